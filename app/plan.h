/* The settings that `trade` tries on a scene, and the reference that it measures them by. */
#ifndef PLAN_H
#define PLAN_H

#include "setting.h"

#include <jansson.h>

enum { PLAN_REFERENCES = 6 };

struct plan {
    int count, capacity;
    struct setting *setting;                   /* count; the first is the scene as it is */
    struct setting reference[PLAN_REFERENCES]; /* BDF2, solved, 1/4, 1/8, ... of the length */
};

/* scene: JSON with overrides done; solver: the one it uses; finer: how many times, than the scene
 * for which iterations are counted. false without memory. */
bool plan_make(struct plan *plan, const json_t *scene, const char *solver, double finer);
void plan_free(struct plan *plan);

#endif
