/* Programs of the system that projdyn starts. */
#ifndef PROGRAM_H
#define PROGRAM_H

#include <stdbool.h>
#include <stddef.h>

/* Finds the first of some programs (the list ends with NULL) in the folders of PATH. */
bool find_program(const char *const *names, char *path, size_t size);

#endif
