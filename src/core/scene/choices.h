/* Tables of named alternatives of a scene, e.g. integrators. A table is defined beside its entries;
 * its first entry is the default. To read a scene, the names suffice. */
#ifndef PDYN_CHOICES_H
#define PDYN_CHOICES_H

#include <stddef.h>

struct choices {
    const void *entry; /* array of structs that begin with name and summary, both const char * */
    size_t size;       /* bytes per struct */
    int count;
};

extern const struct choices boundary_choices;   /* struct boundary_model (boundary.c) */
extern const struct choices kernel_choices;     /* struct kernel_model (kernels.c) */
extern const struct choices integrator_choices; /* struct integrator (integrator.c) */

static inline const void *choices_entry(const struct choices *choices, int k) {
    return (const char *)choices->entry + (size_t)k * choices->size;
}

/* Name (part 0) or summary (part 1) of entry k. */
static inline const char *choices_text(const struct choices *choices, int k, int part) {
    return ((const char *const *)choices_entry(choices, k))[part];
}

#endif
