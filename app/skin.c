#include "skin.h"

#include "app.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Vectors of the points of the skin from those of the body; NULL: no memory. */
static float *carry(const struct vtk_frame *skin, const float *of_body) {
    float *out = malloc(3 * (size_t)skin->count * sizeof *out);
    for (size_t i = 0; out && i < (size_t)skin->count; i++) {
        const int *vertex = skin->vertex + 4 * i;
        const float *weight = skin->weight + 4 * i, *first = of_body + 3 * (size_t)vertex[0];
        for (size_t a = 0; a < 3; a++) {
            double sum = first[a];
            for (int k = 1; k < 4; k++)
                sum += weight[k] * ((double)of_body[3 * (size_t)vertex[k] + a] - first[a]);
            out[3 * i + a] = (float)sum;
        }
    }
    return out;
}

static int *copy_triangles(const struct vtk_frame *skin) {
    size_t size = 3 * (size_t)skin->triangles * sizeof *skin->triangle;
    int *out = malloc(size);
    return out ? memcpy(out, skin->triangle, size) : NULL;
}

static bool fits(const struct vtk_frame *skin, const struct vtk_frame *frame) {
    bool good = frame->velocity && frame->triangles && skin->triangles;
    for (size_t k = 0; k < 4 * (size_t)skin->count; k++) good &= skin->vertex[k] < frame->count;
    return good;
}

int skin_carry(const struct vtk_frame *skin, const char *path, struct vtk_frame *frame) {
    if (!fits(skin, frame)) {
        fprintf(stderr, "projdyn: %s: expected the body of its .skin.vtk, found %d vertices\n",
                path, frame->count);
        return EXIT_BAD_INPUT;
    }
    struct vtk_frame carried = {.count = skin->count,
                                .triangles = skin->triangles,
                                .x = carry(skin, frame->x),
                                .velocity = carry(skin, frame->velocity),
                                .triangle = copy_triangles(skin)};
    vtk_frame_free(frame);
    *frame = carried;
    if (carried.x && carried.velocity && carried.triangle) return EXIT_GOOD;
    vtk_frame_free(frame);
    return report_no_memory();
}
