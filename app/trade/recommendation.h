/* Recommends one setting of a study for the user's target, with its time on the scene itself. */
#ifndef RECOMMENDATION_H
#define RECOMMENDATION_H

#include "study.h"

struct target {
    double max_error;  /* INFINITY: no limit */
    double max_ms;     /* processor time per frame; INFINITY: no limit */
    const char *write; /* path for the scene with the recommended setting, or NULL */
};

/* Prints the recommendation and writes the scene. Returns an exit code; EXIT_FAILED after a
 * message if no setting reaches the target. */
int recommend(const struct study *study, const struct target *target);

#endif
