/* The look of the parts of a USD stage: liquids and tanks are seen through, all others are matt. */
#include "usd_look.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum kind { LIQUID, SHEET, VOLUME, OBSTACLE, TANK };

/* Colours of parts without one, as in pictures (replay/page/colours.js). */
static const char *const palette[][4] = {
    [LIQUID] = {"#3d8fb5", "#d9a93a", "#9c3350", "#3d8fb5"},
    [SHEET] = {"#e0c9a4", "#d98e73", "#a9b79a", "#c3a3b5"},
    [VOLUME] = {"#c4553b", "#d9a04a", "#7c5c86", "#6f8f5a"},
    [OBSTACLE] = {"#bdb7ae", "#bdb7ae", "#bdb7ae", "#bdb7ae"},
    [TANK] = {"#dfeeee", "#dfeeee", "#dfeeee", "#dfeeee"},
};

static const struct usd_look looks[] = {
    [LIQUID] = {.opacity = 0.4, .roughness = 0.02, .ior = 1.333},
    [SHEET] = {.opacity = 1.0, .roughness = 0.8, .ior = 1.5, .two_sided = true},
    [VOLUME] = {.opacity = 1.0, .roughness = 0.5, .ior = 1.5},
    [OBSTACLE] = {.opacity = 1.0, .roughness = 0.6, .ior = 1.5},
    [TANK] = {.opacity = 0.1, .roughness = 0.02, .ior = 1.0, .two_sided = true}, /* thin panes */
};

/* "#rrggbb", sRGB, as linear light. */
static void set_color(struct usd_look *look, const char *color) {
    long hex = strtol(color + 1, NULL, 16);
    for (int k = 0; k < 3; k++) {
        double s = (double)(hex >> 8 * (2 - k) & 255) / 255.0;
        look->color[k] = s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4);
    }
}

static int compare_edges(const void *a, const void *b) {
    const int *p = a, *q = b;
    return p[0] != q[0] ? (p[0] > q[0]) - (p[0] < q[0]) : (p[1] > q[1]) - (p[1] < q[1]);
}

/* Whether every edge of a mesh has two triangles, as isClosed in replay/page/meshes.js. */
static int is_closed(const struct vtk_frame *frame, bool *out) {
    int count = 3 * frame->triangles, (*edge)[2] = malloc(sizeof *edge * (size_t)(count + 1));
    if (!edge) return report_no_memory();
    for (int k = 0; k < count; k++) {
        int a = frame->triangle[k], b = frame->triangle[k % 3 == 2 ? k - 2 : k + 1];
        edge[k][0] = a < b ? a : b, edge[k][1] = a < b ? b : a;
    }
    qsort(edge, (size_t)count, sizeof *edge, compare_edges);
    *out = true;
    for (int k = 0, next; k < count && *out; k = next) {
        for (next = k + 1; next < count && !compare_edges(edge[k], edge[next]);) next++;
        *out = next == k + 2;
    }
    free(edge);
    return EXIT_GOOD;
}

static int find_kind_of_body(const struct run *run, const struct part *part, enum kind *out) {
    char path[RUN_PATH];
    struct vtk_frame frame;
    bool closed = true;
    if (!part->fluid && !part->shape && part->radius == 0.0) {
        int code = part_read_frame(run, part, 0, path, &frame);
        if (code != EXIT_GOOD) return code;
        code = is_closed(&frame, &closed);
        vtk_frame_free(&frame);
        if (code != EXIT_GOOD) return code;
    }
    *out = part->fluid ? LIQUID : closed ? VOLUME : SHEET;
    return EXIT_GOOD;
}

/* Whether the middle of a body at the start is in the box. */
static int holds_body(const struct run *run, const struct part *body, const struct box *box,
                      bool *out) {
    char path[RUN_PATH];
    struct vtk_frame frame;
    double sum[3] = {0};
    int code = part_read_frame(run, body, 0, path, &frame);
    if (code != EXIT_GOOD) return code;
    for (int k = 0; k < 3 * frame.count; k++) sum[k % 3] += (double)frame.x[k] / frame.count;
    *out |= frame.count && box_contains(box, sum);
    vtk_frame_free(&frame);
    return EXIT_GOOD;
}

/* Whether a solid is a tank: a box that lacks a side, or holds a body. */
static int is_tank(const struct run *run, const struct part *part, bool *out) {
    char path[RUN_PATH];
    struct vtk_frame frame;
    struct box box = box_empty;
    if (strcmp(part->shape, "box") != 0) return EXIT_GOOD;
    int code = part_read_frame(run, part, 0, path, &frame);
    if (code != EXIT_GOOD) return code;
    vtk_frame_extend_box(&box, &frame);
    *out = frame.triangles < 12;
    vtk_frame_free(&frame);
    for (int p = 0; p < run->parts && code == EXIT_GOOD && !*out; p++)
        if (run->part[p].kind == BODY) code = holds_body(run, &run->part[p], &box, out);
    return code;
}

static int find_kind(const struct run *run, const struct part *part, enum kind *out) {
    bool tank = false;
    if (part->kind == BODY) return find_kind_of_body(run, part, out);
    int code = part->kind == SOLID ? is_tank(run, part, &tank) : EXIT_GOOD;
    *out = tank ? TANK : OBSTACLE;
    return code;
}

int usd_find_looks(const struct run *run, struct usd_look *out) {
    int bodies[] = {[LIQUID] = 0, [SHEET] = 0, [VOLUME] = 0}; /* so far, of each kind */
    for (int p = 0; p < run->parts; p++) {
        const struct part *part = &run->part[p];
        enum kind kind;
        if (part->kind == BOUNDARY) continue;
        int code = find_kind(run, part, &kind);
        if (code != EXIT_GOOD) return code;
        int number = part->kind == BODY ? bodies[kind]++ : 0;
        out[p] = looks[kind];
        set_color(&out[p],
                  part->color ? part->color : palette[kind][number % (kind == LIQUID ? 3 : 4)]);
    }
    return EXIT_GOOD;
}
