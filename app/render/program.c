/* Programs of the system that projdyn starts. */
#include "program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static bool find_one(const char *name, char *path, size_t size) {
    const char *folder = getenv("PATH");
    while (folder && *folder) {
        int length = (int)strcspn(folder, ":");
        int written = snprintf(path, size, "%.*s/%s", length, folder, name);
        if (length && written < (int)size && !access(path, X_OK)) return true;
        folder += length + (folder[length] == ':');
    }
    return false;
}

bool find_program(const char *const *names, char *path, size_t size) {
    for (; *names; names++)
        if (find_one(*names, path, size)) return true;
    return false;
}
