/* The OBJ file of a surface: its shape at the start of the run, with texture coordinates, groups
 * and materials, which the frames do not have. Vertices and triangles have the order of the frames.
 */
#include "base/file_in.h"
#include "base/file_out.h"
#include "output.h"

#include <ctype.h>
#include <string.h>

static void write_vertex(struct file_out *file, const double *x) {
    file_out_print(file, "v %.9g %.9g %.9g\n", x[0], x[1], x[2]);
}

/* ---- the file of the scene, with other positions --------------------------------------------- */

/* Length of a corner v, v/t, v//n or v/t/n without its normal, which a rotation would change. */
static size_t length_without_normal(const char *corner, size_t length) {
    const char *slash = memchr(corner, '/', length);
    const char *second =
        slash ? memchr(slash + 1, '/', length - (size_t)(slash + 1 - corner)) : NULL;
    if (!second) return length;
    return (size_t)((second == slash + 1 ? slash : second) - corner);
}

/* Writes a face from the text after its keyword. */
static void write_face(struct file_out *file, const char *at, const char *end) {
    file_out_print(file, "f");
    while (true) {
        while (at < end && isspace((unsigned char)*at)) at++;
        const char *corner = at;
        while (at < end && !isspace((unsigned char)*at)) at++;
        if (corner == at || *corner == '#') break;
        size_t length = length_without_normal(corner, (size_t)(at - corner));
        file_out_print(file, " %.*s", (int)length, corner);
    }
    file_out_print(file, "\n");
}

static bool begins_with(const char *line, const char *end, const char *word) {
    size_t length = strlen(word);
    return (size_t)(end - line) > length && !memcmp(line, word, length) &&
           isspace((unsigned char)line[length]);
}

/* Writes a line of the file. x: the next vertex; returns the one after the line. */
static const double *write_line(struct file_out *file, const char *line, const char *end,
                                const double *x) {
    while (line < end && isspace((unsigned char)*line)) line++;
    if (begins_with(line, end, "v")) {
        write_vertex(file, x);
        return x + 3;
    }
    if (begins_with(line, end, "f")) write_face(file, line + 1, end);
    else if (!begins_with(line, end, "vn"))
        file_out_bytes(file, line, (size_t)(end - line)), file_out_print(file, "\n");
    return x;
}

/* Number of vertices in the text. */
static int count_vertices(const char *at, const char *end) {
    int count = 0;
    while (at < end) {
        while (at < end && *at != '\n' && isspace((unsigned char)*at)) at++;
        count += begins_with(at, end, "v");
        const char *newline = memchr(at, '\n', (size_t)(end - at));
        at = newline ? newline + 1 : end;
    }
    return count;
}

static void copy_lines(struct file_out *file, const char *at, const char *end, const double *x) {
    while (at < end) {
        const char *newline = memchr(at, '\n', (size_t)(end - at)), *stop = newline ? newline : end;
        x = write_line(file, at, stop, x);
        at = newline ? newline + 1 : end;
    }
}

/* ---- meshes from elsewhere ------------------------------------------------------------------- */

/* Vertex j of row i of a grid has the texture coordinates of its place in the unit square. */
static void write_grid_coordinates(struct file_out *file, const int grid[2]) {
    for (int k = 0; k < grid[0] * grid[1]; k++)
        file_out_print(file, "vt %.9g %.9g\n", (double)(k % grid[0]) / (grid[0] - 1),
                       1.0 - (double)(k / grid[0]) / (grid[1] - 1));
}

static void write_triangles(struct file_out *file, const pdyn_body_info *info, bool textured) {
    for (int k = 0; k < 3 * info->triangles; k++) {
        int corner = info->triangle[k] + 1;
        file_out_print(file, k % 3 ? " " : "f ");
        file_out_print(file, textured ? "%d/%d" : "%d", corner, corner);
        if (k % 3 == 2) file_out_print(file, "\n");
    }
}

static void write_mesh(struct file_out *file, const pdyn_body_info *info, const int grid[2],
                       const double *x) {
    for (int i = 0; i < info->count; i++) write_vertex(file, x + 3 * (size_t)i);
    if (grid[0]) write_grid_coordinates(file, grid);
    write_triangles(file, info, grid[0]);
}

/* ---- the file of a body ---------------------------------------------------------------------- */

/* Loads the OBJ file of the scene; none if there is none. PDYN_BAD_INPUT: it has
 * changed since the scene was read. */
static pdyn_status load_source(const pdyn_sim *sim, int body, char **text, size_t *size) {
    const char *path = sim->scene.body[body].obj;
    *text = NULL, *size = 0;
    pdyn_status status = path ? file_load(sim->context, path, text, size) : PDYN_OK;
    if (status != PDYN_OK || !*text) return status;
    mesh_obj_join_lines(*text, *size);
    if (count_vertices(*text, *text + *size) == pdyn_get_body(sim, body).count) return PDYN_OK;
    return set_error(PDYN_BAD_INPUT, "%.1024s: the file has changed since the scene was read",
                     path);
}

static pdyn_status write_file(const pdyn_sim *sim, int body, const char *text, size_t size,
                              const char *path) {
    struct file_out file;
    pdyn_status status = file_out_open(sim->context, path, &file);
    if (status != PDYN_OK) return status;
    pdyn_body_info info = pdyn_get_body(sim, body);
    const double *x = sim->x + 3 * (size_t)info.first;
    if (text) copy_lines(&file, text, text + size, x);
    else write_mesh(&file, &info, sim->scene.body[body].grid, x);
    return file_out_close(&file);
}

pdyn_status obj_write_body(const pdyn_sim *sim, int body, const char *path) {
    char *text;
    size_t size;
    pdyn_status status = load_source(sim, body, &text, &size);
    if (status == PDYN_OK) status = write_file(sim, body, text, size, path);
    if (text) FREE_ARRAY(sim->context, text, size + 1);
    return status;
}
