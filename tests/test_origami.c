// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Crease patterns by others folded from flat by their rest angles, on meshes that know nothing of the
// creases. Skipped where the files are not there.
#include "tests/check.h"
#include "tests/crease_case.h"

#include "io/fold.h"
#include "mesh/remesh.h"
#include "tests/creased.h"

typedef struct origami {
    ruga_crease_pattern pattern;
    crease_case c;
    double *x, *target, *rest, *stiffness;
    bool* fixed;
    ruga_creased* creased;
    double size;
} origami;

static bool read_pattern(const char* name, ruga_crease_pattern* pattern) {
    const char* data = getenv("RUGA_DATA");
    char path[1024];
    (void)snprintf(path, sizeof path, "%s/fold/%s", data ? data : RUGA_SOURCE_DIR "/../shared/data", name);
    FILE* file = fopen(path, "rb");
    if (!file) {
        print_message("skipped: %s is not there (set RUGA_DATA)\n", path);
        return false;
    }
    (void)fclose(file);
    assert_ok(ruga_fold_read(path, 0, 1, pattern));
    return true;
}

// Holds the uncut triangle nearest to the middle, whose vertices have no copies.
static void hold_middle(origami* o) {
    const ruga_cut* cut = &o->c.cut;
    double low[3], high[3], nearest = INFINITY;
    int best = -1;
    ruga_mesh_bounds(&o->c.mesh, low, high);
    for (int p = 0; p < cut->piece_count; p++) {
        bool alone = cut->piece[p].fraction == 1;
        double off[3] = {-(low[0] + high[0]) / 2, -(low[1] + high[1]) / 2, 0};
        for (int i = 0; i < 3; i++) {
            int v = cut->source[cut->piece[p].node[i]];
            alone = alone && cut->copy_start[v + 1] - cut->copy_start[v] == 1;
            ruga_add_scaled(1.0 / 3, o->c.raster.mesh.position + 3 * v, off);
        }
        if (alone && ruga_norm(off) < nearest) {
            nearest = ruga_norm(off);
            best = p;
        }
    }
    assert_true(best >= 0);
    for (int i = 0; i < 3; i++) {
        o->fixed[cut->piece[best].node[i]] = true;
    }
}

// edges: along the side of a square of the pattern's area; thickness as a part of that side; rigidity: D over
// k times that side, k = 1 N the stiffness of the creases.
static void make_origami(origami* o, double scale, int edges, double thickness, double rigidity) {
    ruga_mesh outline;
    const ruga_raster_def raster = ruga_default_raster_def();
    assert_ok(ruga_crease_pattern_mesh(&o->pattern, "pattern", &outline));
    o->size = sqrt(ruga_mesh_area(&outline));
    assert_ok(ruga_mesh_remesh(&outline, o->size / edges, &o->c.mesh));
    ruga_mesh_clear(&outline);
    assert_ok(ruga_crease_pattern_curves(&o->pattern, &(ruga_curve){0}, false, &o->c.curves));
    assert_ok(ruga_raster_create(&o->c.mesh, &o->c.curves, &raster, &o->c.raster));
    assert_ok(ruga_cut_create(&o->c.raster, &o->c.cut));
    size_t nodes = (size_t)o->c.cut.node_count, segments = (size_t)o->c.cut.segment_count;
    o->x = malloc(nodes * 3 * sizeof *o->x);
    o->fixed = calloc(nodes, sizeof *o->fixed);
    o->target = calloc(segments, sizeof *o->target);
    o->rest = calloc(segments, sizeof *o->rest);
    o->stiffness = calloc(segments, sizeof *o->stiffness);
    for (size_t s = 0; s < segments; s++) {
        int curve = o->c.cut.segment[s].curve;
        if (curve >= 0) {
            o->target[s] = scale * ruga_crease_pattern_rest(&o->pattern.edge[o->c.raster.curve[curve].label]);
            o->stiffness[s] = 1;
        }
    }
    hold_middle(o);
    ruga_creased_def def = ruga_default_creased_def();
    double h = thickness * o->size;
    def.raster = &o->c.raster;
    def.cut = &o->c.cut;
    def.stiffness = o->stiffness;
    def.fixed = o->fixed;
    def.skin.thickness = h;
    def.skin.young = rigidity * o->size * 12 * (1 - 0.3 * 0.3) / (h * h * h);
    def.tolerance = 1e-6;
    assert_ok(ruga_creased_create(&def, &o->creased));
    ruga_cut_rest(&o->c.raster, &o->c.cut, o->x);
}

static void clear_origami(origami* o) {
    ruga_creased_destroy(&o->creased);
    free(o->x);
    free(o->fixed);
    free(o->target);
    free(o->rest);
    free(o->stiffness);
    clear_case(&o->c);
    ruga_crease_pattern_clear(&o->pattern);
}

// Ramps the rest angles in `steps`; returns the least part of its target that a segment reaches.
static double fold_origami(origami* o, int steps, const char* name) {
    const ruga_cut* cut = &o->c.cut;
    ruga_creased_report report = {0};
    int iterations = 0;
    for (int step = 1; step <= steps; step++) {
        for (int s = 0; s < cut->segment_count; s++) {
            o->rest[s] = o->target[s] * step / steps;
        }
        assert_ok(ruga_creased_solve(o->creased, o->rest, o->x, &report));
        iterations += report.iterations;
    }
    double least = INFINITY, strain = 0;
    for (int s = 0; s < cut->segment_count; s++) {
        if (o->target[s] != 0) {
            least = fmin(least, ruga_creased_angles(o->creased)[s] / o->target[s]);
        }
    }
    for (int p = 0; p < cut->piece_count; p++) {
        for (int i = 0; i < 3; i++) {
            int a = cut->piece[p].node[i], b = cut->piece[p].node[(i + 1) % 3];
            double rest = ruga_distance(o->c.raster.mesh.position + 3 * cut->source[a],
                                        o->c.raster.mesh.position + 3 * cut->source[b]);
            strain = fmax(strain, fabs(ruga_distance(o->x + 3 * a, o->x + 3 * b) / rest - 1));
        }
    }
    print_message(
        "%s: outcome %d, %d iterations, gap %.2g, least part of a target reached %.4f, edge strain %.2g\n",
        name, report.outcome, iterations, report.gap, least, strain);
    assert_int_equal(report.outcome, RUGA_OUTCOME_MINIMUM);
    assert_true(report.gap < 1e-12 * o->size);
    return least;
}

static void a_vertex_of_right_angles_folds_over(void** state) {
    (void)state;
    origami o = {0};
    if (!read_pattern("simpleVertex.fold", &o.pattern)) {
        skip();
    }
    // Its two lines cannot both fold rigidly: one must be folded all the way before the other can. Soft
    // panels can.
    make_origami(&o, 0.9, 10, 0.02, 0.05);
    assert_true(fold_origami(&o, 6, "simpleVertex") > 0.95);
    clear_origami(&o);
}

static void miura_folds_on_a_coarse_mesh(void** state) {
    (void)state;
    origami o = {0};
    if (!read_pattern("miura-ori.fold", &o.pattern)) {
        skip();
    }
    make_origami(&o, 0.9, 11, 0.01, 10);
    assert_true(fold_origami(&o, 6, "miura-ori") > 0.95);
    clear_origami(&o);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_vertex_of_right_angles_folds_over),
        cmocka_unit_test(miura_folds_on_a_coarse_mesh),
    };
    return cmocka_run_group_tests_name("origami", tests, NULL, check_no_leak);
}
