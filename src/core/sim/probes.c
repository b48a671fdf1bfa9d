/* Probes: a table of what each kind measures, the names of columns, means over time. */
#include "probes.h"

#include "base/sized.h"
#include "fluid_at.h"
#include "forces.h"
#include "live_particles.h"
#include "probe_place.h"
#include "probe_wall.h"
#include "scene/json_file.h"

#include "projdyn/vec3.h"

#include <stdio.h>

/* ---- what probes measure --------------------------------------------------------------------- */

typedef void measure_fn(const struct pdyn_sim *sim, const struct probe_place *place, double *out);

static double radius_of(const struct pdyn_sim *sim, const struct scene_probe *probe) {
    return probe->radius > 0.0 ? probe->radius : 2.0 * sim_spacing(sim);
}

static void measure_points(const struct pdyn_sim *sim, const struct probe_place *place,
                           double *out) {
    double radius = radius_of(sim, place->probe);
    for (int k = 0; k < place->probe->at.count; k++)
        fluid_at_fit(sim, place->x + 3 * (size_t)k, radius, out + FLUID_VALUES * k);
}

static void measure_wall(const struct pdyn_sim *sim, const struct probe_place *place, double *out) {
    *out = probe_wall_pressure(sim, place, radius_of(sim, place->probe));
}

static void measure_height(const struct pdyn_sim *sim, const struct probe_place *place,
                           double *out) {
    *out = fluid_at_height(sim, place->x);
}

static bool is_fluid(const struct pdyn_sim *sim, int i) {
    return particle_is_live(sim, i) &&
           has_neighbour_lists(sim, objective_body_of(&sim->objective, i));
}

/* The volume of all fluids in the box, and its mean velocity. */
static void measure_box(const struct pdyn_sim *sim, const struct probe_place *place, double *out) {
    double spacing = sim_spacing(sim), count = 0.0, sum[3] = {0};
    for (int i = 0; i < sim->objective.particles; i++) {
        double x[3];
        probe_place_return(place, sim->x + 3 * (size_t)i, x);
        if (!box_contains(&place->probe->box, x) || !is_fluid(sim, i)) continue;
        count++;
        vec3_add(sum, 1.0, sim->v + 3 * (size_t)i);
    }
    out[0] = count * spacing * spacing * spacing;
    for (int a = 0; a < 3; a++) out[1 + a] = count > 0.0 ? sum[a] / count : 0.0;
}

static void measure_solid(const struct pdyn_sim *sim, const struct probe_place *place,
                          double *out) {
    const struct scene_probe *probe = place->probe;
    load_copy(solid_load_compute(sim, probe->source) + probe->target, out, out + 3);
}

/* The force on a body by all of its constraints that count, or by one of them. */
static void measure_constraint(const struct pdyn_sim *sim, const struct probe_place *place,
                               double *out) {
    const struct scene_probe *probe = place->probe;
    const pdyn_body *body = &sim->body[probe->target];
    struct load load = {{0}, {0}};
    for (int k = 0, number = 0; k < sim->constraints; k++) {
        const struct batch *b = sim->objective.batch[k];
        if (!scene_probe_counts(probe, b->type) || b->view.body != body) continue;
        if (probe->number < 0 || probe->number == number) forces_add_load(sim, k, body, &load);
        number++;
    }
    load_copy(&load, out, out + 3);
}

/* The volume V inside a surface, and the pressure p of its filling above that outside: its forces
 * are p grad V, and grad V . x = 3 V. */
static void measure_inside(const struct pdyn_sim *sim, const struct probe_place *place,
                           double *out) {
    const pdyn_body *body = &sim->body[place->probe->target];
    double virial = 0.0;
    for (int k = 0; k < sim->constraints; k++) {
        const struct batch *b = sim->objective.batch[k];
        if (b->type->flags & PDYN_ON_CLOSED && b->view.body == body)
            virial += forces_virial(sim, k);
    }
    out[0] = fabs(mesh_volume(body->triangles, body->triangle, sim->x + 3 * (size_t)body->first));
    out[1] = out[0] > 0.0 ? virial / (3.0 * out[0]) : 0.0;
}

/* The force by a source on a body, and its moment about the origin. */
static void measure_body(const struct pdyn_sim *sim, const struct probe_place *place, double *out) {
    const struct scene_probe *probe = place->probe;
    struct load load = forces_load_on(sim, probe->target, sim->probes->force[probe->source]);
    load_copy(&load, out, out + 3);
}

struct quantity {
    const char *name, *unit;
};
static const struct quantity fluid[FLUID_VALUES] = {
    {"pressure", "Pa"}, {"velocity_x", "m_s"}, {"velocity_y", "m_s"}, {"velocity_z", "m_s"}};
static const struct quantity load[] = {{"force_x", "N"},   {"force_y", "N"},   {"force_z", "N"},
                                       {"moment_x", "Nm"}, {"moment_y", "Nm"}, {"moment_z", "Nm"}};
static const struct quantity water[] = {
    {"volume", "m3"}, {"velocity_x", "m_s"}, {"velocity_y", "m_s"}, {"velocity_z", "m_s"}};
static const struct quantity filling[] = {{"volume", "m3"}, {"overpressure", "Pa"}};

static const struct {
    measure_fn *measure;
    int count; /* quantities, of every point */
    const struct quantity *quantity;
} kinds[PROBE_KINDS] = {
    [PROBE_POINT] = {measure_points, FLUID_VALUES, fluid},
    [PROBE_LINE] = {measure_points, FLUID_VALUES, fluid},
    [PROBE_WALL] = {measure_wall, 1, fluid}, /* the pressure */
    [PROBE_HEIGHT] = {measure_height, 1, &(const struct quantity){"height", "m"}},
    [PROBE_BOX] = {measure_box, 4, water},
    [PROBE_SOLID] = {measure_solid, 6, load},
    [PROBE_CONSTRAINT] = {measure_constraint, 6, load},
    [PROBE_INSIDE] = {measure_inside, 2, filling},
    [PROBE_BODY] = {measure_body, 6, load},
};

/* ---- memory ---------------------------------------------------------------------------------- */

static int values_of(const struct scene_probe *probe) {
    return kinds[probe->kind].count * (probe->at.count ? probe->at.count : 1);
}

/* NAME.QUANTITY_UNIT; with the number of the point on a line: NAME.QUANTITY_NUMBER_UNIT. */
static void name_column(const struct scene_probe *probe, int value, char *text) {
    const struct quantity *q = &kinds[probe->kind].quantity[value % kinds[probe->kind].count];
    char number[16] = "";
    if (probe->kind == PROBE_LINE)
        snprintf(number, sizeof number, "_%d", value / kinds[probe->kind].count);
    snprintf(text, PROBE_COLUMN, "%s.%s%s_%s", probe->name, q->name, number, q->unit);
}

static void list_columns(struct probes *p, const struct scene *scene) {
    for (int k = 0, first = 0; k < p->count; first += p->probe[k++].values) {
        const struct scene_probe *from = &scene->probe[k];
        p->probe[k] =
            (pdyn_probe_info){from->name, values_of(from), p->column + first, p->value + first};
        for (int m = 0; m < p->probe[k].values; m++) {
            char *text = p->text + (size_t)PROBE_COLUMN * (size_t)(first + m);
            name_column(from, m, text);
            p->column[first + m] = text;
        }
    }
}

/* The numbers of a vector of forces by a source; 0: no probe of a body needs it. */
static size_t force_numbers(const struct pdyn_sim *sim, int source) {
    for (int k = 0; k < sim->scene.probes; k++)
        if (sim->scene.probe[k].kind == PROBE_BODY && sim->scene.probe[k].source == source)
            return VECTOR_LENGTH(sim->objective.particles);
    return 0;
}

static bool has_wall_of_body(const struct scene *scene) {
    for (int k = 0; k < scene->probes; k++)
        if (scene->probe[k].kind == PROBE_WALL && scene->probe[k].on_body >= 0) return true;
    return false;
}

static int count_points(const struct scene *scene) {
    int points = 0;
    for (int k = 0; k < scene->probes; k++) points += scene->probe[k].at.count;
    return points;
}

static bool resize_arrays(struct pdyn_sim *sim, enum array_action action) {
    struct probes *p = sim->probes;
    size_t samples =
        sim->objective.samples && has_wall_of_body(&sim->scene) ? sim->objective.samples->count : 0;
    const struct array_entry table[] = {
        ARRAY(p->probe, p->count),
        ARRAY(p->value, p->values),
        ARRAY(p->now, p->values),
        ARRAY(p->text, PROBE_COLUMN * (size_t)p->values),
        ARRAY(p->column, p->values),
        ARRAY(p->force[PDYN_LOAD_ALL], force_numbers(sim, PDYN_LOAD_ALL)),
        ARRAY(p->force[PDYN_LOAD_FLUID], force_numbers(sim, PDYN_LOAD_FLUID)),
        ARRAY(p->force[PDYN_LOAD_CONTACT], force_numbers(sim, PDYN_LOAD_CONTACT)),
        ARRAY(p->place, p->count),
        ARRAY(p->x, 3 * (size_t)count_points(&sim->scene)),
        ARRAY(p->sample_force, 3 * samples),
    };
    return context_arrays(sim->context, table, ARRAY_ROWS(table), action);
}

static void start_places(struct pdyn_sim *sim) {
    struct probes *p = sim->probes;
    size_t first = 0;
    for (int k = 0; k < p->count; k++) {
        const struct scene_probe *probe = &sim->scene.probe[k];
        probe_place_start(sim, probe, probe->at.count ? p->x + first : NULL, &p->place[k]);
        first += 3 * (size_t)probe->at.count;
    }
}

static pdyn_status check_walls(const struct pdyn_sim *sim, const struct json_file *json) {
    struct json_at root = json_root(json), probes = json_member(&root, "probes");
    for (int k = 0; k < sim->scene.probes; k++) {
        const struct scene_probe *probe = &sim->scene.probe[k];
        if (probe->kind != PROBE_WALL ||
            probe_wall_exists(sim, &sim->probes->place[k], radius_of(sim, probe)))
            continue;
        const char *name = probe->on_solid >= 0  ? sim->scene.solid[probe->on_solid].name
                           : probe->on_body >= 0 ? sim->scene.body[probe->on_body].name
                                                 : NULL;
        struct json_at at = json_element(&probes, (size_t)k), wall = json_member(&at, "wall");
        return json_fail(&wall,
                         "probe \"%s\": expected a wall of %s%s%s within %g m of (%g, %g, %g)",
                         probe->name, name ? "\"" : "a solid", name ? name : "", name ? "\"" : "",
                         radius_of(sim, probe), probe->at.x[0], probe->at.x[1], probe->at.x[2]);
    }
    return PDYN_OK;
}

pdyn_status probes_create(struct pdyn_sim *sim, const struct json_file *json) {
    if (!sim->scene.probes) return PDYN_OK;
    struct probes *p = sim->probes = NEW_ARRAY(sim->context, 1, struct probes);
    if (!p) return PDYN_NO_MEMORY;
    p->count = sim->scene.probes;
    for (int k = 0; k < p->count; k++) p->values += values_of(&sim->scene.probe[k]);
    if (!resize_arrays(sim, ARRAYS_ALLOCATE)) return PDYN_NO_MEMORY;
    list_columns(p, &sim->scene);
    start_places(sim);
    return check_walls(sim, json);
}

void probes_free(struct pdyn_sim *sim) {
    if (!sim->probes) return;
    resize_arrays(sim, ARRAYS_FREE);
    FREE_ARRAY(sim->context, sim->probes, 1);
}

/* ---- steps ----------------------------------------------------------------------------------- */

/* The exponential mean takes 1 - e^(-h / time) of each new value, the first value as a whole. */
static double part_of(const struct scene_probe *probe, double h, long steps) {
    return probe->time > 0.0 && steps > 1 ? -expm1(-h / probe->time) : 1.0;
}

void probes_step(struct pdyn_sim *sim, double h) {
    struct probes *p = sim->probes;
    if (!p) return;
    double *now = p->now, *value = p->value;
    for (int k = 0; k < LOAD_SOURCES; k++)
        if (p->force[k]) forces_sum(sim, (pdyn_load_source)k, p->force[k]);
    if (p->sample_force) probe_wall_sum(sim);
    for (int k = 0; k < p->count; k++) {
        const struct scene_probe *from = &sim->scene.probe[k];
        double part = part_of(from, h, sim->steps);
        probe_place_move(sim, &p->place[k]);
        kinds[from->kind].measure(sim, &p->place[k], now);
        for (int m = 0; m < p->probe[k].values; m++, value++, now++)
            *value = part == 1.0 ? *now : *value + part * (*now - *value);
    }
}

void probes_persist(struct pdyn_sim *sim, struct snapshot_file *file) {
    if (sim->probes)
        snapshot_file_numbers(file, sim->probes->value, (size_t)sim->probes->values,
                              "a value of a probe is not finite");
}

void pdyn_get_probe_sized(const pdyn_sim *sim, int probe, pdyn_probe_info *out, size_t size) {
    pdyn_probe_info info = {0};
    if (sim && sim->probes && probe >= 0 && probe < sim->probes->count)
        info = sim->probes->probe[probe];
    sized_copy(out, size, &info, sizeof info);
}
