#include "contact_stiffness.h"

#include "head.h"

#include "projdyn/vec3.h"

#include <math.h>

/* N/m: cloth of 0.2 kg/m^2 rests at a few per cent below the thickness. */
static const double least = 1000.0;

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
        force = fmax(force, pressure * mesh_area(&body->mesh) / body->mesh.vertices);
        if (body->is_rigid) force = fmax(force, body->mass * gravity);
    }
    return force / scene->contact.thickness;
}
