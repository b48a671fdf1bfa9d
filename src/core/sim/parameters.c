#include "parameters.h"

#include "base/bad_call.h"
#include "base/text.h"
#include "forces.h"
#include "scene/derived.h"
#include "scene/hint.h"
#include "scene/keyed.h"
#include "scene/params.h"
#include "scene/table.h"
#include "schedule.h"
#include "sim.h"

#include "projdyn/control.h"

#include <math.h>
#include <string.h>

enum { LARGEST = 3, NAMES = 64 }; /* numbers of a value other than a path; parameters of a type */

/* ---- all batches of a constraint ------------------------------------------------------------- */

static bool is_damped(const struct batch *b) {
    return b->type->damping && b->type->damping(b->params) > 0.0;
}

static bool has_damper(const struct pdyn_sim *sim, int constraint) {
    const struct objective *objective = &sim->objective;
    const struct batch *changed = objective->batch[constraint];
    bool found = false;
    for (int b = 0; b < objective->batches; b++)
        found |= objective->batch[b]->damper && batch_belongs_to(objective->batch[b], changed);
    return found;
}

/* The parameter as it was given, before the type computes others from it. */
static void *given_field(const struct pdyn_sim *sim, int constraint, const pdyn_param *p) {
    return (char *)derived_given(sim->constraint[constraint]) + p->offset;
}

/* Refreshes the constraint and its damper. Solvers stay where only the projection has changed. */
static pdyn_status refresh(struct pdyn_sim *sim, int constraint) {
    struct objective *objective = &sim->objective;
    const struct batch *changed = objective->batch[constraint];
    pdyn_status status = PDYN_OK;
    for (int b = 0; b < objective->batches && status == PDYN_OK; b++)
        if (batch_belongs_to(objective->batch[b], changed))
            status = batch_refresh(objective->batch[b], &sim->control.stale);
    forces_forget(sim);
    return status;
}

static void switch_batches(struct pdyn_sim *sim, int constraint, bool off) {
    struct objective *objective = &sim->objective;
    const struct batch *changed = objective->batch[constraint];
    sim->control.stale |= changed->off != off;
    for (int b = 0; b < objective->batches; b++)
        if (batch_belongs_to(objective->batch[b], changed)) objective->batch[b]->off = off;
}

/* ---- values ---------------------------------------------------------------------------------- */

static pdyn_status fail_unknown(const struct batch *b, const char *name) {
    const char *names[NAMES];
    char hint[512] = "", clipped[128];
    int count = 0;
    for (const pdyn_param *p = b->type->params; p->name && count < NAMES; p++)
        if (param_is_changeable(b->type, p)) names[count++] = p->name;
    hint_append(hint, sizeof hint, name, names, count);
    text_clip(clipped, sizeof clipped, name);
    return set_error(PDYN_BAD_INPUT,
                     "constraint \"%s\" on body \"%s\": no parameter \"%s\" that can be changed "
                     "while the simulation runs%s",
                     b->type->name, b->view.body->name, clipped, hint);
}

static pdyn_status fail_value(const struct batch *b, const pdyn_param *p, const char *expected) {
    return set_error(PDYN_BAD_INPUT, "constraint \"%s\" on body \"%s\": %s: expected %s",
                     b->type->name, b->view.body->name, p->name, expected);
}

/* Checks one or three numbers. */
static pdyn_status check_value(const struct batch *b, const pdyn_param *p, const double *value,
                               int count) {
    char expected[160] = "";
    int numbers = param_numbers(p), fit = 0;
    while (fit < count && value[fit] >= p->min && value[fit] <= p->max) fit++;
    if (count == numbers && fit == numbers) return PDYN_OK;
    params_describe_bounds(expected, sizeof expected, numbers == 1 ? "a number" : "3 numbers",
                           p->min, p->max, p->unit);
    if (count == numbers) text_append(expected, sizeof expected, ", found %.10g", value[fit]);
    else
        text_append(expected, sizeof expected, ", found %d number%s", count, count == 1 ? "" : "s");
    return fail_value(b, p, expected);
}

static pdyn_status check_path(const struct batch *b, const pdyn_param *p, const double *value,
                              int count) {
    bool good = count > 0 && count % 4 == 0;
    for (int k = 0; good && k < count; k++) good = fabs(value[k]) <= SCENE_MAX_POSITION;
    for (int k = 4; good && k < count; k += 4) good = value[k] > value[k - 4];
    return good ? PDYN_OK
                : fail_value(b, p, "4 finite numbers for each key: an ascending time and a vector");
}

/* Computes the parameters that depend on changed ones, and checks the rules of the type. */
static pdyn_status derive(struct pdyn_sim *sim, int constraint) {
    const struct batch *b = sim->objective.batch[constraint];
    pdyn_param_fault fault = derived_compute(sim->constraint[constraint]);
    bool damped = has_damper(sim, constraint);
    if (fault.message)
        return set_error(PDYN_BAD_INPUT, "constraint \"%s\" on body \"%s\": %s%s%s", b->type->name,
                         b->view.body->name, fault.param ? fault.param : "",
                         fault.param ? ": " : "", fault.message);
    if (is_damped(b) == damped) return PDYN_OK;
    return set_error(PDYN_BAD_INPUT, "constraint \"%s\" on body \"%s\": damping must stay %s",
                     b->type->name, b->view.body->name,
                     damped ? "above 0 while the simulation runs"
                            : "0 while the simulation runs: to change it, give it a value above "
                              "0 in the scene");
}

/* Writes `size` bytes into a parameter; writes the old ones back where the constraint does not
 * accept them. */
static pdyn_status exchange(struct pdyn_sim *sim, int constraint, void *field, const void *next,
                            size_t size) {
    double before[LARGEST];
    memcpy(before, field, size), memcpy(field, next, size);
    pdyn_status status = derive(sim, constraint);
    bool refused = status != PDYN_OK;
    if (!refused) status = refresh(sim, constraint);
    if (status == PDYN_OK) return PDYN_OK;
    memcpy(field, before, size);
    derived_compute(sim->constraint[constraint]);
    if (refused) return status;
    return refresh(sim, constraint) == PDYN_NO_MEMORY ? PDYN_NO_MEMORY : status;
}

/* A path is read in every step: without parameters that depend on it, nothing else changes. */
static pdyn_status set_path(struct pdyn_sim *sim, int constraint, const pdyn_param *p,
                            const double *value, int count) {
    pdyn_path *field = given_field(sim, constraint, p), before = *field, next = {0};
    pdyn_status status = keyed_set_path(sim->context, &next, value, count / 4);
    if (status != PDYN_OK) return status;
    if (!sim->constraint[constraint]->given) *field = next;
    else status = exchange(sim, constraint, field, &next, sizeof next);
    keyed_free_path(sim->context, status == PDYN_OK ? &before : &next);
    return status;
}

/* ---- tables ---------------------------------------------------------------------------------- */

static int rows_of(const struct batch *b, const pdyn_param *p) {
    const pdyn_body *body = b->view.body;
    return param_rows(p, body->count, body->triangles, body->tets);
}

/* The first number that the table may not contain; `count`: all are allowed. */
static int find_wrong(const struct batch *b, const pdyn_param *p, const double *value, int count) {
    int width = param_width(p), k = 0;
    while (k < count &&
           table_allows(p, value + k - k % width, k % width, value[k], b->view.body->count))
        k++;
    return k;
}

static bool has_rows(const pdyn_param *p, int rows, int count) {
    int width = param_width(p);
    if (count <= 0 || count % width) return false;
    return !rows || count == width || count / width == rows;
}

/* Checks all rows, or one row for all. */
static pdyn_status check_table(const struct batch *b, const pdyn_param *p, const double *value,
                               int count) {
    char expected[256] = "";
    int rows = rows_of(b, p), width = param_width(p), vertices = param_vertices(p);
    bool sized = has_rows(p, rows, count);
    int wrong = sized ? find_wrong(b, p, value, count) : 0;
    if (sized && wrong == count) return PDYN_OK;
    table_describe(expected, sizeof expected, p, rows, NULL);
    if (rows) text_append(expected, sizeof expected, ", or one row for all");
    if (vertices)
        text_append(expected, sizeof expected, ", the first %d different vertices from 0 to %d",
                    vertices, b->view.body->count - 1);
    if (vertices < width)
        params_describe_bounds(expected, sizeof expected, vertices ? ", the others" : ",", p->min,
                               p->max, p->unit);
    if (sized)
        text_append(expected, sizeof expected, ", found %.10g in row %d", value[wrong],
                    wrong / width);
    else text_append(expected, sizeof expected, ", found %d numbers", count);
    return fail_value(b, p, expected);
}

/* Sets all rows, or the same in each. */
static pdyn_status set_table(struct pdyn_sim *sim, int constraint, const pdyn_param *p,
                             const double *value, int count) {
    const struct batch *b = sim->objective.batch[constraint];
    pdyn_table *field = given_field(sim, constraint, p), before = *field, next = {0};
    int rows = rows_of(b, p), width = param_width(p);
    double *numbers = table_allocate(b->context, p, rows ? rows : count / width, &next);
    if (!numbers) return PDYN_NO_MEMORY;
    for (int k = 0; k < next.count * width; k++) numbers[k] = value[k % count];
    pdyn_status status = exchange(sim, constraint, field, &next, sizeof next);
    table_free(b->context, p, status == PDYN_OK ? &before : &next);
    return status;
}

static pdyn_status set_values(struct pdyn_sim *sim, int constraint, const pdyn_param *p,
                              const double *value, int count) {
    if (p->kind == PDYN_PATH) return set_path(sim, constraint, p, value, count);
    if (param_is_table(p)) return set_table(sim, constraint, p, value, count);
    return exchange(sim, constraint, given_field(sim, constraint, p), value,
                    (size_t)count * sizeof *value);
}

pdyn_status parameters_follow(struct pdyn_sim *sim, int constraint, const pdyn_param *p,
                              const double *value) {
    const void *field = given_field(sim, constraint, p);
    const double *now = param_is_table(p) ? ((const pdyn_table *)field)->value : field;
    int numbers = param_numbers(p);
    bool same = !memcmp(now, value, (size_t)numbers * sizeof *value);
    return same ? PDYN_OK : set_values(sim, constraint, p, value, numbers);
}

/* ---- public functions ------------------------------------------------------------------------ */

pdyn_status pdyn_set_parameter(pdyn_sim *sim, int constraint, const char *name, const double *value,
                               int count) {
    if (HAS_NULL(sim, name, value) || BAD_INDEX(constraint, sim->constraints) ||
        control_refuses(__func__, sim))
        return PDYN_BAD_CALL;
    struct batch *b = sim->objective.batch[constraint];
    const pdyn_param *p = b->type->params;
    while (p->name && (strcmp(p->name, name) != 0 || !param_is_changeable(b->type, p))) p++;
    if (!p->name) return fail_unknown(b, name);
    pdyn_status status = p->kind == PDYN_PATH ? check_path(b, p, value, count)
                         : param_is_table(p)  ? check_table(b, p, value, count)
                                              : check_value(b, p, value, count);
    if (status == PDYN_OK) status = set_values(sim, constraint, p, value, count);
    if (status != PDYN_OK) return status;
    sim->control.driven = true;
    schedule_replace(sim, constraint, p);
    return PDYN_OK;
}

pdyn_status pdyn_enable(pdyn_sim *sim, int constraint, bool enabled) {
    if (HAS_NULL(sim) || BAD_INDEX(constraint, sim->constraints) || control_refuses(__func__, sim))
        return PDYN_BAD_CALL;
    const struct batch *b = sim->objective.batch[constraint];
    if (b->off == !enabled) return PDYN_OK;
    if (b->op)
        return set_error(PDYN_BAD_INPUT,
                         "constraint \"%s\" on body \"%s\" is matrix-free and cannot be "
                         "switched off",
                         b->type->name, b->view.body->name);
    switch_batches(sim, constraint, !enabled);
    sim->control.driven |= enabled; /* a constraint that ends takes its energy, which is not
                                       negative, out of the scene */
    sim->history = 0.0; /* forces jump: BDF2 would continue the accelerations of the step before */
    return refresh(sim, constraint);
}

bool pdyn_is_enabled(const pdyn_sim *sim, int constraint) {
    return sim_has_constraint(sim, constraint) && !sim->objective.batch[constraint]->off;
}

/* ---- saved states ---------------------------------------------------------------------------- */

/* Whether this is the value of a parameter that the scene leaves out, outside of its bounds. */
static bool is_absent(const pdyn_param *p, const double *value, int count) {
    bool absent = !p->required && !param_has_default(p);
    for (int k = 0; k < count; k++) absent = absent && !memcmp(&value[k], &p->def, sizeof p->def);
    return absent;
}

/* Saves or reads a number; returns whether it has changed. */
static bool persist_value(const struct batch *b, const pdyn_param *p, double *field,
                          struct snapshot_file *file) {
    int count = param_numbers(p);
    double before[LARGEST];
    size_t size = (size_t)count * sizeof *field;
    memcpy(before, field, size);
    snapshot_file_bytes(file, field, size);
    bool changed = file->view.reading && memcmp(before, field, size) != 0;
    bool valid =
        !changed || is_absent(p, field, count) || check_value(b, p, field, count) == PDYN_OK;
    if (!valid || file->status != PDYN_OK) memcpy(field, before, size);
    snapshot_file_require(file, valid, "a parameter is out of bounds");
    return changed && valid;
}

/* Writes a table, or reads its rows; whether they have changed. */
static bool persist_table(const struct batch *b, const pdyn_param *p, pdyn_table *field,
                          struct snapshot_file *file) {
    int count = field->count, rows = rows_of(b, p), width = param_width(p);
    size_t row = (size_t)width * sizeof(double);
    snapshot_file_count(file, &count, row, "the number of rows is out of range");
    bool absent = !count && !p->required && !param_has_default(p);
    snapshot_file_require(file, absent || (rows ? count == rows : count > 0),
                          "a table has other rows");
    if (file->status != PDYN_OK) return false;
    if (!file->view.reading)
        return snapshot_file_bytes(file, (double *)field->value, (size_t)count * row), false;
    pdyn_table read = {0};
    double *value = table_allocate(b->context, p, count, &read);
    if (count && !value) return file->status = PDYN_NO_MEMORY, false;
    snapshot_file_bytes(file, value, (size_t)count * row);
    bool valid = find_wrong(b, p, value, count * width) == count * width;
    snapshot_file_require(file, valid, "a number of a table is out of bounds");
    bool changed =
        file->status == PDYN_OK &&
        (count != field->count || (count && memcmp(value, field->value, (size_t)count * row)));
    pdyn_table dropped = changed ? *field : read;
    if (changed) *field = read;
    table_free(b->context, p, &dropped);
    return changed;
}

static void persist_constraint(struct pdyn_sim *sim, int constraint, struct snapshot_file *file) {
    struct batch *b = sim->objective.batch[constraint];
    const struct scene_constraint *c = sim->constraint[constraint];
    bool off = b->off, changed = false;
    snapshot_file_flags(file, &off, 1, "the flag of a constraint is neither 0 nor 1");
    snapshot_file_require(file, !off || !b->op, "a matrix-free constraint is off");
    for (const pdyn_param *p = b->type->params; p->name && file->status == PDYN_OK; p++) {
        void *field = given_field(sim, constraint, p);
        if (!param_is_changeable(b->type, p)) continue;
        if (p->kind == PDYN_PATH) keyed_persist_path(b->context, field, file);
        else if (param_is_table(p)) changed |= persist_table(b, p, field, file);
        else changed |= persist_value(b, p, field, file);
        changed |= p->kind == PDYN_PATH && c->given; /* others may depend on it */
    }
    if (!file->view.reading) return;
    /* After a failure, too: the arrays that `params` points to may have been freed. */
    bool accepted = !derived_compute(c).message;
    snapshot_file_require(file, accepted, "a constraint type refuses its parameters");
    snapshot_file_require(file, is_damped(b) == has_damper(sim, constraint),
                          "damping appears or disappears");
    if (file->status != PDYN_OK || (!changed && off == b->off)) return;
    switch_batches(sim, constraint, off);
    file->status = refresh(sim, constraint);
}

void parameters_persist(struct pdyn_sim *sim, struct snapshot_file *file) {
    for (int k = 0; k < sim->constraints && file->status == PDYN_OK; k++)
        persist_constraint(sim, k, file);
}
