/* Reading inlets and outlets; the lattice of particles in an inlet. */
#include "inlet.h"

#include "fill.h"
#include "geometry/sampling.h"
#include "inlet_motion.h"
#include "keyed.h"
#include "motion.h"
#include "params.h"
#include "reader.h"

#include "projdyn/vec3.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const pdyn_param inlet_params[] = {
    {"direction", PDYN_VECTOR, offsetof(struct scene_inlet, direction), true, 0, -1e6, 1e6, "1",
     ""},
    {"start", PDYN_REAL, offsetof(struct scene_inlet, start), false, 0, 0, 1e6, "s", ""},
    {"duration", PDYN_REAL, offsetof(struct scene_inlet, duration), false, 0, 1e-9, 1e6, "s", ""},
    {0}};

const pdyn_param inlet_speed_param = {
    "speed", PDYN_REAL, offsetof(struct scene_inlet, speed), true, 0, 0, INLET_MAX_SPEED,
    "m/s",   ""};

const pdyn_param outlet_params[] = {{"outside", PDYN_BOOL, offsetof(struct scene_outlet, outside),
                                     false, 0, -INFINITY, INFINITY, "", ""},
                                    {0}};

/* The opening of an inlet: a lattice in the plane spanned by `across` and `up`. */
struct opening {
    double center[3], across[3], up[3];
    const double *direction;
    double spacing; /* m, particle spacing */
    double *area;   /* m^2 */
    struct point_list *layer;
};

/* ---- the plane ------------------------------------------------------------------------------- */

static pdyn_status read_direction(const struct json_at *owner, double direction[3]) {
    struct json_at at = json_member(owner, "direction");
    double length = vec3_length(direction);
    if (!(length > 0.0)) return json_expected(&at, "a direction that is not 0");
    for (int a = 0; a < 3; a++) direction[a] /= length;
    return PDYN_OK;
}

/* Computes the axes of the plane. Default of "up": y, or z for a flow along y. */
static pdyn_status read_axes(const struct json_at *owner, const double direction[3],
                             struct opening *o) {
    struct json_at at = json_member(owner, "up");
    bool along_y = fabs(direction[1]) > 0.999;
    double up[3] = {0.0, !along_y, along_y};
    pdyn_status status = at.value ? params_reals(&at, 3, -1e6, 1e6, "1", up) : PDYN_OK;
    if (status != PDYN_OK) return status;
    double size = vec3_length(up);
    vec3_add(up, -vec3_dot(up, direction), direction);
    double length = vec3_length(up);
    if (!(length > 1e-6 * size))
        return json_expected(&at, "a direction that is not 0 and not parallel to the flow");
    for (int a = 0; a < 3; a++) o->up[a] = up[a] / length;
    vec3_cross(o->across, direction, o->up);
    return PDYN_OK;
}

/* ---- the lattice of a layer ------------------------------------------------------------------ */

static pdyn_status check_size(const struct json_at *at, double points) {
    if (points <= MAX_PARTICLES) return PDYN_OK;
    return json_fail(at, "expected at most %d particles in a layer, found about %.10g",
                     MAX_PARTICLES, points);
}

/* Appends the lattice point i spacings across and j spacings up from the centre. Every second point
 * is in front, as on a chessboard: layers that a falling jet draws apart then stay close. */
static pdyn_status add_point(const struct json_at *at, const struct opening *o, double i,
                             double j) {
    double x[3] = {o->center[0], o->center[1], o->center[2]};
    if (fmod(fabs(floor(i) + floor(j)), 2.0) > 0.0)
        vec3_add(x, INLET_STAGGER * o->spacing, o->direction);
    vec3_add(x, i * o->spacing, o->across);
    vec3_add(x, j * o->spacing, o->up);
    return point_list_add(at->file->context, o->layer, x);
}

static pdyn_status read_rectangle(const struct json_at *at, struct opening *o) {
    static const char *const keys[] = {"center", "size", NULL};
    struct json_at center = json_member(at, "center"), size_at = json_member(at, "size");
    double size[2], n[2];
    pdyn_status status = params_check_keys(at, NULL, keys);
    if (status == PDYN_OK)
        status = params_reals(&center, 3, -SCENE_MAX_POSITION, SCENE_MAX_POSITION, "m", o->center);
    if (status == PDYN_OK) status = params_reals(&size_at, 2, 0.0, 1e6, "m", size);
    for (int a = 0; a < 2 && status == PDYN_OK; a++) {
        n[a] = sample_cells(size[a], o->spacing);
        if (n[a] < 1.0)
            status = json_fail(&size_at,
                               "expected edges of at least %.10g m (twice the radius), found "
                               "%.10g m",
                               o->spacing, size[a]);
    }
    if (status == PDYN_OK) status = check_size(at, n[0] * n[1]);
    if (status != PDYN_OK) return status;
    *o->area = size[0] * size[1];
    for (double j = 0.0; j < n[1]; j++)
        for (double i = 0.0; i < n[0] && status == PDYN_OK; i++)
            status = add_point(at, o, i - 0.5 * (n[0] - 1.0), j - 0.5 * (n[1] - 1.0));
    return status;
}

/* Appends the lattice points inside a disc; one is at its centre. Their number corresponds to the
 * area of the disc. */
static pdyn_status read_disc(const struct json_at *at, struct opening *o) {
    struct sphere disc;
    pdyn_status status = params_sphere(at, &disc);
    if (status != PDYN_OK) return status;
    double reach = disc.radius / o->spacing * (1.0 + 1e-12) + 1e-9, n = floor(reach);
    status = check_size(at, 4.0 * reach * reach);
    *o->area = acos(-1.0) * disc.radius * disc.radius;
    for (int a = 0; a < 3; a++) o->center[a] = disc.center[a];
    for (double j = -n; j <= n; j++)
        for (double i = -n; i <= n && status == PDYN_OK; i++)
            if (i * i + j * j <= reach * reach) status = add_point(at, o, i, j);
    return status;
}

static pdyn_status read_opening(const struct json_at *at, struct opening *o) {
    static const char *const shapes[] = {"rectangle", "disc"};
    int shape;
    pdyn_status status = reader_one_of(at, shapes, 2, &shape);
    if (status != PDYN_OK) return status;
    struct json_at found = json_member(at, shapes[shape]);
    status = shape ? read_disc(&found, o) : read_rectangle(&found, o);
    return status == PDYN_OK ? fill_check_range(&found, o->layer, 0) : status;
}

/* ---- inlets and outlets ---------------------------------------------------------------------- */

/* Without keys the speed is constant. */
static pdyn_status read_speeds(const struct json_at *at, struct scene_inlet *out) {
    double key[4] = {0};
    if (!json_is_number(at->value) && !json_is_array(at->value))
        return json_expected(at, "a number, or an array of keys");
    if (json_is_array(at->value))
        return json_array_size(at->value) ? keyed_read_path(at, &inlet_speed_param, &out->speed)
                                          : json_expected(at, "at least one key");
    pdyn_status status = params_real(at, 1e-6, INLET_MAX_SPEED, "m/s", key + 1);
    return status == PDYN_OK ? keyed_set_path(at->file->context, &out->speed, key, 1) : status;
}

pdyn_status inlet_read(const struct json_at *at, const struct scene_body *body,
                       struct scene_inlet *out) {
    static const char *const others[] = {"rectangle", "disc",  "up", "speed",
                                         "motion",    "pivot", NULL};
    struct opening opening = {.spacing = 2.0 * body->radius,
                              .direction = out->direction,
                              .area = &out->area,
                              .layer = &out->layer};
    struct json_at speed = json_member(at, "speed");
    pdyn_status status = params_check_keys(at, inlet_params, others);
    if (status == PDYN_OK) status = params_read(at, inlet_params, NULL, out);
    if (status == PDYN_OK) status = read_speeds(&speed, out);
    if (status == PDYN_OK) status = read_direction(at, out->direction);
    if (status == PDYN_OK) status = read_axes(at, out->direction, &opening);
    if (status == PDYN_OK) status = read_opening(at, &opening);
    memcpy(out->motion.pivot, opening.center, sizeof opening.center);
    if (status == PDYN_OK) status = motion_read(at, &out->motion);
    out->end = out->duration > 0.0 ? out->start + out->duration : INFINITY;
    return status;
}

/* Whether inlet k of the body has as many particles in a layer, and as large an opening, as inlet
 * j. */
static bool is_like(const struct scene_body *body, int k, int j) {
    const struct scene_inlet *a = &body->inlet[k], *b = &body->inlet[j];
    return a->layer.count == b->layer.count && a->area == b->area;
}

void inlet_note_areas(pdyn_context *context, const struct scene_body *body) {
    for (int k = 0; k < body->inlets; k++) {
        const struct scene_inlet *inlet = &body->inlet[k];
        double part = inlet->layer.count * 4.0 * body->radius * body->radius / inlet->area;
        int first = 0, alike = 0;
        char of_each[48] = "";
        while (!is_like(body, first, k)) first++;
        if (first < k || fabs(part - 1.0) <= 0.1) continue;
        for (int j = k; j < body->inlets; j++) alike += is_like(body, j, k);
        if (alike > 1) snprintf(of_each, sizeof of_each, "in each of %d inlets ", alike);
        context_log(
            context, PDYN_LOG_INFO,
            "body \"%s\": %sa layer of %d particles of radius %g m has %.3g %% of the area of "
            "its inlet, %.4g m^2, and so has the flow; %.3g times the speed gives the flow "
            "of that area",
            body->name, of_each, inlet->layer.count, body->radius, 100.0 * part, inlet->area,
            1.0 / part);
    }
}

void inlet_free(pdyn_context *context, struct scene_inlet *inlet) {
    keyed_free_path(context, &inlet->speed);
    motion_free(context, &inlet->motion);
    point_list_free(context, &inlet->layer);
}

pdyn_status outlet_read(const struct json_at *at, struct scene_outlet *out) {
    static const char *const others[] = {"box", NULL};
    pdyn_status status = params_check_keys(at, outlet_params, others);
    struct json_at box = json_member(at, "box");
    if (status == PDYN_OK) status = params_read(at, outlet_params, NULL, out);
    return status == PDYN_OK ? params_box(&box, &out->box) : status;
}
