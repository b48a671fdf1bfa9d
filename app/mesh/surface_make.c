/* The surface of a fluid in a frame: reads the particles and what stands around them; and the skin
 * of a body. */
#include "surface_make.h"

#include <stdlib.h>

/* Passes of smoothing: before vertices move to obstacles, and after. */
enum { PASSES = 80, PASSES_AFTER = 10 };

/* ---- obstacles ------------------------------------------------------------------------------- */

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

/* Reads the triangles of all surface bodies and solids and builds their tree. The caller frees
 * *out in any case. */
static int read_obstacles(const struct run *run, int f, struct obstacles *out) {
    int code = EXIT_GOOD;
    *out = (struct obstacles){0};
    for (int p = 0; p < run->parts && code == EXIT_GOOD; p++)
        if (is_obstacle(&run->part[p])) code = add_part(run, &run->part[p], f, out);
    return code == EXIT_GOOD ? obstacles_build(out) : code;
}

/* ---- skins ----------------------------------------------------------------------------------- */

int surface_carry(const struct run *run, const struct part *part, int f, int threads,
                  struct surface *out) {
    char path[RUN_PATH];
    struct vtk_frame frame;
    *out = (struct surface){0};
    int code = part_read_frame(run, part, f, path, &frame);
    if (code != EXIT_GOOD) return code;
    *out = (struct surface){.vertices = frame.count,
                            .triangles = frame.triangles,
                            .x = frame.x,
                            .velocity = frame.velocity,
                            .triangle = frame.triangle,
                            .mobility = malloc((size_t)frame.count * sizeof(float))};
    if (!out->mobility) return report_no_memory();
    for (int v = 0; v < frame.count; v++) out->mobility[v] = 1.0f; /* normals by triangles alone */
    return surface_make_normals(out, NULL, threads);
}

/* ---- surfaces -------------------------------------------------------------------------------- */

/* Makes the surface of the particles in a file. */
static int surround(const struct vtk_frame *frame, const char *path, double radius, bool drops,
                    const struct obstacles *obstacles, int threads, struct surface *surface) {
    struct colour_field field;
    double reach = 0.5 * radius, gap = SURFACE_GAP * radius;
    double rounding = 1.7 * radius; /* distance from a wall of a rounded edge of moving water */
    int code = colour_field_build(frame, path, radius, threads, &field);
    if (code == EXIT_GOOD) code = surface_extract(&field, threads, surface);
    if (code == EXIT_GOOD && drops) code = surface_add_drops(surface, &field);
    if (code == EXIT_GOOD) code = surface_sample(surface, &field, threads);
    if (code == EXIT_GOOD) code = surface_smooth(surface, NULL, surface->mobility, PASSES, threads);
    if (code == EXIT_GOOD) surface_attach(surface, &field, obstacles, reach, threads);
    if (code == EXIT_GOOD)
        code = surface_smooth(surface, NULL, surface->mobility, PASSES_AFTER, threads);
    if (code == EXIT_GOOD) surface_attach(surface, &field, obstacles, reach, threads);
    if (code == EXIT_GOOD) code = surface_make_normals(surface, &field, threads);
    if (code == EXIT_GOOD) code = surface_sharpen(surface, obstacles, rounding, gap, threads);
    if (code == EXIT_GOOD) surface_attach(surface, &field, obstacles, 0.0, threads);
    if (code == EXIT_GOOD) code = surface_make_normals(surface, &field, threads);
    colour_field_free(&field);
    surface->particles = frame->count;
    return code;
}

int surface_make(const struct run *run, const struct part *part, int f, bool drops, int threads,
                 struct surface *out) {
    char path[RUN_PATH];
    struct vtk_frame frame;
    struct obstacles obstacles = {0};
    *out = (struct surface){0};
    if (!(part->radius > 0.0))
        return run_error("%s/%s: radius_m of body \"%s\": expected a number above 0",
                         run->directory, run->source, part->name);
    int code = part_read_frame(run, part, f, path, &frame);
    if (code != EXIT_GOOD) return code;
    if (frame.triangles || !frame.velocity)
        code = run_error("%s: expected particles with velocities", path);
    else code = read_obstacles(run, f, &obstacles);
    if (code == EXIT_GOOD)
        code = surround(&frame, path, part->radius, drops, &obstacles, threads, out);
    obstacles_free(&obstacles);
    vtk_frame_free(&frame);
    return code;
}
