// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// One case of each line of the physics: wavelength, onset and amplitude of a compressed sheet against eq. 3
// and eps_c = (1/4)(3 E*_q / E*_x)^(2/3), A = h sqrt(eps/eps_c - 1). script/physics has the others.
#include "tests/check.h"

#include "app/validate/sheet.h"

static void check_amplitude(const sheet_frame* f, double critical, double h, double tolerance) {
    double law = h * sqrt(f->strain / critical - 1);
    print_message("%.1f eps_c: amplitude %.3f of the law\n", f->strain / critical, f->amplitude / law);
    assert_near(f->amplitude, law, tolerance * law);
}

static void a_prescribed_sheet_wrinkles_as_theory_says(void** state) {
    (void)state;
    enum { COUNT = 10 };
    static const double strain[COUNT] = {0.8, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 2, 2.5, 3};
    sheet_def def = sheet_default();
    sheet_frame frame[COUNT];
    double wavelength, critical, h;
    def.strain = strain;
    def.count = COUNT;
    assert_ok(sheet_run(&def, frame, &wavelength, &critical, &h));
    for (int k = 0; k < def.count; k++) {
        assert_int_equal(frame[k].report.outcome, RUGA_OUTCOME_MINIMUM);
        assert_near(frame[k].report.constraint_residual, 0, 1e-9);
    }
    assert_true(frame[0].amplitude < 0.01 * h);
    double onset = sheet_onset(def.count, frame, critical, false, 0);
    print_message("onset %.3f eps_c, wavelength %.3f\n", onset, frame[7].wavelength_fft / wavelength);
    assert_near(onset, 1, 0.08);
    assert_near(frame[7].wavelength_fft, wavelength, 0.05 * wavelength);
    check_amplitude(&frame[5], critical, h, 0.06);
    for (int k = 7; k < def.count; k++) {
        check_amplitude(&frame[k], critical, h, 0.06);
    }
}

// No clusters: free edges slip, so less strain reaches the skin; its own strain in the middle is what counts.
// The sheet is wide enough for the middle to be nearly in plane strain.
static void the_foundation_alone_wrinkles_at_the_skins_own_strain(void** state) {
    (void)state;
    enum { COUNT = 7 };
    static const double strain[COUNT] = {0.8, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6};
    sheet_def def = sheet_default();
    sheet_frame frame[COUNT];
    double wavelength, critical, h;
    def.ratio = 100;
    def.clusters = false;
    def.length = 18;
    def.width = 6;
    def.strain = strain;
    def.count = COUNT;
    assert_ok(sheet_run(&def, frame, &wavelength, &critical, &h));
    for (int k = 0; k < COUNT; k++) {
        assert_int_equal(frame[k].report.outcome, RUGA_OUTCOME_MINIMUM);
    }
    double onset = sheet_onset(COUNT, frame, critical, true, 0);
    print_message("onset %.3f eps_c, wavelength %.3f\n", onset, frame[COUNT - 1].wavelength_fft / wavelength);
    assert_near(onset, 1, 0.05);
    assert_near(frame[COUNT - 1].wavelength_fft, wavelength, 0.05 * wavelength);
}

static void a_coupled_sheet_wrinkles_at_the_predicted_wavelength(void** state) {
    (void)state;
    enum { COUNT = 5 };
    static const double strain[COUNT] = {0.4, 0.8, 1.2, 1.6, 2};
    sheet_def def = sheet_default();
    sheet_frame frame[COUNT];
    double wavelength, critical, h;
    def.ratio = 100;
    def.coupled = true;
    def.strain = strain;
    def.count = COUNT;
    assert_ok(sheet_run(&def, frame, &wavelength, &critical, &h));
    for (int k = 0; k < COUNT; k++) {
        assert_int_equal(frame[k].report.outcome, RUGA_OUTCOME_MINIMUM);
        assert_true(frame[k].report.residual_coupled <= 1e-5);
    }
    print_message("coupled wavelength %.3f\n", frame[COUNT - 1].wavelength_fft / wavelength);
    assert_near(frame[COUNT - 1].wavelength_fft, wavelength, 0.08 * wavelength);
    assert_true(frame[COUNT - 1].amplitude > 0.5 * h);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_prescribed_sheet_wrinkles_as_theory_says),
        cmocka_unit_test(the_foundation_alone_wrinkles_at_the_skins_own_strain),
        cmocka_unit_test(a_coupled_sheet_wrinkles_at_the_predicted_wavelength),
    };
    return cmocka_run_group_tests_name("physics", tests, NULL, check_no_leak);
}
