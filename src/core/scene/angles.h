/* Angles in another unit than degrees. */
#ifndef PDYN_ANGLES_H
#define PDYN_ANGLES_H

#include "json_file.h"

/* Notes that one of the values, in a unit that is "degrees", is a usual angle in radians. */
void angles_note(const struct json_at *at, const char *unit, const double *value, int count);

#endif
