/* A headless Chromium that shows one page, driven over pipes (DevTools protocol,
 * --remote-debugging-pipe): JSON messages that end with a NUL byte. */
#ifndef BROWSER_H
#define BROWSER_H

#include <jansson.h>
#include <sys/types.h>

struct browser {
    pid_t process;
    int to, from;                  /* ends of the pipes; -1: closed */
    long messages;                 /* number of commands sent */
    const char *session;           /* of the page; owned by `attached` */
    json_t *attached;              /* answer to Target.attachToTarget */
    char *text;                    /* bytes received: `length` of `capacity` */
    size_t length, capacity, used; /* used: bytes at the start that are dealt with */
};

/* Functions that return int return an exit code, after a message unless it is EXIT_GOOD. The
 * caller calls browser_close() in any case. */

/* Starts the browser and opens a page. folder: for the profile and the log of the browser. */
int browser_open(struct browser *browser, const char *folder, const char *url);
void browser_close(struct browser *browser);

/* Value of a JavaScript expression in the page, which must be a text; a promise is waited for. The
 * caller releases *value. */
int browser_evaluate(struct browser *browser, const char *expression, json_t **value);

#endif
