/* Growing list of paths. */
#include "sources.h"

pdyn_status sources_add(pdyn_context *context, struct sources *sources, const char *path) {
    char **grown =
        context_grow(context, sources->path, &sources->capacity, sources->count + 1, sizeof *grown);
    if (!grown) return PDYN_NO_MEMORY;
    sources->path = grown;
    char *copy = context_copy_text(context, path);
    if (!copy) return PDYN_NO_MEMORY;
    sources->path[sources->count++] = copy;
    return PDYN_OK;
}

void sources_free(pdyn_context *context, struct sources *sources) {
    for (size_t k = 0; k < sources->count; k++) context_free_text(context, sources->path[k]);
    FREE_ARRAY(context, sources->path, sources->capacity);
    *sources = (struct sources){0};
}
