#include "signals.h"

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>

enum { COUNT = 3 };
static const int numbers[COUNT] = {SIGINT, SIGTERM, SIGHUP};

static bool has_action(int number, signal_fn *action) {
    struct sigaction now;
    return sigaction(number, NULL, &now) == 0 && now.sa_handler == action;
}

void signals_catch(signal_fn *handler, int flags) {
    struct sigaction action = {.sa_handler = handler, .sa_flags = flags};
    bool nohup = has_action(SIGHUP, SIG_IGN);
    for (int k = 0; k < COUNT; k++)
        if (numbers[k] != SIGHUP || !nohup) sigaction(numbers[k], &action, NULL);
}

void signals_catch_default(signal_fn *handler) {
    struct sigaction action = {.sa_handler = handler};
    for (int k = 0; k < COUNT; k++)
        if (has_action(numbers[k], SIG_DFL)) sigaction(numbers[k], &action, NULL);
}
