// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Springs of cloth (Bridson, Marino and Fedkiw 2003; Patkar, Jin and Fedkiw 2015, section 3):
//   d = sum_i w_i x_i,  E = k/2 (|d| - L)^2,  f_i = -w_i k (1 - L/|d|) d.
// Two nodes with the weights 1 and -1 are a linear or a bending spring; four, the two ends of an edge and the
// two corners across it, an axial-bending spring. The damping force is -time k w_i u (u . sum_j w_j v_j), u =
// d/|d|: both act along the line between the two means, so that momentum and angular momentum stay.
//
// All pulls first, then their sum for each node in the order of its list: the same bits for any number of
// threads.
#include "shell/springs.h"

#include "core/memory.h"
#include "core/parallel.h"
#include "core/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK = 1024 };

const int ruga_spring_width[RUGA_SPRING_WIDTHS] = {2, 4, 6};

void ruga_springs_clear(ruga_springs* springs) {
    for (int k = 0; k < RUGA_SPRING_WIDTHS; k++) {
        ruga_release(springs->list[k].node);
        ruga_release(springs->list[k].weight);
        ruga_release(springs->list[k].stiffness);
        ruga_release(springs->list[k].length);
        ruga_release(springs->list[k].scale);
        ruga_release(springs->list[k].label);
    }
    ruga_release(springs->spring);
    ruga_release(springs->start);
    ruga_release(springs->at);
    ruga_release(springs->share);
    ruga_release(springs->unit);
    ruga_release(springs->pull);
    ruga_release(springs->partial);
    *springs = (ruga_springs){0};
}

// ------------------------------------------------------------------------------- set-up

ruga_status ruga_springs_add(ruga_springs* springs, int count, const int* node, const double* weight,
                             double stiffness, double length, int label) {
    ruga_spring s = {.stiffness = stiffness, .length = length, .scale = 1, .label = label};
    for (int i = 0; i < count; i++) {
        int at = 0;
        while (at < s.count && s.node[at] != node[i]) {
            at++;
        }
        s.node[at] = node[i];
        s.weight[at] += weight[i];
        s.count += at == s.count;
    }
    int left = 0;
    for (int i = 0; i < s.count; i++) {
        s.node[left] = s.node[i];
        s.weight[left] = s.weight[i];
        left += s.weight[i] != 0;
    }
    s.count = left;
    if (s.count == 0) {
        return RUGA_OK;
    }
    if (s.count == 2) { // d may be turned, and its scale be put into the rest
        double scale = fabs(s.weight[0]);
        int a = s.node[0] < s.node[1] ? s.node[0] : s.node[1], b = s.node[0] + s.node[1] - a;
        s = (ruga_spring){2, {a, b}, {1, -1}, stiffness * scale * scale, length / scale, 1 / scale, label};
    }
    RUGA_TRY(RUGA_RESERVE(springs->spring, springs->capacity, springs->count + 1));
    springs->spring[springs->count++] = s;
    return RUGA_OK;
}

static int list_of(const ruga_spring* s) {
    return (s->count + 1) / 2 - 1;
}

static int compare(const void* a, const void* b) {
    const ruga_spring *p = a, *q = b;
    if (list_of(p) != list_of(q)) {
        return list_of(p) - list_of(q);
    }
    for (int i = 0; i < RUGA_SPRING_MOST; i++) {
        if (p->node[i] != q->node[i]) {
            return p->node[i] < q->node[i] ? -1 : 1;
        }
    }
    if (p->label != q->label) {
        return p->label < q->label ? -1 : 1;
    }
    return p->length < q->length ? -1 : p->length > q->length;
}

static void merge_equal(ruga_springs* springs) {
    int left = 0;
    qsort(springs->spring, (size_t)springs->count, sizeof *springs->spring, compare);
    for (int k = 0; k < springs->count; k++) {
        const ruga_spring* s = &springs->spring[k];
        bool same = left > 0 && s->count == 2 && s->label < 0 && compare(&springs->spring[left - 1], s) == 0;
        if (same) {
            springs->spring[left - 1].stiffness += s->stiffness;
        } else {
            springs->spring[left++] = *s;
        }
    }
    springs->count = left;
}

static ruga_status fill_lists(ruga_springs* springs) {
    for (int k = 0, next = 0; k < RUGA_SPRING_WIDTHS; k++) {
        ruga_spring_list* list = &springs->list[k];
        size_t width = (size_t)ruga_spring_width[k];
        list->first = next;
        while (next < springs->count && list_of(&springs->spring[next]) == k) {
            next++;
        }
        list->count = next - list->first;
        RUGA_TRY(RUGA_NEW(list->node, (size_t)list->count * width));
        RUGA_TRY(RUGA_NEW(list->weight, (size_t)list->count * width));
        RUGA_TRY(RUGA_NEW(list->stiffness, list->count));
        RUGA_TRY(RUGA_NEW(list->length, list->count));
        RUGA_TRY(RUGA_NEW(list->scale, list->count));
        RUGA_TRY(RUGA_NEW(list->label, list->count));
        for (int s = 0; s < list->count; s++) {
            const ruga_spring* from = &springs->spring[list->first + s];
            for (size_t i = 0; i < width; i++) { // one of three or five nodes has a last node of weight 0
                bool own = (int)i < from->count;
                list->node[(size_t)s * width + i] = from->node[own ? i : 0];
                list->weight[(size_t)s * width + i] = own ? from->weight[i] : 0;
            }
            list->stiffness[s] = from->stiffness;
            list->length[s] = from->length;
            list->scale[s] = from->scale;
            list->label[s] = from->label;
        }
    }
    return RUGA_OK;
}

// The springs of each node, by counting.
static ruga_status list_by_node(ruga_springs* springs) {
    RUGA_TRY(RUGA_NEW_ZERO(springs->start, (size_t)springs->node_count + 2));
    int* end = springs->start + 1; // where the next of a node goes; in the end its true place
    for (int s = 0; s < springs->count; s++) {
        for (int i = 0; i < springs->spring[s].count; i++) {
            end[springs->spring[s].node[i] + 1]++;
        }
    }
    for (int n = 0; n < springs->node_count; n++) {
        end[n + 1] += end[n];
    }
    RUGA_TRY(RUGA_NEW(springs->at, end[springs->node_count]));
    RUGA_TRY(RUGA_NEW(springs->share, end[springs->node_count]));
    for (int s = 0; s < springs->count; s++) {
        for (int i = 0; i < springs->spring[s].count; i++) {
            int to = end[springs->spring[s].node[i]]++;
            springs->at[to] = s;
            springs->share[to] = springs->spring[s].weight[i];
        }
    }
    return RUGA_OK;
}

static int chunk_count(const ruga_springs* springs) {
    return ruga_chunk_count(springs->count, CHUNK) + RUGA_SPRING_WIDTHS;
}

ruga_status ruga_springs_finish(ruga_springs* springs) {
    if (springs->count > 0) {
        merge_equal(springs);
    }
    RUGA_TRY(fill_lists(springs));
    RUGA_TRY(list_by_node(springs));
    ruga_release(springs->spring);
    springs->spring = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(springs->unit, springs->count));
    RUGA_TRY(RUGA_NEW(springs->pull, springs->count));
    return RUGA_NEW(springs->partial, chunk_count(springs));
}

// ------------------------------------------------------------------------------- forces

typedef struct pass {
    ruga_springs* springs;
    int list;
    double time;
    const double* x; // places, or velocities
    double* out;
    double* partial;
} pass;

// Weighted sum over the nodes of spring s of a list; `width` is a constant where it is inlined.
static inline void sum_nodes(const ruga_spring_list* list, int width, int s, const double* x, double d[3]) {
    const int* node = list->node + (size_t)s * (size_t)width;
    const double* weight = list->weight + (size_t)s * (size_t)width;
    const double* first = x + 3 * (size_t)node[0];
    if (width == 2) {
        ruga_subtract(first, x + 3 * (size_t)node[1], d);
        return;
    }
    for (int c = 0; c < 3; c++) {
        d[c] = weight[0] * first[c];
    }
    for (int i = 1; i < width; i++) {
        ruga_add_scaled(weight[i], x + 3 * (size_t)node[i], d);
    }
}

static inline double pull_all(const pass* p, int width, int begin, int end) {
    const ruga_spring_list* list = &p->springs->list[p->list];
    double energy = 0;
    for (int s = begin; s < end; s++) {
        double d[3], *unit = p->springs->unit[list->first + s];
        sum_nodes(list, width, s, p->x, d);
        double now = ruga_norm(d), inverse = now > 0 ? 1 / now : 0, off = now - list->length[s];
        double tension = list->stiffness[s] * off;
        for (int c = 0; c < 3; c++) {
            unit[c] = inverse * d[c];
        }
        p->springs->pull[list->first + s] = -tension;
        energy += tension * off;
    }
    return 0.5 * energy;
}

static inline void damp_all(const pass* p, int width, int begin, int end) {
    const ruga_spring_list* list = &p->springs->list[p->list];
    for (int s = begin; s < end; s++) {
        const double* unit = p->springs->unit[list->first + s];
        double d[3];
        sum_nodes(list, width, s, p->x, d);
        p->springs->pull[list->first + s] = p->time * list->stiffness[s] * ruga_dot(unit, d);
    }
}

static void pull_chunk(int begin, int end, int chunk, void* context) {
    const pass* p = context;
    p->partial[chunk] = p->list == 0   ? pull_all(p, 2, begin, end)
                        : p->list == 1 ? pull_all(p, 4, begin, end)
                                       : pull_all(p, 6, begin, end);
}

static void damp_chunk(int begin, int end, int chunk, void* context) {
    const pass* p = context;
    (void)chunk;
    switch (p->list) {
    case 0:
        damp_all(p, 2, begin, end);
        break;
    case 1:
        damp_all(p, 4, begin, end);
        break;
    default:
        damp_all(p, 6, begin, end);
    }
}

static void gather(int begin, int end, int chunk, void* context) {
    const pass* p = context;
    const ruga_springs* s = p->springs;
    (void)chunk;
    for (int n = begin; n < end; n++) {
        double sum[3] = {0, 0, 0};
        for (int k = s->start[n]; k < s->start[n + 1]; k++) {
            ruga_add_scaled(s->share[k] * s->pull[s->at[k]], s->unit[s->at[k]], sum);
        }
        ruga_add_scaled(1, sum, p->out + 3 * (size_t)n);
    }
}

double ruga_springs_force(ruga_springs* springs, const double* x, double* force) {
    pass p = {.springs = springs, .x = x, .out = force, .partial = springs->partial};
    double energy = 0;
    for (p.list = 0; p.list < RUGA_SPRING_WIDTHS; p.list++) {
        int count = springs->list[p.list].count;
        ruga_parallel_for(count, CHUNK, pull_chunk, &p);
        for (int k = 0; k < ruga_chunk_count(count, CHUNK); k++) {
            energy += p.partial[k];
        }
    }
    ruga_parallel_for(springs->node_count, CHUNK, gather, &p);
    return energy;
}

void ruga_springs_damp(ruga_springs* springs, double time, const double* v, double* out) {
    pass p = {.springs = springs, .time = time, .x = v, .out = out};
    for (p.list = 0; p.list < RUGA_SPRING_WIDTHS; p.list++) {
        ruga_parallel_for(springs->list[p.list].count, CHUNK, damp_chunk, &p);
    }
    ruga_parallel_for(springs->node_count, CHUNK, gather, &p);
}
