/* A template for your own constraint: copy it, change the names, the parameters and the projection.
 * This one holds points above a floor: u is a point,
 *
 *     p = u with p_y = max(u_y, height),     J = diag(1, 1 or 0, 1)
 *
 *     cc -shared -fPIC -Iinclude -o template.so template.c -lm
 *     projdyn check --conformance ./template.so
 *     projdyn run template.json --allow-plugins
 *
 * -Iinclude: from the root of the source; $(pkg-config --cflags projdyn) with an installed library.
 */
#include <projdyn/module.h>
#include <projdyn/vec3.h>

struct params {
    double height, stiffness;
};

static const pdyn_param params[] = {
    /* name, kind, offset, required, default, minimum, maximum, unit, meaning */
    {"height", PDYN_REAL, offsetof(struct params, height), false, 0, -1e6, 1e6, "m",
     "where the floor is"},
    {"stiffness", PDYN_REAL, offsetof(struct params, stiffness), false, 1e5, 0, 1e12, "N/m",
     "force per distance of a point below the floor"},
    {0}};

/* The number of elements: one per point of the body. */
static int elements(const void *par, const pdyn_body *body) {
    (void)par;
    return body->count;
}

/* The rows: u = sum of coefficient x position. Here each row has one particle. */
static void select_rows(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->column[e] = b->body->first + e, b->coefficient[e] = 1.0;
}

/* The weight w of an element: E = w/2 |u - p|^2. */
static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++) b->weight[e] = ((const struct params *)par)->stiffness;
}

/* p: the point closest to u that satisfies the constraint. */
static void project(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++)
        for (int k = 0; k < 3; k++) {
            double u = b->u[3 * e + k], height = ((const struct params *)par)->height;
            b->p[3 * e + k] = k == 1 && u < height ? height : u;
        }
}

/* J = dp/du, symmetric, eigenvalues in [0, 1]; speeds up convergence. Optional. */
static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    double height = ((const struct params *)par)->height;
    for (int e = first; e < last; e++, J += 9)
        J[0] = J[8] = 1.0, J[4] = b->u[3 * e + 1] < height ? 0.0 : 1.0;
}

static const pdyn_constraint_type type = {
    .name = "floor",
    .summary = "holds points above a height",
    .flags = PDYN_ANCHORED | PDYN_ONE_SIDED, /* pushes without being pushed, and only upwards */
    .params_size = sizeof(struct params),
    .params = params,
    .elements = elements,
    .rows = 1,
    .width = 1,
    .select = select_rows,
    .weight = weight,
    .project = project,
    .tangent = tangent,
};

static const pdyn_constraint_type *const types[] = {&type, NULL};
const pdyn_plugin pdyn_plugin_table = {PDYN_ABI, "floor", types, NULL};
