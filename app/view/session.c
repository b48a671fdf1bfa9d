/* The thread of a simulation, its inbox and its frame. */
#include "session.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { INBOX = 256 }; /* messages */

struct session {
    struct live *live; /* of the thread alone */
    void (*wake)(void *user);
    void *user;
    pthread_t thread;
    pthread_mutex_t mutex; /* of what follows */
    pthread_cond_t changed;
    json_t *inbox[INBOX];
    int waiting;      /* messages in the inbox */
    bool ready, stop; /* ready: the page wants a frame */
    int shown;        /* live->starts of the last frame: steps come after the frame of the start */
    struct bytes frame; /* for the page; data NULL: none */
};

/* ---- the thread of the simulation ------------------------------------------------------------ */

static bool must_step(const struct session *session) {
    return session->live->running && session->shown == session->live->starts;
}

/* Waits, with the mutex, until there is something to do: a message, a step or a frame. */
static void wait_for_work(struct session *session) {
    while (!session->stop && !session->waiting && !(session->ready && session->live->stale)) {
        double due = must_step(session) ? live_due(session->live) : INFINITY;
        if (due <= wall_seconds()) return;
        if (isinf(due)) {
            pthread_cond_wait(&session->changed, &session->mutex);
            continue;
        }
        struct timespec until = {.tv_sec = (time_t)due,
                                 .tv_nsec = (long)(1e9 * (due - floor(due)))};
        pthread_cond_timedwait(&session->changed, &session->mutex, &until);
    }
}

/* Takes the messages of the inbox, with the mutex, and does what they say, without it. */
static void act(struct session *session) {
    json_t *inbox[INBOX];
    int waiting = session->waiting;
    memcpy(inbox, session->inbox, sizeof inbox);
    session->waiting = 0;
    pthread_mutex_unlock(&session->mutex);
    for (int k = 0; k < waiting; k++) {
        live_act(session->live, inbox[k]);
        json_decref(inbox[k]);
    }
    pthread_mutex_lock(&session->mutex);
}

/* Makes a frame if the page is ready and shows another state. Called with the mutex. */
static void post_frame(struct session *session) {
    struct bytes frame;
    if (!session->ready || !session->live->stale) return;
    session->ready = session->live->stale = false;
    pthread_mutex_unlock(&session->mutex);
    bool good = frame_make(session->live, &frame);
    if (!good) report_no_memory();
    pthread_mutex_lock(&session->mutex);
    free(session->frame.data);
    session->frame = frame;
    session->shown = session->live->starts;
    session->wake(session->user);
}

static void *simulate(void *self) {
    struct session *session = self;
    pthread_mutex_lock(&session->mutex);
    while (wait_for_work(session), !session->stop) {
        act(session);
        if (must_step(session) && live_due(session->live) <= wall_seconds()) {
            pthread_mutex_unlock(&session->mutex);
            live_step(session->live);
            pthread_mutex_lock(&session->mutex);
        }
        post_frame(session);
    }
    pthread_mutex_unlock(&session->mutex);
    return NULL;
}

/* ---- the other thread ------------------------------------------------------------------------ */

struct session *session_start(struct live *live, void (*wake)(void *user), void *user) {
    struct session *session = calloc(1, sizeof *session);
    pthread_condattr_t clock;
    if (!session) return report_no_memory(), NULL;
    *session = (struct session){.live = live, .wake = wake, .user = user};
    pthread_condattr_init(&clock);
    pthread_condattr_setclock(&clock, CLOCK_MONOTONIC); /* as wall_seconds() */
    pthread_mutex_init(&session->mutex, NULL);
    pthread_cond_init(&session->changed, &clock);
    pthread_condattr_destroy(&clock);
    if (!pthread_create(&session->thread, NULL, simulate, session)) return session;
    fprintf(stderr, "projdyn: view: cannot start a thread\n");
    free(session);
    return NULL;
}

void session_stop(struct session *session) {
    if (!session) return;
    pthread_mutex_lock(&session->mutex);
    session->stop = true;
    pthread_cond_signal(&session->changed);
    pthread_mutex_unlock(&session->mutex);
    pthread_join(session->thread, NULL);
    for (int k = 0; k < session->waiting; k++) json_decref(session->inbox[k]);
    pthread_cond_destroy(&session->changed);
    pthread_mutex_destroy(&session->mutex);
    free(session->frame.data);
    free(session);
}

static bool same_member(const json_t *a, const json_t *b, const char *name) {
    return json_equal(json_object_get(a, name), json_object_get(b, name)) ||
           (!json_object_get(a, name) && !json_object_get(b, name));
}

/* Whether a message does what the one before does, to the same particle or parameter: many come
 * while the mouse moves, and the last one counts. Each "step" is one more. */
static bool replaces(const json_t *message, const json_t *before) {
    const char *what = json_string_value(json_object_get(message, "do"));
    return what && strcmp(what, "step") && same_member(message, before, "do") &&
           same_member(message, before, "particle") && same_member(message, before, "constraint") &&
           same_member(message, before, "name");
}

/* Puts a message, taken over, into the inbox, with the mutex; false if it is full. */
static bool put(struct session *session, json_t *message) {
    int last = session->waiting - 1;
    if (last >= 0 && replaces(message, session->inbox[last])) {
        json_decref(session->inbox[last]);
        session->inbox[last] = message;
        return true;
    }
    if (session->waiting == INBOX) return json_decref(message), false;
    session->inbox[session->waiting++] = message;
    return true;
}

bool session_receive(struct session *session, const char *text, size_t size) {
    json_t *message = json_loadb(text, size, JSON_REJECT_DUPLICATES, NULL);
    if (!json_is_object(message)) {
        json_decref(message);
        message = json_object(); /* live_act() says that there is no "do" */
    }
    const char *name = json_string_value(json_object_get(message, "do"));
    bool ready = name && !strcmp(name, "ready"), good = true;
    pthread_mutex_lock(&session->mutex);
    if (ready) session->ready = true;
    else good = put(session, message);
    pthread_cond_signal(&session->changed);
    pthread_mutex_unlock(&session->mutex);
    if (ready) json_decref(message);
    return good;
}

bool session_take(struct session *session, struct bytes *frame) {
    pthread_mutex_lock(&session->mutex);
    *frame = session->frame;
    session->frame = (struct bytes){0};
    pthread_mutex_unlock(&session->mutex);
    return frame->data;
}
