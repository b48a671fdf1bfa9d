/* The keys of --camera: JSON that the page checks and follows (camera_path.js). */
#ifndef CAMERA_KEYS_H
#define CAMERA_KEYS_H

#include "browser.h"

/* Functions return an exit code, after a message unless it is EXIT_GOOD. */

/* Reads the argument of --camera: an array of keys, which begins with '[', or the name of a file
 * that has one. *keys: the array as text, which the caller frees; NULL on failure */
int camera_keys_read(const char *argument, char **keys);

/* Hands the keys to the page: EXIT_BAD_INPUT if it refuses them. argument: for the message */
int camera_keys_send(struct browser *browser, const char *argument, const char *keys);

#endif
