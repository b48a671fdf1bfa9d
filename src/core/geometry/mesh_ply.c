/* PLY: a header that lists elements and their properties, then the values as text or bytes. Read
 * are x, y, z of "vertex", for a mesh the list of corners of "face", for particles vx, vy, vz. All
 * other properties are skipped. */
#include "mesh_file.h"
#include "ply_number.h"

#include <inttypes.h>
#include <stdio.h>

/* ---- the header ------------------------------------------------------------------------------ */

enum { SLOT_X, SLOT_Y, SLOT_Z, SLOT_VX, SLOT_VY, SLOT_VZ, SLOT_CORNERS, SLOT_NONE, SLOTS };
enum {
    VERTEX_SLOTS = 1 << SLOT_X | 1 << SLOT_Y | 1 << SLOT_Z,
    VELOCITY_SLOTS = 1 << SLOT_VX | 1 << SLOT_VY | 1 << SLOT_VZ
};

static const struct {
    const char *element, *property;
    int slot;
    bool of_mesh, of_points, required;
} wanted[] = {
    {"vertex", "x", SLOT_X, true, true, true},
    {"vertex", "y", SLOT_Y, true, true, true},
    {"vertex", "z", SLOT_Z, true, true, true},
    {"vertex", "vx", SLOT_VX, false, true, false},
    {"vertex", "vy", SLOT_VY, false, true, false},
    {"vertex", "vz", SLOT_VZ, false, true, false},
    {"face", "vertex_indices", SLOT_CORNERS, true, false, true},
    {"face", "vertex_index", SLOT_CORNERS, true, false, true},
};
enum { WANTED = sizeof wanted / sizeof *wanted };

struct property {
    struct word name;
    const struct ply_type *type;
    const struct ply_type *length; /* type of the length of a list; NULL: not a list */
    int slot;
};

struct element {
    struct word name;
    int64_t count;
    size_t first, properties;
    int slots; /* bits 1 << SLOT_...: properties of this element that are read */
};

struct ply {
    struct mesh_file *file;
    const struct ply_format *format;
    struct mesh_array element, property;
    size_t elements, properties;
    int slots;
    bool header_done;
};

static int shown(struct word word) { return word.length < 40 ? (int)word.length : 40; }

static pdyn_status read_format(struct ply *ply) {
    struct word name = scan_word(&ply->file->in);
    ply->format = ply_find_format(name);
    if (!ply->format)
        return scan_expected(&ply->file->in,
                             "format ascii, binary_little_endian or binary_big_endian", name);
    struct word version = scan_word(&ply->file->in);
    return word_is(version, "1.0") ? PDYN_OK
                                   : scan_expected(&ply->file->in, "version 1.0", version);
}

static pdyn_status read_element(struct ply *ply) {
    struct element element = {.name = scan_word(&ply->file->in), .first = ply->properties};
    if (!element.name.length) return scan_expected(&ply->file->in, "an element name", element.name);
    struct word count = scan_word(&ply->file->in);
    double value;
    if (!word_number(count, &value) || !ply_is_whole(value, 0, 1e15))
        return scan_expected(&ply->file->in, "a number of elements", count);
    element.count = (int64_t)value;
    if (!mesh_file_reserve(ply->file, &ply->element, (ply->elements + 1) * sizeof element))
        return PDYN_NO_MEMORY;
    ((struct element *)ply->element.data)[ply->elements++] = element;
    return PDYN_OK;
}

static bool is_wanted(const struct ply *ply, int k) {
    return ply->file->only_points ? wanted[k].of_points : wanted[k].of_mesh;
}

/* Finds the slot into which a property is read; SLOT_NONE: it is skipped. */
static pdyn_status assign_slot(struct ply *ply, struct element *element, struct property *p) {
    p->slot = SLOT_NONE;
    for (int k = 0; k < WANTED; k++)
        if (is_wanted(ply, k) && word_is(element->name, wanted[k].element) &&
            word_is(p->name, wanted[k].property))
            p->slot = wanted[k].slot;
    if (p->slot == SLOT_NONE) return PDYN_OK;
    if ((p->slot == SLOT_CORNERS) != (p->length != NULL))
        return scan_fail(&ply->file->in, "expected property '%.*s' to be %s", shown(p->name),
                         p->name.text, p->length ? "a number, found a list" : "a list");
    if (p->length && !p->type->whole)
        return scan_fail(&ply->file->in, "expected a list of integers, found %s", p->type->name);
    if (ply->slots & 1 << p->slot)
        return scan_fail(&ply->file->in, "property '%.*s' is given twice", shown(p->name),
                         p->name.text);
    ply->slots |= 1 << p->slot;
    element->slots |= 1 << p->slot;
    return PDYN_OK;
}

static pdyn_status read_property(struct ply *ply) {
    if (!ply->elements)
        return scan_fail(&ply->file->in, "expected an element before its properties");
    struct property property = {0};
    struct word word = scan_word(&ply->file->in);
    if (word_is(word, "list")) {
        word = scan_word(&ply->file->in);
        property.length = ply_find_type(word);
        if (!property.length || !property.length->whole)
            return scan_expected(&ply->file->in, "an integer type for the list's length", word);
        word = scan_word(&ply->file->in);
    }
    property.type = ply_find_type(word);
    if (!property.type) return scan_expected(&ply->file->in, "a type such as float or int", word);
    property.name = scan_word(&ply->file->in);
    if (!property.name.length)
        return scan_expected(&ply->file->in, "a property name", property.name);
    struct element *element = (struct element *)ply->element.data + ply->elements - 1;
    pdyn_status status = assign_slot(ply, element, &property);
    if (status != PDYN_OK) return status;
    if (!mesh_file_reserve(ply->file, &ply->property, (ply->properties + 1) * sizeof property))
        return PDYN_NO_MEMORY;
    ((struct property *)ply->property.data)[ply->properties++] = property;
    element->properties++;
    return PDYN_OK;
}

static pdyn_status end_header(struct ply *ply) {
    ply->header_done = true;
    return PDYN_OK;
}

static pdyn_status read_header_line(struct ply *ply) {
    static const struct {
        const char *name;
        pdyn_status (*read)(struct ply *ply); /* NULL: the line is ignored */
    } keywords[] = {{"format", read_format},     {"element", read_element},
                    {"property", read_property}, {"end_header", end_header},
                    {"comment", NULL},           {"obj_info", NULL}};
    struct word word = scan_word(&ply->file->in);
    size_t k = 0, n = sizeof keywords / sizeof *keywords;
    while (k < n && !word_is(word, keywords[k].name)) k++;
    if (k == n)
        return scan_expected(&ply->file->in, "format, element, property, comment or end_header",
                             word);
    if (!keywords[k].read) return PDYN_OK;
    pdyn_status status = keywords[k].read(ply);
    if (status != PDYN_OK) return status;
    word = scan_word(&ply->file->in);
    return word.length ? scan_expected(&ply->file->in, "the end of the line", word) : PDYN_OK;
}

/* Checks the header, and that the rest of the file is long enough for the elements it announces,
 * before memory is allocated for them. */
static pdyn_status check_header(const struct ply *ply) {
    if (!ply->format) return scan_fail(&ply->file->in, "expected a format line in the header");
    for (int k = 0; k < WANTED; k++)
        if (is_wanted(ply, k) && wanted[k].required && !(ply->slots & 1 << wanted[k].slot))
            return scan_fail(&ply->file->in, "expected property '%s' of element '%s' in the header",
                             wanted[k].property, wanted[k].element);
    int velocity = ply->slots & VELOCITY_SLOTS;
    if (velocity && velocity != VELOCITY_SLOTS)
        return scan_fail(&ply->file->in, "expected all of 'vx', 'vy' and 'vz' or none of them");
    const struct element *element = ply->element.data;
    const struct property *property = ply->property.data;
    size_t left = (size_t)(ply->file->in.data + ply->file->in.size - ply->file->in.at);
    for (size_t e = 0; e < ply->elements; e++) {
        struct word name = element[e].name;
        if (!element[e].properties)
            return scan_fail(&ply->file->in, "element '%.*s' has no properties", shown(name),
                             name.text);
        size_t bytes = 0; /* minimum size of one element; in text a digit and a blank per number */
        for (size_t k = 0; k < element[e].properties; k++) {
            const struct property *p = property + element[e].first + k;
            bytes += !ply->format->binary ? 2 : p->length ? p->length->size : p->type->size;
        }
        double need = (double)element[e].count * (double)bytes;
        if (need > (double)left + !ply->format->binary)
            return scan_fail(&ply->file->in,
                             "%" PRId64 " of element '%.*s' take at least %.0f bytes, but "
                             "%zu are left in the file",
                             element[e].count, shown(name), name.text, need, left);
    }
    return PDYN_OK;
}

static pdyn_status read_header(struct ply *ply) {
    struct mesh_file *file = ply->file;
    struct word magic = scan_word(&file->in);
    if (!word_is(magic, "ply")) return scan_expected(&file->in, "'ply'", magic);
    pdyn_status status = PDYN_OK;
    while (status == PDYN_OK && !ply->header_done) {
        scan_next_line(&file->in);
        status = read_header_line(ply);
    }
    if (status != PDYN_OK) return status;
    scan_next_line(&file->in);
    return check_header(ply);
}

/* ---- the values ------------------------------------------------------------------------------ */

struct place { /* the current element, for error messages */
    const struct element *element;
    int64_t number; /* index of the element, from 0 */
};

static pdyn_status read_value(const struct ply *ply, struct place place, const struct property *p,
                              const struct ply_type *type, double *value) {
    struct word found;
    if (ply->format->read(&ply->file->in, type, value, &found)) return PDYN_OK;
    char what[200];
    struct word name = place.element->name;
    snprintf(what, sizeof what, "%s for '%.*s' of %.*s %" PRId64 " (of %" PRId64 ")", type->name,
             shown(p->name), p->name.text, shown(name), name.text, place.number,
             place.element->count);
    return scan_expected(&ply->file->in, what, found);
}

static pdyn_status add_corner(struct mesh_file *file, double vertex) {
    if (vertex >= 0 && vertex < file->vertices) return mesh_file_corner(file, (int)vertex);
    return scan_fail(&file->in, "the face uses vertex %.0f, but %d are given so far (from 0 on)",
                     vertex, file->vertices);
}

static pdyn_status read_list(const struct ply *ply, struct place place, const struct property *p) {
    double length, value;
    pdyn_status status = read_value(ply, place, p, p->length, &length);
    if (status != PDYN_OK) return status;
    if (length < 0)
        return scan_fail(&ply->file->in, "expected a list length of 0 or more, found %.0f", length);
    bool face = p->slot == SLOT_CORNERS;
    if (face) mesh_file_begin_face(ply->file);
    for (int64_t k = 0; k < (int64_t)length && status == PDYN_OK; k++) {
        status = read_value(ply, place, p, p->type, &value);
        if (status == PDYN_OK && face) status = add_corner(ply->file, value);
    }
    return status == PDYN_OK && face ? mesh_file_end_face(ply->file) : status;
}

static pdyn_status read_entry(const struct ply *ply, struct place place) {
    const struct element *element = place.element;
    const struct property *p = (const struct property *)ply->property.data + element->first;
    const struct property *end = p + element->properties;
    double slot[SLOTS];
    pdyn_status status = PDYN_OK;
    if (!ply->format->binary) scan_skip_blank(&ply->file->in);
    for (; p < end && status == PDYN_OK; p++)
        status = p->length ? read_list(ply, place, p)
                           : read_value(ply, place, p, p->type, slot + p->slot);
    if (status == PDYN_OK && (element->slots & VERTEX_SLOTS) == VERTEX_SLOTS)
        status = mesh_file_vertex(ply->file, slot + SLOT_X);
    if (status == PDYN_OK && element->slots == (VERTEX_SLOTS | VELOCITY_SLOTS))
        status = mesh_file_velocity(ply->file, slot + SLOT_VX);
    if (status != PDYN_OK || ply->format->binary) return status;
    struct word more = scan_word(&ply->file->in);
    return more.length ? scan_expected(&ply->file->in, "the end of the line", more) : PDYN_OK;
}

static pdyn_status read_values(const struct ply *ply) {
    ply->file->in.binary = ply->format->binary;
    const struct element *element = ply->element.data;
    for (size_t e = 0; e < ply->elements; e++)
        for (int64_t k = 0; k < element[e].count; k++) {
            pdyn_status status = read_entry(ply, (struct place){element + e, k});
            if (status != PDYN_OK) return status;
        }
    scan_skip_blank(&ply->file->in);
    if (scan_at_end(&ply->file->in)) return PDYN_OK;
    return scan_fail(&ply->file->in, "expected the end of the file after the last element");
}

pdyn_status mesh_ply_parse(struct mesh_file *file) {
    struct ply ply = {.file = file};
    pdyn_status status = read_header(&ply);
    if (status == PDYN_OK) status = read_values(&ply);
    context_resize(file->in.context, ply.element.data, ply.element.bytes, 0);
    context_resize(file->in.context, ply.property.data, ply.property.bytes, 0);
    return status;
}
