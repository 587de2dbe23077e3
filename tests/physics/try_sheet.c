// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Runs one sheet from the command line and prints each frame: for trials.
#include "app/validate/sheet.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int main(int argc, char** argv) {
    sheet_def def = sheet_default();
    double strain[256];
    int n = 0;
    def.verbose = true;
    for (int i = 1; i + 1 < argc; i += 2) {
        const char* k = argv[i];
        double v = atof(argv[i + 1]);
        if (!strcmp(k, "ratio"))
            def.ratio = v;
        if (!strcmp(k, "nu"))
            def.poisson = v;
        if (!strcmp(k, "length"))
            def.length = v;
        if (!strcmp(k, "width"))
            def.width = v;
        if (!strcmp(k, "edges"))
            def.edges = v;
        if (!strcmp(k, "seed"))
            def.seed = (int)v;
        if (!strcmp(k, "clusters"))
            def.clusters = v > 0;
        if (!strcmp(k, "foundation"))
            def.foundation = v > 0;
        if (!strcmp(k, "paper"))
            def.paper_rule = v > 0;
        if (!strcmp(k, "method"))
            def.paper_method = v > 1, def.newton = v == 1;
        if (!strcmp(k, "minres"))
            def.minres = v > 0;
        if (!strcmp(k, "spectral"))
            def.spectral = v > 0;
        if (!strcmp(k, "limit"))
            def.frame_limit = v;
        if (!strcmp(k, "coupled"))
            def.coupled = v > 0;
        if (!strcmp(k, "depth"))
            def.depth = v;
        if (!strcmp(k, "cells"))
            def.cells = (int)v;
        if (!strcmp(k, "strain"))
            strain[n++] = v;
    }
    if (n == 0) {
        for (double s = 1.1; s < 3.05; s += 0.1)
            strain[n++] = s;
    }
    def.strain = strain;
    def.count = n;
    sheet_frame frames[256];
    double wavelength, critical, h;
    if (sheet_run(&def, frames, &wavelength, &critical, &h) != RUGA_OK) {
        fprintf(stderr, "%s\n", ruga_last_error());
        return 1;
    }
    printf("onset %.4f ec  own %.4f  own with poisson %.4f\n", sheet_onset(n, frames, critical, false, 0),
           sheet_onset(n, frames, critical, true, 0), sheet_onset(n, frames, critical, true, def.poisson));
    return 0;
}
