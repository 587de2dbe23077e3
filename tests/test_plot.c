// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Plots: what is drawn, what is refused, and the same bytes each time. What they look like is for eyes:
// RUGA_KEEP_PLOTS=1 leaves the files in the build's tests folder.
#include "tests/check.h"

#include "core/memory.h"
#include "core/vec3.h"
#include "view/axis.h"
#include "view/plot.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { POINTS = 9, GRID = 6 };

static char* read_file(const char* path, size_t* size) {
    FILE* file = fopen(path, "rb");
    assert_non_null(file);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    *size = (size_t)ftell(file);
    rewind(file);
    char* data = ruga_allocate(*size + 1);
    assert_int_equal(fread(data, 1, *size, file), *size);
    data[*size] = '\0';
    assert_int_equal(fclose(file), 0);
    return data;
}

static void forget(const char* path) {
    if (!getenv("RUGA_KEEP_PLOTS")) {
        assert_int_equal(unlink(path), 0);
    }
}

static ruga_status write_series(const char* path) {
    double x[POINTS], law[POINTS], low[POINTS], high[POINTS], ours[POINTS], bar_low[POINTS], bar_high[POINTS];
    for (int i = 0; i < POINTS; i++) {
        x[i] = 1 + 0.25 * i;
        law[i] = sqrt(x[i] - 1);
        low[i] = 0.94 * law[i];
        high[i] = 1.06 * law[i];
        ours[i] = i == 4 ? NAN : law[i] * (1 + 0.02 * sin(5.0 * i));
        bar_low[i] = ours[i] - 0.05;
        bar_high[i] = ours[i] + 0.05;
    }
    const ruga_plot_series series[] = {
        {.name = "law & tolerance",
         .count = POINTS,
         .x = x,
         .y = law,
         .low = low,
         .high = high,
         .style = RUGA_PLOT_LINE},
        {.name = "ours", .count = POINTS, .x = x, .y = ours, .low = bar_low, .high = bar_high, .bars = true},
        {.name = "markers", .count = POINTS, .x = x, .y = low, .style = RUGA_PLOT_MARKERS},
        {.name = "dashed", .count = POINTS, .x = x, .y = high, .style = RUGA_PLOT_DASHED},
    };
    const ruga_plot_reference reference = {.y = 1, .name = "limit"};
    return ruga_plot_write(&(ruga_plot_def){.title = "Amplitude <law>",
                                            .x = {.name = "strain / critical strain"},
                                            .y = {.name = "amplitude, mm"},
                                            .series_count = 4,
                                            .series = series,
                                            .reference_count = 1,
                                            .references = &reference},
                           path);
}

static ruga_status write_log(const char* path, int count) {
    static const double x[] = {0, 10, 100, 1e3, 1e6, -5}, y[] = {1, 2e-6, 3e-5, 4e-4, 1e-2, 1};
    const ruga_plot_series series = {.name = "time", .count = count, .x = x, .y = y};
    return ruga_plot_write(&(ruga_plot_def){.x = {.name = "vertices", .logarithmic = true},
                                            .y = {.name = "time, s", .logarithmic = true},
                                            .series_count = 1,
                                            .series = &series},
                           path);
}

static ruga_status write_map(const char* path) {
    double column[GRID], row[GRID], value[GRID * GRID], ours[GRID * GRID], law[GRID * GRID];
    bool marked[GRID * GRID];
    for (int i = 0; i < GRID; i++) {
        column[i] = pow(10, 1.5 + 0.5 * i);
        row[i] = 0.2 * pow(8, i / 5.0);
    }
    for (int i = 0; i < GRID * GRID; i++) {
        law[i] = 2 * RUGA_PI * row[i / GRID] * cbrt(column[i % GRID] / 3);
        value[i] = 1 + 0.05 * sin(3.0 * i);
        ours[i] = law[i] * value[i];
        marked[i] = law[i] > 33;
    }
    value[3] = NAN;
    static const double level[] = {4, 8, 16, 32, 64};
    const ruga_map_contours contours[] = {
        {.name = "ours", .value = ours, .logarithmic = true, .level_count = 5, .level = level, .unit = "mm"},
        {.name = "eq. 3",
         .value = law,
         .logarithmic = true,
         .dashed = true,
         .level_count = 5,
         .level = level},
    };
    return ruga_map_write(&(ruga_map_def){.title = "Wavelength",
                                          .x = {.name = "ratio of Young's moduli", .logarithmic = true},
                                          .y = {.name = "thickness, mm", .logarithmic = true},
                                          .columns = GRID,
                                          .rows = GRID,
                                          .column = column,
                                          .row = row,
                                          .value = value,
                                          .value_name = "ours / eq. 3",
                                          .min = 0.9,
                                          .max = 1.1,
                                          .marked = marked,
                                          .marked_name = "not judged",
                                          .contours_count = 2,
                                          .contours = contours},
                          path);
}

static void test_the_ending_decides_on_the_format(void** state) {
    (void)state;
    size_t size;
    assert_ok(write_series("plot_series.svg"));
    char* svg = read_file("plot_series.svg", &size);
    assert_memory_equal(svg, "<?xml", 5);
    assert_non_null(strstr(svg, "</svg>"));
    ruga_release(svg);
    assert_ok(write_series("plot_series.png"));
    char* png = read_file("plot_series.png", &size);
    assert_memory_equal(png, "\x89PNG", 4);
    ruga_release(png);
    forget("plot_series.svg");
    forget("plot_series.png");
    assert_status(write_series("plot_series.jpg"), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), ".svg or .png"));
    assert_status(write_series("no/such/folder/plot.svg"), RUGA_IO);
}

// Every tag that opens closes, in turn: what an XML parser would refuse.
static void check_tags(const char* xml) {
    char open[64][32];
    int depth = 0;
    for (const char* at = strchr(xml, '<'); at; at = strchr(at + 1, '<')) {
        const char* end = strchr(at, '>');
        assert_non_null(end);
        if (at[1] == '?' || at[1] == '!') {
            continue;
        }
        size_t length = strcspn(at + 1 + (at[1] == '/'), " />\n");
        assert_true(length > 0 && length < 32);
        if (at[1] == '/') {
            assert_true(depth > 0);
            assert_int_equal(strlen(open[--depth]), length);
            assert_memory_equal(open[depth], at + 2, length);
        } else if (end[-1] != '/') {
            assert_true(depth < 64);
            (void)snprintf(open[depth++], 32, "%.*s", (int)length, at + 1);
        }
    }
    assert_int_equal(depth, 0);
}

static void test_svg_is_well_formed_xml(void** state) {
    (void)state;
    size_t size;
    assert_ok(write_map("plot_map.svg"));
    assert_ok(write_map("plot_map.png"));
    char* svg = read_file("plot_map.svg", &size);
    assert_int_equal(strlen(svg), size);
    check_tags(svg);
    assert_null(strstr(svg, "nan"));
    assert_null(strstr(svg, "inf"));
    ruga_release(svg);
    forget("plot_map.svg");
    forget("plot_map.png");
}

static void test_same_def_gives_the_same_bytes(void** state) {
    (void)state;
    static const char* const ending[] = {"svg", "png"};
    for (int e = 0; e < 2; e++) {
        char *data[2], path[32];
        size_t size[2];
        for (int i = 0; i < 2; i++) {
            (void)snprintf(path, sizeof path, "plot_same%d.%s", i, ending[e]);
            assert_ok(write_map(path));
            data[i] = read_file(path, &size[i]);
            assert_int_equal(unlink(path), 0);
        }
        assert_int_equal(size[0], size[1]);
        assert_memory_equal(data[0], data[1], size[0]);
        ruga_release(data[0]);
        ruga_release(data[1]);
    }
}

static void test_series_without_a_point_is_refused(void** state) {
    (void)state;
    static const double nothing[] = {NAN, INFINITY}, some[] = {1, 2};
    ruga_plot_series series[] = {{.count = 2, .x = some, .y = some},
                                 {.name = "lost", .count = 2, .x = some, .y = nothing}};
    ruga_plot_def def = {.series_count = 2, .series = series};
    assert_status(ruga_plot_write(&def, "plot_bad.svg"), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "series 2, lost has no point to draw"));
    series[1].count = 0;
    assert_status(ruga_plot_write(&def, "plot_bad.svg"), RUGA_BAD_INPUT);
    def.series_count = 0;
    assert_status(ruga_plot_write(&def, "plot_bad.svg"), RUGA_BAD_INPUT);
    assert_int_equal(access("plot_bad.svg", F_OK), -1);
}

static void test_bad_limits_and_grids_are_refused(void** state) {
    (void)state;
    static const double some[] = {1, 2}, back[] = {2, 1}, nothing[] = {NAN, NAN, NAN, NAN};
    const ruga_plot_series series = {.count = 2, .x = some, .y = some};
    ruga_plot_def def = {
        .series_count = 1, .series = &series, .x = {.logarithmic = true, .min = -1, .max = 3}};
    assert_status(ruga_plot_write(&def, "plot_bad.svg"), RUGA_BAD_INPUT);
    ruga_map_def map = {.columns = 2, .rows = 2, .column = some, .row = some, .value = nothing};
    assert_status(ruga_map_write(&map, "plot_bad.svg"), RUGA_BAD_INPUT);
    map.row = back;
    assert_status(ruga_map_write(&map, "plot_bad.svg"), RUGA_BAD_INPUT);
    map.columns = 1;
    assert_status(ruga_map_write(&map, "plot_bad.svg"), RUGA_BAD_INPUT);
}

static void test_logarithmic_axes_leave_out_what_is_not_positive(void** state) {
    (void)state;
    size_t size[2];
    assert_ok(write_log("plot_log.svg", 5));
    char* five = read_file("plot_log.svg", &size[0]);
    assert_ok(write_log("plot_log.svg", 6));
    char* six = read_file("plot_log.svg", &size[1]);
    assert_int_equal(size[0], size[1]);
    assert_memory_equal(five, six, size[0]);
    ruga_release(five);
    ruga_release(six);
    forget("plot_log.svg");
    assert_status(write_log("plot_log.svg", 1), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "positive where the axis is logarithmic"));
}

// Labels that stand on the axis, read back, are the ticks' values, and there are enough and not too many.
static void test_ticks_are_round_and_within_the_axis(void** state) {
    (void)state;
    static const struct {
        bool logarithmic;
        double min, max;
    } axes[] = {{false, 0, 1},      {false, -3.7, 12}, {false, 1.02, 1.09}, {false, 0, 4.2e-6},
                {false, -2e7, 9e7}, {true, 0.18, 1.9}, {true, 30, 1.1e4},   {true, 1e-9, 1e5},
                {true, 4.1, 4.9},   {true, 1.5, 7}};
    for (size_t i = 0; i < sizeof axes / sizeof axes[0]; i++) {
        const ruga_axis axis = {.logarithmic = axes[i].logarithmic, .min = axes[i].min, .max = axes[i].max};
        ruga_tick ticks[RUGA_AXIS_TICKS];
        int labels = 0, count = ruga_axis_ticks(&axis, 6, ticks);
        for (int k = 0; k < count; k++) {
            double size = axis.max - axis.min;
            assert_true(ticks[k].value >= axis.min - 1e-9 * size && ticks[k].value <= axis.max + 1e-9 * size);
            assert_true(k == 0 || ticks[k].value > ticks[k - 1].value);
            if (ticks[k].label[0]) {
                labels++;
                if (!strstr(ticks[k].label, "⁻") && !strstr(ticks[k].label, "10⁵")) {
                    assert_near(atof(ticks[k].label), ticks[k].value, 1e-9 * fabs(ticks[k].value));
                }
            }
        }
        assert_in_range(labels, 3, 11);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_ending_decides_on_the_format),
        cmocka_unit_test(test_svg_is_well_formed_xml),
        cmocka_unit_test(test_same_def_gives_the_same_bytes),
        cmocka_unit_test(test_series_without_a_point_is_refused),
        cmocka_unit_test(test_bad_limits_and_grids_are_refused),
        cmocka_unit_test(test_logarithmic_axes_leave_out_what_is_not_positive),
        cmocka_unit_test(test_ticks_are_round_and_within_the_axis),
    };
    return cmocka_run_group_tests(tests, NULL, check_no_leak);
}
