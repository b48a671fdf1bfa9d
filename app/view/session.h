/* A live view between two threads: one steps the simulation, one serves the page. The page's
 * messages wait in an inbox until the step ends; the frames go through a place for one, which is
 * filled when the page is ready for a frame and the state is another one than it shows. So no queue
 * grows, and the simulation never waits for the page. */
#ifndef SESSION_H
#define SESSION_H

#include "frame.h"

struct session;

/* Starts the thread of a simulation that is loaded; it takes the first step when a page is ready.
 * wake: called from that thread when a frame is there. NULL with a message if that fails. */
struct session *session_start(struct live *live, void (*wake)(void *user), void *user);
/* Ends the thread after its step. NULL: does nothing. */
void session_stop(struct session *session);

/* A message of the page, a JSON text: {"do": "ready"}, the page has shown its frame and wants the
 * next; or one of actions.c. Texts that are no JSON object are refused in a note. Returns false if
 * the inbox is full: the page must be disconnected. */
bool session_receive(struct session *session, const char *text, size_t size);

/* The frame for the page, which the caller frees; false: none is there. */
bool session_take(struct session *session, struct bytes *frame);

#endif
