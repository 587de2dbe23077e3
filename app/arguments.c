// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Words of the command line to values, by a command's table of options. "--edge 8mm", "--edge=8mm" and "-o
// FILE";
// "--" ends the options.
#include "app/command.h"

#include "core/memory.h"
#include "io/scene.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct ruga_arguments {
    const ruga_command* command;
    const char* operand;
    int count;
    const ruga_option** option; // [count] in the order given
    const char** value;         // [count]
    const char** list;          // [count] work of ruga_values: values of one option stand together
};

const ruga_option ruga_common_options[] = {
    {"--quiet", "-q", NULL, "print nothing but errors", false},
    {"--help", "-h", NULL, "print this help", false},
    {0},
};

// ---- nearest name --------------------------------------------------------------------------------------

enum { WORD_MAX = 32 };

// Levenshtein's distance of two words shorter than WORD_MAX.
static int edit_distance(const char* a, size_t a_length, const char* b, size_t b_length) {
    int row[WORD_MAX + 1];
    for (size_t j = 0; j <= b_length; j++) {
        row[j] = (int)j;
    }
    for (size_t i = 1; i <= a_length; i++) {
        int diagonal = row[0];
        row[0] = (int)i;
        for (size_t j = 1; j <= b_length; j++) {
            int replace = diagonal + (a[i - 1] != b[j - 1]);
            diagonal = row[j];
            int skip = 1 + (row[j] < row[j - 1] ? row[j] : row[j - 1]);
            row[j] = replace < skip ? replace : skip;
        }
    }
    return row[b_length];
}

void ruga_suggest(const char* names, const char* word, char* sentence, size_t size) {
    size_t word_length = strlen(word), best_length = 0;
    const char* best = NULL;
    int least = WORD_MAX;
    if (word_length >= WORD_MAX) {
        return;
    }
    for (const char* name = names; *name; name += strcspn(name, "|"), name += *name == '|') {
        size_t length = strcspn(name, "|");
        int distance = length < WORD_MAX ? edit_distance(name, length, word, word_length) : WORD_MAX;
        if (distance < least) {
            least = distance;
            best = name;
            best_length = length;
        }
    }
    size_t used = strlen(sentence);
    // Up to half of its letters wrong, a word may still be meant.
    if (best && (least <= 1 || (size_t)least * 2 <= best_length) && used < size) {
        (void)snprintf(sentence + used, size - used, ", did you mean %.*s?", (int)best_length, best);
    }
}

// ---- reading -------------------------------------------------------------------------------------------

static const ruga_option* find_in(const ruga_option* options, const char* name, size_t length) {
    for (const ruga_option* o = options; o->name; o++) {
        bool is_name = strlen(o->name) == length && strncmp(o->name, name, length) == 0;
        bool is_letter = o->letter && strlen(o->letter) == length && strncmp(o->letter, name, length) == 0;
        if (is_name || is_letter) {
            return o;
        }
    }
    return NULL;
}

static const ruga_option* find_option(const ruga_command* command, const char* name, size_t length) {
    const ruga_option* found = find_in(command->options, name, length);
    return found ? found : find_in(ruga_common_options, name, length);
}

static ruga_status fail_unknown(const ruga_command* command, const char* word, size_t length) {
    char names[1024] = "", name[WORD_MAX] = "", sentence[256];
    const ruga_option* const tables[] = {command->options, ruga_common_options};
    for (int t = 0; t < 2; t++) {
        for (const ruga_option* o = tables[t]; o->name; o++) {
            size_t used = strlen(names);
            (void)snprintf(names + used, sizeof names - used, "%s%s", used ? "|" : "", o->name);
        }
    }
    (void)snprintf(name, sizeof name, "%.*s", (int)(length < WORD_MAX ? length : WORD_MAX - 1), word);
    (void)snprintf(sentence, sizeof sentence, "%s: unknown option %s", command->name, name);
    size_t before = strlen(sentence);
    ruga_suggest(names, name, sentence, sizeof sentence);
    return strlen(sentence) > before
               ? ruga_fail(RUGA_BAD_INPUT, "%s", sentence)
               : ruga_fail(RUGA_BAD_INPUT, "%s; ruga %s --help lists them", sentence, command->name);
}

static ruga_status add_option(ruga_arguments* a, const ruga_option* option, const char* value) {
    for (int i = 0; i < a->count && !option->repeats && option->value; i++) {
        if (a->option[i] == option) {
            return ruga_fail(RUGA_BAD_INPUT, "%s: %s is given twice", a->command->name, option->name);
        }
    }
    a->option[a->count] = option;
    a->value[a->count++] = value;
    return RUGA_OK;
}

// The option at words[*i], with the word after it where that is its value.
static ruga_status read_option(ruga_arguments* a, int count, char** words, int* i) {
    const char *word = words[*i], *equals = word[1] == '-' ? strchr(word, '=') : NULL;
    size_t length = equals ? (size_t)(equals - word) : strlen(word);
    const ruga_option* option = find_option(a->command, word, length);
    if (!option) {
        return fail_unknown(a->command, word, length);
    }
    if (!option->value) {
        return equals ? ruga_fail(RUGA_BAD_INPUT, "%s: %s takes no value", a->command->name, option->name)
                      : add_option(a, option, "");
    }
    const char* value = equals ? equals + 1 : *i + 1 < count ? words[++*i] : NULL;
    if (!value || !*value) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: %s wants a value: %s %s", a->command->name, option->name,
                         option->name, option->value);
    }
    return add_option(a, option, value);
}

static ruga_status read_words(ruga_arguments* a, int count, char** words) {
    bool options = true;
    for (int i = 0; i < count; i++) {
        if (options && strcmp(words[i], "--") == 0) {
            options = false;
        } else if (options && words[i][0] == '-' && words[i][1]) {
            RUGA_TRY(read_option(a, count, words, &i));
        } else if (!a->command->operand) {
            return ruga_fail(RUGA_BAD_INPUT, "%s: takes options only, not %s", a->command->name, words[i]);
        } else if (a->operand) {
            return ruga_fail(RUGA_BAD_INPUT, "%s: it takes one %s, but both %s and %s are given",
                             a->command->name, a->command->operand, a->operand, words[i]);
        } else {
            a->operand = words[i];
        }
    }
    if (a->command->operand && (!a->operand || !*a->operand) && !ruga_given(a, "--help")) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: no %s is given; ruga %s --help shows how", a->command->name,
                         a->command->operand, a->command->name);
    }
    return RUGA_OK;
}

ruga_status ruga_arguments_read(const ruga_command* command, int count, char** words, ruga_arguments** out) {
    ruga_status status = RUGA_OK;
    ruga_arguments* a = NULL;
    *out = NULL;
    RUGA_TRY(RUGA_NEW_ZERO(a, 1));
    a->command = command;
    RUGA_TRY_DONE(RUGA_NEW(a->option, count));
    RUGA_TRY_DONE(RUGA_NEW(a->value, count));
    RUGA_TRY_DONE(RUGA_NEW(a->list, count));
    RUGA_TRY_DONE(read_words(a, count, words));
done:
    if (status != RUGA_OK) {
        ruga_arguments_destroy(&a);
    }
    *out = a;
    return status;
}

void ruga_arguments_destroy(ruga_arguments** arguments) {
    ruga_arguments* a = *arguments;
    if (a) {
        ruga_release(a->option);
        ruga_release(a->value);
        ruga_release(a->list);
        ruga_release(a);
        *arguments = NULL;
    }
}

// ---- values --------------------------------------------------------------------------------------------

const char* ruga_operand(const ruga_arguments* a) {
    return a->operand;
}

const char* ruga_value(const ruga_arguments* a, const char* option) {
    for (int i = a->count - 1; i >= 0; i--) {
        if (strcmp(a->option[i]->name, option) == 0) {
            return a->value[i];
        }
    }
    return NULL;
}

bool ruga_given(const ruga_arguments* a, const char* option) {
    return ruga_value(a, option) != NULL;
}

const char* const* ruga_values(const ruga_arguments* a, const char* option, int* count) {
    *count = 0;
    for (int i = 0; i < a->count; i++) {
        if (strcmp(a->option[i]->name, option) == 0) {
            a->list[(*count)++] = a->value[i];
        }
    }
    return a->list;
}

ruga_status ruga_required(const ruga_arguments* a, const char* option, const char** value) {
    *value = ruga_value(a, option);
    if (!*value) {
        const ruga_option* o = find_option(a->command, option, strlen(option));
        return ruga_fail(RUGA_BAD_INPUT, "%s: %s %s is missing", a->command->name,
                         o->letter ? o->letter : option, o->value);
    }
    return RUGA_OK;
}

ruga_status ruga_quantity(const ruga_arguments* a, const char* option, const char* dimension, double* value) {
    const char* text = ruga_value(a, option);
    if (!text) {
        return RUGA_OK;
    }
    ruga_status status = ruga_quantity_parse(text, dimension, value);
    return status == RUGA_OK ? status : ruga_fail_prefix(status, "%s", option);
}

ruga_status ruga_integer(const ruga_arguments* a, const char* option, int low, int high, int* value) {
    const char* text = ruga_value(a, option);
    if (!text) {
        return RUGA_OK;
    }
    char* end;
    errno = 0;
    long number = strtol(text, &end, 10);
    if (end == text || *end || errno || number < low || number > high) {
        return ruga_fail(RUGA_BAD_INPUT, "%s: %s is not a whole number from %d to %d", option, text, low,
                         high);
    }
    *value = (int)number;
    return RUGA_OK;
}

ruga_status ruga_option_choice(const ruga_arguments* a, const char* option, const char* choices, int* index) {
    const char* text = ruga_value(a, option);
    if (!text) {
        return RUGA_OK;
    }
    int i = 0;
    for (const char* name = choices; *name; name += strcspn(name, "|"), name += *name == '|', i++) {
        if (strlen(text) == strcspn(name, "|") && strncmp(text, name, strlen(text)) == 0) {
            *index = i;
            return RUGA_OK;
        }
    }
    char sentence[256] = "";
    (void)snprintf(sentence, sizeof sentence, "%s: %.40s is none of ", option, text);
    for (size_t used = strlen(sentence); *choices && used + 2 < sizeof sentence; choices++) {
        used += (size_t)snprintf(sentence + used, sizeof sentence - used, *choices == '|' ? ", " : "%c",
                                 *choices);
    }
    return ruga_fail(RUGA_BAD_INPUT, "%s", sentence);
}
