/* Marching cubes on the blocks of a colour field. A vertex belongs to the block of the lower end of
 * its grid edge: the index of a vertex is the first index of its block plus its rank among the
 * edges of the block that the surface crosses, so that cells share vertices without a search. */
#include "app.h"
#include "cube_cases.h"
#include "parallel.h"
#include "surface.h"

#include <stdio.h>
#include <stdlib.h>

enum { SIDE = BLOCK + 1, CORNERS = SIDE * SIDE * SIDE, GRAIN = 64, EDGE_WORDS = 3 };

/* Crossings closer to an end of a grid edge than this part of it would make thin triangles. */
static const double least_part = 0.2;

struct crossed_edges {
    uint64_t axis[EDGE_WORDS]; /* bit s: the surface crosses the edge along an axis from sample s */
    int first_vertex, first_triangle;
};

struct extraction {
    const struct colour_field *field;
    struct surface *surface;
    struct crossed_edges *edges; /* blocks + 1: of each block; counts, then sums of counts */
    struct cube_case cases[256];
};

/* ---- a block with the first samples of the next ones ----------------------------------------- */

struct window {
    float value[CORNERS]; /* x runs fastest */
    int block[8];         /* indices of the block and of the next ones; bit a: along axis a; -1 */
};

static int corner_index(int i, int j, int k) { return (k * SIDE + j) * SIDE + i; }

static void open_window(const struct colour_field *field, int b, struct window *w) {
    float constant[8];
    for (int n = 0; n < 8; n++) {
        int at[3];
        colour_coordinates(field->block[b], at);
        for (int a = 0; a < 3; a++) at[a] += n >> a & 1;
        uint64_t key = colour_key(at);
        w->block[n] = colour_find(field->block, field->blocks, key);
        constant[n] = colour_is_deep(field, key) ? 1.0f : 0.0f;
    }
    for (int k = 0; k < SIDE; k++)
        for (int j = 0; j < SIDE; j++)
            for (int i = 0; i < SIDE; i++) {
                int n = i / BLOCK | j / BLOCK << 1 | k / BLOCK << 2;
                int sample = (k % BLOCK * BLOCK + j % BLOCK) * BLOCK + i % BLOCK;
                w->value[corner_index(i, j, k)] =
                    w->block[n] < 0
                        ? constant[n]
                        : field->value[(size_t)w->block[n] * BLOCK_SAMPLES + (size_t)sample];
            }
}

/* The corners of a cell that are inside, as bits. */
static int case_of_cell(const struct window *w, int i, int j, int k) {
    int inside = 0;
    for (int c = 0; c < 8; c++)
        inside |=
            colour_is_inside(w->value[corner_index(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2))])
            << c;
    return inside;
}

/* ---- counting -------------------------------------------------------------------------------- */

static int count_bits(uint64_t word) { return __builtin_popcountll(word); }

/* Marks the edges from a sample that the surface crosses. */
static void mark_edges(const struct window *w, int i, int j, int k, struct crossed_edges *edges) {
    bool here = colour_is_inside(w->value[corner_index(i, j, k)]);
    for (int a = 0; a < 3; a++) {
        int far = corner_index(i + (a == 0), j + (a == 1), k + (a == 2));
        if (colour_is_inside(w->value[far]) != here)
            edges->axis[a] |= UINT64_C(1) << ((k * BLOCK + j) * BLOCK + i);
    }
}

static void count_blocks(void *self, int first, int last) {
    struct extraction *e = self;
    for (int b = first; b < last; b++) {
        struct window w;
        struct crossed_edges *edges = &e->edges[b];
        open_window(e->field, b, &w);
        for (int k = 0; k < BLOCK; k++)
            for (int j = 0; j < BLOCK; j++)
                for (int i = 0; i < BLOCK; i++) {
                    mark_edges(&w, i, j, k, edges);
                    edges->first_triangle += e->cases[case_of_cell(&w, i, j, k)].triangles;
                }
        for (int a = 0; a < 3; a++) edges->first_vertex += count_bits(edges->axis[a]);
    }
}

/* Turns the counts of the blocks into first indices and allocates the surface. */
static int sum_counts(struct extraction *e) {
    long vertices = 0, triangles = 0;
    for (int b = 0; b < e->field->blocks; b++) {
        int v = e->edges[b].first_vertex, t = e->edges[b].first_triangle;
        e->edges[b].first_vertex = (int)vertices, e->edges[b].first_triangle = (int)triangles;
        vertices += v, triangles += t;
    }
    int code = surface_resize(e->surface, vertices, triangles);
    e->surface->vertices = (int)vertices, e->surface->triangles = (int)triangles;
    return code;
}

int surface_resize(struct surface *surface, long vertices, long triangles) {
    if (vertices > SURFACE_MOST || triangles > SURFACE_MOST) {
        fprintf(stderr, "projdyn: mesh: a surface of more than %d vertices or triangles\n",
                SURFACE_MOST);
        return EXIT_FAILED;
    }
    float *x = realloc(surface->x, (3 * (size_t)vertices + 1) * sizeof *x);
    if (x) surface->x = x;
    int *triangle = realloc(surface->triangle, (3 * (size_t)triangles + 1) * sizeof *triangle);
    if (triangle) surface->triangle = triangle;
    return x && triangle ? EXIT_GOOD : report_no_memory();
}

/* ---- vertices and triangles ------------------------------------------------------------------ */

/* Index of the vertex on the edge along an axis from sample s of a block; -1: there is none. */
static int vertex_of(const struct extraction *e, int block, int s, int axis) {
    if (block < 0 || !(e->edges[block].axis[axis] >> s & 1)) return -1;
    const struct crossed_edges *edges = &e->edges[block];
    int rank = count_bits(edges->axis[axis] & ((UINT64_C(1) << s) - 1));
    for (int a = 0; a < axis; a++) rank += count_bits(edges->axis[a]);
    return edges->first_vertex + rank;
}

/* Places the vertices on the edges from sample (i, j, k), by linear interpolation. */
static void place_vertices(struct extraction *e, const struct window *w, int i, int j, int k) {
    int at[3], s = (k * BLOCK + j) * BLOCK + i;
    const int sample[3] = {i, j, k};
    colour_coordinates(e->field->block[w->block[0]], at);
    for (int axis = 0; axis < 3; axis++) {
        int vertex = vertex_of(e, w->block[0], s, axis);
        if (vertex < 0) continue;
        double here = (double)w->value[corner_index(i, j, k)];
        double next =
            (double)w->value[corner_index(i + (axis == 0), j + (axis == 1), k + (axis == 2))];
        double part = (COLOUR_ISO - here) / (next - here);
        part = part < least_part ? least_part : part > 1.0 - least_part ? 1.0 - least_part : part;
        for (int a = 0; a < 3; a++)
            e->surface->x[3 * (size_t)vertex + (size_t)a] =
                (float)(e->field->cell * (BLOCK * at[a] + sample[a] + (a == axis ? part : 0.0)));
    }
}

/* The vertex on an edge of cell (i, j, k). */
static int vertex_of_cell(const struct extraction *e, const struct window *w, int i, int j, int k,
                          int edge) {
    int corner = cube_edge_corner(edge);
    i += corner & 1, j += corner >> 1 & 1, k += corner >> 2;
    int n = i / BLOCK | j / BLOCK << 1 | k / BLOCK << 2;
    int s = (k % BLOCK * BLOCK + j % BLOCK) * BLOCK + i % BLOCK;
    return vertex_of(e, w->block[n], s, edge / 4);
}

static void fill_blocks(void *self, int first, int last) {
    struct extraction *e = self;
    for (int b = first; b < last; b++) {
        struct window w;
        int *triangle = e->surface->triangle + 3 * (size_t)e->edges[b].first_triangle;
        open_window(e->field, b, &w);
        for (int k = 0; k < BLOCK; k++)
            for (int j = 0; j < BLOCK; j++)
                for (int i = 0; i < BLOCK; i++) {
                    const struct cube_case *cell = &e->cases[case_of_cell(&w, i, j, k)];
                    place_vertices(e, &w, i, j, k);
                    for (int c = 0; c < 3 * cell->triangles; c++)
                        *triangle++ = vertex_of_cell(e, &w, i, j, k, cell->edge[c]);
                }
    }
}

int surface_extract(const struct colour_field *field, int threads, struct surface *out) {
    struct extraction e = {.field = field, .surface = out};
    *out = (struct surface){0};
    cube_cases_make(e.cases);
    e.edges = calloc((size_t)field->blocks + 1, sizeof *e.edges);
    if (!e.edges) return report_no_memory();
    parallel_for(threads, field->blocks, GRAIN, count_blocks, &e);
    int code = sum_counts(&e);
    if (code == EXIT_GOOD) parallel_for(threads, field->blocks, GRAIN, fill_blocks, &e);
    free(e.edges);
    return code;
}

void surface_free(struct surface *surface) {
    free(surface->x), free(surface->velocity), free(surface->normal), free(surface->triangle);
    free(surface->closest), free(surface->walls), free(surface->mobility);
    *surface = (struct surface){0};
}
