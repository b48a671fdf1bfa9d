/* Reads what stands around the water: surfaces of bodies, and solids. */
#include "mesh_input.h"

static int add_part(const struct run *run, const struct part *part, int f, struct obstacles *out) {
    struct vtk_frame frame;
    char path[RUN_PATH];
    int code = part_read_frame(run, part, f, path, &frame);
    if (code != EXIT_GOOD) return code;
    if (frame.triangles) code = obstacles_add(out, &frame);
    vtk_frame_free(&frame);
    return code;
}

/* Particles have no triangles, boundary points stand for solids. */
static bool is_obstacle(const struct part *part) {
    return part->kind == SOLID || (part->kind == BODY && !(part->radius > 0.0));
}

int mesh_read_obstacles(const struct run *run, int f, struct obstacles *out) {
    int code = EXIT_GOOD;
    *out = (struct obstacles){0};
    for (int p = 0; p < run->parts && code == EXIT_GOOD; p++)
        if (is_obstacle(&run->part[p])) code = add_part(run, &run->part[p], f, out);
    return code == EXIT_GOOD ? obstacles_build(out) : code;
}
