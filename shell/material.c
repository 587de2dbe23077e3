// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "shell/material.h"

#include <math.h>

static ruga_status check_positive(double value, const char* name, const char* unit) {
    if (!(value > 0) || !isfinite(value)) {
        return ruga_fail(RUGA_BAD_INPUT, "skin.%s is %g%s: it must be above 0", name, value, unit);
    }
    return RUGA_OK;
}

ruga_status ruga_shell_material_check(const ruga_shell_material* material) {
    const ruga_skin_def* skin = &material->skin;
    if (!material->thickness) {
        RUGA_TRY(check_positive(skin->thickness, "thickness", " m"));
    }
    if (!material->young) {
        RUGA_TRY(check_positive(skin->young, "young", " Pa"));
    }
    if (!material->growth) {
        RUGA_TRY(check_positive(skin->growth[0], "growth[0]", ""));
        RUGA_TRY(check_positive(skin->growth[1], "growth[1]", ""));
    }
    if (!(skin->poisson > -1 && skin->poisson < 0.5)) {
        return ruga_fail(RUGA_BAD_INPUT, "skin.poisson is %g: it must be above -1 and below 0.5",
                         skin->poisson);
    }
    if (!(skin->density >= 0) || !isfinite(skin->density)) {
        return ruga_fail(RUGA_BAD_INPUT, "skin.density is %g kg/m^3: it must not be negative", skin->density);
    }
    return RUGA_OK;
}

double ruga_shell_material_thickness(const ruga_shell_material* material, int f) {
    return material->thickness ? material->thickness[f] : material->skin.thickness;
}

double ruga_shell_material_young(const ruga_shell_material* material, int f) {
    return material->young ? material->young[f] : material->skin.young;
}

const double* ruga_shell_material_growth(const ruga_shell_material* material, int f) {
    return material->growth ? material->growth + 2 * (size_t)f : material->skin.growth;
}

double ruga_shell_material_bending(const ruga_shell_material* material, int f) {
    double h = ruga_shell_material_thickness(material, f), nu = material->skin.poisson;
    return ruga_shell_material_young(material, f) * h * h * h / (12 * (1 - nu * nu));
}
