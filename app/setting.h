/* Overrides PATH=VALUE of a scene, with a name for people. */
#ifndef SETTING_H
#define SETTING_H

#include <stdbool.h>

struct setting {
    char *name;
    char **set; /* sets */
    int sets;
    bool cut;    /* its steps end after some iterations, solved or not */
    bool failed; /* memory ran out: some are missing */
};

/* One more override. */
void setting_add(struct setting *setting, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void setting_free(struct setting *setting);

#endif
