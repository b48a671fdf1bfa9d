/* Transforms of points and directions. */
#include "transform.h"

#include "params.h"

#include "projdyn/vec3.h"

static const pdyn_param transform_params[] = {
    {"rotate", PDYN_VECTOR, offsetof(struct transform, rotate), false, 0, -1e6, 1e6, "degrees", ""},
    {"translate", PDYN_VECTOR, offsetof(struct transform, translate), false, 0, -1e6, 1e6, "m", ""},
    {0}};

/* A scale is one number for all axes, or an array of three. */
static pdyn_status read_scale(const struct json_at *at, double min, double scale[3]) {
    pdyn_status status = PDYN_OK;
    for (int k = 0; k < 3; k++) scale[k] = 1.0;
    if (json_is_array(at->value)) return params_reals(at, 3, min, 1e6, "1", scale);
    if (at->value) status = params_real(at, min, 1e6, "1", &scale[0]);
    scale[1] = scale[2] = scale[0];
    return status;
}

pdyn_status transform_read(const struct json_at *owner, double min, struct transform *out) {
    struct json_at scale = json_member(owner, "scale");
    pdyn_status status = read_scale(&scale, min, out->scale);
    if (status == PDYN_OK && !(out->scale[0] * out->scale[1] * out->scale[2] != 0.0))
        status = json_expected(&scale, "a scale that is not 0");
    if (status == PDYN_OK) status = params_read(owner, transform_params, NULL, out);
    return status;
}

pdyn_status transform_refuse(const struct json_at *owner, const char *what) {
    static const char *const keys[] = {"scale", "rotate", "translate"};
    for (int k = 0; k < 3; k++) {
        struct json_at key = json_member(owner, keys[k]);
        if (key.value) return json_fail_at_key(&key, "\"%s\" needs %s", keys[k], what);
    }
    return PDYN_OK;
}

static void rotate(const struct transform *t, double x[3]) {
    for (int a = 0; a < 3; a++) {
        double angle = fmod(t->rotate[a], 360.0) * (acos(-1.0) / 180.0);
        double *p = &x[(a + 1) % 3], *q = &x[(a + 2) % 3], before = *p;
        *p = cos(angle) * before - sin(angle) * *q;
        *q = sin(angle) * before + cos(angle) * *q;
    }
}

void transform_points(const struct transform *t, double *x, int count) {
    for (int i = 0; i < count; i++, x += 3) {
        for (int a = 0; a < 3; a++) x[a] *= t->scale[a];
        rotate(t, x);
        vec3_add(x, 1.0, t->translate);
    }
}

void transform_directions(const struct transform *t, double *v, int count) {
    for (int i = 0; i < count; i++) rotate(t, v + 3 * (size_t)i);
}
