/* A list of overrides under one name, and the scene with them. */
#include "setting.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

void setting_add(struct setting *s, const char *format, ...) {
    char **set = realloc(s->set, (size_t)(s->sets + 1) * sizeof *set), *text = NULL;
    va_list args;
    va_start(args, format);
    if (set) s->set = set;
    if (!set || vasprintf(&text, format, args) < 0) s->failed = true;
    else set[s->sets++] = text;
    va_end(args);
}

bool setting_scene(const struct setting *s, const struct scene_options *user,
                   struct scene_options *scene) {
    bool good = true;
    *scene = (struct scene_options){.scene = user->scene, .threads = 1, .silent = true};
    for (int k = 0; k < user->plugins; k++) good &= scene_plugin(scene, user->plugin[k]);
    for (int k = 0; k < user->sets; k++) good &= scene_set(scene, user->set[k]);
    for (int k = 0; k < s->sets; k++) good &= scene_set(scene, s->set[k]);
    return good;
}

void setting_free(struct setting *s) {
    for (int k = 0; k < s->sets; k++) free(s->set[k]);
    free(s->set);
    free(s->name);
    *s = (struct setting){0};
}
