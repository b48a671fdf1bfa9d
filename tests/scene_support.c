#include "scene_support.h"

#include "scene/scene_file.h"

#include <string.h>

pdyn_context *context;
struct counter counter;

int scene_set_up(void **state) {
    context = test_counting_context(1, &counter);
    return test_enter_directory(state);
}

int scene_tear_down(void **state) {
    pdyn_destroy(context);
    return test_leave_directory(state);
}

void assert_message(const char *expected) {
    const char *found = pdyn_last_error(context);
    size_t length = strlen(expected);
    if (length && expected[length - 1] == '*' && !strncmp(found, expected, length - 1)) return;
    if (!strncmp(found, expected, length) && !strncmp(found + length, "; meaning: ", 11)) return;
    assert_string_equal(found, expected);
}

pdyn_status read_scene(const char *name, const char *text, const char *const *set, int sets,
                       struct scene *scene) {
    pdyn_scene *file = NULL;
    *scene = (struct scene){0};
    pdyn_status status =
        text ? pdyn_scene_parse(context, text, name, &file) : pdyn_scene_open(context, name, &file);
    if (status == PDYN_OK) status = pdyn_scene_override(file, set, sets);
    if (status == PDYN_OK) status = scene_read(&file->json, scene);
    pdyn_scene_free(file);
    return status;
}

pdyn_status read_text(const char *text, const char *const *set, int sets, struct scene *scene) {
    return read_scene("scene.json", quoted(text), set, sets, scene);
}

void read_good(const char *text, const char *const *set, int sets, struct scene *scene) {
    if (read_text(text, set, sets, scene) != PDYN_OK) fail_msg("%s", pdyn_last_error(context));
}

void free_good(struct scene *scene) {
    scene_free(context, scene);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    assert_null(scene->body);
}

void assert_failure(pdyn_status status, const struct scene *scene, const char *expected) {
    static const struct scene empty;
    assert_int_equal(status, PDYN_BAD_INPUT);
    assert_message(expected);
    assert_memory_equal(scene, &empty, sizeof empty);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
}

void assert_bad_scenes(const struct bad_scene *bad, int count) {
    for (int k = 0; k < count; k++) {
        struct scene scene;
        assert_failure(read_text(bad[k].text, NULL, 0, &scene), &scene, bad[k].error);
    }
}

/* ---- a body that is filled with particles ---------------------------------------------------- */

pdyn_status read_fill(double radius, const char *fill, struct scene *scene) {
    char text[4096];
    snprintf(text, sizeof text,
             "{'duration': 1, 'bodies': [{'velocity': [1, 2, 3],\n"
             "'particles': {'radius': %.17g, 'fill': [%s]}}]}",
             radius, fill);
    return read_text(text, NULL, 0, scene);
}

const struct scene_body *read_good_fill(double radius, const char *fill, struct scene *scene) {
    if (read_fill(radius, fill, scene) != PDYN_OK) fail_msg("%s", pdyn_last_error(context));
    assert_int_equal(scene->body[0].start.count, scene->body[0].start_v.count);
    return &scene->body[0];
}

void expect_bad_fill(double radius, const char *fill, const char *message) {
    struct scene scene;
    assert_int_not_equal(read_fill(radius, fill, &scene), PDYN_OK);
    assert_string_equal(pdyn_last_error(context), message);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
}

void assert_velocity(const struct scene_body *body, int first, int count, double x, double y,
                     double z) {
    const double v[3] = {x, y, z};
    for (int i = first; i < first + count; i++)
        if (!(test_distance(body->start_v.x + 3 * i, v, 3) < 1e-12))
            fail_msg("particle %d has an unexpected velocity", i);
}
