// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// The validation suite: cases that hold what Ruga computes against theory, published figures and other
// programs. A case is one function that states lines, notes and pictures; the report is made from them.
#ifndef RUGA_APP_VALIDATE_VALIDATION_H
#define RUGA_APP_VALIDATE_VALIDATION_H

#include "core/status.h"

#include <jansson.h>

enum { RUGA_VALIDATION_PATH = 4096 };

typedef struct ruga_validation ruga_validation;

typedef struct ruga_validation_case {
    const char* name;  // of --case: letters, digits and -
    const char* title; // one line
    const char* about; // Markdown: what is compared with what, and where the reference comes from
    bool quick;        // also with --quick, when ruga_validation_is_quick asks for a small form of it
    ruga_status (*run)(ruga_validation* validation);
} ruga_validation_case;

// All cases, in the order of the report; ended by NULL.
extern const ruga_validation_case* const ruga_validation_cases[];

// ---- what a case states --------------------------------------------------------------------------------

bool ruga_validation_is_quick(const ruga_validation* v);

// A line of the table. `source` says where the reference comes from ("eq. 3", "Sze 2004, table 1").
// near: |ours - reference| <= tolerance |reference|. below, above: ours against a limit.
// record: shown and not judged; reference may be NAN.
void ruga_validation_near(ruga_validation* v, const char* quantity, double ours, double reference,
                          double tolerance, const char* source);
void ruga_validation_below(ruga_validation* v, const char* quantity, double ours, double limit,
                           const char* source);
void ruga_validation_above(ruga_validation* v, const char* quantity, double ours, double limit,
                           const char* source);
void ruga_validation_record(ruga_validation* v, const char* quantity, double ours, double reference,
                            const char* source);
// A paragraph under the table.
void ruga_validation_note(ruga_validation* v, const char* format, ...) __attribute__((format(printf, 2, 3)));
// The case cannot be run here, for this reason; lines stated before stay.
void ruga_validation_skip(ruga_validation* v, const char* format, ...) __attribute__((format(printf, 2, 3)));
// Where to write a picture or a table of the case: DIR/validation/CASE-suffix. Pictures (.svg, .png) are shown
// in the report over the caption, other files are linked.
void ruga_validation_file(ruga_validation* v, const char* suffix, const char* caption,
                          char path[RUGA_VALIDATION_PATH]);
// A place for files that nobody needs afterwards: DIR/validation/work/CASE, made.
ruga_status ruga_validation_work(ruga_validation* v, char path[RUGA_VALIDATION_PATH]);

// ---- for the command -----------------------------------------------------------------------------------

typedef struct ruga_validation_settings {
    const char* directory; // existing
    bool quick, quiet;
} ruga_validation_settings;

// Runs a case and writes DIR/validation/CASE.json with all that it stated; *failed counts its failed lines. A case
// that cannot finish counts as one failed line, with the sentence as a note; only RUGA_CANCELLED and errors of
// writing are returned.
ruga_status ruga_validation_run(const ruga_validation_settings* settings, const ruga_validation_case* c,
                                int* failed);
// DIR/validation.md from all the cases' files that are there. *all: an array of their objects, or NULL.
ruga_status ruga_validation_report(const ruga_validation_settings* settings, json_t** all);

#endif
