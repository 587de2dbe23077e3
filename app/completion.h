// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Completion for the shells bash, zsh and fish, made from the tables of the commands and the keys of scenes.
#ifndef RUGA_APP_COMPLETION_H
#define RUGA_APP_COMPLETION_H

#include "app/command.h"
#include "io/pool.h"

void ruga_completion_bash(ruga_string* script);
void ruga_completion_zsh(ruga_string* script);
void ruga_completion_fish(ruga_string* script);

// What an operand or the value of an option may be.
typedef enum ruga_wanted {
    RUGA_WANTED_NOTHING, // that could be guessed: a number, a length
    RUGA_WANTED_WORDS,   // one of `list`, "a|b|c"
    RUGA_WANTED_FILE,    // of the endings in `list`, "yaml|json"; "" = any
    RUGA_WANTED_FOLDER,
    RUGA_WANTED_KEY, // KEY=VALUE of a scene
} ruga_wanted;

typedef struct ruga_want {
    ruga_wanted kind;
    char list[256];
} ruga_want;

// By the word that stands for it in the help: "SCENE", "x|y|z", "PAGE.html"; NULL = nothing. is_output: the
// value of
// --output, which is a file whatever its word.
void ruga_want_of(const char* word, bool is_output, ruga_want* want);

// Whether key number `key` of the schema holds a value; and whether that is one of a few words, "a|b|c".
bool ruga_key_is_settable(int key);
bool ruga_key_words(int key, char words[256]);

// The words of "a|b|c", each after `before`.
void ruga_add_words(ruga_string* script, const char* list, const char* before, const char* between);
// For between single quotes, on one line; a backslash goes before each character of `escaped`.
void ruga_add_quoted(ruga_string* script, const char* text, const char* escaped);

#endif
