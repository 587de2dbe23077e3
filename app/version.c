// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The libraries that this program was built with. The build gives the numbers of those whose headers are not
// C.
#include "app/command.h"
#include "ruga/base.h"

#include <cairo.h>
#include <cholmod.h>
#include <hdf5.h>
#include <jansson.h>
#include <metis.h>
#include <openblas_config.h>
#include <png.h>
#include <yaml.h>

#include <stdio.h>
#include <string.h>

void ruga_print_version(void) {
    // " OpenBLAS 0.3.21 "
    const char* blas = strpbrk(OPENBLAS_VERSION, "0123456789");
    (void)printf("ruga %s\n", ruga_version());
    (void)printf("SuiteSparse %d.%d.%d (CHOLMOD %d.%d.%d)\n", SUITESPARSE_MAIN_VERSION,
                 SUITESPARSE_SUB_VERSION, SUITESPARSE_SUBSUB_VERSION, CHOLMOD_MAIN_VERSION,
                 CHOLMOD_SUB_VERSION, CHOLMOD_SUBSUB_VERSION);
    (void)printf("Trilinos %s (Belos)\n", RUGA_TRILINOS_VERSION);
    (void)printf("OpenVDB %s\n", RUGA_OPENVDB_VERSION);
    (void)printf("CGAL %s\n", RUGA_CGAL_VERSION);
    (void)printf("HDF5 %d.%d.%d\n", H5_VERS_MAJOR, H5_VERS_MINOR, H5_VERS_RELEASE);
    (void)printf("METIS %d.%d.%d\n", METIS_VER_MAJOR, METIS_VER_MINOR, METIS_VER_SUBMINOR);
    (void)printf("OpenBLAS %.*s\n", (int)strcspn(blas ? blas : "", " "), blas ? blas : "");
    (void)printf("ARPACK-NG, UDUNITS-2\n");
    (void)printf("Embree %s\n", RUGA_EMBREE_VERSION);
    (void)printf("OpenEXR %s\n", RUGA_OPENEXR_VERSION);
    (void)printf("libyaml %s\n", yaml_get_version_string());
    (void)printf("jansson %s\n", JANSSON_VERSION);
    (void)printf("libpng %s\n", PNG_LIBPNG_VER_STRING);
    (void)printf("cairo %s\n", CAIRO_VERSION_STRING);
}
