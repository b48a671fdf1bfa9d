/* The head of a body, and the pressure that a fluid may meet (see head.h). */
#include "head.h"

#include "inlet_motion.h"
#include "poses.h"

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

/* At a time, s. */
static void add_inlet(struct heights *h, const struct scene_inlet *inlet, double radius,
                      double time) {
    double speed = inlet_top_speed(inlet, -INFINITY, INFINITY);
    for (int i = 0; i < inlet->layer.count; i++) {
        double x[3];
        inlet_place(inlet, i, 0.0, time, x);
        add(h, x, radius, speed);
    }
}

static void add_body(struct heights *h, const struct scene_body *body) {
    const struct point_list *start = &body->start, *v = &body->start_v;
    if (body->has_mesh) add_mesh(h, &body->mesh, vec3_length(body->velocity));
    for (int i = 0; i < start->count; i++)
        add(h, start->x + 3 * (size_t)i, body->radius,
            i < v->count ? vec3_length(v->x + 3 * (size_t)i) : 0.0);
    for (int k = 0; k < body->inlets; k++) {
        add_inlet(h, &body->inlet[k], body->radius, -INFINITY);
        for (int m = 0; m < body->inlet[k].motion.keys; m++)
            add_inlet(h, &body->inlet[k], body->radius, body->inlet[k].motion.key[m].time);
    }
}

static struct heights empty_range(const double *g) {
    struct heights h = {.gravity = vec3_length(g), .lowest = INFINITY, .highest = -INFINITY};
    vec3_add(h.up, -1.0 / h.gravity, g);
    return h;
}

static double lowest_point(const struct scene *scene) {
    struct heights h = empty_range(scene->settings.gravity);
    for (int b = 0; b < scene->bodies; b++) add_body(&h, &scene->body[b]);
    for (int s = 0; s < scene->solids; s++) add_mesh(&h, &scene->solid[s].mesh, 0.0);
    return h.lowest;
}

static double top_of(const struct scene *scene, const struct scene_body *body) {
    struct heights h = empty_range(scene->settings.gravity);
    add_body(&h, body);
    return h.highest;
}

/* Returns the densest body of particles that reaches above a height, NULL: there is none; *top: how
 * high it reaches, m. */
static const struct scene_body *densest_above(const struct scene *scene, double above,
                                              double *top) {
    const struct scene_body *densest = NULL;
    for (int b = 0; b < scene->bodies; b++) {
        const struct scene_body *body = &scene->body[b];
        double reach = body->has_mesh ? -INFINITY : top_of(scene, body);
        if (!(reach > above) || (densest && body->rest_density <= densest->rest_density)) continue;
        densest = body, *top = reach;
    }
    return densest;
}

double scene_head(const struct scene *scene, const struct scene_body *body) {
    double head = 0.0, top;
    const struct scene_body *dense;
    if (vec3_length(scene->settings.gravity) == 0.0) return 0.0;
    double from = lowest_point(scene);
    if (body->has_mesh) return top_of(scene, body) - from;
    for (; (dense = densest_above(scene, from, &top)); from = top)
        head += dense->rest_density / body->rest_density * (top - from);
    return head;
}

double scene_pressure(const struct scene *scene, const struct scene_body *fluid) {
    double gravity = vec3_length(scene->settings.gravity), rho = fluid ? fluid->rest_density : 0.0;
    if (gravity == 0.0) return 0.0;
    double from = lowest_point(scene), largest = 0.0;
    if (fluid) largest = rho * gravity * scene_head(scene, fluid);
    for (int b = 0; b < scene->bodies; b++) {
        const struct scene_body *body = &scene->body[b];
        double density = fmax(rho, body->has_mesh ? body->density : body->rest_density);
        largest = fmax(largest, density * gravity * (top_of(scene, body) - from));
    }
    for (int s = 0; s < scene->solids; s++) {
        double speed = pose_top_speed_of_mesh(&scene->solid[s], INFINITY);
        largest = fmax(largest, 0.5 * rho * speed * speed);
    }
    return largest;
}
