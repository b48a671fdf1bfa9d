/* Tetrahedra from files: TetGen .node and .ele, Gmsh .msh (2.2 and 4.1, ASCII). A count in a file
 * is accepted only if the file is long enough for it, and arrays grow as elements are read: a wrong
 * count cannot exhaust memory. */
#include "base/text.h"
#include "mesh_file.h"
#include "tets.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

struct reader {
    struct mesh_file *file;
    struct mesh_array tag;  /* long, one per vertex: tags, ascending; NULL: vertices are numbered */
    struct mesh_array tets; /* int x 4 per tetrahedron */
    int count;
    bool named;       /* vertices have tags (Gmsh) */
    long first_index; /* number of the first vertex (TetGen) */
};

/* Reads an integer from `low` to `high`; `what` is for the error text. */
static pdyn_status read_whole(struct mesh_file *file, const char *what, double low, double high,
                              long *out) {
    double value;
    struct word word = scan_word(&file->in);
    if (!word_number(word, &value) || !(value >= low && value <= high) ||
        value != (double)(long)value)
        return scan_expected(&file->in, what, word);
    return *out = (long)value, PDYN_OK;
}

/* Skips blanks, line ends and comments up to the next word. */
static void skip(struct mesh_file *file) {
    scan_skip_blank(&file->in);
    while (!scan_at_end(&file->in) && *file->in.at == '#')
        scan_next_line(&file->in), scan_skip_blank(&file->in);
}

/* Reads a count of elements of at least `min_bytes` each; the file must be long enough. */
static pdyn_status read_count(struct mesh_file *file, const char *what, size_t min_bytes,
                              long *out) {
    size_t left = (size_t)(file->in.data + file->in.size - file->in.at);
    pdyn_status status = read_whole(file, what, 0, MESH_MAX, out);
    if (status != PDYN_OK || (size_t)*out * min_bytes <= left) return status;
    return scan_fail(&file->in, "%ld of them cannot be in a file of %zu bytes", *out,
                     file->in.size);
}

static pdyn_status read_point(struct mesh_file *file) {
    double x[3];
    for (int k = 0; k < 3; k++) {
        struct word word = scan_word(&file->in);
        if (!word_number(word, x + k)) return scan_expected(&file->in, "3 coordinates", word);
    }
    return mesh_file_vertex(file, x);
}

/* ---- vertices by tag ------------------------------------------------------------------------- */

/* Appends the tag of the vertex with index `count`. */
static pdyn_status add_tag(struct reader *r, size_t count, long tag) {
    long last = count ? ((const long *)r->tag.data)[count - 1] : -1;
    if (tag <= last)
        return scan_fail(&r->file->in, "expected tags of nodes to ascend, found %ld after %ld", tag,
                         last);
    if (!mesh_file_reserve(r->file, &r->tag, (count + 1) * sizeof(long))) return PDYN_NO_MEMORY;
    ((long *)r->tag.data)[count] = tag;
    return PDYN_OK;
}

/* Index of the vertex with this tag or number; -1: there is none. */
static int find_vertex(const struct reader *r, long name) {
    const long *tag = r->tag.data;
    int low = 0, high = r->file->vertices;
    if (!r->named)
        return name >= r->first_index && name - r->first_index < high ? (int)(name - r->first_index)
                                                                      : -1;
    while (high - low > 1) {
        int middle = low + (high - low) / 2;
        if (tag[middle] <= name) low = middle;
        else high = middle;
    }
    return high > low && tag[low] == name ? low : -1;
}

/* Reads the four corners of a tetrahedron. */
static pdyn_status read_tet(struct reader *r) {
    size_t bytes = 4 * sizeof(int) * ((size_t)r->count + 1);
    if (r->count == MESH_MAX) return scan_fail(&r->file->in, "more than %d tetrahedra", MESH_MAX);
    if (!mesh_file_reserve(r->file, &r->tets, bytes)) return PDYN_NO_MEMORY;
    int *corner = (int *)r->tets.data + 4 * (size_t)r->count++;
    for (int k = 0; k < 4; k++) {
        long name = 0;
        pdyn_status status = read_whole(r->file, "4 vertices", 0, 9e15, &name);
        if (status != PDYN_OK) return status;
        corner[k] = find_vertex(r, name);
        if (corner[k] < 0) return scan_fail(&r->file->in, "there is no vertex %ld", name);
        for (int m = 0; m < k; m++)
            if (corner[m] == corner[k])
                return scan_fail(&r->file->in, "the tetrahedron uses vertex %ld twice", name);
    }
    return PDYN_OK;
}

/* ---- TetGen ---------------------------------------------------------------------------------- */

static pdyn_status parse_node(struct reader *r) {
    struct mesh_file *file = r->file;
    long count = 0, dimension, index = 0;
    skip(file);
    pdyn_status status = read_count(file, "a number of points", 8, &count);
    if (status == PDYN_OK) status = read_whole(file, "dimension 3", 3, 3, &dimension);
    scan_next_line(&file->in);
    for (long i = 0; i < count && status == PDYN_OK; i++, scan_next_line(&file->in)) {
        skip(file);
        status = read_whole(file, "the number of a point", 0, MESH_MAX, &index);
        if (!i) r->first_index = index;
        if (status == PDYN_OK && (index - i != r->first_index || r->first_index > 1))
            status =
                scan_fail(&file->in, "expected points numbered from 0 or 1 on, found %ld", index);
        if (status == PDYN_OK) status = read_point(file);
    }
    return status;
}

static pdyn_status parse_ele(struct reader *r) {
    struct mesh_file *file = r->file;
    long count = 0, corners, index;
    skip(file);
    pdyn_status status = read_count(file, "a number of tetrahedra", 10, &count);
    if (status == PDYN_OK) status = read_whole(file, "4 corners", 4, 4, &corners);
    scan_next_line(&file->in);
    for (long i = 0; i < count && status == PDYN_OK; i++, scan_next_line(&file->in)) {
        skip(file);
        status = read_whole(file, "the number of a tetrahedron", 0, MESH_MAX, &index);
        if (status == PDYN_OK) status = read_tet(r);
    }
    return status;
}

/* ---- Gmsh ------------------------------------------------------------------------------------ */

/* Advances to the line after a section's name, e.g. "$Nodes". */
static pdyn_status find_section(struct mesh_file *file, const char *name) {
    while (!scan_at_end(&file->in)) {
        struct word word = scan_word(&file->in);
        scan_next_line(&file->in);
        if (word_is(word, name)) return PDYN_OK;
    }
    return scan_fail(&file->in, "expected a section %s", name);
}

static pdyn_status read_node_2(struct reader *r) {
    long tag = 0;
    skip(r->file);
    pdyn_status status = read_whole(r->file, "the tag of a node", 0, 9e15, &tag);
    if (status == PDYN_OK) status = add_tag(r, (size_t)r->file->vertices, tag);
    return status == PDYN_OK ? read_point(r->file) : status;
}

/* Format: tag, type, number of further tags, these tags, corners. Type 4 is a tetrahedron. */
static pdyn_status read_element_2(struct reader *r) {
    long tag, type = 0, tags = 0, unused;
    skip(r->file);
    pdyn_status status = read_whole(r->file, "the tag of an element", 0, 9e15, &tag);
    if (status == PDYN_OK) status = read_whole(r->file, "the type of an element", 1, 999, &type);
    if (status == PDYN_OK) status = read_whole(r->file, "a number of tags", 0, 99, &tags);
    for (long k = 0; k < tags && status == PDYN_OK; k++)
        status = read_whole(r->file, "a tag", -9e15, 9e15, &unused);
    if (status == PDYN_OK && type == 4) status = read_tet(r);
    scan_next_line(&r->file->in);
    return status;
}

static pdyn_status parse_2(struct reader *r) {
    long nodes = 0, elements = 0;
    pdyn_status status = find_section(r->file, "$Nodes");
    if (status == PDYN_OK) status = read_count(r->file, "a number of nodes", 8, &nodes);
    for (long k = 0; k < nodes && status == PDYN_OK; k++) status = read_node_2(r);
    if (status == PDYN_OK) status = find_section(r->file, "$Elements");
    if (status == PDYN_OK) status = read_count(r->file, "a number of elements", 6, &elements);
    for (long k = 0; k < elements && status == PDYN_OK; k++) status = read_element_2(r);
    return status;
}

/* Reads the head of a block of an entity: dimension, tag, a number, and the number of entries. */
static pdyn_status read_block(struct mesh_file *file, long *number, long *count) {
    long dimension, tag;
    skip(file);
    pdyn_status status = read_whole(file, "the dimension of an entity", 0, 3, &dimension);
    if (status == PDYN_OK) status = read_whole(file, "the tag of an entity", -9e15, 9e15, &tag);
    if (status == PDYN_OK) status = read_whole(file, "a number", 0, 999, number);
    return status == PDYN_OK ? read_count(file, "a number of entries", 2, count) : status;
}

/* Format: the tags of all nodes of the block, then their coordinates. */
static pdyn_status read_nodes_4(struct reader *r) {
    struct mesh_file *file = r->file;
    long parametric, count = 0, tag = 0;
    int first = file->vertices;
    pdyn_status status = read_block(file, &parametric, &count);
    if (status != PDYN_OK) return status;
    for (long k = 0; k < count && status == PDYN_OK; k++) {
        skip(file);
        status = read_whole(file, "the tag of a node", 0, 9e15, &tag);
        if (status == PDYN_OK) status = add_tag(r, (size_t)(first + k), tag);
    }
    for (long k = 0; k < count && status == PDYN_OK; k++) {
        skip(file);
        status = read_point(file);
        scan_next_line(&file->in);
    }
    return status;
}

static pdyn_status read_elements_4(struct reader *r) {
    struct mesh_file *file = r->file;
    long type = 0, count = 0, tag;
    pdyn_status status = read_block(file, &type, &count);
    scan_next_line(&file->in);
    for (long k = 0; k < count && status == PDYN_OK; k++, scan_next_line(&file->in)) {
        skip(file);
        status = read_whole(file, "the tag of an element", 0, 9e15, &tag);
        if (status == PDYN_OK && type == 4) status = read_tet(r);
    }
    return status;
}

/* Reads a section of blocks: number of blocks, then each block by `read`. */
static pdyn_status read_blocks(struct reader *r, const char *section,
                               pdyn_status (*read)(struct reader *r)) {
    long blocks = 0;
    pdyn_status status = find_section(r->file, section);
    if (status == PDYN_OK) status = read_count(r->file, "a number of blocks", 4, &blocks);
    scan_next_line(&r->file->in);
    for (long k = 0; k < blocks && status == PDYN_OK; k++) status = read(r);
    return status;
}

static pdyn_status parse_msh(struct reader *r) {
    double version = 0.0;
    long binary = 0, size;
    r->named = true;
    pdyn_status status = find_section(r->file, "$MeshFormat");
    if (status != PDYN_OK) return status;
    struct word word = scan_word(&r->file->in);
    if (!word_number(word, &version) || (version != 2.2 && version != 4.1))
        return scan_expected(&r->file->in, "version 2.2 or 4.1", word);
    status = read_whole(r->file, "0 for an ASCII file, or 1", 0, 1, &binary);
    if (status == PDYN_OK && binary)
        return scan_fail(&r->file->in, "it is a binary file of Gmsh, expected an ASCII one: "
                                       "gmsh FILE.msh -save -format msh41 -o NEW.msh");
    if (status == PDYN_OK) status = read_whole(r->file, "the size of a number", 1, 99, &size);
    if (status != PDYN_OK) return status;
    if (version == 2.2) return parse_2(r);
    status = read_blocks(r, "$Nodes", read_nodes_4);
    return status == PDYN_OK ? read_blocks(r, "$Elements", read_elements_4) : status;
}

/* ---- files ----------------------------------------------------------------------------------- */

/* Reads and parses one file. Vertices are appended to those of files read before. */
static pdyn_status read_one(struct reader *r, const char *path,
                            pdyn_status (*parse)(struct reader *r)) {
    r->file->in.path = path;
    pdyn_status status = scan_load(&r->file->in);
    struct text_locale locale;
    if (status != PDYN_OK) return status;
    if (!text_begin(&locale)) return context_no_memory(r->file->in.context);
    status = parse(r);
    text_end(&locale);
    scan_free(&r->file->in);
    return status;
}

static pdyn_status read_tetgen(struct reader *r, const char *path, size_t length) {
    size_t size = length + 2;
    char *other = NEW_ARRAY(r->file->in.context, size, char);
    if (!other) return PDYN_NO_MEMORY;
    snprintf(other, size, "%.*s.node", (int)(length - 5), path);
    pdyn_status status = read_one(r, other, parse_node);
    snprintf(other, size, "%.*s.ele", (int)(length - 5), path);
    if (status == PDYN_OK) status = read_one(r, other, parse_ele);
    FREE_ARRAY(r->file->in.context, other, size);
    return status;
}

static bool ends_with(const char *path, size_t length, const char *ending) {
    size_t n = strlen(ending);
    return length > n && !strcasecmp(path + length - n, ending);
}

static pdyn_status read_any(struct reader *r, const char *path) {
    size_t length = strlen(path);
    if (ends_with(path, length, ".node")) return read_tetgen(r, path, length);
    if (ends_with(path, length, ".ele")) return read_tetgen(r, path, length + 1);
    if (ends_with(path, length, ".msh")) return read_one(r, path, parse_msh);
    return set_error(PDYN_BAD_INPUT,
                     "%.1024s: expected a mesh of tetrahedra ending with .node, .ele or .msh; "
                     "\"cell\" fills a closed mesh of triangles with tetrahedra",
                     path);
}

pdyn_status tets_read(pdyn_context *context, const char *path, struct mesh *mesh,
                      struct tets *tets) {
    struct mesh_file file = {.in = {.context = context, .path = path}};
    struct reader r = {.file = &file};
    *mesh = (struct mesh){0}, *tets = (struct tets){0};
    pdyn_status status = read_any(&r, path);
    if (status == PDYN_OK && !r.count)
        status = set_error(PDYN_BAD_INPUT, "%.1024s: the mesh has no tetrahedra", path);
    if (status == PDYN_OK) {
        mesh->vertices = file.vertices, tets->count = r.count;
        mesh->vertex =
            mesh_file_detach(&file, &file.vertex, 3 * (size_t)file.vertices * sizeof(double));
        tets->corner = mesh_file_detach(&file, &r.tets, 4 * (size_t)r.count * sizeof(int));
        if (!mesh->vertex || !tets->corner) status = context_no_memory(context);
    }
    context_resize(context, r.tag.data, r.tag.bytes, 0);
    context_resize(context, r.tets.data, r.tets.bytes, 0);
    mesh_file_release(&file);
    return status;
}
