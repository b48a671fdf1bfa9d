/* The report of a run, report.json, composed with jansson. */
#include "base/clock.h"
#include "base/file_out.h"
#include "output.h"
#include "projdyn/vec3.h"
#include "scene/json_file.h"
#include "sim/live_particles.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

/* ---- values ---------------------------------------------------------------------------------- */

/* A number, or null if it is not finite, e.g. a mean over no steps. */
static json_t *real(double value) { return isfinite(value) ? json_real(value) : json_null(); }

static json_t *vector(const double v[3]) {
    return json_pack("[o, o, o]", real(v[0]), real(v[1]), real(v[2]));
}

/* A string; bytes that are not UTF-8, e.g. in names of files, become '?'. */
static json_t *text(pdyn_context *context, const char *from) {
    json_t *value = from ? json_string(from) : json_null();
    if (value) return value;
    size_t size = strlen(from) + 1;
    char *plain = NEW_ARRAY(context, size, char);
    if (!plain) return NULL;
    for (size_t i = 0; from[i]; i++) plain[i] = (unsigned char)from[i] < 0x80 ? from[i] : '?';
    value = json_string(plain);
    FREE_ARRAY(context, plain, size);
    return value;
}

static json_t *mean(const struct report *report, int column) {
    return real(report->stats[column].sum / (double)report->steps);
}

static json_t *mean_max_of(const struct report *report, const struct report_stats *stats) {
    return json_pack("{s:o, s:o}", "mean", real(stats->sum / (double)report->steps), "max",
                     real(stats->max));
}

static json_t *mean_max(const struct report *report, int column) {
    return mean_max_of(report, &report->stats[column]);
}

/* ---- the scene ------------------------------------------------------------------------------- */

/* Numbers of particles. fluid: capacity of the bodies; start, peak, end: live ones. */
static json_t *particles(const struct report *report, const pdyn_sim *sim) {
    const struct live_particles *e = sim->live;
    pdyn_state state = pdyn_get_state(sim);
    int fluid = 0, cloth = 0;
    for (int b = 0; b < state.bodies; b++) {
        pdyn_body_info body = pdyn_get_body(sim, b);
        if (body.triangles) cloth += body.count;
        else fluid += body.count;
    }
    int start = report->start.particles;
    int peak = (int)fmax(start, report->stats[STEP_particles].max);
    return json_pack("{s:i, s:i, s:i, s:i, s:i, s:i, s:I, s:I}", "fluid", fluid, "cloth", cloth,
                     "boundary", state.boundary, "start", start, "peak", peak, "end",
                     report->end.particles, "emitted", (json_int_t)(e ? e->emitted : 0), "removed",
                     (json_int_t)(e ? e->removed : 0));
}

/* A "color" of the scene; NULL: none. */
static const char *color_of(const char color[8]) { return color[0] ? color : NULL; }

static json_t *body(const pdyn_body_info *info, bool rigid, const char *color, json_t *residual) {
    if (info->triangles)
        return json_pack("{s:s, s:s, s:b, s:i, s:i, s:s*, s:o}", "name", info->name, "kind",
                         "surface", "rigid", rigid, "count", info->count, "triangles",
                         info->triangles, "color", color, "step_residual", residual);
    return json_pack("{s:s, s:s, s:i, s:o, s:o, s:s*, s:o}", "name", info->name, "kind",
                     "particles", "count", info->count, "radius_m", real(info->radius),
                     "rest_density", real(info->rest_density), "color", color, "step_residual",
                     residual);
}

static json_t *bodies(const struct report *report, const pdyn_sim *sim) {
    json_t *list = json_array();
    for (int b = 0; list && b < sim->bodies; b++) {
        pdyn_body_info info = pdyn_get_body(sim, b);
        json_t *residual = mean_max_of(report, &report->residual[b]);
        const char *color = color_of(sim->scene.body[b].color);
        bool rigid = sim->scene.body[b].is_rigid;
        if (json_array_append_new(list, body(&info, rigid, color, residual)))
            return json_decref(list), NULL;
    }
    return list;
}

/* Number of elements per constraint type, over all bodies. */
static json_t *constraints(const pdyn_sim *sim) {
    json_t *object = json_object();
    int count = pdyn_get_state(sim).constraints;
    for (int b = 0; object && b < count; b++) {
        pdyn_constraint_info info = pdyn_get_constraint(sim, b);
        json_int_t before = json_integer_value(json_object_get(object, info.type));
        if (json_object_set_new(object, info.type, json_integer(before + info.elements)))
            return json_decref(object), NULL;
    }
    return object;
}

static json_t *parameters_of(const pdyn_sim *sim, int constraint) {
    pdyn_constraint_info info = pdyn_get_constraint(sim, constraint);
    json_t *numbers = json_object();
    pdyn_parameter_info p;
    for (int k = 0; numbers && (p = pdyn_get_parameter(sim, constraint, k)).name; k++)
        if (json_object_set_new(numbers, p.name, real(p.value))) return json_decref(numbers), NULL;
    return json_pack("{s:s, s:s, s:o}", "type", info.type, "body", info.body, "numbers", numbers);
}

/* The numeric parameters of every constraint, computed ones included. */
static json_t *parameters(const pdyn_sim *sim) {
    json_t *list = json_array();
    int count = pdyn_get_state(sim).constraints;
    for (int k = 0; list && k < count; k++)
        if (json_array_append_new(list, parameters_of(sim, k))) return json_decref(list), NULL;
    return list;
}

/* ---- the run --------------------------------------------------------------------------------- */

static json_t *milliseconds(const struct report *report) {
    return json_pack("{s:o, s:o, s:o, s:o, s:o}", "neighbours", mean(report, STEP_ms_neighbours),
                     "local", mean(report, STEP_ms_local), "global", mean(report, STEP_ms_global),
                     "contact", mean(report, STEP_ms_contact), "output",
                     real(report->output_ms / (double)report->steps));
}

static json_t *density_error(const struct report *report) {
    return json_pack("{s:o, s:o, s:o, s:o}", "mean", mean(report, STEP_density_error_mean),
                     "worst_mean", real(report->stats[STEP_density_error_mean].max), "mean_max",
                     mean(report, STEP_density_error_max), "max",
                     real(report->stats[STEP_density_error_max].max));
}

static json_t *time_step(const struct report *report, const pdyn_sim *sim) {
    return json_pack("{s:s, s:o, s:o, s:o}", "integrator", pdyn_integrator(sim), "min",
                     real(report->stats[STEP_h_s].min), "mean", mean(report, STEP_h_s), "max",
                     real(report->stats[STEP_h_s].max));
}

static json_t *energy(const pdyn_step_info *info) {
    double total = info->kinetic_energy + info->potential_energy + info->constraint_energy;
    return json_pack("{s:o, s:o, s:o, s:o}", "kinetic", real(info->kinetic_energy), "potential",
                     real(info->potential_energy), "constraint", real(info->constraint_energy),
                     "total", real(total));
}

static double peak_rss_bytes(void) {
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage); /* cannot fail for the current process */
    return 1024.0 * (double)usage.ru_maxrss;
}

static json_t *describe_scene(const struct report *report, const pdyn_sim *sim) {
    return json_pack("{s:s, s:o, s:o, s:s, s:i, s:o, s:o, s:o, s:o, s:{s:s, s:s, s:o, s:I}}",
                     "version", pdyn_version(), "scene", text(sim->context, sim->scene.file),
                     "name", text(sim->context, sim->scene.name), "up",
                     sim->scene.settings.z_up ? "z" : "y", "threads",
                     pdyn_thread_count(sim->context), "particles", particles(report, sim), "bodies",
                     bodies(report, sim), "constraints", constraints(sim), "parameters",
                     parameters(sim), "solver", "type", pdyn_solver_type(sim), "step",
                     pdyn_step_type(sim), "reason", text(sim->context, pdyn_solver_reason(sim)),
                     "dual_steps", (json_int_t)sim->choice.dual_steps);
}

static json_t *describe_run(const struct report *report, const pdyn_sim *sim) {
    double wall_ms = clock_ms() - report->opened_ms;
    return json_pack(
        "{s:I, s:I, s:o, s:o, s:o, s:o, s:o, s:I, s:I}", "steps", (json_int_t)report->steps,
        "unsolved_steps", (json_int_t)report->unsolved, "simulated_s", real(pdyn_time(sim)),
        "wall_s", real(1e-3 * wall_ms), "ms_per_step", real(wall_ms / (double)report->steps), "ms",
        milliseconds(report), "time_step", time_step(report, sim), "peak_memory_bytes",
        (json_int_t)pdyn_peak_bytes(sim->context), "peak_rss_bytes", (json_int_t)peak_rss_bytes());
}

static json_t *describe_result(const struct report *report, const pdyn_sim *sim) {
    pdyn_step_info start = report->start;
    const pdyn_step_info *end = &report->end;
    start.constraint_energy = energy_budget_constraints(sim);
    const double *pin = end->pin_reaction;
    char hash[17];
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)pdyn_state_hash(sim));
    return json_pack(
        "{s:o, s:o, s:o, s:o, s:o, s:o, s:{s:o, s:o}, s:{s:o, s:o}, s:o, s:o, s:I, s:s}", "impacts",
        mean_max(report, STEP_impacts), "retries", real(report->stats[STEP_retries].sum),
        "outer_iterations", mean_max(report, STEP_outer_iterations), "linear_iterations",
        mean_max(report, STEP_linear_iterations), "density_error", density_error(report),
        "step_residual", mean_max(report, STEP_step_residual), "energy", "start", energy(&start),
        "end", energy(end), "momentum", "start", vector(start.momentum), "end",
        vector(end->momentum), "pin_reaction_N", real(vec3_length(pin)), "pin_reaction",
        vector(pin), "leaked", (json_int_t)end->leaked, "state_hash", hash);
}

/* A solid, the file of its mesh and the load on it; null where the load is unknown: no step was
 * made, or the last one failed. */
static json_t *solid(const struct scene_solid *s, const struct load *load) {
    static const struct load unknown = {{NAN, NAN, NAN}, {NAN, NAN, NAN}};
    if (!load) load = &unknown;
    return json_pack("{s:s, s:s, s:b, s:s++, s:s*, s:o, s:o}", "name", s->name, "kind",
                     scene_solid_kinds[s->kind], "moving", s->motion.keys > 0, "file",
                     SOLIDS_FOLDER, s->name, s->motion.keys ? SERIES_ENDING : SHAPE_ENDING, "color",
                     color_of(s->color), "force_N", vector(load->force), "moment_Nm",
                     vector(load->moment));
}

static json_t *solids(const pdyn_sim *sim) {
    const struct load *loads = solid_load_compute(sim, PDYN_LOAD_ALL);
    json_t *list = json_array();
    for (int k = 0; list && k < sim->scene.solids; k++)
        if (json_array_append_new(list, solid(&sim->scene.solid[k], loads ? loads + k : NULL)))
            return json_decref(list), NULL;
    return list;
}

/* The warnings, as pdyn_get_warning gives them. */
static json_t *warnings(const pdyn_sim *sim) {
    json_t *list = json_array();
    pdyn_warning w;
    for (int k = 0; list && (w = pdyn_get_warning(sim, k)).code; k++) {
        json_t *one = json_pack("{s:s, s:s, s:s, s:I, s:o, s:o}", "code", w.code, "subject",
                                w.subject, "text", w.text, "count", (json_int_t)w.count, "first_s",
                                real(w.first), "last_s", real(w.last));
        if (json_array_append_new(list, one)) return json_decref(list), NULL;
    }
    return list;
}

json_t *report_scene(const struct report *report, const pdyn_sim *sim) {
    json_t *root = describe_scene(report, sim);
    if (root && !json_object_set_new(root, "solids", solids(sim)) &&
        !json_object_set_new(root, "strings", report_strings(sim)))
        return root;
    json_decref(root);
    return NULL;
}

/* Composes the report as JSON text. NULL: no memory. */
static char *compose(const struct report *report, const pdyn_sim *sim, bool interrupted,
                     const char *failed) {
    json_t *root = report_scene(report, sim), *run = describe_run(report, sim);
    json_t *result = describe_result(report, sim);
    char *dump = NULL;
    if (root && run && result && !json_object_update(root, run) &&
        !json_object_update(root, result) &&
        !json_object_set_new(root, "warnings", warnings(sim)) &&
        !json_object_set_new(root, "interrupted", json_boolean(interrupted)) &&
        !json_object_set_new(root, "failed", text(sim->context, failed)))
        dump = json_compose(root, JSON_INDENT(2) | JSON_REAL_PRECISION(15));
    json_decref(root);
    json_decref(run);
    json_decref(result);
    return dump;
}

pdyn_status report_write(const struct report *report, const pdyn_sim *sim, const char *path,
                         bool interrupted, const char *failed) {
    struct file_out file;
    char *dump = compose(report, sim, interrupted, failed);
    if (!dump) return context_no_memory(sim->context);
    pdyn_status status = file_out_open(sim->context, path, &file);
    if (status == PDYN_OK) {
        file_out_print(&file, "%s\n", dump);
        status = file_out_close(&file);
    }
    free(dump);
    return status;
}
