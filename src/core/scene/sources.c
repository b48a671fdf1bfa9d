/* Growing list of paths. */
#include "sources.h"

#include <string.h>

pdyn_status sources_add(pdyn_context *context, struct sources *sources, const char *path) {
    char **grown =
        context_grow(context, sources->path, &sources->capacity, sources->count + 1, sizeof *grown);
    if (!grown) return PDYN_NO_MEMORY;
    sources->path = grown;
    char *copy = NEW_ARRAY(context, strlen(path) + 1, char);
    if (!copy) return PDYN_NO_MEMORY;
    sources->path[sources->count++] = strcpy(copy, path);
    return PDYN_OK;
}

void sources_free(pdyn_context *context, struct sources *sources) {
    for (size_t k = 0; k < sources->count; k++)
        FREE_ARRAY(context, sources->path[k], strlen(sources->path[k]) + 1);
    FREE_ARRAY(context, sources->path, sources->capacity);
    *sources = (struct sources){0};
}
