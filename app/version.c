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

void ruga_library_versions(const char* between, char* text, size_t size) {
    const char* b = between;
    // " OpenBLAS 0.3.21 "
    const char* blas = strpbrk(OPENBLAS_VERSION, "0123456789");
    (void)snprintf(
        text, size,
        "SuiteSparse %d.%d.%d (CHOLMOD %d.%d.%d)%sTrilinos %s (Belos)%sOpenVDB %s%sCGAL %s%sMETIS %d.%d.%d%s"
        "OpenBLAS %.*s%sARPACK-NG, UDUNITS-2%sEmbree %s%sOpenEXR %s%slibyaml %s%sjansson %s%slibpng %s%s"
        "cairo %s",
        SUITESPARSE_MAIN_VERSION, SUITESPARSE_SUB_VERSION, SUITESPARSE_SUBSUB_VERSION, CHOLMOD_MAIN_VERSION,
        CHOLMOD_SUB_VERSION, CHOLMOD_SUBSUB_VERSION, b, RUGA_TRILINOS_VERSION, b, RUGA_OPENVDB_VERSION, b,
        RUGA_CGAL_VERSION, b, METIS_VER_MAJOR, METIS_VER_MINOR, METIS_VER_SUBMINOR, b,
        (int)strcspn(blas ? blas : "", " "), blas ? blas : "", b, b, RUGA_EMBREE_VERSION, b,
        RUGA_OPENEXR_VERSION, b, yaml_get_version_string(), b, JANSSON_VERSION, b, PNG_LIBPNG_VER_STRING, b,
        CAIRO_VERSION_STRING);
}

void ruga_print_version(void) {
    char libraries[1024];
    ruga_library_versions("\n", libraries, sizeof libraries);
    (void)printf("ruga %s\nHDF5 %d.%d.%d\n%s\n", ruga_version(), H5_VERS_MAJOR, H5_VERS_MINOR,
                 H5_VERS_RELEASE, libraries);
}
