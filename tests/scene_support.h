/* Shared by tests that read scenes: a directory of their own, one context that counts allocations,
 * short texts of scenes (with ' for "). */
#ifndef SCENE_SUPPORT_H
#define SCENE_SUPPORT_H

#include "scene/scene.h"
#include "support.h"

#define COUNT(array) ((int)(sizeof(array) / sizeof *(array)))

#define BOX        "{'minimum': [0, 0, 0], 'maximum': [1, 1, 1]}"
#define WATER      "{'particles': {'radius': 0.1, 'fill': [{'box': " BOX "}]}}"
#define TOP(extra) "{'duration': 1, 'bodies': [" WATER "],\n " extra "}"
#define BODY(text) "{'duration': 1, 'bodies': [\n  " text "]}"
#define SHEET(extra)                                                                               \
    "{'surface': {'grid': {'size': [1, 1], 'vertices': [3, 3]}, 'area_density': 1" extra "}}"
#define CLOTH(constraints)                                                                         \
    BODY("{'surface': {'grid': {'size': [1, 1], 'vertices': [3, 3]}, 'area_density': 1},\n"        \
         " 'constraints': [" constraints "]}")
#define PIN(vertices) CLOTH("{'type': 'pin', 'vertices': " vertices "}")
#define BOTH                                                                                       \
    "{'duration': 1, 'bodies': [\n"                                                                \
    "  {'name': 'water', 'particles': {'radius': 0.1, 'fill': [{'box': " BOX "}]}},\n"             \
    "  {'name': 'sheet', 'surface': {'grid': {'size': [1, 1], 'vertices': [3, 3]}, "               \
    "'area_density': 1},\n"                                                                        \
    "   'constraints': [{'type': 'spring', 'stretching_stiffness': 1000}]}]}"

extern pdyn_context *context;
extern struct counter counter;

/* Set-up and tear-down of a group of tests. */
int scene_set_up(void **state);
int scene_tear_down(void **state);

/* An expected text that ends with a star may continue; any may be followed by "; meaning: ...". */
void assert_message(const char *expected);

/* Reads a scene from a file (text NULL) or a text, with overrides. */
pdyn_status read_scene(const char *name, const char *text, const char *const *set, int sets,
                       struct scene *scene);
pdyn_status read_text(const char *text, const char *const *set, int sets, struct scene *scene);
void read_good(const char *text, const char *const *set, int sets, struct scene *scene);
void free_good(struct scene *scene);
/* Asserts bad input with this message, an empty scene and no allocated memory. */
void assert_failure(pdyn_status status, const struct scene *scene, const char *expected);

struct bad_scene {
    const char *text, *error;
};
/* The same for each text. */
void assert_bad_scenes(const struct bad_scene *bad, int count);

/* Reads a scene with one body of particles of this radius, m, at the velocity (1, 2, 3) m/s, filled
 * as the entries of "fill" say. */
pdyn_status read_fill(double radius, const char *fill, struct scene *scene);
const struct scene_body *read_good_fill(double radius, const char *fill, struct scene *scene);
void expect_bad_fill(double radius, const char *fill, const char *message);
/* Asserts the velocity (x, y, z), m/s, of `count` particles. */
void assert_velocity(const struct scene_body *body, int first, int count, double x, double y,
                     double z);

#endif
