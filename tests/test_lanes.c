// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"

#include "core/random.h"
#include "shell/bending.h"
#include "shell/membrane.h"

static double noise(ruga_random* random) {
    return 2 * ruga_random_uniform(random) - 1;
}

// Whether in vector registers, in what is left over, or alone: an element's numbers are the same bits.
static void elements_side_by_side_do_not_know_one_another(void** state) {
    (void)state;
    static ruga_triangle_lanes all, one;
    static ruga_hinge_lanes hinges, hinge;
    ruga_random random = {17};
    for (int count = 1; count <= RUGA_LANES; count += 5) {
        double energy[RUGA_LANES], alone;
        ruga_membrane_rest rest[RUGA_LANES];
        for (int i = 0; i < count; i++) {
            rest[i] = (ruga_membrane_rest){.stretch = 1 + noise(&random), .shear = 1};
            for (int k = 0; k < 12; k++) {
                hinges.x[k / 3][k % 3][i] = noise(&random);
                all.x[k % 9 / 3][k % 3][i] = hinges.x[k / 3][k % 3][i];
                rest[i].slope[k % 4 / 2][k % 2] = noise(&random);
            }
        }
        ruga_hinge_lanes_measure(count, &hinges);
        for (int kind = RUGA_MEMBRANE_BARAFF_WITKIN; kind <= RUGA_MEMBRANE_STVK; kind++) {
            ruga_membrane_lanes_energy((ruga_membrane)kind, 0.3, count, rest, &all, energy);
            ruga_membrane_lanes_hessian((ruga_membrane)kind, 0.3, count, rest, 0.7, &all);
            for (int i = 0; i < count; i++) {
                for (int k = 0; k < 9; k++) {
                    one.x[k / 3][k % 3][0] = all.x[k / 3][k % 3][i];
                }
                ruga_membrane_lanes_energy((ruga_membrane)kind, 0.3, 1, rest + i, &one, &alone);
                ruga_membrane_lanes_hessian((ruga_membrane)kind, 0.3, 1, rest + i, 0.7, &one);
                assert_true(energy[i] == alone);
                for (int k = 0; k < 27; k++) {
                    assert_true(all.gradient[k % 9 / 3][k % 3][i] == one.gradient[k % 9 / 3][k % 3][0]);
                    assert_true(all.block[k / 9][k % 9][i] == one.block[k / 9][k % 9][0]);
                }
            }
        }
        for (int i = 0; i < count; i++) {
            for (int k = 0; k < 12; k++) {
                hinge.x[k / 3][k % 3][0] = hinges.x[k / 3][k % 3][i];
            }
            ruga_hinge_lanes_measure(1, &hinge);
            assert_true(hinge.angle[0] == hinges.angle[i]);
            for (int k = 0; k < 12; k++) {
                assert_true(hinge.gradient[k / 3][k % 3][0] == hinges.gradient[k / 3][k % 3][i]);
            }
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(elements_side_by_side_do_not_know_one_another),
    };
    return cmocka_run_group_tests(tests, NULL, check_no_leak);
}
