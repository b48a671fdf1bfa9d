/* Friction of a fluid on the surfaces in it, by Navier's law of slip (1823): on each wet side, the
 * stress beta v pulls a surface along, v the velocity of the fluid there, along the surface and
 * relative to it, beta the surface's `fluid_friction`, Pa s/m.
 *
 * A spring of stiffness beta A / h along the surface ties u (wet_side.h), of the area A, to where
 * it is when the step begins: after a step of length h, its force is the force beta A v of implicit
 * Euler. The fluid loses the momentum that the surface gets. */
#include "wet_side.h"

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->weight[e] = b->wet_sides->side[e].along / b->h;
}

/* p: the anchor, moved with u across the surface */
static void project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) wet_side_project(b, e, wet_side_anchor(b, e), 1.0);
}

/* J = n n' */
static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    (void)par;
    for (int e = first; e < last; e++, J += 9) {
        const double *n = b->wet_sides->side[e].normal;
        for (int k = 0; k < 9; k++) J[k] = n[k / 3] * n[k % 3];
    }
}

const pdyn_constraint_type pdyn_constraint_slip = {
    .name = "slip",
    .summary = "friction between a fluid and surfaces in it",
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
