// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Writing result files so that they are readable at any moment.
//
// HDF5's single-writer-multiple-readers mode (SWMR) orders the writes of its own tables so that what they
// point to is there before they are. It needs that every dataset and attribute exists before it starts;
// only datasets grow afterwards. On top of that:
//  - The file gets its name with its first whole frame.
//  - A frame is flushed before the row of /frames/time that says that it is there: the number of whole frames
//    is the length of /frames/time, and after a kill other datasets may have a row more.
//  - Restart data alternate between two slots, so that those of the last whole frame stand while those of
//    the next are written; a slot's frame number is -1 while its vector changes.
//  - Space is handed out in pages of 4 KiB (H5F_FSPACE_STRATEGY_PAGE), and HDF5's tables do not straddle
//    them: a process can be killed between two pages of one write, but not within a page.
// A killed writer leaves a mark of the file's end that may be stale, so a file is never reopened for
// writing: to resume is to copy the whole frames to a fresh file.
#define _POSIX_C_SOURCE 200809L
#include "io/result.h"

#include "core/memory.h"
#include "io/result_layout.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { STATS_CHUNK = 128, PAGE = 4096 };

struct ruga_result {
    char* path;
    char* temporary;
    bool published; // the file stands at `path`
    bool failed;    // no frame can follow
    bool abandoned; // HDF5 failed to write: it must not try again
    hid_t file;
    hid_t set[RUGA_RESULT_SETS];
    int vertex_count;
    int node_count; // 0 without an interior
    int segment_count, handle_count;
    int restart_doubles;
    int frame_count;
};

// --- Names ---

// `path.part-PID` of processes that no longer run.
static void remove_stale(const char* path) {
    const char* slash = strrchr(path, '/');
    const char* base = slash ? slash + 1 : path;
    size_t length = strlen(base);
    char* folder = ruga_copy_string(slash ? path : "./");
    if (!folder) {
        return; // tidying only
    }
    folder[slash ? slash - path + 1 : 2] = '\0';
    DIR* entries = opendir(folder);
    for (struct dirent* entry; entries && (entry = readdir(entries));) {
        static const char mark[] = ".part-";
        const char* digits = entry->d_name + length + sizeof mark - 1;
        if (strncmp(entry->d_name, base, length) != 0 || strncmp(entry->d_name + length, mark, 6) != 0 ||
            *digits == '\0' || digits[strspn(digits, "0123456789")] != '\0') {
            continue;
        }
        long process = strtol(digits, NULL, 10);
        if (process > 0 && kill((pid_t)process, 0) != 0 && errno == ESRCH) {
            (void)unlinkat(dirfd(entries), entry->d_name, 0);
        }
    }
    if (entries) {
        (void)closedir(entries);
    }
    ruga_release(folder);
}

static ruga_status make_names(ruga_result* result, const char* path) {
    size_t size = strlen(path) + 32;
    RUGA_TRY(RUGA_NEW(result->temporary, size));
    (void)snprintf(result->temporary, size, "%s.part-%ld", path, (long)getpid());
    result->path = ruga_copy_string(path);
    return result->path ? RUGA_OK : ruga_fail(RUGA_NO_MEMORY, "out of memory: a file's name");
}

static ruga_status publish(ruga_result* result) {
    if (rename(result->temporary, result->path) != 0) {
        return ruga_fail(RUGA_IO, "%s: cannot be put in its place: %s", result->path, strerror(errno));
    }
    result->published = true;
    return RUGA_OK;
}

// --- What stands in the file from the start ---

static bool put_header(hid_t file, const ruga_result_header* header) {
    char versions[512], hash[20];
    unsigned major, minor, release;
    if (H5get_libversion(&major, &minor, &release) < 0) {
        return false;
    }
    (void)snprintf(versions, sizeof versions, "HDF5 %u.%u.%u%s%s", major, minor, release,
                   header->libraries ? ", " : "", header->libraries ? header->libraries : "");
    hid_t root = H5Gopen2(file, "/", H5P_DEFAULT);
    bool ok = root >= 0 && ruga_hdf5_put_integer(root, "format", RUGA_RESULT_FORMAT) &&
              ruga_hdf5_put_text(root, "version", ruga_version()) &&
              ruga_hdf5_put_text(root, "library_versions", versions) &&
              ruga_hdf5_put_text(root, "scene", header->scene_text ? header->scene_text : "");
    (void)snprintf(hash, sizeof hash, "%016" PRIx64, header->scene_hash);
    ok = ok && ruga_hdf5_put_text(root, "scene_hash", hash);
    (void)snprintf(hash, sizeof hash, "%016" PRIx64, header->mesh_hash);
    ok = ok && ruga_hdf5_put_text(root, "mesh_hash", hash) &&
         ruga_hdf5_put_integer(root, "seed", header->seed) &&
         ruga_hdf5_put_double(root, "mesh_unit", header->mesh_unit) &&
         ruga_hdf5_put_double(root, "wavelength", header->wavelength) &&
         ruga_hdf5_put_double(root, "critical_strain", header->critical_strain) &&
         ruga_hdf5_put_double(root, "cluster_sigma", header->cluster_sigma) &&
         ruga_hdf5_put_double(root, "cluster_radius", header->cluster_radius);
    (void)H5Gclose(root);
    return ok;
}

static bool put_integers(hid_t file, const char* name, int rows, int columns, const int* data) {
    return ruga_hdf5_put_array(file, name, H5T_STD_I32LE, H5T_NATIVE_INT, columns > 1 ? 2 : 1,
                               (hsize_t[]){(hsize_t)rows, (hsize_t)columns}, data);
}

static bool put_reals(hid_t file, const char* name, int rows, int columns, const double* data) {
    return ruga_hdf5_put_array(file, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, 2,
                               (hsize_t[]){(hsize_t)rows, (hsize_t)columns}, data);
}

static bool put_mesh(hid_t file, const ruga_mesh* mesh, const int* source_vertex) {
    int faces = mesh->triangle_count;
    return put_integers(file, "/mesh/triangles", faces, 3, mesh->triangle) &&
           put_reals(file, "/mesh/rest", mesh->vertex_count, 3, mesh->position) &&
           put_integers(file, "/mesh/source_vertex", mesh->vertex_count, 1, source_vertex) &&
           (!mesh->uv || !mesh->uv_triangle ||
            (put_reals(file, "/mesh/uv", mesh->uv_count, 2, mesh->uv) &&
             put_integers(file, "/mesh/uv_triangles", faces, 3, mesh->uv_triangle))) &&
           (!mesh->face_group ||
            (put_integers(file, "/mesh/face_group", faces, 1, mesh->face_group) &&
             ruga_hdf5_put_texts(file, "/mesh/group_names", mesh->group_count, mesh->group_name)));
}

static bool put_column(hid_t file, const char* name, int rows, const double* data) {
    return !data || ruga_hdf5_put_array(file, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, 1,
                                        (hsize_t[]){(hsize_t)rows}, data);
}

static bool put_skin(hid_t file, const ruga_result_header* header) {
    int vertices = header->mesh->vertex_count;
    return put_column(file, "/mesh/thickness", vertices, header->vertex_thickness) &&
           put_column(file, "/mesh/young", vertices, header->vertex_young) &&
           put_column(file, "/mesh/wavelength", vertices, header->vertex_wavelength) &&
           (!header->vertex_growth || put_reals(file, "/mesh/growth", vertices, 2, header->vertex_growth));
}

static bool put_lattice(hid_t file, const ruga_lattice* lattice) {
    return put_integers(file, "/lattice/elements", lattice->element_count, lattice->nodes_per_element,
                        lattice->element_node) &&
           put_reals(file, "/lattice/nodes", lattice->node_count, 3, lattice->rest);
}

static bool put_creases(hid_t file, const ruga_result_creases* creases) {
    int count = creases->segment_count;
    return put_integers(file, "/creases/segments", count, 2, creases->segment) &&
           put_integers(file, "/creases/segment_crease", count, 1, creases->crease) &&
           put_column(file, "/creases/length", count, creases->length) &&
           put_column(file, "/creases/stiffness", count, creases->stiffness) &&
           ruga_hdf5_put_array(file, "/creases/assignment", H5T_STD_I8LE, H5T_NATIVE_CHAR, 1,
                               (hsize_t[]){(hsize_t)count}, creases->assignment) &&
           ruga_hdf5_put_texts(file, "/creases/names", creases->crease_count, creases->name);
}

// One frame a chunk for positions: they are written once, without reading, and never rewritten.
static bool make_set(ruga_result* result, int set) {
    static const int64_t no_frame = -1;
    static const double no_time = NAN;
    const char* name = ruga_result_set_name(set);
    hid_t type = ruga_result_set_type(set);
    hsize_t points = (hsize_t)(set == RUGA_RESULT_LATTICE ? result->node_count : result->vertex_count);
    hid_t* made = &result->set[set];
    switch (set) {
    case RUGA_RESULT_POSITION:
    case RUGA_RESULT_EMBEDDED:
    case RUGA_RESULT_LATTICE:
        *made = ruga_hdf5_make(result->file, name, type, 3, (hsize_t[]){0, points, 3}, 1, NULL);
        break;
    case RUGA_RESULT_ANGLE:
    case RUGA_RESULT_REST_ANGLE:
    case RUGA_RESULT_SEGMENT_GAP:
        *made = ruga_hdf5_make(result->file, name, type, 2, (hsize_t[]){0, (hsize_t)result->segment_count}, 1, NULL);
        break;
    case RUGA_RESULT_HANDLE_FORCE:
        *made = ruga_hdf5_make(result->file, name, type, 3, (hsize_t[]){0, (hsize_t)result->handle_count, 3},
                               STATS_CHUNK, NULL);
        break;
    case RUGA_RESULT_RESTART:
        *made = ruga_hdf5_make(result->file, name, type, 2, (hsize_t[]){2, (hsize_t)result->restart_doubles},
                               0, NULL);
        break;
    case RUGA_RESULT_RESTART_FRAME:
        *made = ruga_hdf5_make(result->file, name, type, 1, (hsize_t[]){2}, 0, &no_frame);
        break;
    case RUGA_RESULT_TIME:
        *made = ruga_hdf5_make(result->file, name, type, 1, (hsize_t[]){0}, STATS_CHUNK, &no_time);
        break;
    default:
        *made = ruga_hdf5_make(result->file, name, type, 1, (hsize_t[]){0}, STATS_CHUNK, NULL);
    }
    return *made >= 0;
}

// The formats of HDF5 1.10, the first with SWMR, whatever later library is in use.
static hid_t create_file(const char* name) {
    hid_t file = H5I_INVALID_HID;
    hid_t creation = H5Pcreate(H5P_FILE_CREATE), access = H5Pcreate(H5P_FILE_ACCESS);
    if (creation >= 0 && access >= 0 &&
        H5Pset_file_space_strategy(creation, H5F_FSPACE_STRATEGY_PAGE, 0, 1) >= 0 &&
        H5Pset_file_space_page_size(creation, PAGE) >= 0 &&
        H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110) >= 0) {
        file = H5Fcreate(name, H5F_ACC_TRUNC, creation, access);
    }
    (void)H5Pclose(access);
    (void)H5Pclose(creation);
    return file;
}

static bool fill_file(ruga_result* result, const ruga_result_header* header, const int* source_vertex) {
    result->file = create_file(result->temporary);
    if (result->file < 0 || !put_header(result->file, header) ||
        !put_mesh(result->file, header->mesh, source_vertex) || !put_skin(result->file, header) ||
        (header->lattice && !put_lattice(result->file, header->lattice)) ||
        (header->creases && !put_creases(result->file, header->creases))) {
        return false;
    }
    for (int set = 0; set < RUGA_RESULT_SETS; set++) {
        bool there = (header->lattice || !ruga_result_set_is_interior(set)) &&
                     (header->creases || !ruga_result_set_is_crease(set)) &&
                     (header->handle_count > 0 || set != RUGA_RESULT_HANDLE_FORCE);
        if (there && !make_set(result, set)) {
            return false;
        }
    }
    return H5Fflush(result->file, H5F_SCOPE_GLOBAL) >= 0 && H5Fstart_swmr_write(result->file) >= 0;
}

// The file under its temporary name, ready for frames.
static ruga_status start_file(const char* path, const ruga_result_header* header, ruga_result** result) {
    RUGA_ASSERT(header->mesh && header->restart_doubles >= 0);
    *result = NULL;
    remove_stale(path);
    ruga_result* made;
    RUGA_TRY(RUGA_NEW_ZERO(made, 1));
    made->file = -1;
    for (int set = 0; set < RUGA_RESULT_SETS; set++) {
        made->set[set] = -1;
    }
    made->vertex_count = header->mesh->vertex_count;
    made->node_count = header->lattice ? header->lattice->node_count : 0;
    made->restart_doubles = header->restart_doubles;
    made->segment_count = header->creases ? header->creases->segment_count : 0;
    made->handle_count = header->handle_count;
    *result = made;
    RUGA_TRY(make_names(made, path));
    int* identity = NULL;
    if (!header->mesh->source_vertex) {
        RUGA_TRY(RUGA_NEW(identity, made->vertex_count));
        for (int v = 0; v < made->vertex_count; v++) {
            identity[v] = v;
        }
    }
    ruga_hdf5 hdf5;
    ruga_hdf5_begin(&hdf5, path);
    bool ok = fill_file(made, header, identity ? identity : header->mesh->source_vertex);
    ruga_status status = ruga_hdf5_check(&hdf5, ok, RUGA_IO, "the result file cannot be written");
    ruga_hdf5_end(&hdf5);
    made->abandoned = !ok;
    ruga_release(identity);
    return status;
}

// After a failure: frees everything and keeps the sentence of what failed first.
static ruga_status give_up(ruga_status status, ruga_result** result) {
    char* sentence = ruga_copy_string(ruga_last_error());
    (void)ruga_result_close(result);
    if (sentence) {
        (void)ruga_fail(status, "%s", sentence);
    }
    ruga_release(sentence);
    return status;
}

ruga_status ruga_result_create(const char* path, const ruga_result_header* header, bool force,
                               ruga_result** result) {
    *result = NULL;
    if (!force && access(path, F_OK) == 0) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "%s: there is such a file already: choose another name, or use "
                         "--resume to go on from it or --force to replace it",
                         path);
    }
    ruga_status status = start_file(path, header, result);
    return status == RUGA_OK ? status : give_up(status, result);
}

// --- Frames ---

static bool put_restart(const ruga_result* result, int frame, const double* restart) {
    hid_t number_set = result->set[RUGA_RESULT_RESTART_FRAME];
    hid_t vector_set = result->set[RUGA_RESULT_RESTART];
    hsize_t slot = (hsize_t)(frame % 2);
    int64_t none = -1, number = frame;
    return ruga_hdf5_put_row(number_set, H5T_NATIVE_INT64, slot, &none) && H5Dflush(number_set) >= 0 &&
           (result->restart_doubles == 0 ||
            ruga_hdf5_put_row(vector_set, H5T_NATIVE_DOUBLE, slot, restart)) &&
           H5Dflush(vector_set) >= 0 && ruga_hdf5_put_row(number_set, H5T_NATIVE_INT64, slot, &number);
}

// restart NULL: left as it is, for frames that are copied.
static bool put_frame(ruga_result* result, const ruga_result_frame* frame, const double* restart) {
    const hid_t* set = result->set;
    hsize_t row = (hsize_t)result->frame_count;
    if ((restart && !put_restart(result, result->frame_count, restart)) ||
        !ruga_hdf5_put_row(set[RUGA_RESULT_POSITION], H5T_NATIVE_DOUBLE, row, frame->position)) {
        return false;
    }
    if (result->node_count > 0 &&
        (!ruga_hdf5_put_row(set[RUGA_RESULT_EMBEDDED], H5T_NATIVE_DOUBLE, row, frame->embedded) ||
         !ruga_hdf5_put_row(set[RUGA_RESULT_LATTICE], H5T_NATIVE_DOUBLE, row, frame->lattice_position))) {
        return false;
    }
    if (result->segment_count > 0 &&
        (!ruga_hdf5_put_row(set[RUGA_RESULT_ANGLE], H5T_NATIVE_DOUBLE, row, frame->crease_angle) ||
         !ruga_hdf5_put_row(set[RUGA_RESULT_REST_ANGLE], H5T_NATIVE_DOUBLE, row, frame->crease_rest) ||
         !ruga_hdf5_put_row(set[RUGA_RESULT_GAP], H5T_NATIVE_DOUBLE, row, &frame->gap) ||
         !ruga_hdf5_put_row(set[RUGA_RESULT_SEGMENT_GAP], H5T_NATIVE_DOUBLE, row, frame->segment_gap))) {
        return false;
    }
    if (result->handle_count > 0 &&
        !ruga_hdf5_put_row(set[RUGA_RESULT_HANDLE_FORCE], H5T_NATIVE_DOUBLE, row, frame->handle_force)) {
        return false;
    }
    return ruga_result_put_report(set, row, &frame->report) &&
           H5Fflush(result->file, H5F_SCOPE_GLOBAL) >= 0 &&
           ruga_hdf5_put_row(set[RUGA_RESULT_TIME], H5T_NATIVE_DOUBLE, row, &frame->time) &&
           H5Fflush(result->file, H5F_SCOPE_GLOBAL) >= 0;
}

static ruga_status append(ruga_result* result, const ruga_result_frame* frame, const double* restart) {
    ruga_hdf5 hdf5;
    ruga_hdf5_begin(&hdf5, result->path);
    bool ok = put_frame(result, frame, restart);
    char trouble[64];
    (void)snprintf(trouble, sizeof trouble, "frame %d cannot be written", result->frame_count);
    ruga_status status = ruga_hdf5_check(&hdf5, ok, RUGA_IO, trouble);
    ruga_hdf5_end(&hdf5);
    result->failed = result->abandoned = !ok;
    result->frame_count += ok;
    return status;
}

ruga_status ruga_result_append(ruga_result* result, const ruga_result_frame* frame) {
    RUGA_ASSERT(frame->position && (result->restart_doubles == 0 || frame->restart));
    RUGA_ASSERT(result->segment_count == 0 || (frame->crease_angle && frame->crease_rest && frame->segment_gap));
    RUGA_ASSERT(result->handle_count == 0 || frame->handle_force);
    RUGA_ASSERT(result->node_count == 0 || (frame->embedded && frame->lattice_position));
    if (result->failed) {
        return ruga_fail(RUGA_IO, "%s: frame %d could not be written, so no frame can follow it",
                         result->path, result->frame_count);
    }
    static const double nothing = 0;
    RUGA_TRY(append(result, frame, frame->restart ? frame->restart : &nothing));
    if (!result->published) {
        ruga_status status = publish(result);
        result->failed = status != RUGA_OK;
        return status;
    }
    return RUGA_OK;
}

static bool close_file(ruga_result* result) {
    bool ok = true;
    for (int set = 0; set < RUGA_RESULT_SETS; set++) {
        ok = (result->set[set] < 0 || H5Dclose(result->set[set]) >= 0) && ok;
    }
    return (result->file < 0 || H5Fclose(result->file) >= 0) && ok;
}

// A file that HDF5 could not write to is left open: closing it would write again, with parts of the tables
// missing if there is space by now, and where that fails HDF5 1.10 crashes at its next look at the file.
ruga_status ruga_result_close(ruga_result** result) {
    ruga_result* r = *result;
    if (!r) {
        return RUGA_OK;
    }
    ruga_hdf5 hdf5;
    ruga_hdf5_begin(&hdf5, r->path ? r->path : "");
    bool ok = r->abandoned || close_file(r);
    ruga_status status = ruga_hdf5_check(&hdf5, ok, RUGA_IO, "the file cannot be closed");
    ruga_hdf5_end(&hdf5);
    if (r->file >= 0 && !r->published) {
        (void)unlink(r->temporary);
    }
    ruga_release(r->path);
    ruga_release(r->temporary);
    ruga_release(r);
    *result = NULL;
    return status;
}

// --- Going on from an older file ---

static ruga_status check_fits(const char* path, const ruga_result_reader* reader,
                              const ruga_result_header* header) {
    const ruga_result_header* old = ruga_result_reader_header(reader);
    static const char advice[] = "write to another file, or start anew with --force";
    if (ruga_result_frame_count(reader) == 0) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: has no whole frame to go on from: start anew with --force",
                         path);
    }
    if (old->mesh->vertex_count != header->mesh->vertex_count) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: was made from a mesh of %d vertices, this one has %d: %s", path,
                         old->mesh->vertex_count, header->mesh->vertex_count, advice);
    }
    if (old->mesh_hash != header->mesh_hash) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "%s: was made from another mesh (hash %016" PRIx64 ", now %016" PRIx64 "): %s", path,
                         old->mesh_hash, header->mesh_hash, advice);
    }
    if (old->scene_hash != header->scene_hash) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "%s: was made from another scene (hash %016" PRIx64 ", now %016" PRIx64 "): %s",
                         path, old->scene_hash, header->scene_hash, advice);
    }
    if (old->handle_count > 0 && old->handle_count != header->handle_count) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: it has %d handles, not %d: %s", path, old->handle_count,
                         header->handle_count, advice);
    }
    int segments = header->creases ? header->creases->segment_count : 0;
    int old_segments = old->creases ? old->creases->segment_count : 0;
    if (old_segments != segments) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: its creases have %d segments, not %d: %s", path, old_segments, segments,
                         advice);
    }
    if (old->restart_doubles != header->restart_doubles) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "%s: its restart data have %d numbers, not %d: it is of another "
                         "version of Ruga: %s",
                         path, old->restart_doubles, header->restart_doubles, advice);
    }
    return RUGA_OK;
}

static ruga_status check_lattice(const char* path, ruga_result_reader* reader,
                                 const ruga_result_header* header) {
    int nodes;
    RUGA_TRY(ruga_result_read_lattice(reader, 0, &nodes, NULL, NULL));
    int wanted = header->lattice ? header->lattice->node_count : 0;
    if (nodes != wanted) {
        return ruga_fail(RUGA_BAD_INPUT,
                         "%s: its interior has %d nodes, not %d: write to another file, or "
                         "start anew with --force",
                         path, nodes, wanted);
    }
    return RUGA_OK;
}

typedef struct copy_buffers {
    double *position, *embedded, *lattice, *restart, *angle, *rest, *gap, *force;
} copy_buffers;

// The slot of the frame before the last is copied too where it is whole: then the file is, bit for bit, that
// of a run without a break, even if no frame follows.
static ruga_status copy_frames(ruga_result_reader* reader, ruga_result* result, const copy_buffers* buffers,
                               double* last_restart) {
    int count = ruga_result_frame_count(reader);
    for (int frame = 0; frame < count; frame++) {
        ruga_result_frame copy = {.position = buffers->position,
                                  .embedded = buffers->embedded,
                                  .lattice_position = buffers->lattice,
                                  .crease_angle = buffers->angle,
                                  .crease_rest = buffers->rest,
                                  .segment_gap = buffers->gap,
                                  .handle_force = buffers->force};
        RUGA_TRY(ruga_result_read_frame(reader, frame, &copy.time, buffers->position,
                                        result->node_count > 0 ? buffers->embedded : NULL, &copy.report));
        if (result->node_count > 0) {
            RUGA_TRY(ruga_result_read_lattice(reader, frame, NULL, NULL, buffers->lattice));
        }
        if (result->segment_count > 0) {
            RUGA_TRY(ruga_result_read_creases(reader, frame, buffers->angle, buffers->rest, &copy.gap));
            RUGA_TRY(ruga_result_read_segment_gaps(reader, frame, buffers->gap));
        }
        if (ruga_result_reader_header(reader)->handle_count > 0) {
            RUGA_TRY(ruga_result_read_handle_force(reader, frame, buffers->force));
        }
        bool found = false;
        double* restart = frame == count - 1 ? last_restart : buffers->restart;
        if (frame >= count - 2) {
            RUGA_TRY(ruga_result_read_restart(reader, frame, restart, &found));
        }
        if (frame == count - 1 && !found) {
            return ruga_fail(RUGA_BAD_INPUT,
                             "%s: the restart data of its last frame, %d, are missing: start "
                             "anew with --force",
                             result->path, frame);
        }
        RUGA_TRY(append(result, &copy, found ? restart : NULL));
    }
    return RUGA_OK;
}

static ruga_status copy_file(ruga_result_reader* reader, ruga_result* result, double* restart) {
    copy_buffers buffers = {0};
    ruga_status status;
    RUGA_TRY_DONE(RUGA_NEW(buffers.position, 3 * (size_t)result->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW(buffers.embedded, 3 * (size_t)result->vertex_count));
    RUGA_TRY_DONE(RUGA_NEW(buffers.lattice, 3 * (size_t)result->node_count));
    RUGA_TRY_DONE(RUGA_NEW(buffers.restart, (size_t)result->restart_doubles + 1));
    RUGA_TRY_DONE(RUGA_NEW(buffers.angle, (size_t)result->segment_count));
    RUGA_TRY_DONE(RUGA_NEW(buffers.rest, (size_t)result->segment_count));
    RUGA_TRY_DONE(RUGA_NEW(buffers.gap, (size_t)result->segment_count));
    RUGA_TRY_DONE(RUGA_NEW_ZERO(buffers.force, 3 * (size_t)result->handle_count));
    RUGA_TRY_DONE(copy_frames(reader, result, &buffers, restart));
    RUGA_TRY_DONE(publish(result));
done:
    ruga_release(buffers.position);
    ruga_release(buffers.embedded);
    ruga_release(buffers.lattice);
    ruga_release(buffers.restart);
    ruga_release(buffers.angle);
    ruga_release(buffers.rest);
    ruga_release(buffers.gap);
    ruga_release(buffers.force);
    return status;
}

ruga_status ruga_result_resume(const char* path, const ruga_result_header* header, double* restart,
                               int* frames_done, ruga_result** result) {
    *result = NULL;
    *frames_done = 0;
    if (access(path, F_OK) != 0 && errno == ENOENT) {
        return RUGA_OK;
    }
    ruga_result_reader* reader = NULL;
    RUGA_TRY(ruga_result_open(path, &reader));
    ruga_status status;
    RUGA_TRY_DONE(check_fits(path, reader, header));
    RUGA_TRY_DONE(check_lattice(path, reader, header));
    RUGA_TRY_DONE(start_file(path, header, result));
    RUGA_TRY_DONE(copy_file(reader, *result, restart));
    *frames_done = (*result)->frame_count;
done:
    ruga_result_reader_close(&reader);
    return status == RUGA_OK ? status : give_up(status, result);
}
