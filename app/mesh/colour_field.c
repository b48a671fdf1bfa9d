/* Bins and volumes of the particles of a colour field. */
#include "colour_field.h"

#include "app.h"
#include "parallel.h"
#include "projdyn/vec3.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { AXIS_BITS = 21, AXIS_HALF = 1 << 20, GRAIN = 64 };

/* ---- bins ------------------------------------------------------------------------------------ */

uint64_t colour_key(const int at[3]) {
    uint64_t key = 0;
    for (int a = 2; a >= 0; a--) key = key << AXIS_BITS | (uint64_t)(at[a] + AXIS_HALF);
    return key;
}

void colour_coordinates(uint64_t key, int at[3]) {
    for (int a = 0; a < 3; a++)
        at[a] = (int)(key >> a * AXIS_BITS & ((1u << AXIS_BITS) - 1)) - AXIS_HALF;
}

void colour_bin(const struct colour_field *field, const double x[3], int at[3]) {
    for (int a = 0; a < 3; a++) at[a] = (int)floor(x[a] / field->support);
}

/* Index of the first key that is not less than `wanted`. */
static int lower_bound(const uint64_t *key, int count, uint64_t wanted) {
    int low = 0, high = count;
    while (low < high) {
        int middle = low + (high - low) / 2;
        if (key[middle] < wanted) low = middle + 1;
        else high = middle;
    }
    return low;
}

int colour_find(const uint64_t *key, int count, uint64_t wanted) {
    int at = lower_bound(key, count, wanted);
    return at < count && key[at] == wanted ? at : -1;
}

struct colour_rows colour_rows_around(const struct colour_field *field, const int at[3]) {
    struct colour_rows rows;
    for (int r = 0; r < 9; r++) {
        int begin[3] = {at[0] - 1, at[1] + r % 3 - 1, at[2] + r / 3 - 1};
        int low = lower_bound(field->bin, field->bins, colour_key(begin)), high = low;
        begin[0] = at[0] + 1;
        while (high < field->bins && field->bin[high] <= colour_key(begin)) high++;
        rows.first[r] = field->first[low], rows.last[r] = field->first[high];
    }
    return rows;
}

struct entry { /* a particle and the key of its bin */
    uint64_t key;
    int particle;
};

static int compare_entries(const void *a, const void *b) {
    const struct entry *p = a, *q = b;
    if (p->key != q->key) return p->key < q->key ? -1 : 1;
    return (p->particle > q->particle) - (p->particle < q->particle);
}

static int make_entries(const struct colour_field *field, const struct vtk_frame *frame,
                        const char *path, struct entry *entry) {
    for (int i = 0; i < frame->count; i++) {
        int at[3];
        for (int a = 0; a < 3; a++) {
            double b = floor((double)frame->x[3 * i + a] / field->support);
            if (fabs(b) > AXIS_HALF - 4) {
                fprintf(stderr,
                        "projdyn: %s: point %d: expected coordinates up to %g m (2^20 times the "
                        "support of the kernel), found %g m\n",
                        path, i, (AXIS_HALF - 4) * field->support, (double)frame->x[3 * i + a]);
                return EXIT_BAD_INPUT;
            }
            at[a] = (int)b;
        }
        entry[i] = (struct entry){colour_key(at), i};
    }
    qsort(entry, (size_t)frame->count, sizeof *entry, compare_entries);
    return EXIT_GOOD;
}

/* Copies the particles in the order of the entries and lists the bins. */
static void fill_bins(struct colour_field *field, const struct vtk_frame *frame,
                      const struct entry *entry) {
    for (int i = 0; i < field->count; i++) {
        size_t from = 3 * (size_t)entry[i].particle;
        memcpy(field->x + 3 * (size_t)i, frame->x + from, 3 * sizeof *field->x);
        memcpy(field->v + 3 * (size_t)i, frame->velocity + from, 3 * sizeof *field->v);
        if (i && entry[i].key == entry[i - 1].key) continue;
        field->bin[field->bins] = entry[i].key;
        field->first[field->bins++] = i;
    }
    field->first[field->bins] = field->count;
}

/* ---- volumes of particles -------------------------------------------------------------------- */

double colour_kernel(const struct colour_field *field, double r2) {
    double rest = 1.0 - r2 / (field->support * field->support);
    double square = rest * rest;
    return rest > 0.0 ? square * square * rest : 0.0;
}

bool colour_is_alone(const struct colour_field *field, int i) { return !(field->weight[i] > 0.0f); }

static double distance2(const float *a, const float *b, double d[3]) {
    for (int k = 0; k < 3; k++) d[k] = (double)b[k] - (double)a[k];
    return vec3_dot(d, d);
}

/* A particle is deep if its density sum is that of the inside of the fluid, within 10 %, and the
 * centre of its neighbours is at most 0.06 times the support (0.12 spacings) away; 0.18 spacings at
 * a surface. */
static void measure_particle(struct colour_field *field, const struct colour_rows *rows, int i) {
    double sum = 0.0, d[3], offset[3] = {0};
    for (int r = 0; r < 9; r++)
        for (int j = rows->first[r]; j < rows->last[r]; j++) {
            double w = colour_kernel(
                field, distance2(field->x + 3 * (size_t)i, field->x + 3 * (size_t)j, d));
            sum += w;
            for (int a = 0; a < 3; a++) offset[a] += w * d[a];
        }
    double away = vec3_length(offset) / sum;
    field->weight[i] = sum > 1.0 ? (float)(1.0 / sum) : 0.0f;
    field->deep[i] = sum * COLOUR_SUM_SCALE > 0.9 && away < 0.06 * field->support;
}

static void measure_bins(void *self, int first, int last) {
    struct colour_field *field = self;
    for (int b = first; b < last; b++) {
        int at[3];
        colour_coordinates(field->bin[b], at);
        struct colour_rows rows = colour_rows_around(field, at);
        for (int i = field->first[b]; i < field->first[b + 1]; i++)
            measure_particle(field, &rows, i);
    }
}

/* ---- the field ------------------------------------------------------------------------------- */

static bool allocate_particles(struct colour_field *field) {
    size_t n = (size_t)field->count + 1;
    field->x = malloc(3 * n * sizeof *field->x);
    field->v = malloc(3 * n * sizeof *field->v);
    field->weight = malloc(n * sizeof *field->weight);
    field->deep = malloc(n * sizeof *field->deep);
    field->bin = malloc(n * sizeof *field->bin);
    field->first = malloc(n * sizeof *field->first);
    return field->x && field->v && field->weight && field->deep && field->bin && field->first;
}

static int sort_particles(struct colour_field *field, const struct vtk_frame *frame,
                          const char *path) {
    struct entry *entry = malloc(((size_t)frame->count + 1) * sizeof *entry);
    int code = entry && allocate_particles(field) ? EXIT_GOOD : report_no_memory();
    if (code == EXIT_GOOD) code = make_entries(field, frame, path, entry);
    if (code == EXIT_GOOD) fill_bins(field, frame, entry);
    free(entry);
    return code;
}

int colour_field_build(const struct vtk_frame *frame, const char *path, double radius, int threads,
                       struct colour_field *field) {
    *field = (struct colour_field){.support = 4.0 * radius, .cell = radius, .count = frame->count};
    int code = sort_particles(field, frame, path);
    if (code != EXIT_GOOD) return code;
    parallel_for(threads, field->bins, GRAIN, measure_bins, field);
    return colour_sample_surface(field, threads);
}

void colour_field_free(struct colour_field *field) {
    free(field->x), free(field->v), free(field->weight), free(field->deep);
    free(field->bin), free(field->first), free(field->block), free(field->value);
    *field = (struct colour_field){0};
}
