#include "mesh_query.h"

#include "distance.h"

struct search {
    const struct mesh_query *query;
    const double *x;
    double square; /* m^2: distance that is close */
    bool found;    /* a triangle is closer; or: the number of crossings is odd */
    const int *of; /* the group of each triangle; those of group `own` do not count. NULL: all do */
    int own;
};

pdyn_status mesh_query_create(pdyn_context *context, const struct mesh *mesh,
                              struct mesh_query *out) {
    *out = (struct mesh_query){.mesh = mesh, .bounds = box_empty};
    out->box = NEW_ARRAY(context, mesh->triangles, struct box);
    if (mesh->triangles && !out->box) return PDYN_NO_MEMORY;
    pdyn_status status = bvh_create(context, mesh->triangles, &out->tree);
    if (status != PDYN_OK) {
        FREE_ARRAY(context, out->box, mesh->triangles);
        return status;
    }
    for (int t = 0; t < mesh->triangles; t++) {
        const double *corner[3];
        mesh_corners(mesh, t, corner);
        out->box[t] = box_empty;
        for (int c = 0; c < 3; c++) {
            box_add(&out->box[t], corner[c]);
            box_add(&out->bounds, corner[c]);
        }
    }
    bvh_build(&out->tree, out->box, mesh->triangles);
    return PDYN_OK;
}

void mesh_query_free(pdyn_context *context, struct mesh_query *query) {
    if (!query->mesh) return;
    FREE_ARRAY(context, query->box, query->mesh->triangles);
    bvh_free(context, &query->tree);
}

static void visit_close(void *user, int t) {
    struct search *s = user;
    const double *corner[3];
    double c[4];
    mesh_corners(s->query->mesh, t, corner);
    const double *const points[4] = {s->x, corner[0], corner[1], corner[2]};
    s->found = s->found || closest_vertex_face(points, c) < s->square;
}

bool mesh_query_is_close(const struct mesh_query *query, const double x[3], double distance) {
    struct search s = {.query = query, .x = x, .square = distance * distance};
    struct box box = box_of_ball(x, distance);
    if (box_overlaps(&box, &query->bounds)) bvh_visit(&query->tree, &box, visit_close, &s);
    return s.found;
}

static void visit_crossing(void *user, int t) {
    struct search *s = user;
    const double *corner[3];
    double end[3][2];
    int ends = 0;
    if (s->of && s->of[t] == s->own) return;
    mesh_corners(s->query->mesh, t, corner);
    for (int c = 0; c < 3; c++) {
        const double *p = corner[c], *q = corner[(c + 1) % 3];
        if ((p[2] <= s->x[2]) != (q[2] <= s->x[2])) mesh_cut_edge(p, q, s->x[2], end[ends++]);
    }
    if (ends < 2 || (end[0][1] <= s->x[1]) == (end[1][1] <= s->x[1])) return;
    double along = (s->x[1] - end[0][1]) / (end[1][1] - end[0][1]);
    s->found ^= end[0][0] + along * (end[1][0] - end[0][0]) > s->x[0];
}

bool mesh_query_contains(const struct mesh_query *query, const double x[3]) {
    return mesh_query_contains_others(query, x, NULL, 0);
}

bool mesh_query_contains_others(const struct mesh_query *query, const double x[3], const int *of,
                                int own) {
    struct search s = {.query = query, .x = x, .of = of, .own = own};
    struct box ray = {{x[0], x[1], x[2]}, {query->bounds.max[0], x[1], x[2]}};
    if (ray.min[0] <= ray.max[0] && box_overlaps(&ray, &query->bounds))
        bvh_visit(&query->tree, &ray, visit_crossing, &s);
    return s.found;
}
