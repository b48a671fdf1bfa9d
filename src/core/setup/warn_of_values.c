/* Warnings about values outside of the range that occurs in practice: slips of units and signs. */
#include "base/param_kind.h"
#include "sim/extent.h"
#include "sim/sim.h"
#include "warn.h"

#include "projdyn/path.h"
#include "projdyn/vec3.h"

#include <string.h>

struct usual {                  /* the range of a value */
    const char *type, *name;    /* of the constraint and its parameter; NULL: of the scene */
    double from, to;            /* 0 is usual as well */
    const char *unit, *example; /* " Pa", or ""; known values, for comparison */
};

static const struct usual usual_gravity = {NULL,  "gravity", 0.0,
                                           100.0, " m/s^2",  "on Earth it is 9.81 m/s^2"};
static const struct usual usual_friction = {
    NULL, "friction", 0.0, 10.0, "", "steel on steel has 0.2, rubber on concrete 1"};

/* Below, water would cross a sheet by less than a hundredth of a millimetre a second at a depth of
 * a metre, and steps would take thousands of iterations (docs/theory/constraints.md). */
static const struct usual usual_permeability = {
    NULL, "permeability", 1e-9,
    1e6,  " m/(Pa s)",    "wide meshes have 1e-2 m/(Pa s), cloth 1e-4 m/(Pa s), a tight sheet 0"};

static const struct usual usual_parameters[] = {
    {"surface_tension", "tension", 0.0, 1.0, " N/m", "water has 0.072 N/m, mercury 0.49 N/m"},
    {"viscosity", "viscosity", 0.0, 1e4, " Pa s", "water has 0.001 Pa s, honey 10 Pa s"},
    {"gas", "outside", 1e3, 1e9, " Pa", "air has 101325 Pa"},
};

static void check_value(struct pdyn_sim *sim, const char *subject, const struct usual *usual,
                        double value) {
    if (value == 0.0 || (value >= usual->from && value <= usual->to)) return;
    WARN(sim, UNUSUAL, subject, "\"%s\" of %g%s is unusual, expected %g to %g%s: %s", usual->name,
         value, usual->unit, usual->from, usual->to, usual->unit, usual->example);
}

static double value_of(const struct scene_constraint *c, const pdyn_param *p) {
    return *(const double *)((const char *)c->params + p->offset);
}

double warn_parameter(const struct scene_constraint *c, const char *name) {
    for (const pdyn_param *p = c->type->params; p->name; p++)
        if (p->kind == PDYN_REAL && !strcmp(p->name, name)) return value_of(c, p);
    return 0.0;
}

static void check_parameters(struct pdyn_sim *sim, const struct scene_body *body,
                             const struct scene_constraint *c) {
    for (size_t k = 0; k < sizeof usual_parameters / sizeof *usual_parameters; k++) {
        const struct usual *usual = &usual_parameters[k];
        if (!strcmp(c->type->name, usual->type))
            check_value(sim, body->name, usual, warn_parameter(c, usual->name));
    }
}

static double longest_step(const struct scene_settings *settings) {
    return fmin(settings->h_fixed > 0.0 ? settings->h_fixed : settings->h_max,
                settings->frame_interval);
}

/* ---- surface tension ------------------------------------------------------------------------- */

/* Sound speed over sqrt(tension / (rest density x spacing)) that drops need, and the least without
 * a warning (docs/theory/surface-tension.md). */
static const double needed_speed = 10.0, least_speed = 5.0;

/* Drops whose surface compresses the fluid. */
static void check_softness(struct pdyn_sim *sim, int b, double tension) {
    const struct scene_body *body = &sim->scene.body[b];
    double speed = sqrt(tension / (body->rest_density * 2.0 * body->radius));
    for (int k = 0; k < body->constraints; k++) {
        double sound = warn_parameter(&body->constraint[k], "sound_speed");
        if (!strcmp(body->constraint[k].type->name, "fluid") && sound < least_speed * speed)
            WARN(sim, UNUSUAL, body->name,
                 "a sound speed of %.3g m/s is low for a surface tension of %g N/m, expected %.2g "
                 "m/s or more: the surface compresses the fluid, and its particles clump",
                 sound, tension, needed_speed * speed);
    }
}

/* Longest step over sqrt(rest density x spacing^3 / tension) that drops need, and the most without
 * a warning (docs/theory/surface-tension.md). */
static const double needed_step = 1.0, most_step = 2.0;

/* Steps that are too long for the motion of the surface, by a spacing. */
static void check_step(struct pdyn_sim *sim, int b, double tension) {
    const struct scene_body *body = &sim->scene.body[b];
    double step = longest_step(&sim->scene.settings);
    double time = sqrt(body->rest_density * pow(2.0 * body->radius, 3.0) / tension);
    if (step > most_step * time)
        WARN(sim, UNUSUAL, body->name,
             "steps of up to %.2g s are long for a surface tension of %g N/m and particles %.2g m "
             "apart, expected %.2g s or less: they take many iterations, or stay unsolved",
             step, tension, 2.0 * body->radius, needed_step * time);
}

/* ---- gravity and weight ---------------------------------------------------------------------- */

/* Whether a box is open at the maximum of an axis. */
static bool is_open(const struct scene_solid *solid, int axis) {
    return solid->open >> (2 * axis + 1) & 1u;
}

/* Whether a tank is open at the maximum of an axis alone: a duct is open at both ends, a diving
 * bell at the minimum. */
static bool opens_towards(const struct scene_solid *solid, int axis) {
    bool minimum = solid->open >> (2 * axis) & 1u;
    return solid->is_vessel && is_open(solid, axis) && !minimum;
}

/* Tanks that are open at the top, towards which gravity points: its sign is wrong. */
static void check_sign(struct pdyn_sim *sim, const struct scene_solid *solid) {
    const double *gravity = sim->scene.settings.gravity;
    for (int a = 0; a < 3; a++)
        if (opens_towards(solid, a) && gravity[a] > 0.5 * vec3_length(gravity))
            WARN(sim, UNUSUAL, solid->name,
                 "gravity of (%g, %g, %g) m/s^2 points out of its open side +%c; expected the "
                 "other sign",
                 gravity[0], gravity[1], gravity[2], "xyz"[a]);
}

/* Tanks that are open at +y under a gravity along z, or at +z under one along y: their top is
 * closed, and the side that was to be the top is a wall. */
static void check_top(struct pdyn_sim *sim, const struct scene_solid *solid) {
    const double *gravity = sim->scene.settings.gravity;
    for (int up = 1; up < 3; up++) {
        int open = 3 - up;
        if (!opens_towards(solid, open) || is_open(solid, up)) continue;
        if (-gravity[up] > 0.5 * vec3_length(gravity))
            WARN(sim, UNUSUAL, solid->name,
                 "with gravity of (%g, %g, %g) m/s^2 its open side +%c is a side wall, and its top "
                 "+%c is closed; expected an open side +%c, or gravity along -%c",
                 gravity[0], gravity[1], gravity[2], "xyz"[open], "xyz"[up], "xyz"[up],
                 "xyz"[open]);
    }
}

/* A body that is softer than the pressure of its weight; only a fluid could carry it. */
static void check_collapse(struct pdyn_sim *sim, int b, const struct scene_constraint *c) {
    const struct scene_body *body = &sim->scene.body[b];
    struct box box = extent_of_body(sim, &sim->body[b]);
    double pressure = 0.0,
           stiffness = warn_parameter(c, "stiffness") + warn_parameter(c, "volume_stiffness");
    for (int a = 0; a < 3; a++)
        pressure +=
            body->density * fabs(sim->scene.settings.gravity[a]) * (box.max[a] - box.min[a]);
    if (stiffness > 0.0 && stiffness < pressure)
        WARN(sim, UNUSUAL, body->name,
             "a stiffness of %g Pa is less than the pressure of its own weight, %.3g Pa: it "
             "cannot carry itself; gelatin has 1e4 Pa, rubber 1e6 Pa",
             stiffness, pressure);
}

/* ---- paths of pins --------------------------------------------------------------------------- */

/* Part of the size of a body by which its pins may jump in the first step. */
static const double max_jump = 0.1;

/* A path that starts far from 0: often places instead of displacements. */
static void check_start(struct pdyn_sim *sim, int b, const char *type, const pdyn_path *path) {
    double at[3];
    path_at(path, 0.0, at);
    if (vec3_length(at) == 0.0) return;
    struct box box = extent_of_body(sim, &sim->body[b]);
    if (vec3_length(at) > max_jump * box_extent(&box))
        WARN(
            sim, UNUSUAL, sim->body[b].name,
            "the path of \"%s\" starts with (%g, %g, %g) m: its vertices jump there in the first "
            "step; a path has displacements from the place in the scene, and usually starts with 0",
            type, at[0], at[1], at[2]);
}

/* Angle from which on targets that turn in a step move through the axis, or the other way round. */
static const double max_turn = 180.0;

/* The largest change of an angle from `time` on in a step, degrees. */
static double turn_from(const pdyn_path *turn, double time, double step) {
    double before[3], after[3], most = 0.0;
    path_at(turn, time, before), path_at(turn, time + step, after);
    for (int a = 0; a < 3; a++) most = fmax(most, fabs(after[a] - before[a]));
    return most;
}

/* The largest change is in a step that begins or ends at a key. */
static void check_turn(struct pdyn_sim *sim, int b, const char *type, const pdyn_path *turn) {
    double step = longest_step(&sim->scene.settings), most = 0.0;
    for (int k = 0; k < turn->count; k++) {
        double at = turn->key[4 * (size_t)k];
        if (at > sim->scene.settings.duration) break;
        most = fmax(most, turn_from(turn, at, step));
        most = fmax(most, turn_from(turn, at - step, step));
    }
    if (most >= max_turn)
        WARN(sim, UNUSUAL, sim->body[b].name,
             "the turn of \"%s\" goes on by up to %.4g degrees in a step of %.3g s: its vertices "
             "move on straight lines in a step, through the axis, or turn the other way round",
             type, most, step);
}

static const pdyn_path *path_of(const struct scene_constraint *c, const char *name) {
    for (const pdyn_param *p = c->type->params; p->name; p++)
        if (!strcmp(p->name, name) && c->type->flags & PDYN_REACTION)
            return param_path(p, c->params);
    return NULL;
}

const pdyn_path *warn_path(const struct scene_constraint *c) { return path_of(c, "path"); }

static void check_body(struct pdyn_sim *sim, int b) {
    const struct scene_body *body = &sim->scene.body[b];
    check_value(sim, body->name, &usual_permeability, body->permeability);
    for (int k = 0; k < body->constraints; k++) {
        const struct scene_constraint *c = &body->constraint[k];
        check_parameters(sim, body, c);
        if (warn_path(c)) check_start(sim, b, c->type->name, warn_path(c));
        if (path_of(c, "turn")) check_turn(sim, b, c->type->name, path_of(c, "turn"));
        if (!strcmp(c->type->name, "surface_tension")) {
            check_softness(sim, b, warn_parameter(c, "tension"));
            check_step(sim, b, warn_parameter(c, "tension"));
        }
        if (!strcmp(c->type->name, "tet") && !warn_lightest_fluid(sim)) check_collapse(sim, b, c);
    }
}

void warn_of_values(struct pdyn_sim *sim) {
    const struct scene *scene = &sim->scene;
    check_value(sim, "", &usual_gravity, vec3_length(scene->settings.gravity));
    if (scene->has_contact) check_value(sim, "contact", &usual_friction, scene->contact.friction);
    for (int s = 0; s < scene->solids; s++) {
        check_sign(sim, &scene->solid[s]);
        check_top(sim, &scene->solid[s]);
    }
    for (int b = 0; b < sim->bodies; b++) check_body(sim, b);
}
