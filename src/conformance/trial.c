/* The scenes on which types and solvers are checked: written from a type's parameter table, loaded,
 * and set to a random state near rest. */
#include "conformance.h"

#include "base/param_kind.h"
#include "base/text.h"

#include "projdyn/control.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void fault(struct check *check, const char *format, ...) {
    static const char *const bodies[] = {"surface", "particles", "volume"};
    char what[768], text[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(what, sizeof what, format, args);
    va_end(args);
    const char *name = check->type ? check->type->name : check->solver->name;
    if (check->type)
        snprintf(text, sizeof text, "%s (%s%s): %s", name, bodies[check->kind],
                 check->switched ? ", true and false exchanged" : "", what);
    else snprintf(text, sizeof text, "%s: %s", name, what);
    check->faults++;
    if (check->tell) check->tell(check->user, text);
}

double trial_random(uint64_t *seed) {
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 33) / (double)(1u << 30) - 1.0;
}

double trial_dot(const double *a, const double *b, int n) {
    double sum = 0.0;
    for (int k = 0; k < n; k++) sum += a[k] * b[k];
    return sum;
}

double trial_norm(const double *a, int n) { return sqrt(trial_dot(a, a, n)); }

double trial_distance(const double *a, const double *b, int n) {
    double sum = 0.0;
    for (int k = 0; k < n; k++) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sqrt(sum);
}

bool trial_differ(const double *a, const double *b, int n, double tolerance) {
    return !(trial_distance(a, b, n) <= tolerance * trial_norm(b, n));
}

/* ---- the text of a scene --------------------------------------------------------------------- */

/* A required parameter gets 10 clamped to its bounds, others their default. */
static double value_for(const pdyn_param *p) {
    return p->required ? fmin(p->max, fmax(p->min, 10.0)) : p->def;
}

/* By parameter kind; arguments: the name, then three times the value. */
static const char *const format_of[] = {[PDYN_REAL] = ", \"%s\": %.17g",
                                        [PDYN_INT] = ", \"%s\": %.0f",
                                        [PDYN_VECTOR] = ", \"%s\": [%.17g, %.17g, %.17g]",
                                        [PDYN_VERTICES] = ", \"%s\": {\"vertices\": [0, 4]}",
                                        [PDYN_PATH] = ", \"%s\": [[0, 0, 0, 0], [1, 0.1, 0, 0]]",
                                        [PDYN_OTHER] = ", \"%s\": \"other\""};

/* The vertex in a column of a row: those of the first cell of the grid, which span it, then further
 * ones, moved along x from row to row. Rows of one vertex go around the cell as a closed curve. */
static int vertex_for(const pdyn_param *p, enum body_kind kind, enum trial_size size, int row,
                      int column) {
    static const int cell[BODY_KINDS][SIZES][4] = {
        [SURFACE] = {{0, 1, 5, 6}, {0, 1, 46, 47}},
        [VOLUME] = {{0, 1, 3, 6}, {0, 1, 11, 121}}}; /* beside each other along x, y, z */
    static const int around[4] = {0, 1, 3, 2};
    const int *corner = cell[kind][size];
    if (param_vertices(p) == 1) return corner[around[row]];
    return row + (column < 4 ? corner[column] : corner[3] + column);
}

static void write_row(char *text, size_t size, const pdyn_param *p, enum body_kind kind,
                      enum trial_size trial, int row) {
    const char *before = param_width(p) > 1 ? "[" : "";
    for (int k = 0; k < param_width(p); k++, before = ", ")
        text_append(text, size, "%s%.17g", before,
                    k < param_vertices(p) ? vertex_for(p, kind, trial, row, k) : value_for(p));
    if (param_width(p) > 1) text_append(text, size, "]");
}

/* Writes a required table: one row for all parts of the body, or two rows with vertices, four if
 * they have one vertex each. */
static void write_table(char *text, size_t size, const pdyn_param *p, enum body_kind kind,
                        enum trial_size trial) {
    bool listed = param_vertices(p) && !param_rows(p, 1, 1, 1);
    int rows = !listed ? 1 : param_vertices(p) == 1 ? 4 : 2;
    text_append(text, size, ", \"%s\": %s", p->name, listed ? "[" : "");
    for (int row = 0; row < rows; row++) {
        if (row) text_append(text, size, ", ");
        write_row(text, size, p, kind, trial, row);
    }
    if (listed) text_append(text, size, "]");
}

/* Writes the required parameters, those that are true or false, and real ones whose default lies
 * within the bounds (others have no default). */
static void write_params(char *text, size_t size, const struct check *check,
                         const pdyn_constraint_type *type, enum trial_size trial) {
    for (const pdyn_param *p = type->params; p->name; p++) {
        bool given = p->required || (p->kind == PDYN_REAL && isfinite(p->def) && p->def >= p->min &&
                                     p->def <= p->max);
        size_t length = strlen(text);
        double value = value_for(p);
        bool usual = p->required || p->def != 0.0; /* of one that is true or false */
        if (given && param_is_table(p)) write_table(text, size, p, check->kind, trial);
        else if (p->kind == PDYN_BOOL)
            text_append(text, size, ", \"%s\": %s", p->name,
                        usual != check->switched ? "true" : "false");
        else if (given)
            snprintf(text + length, size - length, format_of[p->kind], p->name, value, value,
                     value);
    }
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
    " \"fill\": [{\"box\": {\"minimum\": [0.4, 0, 0], \"maximum\": [0.61, 0.31, 0.31]}}]},"        \
    " \"constraints\": [{\"type\": \"%s\"%s}]}"

#define BLOCK(cells)                                                                               \
    "\"volume\": {\"grid\": {\"size\": [0.4, 0.2, 0.3], \"cells\": " cells "},"                    \
    " \"rotate\": [20, 30, 10], \"density\": 300}"

static bool needs_other(const pdyn_constraint_type *type) {
    return type->flags & PDYN_NEIGHBOURS /* a sheet through its particles */
           || type_ties_to_other(type);
}

void trial_scene(char text[TRIAL_TEXT], const struct check *check, const pdyn_constraint_type *type,
                 enum trial_size size, const char *solver, const char *step) {
    static const char *const bodies[BODY_KINDS][SIZES] = {
        [SURFACE] = {SHEET("[5, 6]"), SHEET("[46, 46]")},
        [PARTICLES] = {WATER("0.05"), WATER("0.0125")},
        [VOLUME] = {BLOCK("[2, 1, 2]"), BLOCK("[10, 10, 10]")}};
    static const char *const drops[SIZES] = {DROPS("0.05"), DROPS("0.0125")};
    static const char *const effort[SIZES] = {
        "\"linear_tolerance\": 1e-12, \"tolerance\": 1e-6, \"linear_iterations\": 100000",
        "\"linear_iterations\": 20, \"outer_iterations\": 2"};
    static const char *const besides[SIZES] = {BESIDE("0.05"), BESIDE("0.0125")};
    enum body_kind kind = check->kind;
    const char *first = kind == PARTICLES && !needs_other(type) ? drops[size] : OTHER;
    char params[TRIAL_TEXT / 4] = "", beside[TRIAL_TEXT / 3] = "";
    write_params(params, sizeof params, check, type, size);
    if (type->matrix_free) snprintf(beside, sizeof beside, besides[size], type->name, params);
    snprintf(text, TRIAL_TEXT,
             "{\"duration\": 1, \"time_step\": {\"fixed\": 0.004}, \"frame_interval\": 0.004,"
             " \"solver\": {\"type\": \"%s\", \"step\": \"%s\", %s},"
             " \"bodies\": [%s, {\"name\": \"b\", %s, \"constraints\": [{\"type\": \"%s\"%s}]}%s]}",
             solver, step, effort[size], first, bodies[kind][size], type->name, params, beside);
}

/* ---- trials ---------------------------------------------------------------------------------- */

pdyn_context *trial_context(const pdyn_context *like, int threads) {
    pdyn_options options = like->options;
    pdyn_context *context = NULL;
    options.threads = threads, options.log = NULL;
    if (pdyn_create(&options, &context) != PDYN_OK) return NULL;
    context->plugins = like->plugins;
    memcpy(context->plugin, like->plugin, sizeof like->plugin);
    return context;
}

/* A deformation of space per strain: x -> F x, by rows. */
static const double deformation[STRAINS][9] = {[COMPRESSED] = {0.97, 0, 0, 0, 0.97, 0, 0, 0, 0.97},
                                               [STRETCHED] = {1.02, 0, 0, 0, 1.02, 0, 0, 0, 1.02},
                                               [SHEARED] = {1, 0.08, -0.05, 0, 1, 0.06, 0, 0, 1},
                                               [CRUMPLED] = {1, 0, 0, 0, 1, 0, 0, 0, 1}};

static const double shift[STRAINS] = {[SHEARED] = -0.1}; /* m: through floors and out of pins */

static const double noise[STRAINS] = {0.002, 0.002, 0.002, [CRUMPLED] = 0.05}; /* m */

/* Takes a step to y: y random near x. Afterwards elements have memory of another state than x. */
static pdyn_status leave_memory(struct trial *t, const struct step_start *start) {
    uint64_t seed = 17;
    double energy;
    for (int k = 0; k < t->n; k++) t->y[k] = t->x[k] + 0.01 * trial_random(&seed);
    pdyn_status status = objective_begin(&t->sim->objective, start);
    if (status == PDYN_OK) status = objective_local(&t->sim->objective, t->y, &energy, t->gradient);
    return status == PDYN_OK ? objective_end(&t->sim->objective) : status;
}

/* Deformed and disturbed x, random v, s and direction u; then the local step at x. The memory of
 * elements is zero in one of the states alone. */
static pdyn_status disturb(struct trial *t, enum strain strain) {
    struct objective *objective = &t->sim->objective;
    pdyn_status status = PDYN_OK;
    uint64_t seed = 7;
    double energy;
    for (int k = 0; k < t->n; k++) {
        const double *row = deformation[strain] + 3 * (k % 3), *from = t->sim->x + 3 * (k / 3);
        t->x[k] = row[0] * from[0] + row[1] * from[1] + row[2] * from[2] + shift[strain] +
                  noise[strain] * trial_random(&seed);
        t->u[k] = trial_random(&seed);
        objective->s[k] = t->sim->x[k] + 0.01 * trial_random(&seed);
    }
    for (int k = 0; k < t->n; k++) t->sim->v[k] = trial_random(&seed);
    objective->h = objective->length = 0.004;
    const double *x = t->sim->x, *v = t->sim->v;
    const struct step_start start = {x, v, NULL, x, v};
    if (t->batch->type->end && strain != COMPRESSED) status = leave_memory(t, &start);
    if (status == PDYN_OK) status = objective_begin(objective, &start);
    return status == PDYN_OK ? objective_local(objective, t->x, &energy, t->gradient) : status;
}

/* A number near `value` that the table may contain. */
static double vary(const pdyn_param *p, double value, uint64_t *seed) {
    double near = value + 0.2 * (1.0 + fabs(value)) * trial_random(seed);
    return fmin(p->max, fmax(p->min, near));
}

static pdyn_status vary_table(pdyn_sim *sim, int constraint, const pdyn_param *p) {
    pdyn_vector_info table = {0};
    uint64_t seed = 13;
    for (int k = 0; !table.name || strcmp(table.name, p->name); k++)
        table = pdyn_get_vector(sim, constraint, k);
    if (!table.count) return PDYN_OK;
    double *value = NEW_ARRAY(sim->context, table.count, double);
    if (!value) return PDYN_NO_MEMORY;
    for (int k = 0; k < table.count; k++) value[k] = vary(p, table.value[k], &seed);
    pdyn_status status = pdyn_set_parameter(sim, constraint, p->name, value, table.count);
    FREE_ARRAY(sim->context, value, table.count);
    return status == PDYN_BAD_INPUT ? PDYN_OK : status; /* other rows have other elements */
}

pdyn_status trial_vary_tables(pdyn_sim *sim) {
    pdyn_status status = PDYN_OK;
    for (int k = 0; k < sim->constraints; k++) {
        const pdyn_constraint_type *type = sim->objective.batch[k]->type;
        for (const pdyn_param *p = type->params; p->name && status == PDYN_OK; p++)
            if (param_is_table(p) && param_rows(p, 1, 1, 1) && !param_vertices(p) &&
                param_is_changeable(type, p))
                status = vary_table(sim, k, p);
    }
    return status;
}

/* Makes numbers larger by a third, those that may change: a type that is right for its defaults
 * alone shows. */
static pdyn_status scale_numbers(pdyn_sim *sim, int constraint) {
    pdyn_status status = PDYN_OK;
    for (int k = 0; status == PDYN_OK; k++) {
        pdyn_parameter_info p = pdyn_get_parameter(sim, constraint, k);
        double value = fmin(p.maximum, fmax(p.minimum, 4.0 / 3.0 * p.value));
        if (!p.name) break;
        if (p.changeable) status = pdyn_set_parameter(sim, constraint, p.name, &value, 1);
        if (status == PDYN_BAD_INPUT) status = PDYN_OK; /* not a whole number, other elements */
    }
    return status;
}

static pdyn_status load(struct trial *t, enum strain strain, const char *scene) {
    pdyn_context *c = t->context;
    pdyn_status status = pdyn_load_text(c, scene, "a scene for this type", NULL, 0, &t->sim);
    if (status == PDYN_OK) status = trial_vary_tables(t->sim);
    for (int k = 0; status == PDYN_OK && strain == SHEARED && k < t->sim->constraints; k++)
        status = scale_numbers(t->sim, k);
    if (status != PDYN_OK) return status;
    t->batch = t->rows = t->sim->objective.batch[0];
    t->n = 3 * t->sim->objective.particles;
    double **vectors[] = {&t->x, &t->gradient, &t->u, &t->y, &t->z, &t->w};
    for (size_t k = 0; k < sizeof vectors / sizeof *vectors; k++)
        if (!(*vectors[k] = NEW_VECTOR(c, t->n / 3))) return PDYN_NO_MEMORY;
    t->da = NEW_ARRAY(c, 2 * (size_t)t->n, double), t->db = NEW_ARRAY(c, 2 * (size_t)t->n, double);
    if (!t->da || !t->db) return PDYN_NO_MEMORY;
    status = disturb(t, strain);
    if (status == PDYN_OK && t->batch->op) status = batch_create_rows(t->batch, &t->rows);
    return status;
}

static void release(struct trial *t) {
    pdyn_context *c = t->context;
    if (t->rows != t->batch) batch_free(t->rows);
    double **vectors[] = {&t->x, &t->gradient, &t->u, &t->y, &t->z, &t->w};
    for (size_t k = 0; k < sizeof vectors / sizeof *vectors; k++)
        FREE_VECTOR(c, *vectors[k], t->n / 3);
    FREE_ARRAY(c, t->da, 2 * (size_t)t->n);
    FREE_ARRAY(c, t->db, 2 * (size_t)t->n);
    pdyn_free(t->sim);
}

bool trial_start(struct trial *t, struct check *check, const pdyn_constraint_type *type,
                 const char *solver) {
    char scene[TRIAL_TEXT];
    *t = (struct trial){.context = trial_context(check->like, 1)};
    if (!t->context) return false;
    trial_scene(scene, check, type, SMALL, solver, "newton");
    pdyn_status status = load(t, check->strain, scene);
    if (status == PDYN_OK) return true;
    fault(check, "%s", pdyn_last_error(t->context));
    release(t);
    pdyn_destroy(t->context);
    return false;
}

void trial_finish(struct trial *t, struct check *check) {
    release(t);
    if (t->context->bytes)
        fault(check, "%zu bytes of the services' memory were not given back", t->context->bytes);
    pdyn_destroy(t->context);
}
