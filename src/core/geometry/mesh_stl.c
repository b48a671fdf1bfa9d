/* STL, text or binary: triangles as three positions each. Corners with equal coordinates become one
 * vertex. Triangles of which two corners are equal are left out: a closed mesh stays closed. Names,
 * normals and attributes are ignored.
 *
 *     text:   solid NAME { facet normal x y z  outer loop  3 x vertex x y z  endloop  endfacet }
 *             endsolid NAME
 *     binary: 80 bytes, number of triangles (uint32); of each: normal, 3 corners (float), uint16
 */
#include "mesh_file.h"

#include "base/snapshot_file.h"

#include <string.h>
#include <strings.h>

enum { HEAD = 84, RECORD = 50 }; /* bytes */

/* ---- vertices -------------------------------------------------------------------------------- */

struct stl {
    struct mesh_file *file;
    struct mesh_array slots; /* hash table of vertices: their index + 1; 0: free */
};

static size_t slots_of(const struct stl *stl) { return stl->slots.bytes / sizeof(int); }

/* The slot of the vertex at x, or the free one where it belongs. */
static int *find_slot(const struct stl *stl, const double x[3]) {
    const double *vertex = stl->file->vertex.data;
    int *slot = stl->slots.data;
    size_t last = slots_of(stl) - 1, k = hash_bytes(HASH_BEGIN, x, 3 * sizeof *x) & last;
    while (slot[k] && memcmp(vertex + 3 * (size_t)(slot[k] - 1), x, 3 * sizeof *x))
        k = (k + 1) & last;
    return slot + k;
}

/* Makes the table twice as large if it is half full. The number of slots is a power of two. */
static bool reserve_slots(struct stl *stl) {
    size_t count = slots_of(stl) ? slots_of(stl) : 512;
    while (count < 2 * ((size_t)stl->file->vertices + 1)) count *= 2;
    if (count == slots_of(stl)) return true;
    if (!mesh_file_reserve(stl->file, &stl->slots, count * sizeof(int))) return false;
    memset(stl->slots.data, 0, stl->slots.bytes);
    const double *vertex = stl->file->vertex.data;
    for (int i = 0; i < stl->file->vertices; i++) *find_slot(stl, vertex + 3 * (size_t)i) = i + 1;
    return true;
}

/* Finds or adds the vertex at x. */
static pdyn_status add_vertex(struct stl *stl, double x[3], int *index) {
    for (int a = 0; a < 3; a++) x[a] += 0.0; /* -0 becomes 0 */
    if (!reserve_slots(stl)) return PDYN_NO_MEMORY;
    int *slot = find_slot(stl, x);
    pdyn_status status = PDYN_OK;
    if (!*slot) {
        status = mesh_file_vertex(stl->file, x);
        if (status == PDYN_OK) *slot = stl->file->vertices;
    }
    *index = *slot - 1;
    return status;
}

static pdyn_status add_triangle(struct stl *stl, double x[9]) {
    int corner[3];
    pdyn_status status = PDYN_OK;
    for (int c = 0; c < 3 && status == PDYN_OK; c++)
        status = add_vertex(stl, x + 3 * c, corner + c);
    if (status != PDYN_OK) return status;
    if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) return PDYN_OK;
    mesh_file_begin_face(stl->file);
    for (int c = 0; c < 3 && status == PDYN_OK; c++)
        status = mesh_file_corner(stl->file, corner[c]);
    return status;
}

/* ---- text ------------------------------------------------------------------------------------ */

static bool is_keyword(struct word word, const char *keyword) {
    return word.length == strlen(keyword) && !strncasecmp(word.text, keyword, word.length);
}

static struct word first_word(struct mesh_file *file) {
    scan_skip_blank(&file->in);
    return scan_word(&file->in);
}

/* Reads a line that begins with the keyword. */
static pdyn_status read_keyword(struct mesh_file *file, const char *keyword) {
    struct word word = first_word(file);
    if (!is_keyword(word, keyword)) return scan_expected(&file->in, keyword, word);
    scan_next_line(&file->in);
    return PDYN_OK;
}

static pdyn_status read_corner(struct mesh_file *file, double x[3]) {
    struct word word = first_word(file);
    if (!is_keyword(word, "vertex")) return scan_expected(&file->in, "vertex", word);
    for (int a = 0; a < 3; a++) {
        word = scan_word(&file->in);
        if (!word_number(word, x + a))
            return scan_expected(&file->in, "3 coordinates after 'vertex'", word);
    }
    return PDYN_OK;
}

/* The lines after "facet normal". */
static pdyn_status read_facet(struct stl *stl) {
    double x[9];
    scan_next_line(&stl->file->in);
    pdyn_status status = read_keyword(stl->file, "outer");
    for (int c = 0; c < 3 && status == PDYN_OK; c++) status = read_corner(stl->file, x + 3 * c);
    if (status == PDYN_OK) status = add_triangle(stl, x);
    if (status == PDYN_OK) scan_next_line(&stl->file->in);
    if (status == PDYN_OK) status = read_keyword(stl->file, "endloop");
    return status == PDYN_OK ? read_keyword(stl->file, "endfacet") : status;
}

static pdyn_status read_solid(struct stl *stl) {
    pdyn_status status = read_keyword(stl->file, "solid");
    while (status == PDYN_OK) {
        struct word word = first_word(stl->file);
        if (is_keyword(word, "endsolid")) return scan_next_line(&stl->file->in), PDYN_OK;
        status = is_keyword(word, "facet")
                     ? read_facet(stl)
                     : scan_expected(&stl->file->in, "facet or endsolid", word);
    }
    return status;
}

static pdyn_status read_text(struct stl *stl) {
    pdyn_status status = PDYN_OK;
    do {
        status = read_solid(stl);
        if (status == PDYN_OK) scan_skip_blank(&stl->file->in);
    } while (status == PDYN_OK && !scan_at_end(&stl->file->in));
    return status;
}

/* ---- bytes ----------------------------------------------------------------------------------- */

static pdyn_status read_binary(struct stl *stl) {
    struct mesh_file *file = stl->file;
    file->in.binary = true, file->in.last = file->in.data;
    if (file->in.size < HEAD)
        return scan_fail(&file->in, "expected 'solid', or a binary STL of at least %d bytes", HEAD);
    size_t count = scan_bits(file->in.data + HEAD - 4, 4, false);
    file->in.last = file->in.data + HEAD - 4;
    if (file->in.size != HEAD + RECORD * count)
        return scan_fail(&file->in, "%zu triangles: expected a file of %zu bytes, found %zu", count,
                         HEAD + RECORD * count, file->in.size);
    pdyn_status status = PDYN_OK;
    for (size_t t = 0; t < count && status == PDYN_OK; t++) {
        double x[9];
        file->in.last = file->in.data + HEAD + RECORD * t + 12;
        for (int k = 0; k < 9; k++) x[k] = scan_float(scan_bits(file->in.last + 4 * k, 4, false));
        status = add_triangle(stl, x);
    }
    return status;
}

/* Binary files may begin with "solid", too, but only they have bytes 0. */
static bool is_text(const struct mesh_file *file) {
    const char *at = file->in.data;
    while (*at && strchr(" \t\r\n", *at)) at++;
    return !strncasecmp(at, "solid", 5) && !memchr(file->in.data, 0, file->in.size);
}

pdyn_status mesh_stl_parse(struct mesh_file *file) {
    struct stl stl = {.file = file};
    pdyn_status status = is_text(file) ? read_text(&stl) : read_binary(&stl);
    context_resize(file->in.context, stl.slots.data, stl.slots.bytes, 0);
    return status;
}
