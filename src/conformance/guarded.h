/* Copies of a batch whose arrays have guard bytes at both ends. A call of a callback on them shows
 * each write outside of its own arrays and elements. */
#ifndef PDYN_CONFORMANCE_GUARDED_H
#define PDYN_CONFORMANCE_GUARDED_H

#include "conformance.h"

enum { COLUMN, COEFFICIENT, U, P, WEIGHT, DATA, KEY, MEMORY, TANGENT, ARRAYS };
enum { GUARD = 1 << 16 }; /* bytes: as long as most arrays of a trial */
enum { RANGES = 7 };      /* of elements, for which callbacks are called one after the other */

extern const char *const guarded_name[ARRAYS];

struct guarded {
    const struct batch *from;
    pdyn_batch view; /* what the type sees */
    struct {
        unsigned char *memory, *before; /* bytes + 2 GUARD each; before: content before a call */
        size_t bytes;
    } array[ARRAYS];
};

/* Copies the arrays of a batch; J holds guard bytes. false: no memory. */
bool guarded_create(struct guarded *guarded, const struct batch *batch);
void guarded_free(struct guarded *guarded);

void *guarded_array(const struct guarded *guarded, int array);
/* The byte range [*begin, *end) of an array that belongs to the elements [first, last). */
void guarded_range(const struct guarded *guarded, int array, int first, int last, size_t *begin,
                   size_t *end);
/* Fills the arrays in the bit set `arrays`, at the elements [first, last), with one byte. */
void guarded_fill(struct guarded *guarded, unsigned arrays, int first, int last, int byte);
/* Whether the array has the same content in both. */
bool guarded_same(const struct guarded *a, const struct guarded *b, int array);
/* Sets u to that of the batch. */
void guarded_restore_u(struct guarded *guarded);

/* ---- calls ----------------------------------------------------------------------------------- */

typedef void callback(const void *params, const pdyn_batch *batch, int first, int last);
typedef void tangent_callback(const void *params, const pdyn_batch *batch, int first, int last,
                              double *J);

struct call {
    const char *name;
    callback *plain;           /* or: */
    tangent_callback *tangent; /* which gets the J of its elements */
    unsigned writes;           /* bit k: it may write array k */
    bool zeroed;               /* what it writes is zero on entry */
};

/* The callback of this name that writes these arrays alone. */
static inline struct call call_of(const char *name, callback *plain, unsigned writes) {
    return (struct call){.name = name, .plain = plain, .writes = writes};
}

/* Calls for the elements [first, last), without a check. */
void guarded_run(const struct guarded *guarded, const struct call *call, int first, int last);
/* Calls once for all elements on a, and for RANGES of them in descending order on b, which has
 * other initial content and an arbitrary u of other elements. A write to any other place is a
 * fault, and is undone; so is a difference of the arrays in the bit set `compared` afterwards. */
void guarded_compare(struct check *check, struct guarded *a, struct guarded *b,
                     const struct call *call, unsigned compared);

#endif
