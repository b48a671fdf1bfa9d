/* Conformance has no fault to report of a constraint that acts in tension alone, as operator and as
 * rows. Constraint i holds the distance of particle i from particle i + 1 of the body below that at
 * rest, L:
 *
 *     C(x) = |x_i - x_(i+1)| - L <= 0,     E = k/2 max(0, C)^2
 *
 * rows: u = x_i - x_(i+1), p = L u / |u| for |u| > L. Every third particle and the last one have no
 * constraint: the weight is 0, and J = 0 is not the derivative of p = u. */
#include "wrong_support.h"

#include "projdyn/vec3.h"

#include <string.h>

enum { ROOM = 1 << 14 }; /* particles */

struct params {
    double stiffness;
};

static const pdyn_param params[] = {
    {"stiffness", PDYN_REAL, offsetof(struct params, stiffness), false, 1e3, 0, 1e6, "N/m", "k"},
    {0}};

static bool by_operator; /* the type has the operator */

static bool is_held(const pdyn_body *body, int i) { return i + 1 < body->count && i % 3 < 2; }

static double rest_length(const pdyn_body *body, int i) {
    double d[3];
    vec3_subtract(d, body->rest + 3 * i, body->rest + 3 * i + 3);
    return vec3_length(d);
}

/* ---- rows ------------------------------------------------------------------------------------ */

static int elements(const void *par, const pdyn_body *body) {
    (void)par;
    return body->count;
}

static void select_rows(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        int held = is_held(b->body, e), i = b->body->first + e;
        b->column[2 * e] = i, b->column[2 * e + 1] = i + held;
        b->coefficient[2 * e] = held, b->coefficient[2 * e + 1] = -held;
        ((double *)b->data)[e] = held ? rest_length(b->body, e) : 1.0;
    }
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = par;
    for (int e = first; e < last; e++) b->weight[e] = is_held(b->body, e) ? q->stiffness : 0.0;
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        const double *u = b->u + 3 * e, length = ((const double *)b->data)[e];
        memcpy(b->p + 3 * e, u, 3 * sizeof *u);
        if (vec3_length(u) > length) vec3_project_length(b->p + 3 * e, u, length);
    }
}

/* An operator has H = k grad C grad C', thus J = I - grad C grad C'. */
static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    (void)par;
    for (int e = first; e < last; e++, J += 9) {
        const double *u = b->u + 3 * e, length = ((const double *)b->data)[e];
        if (!is_held(b->body, e)) continue;
        if (vec3_length(u) > length)
            vec3_tangent_length(J, u, by_operator ? vec3_length(u) : length);
        else J[0] = J[4] = J[8] = 1.0;
    }
}

/* ---- operator -------------------------------------------------------------------------------- */

struct tether {
    const pdyn_services *services;
    const pdyn_body *body;
    int particles; /* of the system */
    double length[ROOM], normal[3 * ROOM];
    double value[ROOM], stiffness[ROOM], squares[ROOM], weight_sum[ROOM];
};

static void *create(const void *par, const pdyn_body *body, const pdyn_services *services) {
    struct tether *t = services->allocate(services->core, NULL, 0, sizeof *t);
    if (!t) return NULL;
    assert_true(body->count < ROOM);
    t->services = services, t->body = body;
    for (int i = 0; i < body->count; i++) {
        bool held = is_held(body, i);
        t->length[i] = held ? rest_length(body, i) : 1.0;
        t->stiffness[i] = held ? ((const struct params *)par)->stiffness : 0.0;
        t->squares[i] = held ? 2.0 : 0.0;
    }
    return t;
}

static void release(void *self) {
    struct tether *t = self;
    if (t) t->services->allocate(t->services->core, t, sizeof *t, 0);
}

static bool neighbours(void *self, const pdyn_neighbours *lists) {
    struct tether *t = self;
    assert_true(lists->particles <= ROOM);
    t->particles = lists->particles;
    return true;
}

static double local(void *self, const double *x, double *gradient) {
    struct tether *t = self;
    double energy = 0.0;
    memset(t->weight_sum, 0, sizeof t->weight_sum);
    for (int i = 0; i < t->body->count; i++) {
        int a = t->body->first + i;
        double *n = t->normal + 3 * i, k = t->stiffness[i];
        t->value[i] = -1.0;
        if (!is_held(t->body, i)) continue;
        vec3_subtract(n, x + 3 * a, x + 3 * a + 3);
        double distance = vec3_length(n), c = t->value[i] = distance - t->length[i];
        for (int j = 0; j < 3; j++) n[j] /= distance;
        if (c <= 0.0) continue;
        energy += 0.5 * k * c * c;
        vec3_add(gradient + 3 * a, k * c, n), vec3_add(gradient + 3 * a + 3, -k * c, n);
        t->weight_sum[a] += 2.0 * k, t->weight_sum[a + 1] += 2.0 * k;
    }
    return energy;
}

static pdyn_one_sided one_sided(void *self) {
    struct tether *t = self;
    return (pdyn_one_sided){t->body->count, t->value, t->stiffness, t->squares, t->weight_sum};
}

static void rate(void *self, const bool *which, const double *u, double *out) {
    struct tether *t = self;
    for (int i = 0; i < t->body->count; i++) {
        const double *n = t->normal + 3 * i, *v = u + 3 * (t->body->first + i);
        out[i] = which[i] && is_held(t->body, i) ? vec3_dot(n, v) - vec3_dot(n, v + 3) : 0.0;
    }
}

static void force(void *self, const double *multiplier, double *y) {
    struct tether *t = self;
    for (int i = 0; i < t->body->count; i++) {
        double *at = y + 3 * (t->body->first + i), *n = t->normal + 3 * i;
        if (!is_held(t->body, i)) continue;
        vec3_add(at, multiplier[i], n), vec3_add(at + 3, -multiplier[i], n);
    }
}

static void diagonal(void *self, const double *stiffness, double *blocks) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    struct tether *t = self;
    for (int i = 0; i < t->body->count; i++) {
        double *at = blocks + 6 * (t->body->first + i), *n = t->normal + 3 * i;
        for (int k = 0; k < 6 && is_held(t->body, i); k++) {
            double entry = stiffness[i] * n[row[k]] * n[column[k]];
            at[k] += entry, at[k + 6] += entry;
        }
    }
}

static const pdyn_operator tether = {.create = create,
                                     .free = release,
                                     .neighbours = neighbours,
                                     .local = local,
                                     .one_sided = one_sided,
                                     .rate = rate,
                                     .force = force,
                                     .diagonal = diagonal};

static const pdyn_constraint_type rows = {.name = "tether",
                                          .summary = "largest distance of successive particles",
                                          .flags = PDYN_ON_PARTICLES,
                                          .params_size = sizeof(struct params),
                                          .params = params,
                                          .data_size = sizeof(double),
                                          .elements = elements,
                                          .rows = 1,
                                          .width = 2,
                                          .select = select_rows,
                                          .weight = weight,
                                          .project = project,
                                          .tangent = tangent};

static void test_operator(void **state) {
    (void)state;
    pdyn_constraint_type type = rows;
    type.matrix_free = &tether, by_operator = true;
    wrong_expect(type, NULL);
    by_operator = false;
    wrong_expect(type, "have different products H u");
}

static void test_rows(void **state) {
    (void)state;
    by_operator = false;
    wrong_expect(rows, NULL);
    by_operator = true;
    wrong_expect(rows, "tangent is not that of project");
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_operator),
                                       cmocka_unit_test(test_rows)};
    return cmocka_run_group_tests_name("tension", tests, NULL, NULL);
}
