/* Limits of lengths, areas and angles, correct ones and ones with a fault: conformance reports the
 * fault. An element measures size(u) and projects to the closest u of its limit:
 *
 *     EDGE   u: an edge                              size = |u|
 *     AREA   u: two sides of a triangle              size = |u_0 x u_1|
 *     BEND   u: the sum of the heights' directions   size = |u| = 2 sin(angle / 2)
 *            of two triangles with a common side
 *
 * A limit holds the size on both sides, below the limit (it acts in tension) or above it (it acts
 * in compression). */
#include "wrong_support.h"

#include "projdyn/svd3.h"

#include <stdatomic.h>
#include <string.h>

enum shape { EDGE, AREA, BEND };
enum side { BOTH, AT_MOST, AT_LEAST };

enum fault {
    NONE,
    ROUNDED, /* not a fault: where the limit does not act, p is u up to rounding */
    /* project */
    WRONG_LENGTH, /* another size than the limit, on one side */
    WRONG_SHORT,  /* the same, on the other side */
    OUTWARD,      /* the wrong sign */
    HALF_WAY,
    SCALED_ROW,  /* reaches the area with the first row alone */
    SCALED_ALL,  /* reaches the area by scaling all rows */
    BOTH_SIDES,  /* acts on both sides, although PDYN_ONE_SIDED */
    NEIGHBOUR,   /* measures the element before, too */
    NOT_AT_ZERO, /* divides by the length of u = 0 */
    COUNTS_CALLS,
    WRITES_DATA,
    NEVER, /* a limit out of reach */
    /* tangent */
    TANGENT_ALWAYS_ONE,
    TANGENT_ALWAYS_ZERO,
    TANGENT_WITHOUT_CLAMP,
    TANGENT_WITHOUT_LENGTH, /* I - n n' without the factor l / |u| */
    TANGENT_ABSOLUTE,       /* counts its elements from the first of the batch */
    TANGENT_COUNTS_CALLS,
    TANGENT_NOT_ZERO_AGAIN, /* writes only where the limit acts, over what it finds there */
    /* energy */
    ENERGY_DOUBLE,
    ENERGY_OF_ALL, /* of the batch, in any range */
    ENERGY_OF_SLACK,
    ENERGY_JUMPS, /* where the limit begins to act */
    /* select, weight */
    SUM_NOT_ZERO,
    SUM_OF_ENDS,
    WITHOUT_FIRST, /* vertices of the body as particles of the system */
    BEYOND_BODY,
    COEFFICIENT_NAN,
    SHIFTED_WRITE, /* data of the next element */
    WEIGHT_OF_U,
    WEIGHT_OF_NEIGHBOUR,
    WEIGHT_NAN,
    WEIGHT_SHRINKS,
    /* row_sizes, parameters */
    ROWS_COUNT_CALLS,
    ROWS_NEGATIVE,
    OFFSET_BEYOND,
    RESOLVE_NAN,
    RESOLVE_LIMIT_NAN,
    RESOLVE_REFUSES,
};

static struct variant {
    enum fault fault;
    enum shape shape;
    enum side side;
    const char *expected;
} now;

static atomic_int calls;

struct params {
    double stiffness, limit;
};

/* ---- rows ------------------------------------------------------------------------------------ */

static int elements(const void *par, const pdyn_body *body) {
    (void)par;
    return now.shape == EDGE   ? body->edges
           : now.shape == AREA ? body->triangles
                               : 3 * body->triangles;
}

/* BEND: no row where a side of the triangle is on the border. */
static void row_sizes(const void *par, const pdyn_batch *b, int e, int *rows, int *width) {
    (void)par;
    *rows = now.shape == AREA ? 2 : now.shape == BEND && b->body->across[e] < 0 ? 0 : 1;
    *width = now.shape == BEND ? 4 : 2;
    /* after core has called it twice for each element */
    if (now.fault == ROWS_COUNT_CALLS && atomic_fetch_add(&calls, 1) >= 2 * b->elements) *rows += 1;
    if (now.fault == ROWS_NEGATIVE && e == 5) *rows = -1;
}

/* The rest of the side a, b and the height of the corner c over it: c is `share` of the way along
 * the side. Returns the height, m. */
static double height_of(const pdyn_body *body, int a, int b, int c, double *share) {
    double side[3], to[3];
    vec3_subtract(side, body->rest + 3 * b, body->rest + 3 * a);
    vec3_subtract(to, body->rest + 3 * c, body->rest + 3 * a);
    *share = vec3_dot(side, to) / vec3_dot(side, side);
    vec3_add(to, -*share, side);
    return vec3_length(to);
}

static void select_bend(const pdyn_batch *b, int e, int *column, double *coefficient) {
    const int *corner = b->body->triangle, first = e / 3 * 3;
    int from = corner[first + (e + 1) % 3], to = corner[first + (e + 2) % 3];
    column[0] = from, column[1] = to;
    for (int k = 0; k < 2; k++) {
        double share;
        column[2 + k] = corner[k ? b->body->across[e] : e];
        coefficient[2 + k] = 1.0 / height_of(b->body, from, to, column[2 + k], &share);
        coefficient[0] -= (1.0 - share) * coefficient[2 + k];
        coefficient[1] -= share * coefficient[2 + k];
    }
}

static void select_side(int *column, double *coefficient, int from, int to) {
    column[0] = from, column[1] = to, coefficient[0] = -1.0, coefficient[1] = 1.0;
}

static void select_element(const pdyn_batch *b, int e, int *column, double *coefficient) {
    const int *edge = b->body->edge + 2 * e, *corner = b->body->triangle + 3 * e;
    if (now.shape == EDGE) select_side(column, coefficient, edge[0], edge[1]);
    if (now.shape == BEND) select_bend(b, e, column, coefficient);
    for (int k = 0; k < 2 && now.shape == AREA; k++)
        select_side(column + 2 * k, coefficient + 2 * k, corner[0], corner[1 + k]);
}

/* The size at rest. */
static double rest_size(const pdyn_body *body, int e) {
    const int *edge = body->edge + 2 * e;
    if (now.shape == EDGE) return vec3_distance(body->rest + 3 * edge[0], body->rest + 3 * edge[1]);
    return now.shape == AREA ? 2.0 * body->triangle_area[e] : 1.0;
}

static void wrong_rows(const pdyn_batch *b, int *column, double *coefficient, int entries) {
    for (int k = 0; k < entries; k++)
        if (now.fault == WITHOUT_FIRST) column[k] -= b->body->first;
        else if (now.fault == BEYOND_BODY) column[k] += 1;
        else if (now.fault == SUM_OF_ENDS) coefficient[k] = fabs(coefficient[k]);
    if (now.fault == SUM_NOT_ZERO) coefficient[0] *= 1.01;
    if (now.fault == COEFFICIENT_NAN) coefficient[0] = NAN;
}

static void select_rows(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = par;
    for (int e = first; e < last; e++) {
        int from = b->row_entry[b->element_row[e]], to = b->row_entry[b->element_row[e + 1]];
        double *data = b->data;
        data[e] = 0.0;
        if (from == to) continue;
        memset(b->coefficient + from, 0, (size_t)(to - from) * sizeof *b->coefficient);
        select_element(b, e, b->column + from, b->coefficient + from);
        for (int k = from; k < to; k++) b->column[k] += b->body->first;
        wrong_rows(b, b->column + from, b->coefficient + from, to - from);
        data[e] = q->limit * rest_size(b->body, e);
        if (now.fault == SHIFTED_WRITE && e + 1 < b->elements) data[e + 1] = data[e];
    }
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++) {
        double w = ((const struct params *)par)->stiffness;
        if (now.fault == WEIGHT_OF_U) w *= 1.0 + vec3_length(b->u + 3 * b->element_row[e]);
        if (now.fault == WEIGHT_OF_NEIGHBOUR && e) w = 0.5 * (w + b->weight[e - 1]) + 1.0;
        if (now.fault == WEIGHT_NAN && e == 7) w = NAN;
        if (now.fault == WEIGHT_SHRINKS) w /= 1.0 + atomic_fetch_add(&calls, 1);
        b->weight[e] = w;
    }
}

/* ---- projection ------------------------------------------------------------------------------ */

static double size_of(const double *u) {
    double cross[3];
    if (now.shape != AREA) return vec3_length(u);
    vec3_cross(cross, u, u + 3);
    return vec3_length(cross);
}

/* The closest s to the singular values `from` with s_0 s_1 = area: s_0 = from_0 - t s_1, s_1 =
 * from_1 - t s_0. The area falls with t; bisection finds t. */
static void closest_stretches(const double *from, double area, double *s) {
    double low = -1.0, high = from[1] / from[0];
    for (int k = 0; k < 100; k++) {
        double t = 0.5 * (low + high), scale = 1.0 / (1.0 - t * t);
        s[0] = scale * (from[0] - t * from[1]), s[1] = scale * (from[1] - t * from[0]);
        if (s[0] * s[1] > area) low = t;
        else high = t;
    }
}

static void project_area(const double *u, double area, double *p) {
    double F[9] = {0}, s[3] = {0};
    memcpy(F, u, 6 * sizeof *F);
    svd3 d = svd3_of(F);
    if (!(d.s[0] > 0.0)) return;
    closest_stretches(d.s, area, s);
    svd3_compose(&d, s, F);
    memcpy(p, F, 6 * sizeof *F);
}

static bool acts(double size, double limit) {
    enum side side = now.fault == BOTH_SIDES ? BOTH : now.side;
    return side == BOTH || (side == AT_MOST ? size > limit : size < limit);
}

/* The limit that a variant projects to. */
static double target_of(double size, double limit) {
    if (now.fault == WRONG_SHORT) return size < limit ? 1.1 * limit : limit;
    if (now.fault != WRONG_LENGTH) return limit;
    if (now.side == AT_LEAST) return 1.1 * limit;
    return size > limit ? 0.9 * limit : limit;
}

/* A projection that is none, instead of p. */
static void spoil(const double *u, double size, double limit, double *p, int n) {
    double ratio = size > 0.0 ? limit / size : 0.0;
    for (int k = 0; k < n; k++)
        if (now.fault == OUTWARD) p[k] = 2.0 * u[k] - p[k];
        else if (now.fault == HALF_WAY) p[k] = 0.5 * (u[k] + p[k]);
        else if (now.fault == SCALED_ROW) p[k] = k < 3 ? ratio * u[k] : u[k];
        else if (now.fault == SCALED_ALL) p[k] = sqrt(ratio) * u[k];
        else if (now.fault == NOT_AT_ZERO) p[k] = u[k] * limit / size;
        else if (now.fault == COUNTS_CALLS) p[k] += 1e-9 * atomic_fetch_add(&calls, 1);
}

static double limit_of(const pdyn_batch *b, int e) { return ((const double *)b->data)[e]; }

static void project_element(const pdyn_batch *b, int e) {
    int row = b->element_row[e], n = 3 * (b->element_row[e + 1] - row);
    const double *u = b->u + 3 * row;
    double *p = b->p + 3 * row, limit = limit_of(b, e), size;
    if (!n) return;
    memcpy(p, u, (size_t)n * sizeof *p);
    size = size_of(u);
    if (now.fault == NEIGHBOUR && e) size = fmax(size, size_of(u - n));
    for (int k = 0; k < n && now.fault == ROUNDED; k++) p[k] = u[k] * 1.1 / 1.1;
    if (!acts(size, limit)) return;
    if (now.shape == AREA) project_area(u, target_of(size, limit), p);
    else vec3_project_length(p, u, target_of(size, limit));
    spoil(u, size, limit, p, n);
    if (now.fault == WRITES_DATA) ((double *)b->data)[e] = 0.999 * limit;
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) project_element(b, e);
}

/* ---- tangent (EDGE and BEND), energy --------------------------------------------------------- */

static void tangent_element(const double *u, double limit, double *J) {
    bool acting = acts(vec3_length(u), limit) && now.fault != TANGENT_ALWAYS_ONE;
    double squared = fmax(vec3_dot(u, u), 1e-300), ratio = limit / sqrt(squared);
    if (now.fault == TANGENT_ALWAYS_ZERO) return;
    if (!acting && now.fault == TANGENT_NOT_ZERO_AGAIN) return;
    if (now.fault == TANGENT_WITHOUT_LENGTH) ratio = 1.0;
    if (now.fault != TANGENT_WITHOUT_CLAMP) ratio = fmin(ratio, 1.0);
    for (int k = 0; k < 9; k++) {
        double unit = k % 4 == 0;
        J[k] = acting ? ratio * (unit - u[k / 3] * u[k % 3] / squared) : unit;
        if (now.fault == TANGENT_COUNTS_CALLS) J[k] *= 1.0 - 1e-9 * atomic_fetch_add(&calls, 1);
    }
}

static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    (void)par;
    if (now.fault == TANGENT_ABSOLUTE) J += 9 * b->element_row[first];
    for (int e = first; e < last; e++)
        if (b->element_row[e + 1] > b->element_row[e]) {
            tangent_element(b->u + 3 * b->element_row[e], limit_of(b, e), J);
            J += 9;
        }
}

static double energy(const void *par, const pdyn_batch *b, int first, int last) {
    double sum = 0.0;
    (void)par;
    if (now.fault == ENERGY_OF_ALL) first = 0, last = b->elements;
    for (int e = first; e < last; e++)
        for (int k = 3 * b->element_row[e]; k < 3 * b->element_row[e + 1]; k++) {
            double d = b->u[k] - b->p[k];
            if (now.fault == ENERGY_OF_SLACK && d == 0.0) d = 0.1 * b->u[k];
            sum += (now.fault == ENERGY_DOUBLE ? 1.0 : 0.5) * b->weight[e] * d * d;
        }
    for (int e = first; e < last && now.fault == ENERGY_JUMPS; e++)
        sum += acts(size_of(b->u + 3 * b->element_row[e]), limit_of(b, e)) ? 0.02 : 0.0;
    return sum;
}

/* ---- the type -------------------------------------------------------------------------------- */

static pdyn_param_fault resolve(void *par, const pdyn_scene_info *scene) {
    struct params *q = par;
    double nan = sqrt(-1.0 - scene->radius);
    if (now.fault == RESOLVE_NAN) q->stiffness = nan;
    if (now.fault == RESOLVE_LIMIT_NAN) q->limit = nan;
    return (pdyn_param_fault){now.fault == RESOLVE_REFUSES ? "is too soft" : NULL, NULL};
}

/* The limit over the size at rest; BEND: 2 sin(angle / 2) at most. */
static double default_limit(void) {
    if (now.fault == NEVER) return now.side == AT_MOST ? 100.0 : 0.0;
    if (now.fault == ROUNDED) return 1.4; /* acts in the crumpled state alone */
    if (now.fault == TANGENT_ALWAYS_ONE && now.side == AT_MOST) return 1.7; /* few act */
    if (now.shape == BEND) return now.side == BOTH ? 0.3 : 0.5;
    return now.side == BOTH ? 1.0 : now.side == AT_MOST ? 1.1 : 0.9;
}

static bool is_reported(const struct variant *variant) {
    now = *variant;
    atomic_store(&calls, 0);
    size_t beyond = now.fault == OFFSET_BEYOND ? sizeof(struct params) : 0;
    const pdyn_param params[] = {{"stiffness", PDYN_REAL, offsetof(struct params, stiffness), false,
                                  100, 0, 1e6, "N/m", "force per length"},
                                 {"limit", PDYN_REAL, offsetof(struct params, limit) + beyond,
                                  false, default_limit(), 0, 1e3, "1", "size over that at rest"},
                                 {0}};
    bool own_energy = now.fault >= ENERGY_DOUBLE && now.fault <= ENERGY_JUMPS;
    const pdyn_constraint_type type = {.name = "limit",
                                       .summary = "keeps sizes in limits",
                                       .flags = PDYN_ON_SURFACE | (now.side ? PDYN_ONE_SIDED : 0u),
                                       .params_size = sizeof(struct params),
                                       .params = params,
                                       .resolve = resolve,
                                       .data_size = sizeof(double),
                                       .elements = elements,
                                       .row_sizes = row_sizes,
                                       .select = select_rows,
                                       .weight = weight,
                                       .project = project,
                                       .tangent = now.shape == AREA ? NULL : tangent,
                                       .energy = own_energy ? energy : NULL};
    if (wrong_type_is_reported(type, now.expected)) return true;
    print_error("... of the fault %d, shape %d, side %d\n", (int)now.fault, (int)now.shape,
                (int)now.side);
    return false;
}

static void examine(const struct variant *variants, size_t count) {
    size_t reported = 0;
    for (size_t k = 0; k < count; k++) reported += is_reported(&variants[k]);
    assert_int_equal(reported, count);
}

#define EXAMINE(variants) examine(variants, sizeof(variants) / sizeof *(variants))

/* No false alarm. */
static void test_good_long(void **state) {
    (void)state;
    static const struct variant good[] = {
        {NONE, EDGE, BOTH, NULL},       {NONE, EDGE, AT_MOST, NULL}, {NONE, EDGE, AT_LEAST, NULL},
        {NONE, AREA, BOTH, NULL},       {NONE, AREA, AT_MOST, NULL}, {NONE, AREA, AT_LEAST, NULL},
        {NONE, BEND, BOTH, NULL},       {NONE, BEND, AT_MOST, NULL}, {ROUNDED, EDGE, AT_MOST, NULL},
        {ROUNDED, AREA, AT_MOST, NULL},
    };
    EXAMINE(good);
}

static void test_project(void **state) {
    (void)state;
    static const char none[] = "project is no projection", closest[] = "p is not the closest point",
                      again[] = "project gives another p";
    static const struct variant wrong[] = {
        {WRONG_LENGTH, EDGE, BOTH, none},
        {WRONG_LENGTH, EDGE, AT_MOST, none},
        {WRONG_LENGTH, EDGE, AT_LEAST, none},
        {WRONG_LENGTH, AREA, BOTH, none},
        {WRONG_LENGTH, AREA, AT_MOST, none},
        {WRONG_LENGTH, AREA, AT_LEAST, none},
        {WRONG_LENGTH, BEND, BOTH, none},
        {WRONG_LENGTH, BEND, AT_MOST, none},
        {WRONG_SHORT, EDGE, BOTH, none},
        {WRONG_SHORT, AREA, BOTH, none},
        {WRONG_SHORT, BEND, BOTH, none},
        {OUTWARD, EDGE, BOTH, none},
        {OUTWARD, EDGE, AT_MOST, none},
        {OUTWARD, EDGE, AT_LEAST, none},
        {OUTWARD, AREA, BOTH, none},
        {OUTWARD, AREA, AT_MOST, none},
        {OUTWARD, BEND, BOTH, none},
        {OUTWARD, BEND, AT_MOST, none},
        {HALF_WAY, EDGE, AT_MOST, none},
        {HALF_WAY, EDGE, AT_LEAST, none},
        {HALF_WAY, AREA, BOTH, none},
        {HALF_WAY, AREA, AT_LEAST, none},
        {HALF_WAY, BEND, AT_MOST, none},
        {SCALED_ROW, AREA, BOTH, closest},
        {SCALED_ROW, AREA, AT_MOST, closest},
        {SCALED_ALL, AREA, BOTH, closest},
        {SCALED_ALL, AREA, AT_MOST, closest},
        {SCALED_ALL, AREA, AT_LEAST, closest},
        {BOTH_SIDES, EDGE, AT_MOST, "PDYN_ONE_SIDED"},
        {BOTH_SIDES, EDGE, AT_LEAST, "PDYN_ONE_SIDED"},
        {BOTH_SIDES, AREA, AT_MOST, "PDYN_ONE_SIDED"},
        {BOTH_SIDES, BEND, AT_MOST, "PDYN_ONE_SIDED"},
        {NEIGHBOUR, EDGE, AT_MOST, again},
        {NEIGHBOUR, AREA, AT_MOST, again},
        {NOT_AT_ZERO, EDGE, BOTH, "not finite"},
        {NOT_AT_ZERO, EDGE, AT_LEAST, "not finite"},
        {COUNTS_CALLS, EDGE, AT_MOST, again},
        {COUNTS_CALLS, AREA, AT_LEAST, again},
        {COUNTS_CALLS, BEND, BOTH, again},
        {WRITES_DATA, EDGE, AT_MOST, "project writes data, which it may only read"},
        {NEVER, EDGE, AT_MOST, "not exercised"},
        {NEVER, AREA, AT_LEAST, "not exercised"},
        {NEVER, BEND, AT_MOST, "not exercised"},
    };
    EXAMINE(wrong);
}

static void test_tangent(void **state) {
    (void)state;
    static const char other[] = "tangent is not that of project",
                      again[] = "tangent gives another J";
    static const struct variant wrong[] = {
        {TANGENT_ALWAYS_ONE, EDGE, AT_MOST, other},
        {TANGENT_ALWAYS_ONE, EDGE, AT_LEAST, other},
        {TANGENT_ALWAYS_ONE, BEND, AT_MOST, other},
        {TANGENT_ALWAYS_ZERO, EDGE, AT_MOST, other},
        {TANGENT_ALWAYS_ZERO, BEND, AT_MOST, other},
        {TANGENT_WITHOUT_CLAMP, EDGE, BOTH, "an eigenvalue outside of [0, 1]"},
        {TANGENT_WITHOUT_CLAMP, EDGE, AT_LEAST, "an eigenvalue outside of [0, 1]"},
        {TANGENT_WITHOUT_LENGTH, EDGE, AT_MOST, other},
        {TANGENT_WITHOUT_LENGTH, BEND, BOTH, other},
        {TANGENT_ABSOLUTE, EDGE, BOTH, "tangent writes J outside of its elements"},
        {TANGENT_COUNTS_CALLS, EDGE, AT_LEAST, again},
        {TANGENT_NOT_ZERO_AGAIN, EDGE, AT_MOST, other},
    };
    EXAMINE(wrong);
}

static void test_energy(void **state) {
    (void)state;
    static const char slope[] = "is not that of the energy", ranges[] = "energy of all elements",
                      jump[] = "is not the work";
    static const struct variant wrong[] = {
        {ENERGY_DOUBLE, EDGE, AT_MOST, slope},   {ENERGY_DOUBLE, AREA, AT_LEAST, slope},
        {ENERGY_DOUBLE, BEND, BOTH, slope},      {ENERGY_OF_ALL, EDGE, BOTH, ranges},
        {ENERGY_OF_ALL, AREA, AT_MOST, ranges},  {ENERGY_OF_SLACK, EDGE, AT_MOST, slope},
        {ENERGY_OF_SLACK, BEND, AT_MOST, slope}, {ENERGY_JUMPS, EDGE, AT_MOST, jump},
        {ENERGY_JUMPS, AREA, AT_LEAST, jump},
    };
    EXAMINE(wrong);
}

static void test_rows(void **state) {
    (void)state;
    static const char sum[] = "say PDYN_ANCHORED", weight_again[] = "weight gives another weight";
    static const struct variant wrong[] = {
        {SUM_NOT_ZERO, EDGE, AT_MOST, sum},
        {SUM_NOT_ZERO, AREA, BOTH, sum},
        {SUM_NOT_ZERO, BEND, BOTH, sum},
        {SUM_OF_ENDS, EDGE, AT_MOST, sum},
        {WITHOUT_FIRST, EDGE, BOTH, "element 0 selects particle 0, expected"},
        {WITHOUT_FIRST, AREA, AT_LEAST, "element 0 selects particle 0, expected"},
        {WITHOUT_FIRST, BEND, AT_MOST, "selects particle"},
        {BEYOND_BODY, BEND, BOTH, "selects particle"},
        {COEFFICIENT_NAN, AREA, BOTH, "a coefficient that is not finite"},
        {SHIFTED_WRITE, EDGE, BOTH, "select writes data outside of its elements"},
        {WEIGHT_OF_U, EDGE, AT_MOST, weight_again},
        {WEIGHT_OF_NEIGHBOUR, EDGE, BOTH, weight_again},
        {WEIGHT_NAN, AREA, BOTH, "element 7 has the weight nan"},
        {WEIGHT_SHRINKS, BEND, BOTH, weight_again},
        {ROWS_COUNT_CALLS, AREA, BOTH, "row_sizes gives other rows"},
        {ROWS_NEGATIVE, EDGE, BOTH, "element 5 has -1 rows"},
        {OFFSET_BEYOND, EDGE, BOTH, "parameter \"limit\": it lies outside of params_size"},
        {RESOLVE_NAN, EDGE, BOTH, "has the weight"},
        {RESOLVE_LIMIT_NAN, EDGE, BOTH, "not finite"},
        {RESOLVE_LIMIT_NAN, EDGE, AT_MOST, "limit"},
        {RESOLVE_REFUSES, EDGE, BOTH, "is too soft"},
    };
    EXAMINE(wrong);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_good_long), cmocka_unit_test(test_project),
        cmocka_unit_test(test_tangent),   cmocka_unit_test(test_energy),
        cmocka_unit_test(test_rows),
    };
    return cmocka_run_group_tests_name("wrong limits", tests, NULL, NULL);
}
