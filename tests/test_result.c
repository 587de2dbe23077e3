// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Result files: what is written is read, and a killed writer costs no whole frame. With arguments this
// program is the writer that tests/test_result.py reads beside and kills:
//   test_result write PATH FRAMES DELAY_US    a fresh file
//   test_result resume PATH FRAMES DELAY_US   goes on to FRAMES frames
//   test_result check PATH FRAMES             has exactly so many frames, each as generated
//   test_result fill PATH BYTES               writes until the disk is full; exit code = whole frames
#define _POSIX_C_SOURCE 200809L
#include "tests/check.h"
#include "tests/scarce_memory.h"

#include "core/memory.h"
#include "io/result.h"

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { V = 300, F = 200, N = 60, E = 2, RESTART = 1000 };

// --- A file's content, the same in every process ---

static double value(int kind, int frame, int i) {
    if (kind == 3 && i % 97 == 5) {
        return NAN;
    }
    return sin(kind * 1000.0 + frame * 10.0 + i * 0.001);
}

typedef struct content {
    double rest[V][3], uv[4][2], nodes[N][3];
    int triangles[F][3], uv_triangles[F][3], face_group[F], source[V], elements[E][8];
    char* group_names[2];
    ruga_mesh mesh;
    ruga_lattice lattice;
    ruga_result_header header;
} content;

static void fill_content(content* c) {
    memset(c, 0, sizeof *c);
    static char first[] = "cheek", second[] = "Stirn \xc3\xa4";
    for (int v = 0; v < V; v++) {
        c->source[v] = v % 7 ? v : -1;
        for (int k = 0; k < 3; k++) {
            c->rest[v][k] = value(9, k, v);
        }
    }
    for (int f = 0; f < F; f++) {
        c->face_group[f] = f % 3 - 1;
        for (int k = 0; k < 3; k++) {
            c->triangles[f][k] = (f + k * 17) % V;
            c->uv_triangles[f][k] = (f + k) % 4;
        }
    }
    for (int e = 0; e < E * 8; e++) {
        c->elements[e / 8][e % 8] = e * 3;
    }
    for (int n = 0; n < N; n++) {
        c->nodes[n][0] = n;
    }
    c->group_names[0] = first;
    c->group_names[1] = second;
    c->mesh = (ruga_mesh){.vertex_count = V,
                          .position = c->rest[0],
                          .triangle_count = F,
                          .triangle = c->triangles[0],
                          .uv_count = 4,
                          .uv = c->uv[0],
                          .uv_triangle = c->uv_triangles[0],
                          .group_count = 2,
                          .group_name = c->group_names,
                          .face_group = c->face_group};
    c->lattice = (ruga_lattice){.degree = 1,
                                .nodes_per_element = 8,
                                .element_count = E,
                                .element_node = c->elements[0],
                                .node_count = N,
                                .rest = c->nodes[0]};
    c->header = (ruga_result_header){.mesh = &c->mesh,
                                     .lattice = &c->lattice,
                                     .scene_text = "mesh: a.obj\n",
                                     .libraries = "CHOLMOD 3",
                                     .scene_hash = 0xfedcba9876543210u,
                                     .mesh_hash = 0x0123456789abcdefu,
                                     .seed = -7,
                                     .mesh_unit = 0.001,
                                     .wavelength = 0.01,
                                     .critical_strain = 0.02,
                                     .cluster_sigma = 0.03,
                                     .cluster_radius = 0.04,
                                     .restart_doubles = RESTART};
}

typedef struct frame_data {
    double position[V][3], embedded[V][3], lattice[N][3], restart[RESTART];
    ruga_result_frame frame;
} frame_data;

static void fill_frame(frame_data* d, int k) {
    for (int i = 0; i < V * 3; i++) {
        d->position[i / 3][i % 3] = value(0, k, i);
        d->embedded[i / 3][i % 3] = value(1, k, i);
    }
    for (int i = 0; i < N * 3; i++) {
        d->lattice[i / 3][i % 3] = value(2, k, i);
    }
    for (int i = 0; i < RESTART; i++) {
        d->restart[i] = value(3, k, i);
    }
    double r = value(4, k, 0);
    d->frame = (ruga_result_frame){.time = k * 0.02,
                                   .position = d->position[0],
                                   .embedded = d->embedded[0],
                                   .lattice_position = d->lattice[0],
                                   .restart = d->restart};
    d->frame.report = (ruga_report){.outcome = (ruga_outcome)(k % 3),
                                    .newton_iterations = k,
                                    .linear_iterations = 2 * k,
                                    .factorizations = 3 * k,
                                    .substeps = 4 * k,
                                    .residual_shell = r,
                                    .residual_coupled = r + 1,
                                    .constraint_residual = r + 2,
                                    .energy_membrane = r + 3,
                                    .energy_bending = r + 4,
                                    .energy_foundation = r + 5,
                                    .energy_interior = r + 6,
                                    .energy_kinetic = r + 7,
                                    .energy_external = r + 8,
                                    .seconds_total = r + 9,
                                    .seconds_interior = r + 10,
                                    .seconds_assembly = r + 11,
                                    .seconds_factor = r + 12,
                                    .seconds_solve = r + 13,
                                    .seconds_other = r + 14};
}

static bool same_report(const ruga_report* a, const ruga_report* b) {
    return a->outcome == b->outcome && a->newton_iterations == b->newton_iterations &&
           a->linear_iterations == b->linear_iterations && a->factorizations == b->factorizations &&
           a->substeps == b->substeps &&
           memcmp(&a->residual_shell, &b->residual_shell, 15 * sizeof(double)) == 0;
}

// Frames [from, to), `delay` microseconds between them.
static ruga_status append_frames(ruga_result* result, int from, int to, long delay) {
    static frame_data data;
    for (int k = from; k < to; k++) {
        fill_frame(&data, k);
        RUGA_TRY(ruga_result_append(result, &data.frame));
        nanosleep(&(struct timespec){.tv_nsec = delay * 1000}, NULL);
    }
    return RUGA_OK;
}

static ruga_status write_file(const char* path, const ruga_result_header* header, int frames, long delay) {
    ruga_result* result;
    RUGA_TRY(ruga_result_create(path, header, true, &result));
    ruga_status status = append_frames(result, 0, frames, delay);
    ruga_status closed = ruga_result_close(&result);
    return status != RUGA_OK ? status : closed;
}

// The first of the frames that differs from what was generated, or their number.
static int first_wrong(ruga_result_reader* reader) {
    static frame_data wanted, found;
    int count = ruga_result_frame_count(reader);
    for (int k = 0; k < count; k++) {
        fill_frame(&wanted, k);
        bool interior = ruga_result_has_interior(reader);
        if (ruga_result_read_frame(reader, k, &found.frame.time, found.position[0],
                                   interior ? found.embedded[0] : NULL, &found.frame.report) != RUGA_OK ||
            found.frame.time != wanted.frame.time ||
            memcmp(found.position, wanted.position, sizeof found.position) != 0 ||
            (interior && memcmp(found.embedded, wanted.embedded, sizeof found.embedded) != 0) ||
            !same_report(&found.frame.report, &wanted.frame.report)) {
            return k;
        }
        if (interior && (ruga_result_read_lattice(reader, k, NULL, NULL, found.lattice[0]) != RUGA_OK ||
                         memcmp(found.lattice, wanted.lattice, sizeof found.lattice) != 0)) {
            return k;
        }
    }
    return count;
}

// --- The writer for other processes ---

static ruga_status resume_file(const char* path, const ruga_result_header* header, int frames, long delay) {
    static double restart[RESTART];
    static frame_data wanted;
    int done;
    ruga_result* result;
    RUGA_TRY(ruga_result_resume(path, header, restart, &done, &result));
    if (done == 0) {
        return write_file(path, header, frames, delay);
    }
    fill_frame(&wanted, done - 1);
    ruga_status status = memcmp(restart, wanted.restart, sizeof restart) == 0
                             ? append_frames(result, done, frames, delay)
                             : ruga_fail(RUGA_IO, "restart data of frame %d differ", done - 1);
    ruga_status closed = ruga_result_close(&result);
    return status != RUGA_OK ? status : closed;
}

static ruga_status check_file(const char* path, int frames) {
    ruga_result_reader* reader;
    RUGA_TRY(ruga_result_open(path, &reader));
    int count = ruga_result_frame_count(reader), wrong = first_wrong(reader);
    ruga_result_reader_close(&reader);
    return count == frames && wrong == frames
               ? RUGA_OK
               : ruga_fail(RUGA_IO, "%d frames, the first wrong one is %d", count, wrong);
}

// Number of whole frames, or 255 where something went otherwise than it should. Ends with the process, as the
// limit on file sizes stands in for a full disk.
static int write_until_full(const char* path, const ruga_result_header* header, rlim_t bytes) {
    (void)signal(SIGXFSZ, SIG_IGN);
    (void)setrlimit(RLIMIT_FSIZE, &(struct rlimit){bytes, bytes});
    ruga_result* result = NULL;
    ruga_status status = ruga_result_create(path, header, true, &result);
    int frame = 0;
    for (; status == RUGA_OK && frame < 1000; frame++) {
        status = append_frames(result, frame, frame + 1, 0);
    }
    bool sentence = strstr(ruga_last_error(), "File too large") != NULL;
    bool again = !result || append_frames(result, frame, frame + 1, 0) == RUGA_IO;
    (void)ruga_result_close(&result);
    if (status != RUGA_IO || !sentence || !again || ruga_byte_count() != 0) {
        print_error("%lu bytes: status %d: %s\n", (unsigned long)bytes, (int)status, ruga_last_error());
        return 255;
    }
    return frame > 0 ? frame - 1 : 0;
}

static int run_command(int count, char** arguments) {
    static content c;
    fill_content(&c);
    int frames = count > 3 ? atoi(arguments[3]) : 0;
    long delay = count > 4 ? atol(arguments[4]) : 0;
    if (strcmp(arguments[1], "fill") == 0) {
        return write_until_full(arguments[2], &c.header, (rlim_t)frames);
    }
    ruga_status status =
        strcmp(arguments[1], "write") == 0    ? write_file(arguments[2], &c.header, frames, delay)
        : strcmp(arguments[1], "resume") == 0 ? resume_file(arguments[2], &c.header, frames, delay)
                                              : check_file(arguments[2], frames);
    if (status != RUGA_OK) {
        (void)fprintf(stderr, "%s\n", ruga_last_error());
    }
    return status != RUGA_OK;
}

// --- Tests ---

static char folder[] = "/tmp/ruga_result_XXXXXX";
static char path[64];

static int make_folder(void** state) {
    (void)state;
    if (!mkdtemp(folder)) {
        return 1;
    }
    (void)snprintf(path, sizeof path, "%s/a.h5", folder);
    return 0;
}

static int remove_folder(void** state) {
    (void)unlink(path);
    return rmdir(folder) != 0 || check_no_leak(state); // so a temporary file left behind fails
}

static void what_is_written_is_read(void** state) {
    (void)state;
    static content c;
    fill_content(&c);
    assert_ok(write_file(path, &c.header, 300, 0)); // more than two chunks of /stats
    assert_ok(check_file(path, 300));
    ruga_result_reader* reader;
    assert_ok(ruga_result_open(path, &reader));
    const ruga_mesh* mesh = ruga_result_mesh(reader);
    assert_int_equal(mesh->vertex_count, V);
    assert_memory_equal(mesh->position, c.rest, sizeof c.rest);
    assert_memory_equal(mesh->triangle, c.triangles, sizeof c.triangles);
    assert_memory_equal(mesh->uv, c.uv, sizeof c.uv);
    assert_memory_equal(mesh->uv_triangle, c.uv_triangles, sizeof c.uv_triangles);
    assert_memory_equal(mesh->face_group, c.face_group, sizeof c.face_group);
    assert_string_equal(mesh->group_name[1], c.group_names[1]);
    assert_int_equal(mesh->source_vertex[V - 1], V - 1); // identity where the mesh had none
    const ruga_result_header* header = ruga_result_reader_header(reader);
    assert_string_equal(header->scene_text, c.header.scene_text);
    assert_true(header->scene_hash == c.header.scene_hash && header->mesh_hash == c.header.mesh_hash);
    assert_true(header->seed == -7 && header->mesh_unit == 0.001 && header->wavelength == 0.01);
    assert_true(header->critical_strain == 0.02 && header->cluster_sigma == 0.03);
    assert_true(header->cluster_radius == 0.04);
    assert_int_equal(header->restart_doubles, RESTART);
    int nodes, elements, nodes_per_element, element[E][8];
    double rest[N][3];
    assert_ok(ruga_result_read_lattice(reader, 0, &nodes, &elements, NULL));
    assert_ok(ruga_result_read_lattice_rest(reader, &nodes_per_element, element[0], rest[0]));
    assert_true(nodes == N && elements == E && nodes_per_element == 8);
    assert_memory_equal(element, c.elements, sizeof element);
    assert_memory_equal(rest, c.nodes, sizeof rest);
    assert_status(ruga_result_read_frame(reader, 300, NULL, NULL, NULL, NULL), RUGA_BAD_INPUT);
    assert_status(ruga_result_read_frame(reader, -1, NULL, NULL, NULL, NULL), RUGA_BAD_INPUT);
    ruga_result_reader_close(&reader);
}

static void without_interior_there_is_no_lattice(void** state) {
    (void)state;
    static content c;
    fill_content(&c);
    c.mesh.uv = NULL;
    c.mesh.uv_triangle = NULL;
    c.mesh.face_group = NULL;
    c.mesh.source_vertex = c.source;
    c.header.lattice = NULL;
    c.header.restart_doubles = 0;
    c.header.libraries = NULL;
    assert_ok(write_file(path, &c.header, 3, 0));
    assert_ok(check_file(path, 3));
    ruga_result_reader* reader;
    assert_ok(ruga_result_open(path, &reader));
    assert_false(ruga_result_has_interior(reader));
    assert_memory_equal(ruga_result_mesh(reader)->source_vertex, c.source, sizeof c.source);
    double unused[3];
    assert_status(ruga_result_read_frame(reader, 0, NULL, NULL, unused, NULL), RUGA_BAD_INPUT);
    assert_status(ruga_result_read_lattice(reader, 0, NULL, NULL, unused), RUGA_BAD_INPUT);
    ruga_result_reader_close(&reader);
    ruga_result* result;
    int done;
    assert_ok(ruga_result_resume(path, &c.header, NULL, &done, &result));
    assert_int_equal(done, 3);
    assert_ok(append_frames(result, 3, 5, 0));
    assert_ok(ruga_result_close(&result));
    assert_ok(check_file(path, 5));
}

// Where it varies; a value that cannot be is a damaged file.
static void a_skin_that_varies_is_written_and_read(void** state) {
    (void)state;
    static content c;
    static double thickness[V], wavelength[V], growth[V][2];
    ruga_result_reader* reader;
    fill_content(&c);
    for (int v = 0; v < V; v++) {
        thickness[v] = 1e-3 * (v + 1);
        wavelength[v] = 1e-2 * (v + 1);
        growth[v][0] = 1 + 0.001 * v;
        growth[v][1] = 2;
    }
    c.header.vertex_thickness = thickness;
    c.header.vertex_wavelength = wavelength;
    c.header.vertex_growth = growth[0];
    assert_ok(write_file("skin.h5", &c.header, 2, 0));
    assert_ok(resume_file("skin.h5", &c.header, 3, 0));
    assert_ok(ruga_result_open("skin.h5", &reader));
    const ruga_result_header* header = ruga_result_reader_header(reader);
    assert_memory_equal(header->vertex_thickness, thickness, sizeof thickness);
    assert_memory_equal(header->vertex_wavelength, wavelength, sizeof wavelength);
    assert_memory_equal(header->vertex_growth, growth, sizeof growth);
    assert_null(header->vertex_young);
    ruga_result_reader_close(&reader);
    thickness[7] = 0;
    assert_ok(write_file("skin.h5", &c.header, 1, 0));
    assert_status(ruga_result_open("skin.h5", &reader), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "/mesh/thickness"));
    (void)unlink("skin.h5");
}

static void a_file_is_there_from_its_first_frame_on(void** state) {
    (void)state;
    static content c;
    fill_content(&c);
    (void)unlink(path);
    ruga_result* result;
    assert_ok(ruga_result_create(path, &c.header, false, &result));
    assert_int_not_equal(access(path, F_OK), 0);
    assert_ok(append_frames(result, 0, 1, 0));
    assert_ok(check_file(path, 1)); // while it is written
    assert_ok(append_frames(result, 1, 2, 0));
    assert_ok(check_file(path, 2));
    assert_ok(ruga_result_close(&result));
    assert_status(ruga_result_create(path, &c.header, false, &result), RUGA_BAD_INPUT);
    assert_null(result);
    // Given up before its first frame, a new file leaves the old one alone.
    assert_ok(ruga_result_create(path, &c.header, true, &result));
    assert_ok(ruga_result_close(&result));
    assert_ok(check_file(path, 2));
}

static void resume_refuses_what_does_not_fit(void** state) {
    (void)state;
    static content c;
    static double restart[RESTART + 1];
    int done;
    ruga_result* result;
    fill_content(&c);
    assert_ok(write_file(path, &c.header, 2, 0));
    c.header.scene_hash++;
    assert_status(ruga_result_resume(path, &c.header, restart, &done, &result), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "another scene"));
    fill_content(&c);
    c.header.mesh_hash++;
    assert_status(ruga_result_resume(path, &c.header, restart, &done, &result), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "another mesh"));
    fill_content(&c);
    c.mesh.vertex_count--;
    assert_status(ruga_result_resume(path, &c.header, restart, &done, &result), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "vertices"));
    fill_content(&c);
    c.header.restart_doubles++;
    assert_status(ruga_result_resume(path, &c.header, restart, &done, &result), RUGA_BAD_INPUT);
    fill_content(&c);
    c.header.lattice = NULL;
    assert_status(ruga_result_resume(path, &c.header, restart, &done, &result), RUGA_BAD_INPUT);
    assert_null(result);
    assert_ok(check_file(path, 2));
    (void)unlink(path);
    fill_content(&c);
    assert_ok(ruga_result_resume(path, &c.header, restart, &done, &result));
    assert_true(done == 0 && result == NULL);
}

static void temporary_files_of_dead_runs_are_removed(void** state) {
    (void)state;
    static content c;
    fill_content(&c);
    pid_t child = fork();
    if (child == 0) {
        ruga_result* result;
        _exit(ruga_result_create(path, &c.header, true, &result) != RUGA_OK);
    }
    int code;
    assert_int_equal(waitpid(child, &code, 0), child);
    assert_int_equal(code, 0);
    char left[128], kept[128];
    (void)snprintf(left, sizeof left, "%s.part-%ld", path, (long)child);
    (void)snprintf(kept, sizeof kept, "%s.part-%ld", path, (long)getppid());
    assert_int_equal(access(left, F_OK), 0);
    (void)close(open(kept, O_CREAT | O_WRONLY, 0600));
    assert_ok(write_file(path, &c.header, 1, 0));
    assert_int_not_equal(access(left, F_OK), 0);
    assert_int_equal(access(kept, F_OK), 0); // of a process that runs
    (void)unlink(kept);
}

static void a_full_disk_is_a_status_and_keeps_whole_frames(void** state) {
    (void)state;
    static content c;
    fill_content(&c);
    for (rlim_t bytes = 1000; bytes < 400000; bytes += 13331) {
        (void)unlink(path);
        pid_t child = fork();
        if (child == 0) {
            char text[32];
            (void)snprintf(text, sizeof text, "%lu", (unsigned long)bytes);
            (void)execl("/proc/self/exe", "test_result", "fill", path, text, (char*)NULL);
            _exit(255);
        }
        int code;
        assert_int_equal(waitpid(child, &code, 0), child);
        assert_true(WIFEXITED(code) && WEXITSTATUS(code) != 255);
        if (WEXITSTATUS(code) > 0) {
            assert_ok(check_file(path, WEXITSTATUS(code)));
        } else {
            assert_int_not_equal(access(path, F_OK), 0);
        }
    }
}

static char* read_bytes(const char* name, size_t* size) {
    FILE* file = fopen(name, "rb");
    assert_non_null(file);
    (void)fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    char* bytes = malloc(*size);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    (void)fclose(file);
    return bytes;
}

static void write_bytes(const char* name, const char* bytes, size_t size) {
    FILE* file = fopen(name, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    (void)fclose(file);
}

static void try_reading(const char* name) {
    ruga_result_reader* reader;
    ruga_status status = ruga_result_open(name, &reader);
    if (status == RUGA_OK) {
        (void)first_wrong(reader);
        ruga_result_reader_close(&reader);
    } else {
        assert_true(status == RUGA_BAD_INPUT || status == RUGA_IO || status == RUGA_NO_MEMORY);
        assert_true(strncmp(ruga_last_error(), name, strlen(name)) == 0);
        assert_null(reader);
    }
}

static void damaged_files_are_refused_with_a_sentence(void** state) {
    (void)state;
    static content c;
    fill_content(&c);
    ruga_result_reader* reader;
    assert_status(ruga_result_open("/nowhere/a.h5", &reader), RUGA_IO);
    assert_status(ruga_result_open(folder, &reader), RUGA_IO);
    write_bytes(path, "", 0);
    assert_status(ruga_result_open(path, &reader), RUGA_BAD_INPUT);
    write_bytes(path, "o mesh\nv 0 0 0\n", 15);
    assert_status(ruga_result_open(path, &reader), RUGA_BAD_INPUT);
    assert_ok(write_file(path, &c.header, 3, 0));
    size_t size;
    char* bytes = read_bytes(path, &size);
    for (size_t length = 0; length < size; length += 1 + size / 60) {
        write_bytes(path, bytes, length);
        try_reading(path);
    }
    for (size_t at = 0; at < size; at += 1 + size / 150) {
        bytes[at] ^= 0x55;
        write_bytes(path, bytes, size);
        try_reading(path);
        bytes[at] ^= 0x55;
    }
    free(bytes);
}

static ruga_status write_read_resume(const content* c) {
    static double restart[RESTART];
    RUGA_TRY(write_file(path, &c->header, 2, 0));
    RUGA_TRY(check_file(path, 2));
    int done;
    ruga_result* result;
    RUGA_TRY(ruga_result_resume(path, &c->header, restart, &done, &result));
    return ruga_result_close(&result);
}

static void failed_allocations_are_a_status(void** state) {
    (void)state;
    static content c;
    fill_content(&c);
    for (int k = 0;; k++) {
        let_allocations_fail_after(k);
        ruga_status status = write_read_resume(&c);
        ruga_set_allocator(NULL, NULL, NULL);
        assert_int_equal(ruga_byte_count(), 0);
        if (status == RUGA_OK) {
            assert_true(k > 10);
            break;
        }
        assert_int_equal(status, RUGA_NO_MEMORY);
    }
}

int main(int count, char** arguments) {
    if (count > 2) {
        return run_command(count, arguments);
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_written_is_read),
        cmocka_unit_test(without_interior_there_is_no_lattice),
        cmocka_unit_test(a_skin_that_varies_is_written_and_read),
        cmocka_unit_test(a_file_is_there_from_its_first_frame_on),
        cmocka_unit_test(resume_refuses_what_does_not_fit),
        cmocka_unit_test(temporary_files_of_dead_runs_are_removed),
        cmocka_unit_test(a_full_disk_is_a_status_and_keeps_whole_frames),
        cmocka_unit_test(damaged_files_are_refused_with_a_sentence),
        cmocka_unit_test(failed_allocations_are_a_status),
    };
    return cmocka_run_group_tests_name("result", tests, make_folder, remove_folder);
}
