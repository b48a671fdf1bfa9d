#include "embedding.h"

#include "bvh.h"
#include "projdyn/vec3.h"

#include <math.h>
#include <string.h>

/* ---- the tetrahedron of a point -------------------------------------------------------------- */

struct search {
    const double *rest;
    const struct tets *tets;
    const double *x; /* the point */
    int best;        /* tetrahedron with the largest least coordinate; -1: none yet */
    double least, weight[4];
};

static void barycentric(const double *const y[4], const double x[3], double weight[4]) {
    double edge[3][3], normal[3], to[3];
    for (int k = 0; k < 3; k++) vec3_subtract(edge[k], y[k + 1], y[0]);
    vec3_subtract(to, x, y[0]);
    weight[0] = 1.0;
    for (int k = 0; k < 3; k++) {
        vec3_cross(normal, edge[(k + 1) % 3], edge[(k + 2) % 3]);
        weight[k + 1] = vec3_dot(normal, to) / vec3_dot(normal, edge[k]);
        weight[0] -= weight[k + 1];
    }
}

static void try_tet(void *user, int t) {
    struct search *s = user;
    const double *y[4];
    double weight[4];
    for (int k = 0; k < 4; k++) y[k] = s->rest + 3 * (size_t)s->tets->corner[4 * (size_t)t + k];
    barycentric(y, s->x, weight);
    double least = fmin(fmin(weight[0], weight[1]), fmin(weight[2], weight[3]));
    if (s->best >= 0 && !(least > s->least)) return;
    s->best = t, s->least = least;
    memcpy(s->weight, weight, sizeof weight);
}

/* Tries the tetrahedra with boxes at the point, then those within a distance that doubles. */
static void find_tet(const struct bvh *tree, double first, struct search *s) {
    s->best = -1;
    for (double reach = 0.0; s->best < 0 || (s->least < 0.0 && reach <= first);
         reach = fmax(first, 2.0 * reach)) {
        struct box near = box_of_ball(s->x, reach);
        bvh_visit(tree, &near, try_tet, s);
    }
}

/* ---- all points ------------------------------------------------------------------------------ */

/* Boxes of the tetrahedra; returns half of their mean extent, m. */
static double make_boxes(const double *rest, const struct tets *tets, struct box *box) {
    double sum = 0.0;
    for (int t = 0; t < tets->count; t++) {
        box[t] = box_empty;
        for (int k = 0; k < 4; k++)
            box_add(&box[t], rest + 3 * (size_t)tets->corner[4 * (size_t)t + k]);
        sum += box_extent(&box[t]);
    }
    return 0.5 * sum / tets->count;
}

static void bind_points(const struct bvh *tree, double reach, struct search *s,
                        const struct mesh *mesh, struct embedding *e) {
    for (int i = 0; i < mesh->vertices; i++) {
        s->x = mesh->vertex + 3 * (size_t)i;
        find_tet(tree, reach, s);
        memcpy(e->corner + 4 * (size_t)i, s->tets->corner + 4 * (size_t)s->best,
               4 * sizeof *e->corner);
        memcpy(e->weight + 4 * (size_t)i, s->weight, sizeof s->weight);
    }
}

pdyn_status embedding_create(pdyn_context *context, const double *rest, const struct tets *tets,
                             const struct mesh *mesh, struct embedding *out) {
    struct bvh tree = {0};
    size_t numbers = 4 * (size_t)mesh->vertices;
    *out = (struct embedding){.count = mesh->vertices};
    struct box *box = NEW_ARRAY(context, tets->count, struct box);
    out->corner = NEW_ARRAY(context, numbers, int);
    out->weight = NEW_ARRAY(context, numbers, double);
    pdyn_status status = box && out->corner && out->weight ? bvh_create(context, tets->count, &tree)
                                                           : PDYN_NO_MEMORY;
    if (status == PDYN_OK) {
        struct search search = {.rest = rest, .tets = tets};
        double reach = make_boxes(rest, tets, box);
        bvh_build(&tree, box, tets->count);
        bind_points(&tree, reach, &search, mesh, out);
        bvh_free(context, &tree);
    }
    FREE_ARRAY(context, box, tets->count);
    if (status != PDYN_OK) embedding_free(context, out);
    return status;
}

void embedding_free(pdyn_context *context, struct embedding *embedding) {
    FREE_ARRAY(context, embedding->corner, 4 * (size_t)embedding->count);
    FREE_ARRAY(context, embedding->weight, 4 * (size_t)embedding->count);
}

/* ---- a tetrahedron for all points ------------------------------------------------------------ */

/* Square of the length, area or volume that a point adds to the first `n` of four. */
static double spanned(const double *const y[4], int n, const double x[3]) {
    double a[3], b[3], c[3], normal[3];
    vec3_subtract(a, x, y[0]);
    if (n == 1) return vec3_dot(a, a);
    vec3_subtract(b, y[1], y[0]);
    vec3_cross(normal, b, a);
    if (n == 2) return vec3_dot(normal, normal);
    vec3_subtract(c, y[2], y[0]);
    return vec3_dot(normal, c) * vec3_dot(normal, c);
}

void embedding_span(const double *x, int count, int corner[4]) {
    const double *y[4] = {x};
    corner[0] = 0;
    for (int n = 1; n < 4; n++) {
        double most = -1.0;
        for (int i = 0; i < count; i++) {
            double more = spanned(y, n, x + 3 * (size_t)i);
            if (more > most) most = more, corner[n] = i;
        }
        y[n] = x + 3 * (size_t)corner[n];
    }
}
