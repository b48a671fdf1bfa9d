/* Constraints and solvers with one fault each: conformance reports it. All are variants of a
 * correct type, a spring of fixed rest length along each edge. */
#include "wrong_support.h"

#include "projdyn/vec3.h"

#include <stdatomic.h>
#include <string.h>

struct params {
    double stiffness;
};

static const pdyn_param params[] = {
    {"stiffness", PDYN_REAL, 0, false, 100, 0, 1e6, "N/m", "of each edge"}, {0}};

static int elements(const void *par, const pdyn_body *body) {
    (void)par;
    return body->edges;
}

static void select_edges(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        const int *edge = b->body->edge + 2 * e;
        for (int k = 0; k < 2; k++) {
            b->column[2 * e + k] = b->body->first + edge[k];
            b->coefficient[2 * e + k] = k ? 1.0 : -1.0;
        }
        ((double *)b->data)[e] =
            vec3_distance(b->body->rest + 3 * edge[0], b->body->rest + 3 * edge[1]);
    }
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++) b->weight[e] = ((const struct params *)par)->stiffness;
}

static double length(const pdyn_batch *b, int e) { return ((double *)b->data)[e]; }

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++)
        vec3_project_length(b->p + 3 * e, b->u + 3 * e, length(b, e));
}

static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    (void)par;
    for (int e = first; e < last; e++, J += 9) vec3_tangent_length(J, b->u + 3 * e, length(b, e));
}

static double damping(const void *par) {
    (void)par;
    return 0.01;
}

static void damping_rest(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) ((double *)b->data)[e] = vec3_length(b->u + 3 * e);
}

static const pdyn_constraint_type good = {.name = "edges",
                                          .summary = "keeps the lengths of edges",
                                          .flags = PDYN_ON_SURFACE,
                                          .params_size = sizeof(struct params),
                                          .params = params,
                                          .data_size = sizeof(double),
                                          .elements = elements,
                                          .rows = 1,
                                          .width = 2,
                                          .select = select_edges,
                                          .weight = weight,
                                          .project = project,
                                          .tangent = tangent,
                                          .damping = damping,
                                          .damping_rest = damping_rest};

static void test_good(void **state) {
    (void)state;
    wrong_expect(good, NULL);
}

struct chosen {
    double stiffness;
    pdyn_vertices vertices;
};

/* An element for each chosen vertex beyond the third, as the shape of a group of points has. */
static int elements_of_chosen(const void *par, const pdyn_body *body) {
    (void)body;
    int count = ((const struct chosen *)par)->vertices.count;
    return count > 3 ? count - 3 : 0;
}

/* A type that needs more than three chosen vertices is exercised. A body of particles has none to
 * choose from: the flag is missing. */
static void test_vertices(void **state) {
    (void)state;
    static const pdyn_param chosen[] = {
        {"stiffness", PDYN_REAL, 0, false, 100, 0, 1e6, "N/m", "of each edge"},
        {"vertices", PDYN_VERTICES, offsetof(struct chosen, vertices), true, 0, 0, 0, "",
         "the points"},
        {0}};
    pdyn_constraint_type t = good;
    t.params = chosen, t.params_size = sizeof(struct chosen);
    wrong_expect(t, NULL);
    t.elements = elements_of_chosen, wrong_expect(t, NULL);
    t.flags = 0;
    wrong_expect(t, "parameter \"vertices\" chooses vertices, which a body of particles lacks");
}

/* ---- where it writes ------------------------------------------------------------------------- */

static void project_beyond(const void *par, const pdyn_batch *b, int first, int last) {
    project(par, b, first, last);
    b->p[3 * last] = 0.0;
}

static void project_before(const void *par, const pdyn_batch *b, int first, int last) {
    project(par, b, first, last);
    if (first > 0) b->p[3 * first - 1] = 0.0;
}

static void project_all(const void *par, const pdyn_batch *b, int first, int last) {
    (void)first, (void)last;
    project(par, b, 0, b->elements);
}

static void project_weights(const void *par, const pdyn_batch *b, int first, int last) {
    project(par, b, first, last);
    for (int e = first; e < last; e++) b->weight[e] *= 1.01;
}

static void project_u(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++) ((double *)b->u)[3 * e] += 1e-9;
    project(par, b, first, last);
}

static void select_beyond(const void *par, const pdyn_batch *b, int first, int last) {
    select_edges(par, b, first, last);
    if (last < b->elements) b->coefficient[2 * last] = 1.0;
}

static void test_writes(void **state) {
    (void)state;
    pdyn_constraint_type t = good;
    t.project = project_beyond, wrong_expect(t, "project writes p outside of its elements");
    t.project = project_before, wrong_expect(t, "project writes p outside of its elements");
    t.project = project_all, wrong_expect(t, "project writes p outside of its elements");
    t.project = project_weights, wrong_expect(t, "project writes weight, which it may only read");
    t.project = project_u, wrong_expect(t, "project writes u, which it may only read");
    t = good, t.select = select_beyond;
    wrong_expect(t, "select writes coefficient outside of its elements");
}

/* ---- what it writes -------------------------------------------------------------------------- */

static void project_nan(const void *par, const pdyn_batch *b, int first, int last) {
    project(par, b, first, last);
    if (first <= 3 && last > 3) b->p[10] = NAN;
}

static void project_part(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++)
        if (e % 5) vec3_project_length(b->p + 3 * e, b->u + 3 * e, length(b, e));
}

static atomic_int calls;

static void project_counting(const void *par, const pdyn_batch *b, int first, int last) {
    project(par, b, first, last);
    for (int e = first; e < last; e++) b->p[3 * e] += 1e-7 * atomic_fetch_add(&calls, 1);
}

/* Projects to the mean length of the range: the result depends on how core splits the elements. */
static void project_mean(const void *par, const pdyn_batch *b, int first, int last) {
    double mean = 0.0;
    (void)par;
    for (int e = first; e < last; e++) mean += length(b, e) / (last - first);
    for (int e = first; e < last; e++) vec3_project_length(b->p + 3 * e, b->u + 3 * e, mean);
}

static void weight_negative(const void *par, const pdyn_batch *b, int first, int last) {
    weight(par, b, first, last);
    for (int e = first; e < last; e++)
        if (e == 7) b->weight[e] = -1.0;
}

static void select_beyond_body(const void *par, const pdyn_batch *b, int first, int last) {
    select_edges(par, b, first, last);
    for (int e = first; e < last; e++) b->column[2 * e] += 2;
}

static void select_counting(const void *par, const pdyn_batch *b, int first, int last) {
    int change = atomic_fetch_add(&calls, 1) % 2;
    select_edges(par, b, first, last);
    for (int e = first; e < last && change; e++)
        b->coefficient[2 * e] = 1.0, b->coefficient[2 * e + 1] = -1.0;
}

/* Rows of a type without `update` are selected once, when the scene is loaded. */
static void select_of_step(const void *par, const pdyn_batch *b, int first, int last) {
    select_edges(par, b, first, last);
    for (int k = 2 * first; k < 2 * last; k++) b->coefficient[k] *= 1.0 + b->h;
}

static int elements_counting(const void *par, const pdyn_body *body) {
    return elements(par, body) - atomic_fetch_add(&calls, 1) % 2;
}

static int elements_negative(const void *par, const pdyn_body *body) {
    return -elements(par, body);
}

static int elements_none(const void *par, const pdyn_body *body) { return 0 * elements(par, body); }

/* The weight is that of the parameter, the force that of its default. */
static void project_default(const void *par, const pdyn_batch *b, int first, int last) {
    double part = params[0].def / ((const struct params *)par)->stiffness;
    project(par, b, first, last);
    for (int k = 3 * first; k < 3 * last; k++) b->p[k] = b->u[k] + part * (b->p[k] - b->u[k]);
}

static void test_values(void **state) {
    (void)state;
    pdyn_constraint_type t = good;
    t.project = project_nan, wrong_expect(t, "not finite");
    t.project = project_part, wrong_expect(t, "does not write all of it");
    t.project = project_counting, wrong_expect(t, "project gives another p for the same elements");
    assert_false(wrong_type_is_reported(t, "depends on `time`"));
    t.project = project_mean, wrong_expect(t, "project gives another p for the same elements");
    t.project = project_default, wrong_expect(t, "p is not the closest point");
    t = good, t.weight = weight_negative, wrong_expect(t, "has the weight -1");
    t = good, t.select = select_beyond_body,
    wrong_expect(t, "selects particle 42, expected 12 to 41");
    t = good, t.select = select_counting, wrong_expect(t, "select gives another coefficient");
    t.select = select_of_step, wrong_expect(t, "select gives other rows");
    t = good, t.elements = elements_counting, wrong_expect(t, "elements gives another number");
    t = good, t.elements = elements_negative, wrong_expect(t, "elements");
    t = good, t.elements = elements_none, wrong_expect(t, "`elements` is 0 on a surface");
    t = good, t.flags = 0, wrong_expect(t, "triangles, edges and tetrahedra: say PDYN_ON_SURFACE");
}

/* ---- weights that change --------------------------------------------------------------------- */

static void weight_of_time(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++)
        b->weight[e] = ((const struct params *)par)->stiffness * (b->time < 0.5 ? 1.0 : 0.5);
}

static void weight_of_step(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++)
        b->weight[e] = ((const struct params *)par)->stiffness * (1.0 + b->h);
}

static void weight_of_memory(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++)
        b->weight[e] = ((const struct params *)par)->stiffness / (1.0 + ((double *)b->memory)[e]);
}

static void weight_negative_in_steps(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++)
        b->weight[e] = b->h > 0.0 ? -1.0 : ((const struct params *)par)->stiffness;
}

/* Damage: the largest strain so far. */
static void end_of_damage(const void *par, const pdyn_batch *b, int first, int last) {
    double *m = b->memory;
    (void)par;
    for (int e = first; e < last; e++)
        m[e] = fmax(m[e], fabs(vec3_length(b->u + 3 * e) / length(b, e) - 1.0));
}

static void begin_nothing(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par, (void)b, (void)first, (void)last;
}

static void expect_begin(pdyn_constraint_type t, const char *expected) {
    wrong_expect(t, expected);
    t.begin = begin_nothing, wrong_expect(t, NULL);
}

/* Such weights are computed once, unless the type has a `begin`. */
static void test_weights_that_change(void **state) {
    (void)state;
    pdyn_constraint_type t = good;
    t.damping = NULL, t.damping_rest = NULL;
    t.weight = weight_of_time, expect_begin(t, "weight depends on `time`, but without `begin`");
    t.weight = weight_of_step, expect_begin(t, "weight depends on the length of the step");
    t.weight = weight_negative_in_steps, t.begin = begin_nothing;
    wrong_expect(t, "element 0 has the weight -1, expected a finite one of at least 0");
    t.begin = NULL;
    t.weight = weight, t.memory_size = sizeof(double), t.end = end_of_damage;
    wrong_expect(t, NULL);
    t.weight = weight_of_memory, expect_begin(t, "weight depends on `memory`");
}

static void begin_stretched(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) ((double *)b->data)[e] = vec3_length(b->u + 3 * e);
}

static void begin_weight(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->weight[e] = 1.0;
}

static void weight_of_data(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++)
        b->weight[e] = ((const struct params *)par)->stiffness / length(b, e);
}

/* PDYN_STEADY: they may not change although there is a `begin`. */
static void test_steady_weights(void **state) {
    (void)state;
    pdyn_constraint_type t = good;
    t.damping = NULL, t.damping_rest = NULL, t.flags |= PDYN_STEADY, t.begin = begin_nothing;
    wrong_expect(t, NULL);
    t.weight = weight_of_time, wrong_expect(t, "weight depends on `time`, but with PDYN_STEADY");
    t.weight = weight_of_step, wrong_expect(t, "the length of the step, but with PDYN_STEADY");
    t.weight = weight_of_data, t.begin = begin_stretched;
    wrong_expect(t, "weight depends on what `begin` writes, but with PDYN_STEADY");
    t.weight = weight, wrong_expect(t, NULL);
    t.begin = begin_weight, wrong_expect(t, "begin writes weight, which it may only read");
}

/* ---- state outside of memory ----------------------------------------------------------------- */

static void begin_largest(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++)
        ((double *)b->data)[e] = fmax(length(b, e), vec3_length(b->u + 3 * e));
}

static void begin_smallest(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++)
        ((double *)b->data)[e] = fmin(length(b, e), vec3_length(b->u + 3 * e));
}

static double step_length;

static void begin_variable(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par, (void)first, (void)last;
    step_length = b->h;
}

static void weight_of_variable(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++)
        b->weight[e] = ((const struct params *)par)->stiffness / (1.0 + step_length);
}

static void project_variable(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++)
        vec3_project_length(b->p + 3 * e, b->u + 3 * e, length(b, e) * (1.0 + step_length));
}

static void project_time(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++)
        vec3_project_length(b->p + 3 * e, b->u + 3 * e, length(b, e) * (1.1 + 0.1 * sin(b->time)));
}

/* Saved states contain `memory` alone, and a type has one set of variables for all bodies. */
static void test_state(void **state) {
    (void)state;
    pdyn_constraint_type t = good;
    t.damping = NULL, t.damping_rest = NULL, t.tangent = NULL;
    t.begin = begin_largest, wrong_expect(t, "begin writes other data after another step");
    t.begin = begin_smallest, wrong_expect(t, "begin writes other data after another step");
    t.begin = begin_variable, t.weight = weight_of_variable;
    wrong_expect(t, "weight gives another weight after callbacks have run for another body");
    t.weight = weight, t.project = project_variable;
    wrong_expect(t, "project gives another p after callbacks have run for another body");
    t.begin = NULL, t.project = project_time;
    expect_begin(t, "project depends on `time`, but without `begin`");
}

/* ---- mathematics ----------------------------------------------------------------------------- */

static void project_half_way(const void *par, const pdyn_batch *b, int first, int last) {
    project(par, b, first, last);
    for (int k = 3 * first; k < 3 * last; k++) b->p[k] = 0.5 * (b->p[k] + b->u[k]);
}

/* A point of the sphere, but not the closest. */
static void project_askew(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        double u[3] = {2.0 * b->u[3 * e], b->u[3 * e + 1], b->u[3 * e + 2]};
        vec3_project_length(u, u, length(b, e));
        memcpy(b->p + 3 * e, u, sizeof u);
    }
}

/* The sphere of project_askew, from one side only: beyond the length (tension), or below it. */
static void project_askew_where(const void *par, const pdyn_batch *b, int first, int last,
                                bool beyond) {
    for (int e = first; e < last; e++)
        if ((vec3_length(b->u + 3 * e) > length(b, e)) == beyond) project_askew(par, b, e, e + 1);
        else memcpy(b->p + 3 * e, b->u + 3 * e, 3 * sizeof *b->p);
}

static void project_askew_tension(const void *par, const pdyn_batch *b, int first, int last) {
    project_askew_where(par, b, first, last, true);
}

static void project_askew_compression(const void *par, const pdyn_batch *b, int first, int last) {
    project_askew_where(par, b, first, last, false);
}

/* A limit that is out of reach: nothing is tried. */
static void project_never(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    memcpy(b->p + 3 * first, b->u + 3 * first, 3 * (size_t)(last - first) * sizeof *b->p);
}

/* Right for elements without memory alone. */
static void project_askew_damaged(const void *par, const pdyn_batch *b, int first, int last) {
    project(par, b, first, last);
    for (int e = first; e < last; e++)
        if (((double *)b->memory)[e] > 0.0) project_askew(par, b, e, e + 1);
}

static void test_memory(void **state) {
    (void)state;
    pdyn_constraint_type t = good;
    t.damping = NULL, t.damping_rest = NULL;
    t.memory_size = sizeof(double), t.end = end_of_damage;
    t.project = project_askew_damaged, wrong_expect(t, "p is not the closest point");
}

static void tangent_identity(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    (void)par, (void)b;
    for (int e = first; e < last; e++, J += 9) J[0] = J[4] = J[8] = 1.0;
}

/* Selects one end: not invariant to translations. */
static void select_one(const void *par, const pdyn_batch *b, int first, int last) {
    select_edges(par, b, first, last);
    for (int e = first; e < last; e++) b->coefficient[2 * e] = 0.0;
}

static void tangent_transposed(const void *par, const pdyn_batch *b, int first, int last,
                               double *J) {
    tangent(par, b, first, last, J);
    for (int e = first; e < last; e++) J[9 * (e - first) + 1] = 0.0;
}

static void tangent_none(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    (void)par, (void)b;
    for (int e = first; e < last; e++, J += 9) J[0] = J[4] = J[8] = 1.0;
}

static void tangent_large(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    tangent(par, b, first, last, J);
    for (int k = 0; k < 9 * (last - first); k++) J[k] *= 1.5;
}

static void tangent_nan(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    tangent(par, b, first, last, J);
    if (first <= 3 && last > 3) J[9 * (3 - first)] = NAN;
}

static void axial_large(const void *par, const pdyn_batch *b, int first, int last, double *axis) {
    (void)par;
    for (int e = first; e < last; e++, axis += 4) {
        vec3_axis_length(axis, b->u + 3 * e, length(b, e));
        axis[3] += 0.5;
    }
}

static bool linear(const void *par, const pdyn_batch *b) {
    (void)par, (void)b;
    return true;
}

static double energy(const void *par, const pdyn_batch *b, int first, int last) {
    double sum = 0.0;
    (void)par;
    for (int e = first; e < last; e++) {
        double d = vec3_distance(b->u + 3 * e, b->p + 3 * e);
        sum += b->weight[e] * d * d; /* the factor 1/2 is missing */
    }
    return sum;
}

/* p is not exact: it differs from the closest point by up to 1e-7 of its length. */
static void project_rough(const void *par, const pdyn_batch *b, int first, int last) {
    project(par, b, first, last);
    for (int k = 3 * first; k < 3 * last; k++) b->p[k] *= 1.0 + 1e-7 * sin(1e9 * b->u[k]);
}

/* E = k sqrt(u^2 + l^2) with k = w l: p = u - dE/du / w */
static void project_soft(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        const double *u = b->u + 3 * e, l = length(b, e);
        for (int k = 0; k < 3; k++) b->p[3 * e + k] = u[k] - l / hypot(vec3_length(u), l) * u[k];
    }
}

static double energy_soft(const void *par, const pdyn_batch *b, int first, int last) {
    double sum = 0.0;
    (void)par;
    for (int e = first; e < last; e++)
        sum += b->weight[e] * length(b, e) * hypot(vec3_length(b->u + 3 * e), length(b, e));
    return sum;
}

static double energy_below_0(const void *par, const pdyn_batch *b, int first, int last) {
    return energy_soft(par, b, first, last) - 1e6 * (last - first);
}

static double energy_of_another(const void *par, const pdyn_batch *b, int first, int last) {
    return 1.1 * energy_soft(par, b, first, last);
}

/* A type with an energy of its own need not project, and its p is checked by that energy, which may
 * be negative where core expects energy from the type. */
static void test_energy(void **state) {
    (void)state;
    pdyn_constraint_type t = good;
    t.tangent = NULL, t.damping = NULL, t.damping_rest = NULL, t.project = project_soft;
    wrong_expect(t, "project is no projection");
    t.energy = energy_soft, wrong_expect(t, NULL);
    t.flags |= PDYN_NUMERIC_TANGENT, wrong_expect(t, NULL);
    t.energy = energy_below_0, expect_begin(t, "expected at least 0: add a constant");
    t.energy = energy_of_another, wrong_expect(t, "is not that of the energy");
}

static void thirteen_rows(const void *par, const pdyn_batch *b, int e, int *rows, int *width) {
    (void)par, (void)b, (void)e;
    *rows = 13, *width = 2;
}

static void test_numeric_tangent(void **state) {
    (void)state;
    pdyn_constraint_type t = good;
    t.tangent = NULL, t.flags |= PDYN_NUMERIC_TANGENT, wrong_expect(t, NULL);
    t.damping = NULL, t.damping_rest = NULL;
    t.project = project_rough, wrong_expect(t, "too rough for PDYN_NUMERIC_TANGENT");
    t.project = project, t.rows = 0, t.row_sizes = thirteen_rows;
    wrong_expect(t, "element 0 has 13 rows, expected at most 12 with PDYN_NUMERIC_TANGENT");
}

/* ---- parameters that are true or false ------------------------------------------------------- */

struct switched {
    struct params common;
    bool on;
};

static const pdyn_param switches[2][3] = {
    {{"stiffness", PDYN_REAL, 0, false, 100, 0, 1e6, "N/m", "of each edge"},
     {"on", PDYN_BOOL, offsetof(struct switched, on), false, 1, 0, 0, "", "whether it acts"},
     {0}},
    {{"stiffness", PDYN_REAL, 0, false, 100, 0, 1e6, "N/m", "of each edge"},
     {"askew", PDYN_BOOL, offsetof(struct switched, on), false, 0, 0, 0, "", "a fault"},
     {0}}};

static void project_if_on(const void *par, const pdyn_batch *b, int first, int last) {
    (((const struct switched *)par)->on ? project : project_never)(par, b, first, last);
}

static void tangent_if_on(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    (((const struct switched *)par)->on ? tangent : tangent_identity)(par, b, first, last, J);
}

static void project_askew_if_on(const void *par, const pdyn_batch *b, int first, int last) {
    (((const struct switched *)par)->on ? project_askew : project)(par, b, first, last);
}

/* Both values of a parameter are checked; with one of them the type may do nothing. */
static void test_switches(void **state) {
    (void)state;
    pdyn_constraint_type t = good;
    t.damping = NULL, t.damping_rest = NULL;
    t.params = switches[0], t.params_size = sizeof(struct switched);
    t.project = project_if_on, t.tangent = tangent_if_on, wrong_expect(t, NULL);
    t = good, t.params = switches[1], t.params_size = sizeof(struct switched);
    t.project = project_askew_if_on, wrong_expect(t, ", not the default of \"askew\"): ");
}

struct exclusive {
    struct params common;
    bool one, other;
};

static const pdyn_param exclusive_params[] = {
    {"stiffness", PDYN_REAL, 0, false, 100, 0, 1e6, "N/m", "of each edge"},
    {"one", PDYN_BOOL, offsetof(struct exclusive, one), false, 0, 0, 0, "", "not with the other"},
    {"other", PDYN_BOOL, offsetof(struct exclusive, other), false, 0, 0, 0, "", "not with one"},
    {0}};

static pdyn_param_fault resolve_exclusive(void *par, const pdyn_scene_info *scene) {
    const struct exclusive *q = par;
    (void)scene;
    return (pdyn_param_fault){q->one && q->other ? "is not for both" : NULL, "other"};
}

static pdyn_param_fault resolve_nothing(void *par, const pdyn_scene_info *scene) {
    (void)par, (void)scene;
    return (pdyn_param_fault){"is never right", "other"};
}

static void project_askew_if_other(const void *par, const pdyn_batch *b, int first, int last) {
    (((const struct exclusive *)par)->other ? project_askew : project)(par, b, first, last);
}

/* Parameters that a type refuses together are checked one by one. */
static void test_exclusive(void **state) {
    (void)state;
    pdyn_constraint_type t = good;
    t.params = exclusive_params, t.params_size = sizeof(struct exclusive);
    t.resolve = resolve_exclusive, wrong_expect(t, NULL);
    t.project = project_askew_if_other, wrong_expect(t, "(surface, not the default of \"other\")");
    t.resolve = resolve_nothing, wrong_expect(t, "is never right");
}

struct posed {
    struct params common;
    pdyn_table pose;
};

static const pdyn_param posed_params[] = {
    {"stiffness", PDYN_REAL, 0, false, 100, 0, 1e6, "N/m", "of each edge"},
    {"pose", PDYN_TABLE(PDYN_ROWS, 3), offsetof(struct posed, pose), true, 0, -1e3, 1e3, "m",
     "positions of all vertices, any number of times"},
    {0}};

/* The text of the larger trial has 20 characters for each number of the table. */
static const pdyn_param wide_params[] = {
    {"stiffness", PDYN_REAL, 0, false, 100, 0, 1e6, "N/m", "of each edge"},
    {"pose", PDYN_TABLE(PDYN_ROWS, 30), offsetof(struct posed, pose), true, 0, 0, 0.3, "m",
     "ten positions of all vertices"},
    {0}};

static pdyn_param_fault resolve_pose(void *par, const pdyn_scene_info *scene) {
    bool whole = ((const struct posed *)par)->pose.count % scene->vertices == 0;
    return (pdyn_param_fault){whole ? NULL : "has not the same rows for each vertex", "pose"};
}

static void project_askew_if_posed(const void *par, const pdyn_batch *b, int first, int last) {
    bool twice = ((const struct posed *)par)->pose.count == 2 * b->body->count;
    (twice ? project_askew : project)(par, b, first, last);
}

/* A type that compares the rows of a table with the vertices of its body. */
static void test_many_rows(void **state) {
    (void)state;
    pdyn_constraint_type t = good;
    t.params = posed_params, t.params_size = sizeof(struct posed);
    t.resolve = resolve_pose, wrong_expect(t, NULL);
    t.project = project_askew_if_posed, wrong_expect(t, "(surface, two rows per vertex)");
    t.project = project, t.params = wide_params, wrong_expect(t, NULL);
}

static void damping_rest_nothing(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par, (void)b, (void)first, (void)last;
}

static void test_mathematics(void **state) {
    (void)state;
    pdyn_constraint_type t = good;
    t.project = project_half_way, wrong_expect(t, "project is no projection");
    t.project = project_askew, wrong_expect(t, "is not that of the energy");
    t.damping = NULL, t.damping_rest = NULL, t.tangent = NULL;
    t.project = project_askew_tension, wrong_expect(t, "is not that of the energy");
    t.project = project_askew_compression, wrong_expect(t, "is not that of the energy");
    t.project = project_never, t.tangent = tangent_identity, wrong_expect(t, "not exercised");
    t = good, t.energy = energy, wrong_expect(t, "is not that of the energy");
    t = good, t.select = select_one, wrong_expect(t, "say PDYN_ANCHORED");
    wrong_expect(t, "the coefficients of row 0 sum to ");
    t = good, t.tangent = tangent_transposed, wrong_expect(t, "an asymmetric J");
    t = good, t.tangent = tangent_none, wrong_expect(t, "tangent is not that of project");
    t = good, t.tangent = tangent_large, wrong_expect(t, "an eigenvalue outside of [0, 1]");
    t = good, t.tangent = tangent_nan, wrong_expect(t, "J that is not finite");
    t = good, t.tangent = NULL, t.tangent_rank1 = axial_large,
    wrong_expect(t, "an eigenvalue outside of [0, 1]");
    t = good, t.linear = linear, wrong_expect(t, "`linear` calls linear");
    t = good, t.damping_rest = damping_rest_nothing,
    wrong_expect(t, "after damping_rest, u is not its own projection");
}

/* ---- solvers --------------------------------------------------------------------------------- */

struct solver {
    pdyn_model *model;
    double *r, *p, *q;
};

static size_t bytes(const struct solver *s) {
    return (3 * (size_t)s->model->particles + 1) * sizeof(double);
}

static void *get(struct solver *s) {
    return s->model->services->allocate(s->model->services->core, NULL, 0, bytes(s));
}

static pdyn_status create(void *self, pdyn_model *model) {
    struct solver *s = self;
    s->model = model;
    s->r = get(s), s->p = get(s), s->q = get(s);
    return s->r && s->p && s->q ? PDYN_OK : PDYN_NO_MEMORY;
}

static void put(struct solver *s, double *vector) {
    s->model->services->allocate(s->model->services->core, vector, vector ? bytes(s) : 0, 0);
}

static void release(void *self) {
    struct solver *s = self;
    put(s, s->r), put(s, s->p), put(s, s->q);
}

static void *leaked[64]; /* memory that the solver does not free; freed by the test */

static void leak(void *self) {
    struct solver *s = self;
    int k = 0;
    while (leaked[k]) k++;
    leaked[k] = s->q;
    put(s, s->r), put(s, s->p);
}

/* Conjugate gradients without preconditioner. */
static pdyn_status solve(void *self, double *b, double *y, const pdyn_stop *stop, int *iterations) {
    struct solver *s = self;
    pdyn_model *m = s->model;
    int n = 3 * m->particles;
    memcpy(s->r, b, (size_t)n * sizeof *b), memcpy(s->p, b, (size_t)n * sizeof *b);
    double rr = m->dot(m, s->r, s->r), target = stop->rel_tol * stop->rel_tol * rr;
    for (*iterations = 0; *iterations < stop->max_iterations && rr > target; ++*iterations) {
        m->product(m, s->p, s->q);
        double step = rr / m->dot(m, s->p, s->q), before = rr;
        for (int k = 0; k < n; k++) y[k] += step * s->p[k], s->r[k] -= step * s->q[k];
        rr = m->dot(m, s->r, s->r);
        for (int k = 0; k < n; k++) s->p[k] = s->r[k] + rr / before * s->p[k];
    }
    return PDYN_OK;
}

static pdyn_status solve_roughly(void *self, double *b, double *y, const pdyn_stop *stop,
                                 int *iterations) {
    pdyn_stop rough = *stop;
    rough.rel_tol = 1e-3;
    return solve(self, b, y, &rough, iterations);
}

static pdyn_status solve_by_chance(void *self, double *b, double *y, const pdyn_stop *stop,
                                   int *iterations) {
    pdyn_status status = solve(self, b, y, stop, iterations);
    y[0] *= 1.0 + 1e-10 * (atomic_fetch_add(&calls, 1) % 7);
    return status;
}

static pdyn_status solve_uncounted(void *self, double *b, double *y, const pdyn_stop *stop,
                                   int *iterations) {
    pdyn_status status = solve(self, b, y, stop, iterations);
    *iterations = 0;
    return status;
}

static pdyn_status solve_never(void *self, double *b, double *y, const pdyn_stop *stop,
                               int *iterations) {
    struct solver *s = self;
    (void)b, (void)y, (void)stop, (void)iterations;
    return s->model->services->set_error(s->model->services->core, PDYN_SOLVER_FAILED, "too hard");
}

static pdyn_status fail_silently(void *self, double *b, double *y, const pdyn_stop *stop,
                                 int *iterations) {
    (void)self, (void)b, (void)y, (void)stop, (void)iterations;
    return PDYN_SOLVER_FAILED;
}

static void expect_solver(pdyn_global_solver solver, const char *expected) {
    const pdyn_global_solver *const solvers[] = {&solver, NULL};
    const pdyn_plugin plugin = {PDYN_ABI, "p", NULL, solvers};
    wrong_expect_plugin(&plugin, expected);
}

static void test_solvers(void **state) {
    (void)state;
    const pdyn_global_solver plain = {.name = "plain",
                                      .summary = "conjugate gradients",
                                      .state_size = sizeof(struct solver),
                                      .create = create,
                                      .solve = solve,
                                      .free = release};
    pdyn_global_solver s = plain;
    expect_solver(s, NULL);
    s.solve = solve_roughly, expect_solver(s, "H y = b has a residual of");
    s.solve = fail_silently, expect_solver(s, "eps = 0: the linear solver failed (\"plain\")");
    s.solve = solve_by_chance, expect_solver(s, "not deterministic");
    s.solve = solve_uncounted, expect_solver(s, "0 iterations, expected 1 to");
    s.solve = solve_never, expect_solver(s, "too hard");
    s = plain, s.free = leak, expect_solver(s, "were not given back");
    for (int k = 0; leaked[k]; k++) free(leaked[k]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_good),           cmocka_unit_test(test_vertices),
        cmocka_unit_test(test_writes),         cmocka_unit_test(test_weights_that_change),
        cmocka_unit_test(test_steady_weights), cmocka_unit_test(test_state),
        cmocka_unit_test(test_values),         cmocka_unit_test(test_memory),
        cmocka_unit_test(test_energy),         cmocka_unit_test(test_numeric_tangent),
        cmocka_unit_test(test_switches),       cmocka_unit_test(test_exclusive),
        cmocka_unit_test(test_many_rows),      cmocka_unit_test(test_mathematics),
        cmocka_unit_test(test_solvers),
    };
    return cmocka_run_group_tests_name("wrong", tests, NULL, NULL);
}
