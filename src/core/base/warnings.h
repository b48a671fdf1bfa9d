/* The warnings of a simulation. A warning has a code, which docs/guide/troubleshooting.md explains,
 * and a subject: the body or the solid that it is about. A warning that is added again is counted;
 * its text is replaced by the newest. */
#ifndef PDYN_WARNINGS_H
#define PDYN_WARNINGS_H

#include "snapshot_file.h"
#include "text.h"

/* X(constant, code). Known from the scene, then found in steps. */
#define WARNING_LIST(X)                                                                            \
    X(UNCONSTRAINED, "unconstrained")                                                              \
    X(NO_EFFECT, "no-effect")                                                                      \
    X(NO_CONTACT, "no-contact")                                                                    \
    X(DENSITY, "density")                                                                          \
    X(UNUSUAL, "unusual")                                                                          \
    X(SCALE, "scale")                                                                              \
    X(SLIVERS, "slivers")                                                                          \
    X(OBLONG, "oblong")                                                                            \
    X(COARSE, "coarse")                                                                            \
    X(THICKNESS, "contact-thickness")                                                              \
    X(TOLERANCE, "tolerance")                                                                      \
    X(LIGHT, "too-light")                                                                          \
    X(EDGE_LENGTH, "edge-length")                                                                  \
    X(FRAMES, "frames")                                                                            \
    X(PROBE, "probe")                                                                              \
    X(NEVER, "never")                                                                              \
    X(OUTLET, "outlet")                                                                            \
    X(MEMORY, "memory")                                                                            \
    X(LARGE, "large")                                                                              \
    X(SEAMS, "seams")                                                                              \
    X(COINCIDENT, "coincident")                                                                    \
    X(OVERLAP, "overlap")                                                                          \
    X(TOO_CLOSE, "too-close")                                                                      \
    X(FACTOR, "factor")                                                                            \
    X(UNSOLVED, "unsolved")                                                                        \
    X(SLOWED, "slowed")                                                                            \
    X(RETRIES, "retries")                                                                          \
    X(LEAK, "leak")                                                                                \
    X(FAST, "fast")                                                                                \
    X(FELL_OUT, "fell-out")                                                                        \
    X(ENERGY, "energy")                                                                            \
    X(COMPRESSED, "compressed")                                                                    \
    X(SHORT_STEP, "short-step")                                                                    \
    X(LONG_STEP, "long-step")                                                                      \
    X(BUDGET, "budget")                                                                            \
    X(BLOCKED, "blocked")                                                                          \
    X(SOLID_WAITS, "solid-waits")                                                                  \
    X(UNREACHABLE, "unreachable")                                                                  \
    X(CONTACT_STIFFNESS, "contact-stiffness")                                                      \
    X(SQUEEZED, "squeezed")                                                                        \
    X(MOMENTUM, "momentum")

enum warning_code {
#define WARNING_ENUM(constant, code) WARNING_##constant,
    WARNING_LIST(WARNING_ENUM)
#undef WARNING_ENUM
        WARNING_CODES
};

enum { WARNINGS_MAX = 128, WARNING_SUBJECT = NAME_LENGTH + 1, WARNING_TEXT = 400 };

struct warning {
    enum warning_code code;
    long count;         /* number of steps or particles */
    double first, last; /* s, times of the first and of the last occurrence */
    double worst;       /* largest value so far */
    char subject[WARNING_SUBJECT], text[WARNING_TEXT];
};

struct warning_list {
    int count; /* in a full list, a new warning replaces the last one */
    struct warning item[WARNINGS_MAX];
};

/* Counts a warning at `time`, s: adds `count`, takes the larger of `value` and the worst before.
 * Returns it for the text; it is valid until the next call. */
struct warning *warnings_count(struct warning_list *list, enum warning_code code,
                               const char *subject, double time, long count, double value);

/* Sets the text (printf format). A warning that has no text yet is logged as well, in the form
 * "SUBJECT: TEXT [CODE]". */
void warnings_say(pdyn_context *context, struct warning *warning, const char *format, ...)
    PDYN_PRINTF(3, 4);

/* Whether there is a warning of this code, whatever its subject. */
bool warnings_has(const struct warning_list *list, enum warning_code code);

const char *warning_name(enum warning_code code);

void warnings_persist(struct warning_list *list, struct snapshot_file *snapshot);

#endif
