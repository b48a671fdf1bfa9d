/* Angles in another unit than degrees. */
#ifndef PDYN_ANGLES_H
#define PDYN_ANGLES_H

#include "json_file.h"

/* Notes that angles given as "rotate" of an object, degrees, are those of usual angles in radians.
 */
void angles_note(const struct json_at *owner, const double degrees[3]);

#endif
