#include "vessel.h"

#include "inlet_motion.h"
#include "poses.h"

/* Whether the point is in the box of a solid as it stands at time 0. */
static bool contains(const struct scene_solid *solid, const double x[3]) {
    double at[3];
    pose_to_rest(&solid->motion, 0.0, x, at);
    return box_contains(&solid->box, at);
}

static bool contains_most(const struct scene_solid *solid, const struct point_list *points) {
    int inside = 0;
    for (int i = 0; i < points->count; i++) inside += contains(solid, points->x + 3 * (size_t)i);
    return 2 * inside > points->count;
}

static bool contains_inlet(const struct scene_solid *solid, const struct scene_inlet *inlet) {
    int inside = 0;
    for (int i = 0; i < inlet->layer.count; i++) {
        double x[3];
        inlet_place(inlet, i, 0.0, 0.0, x);
        inside += contains(solid, x);
    }
    return 2 * inside > inlet->layer.count;
}

static bool holds_fluid(const struct scene *scene, const struct scene_solid *solid) {
    for (int b = 0; b < scene->bodies; b++) {
        const struct scene_body *body = &scene->body[b];
        if (contains_most(solid, &body->start)) return true;
        for (int k = 0; k < body->inlets; k++)
            if (contains_inlet(solid, &body->inlet[k])) return true;
    }
    return false;
}

void vessel_find_all(struct scene *scene) {
    for (int k = 0; k < scene->solids; k++) {
        struct scene_solid *solid = &scene->solid[k];
        solid->is_vessel = solid->open || (solid->kind == SOLID_BOX && holds_fluid(scene, solid));
    }
}

bool vessel_is_behind_wall(const struct scene_solid *vessel, const double rest[3],
                           double distance) {
    bool behind = false;
    for (int side = 0; side < 6; side++) {
        int a = side / 2;
        double beyond = side % 2 ? rest[a] - vessel->box.max[a] : vessel->box.min[a] - rest[a];
        if (beyond > distance) return false;
        behind |= beyond > 0.0 && !(vessel->open >> side & 1u);
    }
    return behind;
}
