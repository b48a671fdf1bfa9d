#include "embedding.h"

#include "base/groups.h"
#include "bvh.h"
#include "projdyn/vec3.h"

#include <math.h>
#include <string.h>

/* Least coordinate below which a point is far from its tetrahedron: beyond half of a height. */
static const double far = -0.5;

/* ---- the tetrahedron of a point -------------------------------------------------------------- */

struct search {
    const double *rest;
    const struct tets *tets;
    const double *x; /* the point */
    int best;        /* tetrahedron with the largest least coordinate; -1: none yet */
    double least, weight[4];
};

/* Barycentric coordinates of x. */
static void weigh(const double *rest, const int corner[4], const double x[3], double weight[4]) {
    const double *y[4];
    double edge[3][3], normal[3], to[3];
    for (int k = 0; k < 4; k++) y[k] = rest + 3 * (size_t)corner[k];
    for (int k = 0; k < 3; k++) vec3_subtract(edge[k], y[k + 1], y[0]);
    vec3_subtract(to, x, y[0]);
    weight[0] = 1.0;
    for (int k = 0; k < 3; k++) {
        vec3_cross(normal, edge[(k + 1) % 3], edge[(k + 2) % 3]);
        weight[k + 1] = vec3_dot(normal, to) / vec3_dot(normal, edge[k]);
        weight[0] -= weight[k + 1];
    }
}

static double least_of(const double weight[4]) {
    return fmin(fmin(weight[0], weight[1]), fmin(weight[2], weight[3]));
}

static void try_tet(void *user, int t) {
    struct search *s = user;
    double weight[4];
    weigh(s->rest, s->tets->corner + 4 * (size_t)t, s->x, weight);
    double least = least_of(weight);
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

/* ---- four vertices that span a large tetrahedron --------------------------------------------- */

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

/* ---- parts far from the tetrahedra ----------------------------------------------------------- */

/* Parts of the mesh without tetrahedra, as ears thinner than a cell. Bound to the nearest
 * tetrahedron, the vertices of a part would be extrapolated over many times its size, and
 * neighbours would follow different ones. Four vertices far apart carry all of the part. */

struct part {
    int hub;      /* the vertex of tetrahedra that is nearest to the part */
    double reach; /* m, from the hub to the vertices of the part and of their tetrahedra */
};

struct spread {
    const double *rest;
    const struct tets *tets;
    double reach; /* m, from the first vertex */
    int n;        /* vertices found */
    int corner[4];
    const double *y[4];
    double most; /* that the next vertex adds */
};

static void try_corners(void *user, int t) {
    struct spread *s = user;
    for (int k = 0; k < 4; k++) {
        int i = s->tets->corner[4 * (size_t)t + k];
        const double *y = s->rest + 3 * (size_t)i;
        double more = spanned(s->y, s->n, y);
        if (more <= s->most || vec3_distance(y, s->y[0]) > s->reach) continue;
        s->most = more, s->corner[s->n] = i, s->y[s->n] = y;
    }
}

/* Finds three more vertices of tetrahedra within twice the reach of a part from its hub. */
static void find_spread(const struct bvh *tree, const double *rest, const struct tets *tets,
                        const struct part *part, int corner[4]) {
    struct spread s = {.rest = rest, .tets = tets, .reach = 2.0 * part->reach};
    s.corner[0] = part->hub, s.y[0] = rest + 3 * (size_t)part->hub;
    const struct box near = box_of_ball(s.y[0], s.reach);
    for (s.n = 1; s.n < 4; s.n++) {
        s.most = 0.0;
        bvh_visit(tree, &near, try_corners, &s);
    }
    memcpy(corner, s.corner, sizeof s.corner);
}

struct parts {
    const double *rest;
    const struct mesh *mesh;
    int *label;        /* vertices of the mesh: the first vertex of the part; -1: near tetrahedra */
    struct part *part; /* vertices of the mesh: of the part that begins there */
};

/* Labels the vertices of each part, which triangles join. */
static void label_parts(struct parts *p, const struct embedding *e) {
    for (int i = 0; i < e->count; i++)
        p->label[i] = least_of(e->weight + 4 * (size_t)i) < far ? i : -1;
    for (int k = 0; k < 3 * p->mesh->triangles; k++) {
        int a = p->mesh->triangle[k], b = p->mesh->triangle[k % 3 < 2 ? k + 1 : k - 2];
        if (p->label[a] >= 0 && p->label[b] >= 0) groups_join(p->label, a, b);
    }
    for (int i = 0; i < e->count; i++)
        if (p->label[i] >= 0) p->label[i] = groups_first(p->label, i);
}

static struct part *part_of(const struct parts *p, int vertex) {
    return p->label[vertex] < 0 ? NULL : &p->part[p->label[vertex]];
}

static void find_hubs(const struct parts *p, const struct embedding *e) {
    for (int i = 0; i < e->count; i++) p->part[i].reach = INFINITY;
    for (int k = 0; k < 4 * e->count; k++) {
        const double *x = p->mesh->vertex + 3 * (size_t)(k / 4);
        double distance = vec3_distance(x, p->rest + 3 * (size_t)e->corner[k]);
        struct part *part = part_of(p, k / 4);
        if (part && distance < part->reach) *part = (struct part){e->corner[k], distance};
    }
}

static void find_reaches(const struct parts *p, const struct embedding *e) {
    for (int k = 0; k < 4 * e->count; k++) {
        struct part *part = part_of(p, k / 4);
        if (!part) continue;
        const double *hub = p->rest + 3 * (size_t)part->hub;
        double to_vertex = vec3_distance(hub, p->mesh->vertex + 3 * (size_t)(k / 4));
        double to_corner = vec3_distance(hub, p->rest + 3 * (size_t)e->corner[k]);
        part->reach = fmax(part->reach, fmax(to_vertex, to_corner));
    }
}

/* Binds each part to its hub and to three vertices within twice its reach. */
static void bind_parts(const struct parts *p, const struct tets *tets, const struct bvh *tree,
                       struct embedding *e) {
    for (int i = 0; i < e->count; i++) {
        int first = p->label[i], *corner = e->corner + 4 * (size_t)i;
        if (first < 0) continue;
        if (first == i) find_spread(tree, p->rest, tets, &p->part[i], corner);
        else memcpy(corner, e->corner + 4 * (size_t)first, 4 * sizeof *corner);
        weigh(p->rest, corner, p->mesh->vertex + 3 * (size_t)i, e->weight + 4 * (size_t)i);
    }
}

static pdyn_status bind_far_parts(pdyn_context *context, const struct search *s,
                                  const struct mesh *mesh, const struct bvh *tree,
                                  struct embedding *e) {
    struct parts p = {.rest = s->rest,
                      .mesh = mesh,
                      .label = NEW_ARRAY(context, e->count, int),
                      .part = NEW_ARRAY(context, e->count, struct part)};
    pdyn_status status = p.label && p.part ? PDYN_OK : PDYN_NO_MEMORY;
    if (status == PDYN_OK) {
        label_parts(&p, e);
        find_hubs(&p, e);
        find_reaches(&p, e);
        bind_parts(&p, s->tets, tree, e);
    }
    FREE_ARRAY(context, p.label, e->count);
    FREE_ARRAY(context, p.part, e->count);
    return status;
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
        status = bind_far_parts(context, &search, mesh, &tree, out);
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
