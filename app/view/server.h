/* The server of a live view: HTTP and WebSocket on 127.0.0.1, for whoever has the token in the URL.
 * It sends one page, and talks to one: the page that connected last. */
#ifndef SERVER_H
#define SERVER_H

#include "live.h"

struct server_options {
    int port; /* 0: a free one */
    bool open_browser;
};

/* Serves the page, text with its NUL, and the simulation until a signal (signals.h). Prints the
 * URL to stdout. Returns an exit code, after a message unless it is EXIT_GOOD. */
int server_run(struct live *live, const char *page, const struct server_options *options);

#endif
