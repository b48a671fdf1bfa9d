/* H in single precision, laid out for products: less than half of what doubles read. All of it
 * where a scene is static; where parts of it change, products with these, and with what has no
 * layout of its own, are those of the batches, in doubles.
 *
 * Good for an inner solve, whose result the next local step looks at in doubles. What neighbours
 * have in common does not round: a product sees differences of them alone, so that small inertia
 * beside large stiffness is not lost. Vectors are particles + 1 times 4, the last particle and the
 * fourth lanes 0.
 *
 * Particles are taken in patches of four neighbours, side by side in sixteen lanes. Linear batches
 * (linear_rows.h) are numbers, of all four for each particle that one of them is tied to, as these
 * have most of their neighbours in common; rows that are differences of two particles are links, a
 * block for each end; rows of one particle without a tangent, as pins are, are weights of that.
 * What is none of these goes through fluxes, B G u, in a pass before. */
#ifndef PDYN_SINGLE_H
#define PDYN_SINGLE_H

#include "objective/objective.h"

enum { PATCH = 4 };          /* particles */
enum { SINGLE_GRAIN = 128 }; /* patches: worth waking a thread for */

struct selected { /* an entry of G, from its row or from its particle */
    float coefficient;
    int index; /* the other one */
};

/* Of all members, for four particles. */
struct numbers {
    int column[4];    /* where these begin in a vector */
    float number[16]; /* 4 x members: what multiplies each, minus the first member, in their sums */
};

/* Of each member: B = m m' + a I for the difference to another particle. */
struct links {
    int to[PATCH];          /* where that begins in a vector; of 0 there is none */
    float block[4 * PATCH]; /* m and a */
};

enum single_way { LEFT_OUT, NUMBERS, LINKS, WEIGHTS, ROWS }; /* what a batch becomes */

struct origin { /* of a link's block; row < 0: none */
    int batch, row;
};

struct single {
    struct objective *objective;
    enum single_way *way; /* batches */
    int patches, rows, entries;
    int *member;       /* patches x PATCH: particles, or one beyond the last */
    int *number_start; /* patches + 1 */
    struct numbers *numbers;
    int *link_start; /* patches + 1 */
    struct links *links;
    struct origin *origin;   /* links x PATCH */
    double *own;             /* particles: the sums of a particle's numbers */
    double *diagonal;        /* particles x 6: H's blocks but for rows and what is left out */
    float *self;             /* particles + 1: these, inertia, and weights */
    int *row_start;          /* rows + 1: the entries of each, */
    struct selected *entry;  /* entries: particles */
    int *touch_start;        /* particles + 2: those that select each, */
    struct selected *touch;  /* entries: rows */
    int *batch_row;          /* batches + 1: the first row of each */
    float **block;           /* batches: B as in batch.h, where it has neither numbers nor links */
    float *flux;             /* rows x 4 */
    double *wide_u, *wide_y; /* particles x 3 and one: for batches left out; NULL: there are none */
    double *partial;         /* a sum for each parallel block */
};

/* Floats of a vector. */
static inline size_t single_size(const struct objective *objective) {
    return 4 * ((size_t)objective->particles + 1);
}

/* Zeroed before; the batches' rows are known. */
pdyn_status single_create(struct single *single, struct objective *objective);
void single_free(struct single *single);

/* Takes the system's linearisation. */
void single_prepare(struct single *single);

/* The 3 x 3 block diagonal of H, as objective_diagonal, taken from what single_prepare met. */
void single_diagonal(const struct single *single, double *blocks);

/* y = H u; returns u.y. */
double single_apply(struct single *single, const float *u, float *y);

#endif
