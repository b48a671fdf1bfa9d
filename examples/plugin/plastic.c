/* Springs along the edges of a sheet that yield: where the strain of an edge exceeds `yield`, the
 * excess stays when the load goes. m is this plastic strain, relative to the length l at rest; it
 * is the memory of the element:
 *
 *     E = k/2 (|u| - (1 + m) l)^2,     p = (1 + m) l u / |u|,     u = x_b - x_a
 *     m changes at the end of a step so that |u| / l - 1 - m is in [-yield, yield]
 *
 * ideal plasticity in one dimension (Simo and Hughes 1998, Computational Inelasticity, chapter 1).
 */
#include <projdyn/module.h>
#include <projdyn/vec3.h>

struct params {
    double stiffness, yield;
};

static const pdyn_param params[] = {{"stiffness", PDYN_REAL, offsetof(struct params, stiffness),
                                     true, 0, 0, 1e12, "N/m",
                                     "of each edge: force per change of its length"},
                                    {"yield", PDYN_REAL, offsetof(struct params, yield), false,
                                     0.02, 0, 1e3, "1", "strain beyond which an edge yields"},
                                    {0}};

static int elements(const void *par, const pdyn_body *body) {
    (void)par;
    return body->edges;
}

/* data: the length at rest */
static void select_rows(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        const int *end = b->body->edge + 2 * e;
        for (int k = 0; k < 2; k++) {
            b->column[2 * e + k] = b->body->first + end[k];
            b->coefficient[2 * e + k] = k ? 1.0 : -1.0;
        }
        ((double *)b->data)[e] =
            vec3_distance(b->body->rest + 3 * end[0], b->body->rest + 3 * end[1]);
    }
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++) b->weight[e] = ((const struct params *)par)->stiffness;
}

/* (1 + m) l */
static double length_of(const pdyn_batch *b, int e) {
    return (1.0 + ((const double *)b->memory)[e]) * ((const double *)b->data)[e];
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++)
        vec3_project_length(b->p + 3 * e, b->u + 3 * e, length_of(b, e));
}

static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *axis) {
    (void)par;
    for (int e = first; e < last; e++, axis += 4)
        vec3_axis_length(axis, b->u + 3 * e, length_of(b, e));
}

/* After an accepted step, never after one that is repeated: the state lasts. */
static void end(const void *par, const pdyn_batch *b, int first, int last) {
    double yield = ((const struct params *)par)->yield;
    for (int e = first; e < last; e++) {
        double *m = (double *)b->memory + e;
        double strain = vec3_length(b->u + 3 * e) / ((const double *)b->data)[e] - 1.0;
        *m = fmin(fmax(*m, strain - yield), strain + yield);
    }
}

static const pdyn_constraint_type type = {
    .name = "plastic",
    .summary = "plastic edges of a sheet: strain beyond a limit stays",
    .flags = PDYN_ON_SURFACE,
    .params_size = sizeof(struct params),
    .params = params,
    .data_size = sizeof(double),
    .elements = elements,
    .rows = 1,
    .width = 2,
    .select = select_rows,
    .weight = weight,
    .project = project,
    .tangent_rank1 = tangent,
    .memory_size = sizeof(double),
    .end = end,
};

static const pdyn_constraint_type *const types[] = {&type, NULL};
const pdyn_plugin pdyn_plugin_table = {PDYN_ABI, "plastic", types, NULL};
