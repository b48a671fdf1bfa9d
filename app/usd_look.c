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

static enum kind kind_of_body(const struct run *run, const struct part *part) {
    if (part->fluid) return LIQUID;
    bool closed = part->shape || part->radius > 0.0 || run_has_constraint(run, part->name, "tet") ||
                  run_has_constraint(run, part->name, "gas");
    return closed ? VOLUME : SHEET;
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
    for (const float *x = frame.x; x < frame.x + 3 * frame.count; x += 3)
        box_add(&box, (const double[3]){x[0], x[1], x[2]});
    *out = frame.triangles < 12;
    vtk_frame_free(&frame);
    for (int p = 0; p < run->parts && code == EXIT_GOOD && !*out; p++)
        if (run->part[p].kind == BODY) code = holds_body(run, &run->part[p], &box, out);
    return code;
}

static int find_kind(const struct run *run, const struct part *part, enum kind *out) {
    bool tank = false;
    int code = part->kind == SOLID ? is_tank(run, part, &tank) : EXIT_GOOD;
    *out = part->kind == BODY ? kind_of_body(run, part) : tank ? TANK : OBSTACLE;
    return code;
}

int usd_find_look(const struct run *run, const struct part *part, struct usd_look *out) {
    enum kind kind;
    int number = 0, code = find_kind(run, part, &kind);
    if (code != EXIT_GOOD) return code;
    for (const struct part *before = run->part; before < part && part->kind == BODY; before++)
        number += kind_of_body(run, before) == kind;
    *out = looks[kind];
    set_color(out, part->color ? part->color : palette[kind][number % (kind == LIQUID ? 3 : 4)]);
    return EXIT_GOOD;
}
