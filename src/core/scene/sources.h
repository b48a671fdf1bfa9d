/* The files that a scene has read, so that its run does not replace them. */
#ifndef PDYN_SOURCES_H
#define PDYN_SOURCES_H

#include "base/context.h"

struct sources { /* zero: empty */
    size_t count, capacity;
    char **path; /* each from the current directory, or absolute */
};

pdyn_status sources_add(pdyn_context *context, struct sources *sources, const char *path);
void sources_free(pdyn_context *context, struct sources *sources);

#endif
