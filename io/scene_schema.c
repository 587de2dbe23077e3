// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The table of keys, in the order in which `explain` and docs/scene.md show them.
#include "io/scene_schema.h"

#include <math.h>
#include <stddef.h>

// clang-format off
#define REQUIRED RUGA_KEY_REQUIRED
#define ANY         {-INFINITY, INFINITY, true, true}
#define POSITIVE    {0, INFINITY, true, true}
#define PART        {0, 1, true, false}
#define NOT_NEGATIVE {0, INFINITY, false, true}
#define POISSON     {-1, 0.5, true, true}
#define IN(type, field) (int)offsetof(type, field)
#define MODEL(field)    IN(ruga_model_def, field)
#define SOURCE(field)   IN(ruga_scene_source, field)
#define HANDLE(field)   IN(ruga_handle_def, field)
#define KEYFRAME(field) IN(ruga_keyframe_def, field)
#define FOLLOW(field)   IN(ruga_scene_follow, field)
#define VARY(field)     IN(ruga_scene_vary, field)
#define CREASE(field)   IN(ruga_scene_crease, field)

#define SECTION(path, fallback, meaning) {path, RUGA_KEY_SECTION, 0, -1, "", fallback, ANY, NULL, meaning}
#define ENTRIES(path, fallback, meaning) {path, RUGA_KEY_ENTRIES, 0, -1, "", fallback, ANY, NULL, meaning}
#define NUMBER(path, offset, dimension, fallback, range, meaning) \
    {path, RUGA_KEY_NUMBERS, 1, offset, dimension, fallback, range, NULL, meaning}
#define NUMBERS(path, count, offset, dimension, fallback, range, meaning) \
    {path, RUGA_KEY_NUMBERS, count, offset, dimension, fallback, range, NULL, meaning}
#define ROWS(path, count, offset, dimension, meaning) \
    {path, RUGA_KEY_ROWS, count, offset, dimension, NULL, ANY, NULL, meaning}
#define INTEGERS(path, count, offset, fallback, low, high, meaning) \
    {path, RUGA_KEY_INTEGERS, count, offset, "", fallback, {low, high, false, false}, NULL, meaning}
#define FLAG(path, offset, fallback, meaning) {path, RUGA_KEY_FLAG, 1, offset, "", fallback, ANY, NULL, meaning}
#define CHOICE(path, offset, fallback, choices, meaning) \
    {path, RUGA_KEY_CHOICE, 1, offset, "", fallback, ANY, choices, meaning}
#define OTHER(path, kind, offset, dimension, fallback, meaning) \
    {path, kind, 1, offset, dimension, fallback, ANY, NULL, meaning}
#define POINTS(path, count, offset, dimension, meaning) \
    {path, RUGA_KEY_POINTS, count, offset, dimension, NULL, ANY, NULL, meaning}
#define VALUES(path, offset, dimension, fallback, range, word, meaning) \
    {path, RUGA_KEY_VALUES, 1, offset, dimension, fallback, range, word, meaning}
#define PAIR(path, offset, dimension, range, meaning) \
    {path, RUGA_KEY_PAIR, 1, offset, dimension, NULL, range, NULL, meaning}

// The keys of a region; IN_ENTRY gives the offset of a field of the entry that has it.
#define REGION(path, IN_ENTRY) \
    ROWS(path ".box", 2, IN_ENTRY(region.min), "m", "Two opposite corners, the smaller one first."), \
    SECTION(path ".sphere", NULL, "What lies within `radius` of `center`."), \
    NUMBERS(path ".sphere.center", 3, IN_ENTRY(region.center), "m", "[0, 0, 0]", ANY, "Centre."), \
    NUMBER(path ".sphere.radius", IN_ENTRY(region.radius), "m", REQUIRED, POSITIVE, "Radius."), \
    SECTION(path ".plane", NULL, "What lies on the plane or on the side that its normal points to."), \
    NUMBERS(path ".plane.center", 3, IN_ENTRY(region.center), "m", "[0, 0, 0]", ANY, "A point of the plane."), \
    NUMBERS(path ".plane.normal", 3, IN_ENTRY(region.normal), "1", REQUIRED, ANY, "Normal, of any length but 0."), \
    OTHER(path ".group", RUGA_KEY_TEXT, IN_ENTRY(region.group), "", NULL, "The faces of a group of the mesh."), \
    OTHER(path ".vertices", RUGA_KEY_VERTICES, IN_ENTRY(region), "", NULL, \
          "Vertices by their number in the file, from 0; for a made shape, of the mesh itself."), \
    OTHER(path ".all", RUGA_KEY_EVERY, -1, "", NULL, "true: everything.")
// clang-format on

const ruga_key ruga_keys[] = {
    INTEGERS("ruga", 1, -1, "1", 1, 1, "Version of the scene format; there is only this one."),

    SECTION("mesh", REQUIRED, "The surface: either `file` or `make`."),
    OTHER("mesh.file", RUGA_KEY_TEXT, SOURCE(file), "", NULL,
          "A surface file (.obj .ply .stl .off .gltf .glb), relative to the scene file's folder. Of a crease "
          "pattern "
          "(.fold .svg) what lies within its outline, in triangles that know nothing of the creases: with "
          "`remesh`."),
    SECTION("mesh.make", NULL, "A shape made on the spot, in metres, centred at the origin."),
    CHOICE("mesh.make.shape", SOURCE(make.shape), "pillow", "sheet|slab|bar|pillow|sphere|skirt",
           "What is made; sheet and skirt lie in z = 0 with normals +z, the others are closed."),
    OTHER("mesh.make.size", RUGA_KEY_SIZE, SOURCE(make.size), "m", "0.5 m",
          "Outer size. sheet: X, Y; slab, bar: X, Y, Z; pillow: X, Y, Z (missing Y = X, Z = 0.3 X); sphere: "
          "diameter; skirt: inner radius, outer radius, angle."),
    NUMBER("mesh.make.edge", SOURCE(make.edge), "m", "10 mm", POSITIVE,
           "Length of an edge; the nearest that fits is taken. Not together with `cells`."),
    INTEGERS("mesh.make.cells", 2, SOURCE(make.cells), "(by edge)", 1, 100000,
             "Number of quads along X and Y, or around and across, in place of `edge`."),
    CHOICE("mesh.make.pattern", SOURCE(make.pattern), "equilateral", "equilateral|diagonal|alternating",
           "How the triangles lie."),
    INTEGERS("mesh.frame", 1, SOURCE(frame), "0", 0, 1000000, "The frame of a FOLD file."),
    OTHER("mesh.unit", RUGA_KEY_UNIT, SOURCE(unit), "m", "m",
          "The unit of length of the file's coordinates, such as mm or inch. A result above 100 m or below 1 "
          "mm "
          "gives a warning."),
    NUMBER("mesh.scale", SOURCE(scale), "1", "1", POSITIVE, "A factor on all coordinates, beside `unit`."),
    OTHER("mesh.groups", RUGA_KEY_TEXTS, SOURCE(groups), "", "(all)",
          "Only the faces of these groups of the file are simulated."),
    SECTION("mesh.remesh", "(none)", "Isotropic remeshing before the simulation."),
    NUMBER("mesh.remesh.edge", SOURCE(remesh_edge), "m", REQUIRED, POSITIVE,
           "Length of an edge of the new mesh."),

    SECTION("skin", "{}", "The thin shell."),
    CHOICE(
        "skin.model", MODEL(skin.model), "shell", "shell|springs|volume",
        "shell: a thin shell. volume: thin stiff elements of a volume that is fine throughout, "
        "`lattice.cells` "
        "along its longest side and graded in depth; a flat rectangular sheet in a plane of z with `fill: "
        "box` and "
        "prescribed stretches only. `coupling` says nothing then. springs: cloth of linear, bending and "
        "axial-bending springs with the stiffness of the shell but Poisson's ratio 1/3, in dynamic motion."),
    NUMBER("skin.thickness", MODEL(skin.thickness), "m", "2 mm", POSITIVE, "Thickness h."),
    NUMBER("skin.young", MODEL(skin.young), "Pa", "40 MPa", POSITIVE, "Young's modulus."),
    NUMBER("skin.poisson", MODEL(skin.poisson), "1", "0.3", POISSON, "Poisson's ratio."),
    NUMBER("skin.density", MODEL(skin.density), "kg/m^3", "900 kg/m^3", NOT_NEGATIVE, "Density."),
    CHOICE("skin.membrane", MODEL(skin.membrane), "baraff-witkin", "baraff-witkin|stvk",
           "Stretching energy: Baraff-Witkin or St Venant-Kirchhoff; the same at small strain."),
    CHOICE(
        "skin.bending", MODEL(skin.bending), "hinge", "hinge|kirchhoff-love",
        "Bending energy. hinge: an angle at each edge, as the 2013 paper; exact for cylinders on equilateral "
        "triangles, but 5 to 20 % too stiff on irregular ones, and with Poisson's ratio -1/3 whatever "
        "`poisson`. kirchhoff-love: directors at the middles of edges, right on any mesh and for any "
        "curvature, "
        "at three to four times the time."),
    NUMBERS("skin.growth", 2, MODEL(skin.growth), "1", "[1, 1]", POSITIVE,
            "Rest lengths along and across the skin's first direction are multiplied by these."),
    CHOICE(
        "skin.motion", MODEL(skin.motion), "static", "static|damped|dynamic",
        "static: the skin is in equilibrium at each frame. damped: drawn towards the skin that the interior "
        "carries along, over the time `relaxation`. dynamic: with mass, in time; needs `interior: none`."),
    NUMBER("skin.relaxation", MODEL(skin.relaxation), "s", "20 ms", POSITIVE,
           "Relaxation time of damped motion."),
    NUMBER("skin.damping", MODEL(skin.damping), "s", "0 s", NOT_NEGATIVE,
           "Of dynamic motion: the viscous stress over the elastic stress of the strain rate. A mode of "
           "frequency w "
           "loses the part w damping / 2 of critical damping."),
    NUMBER("skin.drag", MODEL(skin.drag), "1/s", "0 1/s", NOT_NEGATIVE,
           "Of dynamic motion: the force over the momentum with which the air around holds every part back."),
    CHOICE("skin.creases", MODEL(skin.creases), "angle", "angle|pairs|across",
           "Hinges of creases. angle: signed springs against the fold angle. In dynamic motion also the 2015 "
           "paper's springs, "
           "which do not tell valley from mountain. pairs: between nodes and their virtual copies; their "
           "stiffness falls "
           "with cos^2 of half the rest angle. across: bending and axial-bending springs across the crease."),
    ENTRIES("skin.vary", "(none)",
            "Where the skin differs from the values above: each entry with a region, or one of gradient, "
            "attribute, texture (in a region, or everywhere), and with one or more of thickness, young, "
            "growth_u, growth_v. Of several at one place the last counts. Values belong to vertices and "
            "are linear in between."),
    SECTION("skin.vary.N.region", NULL,
            "A part of the rest shape, as in handles; there each value is one number, unless one of the "
            "three below says how far it is from its first to its second."),
    REGION("skin.vary.N.region", VARY),
    SECTION("skin.vary.N.gradient", NULL,
            "From the first value to the second along a straight line, held before and behind it."),
    NUMBERS("skin.vary.N.gradient.from", 3, VARY(from), "m", REQUIRED, ANY, "Where the first value holds."),
    NUMBERS("skin.vary.N.gradient.to", 3, VARY(to), "m", REQUIRED, ANY, "Where the second value holds."),
    OTHER("skin.vary.N.attribute", RUGA_KEY_TEXT, VARY(attribute), "", NULL,
          "A property of the vertices of a .ply file by its name: the first value where it is 0, the "
          "second where it is 1, and on beyond. So thickness: [0, 1 mm] takes it as a thickness in mm."),
    OTHER("skin.vary.N.texture", RUGA_KEY_TEXT, VARY(texture), "", NULL,
          "A greyscale PNG of 8 or 16 bits, relative to the scene file's folder, over the mesh's uv (0, 0 "
          "at the lower left, of glTF at the upper left; held outside): the first value where it is black, "
          "the second where it is white."),
    PAIR("skin.vary.N.thickness", VARY(value[0]), "m", NOT_NEGATIVE, "Thickness."),
    PAIR("skin.vary.N.young", VARY(value[1]), "Pa", NOT_NEGATIVE, "Young's modulus."),
    PAIR("skin.vary.N.growth_u", VARY(value[2]), "1", NOT_NEGATIVE,
         "Growth along the skin's first direction."),
    PAIR("skin.vary.N.growth_v", VARY(value[3]), "1", NOT_NEGATIVE, "Growth across it."),

    SECTION("interior", "{}", "The solid inside, or the word none for a free shell."),
    NUMBER("interior.young", MODEL(interior.young), "Pa", "0.5 MPa", POSITIVE, "Young's modulus."),
    NUMBER("interior.poisson", MODEL(interior.poisson), "1", "0.3", POISSON, "Poisson's ratio."),
    NUMBER("interior.density", MODEL(interior.density), "kg/m^3", "60 kg/m^3", NOT_NEGATIVE,
           "Density; above 0 where the motion is dynamic."),
    NUMBER("interior.damping", MODEL(interior.damping), "1/s", "0 1/s", NOT_NEGATIVE,
           "Rate of velocity-proportional damping."),
    CHOICE(
        "interior.motion", MODEL(interior.motion), "dynamic", "dynamic|quasistatic|prescribed",
        "dynamic: implicit Euler. quasistatic: interior and skin in equilibrium together. prescribed: by the "
        "keyframes of `prescribed`, which is also the default where those are given."),

    SECTION("lattice", "{}", "The hexahedral elements of the interior."),
    INTEGERS("lattice.cells", 1, MODEL(lattice.cells), "6", 1, 1000,
             "Number of cells along the longest side."),
    INTEGERS("lattice.degree", 1, MODEL(lattice.degree), "2", 1, 2,
             "2: quadratic B-splines, continuous in slope. 1: trilinear."),
    CHOICE(
        "lattice.fill", MODEL(lattice.fill), "mesh", "mesh|box",
        "mesh: what the closed surface encloses is material. box: the whole box of cells is; an open sheet "
        "lies on its top face, at the side of its normals."),
    NUMBER("lattice.depth", MODEL(lattice.depth), "m", "0 m", NOT_NEGATIVE,
           "Depth of the box below an open sheet with `fill: box`; 0 = one cell, or two wavelengths with "
           "`skin.model: volume`."),

    SECTION("coupling", "{}", "What ties skin and interior together."),
    CHOICE(
        "coupling.kind", MODEL(coupling.kind), "clusters", "clusters|spectral|none",
        "Low-pass constraints by Gaussian clusters or by eigenvectors of the mesh's Laplacian. none without "
        "`foundation`: the skin goes where the interior takes it."),
    CHOICE(
        "coupling.rule", MODEL(coupling.rule), "calibrated", "calibrated|paper",
        "How cluster size follows from the wavelength: so that the predicted wavelength comes out, or by the "
        "letter of the 2013 paper."),
    FLAG("coupling.foundation", MODEL(coupling.foundation), "true",
         "Whether the interior also resists what the lattice cannot represent."),
    INTEGERS("coupling.count", 1, MODEL(coupling.count), "0", 0, 1000000,
             "Number of clusters or of eigenvectors; 0 = by the rule."),
    NUMBER(
        "coupling.radius", MODEL(coupling.radius), "m", "0 m", NOT_NEGATIVE,
        "Largest distance of a vertex to its cluster's centre; 0 = by the rule. Only together with `sigma`."),
    NUMBER("coupling.sigma", MODEL(coupling.sigma), "m", "0 m", NOT_NEGATIVE,
           "Width of the Gaussian; 0 = by the rule. Only together with `radius`."),

    ENTRIES(
        "prescribed", "(none)",
        "Keyframes of the interior's motion, x -> matrix (x - c) + c + translate about the mesh's centre c, "
        "then the bump; linear in between, held outside."),
    NUMBER("prescribed.N.time", KEYFRAME(time), "s", "0 s", ANY,
           "Time; each keyframe is later than the one before."),
    {"prescribed.N.stretch", RUGA_KEY_STRETCH, 3, KEYFRAME(matrix), "1", "[1, 1, 1]", POSITIVE, NULL,
     "Stretch along x, y and z. Not together with `matrix`."},
    ROWS("prescribed.N.matrix", 3, KEYFRAME(matrix), "1", "Three rows of any linear map."),
    NUMBERS("prescribed.N.translate", 3, KEYFRAME(translate), "m", "[0, 0, 0]", ANY, "Displacement."),
    SECTION("prescribed.N.bump", "(none)",
            "A dent: depth exp(-r^2 / (2 radius^2)) along direction, r the distance to center."),
    NUMBERS("prescribed.N.bump.center", 3, KEYFRAME(bump_center), "m", "[0, 0, 0]", ANY,
            "Centre, on the rest shape."),
    NUMBER("prescribed.N.bump.radius", KEYFRAME(bump_radius), "m", REQUIRED, POSITIVE, "Radius."),
    NUMBER("prescribed.N.bump.depth", KEYFRAME(bump_depth), "m", REQUIRED, ANY, "Depth at the centre."),
    NUMBERS("prescribed.N.bump.direction", 3, KEYFRAME(bump_direction), "1", "[0, 0, -1]", ANY,
            "Direction, of any length but 0."),

    SECTION("follow", "(none)",
            "A moving surface that the interior follows, in place of `prescribed`: the lattice is fitted to "
            "each of its "
            "samples, linear in between, held outside."),
    OTHER("follow.file", RUGA_KEY_TEXT, FOLLOW(file), "", REQUIRED,
          "A point cache (.pc2, .mdd) of the mesh's file, or its .obj files, numbered from 0 or 1 by %d or "
          "%04d in the "
          "name; the same vertices in the same order, in the mesh's unit and scale."),
    NUMBER("follow.rate", FOLLOW(rate), "1/s", "24 1/s", POSITIVE,
           "Samples per second. Not for .mdd, which has times of its own."),
    NUMBER("follow.start", FOLLOW(start), "s", "0 s", ANY, "Time of the first sample."),
    NUMBER("follow.smoothness", FOLLOW(smoothness), "1", "1e-4", POSITIVE,
           "Weight of the lattice's second differences beside the mean square distance to the surface."),

    SECTION("time", "{}", "Frame k is at k times the step."),
    NUMBER("time.step", MODEL(step), "s", "20 ms", POSITIVE, "Time from frame to frame."),
    INTEGERS("time.frames", 1, MODEL(frames), "50", 1, 1000000,
             "Number of frames after frame 0, the start. The only key that may change for a resumed run."),
    SECTION("start", "{}", "How a skin with interior: none begins."),
    NUMBER("start.fold", MODEL(start.fold), "1", "0", ANY,
           "The flat panels between straight creases are turned by this part of the creases' rest angles at "
           "time 0, and "
           "the whole is laid as near to where it was as it goes. Refused where panels would have to bend."),
    NUMBER("start.cone", MODEL(start.cone), "rad", "0 rad", NOT_NEGATIVE,
           "In dynamic motion. Then a sector of the plane z = 0 about the origin that has this angle is "
           "rolled into a "
           "whole cone, its tip at the origin and its axis along -z. Its first panel stays where it was."),
    NUMBERS("start.velocity", 3, MODEL(start.velocity), "m/s", "[0, 0, 0]", ANY,
            "In dynamic motion. Velocity of what is not held."),
    NUMBERS("start.spin", 3, MODEL(start.spin), "rad/s", "[0, 0, 0]", ANY,
            "In dynamic motion. Angular velocity about the origin of what is not held, added to that."),
    NUMBERS("gravity", 3, MODEL(gravity), "m/s^2", "[0, 0, 0]", ANY, "Acceleration on skin and interior."),

    ENTRIES("handles", "(none)",
            "What holds, moves and loads the object: each with a region and one of fix, move, press, force, "
            "line_force."),
    SECTION("handles.N.region", REQUIRED,
            "A part of the rest shape, in metres after `unit` and `scale`: one of the keys below, or the "
            "word all."),
    REGION("handles.N.region", HANDLE),
    OTHER("handles.N.fix", RUGA_KEY_AXES, HANDLE(axes), "", NULL,
          "The region keeps its rest position: true, or only along these of [x, y, z]."),
    SECTION("handles.N.move", NULL, "The region is rotated, then translated."),
    NUMBERS("handles.N.move.translate", 3, HANDLE(translate), "m", "[0, 0, 0]", ANY,
            "Displacement at full ramp."),
    SECTION("handles.N.move.rotate", "(none)", "Rotation at full ramp."),
    NUMBERS("handles.N.move.rotate.axis", 3, HANDLE(rotate_axis), "1", "[0, 0, 1]", ANY,
            "Axis, of any length but 0."),
    NUMBER("handles.N.move.rotate.angle", HANDLE(rotate_angle), "rad", "0 deg", ANY, "Angle."),
    NUMBERS("handles.N.move.rotate.center", 3, HANDLE(rotate_center), "m", "[0, 0, 0]", ANY,
            "A point of the axis."),
    OTHER("handles.N.move.axes", RUGA_KEY_AXES, HANDLE(axes), "", "[x, y, z]",
          "Components that follow; the others stay free."),
    NUMBER("handles.N.press", HANDLE(pressure), "Pa", NULL, ANY,
           "Pressure along the inward normal of the deformed skin."),
    NUMBERS("handles.N.force", 3, HANDLE(force), "N", NULL, ANY,
            "Total force, spread over the region's area."),
    NUMBERS("handles.N.line_force", 3, HANDLE(force), "N/m", NULL, ANY,
            "Force per length along the region's boundary edges."),
    NUMBERS("handles.N.during", 2, HANDLE(during), "s", "(from the start)", ANY,
            "Grows linearly from the first time to the second, then stays."),
    CHOICE("handles.N.hold", HANDLE(hold), "both", "both|interior|skin", "What fix and move hold."),

    SECTION("solver", "{}", "How it is solved."),
    CHOICE("solver.method", MODEL(solver.method), "default", "default|newton|quasi-newton|paper",
           "The static solve; paper is the published method, for comparison."),
    CHOICE("solver.linear", MODEL(solver.linear), "direct", "direct|minres",
           "How Newton's linear systems are solved."),
    {"solver.tolerance",
     RUGA_KEY_NUMBERS,
     1,
     MODEL(solver.tolerance),
     "1",
     "1e-5",
     {0, 0.1, true, false},
     NULL,
     "Norm of the projected gradient over that of the single nodal forces below which a state is converged."},
    OTHER("solver.seed", RUGA_KEY_SEED, MODEL(solver.seed), "", "1", "Seed of all random numbers."),
    FLAG("solver.allow_coarse", MODEL(solver.allow_coarse), "false",
         "Whether to run with fewer than 3 edges per wavelength."),

    ENTRIES("creases", "(none)",
            "Curves about which the skin folds, or along which it is cut; docs/creases.md."),
    SECTION("creases.N.curve", REQUIRED,
            "Where: one of fold, svg, polyline, uv, vertices, group, stress. Points in metres in the mesh's "
            "frame after `unit` "
            "and `scale`, which also apply to fold and svg; what hangs over the border is trimmed."),
    OTHER("creases.N.curve.fold", RUGA_KEY_TEXT, CREASE(fold), "", NULL,
          "All creases of a FOLD file, relative to the scene file's folder; its cuts (C) are cut."),
    INTEGERS("creases.N.curve.frame", 1, CREASE(frame), "0", 0, 1000000, "The frame of the FOLD file."),
    OTHER("creases.N.curve.svg", RUGA_KEY_TEXT, CREASE(svg), "", NULL,
          "All creases of an SVG drawing, by the colour of their strokes; likewise."),
    POINTS("creases.N.curve.polyline", 3, CREASE(polyline), "m",
           "Two or more points, brought to the nearest place of the surface."),
    POINTS("creases.N.curve.uv", 2, CREASE(uv), "1", "Two or more points in the mesh's texture coordinates."),
    OTHER("creases.N.curve.vertices", RUGA_KEY_VERTICES, CREASE(path), "", NULL,
          "A path along edges: vertices by their number in the file, from 0; for a made shape, of the mesh "
          "itself."),
    OTHER("creases.N.curve.group", RUGA_KEY_TEXT, CREASE(group), "", NULL,
          "The border of a group of the mesh."),
    SECTION(
        "creases.N.curve.stress", NULL,
        "Along the ridges of a result, as `ruga creases` finds them; its surface at rest is to be this one."),
    OTHER("creases.N.curve.stress.result", RUGA_KEY_TEXT, CREASE(result), "", REQUIRED,
          "The result file, relative to the scene file's folder."),
    CHOICE("creases.N.curve.stress.from", CREASE(from), "stress", "bending|stress",
           "stress: ridges of the compressive stress. bending: of the bending energy."),
    INTEGERS("creases.N.curve.stress.frame", 1, CREASE(result_frame), "(the last)", 0, 1000000, "Its frame."),
    NUMBER("creases.N.curve.stress.min_length", CREASE(ridge.min_length), "m", "0 m", NOT_NEGATIVE,
           "Shorter curves are left out; 0 = ten edges."),
    NUMBER("creases.N.curve.stress.smooth", CREASE(ridge.smooth), "m", "0 m", NOT_NEGATIVE,
           "Width over which fields and curves are smoothed; 0 = three edges."),
    NUMBER("creases.N.curve.stress.strength", CREASE(ridge.strength), "1", "0.25", PART,
           "Least energy density or stress of a curve at its strongest place, as a part of the largest."),
    FLAG("creases.N.curve.closed", CREASE(closed), "false",
         "Whether the last point of polyline or uv is joined to the first."),
    FLAG("creases.N.cut", CREASE(cut), "false", "Whether the curve is cut and stays open, without a hinge."),
    CHOICE("creases.N.freedom", CREASE(freedom), "auto", "auto|single|full",
           "single: one hinge for the whole curve, right where it is straight and of one angle. full: what a "
           "mesh that "
           "conforms to the curve may do. auto: full where the curve bends, closes, meets another, or its "
           "values vary."),
    NUMBER("creases.N.start", CREASE(start), "s", "0 s", NOT_NEGATIVE,
           "When the crease comes: until then the sheet is not cut along it, then it is, as it lies and moves."),
    SECTION("creases.N.hinge", "{}",
            "The spring about the curve, k l / 2 (theta - rest)^2 for a length l of it."),
    VALUES("creases.N.hinge.stiffness", CREASE(stiffness), "N", "0.02 N", NOT_NEGATIVE, NULL,
           "k, in N m/rad for each m. One value, or one for each point of polyline, uv or vertices. More "
           "than 1,000 E h times the mean edge counts as that."),
    NUMBER("creases.N.hinge.length", CREASE(length), "m", NULL, POSITIVE,
           "In place of stiffness: k = E h^3 / (12 (1 - nu^2)) over this length."),
    VALUES("creases.N.hinge.rest", CREASE(rest), "rad", "(as the mesh has it)", ANY, "assigned",
           "Angle at which the spring has no moment: 0 when flat, positive for a valley, where both sides "
           "turn to where "
           "their normals point. assigned: that of the file, +180 deg for valleys and -180 deg for mountains "
           "where it "
           "has none."),
    NUMBER("creases.N.hinge.scale", CREASE(scale), "1", "1", ANY, "A factor on rest."),
    ENTRIES("creases.N.hinge.animate", "(none)",
            "The rest angle over time, linear in between and held outside: `angle`, or `scale` times rest."),
    NUMBER("creases.N.hinge.animate.N.time", IN(ruga_crease_key, time), "s", "0 s", ANY,
           "Time; each is later than the one before."),
    NUMBER("creases.N.hinge.animate.N.angle", IN(ruga_crease_key, angle), "rad", NULL, ANY, "Rest angle."),
    NUMBER("creases.N.hinge.animate.N.scale", IN(ruga_crease_key, scale), "1", NULL, ANY,
           "Rest angle as a part of rest and its scale."),
    NUMBER("creases.N.hinge.yield", CREASE(yield), "rad", "(never)", NOT_NEGATIVE,
           "Beyond this difference between angle and rest angle the rest angle follows."),
    NUMBER("creases.N.hinge.rate", CREASE(rate), "1/s", "(at once)", POSITIVE,
           "How fast it follows: its speed over the excess."),
    NUMBER("creases.N.hinge.hardening", CREASE(hardening), "1", "0", NOT_NEGATIVE,
           "Growth of the yield angle for each rad that the rest angle has followed."),
};
const int ruga_key_count = sizeof ruga_keys / sizeof ruga_keys[0];
