#include "scene_summary.h"

#include "projdyn/box.h"
#include "projdyn/control.h"
#include "projdyn/probe.h"
#include "projdyn/vec3.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- sizes ----------------------------------------------------------------------------------- */

struct size {           /* of a body */
    struct box box;     /* m */
    double mass;        /* kg */
    double momentum[3]; /* kg m/s */
};

static void add_mass(struct size *size, const pdyn_state *state, int i) {
    size->mass += state->mass[i];
    for (int a = 0; a < 3; a++) size->momentum[a] += state->mass[i] * state->v[3 * i + a];
}

/* end: the first particle of the next body: the mass of a rigid body is behind its vertices. */
static struct size size_of(const pdyn_state *state, const pdyn_body_info *body, int end) {
    struct size size = {.box = box_empty};
    for (int i = body->first + body->count; i < end; i++) add_mass(&size, state, i);
    for (int i = body->first; i < body->first + body->count; i++) {
        if (state->live && !state->live[i]) continue;
        add_mass(&size, state, i);
        box_add(&size.box, state->x + 3 * i);
    }
    return size;
}

/* Mean edge length of a surface, m. */
static double mean_edge(const pdyn_state *state, const pdyn_body_info *body) {
    const double *x = state->x + 3 * body->first;
    double sum = 0.0;
    for (int k = 0; k < 3 * body->triangles; k++) {
        int next = k % 3 == 2 ? k - 2 : k + 1;
        sum += vec3_distance(x + 3 * body->triangle[k], x + 3 * body->triangle[next]);
    }
    return sum / (3.0 * body->triangles);
}

/* ---- the parts of a scene -------------------------------------------------------------------- */

/* Distance of particles in the body of particles, m; 0: there is none. */
static double particle_spacing(const pdyn_sim *sim) {
    pdyn_body_info body;
    for (int b = 0; (body = pdyn_get_body(sim, b)).name; b++)
        if (!body.triangles) return 2.0 * body.radius;
    return 0.0;
}

static void print_surface(const pdyn_sim *sim, const pdyn_state *state,
                          const pdyn_body_info *body) {
    double edge = mean_edge(state, body), spacing = particle_spacing(sim);
    printf("body %s: %d vertices, %d triangles, edges of %.3g m on average", body->name,
           body->count, body->triangles, edge);
    if (spacing > 0.0) printf(" (%.2g particle spacings)", edge / spacing);
}

static void print_particles(const pdyn_body_info *body) {
    printf("body %s: %d particles of radius %g m", body->name, body->live, body->radius);
    if (body->live < body->count) printf(", capacity for %d more", body->count - body->live);
}

static void print_box(const struct box *box) {
    printf("from (%.4g, %.4g, %.4g) to (%.4g, %.4g, %.4g) m", box->min[0], box->min[1], box->min[2],
           box->max[0], box->max[1], box->max[2]);
}

/* The velocity of the centre of mass of a body that moves. */
static void print_velocity(const struct size *size) {
    double v[3];
    for (int a = 0; a < 3; a++) v[a] = size->momentum[a] / size->mass;
    if (fabs(v[0]) + fabs(v[1]) + fabs(v[2]) > 1e-9)
        printf(", velocity (%.4g, %.4g, %.4g) m/s", v[0], v[1], v[2]);
}

static bool has_fluid_constraint(const pdyn_sim *sim, const pdyn_body_info *body) {
    pdyn_constraint_info constraint;
    for (int k = 0; (constraint = pdyn_get_constraint(sim, k)).type; k++)
        if (!strcmp(constraint.type, "fluid") && !strcmp(constraint.body, body->name)) return true;
    return false;
}

/* Viscosity that particles of the spacing d add to a liquid of the depth D, over d sqrt(g D):
 * docs/results/validation.md#vortex-in-a-tank, where it is 0.6 to 1.7 times that. */
static const double added_viscosity = 0.25;

static void print_viscosity(const pdyn_sim *sim, const pdyn_body_info *body,
                            const struct box *box) {
    double gravity[3], depth_g = 0.0, spacing = 2.0 * body->radius;
    char one_digit[32];
    pdyn_get_gravity(sim, gravity);
    if (vec3_length(gravity) == 0.0 || !has_fluid_constraint(sim, body)) return;
    for (int a = 0; a < 3; a++) depth_g += fabs(gravity[a]) * (box->max[a] - box->min[a] + spacing);
    snprintf(one_digit, sizeof one_digit, "%.0e",
             body->rest_density * added_viscosity * spacing * sqrt(depth_g));
    printf("; its particles add a viscosity of some %g Pa s", strtod(one_digit, NULL));
}

static void print_body(const pdyn_sim *sim, const pdyn_state *state, int b) {
    const pdyn_body_info own = pdyn_get_body(sim, b), *body = &own;
    struct size size = size_of(state, body, body_end(sim, b));
    if (body->triangles) print_surface(sim, state, body);
    else print_particles(body);
    printf(", %.4g kg", size.mass);
    if (body->rest_density > 0.0) printf(", %.4g m^3", size.mass / body->rest_density);
    if (size.mass > 0.0) print_velocity(&size), printf(", "), print_box(&size.box);
    if (size.mass > 0.0) print_viscosity(sim, body, &size.box);
    putchar('\n');
}

static void print_vector(const pdyn_vector_info *v) {
    if (v->width)
        printf(", %s of %d row%s", v->name, v->count / v->width, v->count == v->width ? "" : "s");
    else if (v->count == 3)
        printf(", %s (%.4g, %.4g, %.4g) %s", v->name, v->value[0], v->value[1], v->value[2],
               v->unit);
    else if (v->count) printf(", %s of %d key%s", v->name, v->count / 4, v->count == 4 ? "" : "s");
}

static void print_constraint(const pdyn_sim *sim, int k) {
    pdyn_constraint_info constraint = pdyn_get_constraint(sim, k);
    pdyn_parameter_info p;
    pdyn_vector_info v;
    const char *plural = constraint.elements == 1 ? "" : "s";
    printf("constraint %s on %s: %d element%s%s", constraint.type, constraint.body,
           constraint.elements, plural, constraint.elements ? "" : " at the start");
    for (int i = 0; (p = pdyn_get_parameter(sim, k, i)).name; i++)
        printf(", %s %.6g%s%s", p.name, p.value, strcmp(p.unit, "1") ? " " : "",
               strcmp(p.unit, "1") ? p.unit : "");
    for (int i = 0; (v = pdyn_get_vector(sim, k, i)).name; i++) print_vector(&v);
    putchar('\n');
}

/* Name and bounds of a solid. Returns an exit code. */
static int print_solid(const pdyn_sim *sim, int k) {
    int count = pdyn_solid_vertices(sim, k, NULL);
    double *x = calloc(3 * (size_t)count + 1, sizeof *x);
    if (!x) return report_no_memory();
    pdyn_solid_vertices(sim, k, x);
    struct box box = box_around(x, count);
    free(x);
    printf("solid %s: ", pdyn_solid_name(sim, k)), print_box(&box), putchar('\n');
    return EXIT_GOOD;
}

static void print_boundary(const pdyn_state *state) {
    printf("boundary: %d points", state->boundary);
    if (state->moving) printf(", %d of them on moving solids", state->moving);
    if (state->samples) printf("; %d samples of surfaces", state->samples);
    putchar('\n');
}

static void print_probes(const pdyn_sim *sim) {
    pdyn_probe_info probe;
    for (int k = 0; (probe = pdyn_get_probe(sim, k)).name; k++)
        printf("probe %s: %s%s\n", probe.name, probe.column[0], probe.values > 1 ? " ..." : "");
}

/* Bytes of a frame's files (src/core/output/vtk.c) once inlets have released all particles: 44 a
 * particle, 24 a vertex and 20 a triangle of a surface, 24 a point on moving solids. Meshes of
 * moving solids are not counted. */
static double frame_bytes(const pdyn_sim *sim, const pdyn_state *state) {
    double bytes = 24.0 * state->moving;
    pdyn_body_info body;
    for (int b = 0; (body = pdyn_get_body(sim, b)).name; b++)
        bytes += body.triangles ? 24.0 * body.count + 20.0 * body.triangles : 44.0 * body.count;
    return bytes;
}

static void print_disk(const pdyn_sim *sim, const pdyn_state *state) {
    double frames = floor(pdyn_duration(sim) / pdyn_frame_interval(sim) + 1e-9) + 1.0;
    double bytes = frame_bytes(sim, state);
    printf("disk %.3g MB: %.0f frames of up to %.3g MB\n", 1e-6 * bytes * frames, frames,
           1e-6 * bytes);
}

/* A run ends with the step that reaches the duration. */
static void print_duration(double duration, double interval) {
    double last = interval * floor(duration / interval + 1e-9);
    printf("duration %g s, a frame every %g s", duration, interval);
    if (last < duration * (1.0 - 1e-9)) printf(", the last one at %g s", last);
    printf("\n");
}

int print_scene_summary(const pdyn_context *context, const pdyn_sim *sim) {
    pdyn_state state = pdyn_get_state(sim);
    double gravity[3];
    int code = EXIT_GOOD;
    for (int b = 0; b < state.bodies; b++) print_body(sim, &state, b);
    for (int k = 0; k < state.constraints; k++) print_constraint(sim, k);
    for (int k = 0; pdyn_solid_name(sim, k) && code == EXIT_GOOD; k++) code = print_solid(sim, k);
    if (code != EXIT_GOOD) return code;
    print_boundary(&state);
    print_probes(sim);
    pdyn_get_gravity(sim, gravity);
    printf("gravity (%.4g, %.4g, %.4g) m/s^2\n", gravity[0], gravity[1], gravity[2]);
    if (pdyn_contact_stiffness(sim) > 0.0)
        printf("contact: stiffness %.4g N/m\n", pdyn_contact_stiffness(sim));
    printf("solver %s, %s step: %s\n", pdyn_solver_type(sim), pdyn_step_type(sim),
           pdyn_solver_reason(sim));
    printf("integrator %s\n", pdyn_integrator(sim));
    print_duration(pdyn_duration(sim), pdyn_frame_interval(sim));
    printf("memory %.0f MB\n", 1e-6 * (double)pdyn_peak_bytes(context));
    print_disk(sim, &state);
    return EXIT_GOOD;
}
