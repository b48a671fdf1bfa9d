/* The scenes of trials, written from a type's parameter table. */
#include "base/param_kind.h"
#include "base/text.h"
#include "conformance.h"
#include "scene/scene_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* A required parameter gets 10 clamped to its bounds, others their default. */
static double value_for(const pdyn_param *p) {
    return p->required ? fmin(p->max, fmax(p->min, 10.0)) : p->def;
}

/* By parameter kind; arguments: the name, then three times the value. */
static const char *const format_of[] = {[PDYN_REAL] = ", \"%s\": %.17g",
                                        [PDYN_INT] = ", \"%s\": %.0f",
                                        [PDYN_VECTOR] = ", \"%s\": [%.17g, %.17g, %.17g]",
                                        [PDYN_VERTICES] =
                                            ", \"%s\": {\"vertices\": [0, 4, 7, 12, 16]}",
                                        [PDYN_PATH] = ", \"%s\": [[0, 0, 0, 0], [1, 0.1, 0, 0]]",
                                        [PDYN_OTHER] = ", \"%s\": \"other\""};

/* The vertex in a column of a row: those of the first cell of the grid, which span it, then further
 * ones, moved along x from row to row. Rows of one vertex go around the cell as a closed curve. */
static int vertex_for(const struct trial_scene *scene, const pdyn_param *p, int row, int column) {
    static const int cell[BODY_KINDS][SIZES][4] = {
        [SURFACE] = {{0, 1, 5, 6}, {0, 1, 46, 47}},
        [VOLUME] = {{0, 1, 3, 6}, {0, 1, 11, 121}}}; /* beside each other along x, y, z */
    static const int around[4] = {0, 1, 3, 2};
    const int *corner = cell[scene->check->kind][scene->size];
    if (param_vertices(p) == 1) return corner[around[row]];
    return row + (column < 4 ? corner[column] : corner[3] + column);
}

static void write_row(FILE *text, const struct trial_scene *scene, const pdyn_param *p, int row) {
    const char *before = param_width(p) > 1 ? "[" : "";
    for (int k = 0; k < param_width(p); k++, before = ", ")
        fprintf(text, "%s%.17g", before,
                k < param_vertices(p) ? vertex_for(scene, p, row, k) : value_for(p));
    if (param_width(p) > 1) fprintf(text, "]");
}

/* The rows that a table has in the text: one for all parts of the body, or two with vertices, four
 * if they have one vertex each; with many rows two for each vertex of the body. */
static int count_rows(const struct trial_scene *scene, const pdyn_param *p) {
    static const int vertices[BODY_KINDS][SIZES] = {[SURFACE] = {30, 2116}, [VOLUME] = {18, 1331}};
    const struct check *check = scene->check;
    if (param_rows(p, 1, 1, 1)) return 1;
    if (param_vertices(p)) return param_vertices(p) == 1 ? 4 : 2;
    return check->form.many_rows ? 2 * vertices[check->kind][scene->size] : 1;
}

/* Writes a required table. */
static void write_table(FILE *text, const struct trial_scene *scene, const pdyn_param *p) {
    int rows = count_rows(scene, p);
    bool listed = rows > 1;
    fprintf(text, ", \"%s\": %s", p->name, listed ? "[" : "");
    for (int row = 0; row < rows; row++) {
        if (row) fprintf(text, ", ");
        write_row(text, scene, p, row);
    }
    if (listed) fprintf(text, "]");
}

bool trial_exchanges(const struct check *check, const pdyn_constraint_type *type,
                     const pdyn_param *param) {
    int number = 0;
    for (const pdyn_param *p = type->params; p <= param; p++) number += p->kind == PDYN_BOOL;
    return check->form.exchanged == number || check->form.exchanged > type_bools(type);
}

/* Writes a parameter that is true or false: a required one is true by default. */
static void write_bool(FILE *text, const struct trial_scene *scene, const pdyn_param *p) {
    bool exchanged = trial_exchanges(scene->check, scene->type, p);
    bool usual = p->required || p->def != 0.0;
    if (exchanged || p->required)
        fprintf(text, ", \"%s\": %s", p->name, usual != exchanged ? "true" : "false");
}

/* Writes the constraint with these parameters: those that are required, those that are true or
 * false where the trial exchanges them, and real ones whose default lies within the bounds (others
 * have no default). */
static void write_constraint(FILE *text, const struct trial_scene *scene) {
    fprintf(text, "\"constraints\": [{\"type\": \"%s\"", scene->type->name);
    for (const pdyn_param *p = scene->type->params; p->name; p++) {
        bool given = p->required || (p->kind == PDYN_REAL && isfinite(p->def) && p->def >= p->min &&
                                     p->def <= p->max);
        double value = value_for(p);
        if (p->kind == PDYN_BOOL) write_bool(text, scene, p);
        else if (given && param_is_table(p)) write_table(text, scene, p);
        else if (given) fprintf(text, format_of[p->kind], p->name, value, value, value);
    }
    fprintf(text, "}]}");
}

#define SHEET(vertices)                                                                            \
    "\"surface\": {\"grid\": {\"size\": [0.4, 0.5], \"vertices\": " vertices "},"                  \
    " \"rotate\": [20, 30, 10], \"area_density\": 0.3}"
/* The first body, so that the first particle of the checked one is not that of the system. OTHER:
 * with a surface, for types with a PDYN_OTHER parameter or on neighbour lists; DROPS: for other
 * types on particles. */
#define OTHER                                                                                      \
    "{\"name\": \"other\", \"surface\": {\"grid\": {\"size\": [0.4, 0.5], \"vertices\": [4, 3]},"  \
    " \"rotate\": [20, 30, 10], \"translate\": [0, 0.3, 0], \"area_density\": 0.3}}"
#define DROPS(radius)                                                                              \
    "{\"name\": \"other\", \"particles\": {\"radius\": " radius ", \"fill\": [{\"box\": {"         \
    "\"minimum\": [2, 0, 0], \"maximum\": [2.31, 0.21, 0.21]}}]}}"
#define WATER(radius)                                                                              \
    "\"particles\": {\"radius\": " radius ", \"fill\": [{\"box\": {\"minimum\": [0, 0, 0],"        \
    " \"maximum\": [0.41, 0.31, 0.31]}}]}"

/* Beside the checked body, with the same constraint: bodies on the same neighbour lists. */
#define BESIDE(radius)                                                                             \
    ", {\"name\": \"beside\", \"particles\": {\"radius\": " radius ", \"rest_density\": 500,"      \
    " \"fill\": [{\"box\": {\"minimum\": [0.4, 0, 0], \"maximum\": [0.61, 0.31, 0.31]}}]}, "

#define BLOCK(cells)                                                                               \
    "\"volume\": {\"grid\": {\"size\": [0.4, 0.2, 0.3], \"cells\": " cells "},"                    \
    " \"rotate\": [20, 30, 10], \"density\": 300}"

static bool needs_other(const pdyn_constraint_type *type) {
    return type->flags & PDYN_NEIGHBOURS /* a sheet through its particles */
           || type_ties_to_other(type);
}

static void write_scene(FILE *text, const struct trial_scene *scene) {
    static const char *const bodies[BODY_KINDS][SIZES] = {
        [SURFACE] = {SHEET("[5, 6]"), SHEET("[46, 46]")},
        [PARTICLES] = {WATER("0.05"), WATER("0.0125")},
        [VOLUME] = {BLOCK("[2, 1, 2]"), BLOCK("[10, 10, 10]")}};
    static const char *const drops[SIZES] = {DROPS("0.05"), DROPS("0.0125")};
    static const char *const effort[SIZES] = {
        "\"linear_tolerance\": 1e-12, \"tolerance\": 1e-6, \"linear_iterations\": 100000",
        "\"linear_iterations\": 20, \"outer_iterations\": 2"};
    static const char *const besides[SIZES] = {BESIDE("0.05"), BESIDE("0.0125")};
    enum body_kind kind = scene->check->kind;
    bool other = kind != PARTICLES || needs_other(scene->type);
    fprintf(text,
            "{\"duration\": 1, \"time_step\": {\"fixed\": 0.004}, \"frame_interval\": 0.004,"
            " \"solver\": {\"type\": \"%s\", \"step\": \"%s\", %s},"
            " \"bodies\": [%s, {\"name\": \"b\", %s, ",
            scene->solver, scene->step, effort[scene->size], other ? OTHER : drops[scene->size],
            bodies[kind][scene->size]);
    write_constraint(text, scene);
    if (scene->type->matrix_free) {
        fprintf(text, "%s", besides[scene->size]);
        write_constraint(text, scene);
    }
    fprintf(text, "]}");
}

/* ---- reading --------------------------------------------------------------------------------- */

/* The text of the scene, which the caller frees; NULL: no memory. */
static char *compose(const struct trial_scene *scene) {
    char *text = NULL;
    size_t size;
    struct text_locale locale;
    FILE *file = open_memstream(&text, &size);
    if (!file) return NULL;
    bool plain = text_begin(&locale);
    write_scene(file, scene);
    if (plain) text_end(&locale);
    if (!fclose(file) && plain) return text;
    free(text);
    return NULL;
}

static pdyn_status parse(pdyn_context *context, const struct trial_scene *scene, pdyn_scene **out) {
    char *text = compose(scene);
    if (!text) return context_no_memory(context);
    pdyn_status status = pdyn_scene_parse(context, text, "a scene for this type", out);
    free(text);
    return status;
}

pdyn_status trial_load(pdyn_context *context, const struct trial_scene *scene, pdyn_sim **out) {
    pdyn_scene *parsed = NULL;
    pdyn_status status = parse(context, scene, &parsed);
    if (status == PDYN_OK) status = pdyn_scene_load(parsed, out);
    pdyn_scene_free(parsed);
    return status;
}

bool trial_is_refused(const struct check *check) {
    const struct trial_scene scene = {check, check->type, SMALL, "auto", "newton"};
    pdyn_context *context = trial_context(check->like, 1);
    pdyn_scene *parsed = NULL;
    struct scene read;
    if (!context) return false;
    pdyn_status status = parse(context, &scene, &parsed);
    if (status == PDYN_OK) status = scene_read(&parsed->json, &read);
    if (status == PDYN_OK) scene_free(context, &read);
    pdyn_scene_free(parsed);
    pdyn_destroy(context);
    return status == PDYN_BAD_INPUT;
}
