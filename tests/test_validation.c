// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// `ruga validate` with cases of the test's own in the place of the suite.
#define _POSIX_C_SOURCE 200809L
#include "tests/check.h"

#include "app/command.h"
#include "app/validate/validation.h"
#include "core/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const char FOLDER[] = "test_validation_report";

static ruga_status run_good(ruga_validation* v) {
    ruga_validation_near(v, "within", 1.1, 1, 0.11, "a law");
    ruga_validation_below(v, "below", 1, 1, NULL);
    ruga_validation_above(v, "above", 1, 1, NULL);
    ruga_validation_record(v, "recorded", 7, NAN, NULL);
    return RUGA_OK;
}

static ruga_status run_bad(ruga_validation* v) {
    ruga_validation_near(v, "beyond", 1.2, 1, 0.11, "a law");
    ruga_validation_near(v, "no number", NAN, 1, 0.11, "a law");
    ruga_validation_below(v, "not below", 1.01, 1, NULL);
    return RUGA_OK;
}

static ruga_status run_early(ruga_validation* v) {
    ruga_validation_near(v, "before", 1, 1, 0, NULL);
    return ruga_fail(RUGA_BAD_INPUT, "a sentence of its own");
}

static const ruga_validation_case good = {
    .name = "good", .title = "passes", .about = "", .quick = true, .run = run_good};
static const ruga_validation_case bad = {.name = "bad", .title = "fails", .about = "", .run = run_bad};
static const ruga_validation_case early = {.name = "early", .title = "ends", .about = "", .run = run_early};
const ruga_validation_case* const ruga_validation_cases[] = {&good, &bad, &early, NULL};

// Exit status of the command with these words.
static int exit_of(int count, char** words) {
    ruga_arguments* arguments;
    int exit_status = RUGA_EXIT_DONE;
    assert_ok(ruga_arguments_read(&ruga_validate_command, count, words, &arguments));
    assert_ok(ruga_validate_command.run(arguments, &exit_status));
    ruga_arguments_destroy(&arguments);
    return exit_status;
}

static void read_report(char text[20000]) {
    char path[64];
    (void)snprintf(path, sizeof path, "%s/validation.md", FOLDER);
    FILE* file = fopen(path, "rb");
    assert_non_null(file);
    text[fread(text, 1, 19999, file)] = '\0';
    assert_int_equal(fclose(file), 0);
}

#define WORDS(...)                                                                                           \
    (char*[]) {                                                                                              \
        "--quiet", "-o", (char*)FOLDER, __VA_ARGS__                                                          \
    }

static void lines_that_hold_end_with_0(void** state) {
    (void)state;
    assert_int_equal(exit_of(4, WORDS("--quick")), RUGA_EXIT_DONE);
    assert_int_equal(exit_of(5, WORDS("--case", "good")), RUGA_EXIT_DONE);
}

static void a_line_that_fails_ends_with_1(void** state) {
    (void)state;
    static char text[20000];
    assert_int_equal(exit_of(5, WORDS("--case", "bad")), RUGA_EXIT_NOT_CONVERGED);
    read_report(text);
    assert_non_null(strstr(text, "not below"));
    assert_non_null(strstr(text, "FAIL"));
    assert_int_equal(exit_of(7, WORDS("--case", "good", "--case", "bad")), RUGA_EXIT_NOT_CONVERGED);
}

static void a_case_that_ends_early_is_a_line_that_fails(void** state) {
    (void)state;
    static char text[20000];
    assert_int_equal(exit_of(5, WORDS("--case", "early")), RUGA_EXIT_NOT_CONVERGED);
    read_report(text);
    assert_non_null(strstr(text, "a sentence of its own"));
}

static void failed_lines_are_counted(void** state) {
    (void)state;
    const ruga_validation_settings settings = {.directory = FOLDER, .quiet = true};
    const ruga_validation_case* const cases[] = {&good, &bad, &early};
    const int wanted[] = {0, 3, 1};
    for (int k = 0; k < 3; k++) {
        int failed = -1;
        assert_ok(ruga_validation_run(&settings, cases[k], &failed));
        assert_int_equal(failed, wanted[k]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_that_hold_end_with_0),
        cmocka_unit_test(a_line_that_fails_ends_with_1),
        cmocka_unit_test(a_case_that_ends_early_is_a_line_that_fails),
        cmocka_unit_test(failed_lines_are_counted),
    };
    (void)mkdir(FOLDER, 0777);
    return cmocka_run_group_tests_name("validation", tests, NULL, check_no_leak);
}
