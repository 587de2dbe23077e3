// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Analysis for the multifrontal factorisation (Duff, Reid 1983; Liu 1992): elimination tree, supernodes,
// amalgamation of small supernodes with their parents, rows of each front, and where everything goes.
#include "solver/ldl_symbolic.h"

#include "core/memory.h"
#include "solver/ordering.h"

#include <stdlib.h>
#include <string.h>

void ruga_ldl_symbolic_clear(ruga_ldl_symbolic* symbolic) {
    ruga_release(symbolic->order);
    ruga_release(symbolic->pivot);
    ruga_release(symbolic->parent);
    ruga_release(symbolic->row_start);
    ruga_release(symbolic->row);
    ruga_release(symbolic->place);
    ruga_release(symbolic->run_end);
    ruga_release(symbolic->entry_start);
    ruga_release(symbolic->entry);
    ruga_release(symbolic->entry_row);
    ruga_release(symbolic->entry_column);
    ruga_release(symbolic->task);
    ruga_release(symbolic->by_work);
    ruga_release(symbolic->top);
    *symbolic = (ruga_ldl_symbolic){0};
}

size_t ruga_ldl_symbolic_bytes(const ruga_ldl_symbolic* symbolic) {
    size_t count = (size_t)symbolic->count;
    size_t entries = symbolic->entry_start ? (size_t)symbolic->entry_start[count] : 0;
    size_t rows = symbolic->row_start ? symbolic->row_start[count] : 0;
    size_t tasks = (size_t)symbolic->task_count;
    return ((size_t)symbolic->n + 3 * count + 2 * tasks + 3 * entries + 3 * rows) * sizeof(int) +
           count * (sizeof(size_t) + sizeof(bool));
}

// The tree of supernodes while it is made. Nodes carry the numbers of their steps in a postorder.
typedef struct builder {
    const ruga_node_graph* graph;
    int nodes;
    int* order;   // [nodes] node of a step
    int* parent;  // [nodes] parent step
    int* height;  // [nodes] unknowns in the column
    int* scratch; // [3 * nodes]
    int count;    // supernodes
    int* member;  // [nodes] supernode of a step
    int* above;   // [count] parent supernode
    int* width;   // [count] unknowns eliminated
    int* front;   // [count] unknowns in the front
    double* pad;  // [count] entries that are zero in the exact factor
    int* merged;  // [count] the ancestor that took this supernode in, or itself
    int* end;     // [count] step after the supernode's last
} builder;

static void builder_clear(builder* b) {
    ruga_release(b->order);
    ruga_release(b->parent);
    ruga_release(b->height);
    ruga_release(b->scratch);
    ruga_release(b->member);
    ruga_release(b->above);
    ruga_release(b->width);
    ruga_release(b->front);
    ruga_release(b->pad);
    ruga_release(b->merged);
    ruga_release(b->end);
}

static ruga_status builder_allocate(builder* b) {
    RUGA_TRY(RUGA_NEW(b->order, b->nodes));
    RUGA_TRY(RUGA_NEW(b->parent, b->nodes));
    RUGA_TRY(RUGA_NEW(b->height, b->nodes));
    RUGA_TRY(RUGA_NEW(b->scratch, 3 * (size_t)b->nodes));
    RUGA_TRY(RUGA_NEW(b->member, b->nodes));
    RUGA_TRY(RUGA_NEW(b->above, b->nodes));
    RUGA_TRY(RUGA_NEW(b->width, b->nodes));
    RUGA_TRY(RUGA_NEW(b->front, b->nodes));
    RUGA_TRY(RUGA_NEW(b->pad, b->nodes));
    RUGA_TRY(RUGA_NEW(b->merged, b->nodes));
    return RUGA_NEW(b->end, b->nodes);
}

// order[k] = old order[post[k]]; [count] of scratch.
static void permute(int count, const int* post, int* values, int* scratch) {
    memcpy(scratch, values, (size_t)count * sizeof *values);
    for (int k = 0; k < count; k++) {
        values[k] = scratch[post[k]];
    }
}

static ruga_status order_and_postorder(builder* b, const bool* last) {
    ruga_status status = RUGA_OK;
    int* post = NULL;
    RUGA_TRY_DONE(RUGA_NEW(post, b->nodes));
    RUGA_TRY_DONE(ruga_order_nodes(b->graph, last, b->order));
    RUGA_TRY_DONE(ruga_elimination_tree(b->graph, b->order, b->parent, b->height));
    ruga_postorder(b->nodes, b->parent, post, b->scratch);
    permute(b->nodes, post, b->order, b->scratch);
    permute(b->nodes, post, b->height, b->scratch);
    permute(b->nodes, post, b->parent, b->scratch);
    int* place = b->scratch;
    for (int k = 0; k < b->nodes; k++) {
        place[post[k]] = k;
    }
    for (int k = 0; k < b->nodes; k++) {
        b->parent[k] = b->parent[k] < 0 ? -1 : place[b->parent[k]];
    }
done:
    ruga_release(post);
    return status;
}

// Consecutive steps whose columns have the same rows.
static void find_supernodes(builder* b) {
    b->count = 0;
    for (int k = 0; k < b->nodes; k++) {
        int size = ruga_node_size(b->graph, b->order[k]);
        bool same = k > 0 && b->parent[k - 1] == k &&
                    b->height[k - 1] == b->height[k] + ruga_node_size(b->graph, b->order[k - 1]);
        if (!same) {
            b->width[b->count] = 0;
            b->front[b->count] = b->height[k];
            b->pad[b->count] = 0;
            b->merged[b->count] = b->count;
            b->count++;
        }
        b->member[k] = b->count - 1;
        b->width[b->count - 1] += size;
    }
    for (int k = 0; k < b->nodes; k++) {
        b->above[b->member[k]] = b->parent[k] < 0 ? -1 : b->member[b->parent[k]];
    }
}

static double trapezoid(double width, double height) {
    return width * height - width * (width - 1) / 2;
}

// Small fronts run at the speed of memory and calls, not of BLAS-3: a child is taken in where the zeros
// that are then stored cost less than that (the limits are those of CHOLMOD, wider by experience).
static bool worth_merging(double width, double zeros, double entries) {
    if (width <= 12) {
        return true;
    }
    double share = zeros / entries;
    return (width <= 32 && share < 0.8) || (width <= 96 && share < 0.1) || share < 0.05;
}

static void amalgamate(builder* b) {
    int *first = b->scratch, *next = b->scratch + b->nodes;
    for (int s = 0; s < b->count; s++) {
        first[s] = -1;
    }
    for (int s = 0; s < b->count; s++) {
        // The child with the largest number comes first: its rows are the likeliest to be the parent's.
        for (int c = first[s]; c >= 0; c = next[c]) {
            int width = b->width[s] + b->width[c], height = b->front[s] + b->width[c];
            double stored = trapezoid(width, height);
            double useful = trapezoid(b->width[s], b->front[s]) - b->pad[s] +
                            trapezoid(b->width[c], b->front[c]) - b->pad[c];
            if (worth_merging(width, stored - useful, stored)) {
                b->width[s] = width;
                b->front[s] = height;
                b->pad[s] = stored - useful;
                b->merged[c] = s;
            }
        }
        if (b->above[s] >= 0) {
            next[s] = first[b->above[s]];
            first[b->above[s]] = s;
        }
    }
    for (int s = b->count - 1; s >= 0; s--) { // ancestors have larger numbers: already final
        b->merged[s] = b->merged[b->merged[s]];
    }
}

// Numbers the merged supernodes in a postorder; order[], above[], width[], front[], end[] follow.
static ruga_status renumber(builder* b) {
    ruga_status status = RUGA_OK;
    int *number = NULL, *parent = NULL, *post = NULL, *start = NULL, *old = NULL;
    RUGA_TRY_DONE(RUGA_NEW(number, b->count));
    RUGA_TRY_DONE(RUGA_NEW(parent, b->count));
    RUGA_TRY_DONE(RUGA_NEW(post, b->count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(start, b->count + 1));
    RUGA_TRY_DONE(RUGA_NEW(old, b->nodes));
    int kept = 0;
    for (int s = 0; s < b->count; s++) {
        if (b->merged[s] == s) {
            number[s] = kept++;
        }
    }
    for (int s = 0; s < b->count; s++) {
        if (b->merged[s] == s) {
            parent[number[s]] = b->above[s] < 0 ? -1 : number[b->merged[b->above[s]]];
            b->width[number[s]] = b->width[s];
            b->front[number[s]] = b->front[s];
        }
    }
    ruga_postorder(kept, parent, post, b->scratch);
    permute(kept, post, b->width, b->scratch);
    permute(kept, post, b->front, b->scratch);
    int* place = b->scratch;
    for (int k = 0; k < kept; k++) {
        place[post[k]] = k;
    }
    for (int k = 0; k < kept; k++) {
        b->above[k] = parent[post[k]] < 0 ? -1 : place[parent[post[k]]];
    }
    memcpy(old, b->order, (size_t)b->nodes * sizeof *old);
    for (int k = 0; k < b->nodes; k++) {
        b->member[k] = place[number[b->merged[b->member[k]]]];
        start[b->member[k] + 1]++;
    }
    for (int s = 0; s < kept; s++) {
        start[s + 1] += start[s];
    }
    for (int k = 0; k < b->nodes; k++) {
        b->order[start[b->member[k]]++] = old[k];
    }
    memcpy(b->end, start, (size_t)kept * sizeof *start);
    b->count = kept;
done:
    ruga_release(number);
    ruga_release(parent);
    ruga_release(post);
    ruga_release(start);
    ruga_release(old);
    return status;
}

static void set_order(const builder* b, ruga_ldl_symbolic* symbolic) {
    int out = 0;
    for (int k = 0; k < b->nodes; k++) {
        int node = b->order[k];
        for (int u = b->graph->unknown[node]; u < b->graph->unknown[node + 1]; u++) {
            symbolic->order[out++] = u;
        }
    }
    symbolic->pivot[0] = 0;
    for (int s = 0; s < b->count; s++) {
        symbolic->pivot[s + 1] = symbolic->pivot[s] + b->width[s];
        symbolic->parent[s] = b->above[s];
        double w = b->width[s], h = b->front[s];
        symbolic->entries += trapezoid(w, h);
        symbolic->flops += w * (h - w) * (h - w) + w * w * (h - w) + w * w * w / 3;
    }
}

static int compare_steps(const void* a, const void* b) {
    int x = *(const int*)a, y = *(const int*)b;
    return (x > y) - (x < y);
}

// Adds step i to the rows of supernode s, once, if it lies below its pivots.
static void add_row(ruga_ldl_symbolic* symbolic, int s, int i, int* mark, size_t* found) {
    if (i >= symbolic->pivot[s + 1] && mark[i] != s) {
        mark[i] = s;
        symbolic->row[(*found)++] = i;
    }
}

static void add_rows_of_matrix(const builder* b, ruga_ldl_symbolic* symbolic, int s, const int* step,
                               int* mark, size_t* found) {
    const ruga_node_graph* g = b->graph;
    for (int k = s ? b->end[s - 1] : 0; k < b->end[s]; k++) {
        for (int p = g->start[b->order[k]]; p < g->start[b->order[k] + 1]; p++) {
            for (int u = g->unknown[g->neighbour[p]]; u < g->unknown[g->neighbour[p] + 1]; u++) {
                add_row(symbolic, s, step[u], mark, found);
            }
        }
    }
}

// Rows of each front below its pivots: those of the matrix and those of the children.
static ruga_status find_rows(const builder* b, ruga_ldl_symbolic* symbolic) {
    ruga_status status = RUGA_OK;
    int *mark = NULL, *step = NULL, *first = b->scratch, *next = b->scratch + b->nodes;
    RUGA_TRY_DONE(RUGA_NEW(mark, symbolic->n));
    RUGA_TRY_DONE(RUGA_NEW(step, symbolic->n));
    symbolic->row_start[0] = 0;
    for (int s = 0; s < b->count; s++) {
        first[s] = -1;
        symbolic->row_start[s + 1] = symbolic->row_start[s] + (size_t)(b->front[s] - b->width[s]);
    }
    RUGA_TRY_DONE(RUGA_NEW(symbolic->row, symbolic->row_start[b->count]));
    RUGA_TRY_DONE(RUGA_NEW(symbolic->place, symbolic->row_start[b->count]));
    RUGA_TRY_DONE(RUGA_NEW(symbolic->run_end, symbolic->row_start[b->count]));
    for (int i = 0; i < symbolic->n; i++) {
        step[symbolic->order[i]] = i;
        mark[i] = -1;
    }
    for (int s = 0; s < b->count; s++) {
        size_t begin = symbolic->row_start[s], found = begin;
        add_rows_of_matrix(b, symbolic, s, step, mark, &found);
        for (int c = first[s]; c >= 0; c = next[c]) {
            for (size_t r = symbolic->row_start[c]; r < symbolic->row_start[c + 1]; r++) {
                add_row(symbolic, s, symbolic->row[r], mark, &found);
            }
        }
        RUGA_ASSERT(found == symbolic->row_start[s + 1]);
        qsort(symbolic->row + begin, found - begin, sizeof(int), compare_steps);
        if (b->above[s] >= 0) {
            next[s] = first[b->above[s]];
            first[b->above[s]] = s;
        }
    }
done:
    ruga_release(mark);
    ruga_release(step);
    return status;
}

// Both lists ascend, and the child's rows are all in the parent's front.
static void find_places(ruga_ldl_symbolic* symbolic) {
    for (int s = 0; s < symbolic->count; s++) {
        int p = symbolic->parent[s];
        size_t r = symbolic->row_start[s], end = symbolic->row_start[s + 1];
        if (p < 0) {
            RUGA_ASSERT(r == end);
            continue;
        }
        for (; r < end && symbolic->row[r] < symbolic->pivot[p + 1]; r++) {
            symbolic->place[r] = symbolic->row[r] - symbolic->pivot[p];
        }
        size_t q = symbolic->row_start[p];
        int own = symbolic->pivot[p + 1] - symbolic->pivot[p];
        for (; r < end; r++) {
            while (symbolic->row[q] != symbolic->row[r]) {
                q++;
            }
            symbolic->place[r] = own + (int)(q - symbolic->row_start[p]);
        }
    }
}

// Runs end at the last of the parent's pivots, too: delayed ones may come between them and the rows below.
static void find_runs(ruga_ldl_symbolic* symbolic) {
    for (int s = 0; s < symbolic->count; s++) {
        size_t begin = symbolic->row_start[s], end = symbolic->row_start[s + 1];
        const int *place = symbolic->place, p = symbolic->parent[s];
        int own = p < 0 ? 0 : symbolic->pivot[p + 1] - symbolic->pivot[p];
        for (size_t r = end; r-- > begin;) {
            bool goes_on = r + 1 < end && place[r + 1] == place[r] + 1 && place[r + 1] != own;
            symbolic->run_end[r] = goes_on ? symbolic->run_end[r + 1] : (int)(r + 1 - begin);
        }
    }
}

// Sorts the matrix entries by the front that assembles them, with their steps as row and column.
static void sort_entries(const ruga_sparse* lower, const int* step, const int* owner, int* fill,
                         ruga_ldl_symbolic* symbolic) {
    for (int j = 0; j < symbolic->n; j++) {
        for (int p = lower->start[j]; p < lower->start[j + 1]; p++) {
            int i = step[lower->index[p]];
            symbolic->entry_start[owner[i < step[j] ? i : step[j]] + 1]++;
        }
    }
    for (int s = 0; s < symbolic->count; s++) {
        symbolic->entry_start[s + 1] += symbolic->entry_start[s];
        fill[s] = symbolic->entry_start[s];
    }
    for (int j = 0; j < symbolic->n; j++) {
        for (int p = lower->start[j]; p < lower->start[j + 1]; p++) {
            int a = step[j], b = step[lower->index[p]], k = fill[owner[a < b ? a : b]]++;
            symbolic->entry[k] = p;
            symbolic->entry_row[k] = a < b ? b : a;
            symbolic->entry_column[k] = a < b ? a : b;
        }
    }
}

// Steps become places in the front; [n] of scratch.
static void localise_entries(ruga_ldl_symbolic* symbolic, int* local) {
    for (int s = 0; s < symbolic->count; s++) {
        int begin = symbolic->pivot[s], own = symbolic->pivot[s + 1] - begin;
        for (size_t r = symbolic->row_start[s]; r < symbolic->row_start[s + 1]; r++) {
            local[symbolic->row[r]] = own + (int)(r - symbolic->row_start[s]);
        }
        for (int k = symbolic->entry_start[s]; k < symbolic->entry_start[s + 1]; k++) {
            int i = symbolic->entry_row[k];
            symbolic->entry_row[k] = i < begin + own ? i - begin : local[i];
            symbolic->entry_column[k] -= begin;
        }
    }
}

static ruga_status place_entries(const ruga_sparse* lower, ruga_ldl_symbolic* symbolic) {
    ruga_status status = RUGA_OK;
    int n = symbolic->n, *step = NULL, *owner = NULL, *fill = NULL;
    RUGA_TRY_DONE(RUGA_NEW(step, n));
    RUGA_TRY_DONE(RUGA_NEW(owner, n));
    RUGA_TRY_DONE(RUGA_NEW(fill, symbolic->count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(symbolic->entry_start, symbolic->count + 1));
    RUGA_TRY_DONE(RUGA_NEW(symbolic->entry, lower->start[n]));
    RUGA_TRY_DONE(RUGA_NEW(symbolic->entry_row, lower->start[n]));
    RUGA_TRY_DONE(RUGA_NEW(symbolic->entry_column, lower->start[n]));
    for (int s = 0; s < symbolic->count; s++) {
        for (int i = symbolic->pivot[s]; i < symbolic->pivot[s + 1]; i++) {
            owner[i] = s;
            step[symbolic->order[i]] = i;
        }
    }
    sort_entries(lower, step, owner, fill, symbolic);
    localise_entries(symbolic, step);
done:
    ruga_release(step);
    ruga_release(owner);
    ruga_release(fill);
    return status;
}

static double front_work(const ruga_ldl_symbolic* symbolic, int s) {
    double w = symbolic->pivot[s + 1] - symbolic->pivot[s];
    double r = (double)(symbolic->row_start[s + 1] - symbolic->row_start[s]);
    return w * r * r + w * w * r + w * w * w / 3;
}

// The largest first, so that threads end at about the same time.
static ruga_status sort_tasks(ruga_ldl_symbolic* symbolic) {
    double* work = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(work, symbolic->task_count));
    ruga_status status = RUGA_NEW(symbolic->by_work, symbolic->task_count);
    for (int t = 0; t < symbolic->task_count && status == RUGA_OK; t++) {
        for (int s = symbolic->task[t]; s < symbolic->task[t + 1]; s++) {
            work[t] += symbolic->top[s] ? 0 : front_work(symbolic, s);
        }
        int place = t;
        for (; place > 0 && work[symbolic->by_work[place - 1]] < work[t]; place--) {
            symbolic->by_work[place] = symbolic->by_work[place - 1];
        }
        symbolic->by_work[place] = t;
    }
    ruga_release(work);
    return status;
}

// Subtrees with at most 1/16 of the work become tasks, neighbouring small ones together; what is above
// them is `top`. The split depends on the matrix alone.
static ruga_status share_out(ruga_ldl_symbolic* symbolic) {
    ruga_status status = RUGA_OK;
    double* work = NULL;
    int count = symbolic->count;
    RUGA_TRY_DONE(RUGA_NEW_ZERO(work, count));
    RUGA_TRY_DONE(RUGA_NEW(symbolic->top, count));
    RUGA_TRY_DONE(RUGA_NEW(symbolic->task, count + 1));
    double limit = symbolic->flops / 16, filled = 0;
    for (int s = 0; s < count; s++) {
        work[s] += front_work(symbolic, s);
        symbolic->top[s] = work[s] > limit;
        if (symbolic->parent[s] >= 0) {
            work[symbolic->parent[s]] += work[s];
        }
    }
    bool open = false;
    for (int s = 0; s < count; s++) {
        int p = symbolic->parent[s];
        if (symbolic->top[s]) {
            open = false;
            continue;
        }
        if (!open) {
            symbolic->task[symbolic->task_count++] = s;
            open = true;
            filled = 0;
        }
        if (p < 0 || symbolic->top[p]) { // the root of a subtree: the task is full, or goes on
            filled += work[s];
            open = filled < limit / 2;
        }
    }
    symbolic->task[symbolic->task_count] = count;
    RUGA_TRY_DONE(sort_tasks(symbolic));
done:
    ruga_release(work);
    return status;
}

ruga_status ruga_ldl_analyse(const ruga_sparse* lower, int node_count, const int* node_start,
                             const bool* last, ruga_ldl_symbolic* symbolic) {
    ruga_status status = RUGA_OK;
    ruga_node_graph graph = {0};
    builder b = {0};
    *symbolic = (ruga_ldl_symbolic){.n = lower->columns};
    RUGA_TRY_DONE(ruga_node_graph_create(lower, node_count, node_start, &graph));
    b.graph = &graph;
    b.nodes = graph.count;
    RUGA_TRY_DONE(builder_allocate(&b));
    RUGA_TRY_DONE(order_and_postorder(&b, last));
    find_supernodes(&b);
    amalgamate(&b);
    RUGA_TRY_DONE(renumber(&b));
    symbolic->count = b.count;
    RUGA_TRY_DONE(RUGA_NEW(symbolic->order, symbolic->n));
    RUGA_TRY_DONE(RUGA_NEW(symbolic->pivot, b.count + 1));
    RUGA_TRY_DONE(RUGA_NEW(symbolic->parent, b.count));
    RUGA_TRY_DONE(RUGA_NEW(symbolic->row_start, b.count + 1));
    set_order(&b, symbolic);
    RUGA_TRY_DONE(find_rows(&b, symbolic));
    find_places(symbolic);
    find_runs(symbolic);
    RUGA_TRY_DONE(place_entries(lower, symbolic));
    RUGA_TRY_DONE(share_out(symbolic));
done:
    builder_clear(&b);
    ruga_node_graph_clear(&graph);
    if (status != RUGA_OK) {
        ruga_ldl_symbolic_clear(symbolic);
    }
    return status;
}
