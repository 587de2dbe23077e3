// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "app/validate/shell_benchmarks.h"

#include "app/validate/shell_patch.h"
#include "core/memory.h"
#include "core/vec3.h"
#include "solver/state.h"
#include "view/render.h"

#include <math.h>
#include <string.h>

enum { HANDLES = 8 };

// One scene, and the positions of all its frames.
typedef struct bench {
    shell_patch patch;
    int* number; // [V] 0, 1, 2 ...: any run of vertices is a region
    ruga_model_def def;
    ruga_handle_def handle[HANDLES];
    int handle_count;
    double* x;      // [frames + 1][V][3]
    double bending; // J, of the last frame
} bench;

static void bench_clear(bench* b) {
    shell_patch_clear(&b->patch);
    ruga_release(b->number);
    ruga_release(b->x);
}

static ruga_status bench_create(const shell_run* run, const shell_patch_def* patch, double thickness,
                                double young, double poisson, int frames, bench* b) {
    *b = (bench){.def = ruga_default_model_def()};
    RUGA_TRY(shell_patch_create(patch, &b->patch));
    RUGA_TRY(RUGA_NEW(b->number, b->patch.mesh.vertex_count));
    for (int v = 0; v < b->patch.mesh.vertex_count; v++) {
        b->number[v] = v;
    }
    b->def.mesh = ruga_mesh_as_def(&b->patch.mesh);
    b->def.has_interior = false;
    b->def.skin.bending = run->bending;
    b->def.skin.thickness = thickness;
    b->def.skin.young = young;
    b->def.skin.poisson = poisson;
    b->def.skin.density = 0;
    b->def.solver.method = RUGA_METHOD_NEWTON;
    b->def.solver.tolerance = 1e-7;
    b->def.step = 1;
    b->def.frames = frames;
    return RUGA_OK;
}

// A handle on vertices [first, end), ramped over all frames.
static ruga_handle_def* add_handle(bench* b, ruga_handle_kind kind, int first, int end) {
    RUGA_ASSERT(b->handle_count < HANDLES);
    ruga_handle_def* h = &b->handle[b->handle_count++];
    *h = ruga_default_handle_def();
    h->kind = kind;
    h->region = (ruga_region){
        .kind = RUGA_REGION_VERTICES, .vertex_count = end - first, .vertices = b->number + first};
    h->ramped = true;
    h->during[1] = b->def.frames * b->def.step;
    return h;
}

static ruga_handle_def* add_rows(bench* b, ruga_handle_kind kind, int first, int end) {
    return add_handle(b, kind, b->patch.row[first], b->patch.row[end]);
}

static void fix_axes(bench* b, int first, int end, bool x, bool y, bool z) {
    ruga_handle_def* h = add_handle(b, RUGA_HANDLE_FIX, first, end);
    h->axes[0] = x;
    h->axes[1] = y;
    h->axes[2] = z;
}

static double* frame_of(const bench* b, int frame) {
    return b->x + 3 * (size_t)b->patch.mesh.vertex_count * (size_t)frame;
}

static ruga_status bench_run(bench* b, int* bad) {
    ruga_status status = RUGA_OK;
    ruga_model* model = NULL;
    ruga_state* state = NULL;
    size_t n = 3 * (size_t)b->patch.mesh.vertex_count;
    ruga_report report;
    b->def.handles = b->handle;
    b->def.handle_count = b->handle_count;
    RUGA_TRY_DONE(RUGA_NEW(b->x, n * ((size_t)b->def.frames + 1)));
    RUGA_TRY_DONE(ruga_model_create(&b->def, &model));
    RUGA_TRY_DONE(ruga_state_create(model, &state));
    memcpy(frame_of(b, 0), ruga_state_positions(state), n * sizeof *b->x);
    for (int k = 1; k <= b->def.frames; k++) {
        RUGA_TRY_DONE(ruga_state_step(model, state, &report));
        *bad += report.outcome != RUGA_OUTCOME_MINIMUM;
        b->bending = report.energy_bending;
        memcpy(frame_of(b, k), ruga_state_positions(state), n * sizeof *b->x);
    }
done:
    ruga_state_destroy(&state);
    ruga_model_destroy(&model);
    return status;
}

// Mean displacement of a row of the mesh along an axis.
static double row_move(const bench* b, int frame, int row, int axis) {
    double sum = 0;
    for (int v = b->patch.row[row]; v < b->patch.row[row + 1]; v++) {
        sum += frame_of(b, frame)[3 * v + axis] - frame_of(b, 0)[3 * v + axis];
    }
    return sum / (b->patch.row[row + 1] - b->patch.row[row]);
}

static double vertex_move(const bench* b, int frame, int v, int axis) {
    return frame_of(b, frame)[3 * v + axis] - frame_of(b, 0)[3 * v + axis];
}

// The vertex of row number k of the rows between v = 0 and v = 1 (even) at u, a multiple of the cell.
static int vertex_at(const bench* b, const shell_patch_def* def, double u, double v) {
    int row = (int)lround(v * def->along) + (def->clamp[0] ? 1 : 0);
    int i = (int)lround(u * def->across);
    return b->patch.row[row] + (def->closed ? i % def->across : i);
}

// Rows that make the triangles of a piece nearly equilateral; a multiple of `step`.
static int rows_for(double length, double width, int across, int step) {
    int rows = (int)lround(length / (width / across * sqrt(0.75)) / step) * step;
    return rows > step ? rows : step;
}

// ---- strips that bend ----------------------------------------------------------------------------------

static void map_strip10(double u, double v, double x[3]) {
    x[0] = 10 * v;
    x[1] = 1 - 1 * u - 0.5;
    x[2] = 0;
}

// Sze, Liu and Lo 2004: shear at the end of a cantilever.
static ruga_status run_cantilever(const shell_run* run, double* value, int* bad) {
    shell_patch_def patch = {.across = run->level / 10,
                             .along = rows_for(10, 1, run->level / 10, 1),
                             .irregular = run->irregular,
                             .clamp = {true, false},
                             .map = map_strip10};
    bench b;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(bench_create(run, &patch, 0.1, 1.2e6, 0, 10, &b));
    (void)add_rows(&b, RUGA_HANDLE_FIX, 0, 2);
    add_rows(&b, RUGA_HANDLE_LINE_FORCE, b.patch.row_count - 1, b.patch.row_count)->force[2] = 4;
    RUGA_TRY_DONE(bench_run(&b, bad));
    value[0] = -row_move(&b, 10, b.patch.row_count - 1, 0);
    value[1] = row_move(&b, 10, b.patch.row_count - 1, 2);
done:
    bench_clear(&b);
    return status;
}

// The slit is open by 4 thousandths of a radian: the clamped row beyond one lip must not touch the other.
static void map_annulus(double u, double v, double x[3]) {
    double r = 6 + 4 * u, angle = (2 * RUGA_PI - 4e-3) * v;
    x[0] = r * cos(angle);
    x[1] = r * sin(angle);
    x[2] = 0;
}

// Sze, Liu and Lo 2004: an annular plate slit along a radius, one lip clamped, the other lifted.
static ruga_status run_annulus(const shell_run* run, double* value, int* bad) {
    shell_patch_def patch = {.across = run->level * 3 / 20,
                             .along = 2 * run->level,
                             .irregular = run->irregular,
                             .clamp = {true, false},
                             .map = map_annulus};
    bench b;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(bench_create(run, &patch, 0.03, 21e6, 0, 20, &b));
    (void)add_rows(&b, RUGA_HANDLE_FIX, 0, 2);
    add_rows(&b, RUGA_HANDLE_LINE_FORCE, b.patch.row_count - 1, b.patch.row_count)->force[2] = 0.8;
    RUGA_TRY_DONE(bench_run(&b, bad));
    int last = b.patch.row[b.patch.row_count - 1], end = b.patch.row[b.patch.row_count] - 1;
    value[0] = vertex_move(&b, 10, last, 2);
    value[1] = vertex_move(&b, 10, end, 2);
    value[2] = vertex_move(&b, 20, last, 2);
    value[3] = vertex_move(&b, 20, end, 2);
done:
    bench_clear(&b);
    return status;
}

static void map_strip1(double u, double v, double x[3]) {
    x[0] = v;
    x[1] = 0.1 * (0.5 - u);
    x[2] = 0;
}

static shell_patch_def strip1(const shell_run* run) {
    return (shell_patch_def){.across = run->level / 10,
                             .along = rows_for(1, 0.1, run->level / 10, 2),
                             .irregular = run->irregular,
                             .clamp = {true, false},
                             .map = map_strip1};
}

// Romero et al. 2021: a cantilever under its own weight; height over width of its shape.
static ruga_status run_heavy(const shell_run* run, double* value, int* bad) {
    shell_patch_def patch = strip1(run);
    const double h = 5e-3, young = 1e9, stiffness = young * h * h * h / 12;
    bench b;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(bench_create(run, &patch, h, young, 0, 20, &b));
    (void)add_rows(&b, RUGA_HANDLE_FIX, 0, 2);
    add_rows(&b, RUGA_HANDLE_FORCE, 0, b.patch.row_count)->force[2] = -100 * stiffness * 0.1;
    RUGA_TRY_DONE(bench_run(&b, bad));
    for (int i = 0; i < 3; i++) {
        int frame = (const int[]){2, 6, 20}[i], tip = b.patch.row_count - 1;
        value[i] = -row_move(&b, frame, tip, 2) / (1 + row_move(&b, frame, tip, 0));
    }
done:
    bench_clear(&b);
    return status;
}

static const double NARROW = 0.05;

static void map_narrow(double u, double v, double x[3]) {
    x[0] = v;
    x[1] = NARROW * (0.5 - u);
    x[2] = 0;
}

// Zero of the line fitted to the square of the sideways move over the first four loads beyond onset.
static double onset_of(const bench* b, int tip, double load_step) {
    double n = 0, sx = 0, sxx = 0, sy = 0, sxy = 0;
    for (int k = 1; k <= b->def.frames && n < 4; k++) {
        double x = k * load_step, w = row_move(b, k, tip, 2);
        if (fabs(w) > 0.01) {
            n += 1;
            sx += x;
            sxx += x * x;
            sy += w * w;
            sxy += x * w * w;
        }
    }
    double slope = n > 1 ? (n * sxy - sx * sy) / (n * sxx - sx * sx) : 0;
    return slope > 0 ? (sx - sy / slope) / n : 0;
}

// A strip on edge, clamped at one end: P L^2 / sqrt(EI GJ) at which it falls over sideways, by a dead load at
// the tip or by its weight. Prandtl's strip is narrow: at a tenth of the length, held warping at the clamp
// already adds 4 and 6 percent.
static ruga_status buckle(const shell_run* run, bool weight, double* value, int* bad) {
    int across = run->level > 20 ? run->level / 20 : 1;
    shell_patch_def patch = {.across = across,
                             .along = rows_for(1, NARROW, across, 2),
                             .irregular = run->irregular,
                             .clamp = {true, false},
                             .map = map_narrow};
    const double h = 1e-3, young = 1e9, stiffness = young * h * h * h / 12;
    const double unit = sqrt(2.0) * stiffness * NARROW, critical = weight ? 12.854 : 4.0126;
    const int frames = 70;
    bench b;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(bench_create(run, &patch, h, young, 0, frames, &b));
    (void)add_rows(&b, RUGA_HANDLE_FIX, 0, 2);
    int tip = b.patch.row_count - 1;
    double load = -0.02 * frames * critical * unit;
    if (weight) {
        add_rows(&b, RUGA_HANDLE_FORCE, 0, tip + 1)->force[1] = load;
    } else {
        add_rows(&b, RUGA_HANDLE_LINE_FORCE, tip, tip + 1)->force[1] = load / NARROW;
    }
    RUGA_TRY_DONE(bench_run(&b, bad));
    value[0] = onset_of(&b, tip, 0.02 * critical);
done:
    bench_clear(&b);
    return status;
}

static ruga_status run_buckling_tip(const shell_run* run, double* value, int* bad) {
    return buckle(run, false, value, bad);
}

static ruga_status run_buckling_weight(const shell_run* run, double* value, int* bad) {
    return buckle(run, true, value, bad);
}

static void map_sheet(double u, double v, double x[3]) {
    x[0] = v;
    x[1] = 0.5 * (0.5 - u);
    x[2] = 0;
}

// Both ends of a sheet are carried to those of half a cylinder: E = D/2 (pi/L)^2 L b, and it stands L/pi
// high.
static ruga_status run_roll(const shell_run* run, double* value, int* bad) {
    shell_patch_def patch = {.across = run->level / 2,
                             .along = rows_for(1, 0.5, run->level / 2, 4),
                             .irregular = run->irregular,
                             .clamp = {true, true},
                             .map = map_sheet};
    const double h = 5e-3, young = 1e9, stiffness = young * h * h * h / 12, r = 1 / RUGA_PI;
    bench b;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(bench_create(run, &patch, h, young, 0, 10, &b));
    (void)add_rows(&b, RUGA_HANDLE_FIX, 0, 2);
    ruga_handle_def* end = add_rows(&b, RUGA_HANDLE_MOVE, b.patch.row_count - 2, b.patch.row_count);
    end->rotate_axis[1] = -1;
    end->rotate_angle = RUGA_PI;
    end->rotate_center[0] = 1;
    end->translate[0] = -1;
    end->translate[2] = 2 * r;
    RUGA_TRY_DONE(bench_run(&b, bad));
    value[0] = b.bending / (0.5 * stiffness * RUGA_PI * RUGA_PI * 0.5);
    int middle = b.patch.row_count / 2;
    value[1] = (row_move(&b, 10, middle, 0) + 0.5) / r;
done:
    bench_clear(&b);
    return status;
}

// ---- curved shells under small loads -------------------------------------------------------------------

static void map_roof(double u, double v, double x[3]) {
    double angle = (2 * u - 1) * 40 * RUGA_PI / 180;
    x[0] = 25 * sin(angle);
    x[1] = 50 * v;
    x[2] = 25 * cos(angle);
}

// Scordelis-Lo roof, whole, at 1e-3 of its weight: sag of the middle of the free edge.
static ruga_status run_roof(const shell_run* run, double* value, int* bad) {
    const double width = 25 * 80 * RUGA_PI / 180, scale = 1e-3;
    shell_patch_def patch = {.across = run->level,
                             .along = rows_for(50, width, run->level, 4),
                             .irregular = run->irregular,
                             .map = map_roof};
    bench b;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(bench_create(run, &patch, 0.25, 4.32e8, 0, 1, &b));
    int middle = vertex_at(&b, &patch, 0.5, 0.5), rows = b.patch.row_count;
    fix_axes(&b, b.patch.row[0], b.patch.row[1], true, false, true);
    fix_axes(&b, b.patch.row[rows - 1], b.patch.row[rows], true, false, true);
    fix_axes(&b, middle, middle + 1, false, true, false);
    add_rows(&b, RUGA_HANDLE_FORCE, 0, rows)->force[2] = -90 * 50 * width * scale;
    RUGA_TRY_DONE(bench_run(&b, bad));
    value[0] = -0.5 *
               (vertex_move(&b, 1, vertex_at(&b, &patch, 0, 0.5), 2) +
                vertex_move(&b, 1, vertex_at(&b, &patch, 1, 0.5), 2)) /
               scale;
done:
    bench_clear(&b);
    return status;
}

static void map_cylinder(double u, double v, double x[3]) {
    x[0] = 300 * cos(2 * RUGA_PI * u);
    x[1] = 600 * v;
    x[2] = 300 * sin(2 * RUGA_PI * u);
}

// Pinched cylinder with diaphragms, whole; `level` cells on a quarter of the way round.
static ruga_status run_cylinder(const shell_run* run, double* value, int* bad) {
    const double load = 100;
    shell_patch_def patch = {.across = 4 * run->level,
                             .along = rows_for(600, 600 * RUGA_PI, 4 * run->level, 4),
                             .irregular = run->irregular,
                             .closed = true,
                             .map = map_cylinder};
    bench b;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(bench_create(run, &patch, 3, 3e6, 0.3, 1, &b));
    int near = vertex_at(&b, &patch, 0, 0.5), far = vertex_at(&b, &patch, 0.5, 0.5), rows = b.patch.row_count;
    fix_axes(&b, b.patch.row[0], b.patch.row[1], true, false, true);
    fix_axes(&b, b.patch.row[rows - 1], b.patch.row[rows], true, false, true);
    fix_axes(&b, near, near + 1, false, true, false);
    add_handle(&b, RUGA_HANDLE_FORCE, near, near + 1)->force[0] = -load;
    add_handle(&b, RUGA_HANDLE_FORCE, far, far + 1)->force[0] = load;
    RUGA_TRY_DONE(bench_run(&b, bad));
    value[0] = 0.5 * (vertex_move(&b, 1, far, 0) - vertex_move(&b, 1, near, 0)) / load;
done:
    bench_clear(&b);
    return status;
}

static void map_hemisphere(double u, double v, double x[3]) {
    double height = v * 72 * RUGA_PI / 180, angle = 2 * RUGA_PI * u;
    x[0] = 10 * cos(height) * cos(angle);
    x[1] = 10 * cos(height) * sin(angle);
    x[2] = 10 * sin(height);
}

// Hemisphere with a hole of 18 degrees, whole, pulled along x and pushed along y by 2 N, here by a hundredth
// of it.
static ruga_status run_hemisphere(const shell_run* run, double* value, int* bad) {
    const double scale = 1e-2;
    shell_patch_def patch = {.across = 4 * run->level,
                             .along = rows_for(4 * RUGA_PI, 20 * RUGA_PI, 4 * run->level, 4),
                             .irregular = run->irregular,
                             .closed = true,
                             .map = map_hemisphere};
    bench b;
    ruga_status status = RUGA_OK;
    RUGA_TRY_DONE(bench_create(run, &patch, 0.04, 6.825e7, 0.3, 1, &b));
    int at[4];
    for (int i = 0; i < 4; i++) {
        at[i] = vertex_at(&b, &patch, 0.25 * i, 0);
        add_handle(&b, RUGA_HANDLE_FORCE, at[i], at[i] + 1)->force[i % 2] =
            (i == 0 || i == 3 ? 2 : -2) * scale;
    }
    fix_axes(&b, at[0], at[0] + 1, false, true, true);
    fix_axes(&b, at[2], at[2] + 1, false, true, true);
    fix_axes(&b, at[1], at[1] + 1, true, false, true);
    RUGA_TRY_DONE(bench_run(&b, bad));
    value[0] = 0.5 * (vertex_move(&b, 1, at[0], 0) - vertex_move(&b, 1, at[2], 0)) / scale;
done:
    bench_clear(&b);
    return status;
}

// ---- a sheet under tension ------------------------------------------------------------------------------

static void map_stretched(double u, double v, double x[3]) {
    x[0] = 0.25 * u;
    x[1] = 0.1 * (v - 0.5);
    x[2] = 0;
}

// Height of row k at half of its length.
static double middle_height(const bench* b, int frame, int k, int across) {
    const double* x = frame_of(b, frame) + 3 * (size_t)(b->patch.row[k] + across / 2);
    return k % 2 == 0 ? x[2] : 0.5 * (x[2] + x[5]);
}

// Wavelength across the middle half of the width: 2 pi sqrt(int w^2 / int w'^2); 0 where it is flat.
static double middle_wavelength(const bench* b, int frame, const shell_patch_def* patch) {
    double square = 0, slope = 0, dy = 0.1 / patch->along;
    for (int k = patch->along / 4; k < patch->along - patch->along / 4; k++) {
        double p = middle_height(b, frame, k, patch->across),
               q = middle_height(b, frame, k + 1, patch->across);
        square += 0.25 * (p + q) * (p + q);
        slope += (q - p) * (q - p) / (dy * dy);
    }
    return slope > 0 ? 2 * RUGA_PI * sqrt(square / slope) : 0;
}

// Cerda and Mahadevan 2003: lambda = 2 sqrt(pi) (B/T)^(1/4) L^(1/2). Rows run along the tension T: a row of
// linear triangles across it zigzags over a wrinkle, and tension pulls that straight like a bending stiffness
// T edge^2 / 48.
static ruga_status run_stretched(const shell_run* run, double* value, int* bad) {
    shell_patch_def patch = {.across = 3 * run->level / 4 * 4,
                             .along = (int)lround(0.1 / (0.25 / (3 * run->level) * sqrt(0.75))) / 2 * 2,
                             .irregular = run->irregular,
                             .map = map_stretched};
    bench b;
    ruga_status status = RUGA_OK;
    int* ends = NULL;
    RUGA_TRY_DONE(bench_create(run, &patch, 2e-5, 1e6, 0.45, 10, &b));
    b.def.solver.method = RUGA_METHOD_DEFAULT;
    int rows = b.patch.row_count;
    RUGA_TRY_DONE(RUGA_NEW(ends, 2 * (size_t)rows));
    for (int r = 0; r < rows; r++) {
        ends[r] = b.patch.row[r];
        ends[rows + r] = b.patch.row[r + 1] - 1;
    }
    add_handle(&b, RUGA_HANDLE_FIX, 0, rows)->region.vertices = ends;
    ruga_handle_def* pulled = add_handle(&b, RUGA_HANDLE_MOVE, 0, rows);
    pulled->region.vertices = ends + rows;
    pulled->translate[0] = 0.005;
    RUGA_TRY_DONE(bench_run(&b, bad));
    value[0] = middle_wavelength(&b, 5, &patch);
    value[1] = middle_wavelength(&b, 10, &patch);
done:
    ruga_release(ends);
    bench_clear(&b);
    return status;
}

// ---- a sheet under tension that is pushed together across it ---------------------------------------------

// Length 1, tension T = 0.002 E h along x, nu = 0 (so that it contracts nothing by itself), all sides
// supported (w = 0), pushed together along y: a wave of wavenumbers pi/L and k buckles at N k^2 = B (k^2 +
// (pi/L)^2)^2 + T (pi/L)^2. The least N has k^4 = (pi/L)^4 + (T/B) (pi/L)^2: lambda = 2 sqrt(pi) (B/T)^(1/4)
// L^(1/2), but for (lambda / 2 L)^4 /
// 4. The thickness makes that L/3, the width is four of it. T edge^2 / 48 (see below) is 5 % of B at 40.
static const double PUSHED_YOUNG = 1e9, PUSHED_STRAIN = 0.002, PUSHED_MOST = 2;
enum { PUSHED_FRAMES = 7, PUSHED_HALF_WAVES = 8, PUSHED_EARLY = 6 };

typedef struct pushed {
    double thickness, bending, tension; // h, B, T
    double wavenumber, width, critical; // k; N
} pushed;

static pushed pushed_sheet(void) {
    double root = pow(1 / (6 * sqrt(RUGA_PI)), 4), kx = RUGA_PI; // B/T
    pushed p = {.thickness = sqrt(12 * PUSHED_STRAIN * root)};
    p.tension = PUSHED_STRAIN * PUSHED_YOUNG * p.thickness;
    p.bending = root * p.tension;
    double k2 = sqrt(pow(kx, 4) + kx * kx / root);
    p.wavenumber = sqrt(k2);
    p.width = PUSHED_HALF_WAVES * RUGA_PI / p.wavenumber;
    p.critical = (p.bending * (k2 + kx * kx) * (k2 + kx * kx) + p.tension * kx * kx) / k2;
    return p;
}

static void map_pushed(double u, double v, double x[3]) {
    x[0] = u;
    x[1] = pushed_sheet().width * (v - 0.5);
    x[2] = 0;
}

// Beyond onset, w = a(x) cos(k y) with sides that stay straight: across, the stress is what the contraction
// leaves over from the wave's own length, N(x) = N - E h k^2 a^2 / 4, so that
//     T' a'' + (N - N_c) k^2 a + T' (pi/L)^2 a - (E h k^4 / 4) a^3 = 0,    T' = T + 2 B k^2,    a(0) = a(L) =
//     0,
// Duffing's equation: alpha = (N - N_c) k^2 / T' + (pi/L)^2, beta = E h k^4 / (4 T'), q = beta A^2 / alpha,
//     L = 2 / sqrt(alpha) int_0^(pi/2) dt / sqrt(1 - q (1 + sin^2 t) / 2),    a = A sin t.
// Returns sqrt(2 <a^2>), which is A where a is a sine.
static double pushed_amplitude(double load) {
    enum { STEPS = 2000, HALVINGS = 60 };
    pushed p = pushed_sheet();
    double k2 = p.wavenumber * p.wavenumber, tension = p.tension + 2 * p.bending * k2;
    double alpha = (load - 1) * p.critical * k2 / tension + RUGA_PI * RUGA_PI;
    double beta = PUSHED_YOUNG * p.thickness * k2 * k2 / (4 * tension), low = 0, high = 1, square = 0;
    for (int i = 0; i < HALVINGS; i++) {
        double q = 0.5 * (low + high), length = 0, sum = 0;
        for (int j = 0; j < STEPS; j++) {
            double sine = sin((j + 0.5) * RUGA_PI / (2 * STEPS)), s2 = sine * sine;
            double dx = RUGA_PI / STEPS / sqrt(alpha * (1 - q * (1 + s2) / 2));
            length += dx;
            sum += s2 * dx;
        }
        square = q * alpha / beta * sum / length;
        *(length < 1 ? &low : &high) = q;
    }
    return sqrt(2 * square);
}

// Amplitude 2 sqrt(<w^2>) and wavelength across 2 pi sqrt(int w^2 / int (dw/dy)^2), 0 where it is flat.
static void measure_waves(const bench* b, int frame, double* amplitude, double* wavelength) {
    double area = 0, square = 0, slope = 0;
    for (int f = 0; f < b->patch.mesh.triangle_count; f++) {
        const int* t = b->patch.mesh.triangle + 3 * (size_t)f;
        const double *X[3], *x = frame_of(b, frame);
        for (int i = 0; i < 3; i++) {
            X[i] = b->patch.mesh.position + 3 * (size_t)t[i];
        }
        double part =
            0.5 * fabs((X[1][0] - X[0][0]) * (X[2][1] - X[0][1]) - (X[2][0] - X[0][0]) * (X[1][1] - X[0][1]));
        double w[3] = {x[3 * t[0] + 2], x[3 * t[1] + 2], x[3 * t[2] + 2]};
        double along =
            ((X[1][0] - X[0][0]) * (w[2] - w[0]) - (X[2][0] - X[0][0]) * (w[1] - w[0])) / (2 * part);
        area += part;
        square += part * (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]) / 3;
        slope += part * along * along;
    }
    *amplitude = 2 * sqrt(square / area);
    *wavelength = slope > 0 ? 2 * RUGA_PI * sqrt(square / slope) : 0;
}

// Zero of the line through the squares of the first two amplitudes beyond onset.
static double pushed_onset(const bench* b, double thickness) {
    double before = 0, x_before = 0;
    for (int k = 1; k <= b->def.frames; k++) {
        double a, x = PUSHED_MOST * k / b->def.frames, wavelength;
        measure_waves(b, k, &a, &wavelength);
        if (before > 0) {
            return x_before - before * (x - x_before) / (a * a - before);
        }
        if (a > 0.02 * thickness) {
            before = a * a;
            x_before = x;
        }
    }
    return 0;
}

static ruga_status draw_sheet(const bench* b, const char* path) {
    const double* x = frame_of(b, b->def.frames);
    double* height = NULL;
    ruga_render_def def = ruga_default_render_def();
    RUGA_TRY(RUGA_NEW(height, b->patch.mesh.vertex_count));
    for (int v = 0; v < b->patch.mesh.vertex_count; v++) {
        height[v] = x[3 * (size_t)v + 2];
        def.scalar.max = fmax(def.scalar.max, fabs(height[v]));
    }
    def.width = 700;
    def.height = 500;
    def.elevation = 60 * RUGA_PI / 180;
    def.scalar.value = height;
    def.scalar.min = -def.scalar.max;
    def.scalar.name = "height, m";
    ruga_status status = ruga_render_png(&b->patch.mesh, x, &def, path);
    ruga_release(height);
    return status;
}

static ruga_status run_pushed(const shell_run* run, double* value, int* bad) {
    pushed p = pushed_sheet();
    int across = run->level * 9 / 5;
    shell_patch_def patch = {.across = across,
                             .along = rows_for(p.width, 1, across, 2),
                             .irregular = run->irregular,
                             .map = map_pushed};
    bench b;
    ruga_status status = RUGA_OK;
    int* ends = NULL;
    RUGA_TRY_DONE(bench_create(run, &patch, p.thickness, PUSHED_YOUNG, 0, PUSHED_FRAMES, &b));
    int rows = b.patch.row_count;
    RUGA_TRY_DONE(RUGA_NEW(ends, 2 * (size_t)rows));
    for (int r = 0; r < rows; r++) {
        ends[r] = b.patch.row[r];
        ends[rows + r] = b.patch.row[r + 1] - 1;
    }
    fix_axes(&b, 0, rows, true, false, true);
    b.handle[0].region.vertices = ends;
    fix_axes(&b, 0, rows, false, false, true);
    b.handle[1].region.vertices = ends + rows;
    ruga_handle_def* pull = add_handle(&b, RUGA_HANDLE_LINE_FORCE, 0, rows);
    pull->region.vertices = ends + rows;
    pull->force[0] = p.tension;
    pull->ramped = false;
    for (int side = 0; side < 2; side++) {
        int row = side ? rows - 1 : 0;
        ruga_handle_def* push = add_rows(&b, RUGA_HANDLE_MOVE, row, row + 1);
        push->axes[0] = push->axes[2] = false;
        push->translate[1] =
            (side ? -0.5 : 0.5) * PUSHED_MOST * p.critical / (PUSHED_YOUNG * p.thickness) * p.width;
        fix_axes(&b, b.patch.row[row] + 1, b.patch.row[row + 1] - 1, false, false, true);
    }
    RUGA_TRY_DONE(bench_run(&b, bad));
    value[0] = pushed_onset(&b, p.thickness);
    measure_waves(&b, PUSHED_EARLY, &value[2], &value[1]);
    measure_waves(&b, PUSHED_FRAMES, &value[4], &value[3]);
    value[2] /= pushed_amplitude(PUSHED_MOST * PUSHED_EARLY / PUSHED_FRAMES);
    value[4] /= pushed_amplitude(PUSHED_MOST);
    if (run->picture) {
        RUGA_TRY_DONE(draw_sheet(&b, run->picture));
    }
done:
    ruga_release(ends);
    bench_clear(&b);
    return status;
}

// ---- the list ------------------------------------------------------------------------------------------

const shell_benchmark shell_benchmarks[] = {
    {"cantilever",
     "Sze, Liu and Lo 2004; elastica",
     true,
     false,
     false,
     NULL,
     0.03,
     2,
     {"-U", "W"},
     {3.2894, 6.6996},
     run_cantilever},
    {"slit annulus",
     "Sze, Liu and Lo 2004",
     false,
     false,
     false,
     NULL,
     0.03,
     4,
     {"W_A at P/2", "W_B at P/2", "W_A at P", "W_B at P"},
     {10.468, 13.768, 13.891, 17.528},
     run_annulus},
    {"heavy cantilever",
     "elastica; Romero et al. 2021",
     true,
     false,
     false,
     NULL,
     0.03,
     3,
     {"H/W at 10", "H/W at 30", "H/W at 100"},
     {1.0668, 2.5472, 5.8881},
     run_heavy},
    {"buckling under a tip load",
     "Prandtl 1899",
     false,
     false,
     false,
     NULL,
     0.03,
     1,
     {"P L^2 / sqrt(EI GJ)"},
     {4.0126},
     run_buckling_tip},
    {"buckling under weight",
     "Prandtl 1899",
     false,
     false,
     false,
     NULL,
     0.03,
     1,
     {"q L^3 / sqrt(EI GJ)"},
     {12.854},
     run_buckling_weight},
    {"roll",
     "closed form",
     false,
     false,
     false,
     NULL,
     0.03,
     2,
     {"energy / (D/2 kappa^2 A)", "height / R"},
     {1, 1},
     run_roll},
    {"Scordelis-Lo roof",
     "MacNeal and Harder 1985",
     false,
     false,
     false,
     NULL,
     0.03,
     1,
     {"sag"},
     {0.3024},
     run_roof},
    {"pinched cylinder",
     "Belytschko et al. 1985",
     false,
     false,
     false,
     NULL,
     0.03,
     1,
     {"deflection"},
     {1.82488e-5},
     run_cylinder},
    {"hemisphere",
     "Simo, Fox and Rifai 1989",
     true,
     false,
     false,
     NULL,
     0.03,
     1,
     {"deflection"},
     {0.0935},
     run_hemisphere},
    {"pushed sheet",
     "Cerda and Mahadevan 2003",
     false,
     false,
     true,
     "The pushed sheet at twice the load of onset, irregular mesh, kirchhoff-love",
     0.05,
     5,
     {"N / N_c at onset", "wavelength at 1.7 N_c, m", "amplitude at 1.7 N_c / closed form",
      "wavelength at 2 N_c, m", "amplitude at 2 N_c / closed form"},
     {1, 1.0 / 3, 1, 1.0 / 3, 1},
     run_pushed},
    // (B/T)^(1/4) with B/T = h^2 / (12 (1 - nu^2) strain)
    {"stretched sheet",
     "Cerda and Mahadevan 2003",
     false,
     true,
     false,
     NULL,
     0.10,
     2,
     {"wavelength at 1 %, m", "wavelength at 2 %, m"},
     {0.0142515, 0.0119841},
     run_stretched},
};
const int shell_benchmark_count = (int)(sizeof shell_benchmarks / sizeof shell_benchmarks[0]);
