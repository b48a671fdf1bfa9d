/* A plug-in whose projection goes only half of the way: conformance has to report it. */
#include "projdyn/module.h"

struct params {
    double stiffness;
};

static const pdyn_param params[] = {
    {"stiffness", PDYN_REAL, 0, false, 100, 0, 1e6, "N/m", "of each point"}, {0}};

static int elements(const void *par, const pdyn_body *body) {
    (void)par;
    return body->count;
}

static void select(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->column[e] = b->body->first + e, b->coefficient[e] = 1.0;
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++) b->weight[e] = ((const struct params *)par)->stiffness;
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int k = 3 * first; k < 3 * last; k++) b->p[k] = 0.5 * b->u[k];
}

static const pdyn_constraint_type type = {.name = "floor",
                                          .summary = "goes half of the way",
                                          .flags = PDYN_ANCHORED,
                                          .params_size = sizeof(struct params),
                                          .params = params,
                                          .elements = elements,
                                          .rows = 1,
                                          .width = 1,
                                          .select = select,
                                          .weight = weight,
                                          .project = project};

static const pdyn_constraint_type *const types[] = {&type, NULL};
const pdyn_plugin pdyn_plugin_table = {PDYN_ABI, "wrong", types, NULL};
