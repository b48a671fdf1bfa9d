/* PLY files, binary little endian: positions, velocities (vx, vy, vz), density and pressure of
 * particles, faces of surfaces. */
#include "base/file_out.h"
#include "output.h"
#include "sim/live_particles.h"

static const enum byte_order order = LITTLE_ENDIAN_BYTES;

static void write_header(struct file_out *file, const pdyn_body_info *info, double time) {
    static const char *const properties[] = {"x",  "y",  "z",       "vx",
                                             "vy", "vz", "density", "pressure"};
    file_out_print(file,
                   "ply\nformat binary_little_endian 1.0\ncomment projdyn %s t=%.9g s\n"
                   "element vertex %d\n",
                   info->name, time, info->live);
    for (int k = 0; k < (info->triangles ? 6 : 8); k++)
        file_out_print(file, "property float %s\n", properties[k]);
    if (info->triangles)
        file_out_print(file, "element face %d\nproperty list uchar int vertex_indices\n",
                       info->triangles);
    file_out_print(file, "end_header\n");
}

pdyn_status ply_write_body(const pdyn_sim *sim, int body, const char *path) {
    struct file_out file;
    pdyn_status status = file_out_open(sim->context, path, &file);
    if (status != PDYN_OK) return status;
    pdyn_state state = pdyn_get_state(sim);
    pdyn_body_info info = pdyn_get_body(sim, body);
    write_header(&file, &info, pdyn_time(sim));
    for (int i = info.first; i < info.first + info.count; i++) {
        if (!particle_is_live(sim, i)) continue;
        file_out_reals(&file, order, state.x + 3 * i, 3);
        file_out_reals(&file, order, state.v + 3 * i, 3);
        if (info.triangles) continue;
        file_out_reals(&file, order, state.density + i, 1);
        file_out_reals(&file, order, state.pressure + i, 1);
    }
    for (int t = 0; t < info.triangles; t++) {
        file_out_bytes(&file, &(const unsigned char){3}, 1);
        file_out_ints(&file, order, info.triangle + 3 * t, 3);
    }
    return file_out_close(&file);
}
