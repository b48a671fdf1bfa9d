/* Keys at a wrong place. */
#ifndef PDYN_MISPLACED_H
#define PDYN_MISPLACED_H

#include "json_file.h"

/* Appends to a message the place of an unknown key that belongs to another object of the scene.
 * Returns false where none is known. */
bool misplaced_hint(char *hint, size_t size, const struct json_at *at);

#endif
