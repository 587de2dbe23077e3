// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Wrinkles of a stiff film on a soft half-space, E* = E / (1 - nu^2):
//   wavelength  2 pi h (E*_x / (3 E*_q))^(1/3)     (paper eq. 3)
//   onset       (1/4) (3 E*_q / E*_x)^(2/3)        (Allen 1969)
//   amplitude   h sqrt(strain / onset - 1)         (Chen & Hutchinson 2004)
#include "shell/shell.h"

#include "core/vec3.h"

static double plane_modulus(double young, double poisson) {
    return young / (1 - poisson * poisson);
}

// E*_x / E*_q
static double modulus_ratio(const ruga_skin_def* skin, const ruga_interior_def* interior) {
    return plane_modulus(skin->young, skin->poisson) / plane_modulus(interior->young, interior->poisson);
}

double ruga_wrinkle_wavelength(const ruga_skin_def* skin, const ruga_interior_def* interior) {
    return 2 * RUGA_PI * skin->thickness * cbrt(modulus_ratio(skin, interior) / 3);
}

double ruga_wrinkle_critical_strain(const ruga_skin_def* skin, const ruga_interior_def* interior) {
    double root = cbrt(3 / modulus_ratio(skin, interior));
    return 0.25 * root * root;
}

double ruga_wrinkle_amplitude(const ruga_skin_def* skin, const ruga_interior_def* interior, double strain) {
    double excess = strain / ruga_wrinkle_critical_strain(skin, interior) - 1;
    return excess > 0 ? skin->thickness * sqrt(excess) : 0;
}
