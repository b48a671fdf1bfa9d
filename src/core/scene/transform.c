#include "transform.h"

#include "params.h"

#include "projdyn/vec3.h"

#include <string.h>

static const pdyn_param transform_params[] = {
    {"rotate", PDYN_VECTOR, offsetof(struct transform, rotate), false, 0, -1e6, 1e6, "degrees", ""},
    {"translate", PDYN_VECTOR, offsetof(struct transform, translate), false, 0, -1e6, 1e6, "m", ""},
    {0}};

/* One number for all directions, or three. */
static pdyn_status read_scale(const struct json_at *at, double least, double scale[3]) {
    pdyn_status status = PDYN_OK;
    for (int k = 0; k < 3; k++) scale[k] = 1.0;
    if (json_is_array(at->value)) return params_reals(at, 3, least, 1e6, "1", scale);
    if (at->value) status = params_real(at, least, 1e6, "1", &scale[0]);
    scale[1] = scale[2] = scale[0];
    return status;
}

pdyn_status transform_read(const struct json_at *owner, double least, struct transform *out) {
    struct json_at scale = json_member(owner, "scale");
    pdyn_status status = read_scale(&scale, least, out->scale);
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

static void turn(const struct transform *t, double x[3]) {
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
        turn(t, x);
        vec3_add(x, 1.0, t->translate);
    }
}

void transform_directions(const struct transform *t, double *v, int count) {
    for (int i = 0; i < count; i++) turn(t, v + 3 * (size_t)i);
}

pdyn_status transform_path(const struct json_at *at, const char *what, char **path, size_t *size) {
    const struct json_file *scene = at->file;
    const char *name = json_string_value(at->value);
    if (!name) return json_expected(at, what);
    const char *slash = scene->loaded ? strrchr(scene->name, '/') : NULL;
    size_t folder = slash && *name != '/' ? (size_t)(slash - scene->name) + 1 : 0;
    *size = folder + strlen(name) + 1;
    *path = NEW_ARRAY(scene->context, *size, char);
    if (!*path) return PDYN_NO_MEMORY;
    memcpy(*path, scene->name, folder);
    strcpy(*path + folder, name);
    return PDYN_OK;
}

pdyn_status transform_mesh(const struct json_at *at, struct mesh *mesh) {
    char *path = NULL;
    size_t size = 0;
    pdyn_status status = transform_path(at, "the name of a mesh file, .obj or .ply", &path, &size);
    if (status != PDYN_OK) return status;
    status = json_wrap(at, mesh_read(at->file->context, path, mesh));
    FREE_ARRAY(at->file->context, path, size);
    return status;
}

pdyn_status transform_particles(const struct json_at *at, struct particles *particles) {
    char *path = NULL;
    size_t size = 0;
    pdyn_status status =
        transform_path(at, "the name of a file of particles, .ply or .vtk", &path, &size);
    if (status != PDYN_OK) return status;
    status = json_wrap(at, particles_read(at->file->context, path, particles));
    FREE_ARRAY(at->file->context, path, size);
    return status;
}
