/* Coarse space of the two-level preconditioner: slow motions of cloth and solids, x = I X, with up
 * to 1600 coarse dofs X (nodes) and the interpolation I of amg_setup.h.
 *
 *     A = I' H I,   z += I A^-1 I' r
 *
 * A contains the tangents of all elements (Galerkin product) and inertia; of constraints that
 * change from step to step, fluid and contact, only their block diagonal. */
#ifndef PDYN_COARSE_SPACE_H
#define PDYN_COARSE_SPACE_H

#include "amg_setup.h"
#include "block_skyline.h"

struct coarse_rows {         /* the rows of one constraint's elements, on nodes: G I */
    struct sparse rows;      /* elements of several rows: G I, */
    struct sparse transpose; /* and its transpose */
    int *row_element;        /* rows: the element of each */
    struct sparse terms;     /* elements of one row: per block of A, elements and their factors */
    pdyn_elements now;       /* as H contains them */
};

struct coarse_space {
    pdyn_model *model;
    struct amg_interpolation interpolation;
    struct coarse_rows *part; /* model->elements_count */
    struct skyline a;         /* the factor of A */
    double *stiffness;        /* blocks of a: sum of constant elements, N/m */
    double *mass;             /* blocks of a: I' M I, kg */
    double *dynamic;          /* particles x 6: block diagonal of dynamic constraints; NULL: none */
    double *x;                /* nodes x 3 and one: I' r, then A^-1 I' r */
    int lifetime;             /* corrections that one factor is used for */
    int left;                 /* corrections until A is computed again */
    const double *r;          /* arguments of the correction that runs */
    double *z;
};

/* Zeroed before. Without rows of elements there are no nodes, and a correction is 0. */
pdyn_status coarse_space_create(struct coarse_space *space, pdyn_model *model);
void coarse_space_free(struct coarse_space *space);

/* Computes and factors A from H at the first solve of a step, and where its factor has served for
 * its lifetime. Nothing of it is part of a saved state. */
void coarse_space_update(struct coarse_space *space, bool first_of_step);

/* z += I A^-1 I' r */
void coarse_space_correct(struct coarse_space *space, const double *r, double *z);

#endif
