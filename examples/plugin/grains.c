/* Spheres that do not overlap, without friction: matrix-free, on neighbour lists. Constraint c is a
 * pair of grains a, b, or a grain and a boundary point, closer than two radii:
 *
 *     C(x) = 2 r - |x_a - x_b| <= 0,     E = k/2 max(0, C)^2
 *     grad C = (-n, n),     n = (x_a - x_b) / |x_a - x_b|
 *
 * The simulation uses the operator. The rows describe the same constraints for solvers that
 * assemble H: an element is a grain with the later grains and the boundary points in its list, u =
 * x_a - x_b, p = 2 r u / |u| for |u| < 2 r. The loops are serial for brevity;
 * services->parallel_for would share them. Use it with the scene's "boundary": "points": these lie
 * 0.6 x 2 r behind the walls of a box, so that a grain touches the wall. */
#include <projdyn/module.h>
#include <projdyn/vec3.h>

#include <string.h>

struct params {
    double stiffness;
};

static const pdyn_param params[] = {{"stiffness", PDYN_REAL, offsetof(struct params, stiffness),
                                     false, 1e5, 0, 1e12, "N/m", "force per overlap of two grains"},
                                    {0}};

/* ---- rows ------------------------------------------------------------------------------------ */

static int elements(const void *par, const pdyn_body *body) {
    (void)par;
    return body->count;
}

/* True for the pairs of grain i that count: later grains and boundary points; not samples. */
static bool counts(const pdyn_neighbours *l, int i, int j) {
    return (j > i && j < l->particles - l->samples) || j >= l->particles;
}

static void row_sizes(const void *par, const pdyn_batch *b, int element, int *rows, int *width) {
    const pdyn_neighbours *l = b->neighbours;
    int i = b->body->first + element;
    (void)par;
    *rows = 0, *width = 2;
    for (int k = l->start[i]; k < l->end[i]; k++) *rows += counts(l, i, l->index[k]);
}

/* Calls visit(b, row, i, j, J) for each row of the elements; J: first number of the row's diagonal
 * block, or NULL. */
static void each_row(const pdyn_batch *b, int first, int last,
                     void (*visit)(const pdyn_batch *b, int row, int i, int j, double *J),
                     double *J) {
    const pdyn_neighbours *l = b->neighbours;
    for (int e = first; e < last; e++) {
        int row = b->element_row[e], i = b->body->first + e, n = 3 * (b->element_row[e + 1] - row);
        for (int k = l->start[i]; k < l->end[i]; k++)
            if (counts(l, i, l->index[k])) {
                visit(b, row, i, l->index[k],
                      J ? J + 3 * (row - b->element_row[e]) * (n + 1) : NULL);
                row++;
            }
        if (J) J += n * n;
    }
}

static void select_row(const pdyn_batch *b, int row, int i, int j, double *J) {
    bool wall = j >= b->neighbours->particles;
    (void)J;
    b->column[2 * row] = i, b->coefficient[2 * row] = 1.0;
    b->column[2 * row + 1] = wall ? i : j, b->coefficient[2 * row + 1] = wall ? 0.0 : -1.0;
}

static void select_rows(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    each_row(b, first, last, select_row, NULL);
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++) b->weight[e] = ((const struct params *)par)->stiffness;
}

static const double *wall_of(const pdyn_batch *b, int j) {
    static const double none[3] = {0};
    const pdyn_neighbours *l = b->neighbours;
    return j < l->particles ? none : l->boundary_x + 3 * (j - l->particles);
}

static void project_row(const pdyn_batch *b, int row, int i, int j, double *J) {
    const double *wall = wall_of(b, j);
    double d[3], least = 2.0 * b->body->radius;
    (void)i, (void)J;
    for (int k = 0; k < 3; k++) d[k] = b->u[3 * row + k] - wall[k];
    if (vec3_length(d) < least) vec3_project_length(d, d, least);
    for (int k = 0; k < 3; k++) b->p[3 * row + k] = d[k] + wall[k];
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    each_row(b, first, last, project_row, NULL);
}

/* J of an element is block diagonal: one 3 x 3 block per row. */
static void tangent_row(const pdyn_batch *b, int row, int i, int j, double *J) {
    const double *wall = wall_of(b, j);
    int n = 3 * (b->element_row[i - b->body->first + 1] - b->element_row[i - b->body->first]);
    double d[3], block[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (int k = 0; k < 3; k++) d[k] = b->u[3 * row + k] - wall[k];
    if (vec3_length(d) < 2.0 * b->body->radius)
        vec3_tangent_length(block, d, 2.0 * b->body->radius);
    for (int k = 0; k < 9; k++) J[k / 3 * n + k % 3] = block[k];
}

static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    (void)par;
    each_row(b, first, last, tangent_row, J);
}

/* ---- operator -------------------------------------------------------------------------------- */

struct pair {
    int a, b; /* particle; particle, or boundary point if not below `particles` */
    double n[3];
};

struct grains {
    const pdyn_services *services;
    const pdyn_neighbours *lists;
    double stiffness, least;
    int first, count, particles;
    int constraints, room;       /* the first `count`, one per grain, are unused (k = 0) */
    struct pair *pair;           /* room */
    double *value, *k, *squares; /* room */
    double *weight_sum;          /* particles */
    const double *multiplier;    /* constraints: that of the last call of `force` */
};

/* `pointer`: address of the pointer to the array, of any type (hence memcpy). */
static bool resize(struct grains *g, void *pointer, int old_count, int count, size_t size) {
    void *array;
    memcpy(&array, pointer, sizeof array);
    array = g->services->allocate(g->services->core, array, (size_t)old_count * size,
                                  (size_t)count * size);
    memcpy(pointer, &array, sizeof array);
    return array || !count;
}

static bool make_room(struct grains *g, int room) {
    bool good = resize(g, &g->pair, g->room, room, sizeof *g->pair);
    good &= resize(g, &g->value, g->room, room, sizeof *g->value);
    good &= resize(g, &g->k, g->room, room, sizeof *g->k);
    good &= resize(g, &g->squares, g->room, room, sizeof *g->squares);
    g->room = room;
    return good;
}

static void *create(const void *par, const pdyn_body *body, const pdyn_services *services) {
    struct grains *g = (struct grains *)services->allocate(services->core, NULL, 0, sizeof *g);
    if (!g) return NULL;
    g->services = services;
    g->stiffness = ((const struct params *)par)->stiffness, g->least = 2.0 * body->radius;
    g->first = body->first, g->count = body->count;
    return g;
}

static void release(void *self) {
    struct grains *g = (struct grains *)self;
    make_room(g, 0);
    resize(g, &g->weight_sum, g->particles, 0, sizeof *g->weight_sum);
    g->services->allocate(g->services->core, g, sizeof *g, 0);
}

/* Makes one constraint per listed pair. */
static bool neighbours(void *self, const pdyn_neighbours *l) {
    struct grains *g = (struct grains *)self;
    int c = g->count, most = g->count;
    g->lists = l;
    if (!g->weight_sum && !resize(g, &g->weight_sum, 0, l->particles, sizeof *g->weight_sum))
        return false;
    g->particles = l->particles;
    for (int i = g->first; i < g->first + g->count; i++) most += l->end[i] - l->start[i];
    if (most > g->room && !make_room(g, most + most / 4)) return false;
    memset(g->k, 0, (size_t)g->count * sizeof *g->k);
    memset(g->pair, 0, (size_t)g->count * sizeof *g->pair);
    for (int i = g->first; i < g->first + g->count; i++)
        for (int k = l->start[i]; k < l->end[i]; k++)
            if (counts(l, i, l->index[k])) {
                g->pair[c].a = i, g->pair[c].b = l->index[k];
                g->k[c] = g->stiffness, g->squares[c] = l->index[k] < l->particles ? 2.0 : 1.0;
                c++;
            }
    g->constraints = c;
    return true;
}

static double local(void *self, const double *x, double *gradient) {
    struct grains *g = (struct grains *)self;
    double energy = 0.0;
    memset(g->weight_sum, 0, (size_t)g->particles * sizeof *g->weight_sum);
    for (int c = g->count; c < g->constraints; c++) {
        struct pair *q = &g->pair[c];
        bool wall = q->b >= g->particles;
        const double *other =
            wall ? g->lists->boundary_x + 3 * (q->b - g->particles) : x + 3 * q->b;
        for (int k = 0; k < 3; k++) q->n[k] = x[3 * q->a + k] - other[k];
        double distance = vec3_length(q->n), force;
        for (int k = 0; k < 3; k++) q->n[k] /= distance > 0.0 ? distance : 1.0;
        g->value[c] = g->least - distance;
        if (g->value[c] <= 0.0) continue;
        force = g->k[c] * g->value[c], energy += 0.5 * force * g->value[c];
        vec3_add(gradient + 3 * q->a, -force, q->n), g->weight_sum[q->a] += 2.0 * g->k[c];
        if (!wall) vec3_add(gradient + 3 * q->b, force, q->n), g->weight_sum[q->b] += 2.0 * g->k[c];
    }
    return energy;
}

static pdyn_one_sided one_sided(void *self) {
    struct grains *g = (struct grains *)self;
    pdyn_one_sided s = {g->constraints, g->value, g->k, g->squares, g->weight_sum};
    return s;
}

static void rate(void *self, const bool *which, const double *u, double *out) {
    struct grains *g = (struct grains *)self;
    for (int c = 0; c < g->constraints; c++) {
        const struct pair *q = &g->pair[c];
        out[c] = 0.0;
        if (!which[c]) continue;
        out[c] = -vec3_dot(q->n, u + 3 * q->a);
        if (q->b < g->particles) out[c] += vec3_dot(q->n, u + 3 * q->b);
    }
}

static void force(void *self, const double *multiplier, double *y) {
    struct grains *g = (struct grains *)self;
    g->multiplier = multiplier;
    for (int c = g->count; c < g->constraints; c++) {
        const struct pair *q = &g->pair[c];
        vec3_add(y + 3 * q->a, -multiplier[c], q->n);
        if (q->b < g->particles) vec3_add(y + 3 * q->b, multiplier[c], q->n);
    }
}

static void diagonal(void *self, const double *stiffness, double *blocks) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    struct grains *g = (struct grains *)self;
    for (int c = g->count; c < g->constraints; c++) {
        const struct pair *q = &g->pair[c];
        for (int k = 0; k < 6; k++) {
            double entry = stiffness[c] * q->n[row[k]] * q->n[column[k]];
            blocks[6 * q->a + k] += entry;
            if (q->b < g->particles) blocks[6 * q->b + k] += entry;
        }
    }
}

static void boundary_force(void *self, double *out) {
    struct grains *g = (struct grains *)self;
    for (int c = g->count; c < g->constraints; c++) {
        const struct pair *q = &g->pair[c];
        if (q->b < g->particles) continue;
        vec3_add(out + 3 * (q->b - g->particles), -g->multiplier[c], q->n);
    }
}

static const pdyn_operator operator_of_grains = {
    .create = create,
    .free = release,
    .neighbours = neighbours,
    .local = local,
    .one_sided = one_sided,
    .rate = rate,
    .force = force,
    .diagonal = diagonal,
    .boundary_force = boundary_force,
};

static const pdyn_constraint_type type = {
    .name = "grains",
    .summary = "spheres that do not overlap, without friction",
    .flags = PDYN_ON_PARTICLES,
    .params_size = sizeof(struct params),
    .params = params,
    .elements = elements,
    .row_sizes = row_sizes,
    .select = select_rows,
    .weight = weight,
    .project = project,
    .tangent = tangent,
    .matrix_free = &operator_of_grains,
};

static const pdyn_constraint_type *const types[] = {&type, NULL};
const pdyn_plugin pdyn_plugin_table = {PDYN_ABI, "grains", types, NULL};
