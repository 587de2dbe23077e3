// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// ruga manual: manual pages and shell completions, laid out as under a prefix's share/.
#include "app/command.h"
#include "app/completion.h"
#include "app/console.h"
#include "app/manual.h"
#include "io/writer.h"

#include <string.h>

static const ruga_option options[] = {
    {"--output", "-o", "DIR", "where the files go; made where it is missing", false},
    {0},
};

// The folders of a path, those that are missing.
static ruga_status make_folders(char* path) {
    ruga_status status = RUGA_OK;
    for (char* slash = strchr(path + 1, '/'); slash && status == RUGA_OK; slash = strchr(slash + 1, '/')) {
        *slash = 0;
        status = ruga_make_folder(path);
        *slash = '/';
    }
    return status;
}

// Takes the text.
static ruga_status write_file(const ruga_arguments* arguments, const char* folder, const char* name,
                              ruga_string* text) {
    ruga_string path = {0};
    ruga_writer writer;
    ruga_string_add(&path, "%s/%s", folder, name);
    ruga_status status = ruga_string_status(&path);
    RUGA_TRY_DONE(ruga_string_status(text));
    RUGA_TRY_DONE(make_folders(path.data));
    RUGA_TRY_DONE(ruga_writer_open(path.data, &writer));
    (void)fwrite(text->data, 1, (size_t)text->length, writer.file);
    RUGA_TRY_DONE(ruga_writer_close(&writer, RUGA_OK));
    ruga_say(arguments, "%s\n", path.data);
done:
    ruga_string_clear(&path);
    ruga_string_clear(text);
    return status;
}

static ruga_status run(const ruga_arguments* arguments, int* exit_status) {
    (void)exit_status;
    const char* folder;
    RUGA_TRY(ruga_required(arguments, "--output", &folder));
    ruga_string text = {0};
    ruga_manual_of_program(&text);
    RUGA_TRY(write_file(arguments, folder, "man/man1/ruga.1", &text));
    for (int i = 0; ruga_commands[i]; i++) {
        char name[64];
        (void)snprintf(name, sizeof name, "man/man1/ruga-%s.1", ruga_commands[i]->name);
        ruga_manual_of_command(ruga_commands[i], &text);
        RUGA_TRY(write_file(arguments, folder, name, &text));
    }
    ruga_completion_bash(&text);
    RUGA_TRY(write_file(arguments, folder, "bash-completion/completions/ruga", &text));
    ruga_completion_zsh(&text);
    RUGA_TRY(write_file(arguments, folder, "zsh/site-functions/_ruga", &text));
    ruga_completion_fish(&text);
    return write_file(arguments, folder, "fish/vendor_completions.d/ruga.fish", &text);
}

const ruga_command ruga_manual_command = {
    .name = "manual",
    .usage = "-o DIR",
    .summary = "write the manual pages and the completions of bash, zsh and fish",
    .about = "Writes DIR/man/man1, DIR/bash-completion, DIR/zsh and DIR/fish, the places where man and the "
             "shells\n"
             "look under /usr/local/share and ~/.local/share. Installing Ruga puts the same files under its "
             "prefix.",
    .example = "    ruga manual -o ~/.local/share\n    man ruga-run",
    .options = options,
    .run = run,
};
