/* Files that a scene names: arrays that stand for them, paths relative to the scene, meshes and
 * particles. */
#include "file_ref.h"

#include "array_file.h"

#include <string.h>

pdyn_status file_ref_path(const struct json_at *at, const char *what, char **path) {
    const struct json_file *scene = at->file;
    const char *name = json_string_value(at->value);
    if (!name) return json_expected(at, what);
    const char *slash = scene->on_disk ? strrchr(scene->name, '/') : NULL;
    size_t folder = slash && *name != '/' ? (size_t)(slash - scene->name) + 1 : 0;
    *path = NEW_ARRAY(scene->context, folder + strlen(name) + 1, char);
    if (!*path) return PDYN_NO_MEMORY;
    memcpy(*path, scene->name, folder);
    strcpy(*path + folder, name);
    return scene->sources ? sources_add(scene->context, scene->sources, *path) : PDYN_OK;
}

/* The arrays that stand for the file whose name is the value at `at`; NULL: none. */
static const struct array_file *find_arrays(const struct json_at *at) {
    const char *name = json_string_value(at->value);
    return name ? array_file_find(at->file->arrays, name) : NULL;
}

static bool is_obj(const char *path) {
    size_t length = strlen(path);
    return length > 4 && !strcasecmp(path + length - 4, ".obj");
}

pdyn_status file_ref_mesh(const struct json_at *at, struct mesh *mesh, char **obj) {
    const struct array_file *arrays = find_arrays(at);
    if (arrays) return json_wrap(at, array_file_mesh(at->file->context, arrays, mesh));
    char *path = NULL;
    pdyn_status status = file_ref_path(at, "the name of a mesh file, .obj, .ply or .stl", &path);
    if (status == PDYN_OK) status = json_wrap(at, mesh_read(at->file->context, path, mesh));
    if (status == PDYN_OK && obj && is_obj(path)) *obj = path;
    else context_free_text(at->file->context, path);
    return status;
}

pdyn_status file_ref_tets(const struct json_at *at, struct mesh *mesh, struct tets *tets) {
    const struct array_file *arrays = find_arrays(at);
    if (arrays) return json_wrap(at, array_file_tets(at->file->context, arrays, mesh, tets));
    char *path = NULL;
    pdyn_status status =
        file_ref_path(at, "the name of a mesh of tetrahedra, .node, .ele or .msh", &path);
    if (status == PDYN_OK) status = json_wrap(at, tets_read(at->file->context, path, mesh, tets));
    context_free_text(at->file->context, path);
    return status;
}

pdyn_status file_ref_particles(const struct json_at *at, struct particles *particles) {
    const struct array_file *arrays = find_arrays(at);
    if (arrays) return json_wrap(at, array_file_particles(at->file->context, arrays, particles));
    char *path = NULL;
    pdyn_status status = file_ref_path(at, "the name of a file of particles, .ply or .vtk", &path);
    if (status == PDYN_OK)
        status = json_wrap(at, particles_read(at->file->context, path, particles));
    context_free_text(at->file->context, path);
    return status;
}
