/* Numbers in a PLY file: their types, and how a format writes them. */
#ifndef PDYN_PLY_NUMBER_H
#define PDYN_PLY_NUMBER_H

#include "base/scan.h"

struct ply_type {
    const char *name, *alias;
    size_t size;
    double (*decode)(uint64_t bits);
    bool whole;
    double min, max; /* range of an integer type */
};

struct ply_format {
    const char *name;
    bool binary;
    /* Returns false if the next word is not such a number; `found` is that word. */
    bool (*read)(struct scan *in, const struct ply_type *type, double *value, struct word *found);
};

/* Whether a number is whole and within the range. */
bool ply_is_whole(double value, double min, double max);

/* NULL: there is no such type or format. */
const struct ply_type *ply_find_type(struct word name);
const struct ply_format *ply_find_format(struct word name);

#endif
