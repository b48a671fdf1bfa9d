/* The head of a body (see head.h). */
#include "head.h"

#include "projdyn/vec3.h"

#include <math.h>

struct heights {            /* range of heights of a set of points */
    double up[3], gravity;  /* unit vector against gravity; |gravity|, m/s^2 */
    double lowest, highest; /* m; `highest` includes speed^2 / (2 gravity) */
};

static void add(struct heights *h, const double *x, double radius, double speed) {
    double height = vec3_dot(h->up, x);
    h->lowest = fmin(h->lowest, height - radius);
    h->highest = fmax(h->highest, height + radius + 0.5 * speed * speed / h->gravity);
}

static void add_mesh(struct heights *h, const struct mesh *mesh, double speed) {
    for (int i = 0; i < mesh->vertices; i++) add(h, mesh->vertex + 3 * (size_t)i, 0.0, speed);
}

static void add_body(struct heights *h, const struct scene_body *body) {
    const struct point_list *start = &body->start, *v = &body->start_v;
    if (body->is_surface) add_mesh(h, &body->mesh, vec3_length(body->velocity));
    for (int i = 0; i < start->count; i++)
        add(h, start->x + 3 * (size_t)i, body->radius,
            i < v->count ? vec3_length(v->x + 3 * (size_t)i) : 0.0);
    for (int k = 0; k < body->inlets; k++) {
        const struct scene_inlet *inlet = &body->inlet[k];
        for (int i = 0; i < inlet->layer.count; i++)
            add(h, inlet->layer.x + 3 * (size_t)i, body->radius, inlet->speed);
    }
}

double scene_head(const struct scene *scene, const struct scene_body *body) {
    const double *g = scene->settings.gravity;
    struct heights body_range = {
        .gravity = vec3_length(g), .lowest = INFINITY, .highest = -INFINITY};
    if (body_range.gravity == 0.0) return 0.0;
    vec3_add(body_range.up, -1.0 / body_range.gravity, g);
    struct heights scene_range = body_range;
    add_body(&body_range, body);
    for (int b = 0; b < scene->bodies; b++) add_body(&scene_range, &scene->body[b]);
    for (int s = 0; s < scene->solids; s++) add_mesh(&scene_range, &scene->solid[s].mesh, 0.0);
    return body_range.highest - scene_range.lowest;
}
