/* Springs between chosen vertices of a body: ropes, braces, stitches. A row of the table names two
 * vertices, counted from 0, and the stiffness k of their spring:
 *
 *     E = k/2 (|x_a - x_b| - l)^2,     u = x_a - x_b,     p = l u / |u|,     w = k
 *
 * with l, `length` times the distance at rest. */
#include <projdyn/module.h>
#include <projdyn/rest_length.h>

enum { A, B, STIFFNESS, COLUMNS }; /* of a row */

struct params {
    pdyn_table link;
    double length;
};

static const pdyn_param params[] = {
    {"link", PDYN_VERTEX_TABLE(PDYN_ROWS, 2, COLUMNS), offsetof(struct params, link), true, 0, 0,
     1e12, "N/m", "two vertices of the body and the stiffness of their spring"},
    {"length", PDYN_REAL, offsetof(struct params, length), false, 1, 0, 1e3, "1",
     "of a spring without force, over its length at rest"},
    {0}};

static int elements(const void *par, const pdyn_body *body) {
    (void)body;
    return ((const struct params *)par)->link.count;
}

/* The data of an element is the length l, as rest_length.h has it. */
static void select_rows(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = (const struct params *)par;
    for (int e = first; e < last; e++) {
        const double *row = q->link.value + COLUMNS * e;
        int a = (int)row[A], z = (int)row[B];
        b->column[2 * e] = b->body->first + a, b->coefficient[2 * e] = 1.0;
        b->column[2 * e + 1] = b->body->first + z, b->coefficient[2 * e + 1] = -1.0;
        ((double *)b->data)[e] =
            q->length * vec3_distance(b->body->rest + 3 * a, b->body->rest + 3 * z);
    }
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = (const struct params *)par;
    for (int e = first; e < last; e++) b->weight[e] = q->link.value[COLUMNS * e + STIFFNESS];
}

static const pdyn_constraint_type type = {
    .name = "links",
    .summary = "springs between chosen vertices",
    .flags = PDYN_ON_SURFACE,
    .params_size = sizeof(struct params),
    .params = params,
    .data_size = sizeof(double),
    .elements = elements,
    .rows = 1,
    .width = 2,
    .select = select_rows,
    .weight = weight,
    .project = rest_length_project,
    .tangent_rank1 = rest_length_tangent,
};

static const pdyn_constraint_type *const types[] = {&type, NULL};
const pdyn_plugin pdyn_plugin_table = {PDYN_ABI, "links", types, NULL};
