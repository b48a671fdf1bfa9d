/* Which settings of a study to take, and what they cost on the scene itself. */
#ifndef ADVICE_H
#define ADVICE_H

#include "study.h"

struct wish {
    double error, ms;  /* at most; INFINITY: as it may be */
    const char *write; /* a scene with the settings, or NULL */
};

/* Says it. EXIT_FAILED: nothing that was tried holds the wish. */
int advise(const struct study *study, const struct wish *wish);

#endif
