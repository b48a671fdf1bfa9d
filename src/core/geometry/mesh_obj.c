/* Wavefront OBJ: reads vertices and polygons; ignores names, materials, normals and curves. */
#include "mesh_file.h"

#include "mesh.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* ---- joined lines ---------------------------------------------------------------------------- */

/* Length of a backslash and the end of the line behind it, "\n" or "\r\n"; 0 if there is none. */
static size_t continuation(const char *at, const char *end) {
    if (end - at >= 2 && at[0] == '\\' && at[1] == '\n') return 2;
    return end - at >= 3 && at[0] == '\\' && at[1] == '\r' && at[2] == '\n' ? 3 : 0;
}

/* A continuation of n characters becomes n - 1 blanks, and a newline at the end of the whole line.
 */
void mesh_obj_join_lines(char *text, size_t size) {
    static const char mark[] = {'\xef', '\xbb', '\xbf'};
    char *to = text;
    size_t joined = 0;
    bool comment = false;
    if (size >= sizeof mark && !memcmp(text, mark, sizeof mark)) memset(text, ' ', sizeof mark);
    for (const char *at = text, *end = text + size; at < end;) {
        size_t length = comment ? 0 : continuation(at, end);
        if (length) {
            memset(to, ' ', length - 1);
            to += length - 1, at += length, joined++;
            continue;
        }
        comment = *at != '\n' && (comment || *at == '#');
        *to++ = *at++;
        if (to[-1] != '\n') continue;
        memset(to, '\n', joined);
        to += joined, joined = 0;
    }
    memset(to, '\n', joined);
}

/* ---- lines ----------------------------------------------------------------------------------- */

/* Next word of the line; '#' starts a comment and ends the line. */
static struct word next_word(struct mesh_file *file) {
    struct word word = scan_word(&file->in);
    if (*word.text == '#') word.length = 0;
    return word;
}

static pdyn_status read_vertex(struct mesh_file *file) {
    double x[3], extra;
    for (int k = 0; k < 3; k++) {
        struct word word = next_word(file);
        if (!word_number(word, x + k))
            return scan_expected(&file->in, "3 coordinates after 'v'", word);
    }
    for (struct word word; (word = next_word(file)).length;) /* weight or colour */
        if (!word_number(word, &extra)) return scan_expected(&file->in, "a number", word);
    return mesh_file_vertex(file, x);
}

static bool read_integer(const char **at, const char *end, long *value) {
    if (*at == end || isspace((unsigned char)**at)) return false;
    char *stop;
    *value = strtol(*at, &stop, 10);
    bool read = stop != *at;
    *at = stop;
    return read;
}

/* Parses a face corner v, v/t, v//n or v/t/n and returns v. */
static bool read_corner(struct word word, long *vertex) {
    const char *at = word.text, *end = at + word.length;
    long ignored;
    if (!read_integer(&at, end, vertex)) return false;
    if (at == end) return true;
    if (*at++ != '/') return false;
    bool texture = read_integer(&at, end, &ignored);
    if (at == end) return texture;
    return *at++ == '/' && read_integer(&at, end, &ignored) && at == end;
}

static pdyn_status read_face(struct mesh_file *file) {
    mesh_file_begin_face(file);
    for (struct word word; (word = next_word(file)).length;) {
        long vertex;
        if (!read_corner(word, &vertex))
            return scan_expected(&file->in, "a face corner v, v/t, v//n or v/t/n", word);
        long index = vertex < 0 ? file->vertices + vertex : vertex - 1;
        if (index < 0 || index >= file->vertices)
            return scan_fail(&file->in,
                             "the face uses vertex %ld, but %d are given so far (from 1 on, "
                             "or backwards from -1)",
                             vertex, file->vertices);
        pdyn_status status = mesh_file_corner(file, (int)index);
        if (status != PDYN_OK) return status;
    }
    return mesh_file_end_face(file);
}

static const struct {
    const char *name;
    pdyn_status (*read)(struct mesh_file *file); /* NULL: the line is ignored */
} keywords[] = {
    {"v", read_vertex},  {"f", read_face},   {"vt", NULL},     {"vn", NULL},
    {"vp", NULL},        {"l", NULL},        {"p", NULL},      {"o", NULL},
    {"g", NULL},         {"s", NULL},        {"mg", NULL},     {"usemtl", NULL},
    {"mtllib", NULL},    {"usemap", NULL},   {"maplib", NULL}, {"bevel", NULL},
    {"c_interp", NULL},  {"d_interp", NULL}, {"lod", NULL},    {"shadow_obj", NULL},
    {"trace_obj", NULL},
};

static pdyn_status read_line(struct mesh_file *file) {
    struct word word = next_word(file);
    if (!word.length) return PDYN_OK;
    for (size_t k = 0; k < sizeof keywords / sizeof *keywords; k++)
        if (word_is(word, keywords[k].name))
            return keywords[k].read ? keywords[k].read(file) : PDYN_OK;
    return scan_expected(&file->in, "v, f or another keyword of OBJ", word);
}

pdyn_status mesh_obj_parse(struct mesh_file *file) {
    file->first_index = 1;
    mesh_obj_join_lines(file->in.data, file->in.size);
    pdyn_status status = PDYN_OK;
    for (; status == PDYN_OK && !scan_at_end(&file->in); scan_next_line(&file->in))
        status = read_line(file);
    return status;
}
