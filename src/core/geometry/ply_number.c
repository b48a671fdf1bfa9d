#include "ply_number.h"

#include <math.h>

/* ---- types of numbers ------------------------------------------------------------------------ */

static double from_int8(uint64_t bits) { return (int8_t)bits; }
static double from_int16(uint64_t bits) { return (int16_t)bits; }
static double from_int32(uint64_t bits) { return (int32_t)bits; }
static double from_unsigned(uint64_t bits) { return (double)bits; }

static const struct ply_type types[] = {
    {"char", "int8", 1, from_int8, true, INT8_MIN, INT8_MAX},
    {"uchar", "uint8", 1, from_unsigned, true, 0, UINT8_MAX},
    {"short", "int16", 2, from_int16, true, INT16_MIN, INT16_MAX},
    {"ushort", "uint16", 2, from_unsigned, true, 0, UINT16_MAX},
    {"int", "int32", 4, from_int32, true, INT32_MIN, INT32_MAX},
    {"uint", "uint32", 4, from_unsigned, true, 0, UINT32_MAX},
    {"float", "float32", 4, scan_float, false, 0, 0},
    {"double", "float64", 8, scan_double, false, 0, 0},
};

/* ---- formats: how a number is written -------------------------------------------------------- */

bool ply_is_whole(double value, double min, double max) {
    return value >= min && value <= max && value == floor(value);
}

static bool read_text(struct scan *in, const struct ply_type *type, double *value,
                      struct word *found) {
    *found = scan_word(in);
    return word_number(*found, value) &&
           (!type->whole || ply_is_whole(*value, type->min, type->max));
}

static bool read_bytes(struct scan *in, const struct ply_type *type, bool big, double *value) {
    in->last = in->at;
    if ((size_t)(in->data + in->size - in->at) < type->size) return false;
    *value = type->decode(scan_bits(in->at, type->size, big));
    in->at += type->size;
    return true;
}

static bool read_little(struct scan *in, const struct ply_type *type, double *value,
                        struct word *found) {
    *found = (struct word){0};
    return read_bytes(in, type, false, value);
}

static bool read_big(struct scan *in, const struct ply_type *type, double *value,
                     struct word *found) {
    *found = (struct word){0};
    return read_bytes(in, type, true, value);
}

static const struct ply_format formats[] = {
    {"ascii", false, read_text},
    {"binary_little_endian", true, read_little},
    {"binary_big_endian", true, read_big},
};

/* ---- names ----------------------------------------------------------------------------------- */

const struct ply_type *ply_find_type(struct word name) {
    for (size_t k = 0; k < sizeof types / sizeof *types; k++)
        if (word_is(name, types[k].name) || word_is(name, types[k].alias)) return &types[k];
    return NULL;
}

const struct ply_format *ply_find_format(struct word name) {
    for (size_t k = 0; k < sizeof formats / sizeof *formats; k++)
        if (word_is(name, formats[k].name)) return &formats[k];
    return NULL;
}
