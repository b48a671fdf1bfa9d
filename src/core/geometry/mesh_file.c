/* Reading mesh and particle files: formats by the ending of the name, growing arrays. */
#include "mesh_file.h"

#include "base/text.h"
#include "projdyn/vec3.h"

#include <math.h>
#include <string.h>

/* ---- appending ------------------------------------------------------------------------------- */

bool mesh_file_reserve(const struct mesh_file *file, struct mesh_array *array, size_t bytes) {
    if (bytes <= array->bytes) return true;
    size_t room = bytes > 2 * array->bytes ? bytes : 2 * array->bytes;
    void *moved = context_resize(file->in.context, array->data, array->bytes, room);
    if (!moved) return context_no_memory(file->in.context), false;
    *array = (struct mesh_array){moved, room};
    return true;
}

struct vector_kind {
    const char *name, *names, *unit;
    double max; /* largest coordinate */
};

static pdyn_status append_vector(struct mesh_file *file, const struct vector_kind *kind,
                                 struct mesh_array *array, int *count, const double x[3]) {
    size_t bytes = 3 * sizeof *x;
    for (int k = 0; k < 3; k++)
        if (!(fabs(x[k]) <= kind->max))
            return scan_fail(&file->in, "%s %d: expected a finite %c of at most %g %s, found %g",
                             kind->name, *count + file->first_index, "xyz"[k], kind -> max,
                             kind -> unit, x[k]);
    if (*count == MESH_MAX) return scan_fail(&file->in, "more than %d %s", MESH_MAX, kind->names);
    if (!mesh_file_reserve(file, array, ((size_t)*count + 1) * bytes)) return PDYN_NO_MEMORY;
    memcpy((double *)array->data + 3 * (*count)++, x, bytes);
    return PDYN_OK;
}

pdyn_status mesh_file_vertex(struct mesh_file *file, const double x[3]) {
    static const struct vector_kind kind = {"vertex", "vertices", "m", MESH_MAX_COORDINATE};
    return append_vector(file, &kind, &file->vertex, &file->vertices, x);
}

pdyn_status mesh_file_velocity(struct mesh_file *file, const double v[3]) {
    static const struct vector_kind kind = {"velocity", "velocities", "m/s", MESH_MAX_SPEED};
    return append_vector(file, &kind, &file->velocity, &file->velocities, v);
}

void mesh_file_begin_face(struct mesh_file *file) { file->faces++, file->corners = 0; }

static pdyn_status add_triangle(struct mesh_file *file, int a, int b, int c) {
    if (file->triangles == MESH_MAX)
        return scan_fail(&file->in, "more than %d triangles", MESH_MAX);
    size_t bytes = ((size_t)file->triangles + 1) * 3 * sizeof(int);
    if (!mesh_file_reserve(file, &file->triangle, bytes)) return PDYN_NO_MEMORY;
    int *triangle = (int *)file->triangle.data + 3 * file->triangles++;
    triangle[0] = a, triangle[1] = b, triangle[2] = c;
    return PDYN_OK;
}

pdyn_status mesh_file_corner(struct mesh_file *file, int index) {
    if (!mesh_file_reserve(file, &file->last_face, (size_t)file->vertices * sizeof(int)))
        return PDYN_NO_MEMORY;
    int *last = (int *)file->last_face.data + index;
    if (*last == file->faces)
        return scan_fail(&file->in, "the face uses vertex %d twice", index + file->first_index);
    *last = file->faces;
    pdyn_status status = PDYN_OK;
    if (file->corners >= 2) status = add_triangle(file, file->first, file->previous, index);
    if (!file->corners++) file->first = index;
    file->previous = index;
    return status;
}

/* Twice the area of a triangle, along its normal. */
static void area_of(const struct mesh_file *file, int triangle, double area[3]) {
    const double *x = (const double *)file->vertex.data;
    const int *corner = (const int *)file->triangle.data + 3 * (size_t)triangle;
    vec3_normal(area, x + 3 * (size_t)corner[0], x + 3 * (size_t)corner[1],
                x + 3 * (size_t)corner[2]);
}

/* Whether the fan of the current face folds over itself. */
static bool is_folded(const struct mesh_file *file) {
    int first = file->triangles - (file->corners - 2);
    double all[3] = {0}, one[3];
    for (int t = first; t < file->triangles; t++) area_of(file, t, one), vec3_add(all, 1.0, one);
    for (int t = first; t < file->triangles; t++) {
        area_of(file, t, one);
        if (vec3_dot(one, all) < -1e-6 * vec3_dot(all, all)) return true;
    }
    return false;
}

pdyn_status mesh_file_end_face(const struct mesh_file *file) {
    if (file->corners < 3)
        return scan_fail(&file->in, "expected a face of at least 3 vertices, found %d",
                         file->corners);
    if (file->corners > 3 && is_folded(file))
        return scan_fail(&file->in,
                         "the polygon of %d vertices is concave: expected convex polygons "
                         "or triangles, which every modelling program can make of it",
                         file->corners);
    return PDYN_OK;
}

/* ---- reading --------------------------------------------------------------------------------- */

static pdyn_status parse(struct mesh_file *file, pdyn_status (*format)(struct mesh_file *)) {
    struct text_locale locale;
    if (!text_begin(&locale)) return context_no_memory(file->in.context);
    pdyn_status status = format(file);
    text_end(&locale);
    return status;
}

static void release(const struct mesh_file *file, struct mesh_array *array) {
    context_resize(file->in.context, array->data, array->bytes, 0);
    *array = (struct mesh_array){0};
}

void *mesh_file_detach(const struct mesh_file *file, struct mesh_array *array, size_t bytes) {
    void *taken = context_resize(file->in.context, array->data, array->bytes, bytes);
    if (taken || !bytes) *array = (struct mesh_array){0};
    return taken;
}

struct format {
    const char *ending;
    pdyn_status (*parse)(struct mesh_file *file);
};

/* Reads a file in one of several formats, chosen by its ending. what: the kind of file and the
 * endings. The caller calls mesh_file_release, after a failure, too. */
static pdyn_status read_file(struct mesh_file *file, const struct format *format,
                             const char *what) {
    size_t length = strlen(file->in.path);
    const char *ending = length < 4 ? file->in.path : file->in.path + length - 4;
    while (format->ending && strcasecmp(ending, format->ending)) format++;
    if (!format->ending)
        return set_error(PDYN_BAD_INPUT, "%.1024s: expected a %s", file->in.path, what);
    pdyn_status status = scan_load(&file->in);
    return status == PDYN_OK ? parse(file, format->parse) : status;
}

void mesh_file_release(struct mesh_file *file) {
    release(file, &file->vertex);
    release(file, &file->triangle);
    release(file, &file->velocity);
    release(file, &file->last_face);
    scan_free(&file->in);
}

static pdyn_status detach_mesh(struct mesh_file *file, struct mesh *out) {
    if (!file->triangles)
        return set_error(PDYN_BAD_INPUT, "%.1024s: the mesh has no triangles", file->in.path);
    size_t vertices = (size_t)file->vertices, triangles = (size_t)file->triangles;
    out->vertices = file->vertices, out->triangles = file->triangles;
    out->vertex = mesh_file_detach(file, &file->vertex, 3 * vertices * sizeof(double));
    out->triangle = mesh_file_detach(file, &file->triangle, 3 * triangles * sizeof(int));
    if (out->vertex && out->triangle) return PDYN_OK;
    mesh_free(file->in.context, out);
    return context_no_memory(file->in.context);
}

pdyn_status mesh_read(pdyn_context *context, const char *path, struct mesh *out) {
    static const struct format formats[] = {
        {".obj", mesh_obj_parse}, {".ply", mesh_ply_parse}, {".stl", mesh_stl_parse}, {0}};
    struct mesh_file file = {.in = {.context = context, .path = path}};
    *out = (struct mesh){0};
    pdyn_status status = read_file(&file, formats, "mesh file ending with .obj, .ply or .stl");
    if (status == PDYN_OK) status = detach_mesh(&file, out);
    mesh_file_release(&file);
    return status;
}

static pdyn_status detach_particles(struct mesh_file *file, struct particles *out) {
    if (!file->vertices)
        return set_error(PDYN_BAD_INPUT, "%.1024s: the file has no particles", file->in.path);
    size_t bytes = 3 * (size_t)file->vertices * sizeof(double);
    bool moving = file->velocities;
    out->count = file->vertices;
    out->x = mesh_file_detach(file, &file->vertex, bytes);
    if (moving) out->v = mesh_file_detach(file, &file->velocity, bytes);
    if (out->x && (out->v || !moving)) return PDYN_OK;
    particles_free(file->in.context, out);
    return context_no_memory(file->in.context);
}

pdyn_status particles_read(pdyn_context *context, const char *path, struct particles *out) {
    static const struct format formats[] = {
        {".ply", mesh_ply_parse}, {".vtk", mesh_vtk_parse}, {0}};
    struct mesh_file file = {.in = {.context = context, .path = path}, .only_points = true};
    *out = (struct particles){0};
    pdyn_status status = read_file(&file, formats, "file of particles ending with .ply or .vtk");
    if (status == PDYN_OK) status = detach_particles(&file, out);
    mesh_file_release(&file);
    return status;
}
