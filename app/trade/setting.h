/* A setting: overrides PATH=VALUE of scene values under one name. */
#ifndef SETTING_H
#define SETTING_H

#include "scene_options.h"

struct setting {
    char *name; /* shown in tables */
    char **set; /* sets */
    int sets;
    bool truncated; /* steps stop at an iteration limit instead of a residual */
    bool failed;    /* memory ran out: some overrides are missing */
};

/* Appends an override, formatted as by printf. Sets `failed` if memory ran out. */
void setting_add(struct setting *setting, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* The scene of the user with the user's overrides, then those of a setting. false with a message if
 * memory ran out; the caller calls scene_options_free() in any case. */
bool setting_scene(const struct setting *setting, const struct scene_options *user,
                   struct scene_options *scene);
void setting_free(struct setting *setting);

#endif
