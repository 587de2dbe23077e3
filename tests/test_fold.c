// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#include "tests/check.h"
#include "tests/crease_case.h"
#include "tests/scarce_memory.h"

#include "io/fold.h"
#include "mesh/remesh.h"

static const char FILE_NAME[] = "test_fold.fold";
static const char DRAWING[] = "test_fold.svg";

static void write_text(const char* path, const char* text) {
    FILE* file = fopen(path, "wb");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static void read_text(const char* text, ruga_crease_pattern* p) {
    write_text(FILE_NAME, text);
    assert_ok(ruga_fold_read(FILE_NAME, 0, 1, p));
}

static void refuse_text(const char* text, const char* sentence) {
    ruga_crease_pattern p;
    write_text(FILE_NAME, text);
    assert_status(ruga_fold_read(FILE_NAME, 0, 1, &p), RUGA_BAD_INPUT);
    if (!strstr(ruga_last_error(), sentence)) {
        print_error("\"%s\" does not say \"%s\"\n", ruga_last_error(), sentence);
        fail();
    }
}

static void draw_text(const char* text, ruga_crease_pattern* p) {
    write_text(DRAWING, text);
    assert_ok(ruga_svg_read(DRAWING, 1, 1e-4, p));
}

static int count_edges(const ruga_crease_pattern* p, ruga_assignment assignment) {
    int count = 0;
    for (int e = 0; e < p->edge_count; e++) {
        count += p->edge[e].assignment == assignment;
    }
    return count;
}

static bool has_note(const ruga_crease_pattern* p, const char* part) {
    for (int i = 0; i < p->note_count; i++) {
        if (strstr(p->note[i], part)) {
            return true;
        }
    }
    return false;
}

static double length_of(const ruga_crease_pattern* p, ruga_assignment assignment) {
    double length = 0;
    for (int e = 0; e < p->edge_count; e++) {
        const int* v = p->edge[e].vertex;
        length +=
            p->edge[e].assignment == assignment ? ruga_distance(p->position[v[0]], p->position[v[1]]) : 0;
    }
    return length;
}

// A square with a cross of creases: three mountains and a valley.
#define SQUARE                                                                                               \
    "\"vertices_coords\": [[0,0],[1,0],[2,0],[2,1],[2,2],[1,2],[0,2],[0,1],[1,1]],\n"                        \
    "\"edges_vertices\": [[0,1],[1,2],[2,3],[3,4],[4,5],[5,6],[6,7],[7,0],[1,8],[3,8],[5,8],[7,8]],\n"       \
    "\"edges_assignment\": [\"B\",\"B\",\"B\",\"B\",\"B\",\"B\",\"B\",\"B\",\"M\",\"M\",\"V\",\"M\"]"
#define SQUARE_FACES "\"faces_vertices\": [[0,1,8,7],[1,2,3,8],[3,4,5,8],[6,7,8,5]]"

// ------------------------------------------------------------------------------- FOLD

static void a_plain_pattern_is_read_as_it_is(void** state) {
    (void)state;
    ruga_crease_pattern p;
    read_text(
        "\xef\xbb\xbf{" SQUARE // with a byte order mark
        ", \"edges_foldAngle\": [0,0,0,0,0,0,0,0,-180,-90,45.5,null], \"frame_unit\": \"cm\"," SQUARE_FACES
        "}",
        &p);
    assert_int_equal(p.vertex_count, 9);
    assert_int_equal(p.edge_count, 12);
    assert_int_equal(p.face_count, 4);
    assert_int_equal(p.note_count, 0);
    assert_near(p.position[4][0], 0.02, 1e-17);
    assert_near(ruga_crease_pattern_rest(&p.edge[9]), -RUGA_PI / 2, 1e-15);
    assert_near(ruga_crease_pattern_rest(&p.edge[10]), 45.5 * RUGA_PI / 180, 1e-15);
    assert_near(ruga_crease_pattern_rest(&p.edge[11]), -RUGA_PI, 0); // null: a mountain all the way
    assert_near(ruga_crease_pattern_rest(&p.edge[0]), 0, 0);
    ruga_mesh mesh;
    assert_ok(ruga_crease_pattern_mesh(&p, FILE_NAME, &mesh));
    assert_int_equal(mesh.triangle_count, 2); // its outline alone
    assert_near(ruga_mesh_area(&mesh), 4e-4, 1e-17);
    ruga_mesh_clear(&mesh);
    ruga_crease_pattern_clear(&p);
}

static void missing_faces_are_found_and_said(void** state) {
    (void)state;
    ruga_crease_pattern p;
    read_text("{" SQUARE "}", &p);
    assert_int_equal(p.face_count, 4);
    assert_int_equal(p.corner_count, 16);
    assert_true(has_note(&p, "faces_vertices is missing"));
    ruga_crease_pattern_clear(&p);
    // Clockwise faces are turned.
    read_text("{" SQUARE ", \"faces_vertices\": [[7,8,1,0],[1,2,3,8],[3,4,5,8],[6,7,8,5]]}", &p);
    assert_int_equal(p.corner[0], 0);
    ruga_crease_pattern_clear(&p);
}

static void bad_patterns_are_repaired_aloud(void** state) {
    (void)state;
    ruga_crease_pattern p;
    // Two lines that cross without a vertex; one drawn twice; one without length; one that ends in the open;
    // one alone in the middle of a face; one end that misses its vertex by a hair.
    read_text("{\"vertices_coords\": "
              "[[0,0],[4,0],[4,4],[0,4],[2,0],[2,4],[0,2],[4,2],[1,1],[1.5,0.5],[0.5,3],[1.5,3],"
              "[3.0000000001,4],[3,3]],"
              "\"edges_vertices\": [[0,1],[1,2],[2,3],[3,0],[4,5],[6,7],[5,4],[3,3],[10,11],[12,13]],"
              "\"edges_assignment\": [\"B\",\"B\",\"B\",\"B\",\"M\",\"V\",\"M\",\"V\",\"M\",\"V\"]}",
              &p);
    assert_int_equal(p.face_count, 4);
    assert_true(has_note(&p, "1 lines without length"));
    assert_true(has_note(&p, "1 lines on top of others"));
    assert_true(has_note(&p, "1 crossings of lines became vertices"));
    assert_true(has_note(&p, "vertices on lines split them"));
    assert_true(has_note(&p, "2 lines end within a face"));
    assert_int_equal(count_edges(&p, RUGA_ASSIGNMENT_BORDER), 4 + 5);
    assert_near(length_of(&p, RUGA_ASSIGNMENT_MOUNTAIN), 4 + 1, 1e-9);
    assert_near(length_of(&p, RUGA_ASSIGNMENT_VALLEY), 4 + 1, 1e-9);
    ruga_crease_pattern_clear(&p);
    // An outline that is open at (0, 0), beside a closed one; and an angle of the other sign than the
    // letter's.
    read_text("{\"vertices_coords\": [[0,0],[1,0],[2,0],[2,1],[1,1],[0,1]],"
              "\"edges_vertices\": [[1,2],[2,3],[3,4],[4,5],[5,0],[1,4],[1,3]],"
              "\"edges_assignment\": [\"B\",\"B\",\"B\",\"B\",\"B\",\"B\",\"V\"],"
              "\"edges_foldAngle\": [0,0,0,0,0,0,-30]}",
              &p);
    assert_true(has_note(&p, "2 border lines enclose nothing, as the outline is open at (0, 0)"));
    assert_true(
        has_note(&p, "edges_foldAngle[6] is -30 degrees, although edges_assignment calls the line a valley"));
    assert_false(has_note(&p, "end within a face"));
    assert_int_equal(p.face_count, 2);
    ruga_crease_pattern_clear(&p);
    // A curved valley in two pieces with a flat line between, and angles that differ by round-off, is one
    // crease, which may bend.
    read_text("{\"vertices_coords\": [[0,0],[2,0],[4,0],[4,4],[2,4],[0,4],[1.8,2]],"
              "\"edges_vertices\": [[0,1],[1,2],[2,3],[3,4],[4,5],[5,0],[1,6],[6,4],[6,3]],"
              "\"edges_assignment\": [\"B\",\"B\",\"B\",\"B\",\"B\",\"B\",\"V\",\"V\",\"F\"],"
              "\"edges_foldAngle\": [0,0,0,0,0,0,30,30.000000000001,0]}",
              &p);
    ruga_curves bent = {0};
    assert_ok(ruga_crease_pattern_curves(&p, &(ruga_curve){0}, false, &bent));
    assert_int_equal(bent.count, 1);
    assert_int_equal(bent.curve[0].point_count, 3);
    assert_int_equal(bent.curve[0].freedom, RUGA_FREEDOM_FULL);
    ruga_curves_clear(&bent);
    ruga_crease_pattern_clear(&p);
    // A closed line that nothing joins to the border.
    read_text("{\"vertices_coords\": [[0,0],[4,0],[4,4],[0,4],[1,1],[2,1],[2,2]],"
              "\"edges_vertices\": [[0,1],[1,2],[2,3],[3,0],[4,5],[5,6],[6,4]],"
              "\"edges_assignment\": [\"B\",\"B\",\"B\",\"B\",\"M\",\"M\",\"M\"]}",
              &p);
    assert_true(has_note(&p, "joined to no border"));
    assert_int_equal(p.face_count, 1);
    ruga_curves curves = {0};
    assert_ok(ruga_crease_pattern_curves(&p, &(ruga_curve){0}, false, &curves));
    assert_int_equal(curves.count, 1);
    assert_true(curves.curve[0].closed && curves.curve[0].point_count == 3);
    ruga_curves_clear(&curves);
    ruga_crease_pattern_clear(&p);
    // An outline that nobody marked.
    read_text("{\"vertices_coords\": [[0,0],[1,0],[0,1]], \"edges_vertices\": [[0,1],[1,2],[2,0]]}", &p);
    assert_true(has_note(&p, "3 lines along the outline"));
    ruga_crease_pattern_clear(&p);
}

static void assert_meshed_area(const ruga_crease_pattern* p, double area) {
    ruga_mesh mesh;
    assert_ok(ruga_crease_pattern_mesh(p, FILE_NAME, &mesh));
    assert_near(ruga_mesh_area(&mesh), area, 1e-12 * area);
    ruga_mesh_clear(&mesh);
}

#define RING       "[0,0],[4,0],[4,4],[0,4],[1,1],[3,1],[3,3],[1,3]"
#define RING_EDGES "[0,1],[1,2],[2,3],[3,0],[4,5],[5,6],[6,7],[7,4]"

static void borders_within_the_sheet_cut_holes(void** state) {
    (void)state;
    ruga_crease_pattern p;
    // A hole that nothing joins to the outline, with an island in it and a closed crease around it.
    read_text("{\"vertices_coords\": [" RING
              ",[1.5,1.5],[2.5,1.5],[2,2.5],[0.5,0.5],[3.5,0.5],[3.5,3.5],[0.5,3.5]],"
              "\"edges_vertices\": [" RING_EDGES ",[8,9],[9,10],[10,8],[11,12],[12,13],[13,14],[14,11]],"
              "\"edges_assignment\": "
              "[\"B\",\"B\",\"B\",\"B\",\"B\",\"B\",\"B\",\"B\",\"B\",\"B\",\"B\",\"M\",\"M\",\"M\",\"M\"]}",
              &p);
    assert_true(has_note(&p, "1 places within borders"));
    assert_int_equal(p.face_count, 2);
    assert_meshed_area(&p, 16 - 4 + 0.5);
    ruga_crease_pattern_clear(&p);
    // Creases from its corners to the outline; faces given, but for the hole, and not given.
    static const char* const faces[] = {"", ",\"faces_vertices\": [[0,1,5,4],[1,2,6,5],[2,3,7,6],[3,0,4,7]]"};
    for (int k = 0; k < 2; k++) {
        char text[1024];
        (void)snprintf(
            text, sizeof text,
            "{\"vertices_coords\": [" RING "], \"edges_vertices\": [" RING_EDGES
            ",[0,4],[1,5],[2,6],[3,7]], \"edges_assignment\": [\"B\",\"B\",\"B\",\"B\",\"B\",\"B\","
            "\"B\",\"B\",\"M\",\"V\",\"M\",\"V\"]%s}",
            faces[k]);
        read_text(text, &p);
        assert_int_equal(p.face_count, 4);
        assert_int_equal(p.note_count, k ? 0 : 2);
        assert_meshed_area(&p, 12);
        ruga_crease_pattern_clear(&p);
    }
    // A border across the sheet parts no paper from a hole; two sheets beside one another are two sheets.
    read_text("{\"vertices_coords\": [[0,0],[1,0],[2,0],[2,1],[1,1],[0,1],[5,0],[6,0],[6,1]],"
              "\"edges_vertices\": [[0,1],[1,2],[2,3],[3,4],[4,5],[5,0],[1,4],[6,7],[7,8],[8,6]],"
              "\"edges_assignment\": [\"B\",\"B\",\"B\",\"B\",\"B\",\"B\",\"B\",\"B\",\"B\",\"B\"]}",
              &p);
    assert_int_equal(p.face_count, 3);
    assert_meshed_area(&p, 2.5);
    ruga_crease_pattern_clear(&p);
    // A hole that the faces say nothing of.
    read_text("{\"vertices_coords\": [" RING "], \"edges_vertices\": [" RING_EDGES
              "], \"edges_assignment\": [\"B\",\"B\",\"B\",\"B\",\"B\",\"B\",\"B\",\"B\"], "
              "\"faces_vertices\": [[0,1,2,3]]}",
              &p);
    assert_meshed_area(&p, 12);
    ruga_crease_pattern_clear(&p);
    // A face that is missing by mistake: its creases say that there is paper.
    read_text("{" SQUARE ", \"faces_vertices\": [[0,1,8,7],[1,2,3,8],[3,4,5,8]]}", &p);
    assert_true(has_note(&p, "faces_vertices disagrees"));
    assert_int_equal(p.face_count, 4);
    ruga_crease_pattern_clear(&p);
}

static void broken_files_are_refused_with_the_field(void** state) {
    (void)state;
    refuse_text("{", "not JSON");
    refuse_text("[1]", "is a JSON object");
    refuse_text("{}", "has no vertices_coords");
    refuse_text("{\"vertices_coords\": [[0,0],[1]]}", "vertices_coords[1] does not have two or three");
    refuse_text("{\"vertices_coords\": [[0,0],[1,\"a\"]]}",
                "vertices_coords[1] is not made of finite numbers");
    refuse_text("{\"vertices_coords\": [[0,0],[1,0]]}", "neither edges_vertices nor faces_vertices");
    refuse_text("{\"vertices_coords\": [[0,0],[1,0]], \"edges_vertices\": [[0,2]]}",
                "edges_vertices[0] names a vertex that does not exist");
    refuse_text("{\"vertices_coords\": [[0,0],[1,0]], \"edges_vertices\": [[0,1,1]]}",
                "does not have two vertices");
    refuse_text(
        "{\"vertices_coords\": [[0,0],[1,0]], \"edges_vertices\": [[0,1]], \"edges_assignment\": [\"X\"]}",
        "edges_assignment[0] is not one of");
    refuse_text(
        "{\"vertices_coords\": [[0,0],[1,0]], \"edges_vertices\": [[0,1]], \"edges_foldAngle\": [1,2]}",
        "edges_foldAngle has 2 entries, but edges_vertices has 1");
    refuse_text("{\"vertices_coords\": [[0,0],[1,0],[1,1]], \"faces_vertices\": [[0,1]]}",
                "faces_vertices[0] does not have three vertices");
    refuse_text("{\"vertices_coords\": [[0,0],[1,0]], \"edges_vertices\": [[0,1]], \"frame_unit\": \"mile\"}",
                "frame_unit");
    refuse_text("{\"vertices_coords\": [[0,0],[1,0],[2,1]], \"edges_vertices\": [[0,1],[1,2]]}",
                "no closed outline");
    ruga_crease_pattern p;
    assert_status(ruga_fold_read("no/such.fold", 0, 1, &p), RUGA_IO);
}

static void frames_inherit(void** state) {
    (void)state;
    ruga_crease_pattern p;
    write_text(
        FILE_NAME,
        "{" SQUARE "," SQUARE_FACES
        ", \"file_frames\": [{\"frame_parent\": 0, \"frame_inherit\": true, \"frame_classes\": "
        "[\"foldedForm\"], \"vertices_coords\": [[0,0,1],[1,0,0],[2,0,1],[2,1,1],[2,2,1],[1,2,0],[0,2,1],"
        "[0,1,1],[1,1,0]]}, {\"frame_inherit\": true, \"frame_parent\": 2}]}");
    assert_ok(ruga_fold_read(FILE_NAME, 1, 2, &p));
    assert_true(p.folded);
    assert_near(p.position[0][2], 2, 0);
    assert_int_equal(p.edge_count, 12);
    ruga_crease_pattern_clear(&p);
    assert_status(ruga_fold_read(FILE_NAME, 2, 1, &p), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "inherits from itself"));
    assert_status(ruga_fold_read(FILE_NAME, 3, 1, &p), RUGA_BAD_INPUT);
    assert_non_null(strstr(ruga_last_error(), "frame 3 does not exist: there are 3"));
    // Edges of faces alone.
    read_text(
        "{\"vertices_coords\": [[0,0,0],[1,0,0],[1,1,1],[0,1,0]], \"faces_vertices\": [[0,1,2],[0,2,3]]}",
        &p);
    assert_int_equal(p.edge_count, 5);
    assert_int_equal(count_edges(&p, RUGA_ASSIGNMENT_UNASSIGNED), 1);
    ruga_crease_pattern_clear(&p);
}

static void what_is_written_reads_back_to_the_bit(void** state) {
    (void)state;
    ruga_crease_pattern p, q;
    read_text("{" SQUARE "," SQUARE_FACES "}", &p);
    double flat[27], bent[27], angle[12];
    for (int i = 0; i < 27; i++) {
        flat[i] = p.position[i / 3][i % 3];
        bent[i] = flat[i] / 3 + (i % 3 == 2 ? 0.1 * i : 0);
    }
    for (int e = 0; e < 12; e++) {
        angle[e] = e < 8 ? NAN : 0.1 * e - 1;
    }
    const ruga_fold_frame frame[2] = {{flat, NULL, 0}, {bent, angle, 0.25}};
    assert_ok(ruga_fold_write(FILE_NAME, &p, "m", true, 2, frame));
    assert_ok(ruga_fold_read(FILE_NAME, 0, 1, &q));
    assert_false(q.folded);
    assert_int_equal(q.note_count, 0);
    assert_memory_equal(q.position, p.position, 9 * sizeof *p.position);
    assert_int_equal(q.face_count, 4);
    ruga_crease_pattern_clear(&q);
    assert_ok(ruga_fold_read(FILE_NAME, 1, 1, &q));
    assert_true(q.folded);
    assert_memory_equal(q.position, bent, sizeof bent);
    for (int e = 0; e < 12; e++) {
        assert_int_equal(q.edge[e].assignment, p.edge[e].assignment);
        assert_true(e < 8 ? isnan(q.edge[e].angle) : fabs(q.edge[e].angle - angle[e]) < 1e-15);
    }
    ruga_crease_pattern_clear(&p);
    ruga_crease_pattern_clear(&q);
}

static void creases_are_chained_where_nothing_else_meets_them(void** state) {
    (void)state;
    ruga_crease_pattern p;
    ruga_curves curves = {0};
    // A valley in three pieces, the last with another angle; a flat line; a cut.
    read_text(
        "{\"vertices_coords\": [[0,0],[4,0],[4,4],[0,4],[0,1],[1,1.2],[2,1.2],[4,1],[0,3],[4,3],[1,2],[3,2]],"
        "\"edges_vertices\": "
        "[[0,1],[1,7],[7,9],[9,2],[2,3],[3,8],[8,4],[4,0],[5,6],[4,5],[6,7],[8,9],[10,11]],"
        "\"edges_assignment\": "
        "[\"B\",\"B\",\"B\",\"B\",\"B\",\"B\",\"B\",\"B\",\"V\",\"V\",\"V\",\"F\",\"C\"],"
        "\"edges_foldAngle\": [0,0,0,0,0,0,0,0,90,90,45,0,0]}",
        &p);
    assert_ok(ruga_crease_pattern_curves(&p, &(ruga_curve){.freedom = RUGA_FREEDOM_FULL}, false, &curves));
    assert_int_equal(curves.count, 3);
    assert_int_equal(curves.curve[0].point_count, 3);
    assert_near(ruga_crease_pattern_rest(&p.edge[curves.curve[0].label]), RUGA_PI / 2, 1e-15);
    assert_int_equal(curves.curve[2].kind, RUGA_CREASE_CUT);
    assert_int_equal(curves.curve[2].freedom, RUGA_FREEDOM_FULL);
    ruga_curves_clear(&curves);
    assert_ok(ruga_crease_pattern_curves(&p, &(ruga_curve){0}, true, &curves));
    assert_int_equal(curves.count, 4);
    ruga_curves_clear(&curves);
    ruga_crease_pattern_clear(&p);
}

// ------------------------------------------------------------------------------- SVG

#define SHEET "<rect x='0' y='0' width='10' height='10' stroke='#000' fill='none'/>"

static void strokes_say_what_lines_are(void** state) {
    (void)state;
    ruga_crease_pattern p;
    draw_text(
        "<?xml version='1.0'?><!DOCTYPE svg [<!ENTITY a 'b'>]>\n<svg xmlns='http://www.w3.org/2000/svg'>\n"
        "<style>.m, .n { stroke: #F00; } .v{stroke:rgb(0, 0, 255)}</style><!-- > -->\n" SHEET
        "<line class='m' x1='1' y1='0' x2='1' y2='10'/>"
        "<svg:line class='x v' x1='2px' y1='0' x2='2px' y2='10'/>"
        "<g stroke='yellow'><line x1='3' y1='0' x2='3' y2='10'/></g>"
        "<line style='stroke:#00FF00;fill:none' x1='4' y1='0' x2='4' y2='10'/>"
        "<line stroke='magenta' x1='5' y1='0' x2='5' y2='10'/>"
        "<line stroke='#808080' x1='6' y1='0' x2='6' y2='10'/>"
        "<g opacity='0.5'><line stroke='red' x1='7' y1='0' x2='7' y2='10'/></g>"
        "<line stroke='#10f' stroke-opacity='25%' x1='8' y1='0' x2='8' y2='10'/>"
        "<defs><line stroke='red' x1='0' y1='0' x2='9' y2='9'/></defs>"
        "<line stroke='red' display='none' x1='0' y1='0' x2='9' y2='9'/>"
        "<line x1='0' y1='0' x2='9' y2='9'/>"
        "<line stroke='chucknorris' x1='0' y1='0' x2='9' y2='9'/>"
        "</svg>",
        &p);
    assert_int_equal(p.face_count, 9);
    assert_true(has_note(
        &p,
        "1 shapes were left out, as the colour of their stroke is not known; the first is 'chucknorris'"));
    const ruga_assignment wanted[] = {
        RUGA_ASSIGNMENT_MOUNTAIN,   RUGA_ASSIGNMENT_VALLEY, RUGA_ASSIGNMENT_FLAT,     RUGA_ASSIGNMENT_CUT,
        RUGA_ASSIGNMENT_UNASSIGNED, RUGA_ASSIGNMENT_FLAT,   RUGA_ASSIGNMENT_MOUNTAIN, RUGA_ASSIGNMENT_VALLEY};
    const double rest[] = {-1, 1, 0, 0, 0, 0, -0.5, 0.25};
    for (int e = 0; e < p.edge_count; e++) {
        const double* x = p.position[p.edge[e].vertex[0]];
        int k = (int)(x[0] + 0.5) - 1;
        if (p.edge[e].assignment != RUGA_ASSIGNMENT_BORDER) {
            assert_int_equal(p.edge[e].assignment, wanted[k]);
            assert_near(ruga_crease_pattern_rest(&p.edge[e]), rest[k] * RUGA_PI, 1e-15);
        }
        assert_true(x[1] <= 0); // y points up now
    }
    assert_true(has_note(&p, "1 shapes without a stroke"));
    ruga_crease_pattern_clear(&p);
}

static void all_path_commands_and_transforms_are_drawn(void** state) {
    (void)state;
    ruga_crease_pattern p;
    // Lines of length 1, 2, 3 ... each in another way.
    draw_text(
        "<svg><rect x='-50' y='-50' width='100' height='100' stroke='black'/>"
        "<path stroke='red' d='M1 1L2,1M1-2l2 0M1 2H4M1,3h4M6 1V6m1-5v6'/>"
        "<path stroke='red' d='M-10-10 -10-3'/><polyline stroke='red' points='-20,0 -20 8'/>"
        "<g transform='translate(20 0) rotate(90)'><path stroke='red' transform='scale(3)' d='M0 0h3'/></g>"
        "<path stroke='red' transform='matrix(1 0 0 2 0 0)' d='M30 0v5'/>"
        "</svg>",
        &p);
    assert_near(length_of(&p, RUGA_ASSIGNMENT_MOUNTAIN), 1 + 2 + 3 + 4 + 5 + 6 + 7 + 8 + 9 + 10, 1e-12);
    ruga_crease_pattern_clear(&p);
    // Circles of radius 10 in many ways: two arcs, quarters with compact flags, an ellipse in a scaled frame.
    const char* const circle[] = {
        "<path stroke='blue' d='M-10 0A10 10 0 0 1 10 0A10 10 0 0 1-10 0z'/>",
        "<path stroke='blue' d='M10 0a10 10 0 01-10 10a10 10 0 1110-10'/>", "<circle stroke='blue' r='10'/>",
        "<ellipse transform='scale(2 1)' stroke='blue' cx='0' cy='0' rx='5' ry='10'/>",
        "<rect stroke='blue' x='-10' y='-10' width='20' height='20' rx='10'/>",
        "<rect transform='scale(1 2)' stroke='blue' x='-10' y='-5' width='20' height='10' rx='30' ry='5'/>"};
    for (int k = 0; k < 6; k++) {
        char text[512];
        (void)snprintf(text, sizeof text,
                       "<svg><rect x='-50' y='-50' width='100' height='100' stroke='black'/>%s</svg>",
                       circle[k]);
        draw_text(text, &p);
        assert_near(length_of(&p, RUGA_ASSIGNMENT_VALLEY), 20 * RUGA_PI, 0.06);
        for (int e = 0; e < p.edge_count; e++) {
            if (p.edge[e].assignment == RUGA_ASSIGNMENT_VALLEY) {
                const double *a = p.position[p.edge[e].vertex[0]], *b = p.position[p.edge[e].vertex[1]];
                assert_near(hypot(a[0], a[1]), 10, 0.015); // what was joined moved by the tolerance at most
                assert_near(hypot(a[0] + b[0], a[1] + b[1]) / 2, 10, 0.03);
            }
        }
        ruga_crease_pattern_clear(&p);
    }
    // A parabola as Q T, q t and as cubics: y = x^2 over -2 .. 2, its length 2 sqrt(17) + asinh(4) / 2.
    const char* const parabola[] = {
        "M-2 4Q-1 0 0 0T2 4", "m-2 4q1-4 2-4t2 4",
        "M-2 4C-1.3333333333 1.3333333333-.6666666667 0 0 0S1.3333333333 1.3333333333 2 4",
        "M-2 4c.6666666667-2.6666666667 1.3333333333-4 2-4s1.3333333333 1.3333333333 2 4"};
    for (int k = 0; k < 4; k++) {
        char text[512];
        (void)snprintf(text, sizeof text,
                       "<svg><rect x='-5' y='-5' width='10' height='10' stroke='black'/><path stroke='blue' "
                       "d='%s'/></svg>",
                       parabola[k]);
        draw_text(text, &p);
        assert_near(length_of(&p, RUGA_ASSIGNMENT_VALLEY), 2 * sqrt(17) + asinh(4) / 2, 2e-3);
        ruga_curves curves = {0};
        assert_ok(ruga_crease_pattern_curves(&p, &(ruga_curve){0}, false, &curves));
        assert_int_equal(curves.count, 1);
        ruga_curves_clear(&curves);
        ruga_crease_pattern_clear(&p);
    }
}

static void corners_of_rectangles_are_round(void** state) {
    (void)state;
    ruga_crease_pattern p;
    draw_text("<svg><rect x='-20' y='-20' width='40' height='40' stroke='black'/>"
              "<rect x='-10' y='-8' width='20' height='16' rx='4' ry='2' stroke='blue'/></svg>",
              &p);
    assert_int_equal(p.note_count, 1); // nothing but that the curve is joined to no border
    // Sides 12 and 12, and an ellipse with semi-axes 4 and 2.
    assert_near(length_of(&p, RUGA_ASSIGNMENT_VALLEY), 48 + 9.688448220547675 * 2, 0.03);
    ruga_crease_pattern_clear(&p);
}

static void what_is_no_shape_is_named(void** state) {
    (void)state;
    ruga_crease_pattern p;
    draw_text("<svg>" SHEET "<line stroke='red' x1='5' x2='5' y2='10'/>\n<use href='#a'/><defs><text/></defs>"
              "<g display='none'><image/></g></svg>",
              &p);
    assert_true(has_note(&p, "1 elements that are not shapes were left out, the first a use in line 2"));
    ruga_crease_pattern_clear(&p);
}

static void refuse_drawing(const char* text, const char* sentence) {
    ruga_crease_pattern p;
    write_text(DRAWING, text);
    assert_status(ruga_svg_read(DRAWING, 1, 1e-4, &p), RUGA_BAD_INPUT);
    if (!strstr(ruga_last_error(), sentence)) {
        print_error("\"%s\" does not say \"%s\"\n", ruga_last_error(), sentence);
        fail();
    }
}

static void broken_drawings_are_refused_with_the_line(void** state) {
    (void)state;
    refuse_drawing("<svg/>", "no stroked lines");
    refuse_drawing("", "not XML: no element found");
    refuse_drawing("<svg>\n\n<path stroke='red' d='M0 0L1 x'/></svg>",
                   "svg:3: path data cannot be read from \"L1 x\" on");
    refuse_drawing("<svg><path stroke='red' d='L1 1'/></svg>", "\"L1 1\"");
    refuse_drawing("<svg><path stroke='red' d='M0 0L0x1 nan'/></svg>", "path data");
    refuse_drawing("<svg><path stroke='red' d='M0 0L-0x1F 1'/></svg>", "path data");
    refuse_drawing("<svg>\n<path stroke='red' d='M0 0A1e-200 1e-200 0 0 0 1 1'/></svg>",
                   "svg:2: the numbers");
    refuse_drawing("<svg><g transform='scale(1e200)'><rect stroke='red' width='1e200' height='1'/></g></svg>",
                   "too large");
    refuse_drawing("<svg>\n<rect stroke='black' width='50%' height='1'/></svg>",
                   "svg:2: width=\"50%\" is not");
    refuse_drawing("<svg><circle stroke='black' r='3mm'/></svg>", "r=\"3mm\" is not a number");
    refuse_drawing("<svg><line stroke='red' x1='left' x2='1'/></svg>", "x1=\"left\"");
    refuse_drawing("<svg>\n<line x1='0' stroke='red'", "svg:2: not XML: unclosed token");
    refuse_drawing("<svg><!-- ", "not XML: unclosed token");
    refuse_drawing("<svg>\n<g>\n</svg>", "svg:3: not XML: mismatched tag");
    refuse_drawing("<svg><a b='1' b='2'/></svg>", "not XML: duplicate attribute");
    refuse_drawing("<svg><g transform='turn(3)'></g></svg>", "transform cannot be read");
    refuse_drawing("<svg><polyline stroke='red' points='0 0 1 q'/></svg>", "list of points");
    refuse_drawing("<svg><line stroke='red' x2='1' y2='1'/></svg>", "no closed outline");
}

// Entities are put in, as drawing programs use them; those that double sixty times are refused at once.
static void entities_are_put_in_but_cannot_blow_up(void** state) {
    (void)state;
    ruga_crease_pattern p;
    draw_text("<!DOCTYPE svg [<!ENTITY m '#f00'><!ENTITY half '5'>]><svg>" SHEET
              "<line stroke='&m;' x1='&half;' y1='0' x2='&half;' y2='10'/></svg>",
              &p);
    assert_near(length_of(&p, RUGA_ASSIGNMENT_MOUNTAIN), 10, 1e-12);
    ruga_crease_pattern_clear(&p);
    draw_text("<!DOCTYPE svg [<!ENTITY away SYSTEM 'file:///etc/hostname'>]><svg>" SHEET
              "<style>&away;</style></svg>",
              &p);
    ruga_crease_pattern_clear(&p);
    char text[8192] = "<!DOCTYPE svg [<!ENTITY e0 'some text that is to be repeated'>";
    for (int k = 1; k <= 60; k++) {
        size_t length = strlen(text);
        (void)snprintf(text + length, sizeof text - length, "<!ENTITY e%d '&e%d;&e%d;'>", k, k - 1, k - 1);
    }
    size_t length = strlen(text);
    (void)snprintf(text + length, sizeof text - length, "]><svg>" SHEET "<style>&e60;</style></svg>");
    refuse_drawing(text, "amplification");
}

// ------------------------------------------------------------------------------- real patterns

static bool data_path(const char* name, char path[1024]) {
    const char* data = getenv("RUGA_DATA");
    (void)snprintf(path, 1024, "%s/fold/%s", data ? data : RUGA_SOURCE_DIR "/../shared/data", name);
    FILE* file = fopen(path, "rb");
    if (!file) {
        print_message("skipped: %s is not there (set RUGA_DATA)\n", path);
        return false;
    }
    (void)fclose(file);
    return true;
}

// Patterns by others; counts by an independent reader.
static const struct real {
    const char* name;
    int vertices, edges, faces, border, mountain, valley, flat, unassigned, cut;
    bool drawing; // there is an SVG of it as well
} real_patterns[] = {{"miura-ori", 81, 152, 72, 32, 60, 60, 0, 0, 0, false},
                     {"crane", 58, 129, 72, 10, 58, 41, 20, 0, 0, false},
                     {"grid4x4_unassigned", 25, 40, 16, 16, 0, 0, 0, 24, 0, false},
                     {"simpleVertex", 9, 12, 4, 8, 3, 1, 0, 0, 0, true},
                     {"waterbomb", 195, 524, 330, 58, 246, 220, 0, 0, 0, true},
                     {"wavy_pleats", 169, 174, 6, 14, 96, 64, 0, 0, 0, true},
                     {"singlesquaretwist", 16, 24, 9, 12, 4, 8, 0, 0, 0, true},
                     {"honeycombKiri", 312, 587, 276, 70, 162, 168, 0, 0, 187, true}};
enum { REAL_PATTERNS = sizeof real_patterns / sizeof *real_patterns };

static void assert_counts(const struct real* r, const ruga_crease_pattern* p) {
    const int wanted[] = {r->border, r->mountain, r->valley, r->flat, r->unassigned, r->cut};
    assert_int_equal(p->vertex_count, r->vertices);
    assert_int_equal(p->edge_count, r->edges);
    assert_int_equal(p->face_count, r->faces);
    for (int a = 0; a < RUGA_ASSIGNMENT_COUNT; a++) {
        assert_int_equal(count_edges(p, (ruga_assignment)a), wanted[a]);
    }
}

static void real_patterns_are_read_as_others_read_them(void** state) {
    (void)state;
    for (int k = 0; k < REAL_PATTERNS; k++) {
        char path[1024], name[128];
        ruga_crease_pattern p;
        (void)snprintf(name, sizeof name, "%s.fold", real_patterns[k].name);
        if (!data_path(name, path)) {
            skip();
        }
        assert_ok(ruga_fold_read(path, 0, 1, &p));
        for (int i = 0; i < p.note_count; i++) {
            print_message("%s: %s\n", name, p.note[i]);
        }
        assert_counts(&real_patterns[k], &p);
        // Faces found from the lines alone are the same.
        p.face_count = 0;
        assert_ok(ruga_crease_pattern_arrange(&p, 1e-6));
        assert_int_equal(p.face_count, real_patterns[k].faces);
        ruga_crease_pattern_clear(&p);
    }
    static const char* const folded[] = {"squaretwist_folded3d.fold", "box_folded3d.fold"};
    for (int k = 0; k < 2; k++) {
        char path[1024];
        ruga_crease_pattern p;
        assert_true(data_path(folded[k], path));
        assert_ok(ruga_fold_read(path, 0, 1, &p));
        assert_true(p.folded);
        assert_int_equal(p.face_count, k ? 42 : 9);
        ruga_crease_pattern_clear(&p);
    }
}

static void drawings_and_files_of_one_pattern_agree(void** state) {
    (void)state;
    for (int k = 0; k < REAL_PATTERNS; k++) {
        char path[1024], name[128];
        ruga_crease_pattern p, q;
        (void)snprintf(name, sizeof name, "%s.svg", real_patterns[k].name);
        if (!real_patterns[k].drawing) {
            continue;
        }
        if (!data_path(name, path)) {
            skip();
        }
        assert_ok(ruga_svg_read(path, 1, 1e-3, &p));
        for (int i = 0; i < p.note_count; i++) {
            print_message("%s: %s\n", name, p.note[i]);
        }
        (void)snprintf(name, sizeof name, "%s.fold", real_patterns[k].name);
        assert_true(data_path(name, path));
        assert_ok(ruga_fold_read(path, 0, 1, &q));
        assert_int_equal(p.face_count, q.face_count);
        // The file is scaled to a size of its own; shares of length are not.
        double all_p = 0, all_q = 0;
        for (int a = 0; a < RUGA_ASSIGNMENT_COUNT; a++) {
            all_p += length_of(&p, (ruga_assignment)a);
            all_q += length_of(&q, (ruga_assignment)a);
        }
        for (int a = 0; a < RUGA_ASSIGNMENT_COUNT; a++) {
            assert_near(length_of(&p, (ruga_assignment)a) / all_p, length_of(&q, (ruga_assignment)a) / all_q,
                        1e-3);
        }
        ruga_crease_pattern_clear(&p);
        ruga_crease_pattern_clear(&q);
    }
}

// The outline meshed anew, so that its triangles know nothing of the creases; then the creases cut into it.
static void real_patterns_can_be_cut_into_meshes_that_know_nothing_of_them(void** state) {
    (void)state;
    for (int k = 0; k < REAL_PATTERNS; k++) {
        char path[1024], name[128];
        ruga_crease_pattern p;
        crease_case c = {0};
        ruga_mesh outline;
        (void)snprintf(name, sizeof name, "%s.fold", real_patterns[k].name);
        if (!data_path(name, path)) {
            skip();
        }
        assert_ok(ruga_fold_read(path, 0, 1, &p));
        assert_ok(ruga_crease_pattern_mesh(&p, path, &outline));
        double edge = sqrt(ruga_mesh_area(&outline)) / 30;

        assert_ok(ruga_mesh_remesh(&outline, edge, &c.mesh));
        assert_ok(ruga_crease_pattern_curves(&p, &(ruga_curve){0}, true, &c.curves));
        const ruga_raster_def def = ruga_default_raster_def();
        run_case(&c, &def);
        double drawn = 0, brought = 0;
        for (int e = 0; e < p.edge_count; e++) {
            const int* v = p.edge[e].vertex;
            drawn += p.edge[e].assignment == RUGA_ASSIGNMENT_BORDER
                         ? 0
                         : ruga_distance(p.position[v[0]], p.position[v[1]]);
        }
        for (int i = 0; i < c.raster.curve_count; i++) {
            brought += c.raster.facts[i].length;
        }
        print_message(
            "%s: %d triangles become %d (after mending %d), %d rows, %d redundant, %d rounds, length %.6f of "
            "what was drawn\n",
            name, c.mesh.triangle_count, c.cut.piece_count, c.raster.mesh.triangle_count, c.sewing.row_count,
            c.sewing.redundant_rows, c.raster.rounds, brought / drawn);
        assert_near(brought / drawn, 1, 1e-2);
        ruga_mesh_clear(&outline);
        ruga_crease_pattern_clear(&p);
        clear_case(&c);
    }
}

// Files with random bytes changed, taken out and put in are read or refused.
static void damaged_files_are_read_or_refused(void** state) {
    (void)state;
    static const char* const good[2] = {
        "{" SQUARE ", \"edges_foldAngle\": [0,0,0,0,0,0,0,0,-180,-90,45.5,null]," SQUARE_FACES
        ", \"file_frames\": [{\"frame_parent\": 0, \"frame_inherit\": true}]}",
        "<svg><style>.a{stroke:red;opacity:.5}</style>" SHEET "<g transform='rotate(10 5 5) scale(.5)'>"
        "<path class='a' d='M0 0L10 10C1 2 3 4 5 6S7 8 9 9Q1 1 2 2T8 8A3 4 5 0 1 6 6H2V3z'/>"
        "<polyline stroke='#00f' points='0,5 5,4 10,5'/></g><circle stroke='lime' cx='5' cy='5' "
        "r='2'/></svg>"};
    ruga_random random = {77};
    int read = 0;
    for (int k = 0; k < 4000; k++) {
        char text[1024];
        size_t length = strlen(good[k % 2]);
        memcpy(text, good[k % 2], length + 1);
        for (int change = 0; change < 1 + k % 3; change++) {
            size_t at = (size_t)(ruga_random_uniform(&random) * (double)length);
            int how = (int)(ruga_random_uniform(&random) * 3);
            char byte = (char)(32 + (int)(ruga_random_uniform(&random) * 95));
            if (how == 0) {
                text[at] = byte;
            } else if (how == 1) {
                memmove(text + at, text + at + 1, length - at);
                length--;
            } else if (length < sizeof text - 2) {
                memmove(text + at + 1, text + at, length - at + 1);
                text[at] = byte;
                length++;
            }
        }
        ruga_crease_pattern p;
        write_text(k % 2 ? DRAWING : FILE_NAME, text);
        ruga_status status =
            k % 2 ? ruga_svg_read(DRAWING, 1, 1e-3, &p) : ruga_fold_read(FILE_NAME, k / 2 % 2, 1, &p);
        assert_true(status == RUGA_OK || status == RUGA_BAD_INPUT);
        if (status == RUGA_OK) {
            ruga_curves curves = {0};
            status = ruga_crease_pattern_curves(&p, &(ruga_curve){0}, true, &curves);
            assert_int_equal(status, RUGA_OK);
            ruga_curves_clear(&curves);
            ruga_crease_pattern_clear(&p);
            read++;
        }
    }
    print_message("%d of 4000 damaged files could be read\n", read);
    assert_true(read > 400);
}

static void every_failed_allocation_is_a_status(void** state) {
    (void)state;
    write_text(FILE_NAME, "{" SQUARE "}");
    write_text(DRAWING, "<svg>" SHEET "<path stroke='red' d='M0 0L10 10M10 0L0 10'/><polyline stroke='blue' "
                        "points='0,5 5,4 10,5'/></svg>");
    for (int drawing = 0; drawing < 2; drawing++) {
        for (int k = 0;; k++) {
            ruga_crease_pattern p;
            ruga_curves curves = {0};
            let_allocations_fail_after(k);
            ruga_status status =
                drawing ? ruga_svg_read(DRAWING, 1, 1e-3, &p) : ruga_fold_read(FILE_NAME, 0, 1, &p);
            if (status == RUGA_OK) {
                status = ruga_crease_pattern_curves(&p, &(ruga_curve){0}, false, &curves);
                ruga_curves_clear(&curves);
                ruga_crease_pattern_clear(&p);
            }
            ruga_set_allocator(NULL, NULL, NULL);
            if (status == RUGA_OK) {
                break;
            }
            assert_int_equal(status, RUGA_NO_MEMORY);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plain_pattern_is_read_as_it_is),
        cmocka_unit_test(missing_faces_are_found_and_said),
        cmocka_unit_test(bad_patterns_are_repaired_aloud),
        cmocka_unit_test(borders_within_the_sheet_cut_holes),
        cmocka_unit_test(broken_files_are_refused_with_the_field),
        cmocka_unit_test(frames_inherit),
        cmocka_unit_test(what_is_written_reads_back_to_the_bit),
        cmocka_unit_test(creases_are_chained_where_nothing_else_meets_them),
        cmocka_unit_test(strokes_say_what_lines_are),
        cmocka_unit_test(all_path_commands_and_transforms_are_drawn),
        cmocka_unit_test(corners_of_rectangles_are_round),
        cmocka_unit_test(what_is_no_shape_is_named),
        cmocka_unit_test(broken_drawings_are_refused_with_the_line),
        cmocka_unit_test(entities_are_put_in_but_cannot_blow_up),
        cmocka_unit_test(real_patterns_are_read_as_others_read_them),
        cmocka_unit_test(drawings_and_files_of_one_pattern_agree),
        cmocka_unit_test(real_patterns_can_be_cut_into_meshes_that_know_nothing_of_them),
        cmocka_unit_test(damaged_files_are_read_or_refused),
        cmocka_unit_test(every_failed_allocation_is_a_status),
    };
    return cmocka_run_group_tests_name("fold", tests, NULL, check_no_leak);
}
