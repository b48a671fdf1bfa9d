/* Legacy VTK files, version 4.2, binary (big endian): unstructured grids of points and cells. */
#include "base/file_out.h"
#include "geometry/embedding.h"
#include "output.h"
#include "sim/live_particles.h"

enum { VERTEX_CELL = 1, TRIANGLE_CELL = 5 };

static const enum byte_order order = BIG_ENDIAN_BYTES;

/* Writes the header. The format limits the title to 256 bytes. */
static void write_head(struct file_out *file, const char *title, double time, int points) {
    file_out_print(file,
                   "# vtk DataFile Version 4.2\nprojdyn %.200s t=%.9g s\nBINARY\n"
                   "DATASET UNSTRUCTURED_GRID\nPOINTS %d float\n",
                   title, time, points);
}

/* Writes a body's part of a vector of the system, `width` numbers per live particle. */
static void write_values(struct file_out *file, const pdyn_sim *sim, const pdyn_body_info *info,
                         const double *value, int width) {
    if (info->live == info->count)
        file_out_reals(file, order, value + width * info->first,
                       (size_t)width * (size_t)info->count);
    else
        for (int i = info->first; i < info->first + info->count; i++)
            if (particle_is_live(sim, i))
                file_out_reals(file, order, value + width * i, (size_t)width);
}

static void write_types(struct file_out *file, int type, int count) {
    file_out_print(file, "\nCELL_TYPES %d\n", count);
    for (int i = 0; i < count; i++) file_out_ints(file, order, &type, 1);
}

static void write_vertices(struct file_out *file, int count) {
    file_out_print(file, "\nCELLS %d %zu\n", count, 2 * (size_t)count);
    for (int i = 0; i < count; i++) file_out_ints(file, order, (const int[]){1, i}, 2);
    write_types(file, VERTEX_CELL, count);
}

static void write_triangles(struct file_out *file, const int *triangle, int count) {
    file_out_print(file, "\nCELLS %d %zu\n", count, 4 * (size_t)count);
    for (int t = 0; t < count; t++) {
        const int *corner = triangle + 3 * t;
        file_out_ints(file, order, (const int[]){3, corner[0], corner[1], corner[2]}, 4);
    }
    write_types(file, TRIANGLE_CELL, count);
}

static void write_scalars(struct file_out *file, const pdyn_sim *sim, const pdyn_body_info *info,
                          const char *name, const double *value) {
    file_out_print(file, "SCALARS %s float 1\nLOOKUP_TABLE default\n", name);
    write_values(file, sim, info, value, 1);
    file_out_print(file, "\n");
}

pdyn_status vtk_write_body(const pdyn_sim *sim, int body, const char *path) {
    struct file_out file;
    pdyn_status status = file_out_open(sim->context, path, &file);
    if (status != PDYN_OK) return status;
    pdyn_state state = pdyn_get_state(sim);
    pdyn_body_info info = pdyn_get_body(sim, body);
    write_head(&file, info.name, pdyn_time(sim), info.live);
    write_values(&file, sim, &info, state.x, 3);
    if (info.triangles) write_triangles(&file, info.triangle, info.triangles);
    else write_vertices(&file, info.live);
    file_out_print(&file, "\nPOINT_DATA %d\n", info.live);
    if (!info.triangles) {
        write_scalars(&file, sim, &info, "density", state.density);
        write_scalars(&file, sim, &info, "pressure", state.pressure);
    }
    file_out_print(&file, "VECTORS velocity float\n");
    write_values(&file, sim, &info, state.v, 3);
    file_out_print(&file, "\n");
    return file_out_close(&file);
}

/* Binds the skin of a body to its tetrahedra, that of a rigid body to four of its vertices. */
static pdyn_status bind_skin(const pdyn_sim *sim, int body, struct embedding *out) {
    const struct scene_body *b = &sim->scene.body[body];
    pdyn_body_info info = pdyn_get_body(sim, body);
    int corner[4];
    struct tets span = {.count = 1, .corner = corner};
    if (b->is_rigid) embedding_span(info.rest, info.count, corner);
    return embedding_create(sim->context, info.rest, b->is_rigid ? &span : &b->tets, &b->skin, out);
}

static void write_binding(struct file_out *file, const struct embedding *e) {
    size_t numbers = 4 * (size_t)e->count;
    file_out_print(file, "\nPOINT_DATA %d\nFIELD binding 2\nvertex 4 %d int\n", e->count, e->count);
    file_out_ints(file, order, e->corner, numbers);
    file_out_print(file, "\nweight 4 %d float\n", e->count);
    file_out_reals(file, order, e->weight, numbers);
    file_out_print(file, "\n");
}

pdyn_status vtk_write_skin(const pdyn_sim *sim, int body, const char *path) {
    const struct mesh *skin = &sim->scene.body[body].skin;
    struct file_out file;
    struct embedding binding;
    pdyn_status status = bind_skin(sim, body, &binding);
    if (status != PDYN_OK) return status;
    status = file_out_open(sim->context, path, &file);
    if (status == PDYN_OK) {
        write_head(&file, sim->body[body].name, 0.0, skin->vertices);
        file_out_reals(&file, order, skin->vertex, 3 * (size_t)skin->vertices);
        write_triangles(&file, skin->triangle, skin->triangles);
        write_binding(&file, &binding);
        status = file_out_close(&file);
    }
    embedding_free(sim->context, &binding);
    return status;
}

pdyn_status vtk_write_boundary(const pdyn_sim *sim, bool moving, const char *path) {
    struct file_out file;
    pdyn_status status = file_out_open(sim->context, path, &file);
    if (status != PDYN_OK) return status;
    pdyn_state state = pdyn_get_state(sim);
    int resting = state.boundary - state.moving, count = moving ? state.moving : resting;
    const double *x = state.boundary_x + (moving ? 3 * (size_t)resting : 0);
    write_head(&file, "boundary", pdyn_time(sim), count);
    file_out_reals(&file, order, x, 3 * (size_t)count);
    write_vertices(&file, count);
    file_out_print(&file, "\n");
    return file_out_close(&file);
}

static pdyn_status write_solid(const pdyn_sim *sim, const struct scene_solid *solid,
                               const double *vertex, const char *path) {
    struct file_out file;
    pdyn_status status = file_out_open(sim->context, path, &file);
    if (status != PDYN_OK) return status;
    write_head(&file, solid->name, pdyn_time(sim), solid->mesh.vertices);
    file_out_reals(&file, order, vertex, 3 * (size_t)solid->mesh.vertices);
    write_triangles(&file, solid->mesh.triangle, solid->mesh.triangles);
    file_out_print(&file, "\n");
    return file_out_close(&file);
}

pdyn_status vtk_write_solid(const pdyn_sim *sim, int k, const char *path) {
    const struct scene_solid *solid = &sim->scene.solid[k];
    size_t n = 3 * (size_t)solid->mesh.vertices;
    if (!solid->motion.keys) return write_solid(sim, solid, solid->mesh.vertex, path);
    double *x = NEW_ARRAY(sim->context, n, double);
    if (!x) return PDYN_NO_MEMORY;
    pdyn_solid_vertices(sim, k, x);
    pdyn_status status = write_solid(sim, solid, x, path);
    FREE_ARRAY(sim->context, x, n);
    return status;
}
