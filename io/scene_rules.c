// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What one key of a scene demands of another.
#include "io/scene_read.h"

#include <stdio.h>
#include <string.h>

static bool is_zero(const double v[3]) {
    return v[0] == 0 && v[1] == 0 && v[2] == 0;
}

// Which one of `names` (ended by NULL) the map has. RUGA_BAD_INPUT where there is not exactly one.
static ruga_status exactly_one(const ruga_yaml_node* map, const char* shown, const char* const* names,
                               int* which) {
    *which = -1;
    char list[160] = "";
    for (int i = 0; names[i]; i++) {
        size_t used = strlen(list);
        (void)snprintf(list + used, sizeof list - used, "%s%s", i == 0 ? "" : ", ", names[i]);
        const ruga_yaml_node* node = ruga_yaml_find(map, names[i]);
        if (node && *which >= 0) {
            return ruga_yaml_fail(node, shown, "%s and %s are both given; keep one of them", names[*which],
                                  names[i]);
        }
        *which = node ? i : *which;
    }
    return *which >= 0 ? RUGA_OK : ruga_yaml_fail(map, shown, "one of these keys is needed: %s", list);
}

static ruga_status check_source(const ruga_yaml_node* mesh) {
    static const char* const kinds[] = {"file", "make", NULL};
    int which;
    RUGA_TRY(exactly_one(mesh, "mesh", kinds, &which));
    if (which == 0) {
        return RUGA_OK;
    }
    const ruga_yaml_node* unit = ruga_yaml_find(mesh, "unit");
    if (unit) {
        return ruga_yaml_fail(unit, "mesh.unit",
                              "a made shape is in metres; write units into its size and edge");
    }
    const ruga_yaml_node* make = ruga_yaml_find(mesh, "make");
    const ruga_yaml_node* cells = ruga_yaml_find(make, "cells");
    return cells && ruga_yaml_find(make, "edge")
               ? ruga_yaml_fail(cells, "mesh.make", "edge and cells are both given; keep one of them")
               : RUGA_OK;
}

static ruga_status check_interior(const ruga_yaml_node* root, const ruga_model_def* def) {
    const ruga_yaml_node* interior = ruga_yaml_find(root, "interior");
    const ruga_yaml_node* prescribed = ruga_yaml_find(root, "prescribed");
    const ruga_interior_motion motion = def->interior.motion;
    const ruga_yaml_node* given = ruga_yaml_find(interior, "motion");
    const ruga_yaml_node* follow = ruga_yaml_find(root, "follow");
    if (follow && prescribed) {
        return ruga_yaml_fail(follow, "follow", "prescribed is given too; keep one of them");
    }
    if (follow && motion != RUGA_INTERIOR_PRESCRIBED) {
        return ruga_yaml_fail(
            follow, "follow",
            "a moving surface drives a prescribed interior only; write interior.motion: prescribed, or "
            "leave the key out");
    }
    if (motion == RUGA_INTERIOR_PRESCRIBED && def->keyframe_count == 0 && !follow) {
        return ruga_yaml_fail(
            given ? given : prescribed, given ? "interior.motion" : "prescribed",
            "prescribed motion needs at least one keyframe: prescribed: [{time: 0 s, ...}], or a surface to "
            "follow: follow: {file: body.pc2}");
    }
    if (motion != RUGA_INTERIOR_PRESCRIBED && prescribed) {
        return ruga_yaml_fail(
            prescribed, "prescribed",
            "keyframes have no effect with interior.motion: %s; write interior.motion: prescribed, "
            "or leave prescribed out",
            motion == RUGA_INTERIOR_DYNAMIC ? "dynamic" : "quasistatic");
    }
    if (motion == RUGA_INTERIOR_DYNAMIC && !(def->interior.density > 0)) {
        const ruga_yaml_node* density = ruga_yaml_find(interior, "density");
        return ruga_yaml_fail(
            density ? density : root, "interior.density",
            "dynamic motion needs a density above 0; or write interior.motion: quasistatic");
    }
    return RUGA_OK;
}

static ruga_status check_coupling(const ruga_yaml_node* root, const ruga_coupling_def* coupling) {
    if ((coupling->radius > 0) == (coupling->sigma > 0)) {
        return RUGA_OK;
    }
    const ruga_yaml_node* section = ruga_yaml_find(root, "coupling");
    const char* key = coupling->radius > 0 ? "radius" : "sigma";
    return ruga_yaml_fail(ruga_yaml_find(section, key), "coupling",
                          "%s is given without %s; give both above 0, or neither", key,
                          coupling->radius > 0 ? "sigma" : "radius");
}

static ruga_status check_keyframes(const ruga_yaml_node* list, ruga_keyframe_def* keyframe, int count) {
    const ruga_yaml_node* node = list ? list->first : NULL;
    for (int i = 0; i < count; i++, node = node->next) {
        char shown[40];
        (void)snprintf(shown, sizeof shown, "prescribed.%d", i);
        const ruga_yaml_node* matrix = ruga_yaml_find(node, "matrix");
        if (matrix && ruga_yaml_find(node, "stretch")) {
            return ruga_yaml_fail(matrix, shown, "stretch and matrix are both given; keep one of them");
        }
        if (i > 0 && !(keyframe[i].time > keyframe[i - 1].time)) {
            const ruga_yaml_node* time = ruga_yaml_find(node, "time");
            return ruga_yaml_fail(time ? time : node, shown,
                                  "its time of %g s is not later than the %g s before it", keyframe[i].time,
                                  keyframe[i - 1].time);
        }
        const ruga_yaml_node* bump = ruga_yaml_find(node, "bump");
        keyframe[i].has_bump = bump != NULL;
        if (bump && is_zero(keyframe[i].bump_direction)) {
            return ruga_yaml_fail(bump, shown, "the bump's direction has no length");
        }
    }
    return RUGA_OK;
}

static ruga_status check_region(const ruga_yaml_node* node, const char* shown, ruga_region* region) {
    static const char* const names[] = {"box", "sphere", "plane", "group", "vertices", "all", NULL};
    static const ruga_region_kind kinds[] = {RUGA_REGION_BOX,   RUGA_REGION_SPHERE,   RUGA_REGION_PLANE,
                                             RUGA_REGION_GROUP, RUGA_REGION_VERTICES, RUGA_REGION_ALL};
    if (node->kind == RUGA_YAML_SCALAR) {
        region->kind = RUGA_REGION_ALL;
        return RUGA_OK;
    }
    int which;
    RUGA_TRY(exactly_one(node, shown, names, &which));
    region->kind = kinds[which];
    const ruga_yaml_node* given = ruga_yaml_find(node, names[which]);
    for (int axis = 0; region->kind == RUGA_REGION_BOX && axis < 3; axis++) {
        if (region->min[axis] > region->max[axis]) {
            return ruga_yaml_fail(given, shown,
                                  "the box is empty along %c: %g m to %g m; the smaller corner stands first",
                                  "xyz"[axis], region -> min[axis], region -> max[axis]);
        }
    }
    return region->kind == RUGA_REGION_PLANE && is_zero(region->normal)
               ? ruga_yaml_fail(given, shown, "the plane's normal has no length")
               : RUGA_OK;
}

static ruga_status check_hold(const ruga_yaml_node* node, const char* shown, const ruga_handle_def* handle,
                              bool has_interior) {
    const ruga_yaml_node* hold = ruga_yaml_find(node, "hold");
    if (!hold) {
        return RUGA_OK;
    }
    if (handle->kind != RUGA_HANDLE_FIX && handle->kind != RUGA_HANDLE_MOVE) {
        return ruga_yaml_fail(hold, shown, "hold belongs to fix and move; forces act on the skin");
    }
    return !has_interior && handle->hold == RUGA_HOLD_INTERIOR
               ? ruga_yaml_fail(hold, shown, "there is nothing to hold with interior: none")
               : RUGA_OK;
}

static ruga_status check_handle(const ruga_yaml_node* node, const char* shown, bool has_interior,
                                ruga_handle_def* handle) {
    static const char* const actions[] = {"fix", "move", "press", "force", "line_force", NULL};
    static const ruga_handle_kind kinds[] = {RUGA_HANDLE_FIX, RUGA_HANDLE_MOVE, RUGA_HANDLE_PRESS,
                                             RUGA_HANDLE_FORCE, RUGA_HANDLE_LINE_FORCE};
    int which;
    RUGA_TRY(exactly_one(node, shown, actions, &which));
    handle->kind = kinds[which];
    char region[48];
    (void)snprintf(region, sizeof region, "%s.region", shown);
    RUGA_TRY(check_region(ruga_yaml_find(node, "region"), region, &handle->region));
    RUGA_TRY(check_hold(node, shown, handle, has_interior));

    const ruga_yaml_node* during = ruga_yaml_find(node, "during");
    handle->ramped = during != NULL;
    if (during && handle->kind == RUGA_HANDLE_FIX) {
        return ruga_yaml_fail(during, shown, "fix holds at all times; during has no effect on it");
    }
    if (during && handle->during[1] < handle->during[0]) {
        return ruga_yaml_fail(during, shown, "during ends at %g s, before it begins at %g s",
                              handle->during[1], handle->during[0]);
    }
    const ruga_yaml_node* rotate = ruga_yaml_find(ruga_yaml_find(node, "move"), "rotate");
    return rotate && handle->rotate_angle != 0 && is_zero(handle->rotate_axis)
               ? ruga_yaml_fail(rotate, shown, "the axis of the rotation has no length")
               : RUGA_OK;
}

// A region alone sets one value; whatever goes from one to another needs both.
static ruga_status check_vary(const ruga_yaml_node* node, const char* shown, ruga_scene_vary* vary) {
    static const char* const grades[] = {"gradient", "attribute", "texture", NULL};
    static const char* const places[] = {"region", "gradient", "attribute", "texture", NULL};
    static const char* const values[RUGA_VARY_VALUES] = {"thickness", "young", "growth_u", "growth_v"};
    const ruga_yaml_node* region = ruga_yaml_find(node, "region");
    int which, count = 0;
    bool graded = vary->attribute || vary->texture || ruga_yaml_find(node, "gradient");
    RUGA_TRY(exactly_one(node, shown, graded ? grades : places, &which));
    if (region) {
        char path[48];
        (void)snprintf(path, sizeof path, "%.40s.region", shown);
        RUGA_TRY(check_region(region, path, &vary->region));
    }
    vary->has_gradient = ruga_yaml_find(node, "gradient") != NULL;
    if (vary->has_gradient && memcmp(vary->from, vary->to, sizeof vary->from) == 0) {
        return ruga_yaml_fail(ruga_yaml_find(node, "gradient"), shown, "the gradient ends where it begins");
    }
    for (int i = 0; i < RUGA_VARY_VALUES; i++) {
        const ruga_yaml_node* value = ruga_yaml_find(node, values[i]);
        count += value != NULL;
        if (value && vary->value[i].count != (graded ? 2 : 1)) {
            return ruga_yaml_fail(
                value, shown,
                graded ? "%s needs two values here: [first, second] of the %s"
                       : "%s takes one value in a region; two go with gradient, attribute or texture",
                values[i], graded ? grades[which] : "");
        }
    }
    return count > 0 ? RUGA_OK
                     : ruga_yaml_fail(node, shown,
                                      "there is nothing that it sets: thickness, young, growth_u, growth_v");
}

static ruga_status check_values(const ruga_yaml_node* hinge, const char* shown, const char* key,
                                const ruga_scene_points* values, int points) {
    const ruga_yaml_node* node = ruga_yaml_find(hinge, key);
    if (!node || node->kind != RUGA_YAML_LIST || values->count == points) {
        return RUGA_OK;
    }
    return points > 0 ? ruga_yaml_fail(node, shown, "%s has %d values, but the curve has %d points", key,
                                       values->count, points)
                      : ruga_yaml_fail(node, shown,
                                       "%s takes one value here; one for each point goes with polyline, "
                                       "uv or vertices",
                                       key);
}

static ruga_status check_keys_of_hinge(const ruga_yaml_node* hinge, const char* shown,
                                       const ruga_scene_crease* crease) {
    static const char* const values[] = {"angle", "scale", NULL};
    const ruga_yaml_node* list = ruga_yaml_find(hinge, "animate");
    const ruga_yaml_node* node = list ? list->first : NULL;
    for (int k = 0; k < crease->key_count; k++, node = node->next) {
        char path[80];
        int which;
        (void)snprintf(path, sizeof path, "%.40s.animate.%d", shown, k);
        RUGA_TRY(exactly_one(node, path, values, &which));
        if (k > 0 && !(crease->keys[k].time > crease->keys[k - 1].time)) {
            return ruga_yaml_fail(node, path, "its time of %g s is not later than the %g s before it",
                                  crease->keys[k].time, crease->keys[k - 1].time);
        }
    }
    return RUGA_OK;
}

static ruga_status check_crease(const ruga_yaml_node* node, const char* shown,
                                const ruga_scene_crease* crease) {
    static const char* const kinds[] = {"fold", "svg", "polyline", "uv", "vertices", "group", "stress", NULL};
    const ruga_yaml_node *curve = ruga_yaml_find(node, "curve"), *hinge = ruga_yaml_find(node, "hinge");
    char path[48];
    int which;
    (void)snprintf(path, sizeof path, "%.30s.curve", shown);
    RUGA_TRY(exactly_one(curve, path, kinds, &which));
    bool drawn = which == 2 || which == 3;
    int points = which == 2   ? crease->polyline.count
                 : which == 3 ? crease->uv.count
                 : which == 4 ? crease->path.vertex_count
                              : 0;
    if (crease->closed && !drawn) {
        return ruga_yaml_fail(ruga_yaml_find(curve, "closed"), path, "closed belongs to polyline and uv");
    }
    if (ruga_yaml_find(curve, "frame") && which != 0) {
        return ruga_yaml_fail(ruga_yaml_find(curve, "frame"), path, "frame belongs to fold");
    }
    (void)snprintf(path, sizeof path, "%.30s.hinge", shown);
    if (crease->cut && hinge) {
        return ruga_yaml_fail(hinge, path, "a cut has no hinge");
    }
    if (ruga_yaml_find(hinge, "stiffness") && ruga_yaml_find(hinge, "length")) {
        return ruga_yaml_fail(hinge, path, "stiffness and length are both given; keep one of them");
    }
    for (int k = 0; k < 2 && !ruga_yaml_find(hinge, "yield"); k++) {
        const char* name = k ? "hardening" : "rate";
        if (ruga_yaml_find(hinge, name)) {
            return ruga_yaml_fail(ruga_yaml_find(hinge, name), path, "%s says nothing without yield", name);
        }
    }
    if (crease->rest.word && which > 1 && which != 6) {
        return ruga_yaml_fail(ruga_yaml_find(hinge, "rest"), path,
                              "assigned angles belong to fold, svg and stress");
    }
    RUGA_TRY(check_values(hinge, path, "stiffness", &crease->stiffness, points));
    RUGA_TRY(check_values(hinge, path, "rest", &crease->rest, points));
    return check_keys_of_hinge(hinge, path, crease);
}

static ruga_status check_creases(const ruga_yaml_node* root, const ruga_scene_parts* parts) {
    const ruga_yaml_node* list = ruga_yaml_find(root, "creases");
    const ruga_yaml_node* node = list ? list->first : NULL;
    for (int i = 0; i < parts->crease_count; i++, node = node->next) {
        char shown[32];
        (void)snprintf(shown, sizeof shown, "creases.%d", i);
        RUGA_TRY(check_crease(node, shown, &parts->crease[i]));
    }
    return RUGA_OK;
}

static ruga_status check_skin(const ruga_yaml_node* root, const ruga_model_def* def) {
    const ruga_yaml_node* skin = ruga_yaml_find(root, "skin");
    if (def->skin.motion == RUGA_SKIN_DYNAMIC && def->has_interior) {
        return ruga_yaml_fail(ruga_yaml_find(skin, "motion"), "skin.motion", "dynamic needs interior: none");
    }
    return def->skin.model == RUGA_SKIN_SPRINGS && def->has_interior
               ? ruga_yaml_fail(ruga_yaml_find(skin, "model"), "skin.model", "springs needs interior: none")
               : RUGA_OK;
}

ruga_status ruga_scene_check_keys(const ruga_yaml_node* root, ruga_scene_parts* parts, ruga_model_def* def) {
    RUGA_TRY(check_source(ruga_yaml_find(root, "mesh")));
    RUGA_TRY(check_skin(root, def));
    RUGA_TRY(check_creases(root, parts));
    const ruga_yaml_node* varies = ruga_yaml_find(ruga_yaml_find(root, "skin"), "vary");
    const ruga_yaml_node* entry = varies ? varies->first : NULL;
    for (int i = 0; i < parts->vary_count; i++, entry = entry->next) {
        char shown[40];
        (void)snprintf(shown, sizeof shown, "skin.vary.%d", i);
        RUGA_TRY(check_vary(entry, shown, &parts->vary[i]));
    }
    if (def->has_interior) {
        RUGA_TRY(check_interior(root, def));
        RUGA_TRY(check_coupling(root, &def->coupling));
        // Both arrays are the scene's own; the def only promises not to change them.
        RUGA_TRY(check_keyframes(ruga_yaml_find(root, "prescribed"), (ruga_keyframe_def*)def->keyframes,
                                 def->keyframe_count));
    }
    const ruga_yaml_node* list = ruga_yaml_find(root, "handles");
    const ruga_yaml_node* node = list ? list->first : NULL;
    for (int i = 0; i < def->handle_count; i++, node = node->next) {
        char shown[32];
        (void)snprintf(shown, sizeof shown, "handles.%d", i);
        RUGA_TRY(check_handle(node, shown, def->has_interior, (ruga_handle_def*)&def->handles[i]));
    }
    return RUGA_OK;
}
