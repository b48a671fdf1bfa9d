/* A headless Chromium, driven over pipes. */
#include "browser.h"
#include "app.h"
#include "program.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum {
    COMMANDS_IN = 3, /* descriptors of the browser for the messages */
    ANSWERS_OUT = 4,
    PATIENCE = 300, /* s until an answer must have come */
    CHUNK = 1 << 16,
};

static const char *const names[] = {"chromium", "chromium-browser", "google-chrome", NULL};

static int fail(const char *what) {
    fprintf(stderr, "projdyn: render: the browser %s\n", what);
    return EXIT_FAILED;
}

/* ---- process --------------------------------------------------------------------------------- */

/* Moves the pipes to the descriptors that Chromium expects, and starts it. Does not return. */
static void run_browser(const char *path, const char *folder, int in, int out) {
    char profile[4096], log[4096];
    snprintf(profile, sizeof profile, "--user-data-dir=%s/profile", folder);
    snprintf(log, sizeof log, "%s/log", folder);
    int quiet = open(log, O_WRONLY | O_CREAT, 0600);
    in = fcntl(in, F_DUPFD, ANSWERS_OUT + 1); /* away from 3 and 4, then there */
    out = fcntl(out, F_DUPFD, ANSWERS_OUT + 1);
    if (quiet < 0 || dup2(quiet, 1) < 0 || dup2(quiet, 2) < 0 || dup2(in, COMMANDS_IN) < 0 ||
        dup2(out, ANSWERS_OUT) < 0)
        _exit(127);
    signal(SIGPIPE, SIG_DFL);
    setenv("TMPDIR", folder, 1); /* what it leaves behind is removed with the folder */
    execl(path, path, "--headless", "--remote-debugging-pipe", profile, "--use-gl=angle",
          "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars",
          "--no-first-run", "--disable-background-networking", "--disable-component-update",
          "--disable-sync", "--disable-quic", geteuid() ? NULL : "--no-sandbox", (char *)NULL);
    _exit(127);
}

static int start(struct browser *browser, const char *folder) {
    char path[4096];
    int to[2], from[2];
    if (!find_program(names, path, sizeof path))
        return fail("Chromium is not installed; on Debian: apt-get install chromium");
    if (pipe2(to, O_CLOEXEC)) return fail(strerror(errno));
    if (pipe2(from, O_CLOEXEC)) return close(to[0]), close(to[1]), fail(strerror(errno));
    browser->to = to[1];
    browser->from = from[0];
    browser->process = fork();
    if (!browser->process) run_browser(path, folder, to[0], from[1]);
    close(to[0]);
    close(from[1]);
    return browser->process > 0 ? EXIT_GOOD : fail(strerror(errno));
}

/* ---- messages -------------------------------------------------------------------------------- */

static int send_text(struct browser *browser, const char *text) {
    for (size_t left = strlen(text) + 1; left;) {
        ssize_t sent = write(browser->to, text, left);
        if (sent < 0 && errno != EINTR) return fail("does not take commands");
        if (sent < 0) continue;
        text += sent;
        left -= (size_t)sent;
    }
    return EXIT_GOOD;
}

/* Appends what the browser writes to browser->text; waits for it. */
static int receive(struct browser *browser) {
    struct pollfd ready = {.fd = browser->from, .events = POLLIN};
    if (browser->length + CHUNK > browser->capacity) {
        size_t capacity = 2 * browser->capacity + CHUNK;
        char *text = realloc(browser->text, capacity);
        if (!text) return report_no_memory();
        browser->text = text;
        browser->capacity = capacity;
    }
    int count = poll(&ready, 1, 1000 * PATIENCE);
    if (count == 0) return fail("does not answer");
    ssize_t size = count < 0 ? -1 : read(browser->from, browser->text + browser->length, CHUNK);
    if (size < 0 && errno == EINTR) return EXIT_GOOD;
    if (size <= 0) return fail("has ended");
    browser->length += (size_t)size;
    return EXIT_GOOD;
}

/* The next message; browser->used moves behind it. */
static int next_message(struct browser *browser, json_t **message) {
    if (browser->used)
        memmove(browser->text, browser->text + browser->used, browser->length -= browser->used);
    browser->used = 0;
    char *end = NULL;
    for (size_t seen = 0; !end;) {
        if (browser->length > seen) end = memchr(browser->text + seen, 0, browser->length - seen);
        if (end) break;
        seen = browser->length;
        int code = receive(browser);
        if (code != EXIT_GOOD) return code;
    }
    browser->used = (size_t)(end - browser->text) + 1;
    *message = json_loads(browser->text, 0, NULL);
    return *message ? EXIT_GOOD : fail("sent no JSON");
}

/* Sends a command and waits for the member "result" of its answer, which the caller releases.
 * parameters: taken over */
static int call(struct browser *browser, const char *method, json_t *parameters, json_t **result) {
    long id = ++browser->messages;
    json_t *command = json_pack("{s:i, s:s, s:o, s:s*}", "id", (int)id, "method", method, "params",
                                parameters, "sessionId", browser->session);
    char *text = command ? json_dumps(command, JSON_COMPACT) : NULL;
    json_decref(command);
    if (!text) return report_no_memory();
    int code = send_text(browser, text);
    free(text);
    while (code == EXIT_GOOD) {
        json_t *message;
        code = next_message(browser, &message);
        if (code != EXIT_GOOD) return code;
        bool mine = json_integer_value(json_object_get(message, "id")) == id;
        *result = mine ? json_incref(json_object_get(message, "result")) : NULL;
        json_decref(message);
        if (mine) return *result ? EXIT_GOOD : fail("refused a command");
    }
    return code;
}

/* ---- the page -------------------------------------------------------------------------------- */

int browser_evaluate(struct browser *browser, const char *expression, json_t **value) {
    json_t *result;
    int code = call(browser, "Runtime.evaluate",
                    json_pack("{s:s, s:b, s:b}", "expression", expression, "awaitPromise", 1,
                              "returnByValue", 1),
                    &result);
    if (code != EXIT_GOOD) return code;
    *value = json_incref(json_object_get(json_object_get(result, "result"), "value"));
    json_decref(result);
    if (json_is_string(*value)) return EXIT_GOOD;
    json_decref(*value);
    return fail("failed in the page");
}

/* Waits until the page says, by a class of its body, that it is ready or has failed. */
static int wait_for_page(struct browser *browser) {
    for (int tenths = 0; tenths < 10 * PATIENCE; tenths++) {
        json_t *state;
        int code = browser_evaluate(browser,
                                    "document.body ? document.body.className + ' ' + "
                                    "document.getElementById('message')?.textContent : ''",
                                    &state);
        if (code != EXIT_GOOD) return code;
        const char *text = json_string_value(state);
        bool ready = strstr(text, "ready"), failed = strstr(text, "failed");
        if (failed) fprintf(stderr, "projdyn: render: the page: %s\n", text);
        json_decref(state);
        if (failed) return EXIT_FAILED;
        if (ready) return EXIT_GOOD;
        usleep(100000);
    }
    return fail("does not show the page");
}

int browser_open(struct browser *browser, const char *folder, const char *url) {
    json_t *target;
    *browser = (struct browser){.to = -1, .from = -1};
    int code = start(browser, folder);
    if (code == EXIT_GOOD)
        code = call(browser, "Target.createTarget", json_pack("{s:s}", "url", url), &target);
    if (code != EXIT_GOOD) return code;
    code =
        call(browser, "Target.attachToTarget",
             json_pack("{s:O, s:b}", "targetId", json_object_get(target, "targetId"), "flatten", 1),
             &browser->attached);
    json_decref(target);
    if (code != EXIT_GOOD) return code;
    browser->session = json_string_value(json_object_get(browser->attached, "sessionId"));
    return wait_for_page(browser);
}

void browser_close(struct browser *browser) {
    if (browser->to >= 0) close(browser->to);
    if (browser->from >= 0) close(browser->from);
    if (browser->process > 0) {
        kill(browser->process, SIGTERM);
        waitpid(browser->process, NULL, 0);
    }
    json_decref(browser->attached);
    free(browser->text);
}
