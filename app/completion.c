// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// What may stand where on the command line, for the completions of all shells. It follows from the word that
// stands for a value in the help, so that a new command or option needs nothing here.
#include "app/completion.h"

#include "io/scene_schema.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

static const struct {
    const char* word;
    ruga_wanted kind;
    const char* list;
} known[] = {
    {"SCENE", RUGA_WANTED_FILE, "yaml|yml|json"},
    {"MESH", RUGA_WANTED_FILE, "obj|ply|stl|off|gltf|glb"},
    {"RESULT", RUGA_WANTED_FILE, "h5"},
    {"CSV", RUGA_WANTED_FILE, "csv"},
    {"PNG", RUGA_WANTED_FILE, "png"},
    {"FILE", RUGA_WANTED_FILE, ""},
    {"DIR", RUGA_WANTED_FOLDER, ""},
    {"UNIT", RUGA_WANTED_WORDS, "m|dm|cm|mm|inch|foot"},
};

// "a|b": words of the command line are small, words that stand for something else are not.
static bool is_choice(const char* word) {
    bool several = strchr(word, '|') != NULL;
    for (const char* c = word; *c; c++) {
        several = several && !isupper((unsigned char)*c);
    }
    return several;
}

static void add_to_list(ruga_want* want, const char* list, size_t length) {
    size_t used = strlen(want->list);
    (void)snprintf(want->list + used, sizeof want->list - used, "%s%.*s", used ? "|" : "", (int)length, list);
}

// Of "RESULT|CSV" each; "PAGE.html" is a file that ends so.
static void want_files(const char* word, ruga_want* want) {
    for (size_t length; *word; word += length + (word[length] == '|')) {
        length = strcspn(word, "|");
        const char* dot = memchr(word, '.', length);
        if (dot && dot[1] != '.') {
            want->kind = RUGA_WANTED_FILE;
            add_to_list(want, dot + 1, length - (size_t)(dot + 1 - word));
        }
        for (size_t i = 0; i < sizeof known / sizeof known[0] && !dot; i++) {
            if (strlen(known[i].word) == length && strncmp(known[i].word, word, length) == 0) {
                want->kind = known[i].kind;
                add_to_list(want, known[i].list, strlen(known[i].list));
            }
        }
    }
}

void ruga_want_of(const char* word, bool is_output, ruga_want* want) {
    *want = (ruga_want){.kind = RUGA_WANTED_NOTHING};
    if (!word) {
        return;
    }
    if (strncmp(word, "KEY=", 4) == 0) {
        want->kind = RUGA_WANTED_KEY;
    } else if (is_choice(word)) {
        want->kind = RUGA_WANTED_WORDS;
        (void)snprintf(want->list, sizeof want->list, "%s", word);
    } else {
        want_files(word, want);
        if (want->kind == RUGA_WANTED_NOTHING && is_output) {
            want->kind = RUGA_WANTED_FILE;
        }
    }
}

bool ruga_key_is_settable(int key) {
    ruga_key_kind kind = ruga_keys[key].kind;
    return kind != RUGA_KEY_SECTION && kind != RUGA_KEY_ENTRIES && kind != RUGA_KEY_LATER;
}

bool ruga_key_words(int key, char words[256]) {
    const ruga_key* k = &ruga_keys[key];
    char name[32];
    bool later;
    words[0] = 0;
    for (int i = 0; k->kind == RUGA_KEY_CHOICE && ruga_choice(k->choices, i, name, &later); i++) {
        size_t used = strlen(words);
        (void)snprintf(words + used, 256 - used, "%s%s", used && !later ? "|" : "", later ? "" : name);
    }
    if (k->kind == RUGA_KEY_FLAG) {
        (void)snprintf(words, 256, "true|false");
    }
    return words[0] != 0;
}

void ruga_add_words(ruga_string* script, const char* list, const char* before, const char* between) {
    for (size_t length; *list; list += length + (list[length] == '|')) {
        length = strcspn(list, "|");
        ruga_string_add(script, "%s%.*s%s", before, (int)length, list, list[length] ? between : "");
    }
}

void ruga_add_quoted(ruga_string* script, const char* text, const char* escaped) {
    for (; *text; text++) {
        if (*text == '\'') {
            ruga_string_add(script, "'\\''");
        } else if (*text == '\n') {
            ruga_string_add(script, " ");
        } else {
            ruga_string_add(script, strchr(escaped, *text) ? "\\%c" : "%c", *text);
        }
    }
}
