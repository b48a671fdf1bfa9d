/* Arrays that stand for files: checks, copies, and the list of a scene. */
#include "array_file.h"

#include <math.h>
#include <string.h>
#include <strings.h>

/* ---- checks ---------------------------------------------------------------------------------- */

static pdyn_status check_name(const struct array_kind *kind, const char *name) {
    size_t length = strlen(name), n = strlen(kind->ending);
    if (length > n && length < sizeof((struct array_file *)0)->name && !strchr(name, '/') &&
        !strcasecmp(name + length - n, kind->ending))
        return PDYN_OK;
    return set_error(PDYN_BAD_INPUT,
                     "%.256s: expected a name without '/', of at most 255 bytes, that ends with "
                     "%s",
                     name, kind->ending);
}

static pdyn_status check_count(const struct array_file *file, const char *what, int count) {
    if (count >= 1 && count <= MESH_MAX) return PDYN_OK;
    return set_error(PDYN_BAD_INPUT, "%s: number of %s: expected 1 to %d, found %d", file->name,
                     what, MESH_MAX, count);
}

static pdyn_status check_vectors(const struct array_file *file, const double *x, double max,
                                 const char *unit) {
    for (size_t i = 0; x && i < 3 * (size_t)file->points; i++)
        if (!(fabs(x[i]) <= max))
            return set_error(PDYN_BAD_INPUT,
                             "%s: %s %zu: expected a finite %s%c of at most %g %s, found %g",
                             file->name, file->kind->point, i / 3, x == file->v ? "v" : "",
                             "xyz"[i % 3], max, unit, x[i]);
    return PDYN_OK;
}

static pdyn_status check_element(const struct array_file *file, const int *corner, int element) {
    for (int k = 0; k < file->kind->corners; k++) {
        if (corner[k] < 0 || corner[k] >= file->points)
            return set_error(PDYN_BAD_INPUT, "%s: %s %d uses vertex %d, expected 0 to %d",
                             file->name, file->kind->element, element, corner[k], file->points - 1);
        for (int m = 0; m < k; m++)
            if (corner[m] == corner[k])
                return set_error(PDYN_BAD_INPUT, "%s: %s %d uses vertex %d twice", file->name,
                                 file->kind->element, element, corner[k]);
    }
    return PDYN_OK;
}

static pdyn_status check(const struct array_file *file) {
    pdyn_status status = check_count(file, "points", file->points);
    if (status == PDYN_OK && file->kind->corners)
        status = check_count(file, "elements", file->elements);
    if (status == PDYN_OK) status = check_vectors(file, file->x, MESH_MAX_COORDINATE, "m");
    if (status == PDYN_OK) status = check_vectors(file, file->v, MESH_MAX_SPEED, "m/s");
    for (int e = 0; e < file->elements && status == PDYN_OK; e++)
        status = check_element(file, file->corner + (size_t)e * (size_t)file->kind->corners, e);
    return status;
}

/* ---- the list -------------------------------------------------------------------------------- */

static size_t corners(const struct array_file *file) {
    return (size_t)file->elements * (size_t)file->kind->corners;
}

static const void *copy(pdyn_context *context, const void *from, size_t count, size_t size) {
    void *to = from ? context_array(context, count, size) : NULL;
    return to ? memcpy(to, from, count * size) : NULL;
}

/* Replaces the pointers by those of copies. PDYN_NO_MEMORY: some are NULL. */
static pdyn_status own(pdyn_context *context, struct array_file *file) {
    size_t numbers = 3 * (size_t)file->points;
    bool moving = file->v, meshed = file->corner;
    file->x = copy(context, file->x, numbers, sizeof *file->x);
    file->v = copy(context, file->v, numbers, sizeof *file->v);
    file->corner = copy(context, file->corner, corners(file), sizeof *file->corner);
    return file->x && !file->v == !moving && !file->corner == !meshed ? PDYN_OK : PDYN_NO_MEMORY;
}

static void free_file(pdyn_context *context, struct array_file *file) {
    FREE_ARRAY(context, file->corner, corners(file));
    FREE_ARRAY(context, file->v, 3 * (size_t)file->points);
    FREE_ARRAY(context, file->x, 3 * (size_t)file->points);
    FREE_ARRAY(context, file, 1);
}

static void drop(pdyn_context *context, struct array_file **list, const char *name) {
    while (*list && strcmp((*list)->name, name)) list = &(*list)->next;
    if (!*list) return;
    struct array_file *found = *list;
    *list = found->next;
    free_file(context, found);
}

pdyn_status array_file_add(pdyn_context *context, struct array_file **list, const char *name,
                           const struct array_file *from) {
    pdyn_status status = check_name(from->kind, name);
    if (status != PDYN_OK) return status;
    struct array_file *file = NEW_ARRAY(context, 1, struct array_file);
    if (!file) return PDYN_NO_MEMORY;
    *file = *from;
    strcpy(file->name, name);
    status = check(file);
    if (status != PDYN_OK) return FREE_ARRAY(context, file, 1), status;
    status = own(context, file);
    if (status != PDYN_OK) return free_file(context, file), status;
    drop(context, list, name);
    file->next = *list, *list = file;
    return PDYN_OK;
}

const struct array_file *array_file_find(const struct array_file *list, const char *name) {
    while (list && strcmp(list->name, name)) list = list->next;
    return list;
}

void array_file_free_all(pdyn_context *context, struct array_file **list) {
    for (struct array_file *next; *list; *list = next) {
        next = (*list)->next;
        free_file(context, *list);
    }
}

/* ---- copies ---------------------------------------------------------------------------------- */

static pdyn_status fail_kind(const struct array_file *file, const struct array_kind *expected) {
    return set_error(PDYN_BAD_INPUT, "%s: expected arrays of %s, found those of %s", file->name,
                     expected->call, file->kind->call);
}

static pdyn_status copy_points(pdyn_context *context, const struct array_file *file, int triangles,
                               struct mesh *mesh) {
    pdyn_status status = mesh_allocate(context, file->points, triangles, mesh);
    if (status == PDYN_OK)
        memcpy(mesh->vertex, file->x, 3 * (size_t)file->points * sizeof *file->x);
    return status;
}

pdyn_status array_file_mesh(pdyn_context *context, const struct array_file *file,
                            struct mesh *mesh) {
    *mesh = (struct mesh){0};
    if (file->kind != &array_surface) return fail_kind(file, &array_surface);
    pdyn_status status = copy_points(context, file, file->elements, mesh);
    if (status == PDYN_OK)
        memcpy(mesh->triangle, file->corner, corners(file) * sizeof *file->corner);
    return status;
}

pdyn_status array_file_tets(pdyn_context *context, const struct array_file *file, struct mesh *mesh,
                            struct tets *tets) {
    *mesh = (struct mesh){0}, *tets = (struct tets){0};
    if (file->kind != &array_volume) return fail_kind(file, &array_volume);
    pdyn_status status = copy_points(context, file, 0, mesh);
    if (status != PDYN_OK) return status;
    tets->corner = NEW_ARRAY(context, corners(file), int);
    if (!tets->corner) return mesh_free(context, mesh), PDYN_NO_MEMORY;
    memcpy(tets->corner, file->corner, corners(file) * sizeof *file->corner);
    tets->count = file->elements;
    return PDYN_OK;
}

pdyn_status array_file_particles(pdyn_context *context, const struct array_file *file,
                                 struct particles *particles) {
    *particles = (struct particles){0};
    if (file->kind == &array_volume) return fail_kind(file, &array_particles);
    size_t numbers = 3 * (size_t)file->points;
    particles->count = file->points;
    particles->x = NEW_ARRAY(context, numbers, double);
    if (file->v) particles->v = NEW_ARRAY(context, numbers, double);
    if (!particles->x || !particles->v != !file->v)
        return particles_free(context, particles), PDYN_NO_MEMORY;
    memcpy(particles->x, file->x, numbers * sizeof *file->x);
    if (file->v) memcpy(particles->v, file->v, numbers * sizeof *file->v);
    return PDYN_OK;
}
