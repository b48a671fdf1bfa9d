/* A plug-in that makes the name of a parameter when it is loaded. */
#include <projdyn/module.h>

#include <string.h>

static pdyn_param params[2] = {{NULL, PDYN_REAL, 0, false, 1, 0, 1, "N/m", "stiffness"}};

__attribute__((constructor)) static void make_name(void) { params[0].name = strdup("stiffness"); }

static int count(const void *par, const pdyn_body *body) {
    (void)par;
    return body->count;
}

static void select_point(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->column[e] = b->body->first + e, b->coefficient[e] = 1.0;
}

static void weigh(const void *par, const pdyn_batch *b, int first, int last) {
    for (int e = first; e < last; e++) b->weight[e] = *(const double *)par;
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int k = 3 * first; k < 3 * last; k++) b->p[k] = 0.0;
}

static const pdyn_constraint_type type = {.name = "named",
                                          .summary = "pulls to the origin",
                                          .flags = PDYN_ANCHORED,
                                          .params_size = sizeof(double),
                                          .params = params,
                                          .rows = 1,
                                          .width = 1,
                                          .elements = count,
                                          .select = select_point,
                                          .weight = weigh,
                                          .project = project};
static const pdyn_constraint_type *const types[] = {&type, NULL};
const pdyn_plugin pdyn_plugin_table = {PDYN_ABI, "named", types, NULL};
