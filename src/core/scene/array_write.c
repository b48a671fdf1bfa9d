/* Writes arrays that stand for files: binary PLY with doubles, Gmsh 2.2 with 17 digits. Numbers are
 * read back to the same bits. */
#include "array_file.h"

#include "base/file_out.h"

#include <string.h>

static void write_ply_header(struct file_out *out, const struct array_file *file) {
    static const char *const properties[] = {"x", "y", "z", "vx", "vy", "vz"};
    file_out_print(out, "ply\nformat binary_little_endian 1.0\nelement vertex %d\n", file->points);
    for (int k = 0; k < (file->v ? 6 : 3); k++)
        file_out_print(out, "property double %s\n", properties[k]);
    if (file->elements)
        file_out_print(out, "element face %d\nproperty list uchar int vertex_indices\n",
                       file->elements);
    file_out_print(out, "end_header\n");
}

static void write_ply(struct file_out *out, const struct array_file *file) {
    write_ply_header(out, file);
    for (size_t i = 0; i < (size_t)file->points; i++) {
        file_out_doubles(out, file->x + 3 * i, 3);
        if (file->v) file_out_doubles(out, file->v + 3 * i, 3);
    }
    for (size_t t = 0; t < (size_t)file->elements; t++) {
        file_out_bytes(out, &(const unsigned char){3}, 1);
        file_out_ints(out, LITTLE_ENDIAN_BYTES, file->corner + 3 * t, 3);
    }
}

/* Element type 4 is a tetrahedron; its 2 tags are the numbers of a physical and of a geometric
 * entity. */
static void write_msh(struct file_out *out, const struct array_file *file) {
    file_out_print(out, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%d\n", file->points);
    for (int i = 0; i < file->points; i++) {
        const double *x = file->x + 3 * (size_t)i;
        file_out_print(out, "%d %.17g %.17g %.17g\n", i + 1, x[0], x[1], x[2]);
    }
    file_out_print(out, "$EndNodes\n$Elements\n%d\n", file->elements);
    for (int e = 0; e < file->elements; e++) {
        const int *c = file->corner + 4 * (size_t)e;
        file_out_print(out, "%d 4 2 1 1 %d %d %d %d\n", e + 1, c[0] + 1, c[1] + 1, c[2] + 1,
                       c[3] + 1);
    }
    file_out_print(out, "$EndElements\n");
}

const struct array_kind array_surface = {".ply", "pdyn_scene_mesh", "vertex", "triangle",
                                         3,      write_ply};
const struct array_kind array_volume = {".msh", "pdyn_scene_tets", "vertex", "tetrahedron",
                                        4,      write_msh};
const struct array_kind array_particles = {".ply",   "pdyn_scene_particles", "particle", "", 0,
                                           write_ply};

static pdyn_status write_path(pdyn_context *context, const struct array_file *file,
                              const char *path) {
    struct file_out out;
    pdyn_status status = file_out_open(context, path, &out);
    if (status != PDYN_OK) return status;
    file->kind->write(&out, file);
    return file_out_close(&out);
}

pdyn_status array_file_write(pdyn_context *context, const struct array_file *file,
                             const char *scene) {
    const char *slash = strrchr(scene, '/');
    size_t folder = slash ? (size_t)(slash - scene) + 1 : 0, size = folder + sizeof file->name;
    char *path = NEW_ARRAY(context, size, char);
    if (!path) return PDYN_NO_MEMORY;
    memcpy(path, scene, folder);
    strcpy(path + folder, file->name);
    pdyn_status status = write_path(context, file, path);
    FREE_ARRAY(context, path, size);
    return status;
}
