/* Reader for the VTK files of a run; the layout is that of the library's VTK writer:
 *
 *     # vtk DataFile Version 4.2 / title / BINARY / DATASET UNSTRUCTURED_GRID
 *     POINTS, CELLS, CELL_TYPES; then, except for boundary points, POINT_DATA with density and
 *     pressure (particles only), velocity, and normals (surfaces of fluids) */
#include "vtk_frame.h"
#include "app.h"
#include "read_file.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINE = 300, VERTEX_CELL = 1, TRIANGLE_CELL = 5 }; /* cell types of VTK */

/* Position in a file that is in memory. */
struct reader {
    const char *path;
    const char *bytes;
    size_t size, at; /* bytes; at: offset of the next byte to read */
};

static int no_memory(const char *path, size_t size) {
    fprintf(stderr, "projdyn: %s: out of memory (%zu bytes)\n", path, size);
    return EXIT_FAILED;
}

/* ---- lines and blocks of numbers ------------------------------------------------------------- */

static int fail_at(const struct reader *r, size_t at, const char *format, ...) PDYN_PRINTF(3, 4);
static int fail_at(const struct reader *r, size_t at, const char *format, ...) {
    va_list args;
    fprintf(stderr, "projdyn: %s: byte %zu: ", r->path, at);
    va_start(args, format);
    vfprintf(stderr, format, args);
    va_end(args);
    fputc('\n', stderr);
    return EXIT_BAD_INPUT;
}

/* Replaces all bytes that are not printable ASCII by '?', so that a message never sends control
 * sequences from a file to the terminal. */
static void make_printable(char *text) {
    for (; *text; text++)
        if (*text < ' ' || *text > '~') *text = '?';
}

/* Reads a text line up to its newline; `expected` is the description for the error message. */
static int read_line(struct reader *r, char line[LINE], const char *expected) {
    const char *begin = r->bytes + r->at;
    size_t left = r->size - r->at;
    if (!left) return fail_at(r, r->at, "expected \"%s\", found the end of the file", expected);
    const char *end = memchr(begin, '\n', left < LINE ? left : LINE);
    size_t length = end ? (size_t)(end - begin) : left < 40 ? left : 40;
    memcpy(line, begin, length);
    line[length] = '\0';
    make_printable(line);
    if (!end) return fail_at(r, r->at, "expected the line \"%s\", found \"%s\"", expected, line);
    r->at += length + 1;
    return EXIT_GOOD;
}

static int expect_line(struct reader *r, const char *expected) {
    char line[LINE];
    size_t at = r->at;
    int code = read_line(r, line, expected);
    if (code == EXIT_GOOD && strcmp(line, expected))
        code = fail_at(r, at, "expected the line \"%s\", found \"%.80s\"", expected, line);
    return code;
}

/* Reads the line "POINTS N float", 0 <= N <= 99999999, in the spelling of printf. */
static int read_count(struct reader *r, int *count) {
    static const char expected[] = "POINTS N float";
    char line[LINE], printed[LINE];
    size_t at = r->at;
    int code = read_line(r, line, expected), number = -1;
    if (code != EXIT_GOOD) return code;
    bool good = sscanf(line, "POINTS %8d", &number) == 1 && number >= 0;
    snprintf(printed, sizeof printed, "POINTS %d float", number);
    if (!good || strcmp(line, printed))
        return fail_at(r, at, "expected the line \"%s\" with a number N, found \"%.80s\"", expected,
                       line);
    *count = number;
    return EXIT_GOOD;
}

/* Checks that `count` four-byte words follow. */
static int need_words(const struct reader *r, size_t count, const char *what) {
    size_t left = (r->size - r->at) / 4;
    if (left >= count) return EXIT_GOOD;
    return fail_at(r, r->at, "truncated: expected %zu numbers of %s, found %zu", count, what, left);
}

static uint32_t next_word(struct reader *r) {
    const unsigned char *b = (const unsigned char *)r->bytes + r->at;
    r->at += 4;
    return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

/* Reads the newline that ends each binary block. */
static int end_block(struct reader *r) {
    if (r->at < r->size && r->bytes[r->at] == '\n') {
        r->at++;
        return EXIT_GOOD;
    }
    return fail_at(r, r->at, "expected a newline after the block of numbers");
}

/* Reads a block of finite numbers. what: its name for messages. The caller frees *out. */
static int read_floats(struct reader *r, size_t count, const char *what, float **out) {
    int code = need_words(r, count, what);
    if (code != EXIT_GOOD) return code;
    float *values = malloc((count + 1) * sizeof *values); /* + 1: count may be 0 */
    if (!values) return no_memory(r->path, count * sizeof *values);
    *out = values;
    for (size_t i = 0; i < count; i++) {
        uint32_t word = next_word(r);
        memcpy(values + i, &word, sizeof word);
        if (!isfinite(values[i]))
            return fail_at(r, r->at - 4, "expected a finite number of %s, found %g", what,
                           (double)values[i]);
    }
    return end_block(r);
}

/* ---- cells ----------------------------------------------------------------------------------- */

/* Reads CELL_TYPES, where all cells must have the same type. */
static int read_cell_types(struct reader *r, int cells, uint32_t type) {
    char line[LINE];
    snprintf(line, sizeof line, "CELL_TYPES %d", cells);
    int code = expect_line(r, line);
    if (code == EXIT_GOOD) code = need_words(r, (size_t)cells, "cell types");
    if (code != EXIT_GOOD) return code;
    for (int i = 0; i < cells; i++) {
        uint32_t found = next_word(r);
        if (found != type)
            return fail_at(r, r->at - 4, "expected the cell type %u, found %u", type, found);
    }
    return end_block(r);
}

/* Reads vertex cells; cell i must consist of point i. */
static int read_vertices(struct reader *r, int count) {
    int code = need_words(r, 2 * (size_t)count, "cells");
    if (code != EXIT_GOOD) return code;
    for (int i = 0; i < count; i++) {
        uint32_t points = next_word(r), point = next_word(r);
        if (points != 1 || point != (uint32_t)i)
            return fail_at(r, r->at - 8, "expected the vertex cell 1 %d, found %u %u", i, points,
                           point);
    }
    return end_block(r);
}

static int read_triangles(struct reader *r, int cells, struct vtk_frame *frame) {
    int code = need_words(r, 4 * (size_t)cells, "cells");
    if (code != EXIT_GOOD) return code;
    frame->triangle = malloc(3 * (size_t)cells * sizeof *frame->triangle);
    if (!frame->triangle) return no_memory(r->path, 3 * (size_t)cells * sizeof(int));
    frame->triangles = cells;
    for (int t = 0; t < cells; t++) {
        uint32_t points = next_word(r);
        if (points != 3) return fail_at(r, r->at - 4, "expected 3 corners, found %u", points);
        for (int k = 0; k < 3; k++) {
            uint32_t corner = next_word(r);
            if (corner >= (uint32_t)frame->count)
                return fail_at(r, r->at - 4, "expected a corner below %d, found %u", frame->count,
                               corner);
            frame->triangle[3 * t + k] = (int)corner;
        }
    }
    return end_block(r);
}

/* Reads CELLS and CELL_TYPES: one vertex cell per point, two words each; or triangles, four
 * words each. */
static int read_cells(struct reader *r, struct vtk_frame *frame) {
    char line[LINE], vertices[LINE], triangles[LINE];
    size_t at = r->at;
    int cells = 0;
    int code = read_line(r, line, "CELLS C K");
    if (code != EXIT_GOOD) return code;
    snprintf(vertices, sizeof vertices, "CELLS %d %zu", frame->count, 2 * (size_t)frame->count);
    if (!strcmp(line, vertices)) {
        code = read_vertices(r, frame->count);
        return code == EXIT_GOOD ? read_cell_types(r, frame->count, VERTEX_CELL) : code;
    }
    bool good = sscanf(line, "CELLS %8d", &cells) == 1 && cells > 0;
    snprintf(triangles, sizeof triangles, "CELLS %d %zu", cells, 4 * (size_t)cells);
    if (!good || strcmp(line, triangles))
        return fail_at(r, at, "expected \"%s\" or \"CELLS C 4C\" of triangles, found \"%.80s\"",
                       vertices, line);
    code = read_triangles(r, cells, frame);
    return code == EXIT_GOOD ? read_cell_types(r, cells, TRIANGLE_CELL) : code;
}

/* ---- the file -------------------------------------------------------------------------------- */

static int read_points(struct reader *r, struct vtk_frame *frame) {
    char title[LINE];
    int code = expect_line(r, "# vtk DataFile Version 4.2");
    if (code == EXIT_GOOD) code = read_line(r, title, "a title");
    if (code == EXIT_GOOD) code = expect_line(r, "BINARY");
    if (code == EXIT_GOOD) code = expect_line(r, "DATASET UNSTRUCTURED_GRID");
    if (code == EXIT_GOOD) code = read_count(r, &frame->count);
    if (code == EXIT_GOOD) code = read_floats(r, 3 * (size_t)frame->count, "POINTS", &frame->x);
    return code;
}

static int read_scalars(struct reader *r, const char *name, int count, float **out) {
    char line[LINE];
    snprintf(line, sizeof line, "SCALARS %s float 1", name);
    int code = expect_line(r, line);
    if (code == EXIT_GOOD) code = expect_line(r, "LOOKUP_TABLE default");
    return code == EXIT_GOOD ? read_floats(r, (size_t)count, name, out) : code;
}

/* Whether the next line is this one. */
static bool is_next(const struct reader *r, const char *line) {
    size_t length = strlen(line);
    return r->size - r->at > length && !memcmp(r->bytes + r->at, line, length) &&
           r->bytes[r->at + length] == '\n';
}

/* Of particles, or of a surface: without points, what follows tells which. */
static int read_point_data(struct reader *r, struct vtk_frame *frame) {
    char line[LINE];
    snprintf(line, sizeof line, "POINT_DATA %d", frame->count);
    int code = expect_line(r, line);
    bool particles = !frame->triangles;
    if (!frame->count) particles = is_next(r, "SCALARS density float 1");
    if (particles) {
        if (code == EXIT_GOOD) code = read_scalars(r, "density", frame->count, &frame->density);
        if (code == EXIT_GOOD) code = read_scalars(r, "pressure", frame->count, &frame->pressure);
    }
    if (code == EXIT_GOOD) code = expect_line(r, "VECTORS velocity float");
    if (code == EXIT_GOOD)
        code = read_floats(r, 3 * (size_t)frame->count, "velocity", &frame->velocity);
    if (code != EXIT_GOOD || particles || r->at == r->size) return code;
    code = expect_line(r, "VECTORS normal float");
    return code == EXIT_GOOD ? read_floats(r, 3 * (size_t)frame->count, "normal", &frame->normal)
                             : code;
}

/* Reads a block of vertices, numbers of at least 0. */
static int read_indices(struct reader *r, size_t count, int **out) {
    int code = need_words(r, count, "vertex");
    if (code != EXIT_GOOD) return code;
    *out = malloc((count + 1) * sizeof **out);
    if (!*out) return no_memory(r->path, count * sizeof **out);
    for (size_t i = 0; i < count; i++) {
        uint32_t word = next_word(r);
        if (word > INT32_MAX)
            return fail_at(r, r->at - 4, "expected a vertex from 0, found %d", (int)word);
        (*out)[i] = (int)word;
    }
    return end_block(r);
}

static int read_binding(struct reader *r, struct vtk_frame *frame) {
    char points[LINE], vertex[LINE], weight[LINE];
    size_t numbers = 4 * (size_t)frame->count;
    snprintf(points, sizeof points, "POINT_DATA %d", frame->count);
    snprintf(vertex, sizeof vertex, "vertex 4 %d int", frame->count);
    snprintf(weight, sizeof weight, "weight 4 %d float", frame->count);
    int code = expect_line(r, points);
    if (code == EXIT_GOOD) code = expect_line(r, "FIELD binding 2");
    if (code == EXIT_GOOD) code = expect_line(r, vertex);
    if (code == EXIT_GOOD) code = read_indices(r, numbers, &frame->vertex);
    if (code == EXIT_GOOD) code = expect_line(r, weight);
    return code == EXIT_GOOD ? read_floats(r, numbers, "weight", &frame->weight) : code;
}

static int read_nothing(struct reader *r, struct vtk_frame *frame) {
    (void)r, (void)frame;
    return EXIT_GOOD;
}

/* read_data: reads what follows the cells */
static int read_frame(const char *path, int (*read_data)(struct reader *r, struct vtk_frame *frame),
                      struct vtk_frame *frame) {
    struct reader r = {.path = path};
    char *bytes;
    *frame = (struct vtk_frame){0};
    int code = read_file(path, &bytes, &r.size);
    r.bytes = bytes;
    if (code == EXIT_GOOD) code = read_points(&r, frame);
    if (code == EXIT_GOOD) code = read_cells(&r, frame);
    if (code == EXIT_GOOD) code = read_data(&r, frame);
    if (code == EXIT_GOOD && r.at != r.size)
        code =
            fail_at(&r, r.at, "expected the end of the file, found %zu more bytes", r.size - r.at);
    free(bytes);
    if (code != EXIT_GOOD) vtk_frame_free(frame);
    return code;
}

int vtk_frame_read(const char *path, struct vtk_frame *frame) {
    return read_frame(path, read_point_data, frame);
}

int vtk_frame_read_geometry(const char *path, struct vtk_frame *frame) {
    return read_frame(path, read_nothing, frame);
}

int vtk_frame_read_skin(const char *path, struct vtk_frame *frame) {
    return read_frame(path, read_binding, frame);
}

void vtk_frame_extend_box(struct box *box, const struct vtk_frame *frame) {
    for (const float *x = frame->x; x < frame->x + 3 * (size_t)frame->count; x += 3)
        box_add(box, (const double[3]){x[0], x[1], x[2]});
}

void vtk_frame_free(struct vtk_frame *frame) {
    free(frame->x);
    free(frame->velocity);
    free(frame->normal);
    free(frame->density);
    free(frame->pressure);
    free(frame->triangle);
    free(frame->vertex);
    free(frame->weight);
    *frame = (struct vtk_frame){0};
}
