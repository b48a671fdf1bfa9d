#include "contact_stiffness.h"

#include "head.h"

#include "projdyn/vec3.h"

#include <math.h>

/* N/m: cloth of 0.2 kg/m^2 rests at a few per cent below the thickness. */
static const double least = 1000.0;

static double area_of(const struct mesh *mesh) {
    double sum = 0.0, n[3];
    for (int t = 0; t < mesh->triangles; t++) {
        const double *c[3];
        for (int k = 0; k < 3; k++) c[k] = mesh->vertex + 3 * (size_t)mesh->triangle[3 * t + k];
        vec3_normal(n, c[0], c[1], c[2]);
        sum += 0.5 * vec3_length(n);
    }
    return sum;
}

/* Pa; of solid bodies alone, or of the fluid that has more. */
static double largest_pressure(const struct scene *scene) {
    double largest = scene_pressure(scene, NULL);
    for (int b = 0; b < scene->bodies; b++)
        if (!scene->body[b].has_mesh)
            largest = fmax(largest, scene_pressure(scene, &scene->body[b]));
    return largest;
}

double scene_contact_stiffness(const struct scene *scene) {
    double gravity = vec3_length(scene->settings.gravity), pressure = largest_pressure(scene);
    double force = least * scene->contact.thickness;
    for (int b = 0; b < scene->bodies; b++) {
        const struct scene_body *body = &scene->body[b];
        if (!body->has_mesh) continue;
        force = fmax(force, pressure * area_of(&body->mesh) / body->mesh.vertices);
        if (body->is_rigid) force = fmax(force, body->mass * gravity);
    }
    return force / scene->contact.thickness;
}
