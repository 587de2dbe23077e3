// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
#define _POSIX_C_SOURCE 200809L
#include "app/interrupt.h"

#include "app/command.h"

#include <signal.h>
#include <unistd.h>

static volatile sig_atomic_t caught, interrupted;

static void handle(int signal_number) {
    (void)signal_number;
    if (!caught || interrupted) {
        _exit(RUGA_EXIT_INTERRUPTED);
    }
    interrupted = 1;
}

void ruga_interrupt_install(void) {
    struct sigaction action = {.sa_handler = handle, .sa_flags = SA_RESTART};
    (void)sigemptyset(&action.sa_mask);
    (void)sigaction(SIGINT, &action, NULL);
    // A closed pipe is found when output is flushed, and told in a sentence.
    action = (struct sigaction){.sa_handler = SIG_IGN};
    (void)sigaction(SIGPIPE, &action, NULL);
}

void ruga_interrupt_catch(void) {
    caught = 1;
}

bool ruga_interrupted(void) {
    return interrupted != 0;
}
