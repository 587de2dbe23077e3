// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Looking things up in the table of keys, guessing what was meant, and the reference made from it.
#include "io/scene_schema.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { WORD_LENGTH = 40 };

const char* ruga_key_name(const ruga_key* key) {
    const char* dot = strrchr(key->path, '.');
    return dot ? dot + 1 : key->path;
}

bool ruga_key_is_child(const ruga_key* key, const char* parent) {
    size_t length = strlen(parent);
    if (length == 0) {
        return strchr(key->path, '.') == NULL;
    }
    return strncmp(key->path, parent, length) == 0 && key->path[length] == '.' &&
           strchr(key->path + length + 1, '.') == NULL;
}

const ruga_key* ruga_key_find(const char* parent, const char* name) {
    for (int i = 0; i < ruga_key_count; i++) {
        if (ruga_key_is_child(&ruga_keys[i], parent) && strcmp(ruga_key_name(&ruga_keys[i]), name) == 0) {
            return &ruga_keys[i];
        }
    }
    return NULL;
}

// Insertions, deletions, replacements and swaps of neighbours that turn a into b (optimal string alignment);
// capitals, - and _ do not count.
static int edit_distance(const char* a, const char* b) {
    int n = (int)strlen(a), m = (int)strlen(b);
    if (n > WORD_LENGTH || m > WORD_LENGTH) {
        return 1000;
    }
    int row[3][WORD_LENGTH + 1] = {{0}};
    for (int j = 0; j <= m; j++) {
        row[0][j] = j;
    }
    for (int i = 1; i <= n; i++) {
        int *now = row[i % 3], *before = row[(i + 2) % 3], *earlier = row[(i + 1) % 3];
        now[0] = i;
        for (int j = 1; j <= m; j++) {
            int x = a[i - 1] == '-' ? '_' : tolower((unsigned char)a[i - 1]);
            int y = b[j - 1] == '-' ? '_' : tolower((unsigned char)b[j - 1]);
            int best = before[j - 1] + (x != y);
            best = before[j] + 1 < best ? before[j] + 1 : best;
            best = now[j - 1] + 1 < best ? now[j - 1] + 1 : best;
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] && earlier[j - 2] + 1 < best) {
                best = earlier[j - 2] + 1;
            }
            now[j] = best;
        }
    }
    return row[n % 3][m];
}

static bool is_near(int distance, const char* name) {
    int length = (int)strlen(name);
    return distance <= (length < 4 ? 1 : length < 8 ? 2 : 3);
}

// The key nearest to `name`, in the section or (elsewhere = true) anywhere else.
static const ruga_key* nearest_key(const char* parent, const char* name, bool elsewhere, int* distance) {
    const ruga_key* nearest = NULL;
    *distance = 1000;
    for (int i = 0; i < ruga_key_count; i++) {
        const ruga_key* key = &ruga_keys[i];
        int d = edit_distance(name, ruga_key_name(key));
        if (ruga_key_is_child(key, parent) != elsewhere && key->kind != RUGA_KEY_LATER && d < *distance) {
            nearest = key;
            *distance = d;
        }
    }
    return nearest;
}

void ruga_key_list(const char* section, ruga_string* text) {
    const char* separator = "";
    for (int i = 0; i < ruga_key_count; i++) {
        if (ruga_key_is_child(&ruga_keys[i], section) && ruga_keys[i].kind != RUGA_KEY_LATER) {
            ruga_string_add(text, "%s%s", separator, ruga_key_name(&ruga_keys[i]));
            separator = ", ";
        }
    }
}

void ruga_key_suggest(const char* parent, const char* name, ruga_string* text) {
    int here_distance, there_distance;
    const ruga_key* here = nearest_key(parent, name, false, &here_distance);
    const ruga_key* there = nearest_key(parent, name, true, &there_distance);
    ruga_string_add(text, "unknown key");
    if (here && is_near(here_distance, name) && here_distance <= there_distance + 1) {
        ruga_string_add(text, "; did you mean %s?", here->path);
    } else if (there && is_near(there_distance, name)) {
        ruga_string_add(text, "; did you mean %s, which stands elsewhere?", there->path);
    }
    ruga_string_add(text, " (keys here: ");
    ruga_key_list(parent, text);
    ruga_string_add(text, ")");
}

bool ruga_choice(const char* choices, int index, char name[32], bool* later) {
    const char* word = choices;
    for (; index > 0; index--) {
        word = strchr(word, '|');
        if (!word) {
            return false;
        }
        word++;
    }
    *later = *word == '!';
    word += *later;
    (void)snprintf(name, 32, "%.*s", (int)strcspn(word, "|"), word);
    return true;
}

void ruga_choices_list(const char* choices, ruga_string* text) {
    char name[32];
    bool later;
    const char* separator = "";
    for (int i = 0; ruga_choice(choices, i, name, &later); i++) {
        if (!later) {
            ruga_string_add(text, "%s%s", separator, name);
            separator = ", ";
        }
    }
}

bool ruga_choice_nearest(const char* choices, const char* name, char nearest[32]) {
    int best = 1000;
    char choice[32];
    bool later;
    for (int i = 0; ruga_choice(choices, i, choice, &later); i++) {
        int distance = edit_distance(name, choice);
        // "baraff" for baraff-witkin, "quasi" for quasistatic
        if (strlen(name) >= 3 && strncmp(name, choice, strlen(name)) == 0) {
            distance = 1;
        }
        if (!later && distance < best) {
            best = distance;
            memcpy(nearest, choice, sizeof choice);
        }
    }
    return is_near(best, name);
}

void ruga_range_text(const ruga_range* range, ruga_string* text) {
    if (!range->low_open && !range->high_open) {
        ruga_string_add(text, "from ");
        ruga_string_add_number(text, range->low);
        ruga_string_add(text, " to ");
        ruga_string_add_number(text, range->high);
        return;
    }
    if (isfinite(range->low)) {
        ruga_string_add(text, "%s ", range->low_open ? "above" : "at least");
        ruga_string_add_number(text, range->low);
    }
    if (isfinite(range->high)) {
        ruga_string_add(text, "%s%s ", isfinite(range->low) ? " and " : "",
                        range->high_open ? "below" : "at most");
        ruga_string_add_number(text, range->high);
    }
}

bool ruga_range_has(const ruga_range* range, double value) {
    return (range->low_open ? value > range->low : value >= range->low) &&
           (range->high_open ? value < range->high : value <= range->high);
}

static void describe_value(const ruga_key* key, ruga_string* text) {
    const char* unit = key->dimension[0] ? key->dimension : "1";
    bool plain = strcmp(unit, "1") == 0;
    switch (key->kind) {
    case RUGA_KEY_SECTION:
        ruga_string_add(text, "a map");
        return;
    case RUGA_KEY_ENTRIES:
        ruga_string_add(text, "a list of maps");
        return;
    case RUGA_KEY_NUMBERS:
    case RUGA_KEY_STRETCH:
        if (key->count == 1) {
            ruga_string_add(text, "%s", plain ? "number" : unit);
        } else {
            ruga_string_add(text, "%d x %s", key->count, plain ? "number" : unit);
        }
        break;
    case RUGA_KEY_ROWS:
        ruga_string_add(text, "%d rows of 3 x %s", key->count, plain ? "number" : unit);
        break;
    case RUGA_KEY_SIZE:
        ruga_string_add(text, "1 to 3 x m (skirt: angle in rad)");
        break;
    case RUGA_KEY_INTEGERS:
        ruga_string_add(text, key->count == 1 ? "whole number" : "%d x whole number", key->count);
        break;
    case RUGA_KEY_SEED:
        ruga_string_add(text, "whole number");
        break;
    case RUGA_KEY_FLAG:
        ruga_string_add(text, "true or false");
        break;
    case RUGA_KEY_CHOICE:
        ruga_choices_list(key->choices, text);
        break;
    case RUGA_KEY_TEXT:
        ruga_string_add(text, "text");
        break;
    case RUGA_KEY_TEXTS:
        ruga_string_add(text, "list of texts");
        break;
    case RUGA_KEY_UNIT:
        ruga_string_add(text, "a unit of length");
        break;
    case RUGA_KEY_AXES:
        ruga_string_add(text, "true, or some of [x, y, z]");
        break;
    case RUGA_KEY_VERTICES:
        ruga_string_add(text, "list of whole numbers");
        break;
    case RUGA_KEY_EVERY:
        ruga_string_add(text, "true");
        break;
    case RUGA_KEY_PAIR:
        ruga_string_add(text, "%s, or 2 x %s", plain ? "number" : unit, plain ? "number" : unit);
        break;
    case RUGA_KEY_POINTS:
        ruga_string_add(text, "list of rows of %d x %s", key->count, plain ? "number" : unit);
        break;
    case RUGA_KEY_VALUES:
        ruga_string_add(text, "%s, or a list of them", plain ? "number" : unit);
        ruga_string_add(text, key->choices ? ", or the word %s" : "", key->choices);
        break;
    case RUGA_KEY_LATER:
        ruga_string_add(text, "not available yet");
        break;
    }
    if (isfinite(key->range.low) || isfinite(key->range.high)) {
        ruga_string_add(text, ", ");
        ruga_range_text(&key->range, text);
    }
}

// What stands before the keys of each part of a scene in the reference: a scene that can be run once `mesh`
// is given.
static const struct {
    const char *key, *scene;
} examples[] = {
    {"ruga", "ruga: 1\n"},
    {"mesh", "mesh:\n"
             "  file: cube.obj            # or make: {shape: pillow, size: 50 cm, edge: 8 mm}\n"
             "  unit: cm                  # of the file's coordinates\n"
             "  groups: [top, rest]       # of the file's groups only these\n"
             "  remesh: {edge: 2 mm}      # triangles small enough for the wrinkles\n"},
    {"skin", "skin:\n"
             "  thickness: 2 mm\n"
             "  young: 40 MPa\n"
             "  poisson: 0.3\n"
             "  vary:                     # thinner within a ball, and thicker and thicker along x\n"
             "    - {gradient: {from: [-20 cm, 0, 0], to: [20 cm, 0, 0]}, thickness: [1 mm, 3 mm]}\n"
             "    - {region: {sphere: {center: [0, 0, 10 cm], radius: 6 cm}}, thickness: 0.8 mm}\n"},
    {"interior", "interior: {young: 20 kPa, poisson: 0.3, density: 40 kg/m^3, motion: quasistatic}\n"},
    {"lattice", "lattice: {cells: 8}\n"},
    {"coupling", "coupling: {kind: clusters, rule: calibrated, foundation: true}\n"},
    {"prescribed", "prescribed:                 # squeezed along x by 5 % in half a second, with a dent\n"
                   "  - {time: 0 s}\n"
                   "  - time: 0.5 s\n"
                   "    stretch: [0.95, 1, 1]\n"
                   "    bump: {center: [0, 0, 10 cm], radius: 5 cm, depth: 1 cm}\n"},
    {"follow",
     "mesh:   {file: cube.obj, unit: cm}\n"
     "follow: {file: cube_%d.obj, rate: 25 1/s}   # cube_0.obj, cube_1.obj and so on: how the body moves\n"},
    {"start", "mesh:     {make: {shape: sheet, size: [20 cm, 12 cm], edge: 5 mm}}\n"
              "skin:     {motion: dynamic}\n"
              "interior: none\n"
              "creases:  [{curve: {polyline: [[0, -6 cm, 0], [0, 6 cm, 0]]}, hinge: {rest: 90 deg}}]\n"
              "start:    {fold: 0.5, velocity: [0, 0, -2]}   # half folded, and falling\n"},
    {"time", "time: {step: 20 ms, frames: 50}\n"},
    {"start", "mesh: {make: {shape: sheet, size: [20 cm, 12 cm], edge: 5 mm}}\n"
              "skin: {motion: dynamic}\n"
              "interior: none\n"
              "start: {velocity: [1, 0, 2]}\n"},
    {"gravity", "gravity: [0, 0, -9.81]\n"},
    {"handles", "handles:\n"
                "  - {region: {plane: {center: [-20 cm, 0, 0], normal: [-1, 0, 0]}}, fix: true}\n"
                "  - region: {sphere: {center: [20 cm, 0, 0], radius: 5 cm}}\n"
                "    move: {translate: [-2 cm, 0, 0], rotate: {axis: [1, 0, 0], angle: 30 deg}}\n"
                "    during: [0 s, 0.5 s]      # grows, and then stays\n"
                "  - {region: {box: [[-5 cm, -5 cm, 0], [5 cm, 5 cm, 20 cm]]}, press: 2 kPa}\n"},
    {"creases", "mesh: {make: {shape: sheet, size: [20 cm, 12 cm], edge: 5 mm}}\n"
                "interior: none\n"
                "handles: [{region: {plane: {center: [-9 cm, 0, 0], normal: [-1, 0, 0]}}, fix: true}]\n"
                "creases:\n"
                "  - curve: {polyline: [[0, -6 cm, 0], [2 cm, 0, 0], [0, 6 cm, 0]]}\n"
                "    hinge:                    # a valley that closes to 60 degrees in half a second\n"
                "      stiffness: 0.1 N\n"
                "      animate: [{time: 0 s, angle: 0 deg}, {time: 0.5 s, angle: 60 deg}]\n"},
    {"solver", "solver: {tolerance: 1e-6, seed: 7}\n"},
};

const char* ruga_key_example(const ruga_key* key) {
    for (size_t i = 0; i < sizeof examples / sizeof examples[0]; i++) {
        if (strcmp(examples[i].key, key->path) == 0) {
            return examples[i].scene;
        }
    }
    return NULL;
}

static const char reference_head[] =
    "# Scene files\n\n"
    "Made from the table in io/scene_schema.c by `RUGA_WRITE_DOCS=1 test_scene_reference`; the test of that "
    "name "
    "compares\n"
    "the two, and reads each example.\n\n"
    "A scene is one YAML document (JSON is a subset). Every key but `mesh` may be left out: its default "
    "stands\n"
    "below. A key that does not exist, is given twice, or has a wrong dimension is refused with file and "
    "line.\n\n"
    "- A quantity is a number and a unit: `0.4 mm`, `40 MPa`, `60 kg/m^3`, `10 deg`, `5 %`. Without a unit "
    "it is\n"
    "  in SI: m, s, Pa, N, kg, rad. Units are those of UDUNITS-2; dates and offsets (`degC`) are refused.\n"
    "- NaN and infinity are refused everywhere. A key with nothing after its colon is refused.\n"
    "- Aliases (`*name`) stand for a copy of what they name. Tags, merge keys (`<<`) and further documents "
    "are\n"
    "  refused, and so are more than 64 MB and more than 100 levels.\n"
    "- `--set key.path=value` replaces or adds a value before anything is checked; entries of lists are "
    "numbered\n"
    "  from 0: `--set handles.0.press=\"5 kPa\"`.\n"
    "- With `interior: none` there are no `lattice`, `coupling` and `prescribed`.\n"
    "- The scene's hash, which `--resume` compares, covers every value with its default in SI, but not\n"
    "  `time.frames`, comments, spelling or the order of keys. Creases may be "
    "[added](creases.md#creases-that-come-later).\n\n"
    "In the tables, N stands for the number of an entry in a list, and a value of `2 x m` for a list of two "
    "lengths.\n"
    "`ruga explain` shows all values of a scene, given or not.\n\n";

// The heading of a part of the scene, with its example.
static void describe_part(const ruga_key* key, ruga_string* text) {
    const char* scene = ruga_key_example(key);
    ruga_string_add(text, "\n## %s\n\n%s\n\n", key->path, key->meaning);
    if (scene) {
        ruga_string_add(text, "```yaml\n%s```\n\n", scene);
    }
    ruga_string_add(text, "| key | value | default | meaning |\n|---|---|---|---|\n");
}

ruga_status ruga_scene_reference(ruga_string* text) {
    ruga_string_add(text, "%sParts: ", reference_head);
    for (int i = 0, n = 0; i < ruga_key_count; i++) {
        if (!strchr(ruga_keys[i].path, '.')) {
            ruga_string_add(text, "%s[%s](#%s)", n++ ? ", " : "", ruga_keys[i].path, ruga_keys[i].path);
        }
    }
    ruga_string_add(text, ".\n");
    for (int i = 0; i < ruga_key_count; i++) {
        const ruga_key* key = &ruga_keys[i];
        const char* fallback = key->fallback ? key->fallback : "-";
        bool section = key->kind == RUGA_KEY_SECTION && fallback[0] == '{';
        bool words = fallback[0] == '(' || fallback[0] == '-' || section;
        if (!strchr(key->path, '.')) {
            describe_part(key, text);
        }
        ruga_string_add(text, "| `%s` | ", key->path);
        describe_value(key, text);
        ruga_string_add(text, words ? " | %s | " : " | `%s` | ", section ? "-" : fallback);
        ruga_string_add(text, "%s |\n", key->meaning);
    }
    return ruga_string_status(text);
}
