// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What a simulation is made from. Fill a def with ruga_default_model_def(), change fields, and hand it to
// ruga_model_create, which copies everything it keeps. All quantities are SI: m, s, Pa, N, kg, rad.
#ifndef RUGA_TYPES_H
#define RUGA_TYPES_H

#include "ruga/base.h"

#ifdef __cplusplus
extern "C" {
#endif

// A triangle mesh in arrays of the caller. Zero a struct and set what you have.
typedef struct ruga_mesh_def {
    int vertex_count;
    const double* positions; // [vertex_count][3] m
    int triangle_count;
    const int* triangles; // [triangle_count][3], counter-clockwise seen from outside
    int uv_count;
    const double* uv;        // [uv_count][2], or NULL
    const int* uv_triangles; // [triangle_count][3] indices into uv, or NULL
    int group_count;
    const char* const* group_names; // [group_count], or NULL
    const int* face_group;          // [triangle_count] index into group_names or -1, or NULL
} ruga_mesh_def;

typedef enum ruga_region_kind {
    RUGA_REGION_ALL,
    RUGA_REGION_BOX,      // between min and max, bounds included
    RUGA_REGION_SPHERE,   // within radius of center
    RUGA_REGION_PLANE,    // where (x - center).normal >= 0
    RUGA_REGION_GROUP,    // the vertices of a group's faces
    RUGA_REGION_VERTICES, // listed vertices
} ruga_region_kind;

// A part of the rest shape, in metres in the mesh's frame.
typedef struct ruga_region {
    ruga_region_kind kind;
    double min[3], max[3];    // box
    double center[3], radius; // sphere; a point on the plane
    double normal[3];         // plane
    const char* group;
    int vertex_count;
    const int* vertices;
} ruga_region;

typedef enum ruga_hold { RUGA_HOLD_BOTH, RUGA_HOLD_INTERIOR, RUGA_HOLD_SKIN } ruga_hold;

typedef enum ruga_handle_kind {
    RUGA_HANDLE_FIX,        // the region keeps its rest position along `axes`
    RUGA_HANDLE_MOVE,       // the region is translated and rotated
    RUGA_HANDLE_PRESS,      // pressure along the inward normal of the deformed skin
    RUGA_HANDLE_FORCE,      // a total force, spread over the region's area
    RUGA_HANDLE_LINE_FORCE, // a force per length along the region's boundary edges
} ruga_handle_kind;

typedef struct ruga_handle_def {
    ruga_region region;
    ruga_handle_kind kind;
    bool axes[3];          // fix and move: which components are held; default all
    double translate[3];   // move, m, at full ramp
    double rotate_axis[3]; // move: need not be of unit length; zero = no rotation
    double rotate_angle;   // move, rad, at full ramp
    double rotate_center[3];
    ruga_hold hold;
    double pressure;  // press, Pa
    double force[3];  // force: N; line_force: N/m
    bool ramped;      // whether `during` was given; otherwise at full strength from the start
    double during[2]; // s: linear from the first to the second, then held
} ruga_handle_def;

// Interior motion when prescribed: x -> matrix (x - c) + c + translate, c the mesh's centre (of its bounding
// box), then the bump. Linear in time between keyframes, held outside.
typedef struct ruga_keyframe_def {
    double time;         // s
    double matrix[9];    // row by row; a stretch is a diagonal
    double translate[3]; // m
    bool has_bump;
    double bump_center[3];    // m, rest shape
    double bump_radius;       // m: depth exp(-|x - center|^2 / (2 radius^2)) along direction
    double bump_depth;        // m
    double bump_direction[3]; // need not be of unit length
} ruga_keyframe_def;

// A moving surface that the interior follows in place of keyframes. The samples are asked for in order while
// a model is created; another status than RUGA_OK ends that.
typedef ruga_status ruga_sample_function(int sample, double* positions, void* context);
typedef struct ruga_motion_def {
    int sample_count;           // 0 = none
    const double* times;        // [sample_count] s, ascending: linear in between, held outside
    ruga_sample_function* read; // positions [vertex_count][3] m of the mesh's vertices
    void* context;
    double smoothness; // > 0: weight of the lattice's second differences beside the distance to the surface
} ruga_motion_def;

typedef enum ruga_membrane { RUGA_MEMBRANE_BARAFF_WITKIN, RUGA_MEMBRANE_STVK } ruga_membrane;
typedef enum ruga_bending { RUGA_BENDING_HINGE, RUGA_BENDING_KIRCHHOFF_LOVE } ruga_bending;
// RUGA_SKIN_DYNAMIC is for a free shell.
typedef enum ruga_skin_motion { RUGA_SKIN_STATIC, RUGA_SKIN_DAMPED, RUGA_SKIN_DYNAMIC } ruga_skin_motion;
typedef enum ruga_interior_motion {
    RUGA_INTERIOR_DYNAMIC,
    RUGA_INTERIOR_QUASISTATIC,
    RUGA_INTERIOR_PRESCRIBED
} ruga_interior_motion;
typedef enum ruga_fill { RUGA_FILL_MESH, RUGA_FILL_BOX } ruga_fill;
typedef enum ruga_coupling_kind {
    RUGA_COUPLING_CLUSTERS,
    RUGA_COUPLING_SPECTRAL,
    RUGA_COUPLING_NONE
} ruga_coupling_kind;
typedef enum ruga_coupling_rule { RUGA_RULE_CALIBRATED, RUGA_RULE_PAPER } ruga_coupling_rule;
typedef enum ruga_method {
    RUGA_METHOD_DEFAULT,
    RUGA_METHOD_NEWTON,
    RUGA_METHOD_QUASI_NEWTON,
    RUGA_METHOD_PAPER
} ruga_method;
typedef enum ruga_linear_kind { RUGA_LINEAR_DIRECT, RUGA_LINEAR_MINRES } ruga_linear_kind;

// RUGA_SKIN_VOLUME: no shell, but thin stiff elements of a volume that is fine throughout, on top of a box;
// the interior must be prescribed by stretches along the axes. RUGA_SKIN_SPRINGS: cloth of springs, in
// dynamic motion.
typedef enum ruga_skin_model { RUGA_SKIN_SHELL, RUGA_SKIN_SPRINGS, RUGA_SKIN_VOLUME } ruga_skin_model;

// Hinges of creases in dynamic motion (Patkar, Jin and Fedkiw 2015, figure 3 (d) and (e), for the latter
// two).
typedef enum ruga_crease_style {
    RUGA_CREASE_ANGLE,  // signed springs against the fold angle
    RUGA_CREASE_PAIRS,  // springs between nodes and their virtual copies
    RUGA_CREASE_ACROSS, // bending and axial-bending springs across the crease
} ruga_crease_style;

typedef struct ruga_skin_def {
    ruga_skin_model model;
    double thickness; // m, > 0
    double young;     // Pa, > 0
    double poisson;   // in (-1, 0.5)
    double density;   // kg/m^3, >= 0
    ruga_membrane membrane;
    ruga_bending bending;
    double growth[2]; // rest lengths along and across the skin's first direction are multiplied by these
    ruga_skin_motion motion;
    double relaxation; // s, for damped motion
    double damping; // s, >= 0, for dynamic motion: viscous stress over the elastic stress of the strain rate
    double drag;    // 1/s, >= 0, for dynamic motion: M drag v
    ruga_crease_style creases; // angle unless the motion is dynamic
    // A skin that varies: values at the mesh's vertices, linear between them, in place of those above; NULL =
    // as above.
    int vertex_count;               // of each array given: the mesh's
    const double* vertex_thickness; // [vertex_count] m, > 0
    const double* vertex_young;     // [vertex_count] Pa, > 0
    const double* vertex_growth;    // [vertex_count][2], > 0
} ruga_skin_def;

typedef struct ruga_interior_def {
    double young;   // Pa, > 0
    double poisson; // in (-1, 0.5)
    double density; // kg/m^3, > 0 where dynamic
    double damping; // 1/s: velocity-proportional, M damping v
    ruga_interior_motion motion;
} ruga_interior_def;

typedef struct ruga_lattice_def {
    int cells;  // along the longest side, >= 1
    int degree; // 2 = quadratic B-splines (C1), 1 = trilinear (C0)
    ruga_fill fill;
    double depth; // m, box only: 0 = one cell
} ruga_lattice_def;

typedef struct ruga_coupling_def {
    ruga_coupling_kind kind;
    ruga_coupling_rule rule;
    bool foundation;
    int count;     // number of clusters or of spectral vectors; 0 = by the rule
    double radius; // m, largest distance of a vertex to its cluster's centre; 0 = by the rule
    double sigma;  // m, width of the Gaussian; 0 = by the rule
} ruga_coupling_def;

typedef struct ruga_solver_def {
    ruga_method method;
    ruga_linear_kind linear;
    double tolerance; // relative, see docs/scene.md
    int64_t seed;
    bool allow_coarse; // run even below 3 edges per wavelength
} ruga_solver_def;

typedef enum ruga_crease_kind {
    RUGA_CREASE_FOLD, // cut and sewn together again: the panels turn about the curve
    RUGA_CREASE_CUT,  // cut and left open
} ruga_crease_kind;

// How much a crease may do besides folding as one straight hinge; docs/creases.md says what is at stake.
typedef enum ruga_crease_freedom {
    RUGA_FREEDOM_AUTO,   // full where the curve is not straight, meets another, is closed, or its values vary
    RUGA_FREEDOM_SINGLE, // the element of Patkar, Jin and Fedkiw (2015)
    RUGA_FREEDOM_FULL,   // auxiliary chords: the freedom of a mesh that conforms to the curve
} ruga_crease_freedom;

typedef enum ruga_crease_path {
    RUGA_CREASE_POLYLINE, // points in space, brought to the nearest place of the rest surface
    RUGA_CREASE_UV,       // points in texture coordinates
    RUGA_CREASE_EDGES,    // vertices that mesh edges join
    RUGA_CREASE_GROUP,    // the border of a group of faces
} ruga_crease_path;

// The rest angle is angle + scale times the crease's `rest` (or point_rest); linear between keys, held
// outside.
typedef struct ruga_crease_key {
    double time;  // s, above that of the key before
    double angle; // rad
    double scale;
} ruga_crease_key;

// One crease curve, or those around a group, with its hinge: k l / 2 (theta - rest)^2 for each length l of
// it. theta is 0 when flat and positive for a valley: both sides turn to where their normals point.
typedef struct ruga_crease_def {
    const char* name; // where it comes from, for messages and results; may be NULL
    ruga_crease_path path;
    bool closed;          // polyline, uv: the last point is joined to the first
    int point_count;      // of polyline and uv
    const double* points; // polyline: [point_count][3] m; uv: [point_count][2]
    int vertex_count;
    const int* vertices; // of edges
    const char* group;
    ruga_crease_kind kind; // a cut has no hinge
    ruga_crease_freedom freedom;
    double start;     // s: until then the sheet is not cut along it; <= 0: always there
    char assignment;  // 'M', 'V', 'F', 'U', 'C' as in FOLD; carried along
    double stiffness; // N m/rad per m = N, >= 0
    double rest;      // rad
    const double*
        point_stiffness;      // [point_count or vertex_count] in place of it, linear along the curve; or NULL
    const double* point_rest; // likewise
    int key_count;            // 0: the rest angle stays as it is
    const ruga_crease_key* keys;
    double yield;     // rad, >= 0: beyond it the rest angle follows; INFINITY = never
    double rate;      // 1/s, > 0: how fast; INFINITY = at once
    double hardening; // >= 0: growth of the yield angle for each rad of plastic turning
} ruga_crease_def;

// How a free skin begins: folded flat panels; in dynamic motion then rolled, with a velocity where nothing
// holds it.
typedef struct ruga_start_def {
    double fold; // part of the creases' rest angles at time 0 by which panels are turned; 0 = as the mesh is
    double
        cone; // rad: a sector of the plane z = 0 about the origin, of this angle, closes to a cone; 0 = none
    double velocity[3]; // m/s
    double spin[3];     // rad/s, about the origin; added to it
} ruga_start_def;

typedef struct ruga_model_def {
    ruga_mesh_def mesh;
    ruga_skin_def skin;
    bool has_interior; // false: a free shell or cloth
    ruga_interior_def interior;
    ruga_lattice_def lattice;
    ruga_coupling_def coupling;
    int keyframe_count;
    const ruga_keyframe_def* keyframes;
    ruga_motion_def follow;
    double step; // s, > 0
    int frames;  // >= 1
    double gravity[3];
    int handle_count;
    const ruga_handle_def* handles;
    int crease_count;
    const ruga_crease_def* creases;
    ruga_start_def start;
    ruga_solver_def solver;
    uint32_t cookie; // set by ruga_default_model_def
} ruga_model_def;

// Every field at its documented default; the mesh is empty.
RUGA_API ruga_model_def ruga_default_model_def(void);
// A handle that fixes everything; a keyframe of the rest shape at time 0.
RUGA_API ruga_handle_def ruga_default_handle_def(void);
RUGA_API ruga_keyframe_def ruga_default_keyframe_def(void);
// A free fold: no stiffness, no yielding.
RUGA_API ruga_crease_def ruga_default_crease_def(void);

typedef enum ruga_outcome {
    RUGA_OUTCOME_MINIMUM = 0,       // converged, certified by the inertia
    RUGA_OUTCOME_SADDLE = 1,        // residual small, but a direction of negative curvature is left
    RUGA_OUTCOME_NOT_CONVERGED = 2, // the residual is above the tolerance
    RUGA_OUTCOME_MOTION = 3         // dynamic motion, which seeks no equilibrium
} ruga_outcome;

// What one step did. Not converged is data, not an error: look at outcome.
typedef struct ruga_report {
    ruga_outcome outcome;
    int newton_iterations;
    int linear_iterations;
    int factorizations;
    int substeps;               // parts that the step was split into so as not to jump past onset
    double residual_shell;      // relative, as in tolerance
    double residual_coupled;    // relative; 0 where the interior is prescribed
    double constraint_residual; // |H x - H B q| / |H B q|
    double energy_membrane, energy_bending, energy_foundation, energy_interior, energy_kinetic,
        energy_external, energy_hinge; // J
    double seconds_total, seconds_interior, seconds_assembly, seconds_factor, seconds_solve, seconds_other;
} ruga_report;

// Called now and then during long work: stage, and how much of it is done, in [0, 1]. Return false to stop;
// the call in progress then ends with RUGA_CANCELLED.
typedef bool ruga_progress_function(const char* stage, double done, void* context);

#ifdef __cplusplus
}
#endif
#endif
