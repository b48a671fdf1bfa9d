/* Trials: scenes on which types and solvers are checked, at a random state near rest. */
#include "conformance.h"

#include "base/param_kind.h"
#include "base/text.h"

#include "projdyn/control.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Writes the body and the parameters of a trial, as " (surface, not the default of "one")". */
static void describe(const struct check *check, char *text, size_t size) {
    static const char *const bodies[] = {"surface", "particles", "volume"};
    text_append(text, size, " (%s%s", bodies[check->kind],
                check->form.exchanged ? ", not the default of" : "");
    for (const pdyn_param *p = check->type->params; p->name; p++)
        if (p->kind == PDYN_BOOL && trial_exchanges(check, check->type, p))
            text_append(text, size, " \"%s\"", p->name);
    text_append(text, size, "%s)", check->form.many_rows ? ", two rows per vertex" : "");
}

void fault(struct check *check, const char *format, ...) {
    char what[768], text[1280], trial[256] = "";
    va_list args;
    va_start(args, format);
    vsnprintf(what, sizeof what, format, args);
    va_end(args);
    const char *name = check->type ? check->type->name : check->solver->name;
    if (check->type) describe(check, trial, sizeof trial);
    snprintf(text, sizeof text, "%s%s: %s", name, trial, what);
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
            if (param_is_table(p) && !param_vertices(p) && param_is_changeable(type, p))
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

static pdyn_status load(struct trial *t, const struct trial_scene *scene) {
    pdyn_context *c = t->context;
    enum strain strain = scene->check->strain;
    pdyn_status status = trial_load(c, scene, &t->sim);
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
    const struct trial_scene scene = {check, type, SMALL, solver, "newton"};
    *t = (struct trial){.context = trial_context(check->like, 1)};
    if (!t->context) return false;
    pdyn_status status = load(t, &scene);
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
