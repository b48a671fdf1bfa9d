/* Writers of surfaces: legacy VTK 4.2, PLY and OBJ. */
#include "surface_file.h"

#include "app.h"
#include "new_file.h"

#include <stdint.h>
#include <string.h>

static void put_word(FILE *file, uint32_t word, bool big) {
    unsigned char byte[4];
    for (int k = 0; k < 4; k++) byte[big ? 3 - k : k] = (unsigned char)(word >> 8 * k);
    fwrite(byte, 1, 4, file);
}

static void put_floats(FILE *file, const float *value, size_t count, bool big) {
    for (size_t k = 0; k < count; k++) {
        uint32_t word;
        memcpy(&word, value + k, sizeof word);
        put_word(file, word, big);
    }
}

static void put_corners(FILE *file, const int *corner, bool big) {
    for (int c = 0; c < 3; c++) put_word(file, (uint32_t)corner[c], big);
}

static void write_vtk(FILE *file, const struct surface *s, const char *title) {
    size_t numbers = 3 * (size_t)s->vertices;
    fprintf(file,
            "# vtk DataFile Version 4.2\nprojdyn %.200s\nBINARY\nDATASET UNSTRUCTURED_GRID\n"
            "POINTS %d float\n",
            title, s->vertices);
    put_floats(file, s->x, numbers, true);
    fprintf(file, "\nCELLS %d %zu\n", s->triangles, 4 * (size_t)s->triangles);
    for (int t = 0; t < s->triangles; t++) {
        put_word(file, 3, true);
        put_corners(file, s->triangle + 3 * (size_t)t, true);
    }
    fprintf(file, "\nCELL_TYPES %d\n", s->triangles);
    for (int t = 0; t < s->triangles; t++) put_word(file, 5, true);
    fprintf(file, "\nPOINT_DATA %d\nVECTORS velocity float\n", s->vertices);
    put_floats(file, s->velocity, numbers, true);
    fputs("\nVECTORS normal float\n", file);
    put_floats(file, s->normal, numbers, true);
    fputc('\n', file);
}

static void write_ply(FILE *file, const struct surface *s, const char *title) {
    fprintf(file,
            "ply\nformat binary_little_endian 1.0\ncomment projdyn %s\nelement vertex %d\n"
            "property float x\nproperty float y\nproperty float z\n"
            "property float nx\nproperty float ny\nproperty float nz\n"
            "property float vx\nproperty float vy\nproperty float vz\n"
            "element face %d\nproperty list uchar int vertex_indices\nend_header\n",
            title, s->vertices, s->triangles);
    for (size_t v = 0; v < 3 * (size_t)s->vertices; v += 3) {
        put_floats(file, s->x + v, 3, false);
        put_floats(file, s->normal + v, 3, false);
        put_floats(file, s->velocity + v, 3, false);
    }
    for (int t = 0; t < s->triangles; t++) {
        fputc(3, file);
        put_corners(file, s->triangle + 3 * (size_t)t, false);
    }
}

static void write_obj(FILE *file, const struct surface *s, const char *title) {
    fprintf(file, "# projdyn %s\n", title);
    for (size_t v = 0; v < 3 * (size_t)s->vertices; v += 3)
        fprintf(file, "v %.9g %.9g %.9g\n", (double)s->x[v], (double)s->x[v + 1],
                (double)s->x[v + 2]);
    for (size_t v = 0; v < 3 * (size_t)s->vertices; v += 3)
        fprintf(file, "vn %.6g %.6g %.6g\n", (double)s->normal[v], (double)s->normal[v + 1],
                (double)s->normal[v + 2]);
    for (int t = 0; t < s->triangles; t++) {
        const int *c = s->triangle + 3 * (size_t)t;
        fprintf(file, "f %d//%d %d//%d %d//%d\n", c[0] + 1, c[0] + 1, c[1] + 1, c[1] + 1, c[2] + 1,
                c[2] + 1);
    }
}

const struct surface_format surface_formats[] = {
    {"vtk", write_vtk}, {"ply", write_ply}, {"obj", write_obj}, {NULL, NULL}};

int surface_write(const struct surface *surface, const struct surface_format *format,
                  const char *path, const char *title) {
    char *temporary;
    FILE *file = new_file_open(path, &temporary);
    if (!file) return report_write_error(path);
    format->write(file, surface, title);
    return new_file_close(file, temporary, path, true) ? EXIT_GOOD : report_write_error(path);
}
