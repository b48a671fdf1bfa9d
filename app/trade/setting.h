/* A setting: overrides PATH=VALUE of scene values under one name. */
#ifndef SETTING_H
#define SETTING_H

#include <stdbool.h>

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
void setting_free(struct setting *setting);

#endif
