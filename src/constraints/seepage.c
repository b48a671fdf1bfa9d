/* Resistance of a surface to a fluid that passes it, by Darcy's law (1856): the pressure difference
 * v / k drives a fluid with the velocity v through a surface, k its `permeability`, m/(Pa s). The
 * surface is no boundary of that fluid's density; this force is all that holds the two together.
 *
 * A spring of stiffness A / (k h) across the surface ties u (wet_side.h) to where it is when the
 * step begins, as in slip.c. The area A is shared by both sides in proportion to the fluid there.
 */
#include "wet_side.h"

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->weight[e] = b->wet_sides->side[e].across / b->h;
}

/* p: the anchor, moved with u along the surface */
static void project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) wet_side_project(b, e, b->u + 3 * (size_t)e, -1.0);
}

/* J = I - n n' */
static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    (void)par;
    for (int e = first; e < last; e++, J += 9) {
        const double *n = b->wet_sides->side[e].normal;
        for (int k = 0; k < 9; k++) J[k] = (k % 4 == 0) - n[k / 3] * n[k % 3];
    }
}

const pdyn_constraint_type pdyn_constraint_seepage = {
    .name = "seepage",
    .summary = "resistance of a permeable surface to a fluid that passes it",
    .flags = PDYN_CONTACT | PDYN_FLUID | PDYN_LOSSY,
    .params = (const pdyn_param[]){{0}},
    .data_size = sizeof(struct wet_side_anchor),
    .update = wet_side_update,
    .rows = 1,
    .width = WET_SIDE_WIDTH,
    .select = wet_side_select,
    .weight = weight,
    .project = project,
    .tangent = tangent,
    .begin = wet_side_begin,
};
