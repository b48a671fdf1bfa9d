/* Rigid bodies: poses, the extension of vectors to vertices, its transpose, and construction. */
#include "rigid_map.h"

#include "projdyn/svd3.h"

#include <string.h>

static int first_point(const struct rigid_body *b) { return b->first + b->vertices; }

/* Of a symmetric matrix. */
static void invert(const double I[9], double inverse[9]) {
    double determinant = vec3_cofactors(inverse, I);
    for (int k = 0; k < 9; k++) inverse[k] /= determinant;
}

/* ---- one body -------------------------------------------------------------------------------- */

void rigid_body_centre(const struct rigid_body *b, const double *x, double c[3]) {
    c[0] = c[1] = c[2] = 0.0;
    for (int a = 0; a < RIGID_POINTS; a++)
        vec3_add(c, 1.0 / RIGID_POINTS, x + 3 * (size_t)(first_point(b) + a));
}

void rigid_body_matrix(const struct rigid_body *b, const double *x, double A[9]) {
    double c[3], r[3];
    rigid_body_centre(b, x, c);
    memset(A, 0, 9 * sizeof *A);
    for (int a = 0; a < RIGID_POINTS; a++) {
        vec3_subtract(r, x + 3 * (size_t)(first_point(b) + a), c);
        for (int k = 0; k < 9; k++) A[k] += r[k / 3] * b->frame[a][k % 3];
    }
}

void rigid_body_weights(const struct rigid_body *b, const double *x, const double arm[3],
                        double w[RIGID_POINTS]) {
    double A[9], at_rest[3] = {0};
    rigid_body_matrix(b, x, A);
    for (int a = 0; a < 3; a++) vec3_add(at_rest, arm[a], A + 3 * a);
    for (int k = 0; k < RIGID_POINTS; k++)
        w[k] = 1.0 / RIGID_POINTS + vec3_dot(b->frame[k], at_rest);
}

void rigid_body_place(const struct rigid_body *b, const double c[3], const double R[9], double *x) {
    for (int i = 0; i < rigid_body_particles(b); i++) {
        double r[3], *to = x + 3 * (size_t)(b->first + i);
        vec3_subtract(r, b->rest + 3 * (size_t)i, b->centre);
        vec3_multiply(to, R, r);
        vec3_add(to, 1.0, c);
    }
}

void rigid_body_set_motion(const struct rigid_body *b, const double *x, const double c[3],
                           const double velocity[3], const double w[3], double *v) {
    for (int i = b->first; i < rigid_body_end(b); i++) {
        double r[3];
        vec3_subtract(r, x + 3 * (size_t)i, c);
        vec3_cross(v + 3 * (size_t)i, w, r);
        vec3_add(v + 3 * (size_t)i, 1.0, velocity);
    }
}

void rigid_body_moment(const struct rigid_body *b, int begin, const double *x, const double c[3],
                       const double *y, double force[3], double moment[3]) {
    memset(force, 0, 3 * sizeof *force), memset(moment, 0, 3 * sizeof *moment);
    for (int i = begin; i < rigid_body_end(b); i++) {
        double r[3], turn[3];
        vec3_subtract(r, x + 3 * (size_t)i, c);
        vec3_cross(turn, r, y + 3 * (size_t)i);
        vec3_add(force, 1.0, y + 3 * (size_t)i), vec3_add(moment, 1.0, turn);
    }
}

void rigid_add_inertia(double I[9], double mass, const double *r) {
    for (int k = 0; k < 9; k++)
        I[k] += mass * ((k % 4 ? 0.0 : vec3_dot(r, r)) - r[k / 3] * r[k % 3]);
}

void rigid_body_inertia(const struct rigid_body *b, const double *x, const double c[3],
                        double I[9]) {
    memset(I, 0, 9 * sizeof *I);
    for (int a = 0; a < RIGID_POINTS; a++) {
        double r[3];
        vec3_subtract(r, x + 3 * (size_t)(first_point(b) + a), c);
        rigid_add_inertia(I, b->mass / RIGID_POINTS, r);
    }
}

/* ---- positions ------------------------------------------------------------------------------- */

/* Largest entry of A'A - I up to which positions are rigid: rounding errors. */
static const double rigid_enough = 1e-12;

/* svd3.h has matrices column by column: A = sum s_i left_i right_i' for F = A', R accordingly. */
void rigid_closest_rotation(const double A[9], double R[9]) {
    const double ones[3] = {1.0, 1.0, 1.0};
    double columns[9], rotation[9];
    for (int k = 0; k < 9; k++) columns[k] = A[3 * (k % 3) + k / 3];
    const svd3 d = svd3_of(columns);
    svd3_compose(&d, ones, rotation);
    for (int k = 0; k < 9; k++) R[k] = rotation[3 * (k % 3) + k / 3];
}

static bool is_rotation(const double A[9]) {
    double worst = 0.0;
    for (int k = 0; k < 9; k++) {
        const double *p = A + k / 3, *q = A + k % 3;
        double dot = p[0] * q[0] + p[3] * q[3] + p[6] * q[6];
        worst = fmax(worst, fabs(dot - (k % 4 == 0)));
    }
    return worst <= rigid_enough;
}

struct loop { /* the arguments of a parallel loop over bodies */
    const struct rigid_map *map;
    const double *in;
    double *out;
};

static void for_bodies(const struct rigid_map *map, pdyn_range_fn *fn, const double *in,
                       double *out) {
    struct loop loop = {map, in, out};
    pool_for(map->context->pool, map->bodies, RIGID_GRAIN, fn, &loop);
}

static void retract(void *arg, int first, int last, int block) {
    (void)block;
    const struct loop *c = arg;
    for (int k = first; k < last; k++) {
        struct rigid_body *b = &c->map->body[k];
        double A[9], R[9], centre[3];
        rigid_body_matrix(b, c->out, A);
        b->bent = !is_rotation(A);
        if (!b->bent) continue;
        rigid_closest_rotation(A, R);
        rigid_body_centre(b, c->out, centre);
        rigid_body_place(b, centre, R, c->out);
    }
}

bool rigid_map_retract(const struct rigid_map *map, double *x) {
    bool bent = false;
    for_bodies(map, retract, NULL, x);
    for (int k = 0; k < map->bodies; k++) bent |= map->body[k].bent;
    return bent;
}

static void update(void *arg, int first, int last, int block) {
    (void)block;
    const struct loop *c = arg;
    for (int k = first; k < last; k++) {
        struct rigid_body *b = &c->map->body[k];
        double centre[3], I[9];
        rigid_body_centre(b, c->in, centre);
        for (int i = 0; i < rigid_body_particles(b); i++)
            vec3_subtract(b->arm + 3 * (size_t)i, c->in + 3 * (size_t)(b->first + i), centre);
        rigid_body_inertia(b, c->in, centre, I);
        invert(I, b->inverse);
        for (int m = 0; m < 9; m++) b->inverse[m] *= b->mass / RIGID_POINTS;
    }
}

void rigid_map_update(struct rigid_map *map, const double *x) { for_bodies(map, update, x, NULL); }

/* ---- displacements and forces ---------------------------------------------------------------- */

void rigid_body_sum(const struct rigid_body *b, int begin, const double *f,
                    double sum[RIGID_SIZE]) {
    memset(sum, 0, RIGID_SIZE * sizeof *sum);
    for (int i = begin; i < rigid_body_particles(b); i++) {
        double turn[3];
        const double *own = f + 3 * (size_t)(b->first + i);
        vec3_cross(turn, b->arm + 3 * (size_t)i, own);
        for (int a = 0; a < 3; a++) sum[a] += own[a], sum[3 + a] += turn[a];
    }
}

void rigid_body_move(const struct rigid_body *b, int begin, const double motion[RIGID_SIZE],
                     double *u) {
    const double *t = motion, *w = motion + 3;
    for (int i = begin; i < rigid_body_particles(b); i++) {
        double *own = u + 3 * (size_t)(b->first + i);
        vec3_cross(own, w, b->arm + 3 * (size_t)i);
        vec3_add(own, 1.0, t);
    }
}

double rigid_body_mobility(const struct rigid_body *b, int i, int j, const double *n) {
    double turn[3], moment[3], spin[3];
    vec3_cross(turn, b->arm + 3 * (size_t)(i - b->first), n);
    vec3_cross(moment, b->arm + 3 * (size_t)(j - b->first), n);
    vec3_multiply(spin, b->inverse, moment);
    return (1.0 + RIGID_POINTS * vec3_dot(turn, spin)) / b->mass;
}

/* The mean over the points of sums of them, and the rotation that has these moments. */
static void mean_motion(const struct rigid_body *b, const double sum[RIGID_SIZE],
                        double motion[RIGID_SIZE]) {
    for (int a = 0; a < 3; a++) motion[a] = sum[a] / RIGID_POINTS;
    vec3_multiply(motion + 3, b->inverse, sum + 3);
}

static void extend(void *arg, int first, int last, int block) {
    (void)block;
    const struct loop *c = arg;
    for (int k = first; k < last; k++) {
        const struct rigid_body *b = &c->map->body[k];
        double sum[RIGID_SIZE], motion[RIGID_SIZE];
        rigid_body_sum(b, b->vertices, c->out, sum);
        mean_motion(b, sum, motion);
        rigid_body_move(b, 0, motion, c->out);
    }
}

void rigid_map_extend(const struct rigid_map *map, double *u) { for_bodies(map, extend, NULL, u); }

const double *rigid_map_extended(struct rigid_map *map, int first, int last, const double *u) {
    size_t start = 3 * (size_t)first, count = 3 * (size_t)(last - first);
    memcpy(map->input + start, u + start, count * sizeof *u);
    rigid_map_extend(map, map->input);
    return map->input;
}

static void pull(void *arg, int first, int last, int block) {
    (void)block;
    const struct loop *c = arg;
    for (int k = first; k < last; k++) {
        const struct rigid_body *b = &c->map->body[k];
        double sum[RIGID_SIZE], motion[RIGID_SIZE];
        rigid_body_sum(b, 0, c->out, sum);
        mean_motion(b, sum, motion);
        memset(c->out + 3 * (size_t)b->first, 0, 3 * (size_t)b->vertices * sizeof(double));
        rigid_body_move(b, b->vertices, motion, c->out);
    }
}

void rigid_map_pull(const struct rigid_map *map, double *y) { for_bodies(map, pull, NULL, y); }

void rigid_map_close_blocks(const struct rigid_map *map, double inertia, double *blocks) {
    for (int k = 0; k < map->bodies; k++) {
        const struct rigid_body *b = &map->body[k];
        for (int i = b->first; i < first_point(b); i++) {
            double *own = blocks + 6 * (size_t)i;
            memset(own, 0, 6 * sizeof *own);
            vec3_add_identity(own, inertia * map->effective_mass[i]);
        }
    }
}

/* ---- creation -------------------------------------------------------------------------------- */

/* The gradients of the affine coordinates: frame_a = M^-1 r_a with M = sum r_a r_a'. */
static void set_frame(struct rigid_body *b) {
    double M[9] = {0}, inverse[9], r[RIGID_POINTS][3];
    for (int a = 0; a < RIGID_POINTS; a++) {
        vec3_subtract(r[a], b->rest + 3 * (size_t)(b->vertices + a), b->centre);
        for (int k = 0; k < 9; k++) M[k] += r[a][k / 3] * r[a][k % 3];
    }
    invert(M, inverse);
    for (int a = 0; a < RIGID_POINTS; a++) vec3_multiply(b->frame[a], inverse, r[a]);
}

/* The effective mass of particle i: 1 over the mean of its mobility along three directions. */
static double mass_at(const struct rigid_body *b, int i) {
    double sum = 0.0;
    for (int a = 0; a < 3; a++) {
        double unit[3] = {0};
        unit[a] = 1.0;
        sum += rigid_body_mobility(b, i, i, unit);
    }
    return 3.0 / sum;
}

static bool resize(struct rigid_map *map, enum array_action action) {
    const struct array_entry table[] = {
        ARRAY(map->input, 3 * (size_t)map->particles + 1),
        ARRAY(map->effective_mass, map->particles),
        ARRAY(map->owner, map->particles),
    };
    bool good = context_arrays(map->context, table, ARRAY_ROWS(table), action);
    for (int k = 0; k < map->bodies; k++) {
        struct rigid_body *b = &map->body[k];
        const struct array_entry own[] = {ARRAY(b->arm, 3 * (size_t)rigid_body_particles(b))};
        good &= context_arrays(map->context, own, ARRAY_ROWS(own), action);
    }
    return good;
}

pdyn_status rigid_map_create(struct rigid_map *map, const double *rest) {
    if (!resize(map, ARRAYS_ALLOCATE)) return PDYN_NO_MEMORY;
    for (int k = 0; k < map->bodies; k++) {
        struct rigid_body *b = &map->body[k];
        b->rest = rest + 3 * (size_t)b->first;
        rigid_body_centre(b, rest, b->centre);
        rigid_body_inertia(b, rest, b->centre, b->inertia);
        set_frame(b);
    }
    rigid_map_update(map, rest);
    for (int i = 0; i < map->particles; i++) map->owner[i] = -1;
    for (int k = 0; k < map->bodies; k++)
        for (int i = 0; i < rigid_body_particles(&map->body[k]); i++)
            map->owner[map->body[k].first + i] = k;
    for (int k = 0; k < map->bodies; k++)
        for (int i = map->body[k].first; i < first_point(&map->body[k]); i++)
            map->effective_mass[i] = mass_at(&map->body[k], i);
    return PDYN_OK;
}

void rigid_map_free(struct rigid_map *map) {
    if (!map) return;
    pdyn_context *c = map->context;
    resize(map, ARRAYS_FREE);
    FREE_ARRAY(c, map->body, map->bodies);
    FREE_ARRAY(c, map, 1);
}
