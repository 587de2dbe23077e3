// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"
#include "tests/scarce_memory.h"

#include "io/csv.h"

#include <string.h>
#include <unistd.h>

static const char PATH[] = "table.csv";

static void write_table(const char* text) {
    FILE* file = fopen(PATH, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static void names_and_numbers_are_read(void** state) {
    (void)state;
    ruga_csv csv;
    write_table("\nx, \"a, \"\"b\"\"\" ,outcome\r\n1,2.5e-3,minimum\r\n\n-4 ,\"7\",\n1e400,nan,3");
    assert_ok(ruga_csv_read(PATH, &csv));
    assert_int_equal(csv.column_count, 3);
    assert_int_equal(csv.row_count, 3);
    assert_string_equal(csv.name[1], "a, \"b\"");
    assert_true(csv.column[0][1] == -4 && csv.column[1][0] == 2.5e-3 && csv.column[1][1] == 7);
    assert_true(isnan(csv.column[2][0]) && isnan(csv.column[2][1]) && csv.column[2][2] == 3);
    assert_int_equal(ruga_csv_find(&csv, "outcome", 7), 2);
    assert_int_equal(ruga_csv_find(&csv, "out", 3), -1);
    ruga_csv_clear(&csv);
    unlink(PATH);
}

static void damaged_tables_are_refused_with_their_line(void** state) {
    (void)state;
    static const struct {
        const char *text, *saying;
    } bad[] = {{"", "no row"},
               {"x,y\n", "no row"},
               {"x,y\n1,2\n3\n", ":3: 1 fields"},
               {"x,y\n1,2,3\n", ":2: more fields"},
               {"x,y\n1,\"2\n", ":2: a quote"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        ruga_csv csv;
        write_table(bad[i].text);
        assert_status(ruga_csv_read(PATH, &csv), RUGA_BAD_INPUT);
        assert_non_null(strstr(ruga_last_error(), bad[i].saying));
    }
    ruga_csv csv;
    unlink(PATH);
    assert_status(ruga_csv_read(PATH, &csv), RUGA_IO);
}

static void memory_that_runs_out_is_told(void** state) {
    (void)state;
    ruga_status status = RUGA_NO_MEMORY;
    ruga_csv csv;
    write_table("x,y\n1,2\n3,4\n");
    for (int count = 0; status != RUGA_OK; count++) {
        assert_in_range(count, 0, 50);
        let_allocations_fail_after(count);
        status = ruga_csv_read(PATH, &csv);
        ruga_set_allocator(NULL, NULL, NULL);
        assert_true(status == RUGA_OK || status == RUGA_NO_MEMORY);
    }
    ruga_csv_clear(&csv);
    unlink(PATH);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_and_numbers_are_read),
        cmocka_unit_test(damaged_tables_are_refused_with_their_line),
        cmocka_unit_test(memory_that_runs_out_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, check_no_leak);
}
