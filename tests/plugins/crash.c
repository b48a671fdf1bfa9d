/* A plug-in that ends the process. */
#include "projdyn/module.h"

#include <signal.h>

static const pdyn_param params[] = {{0}};

static int elements(const void *par, const pdyn_body *body) {
    (void)par;
    return raise(SIGSEGV) + body->count;
}

static void nothing(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par, (void)b, (void)first, (void)last;
}

static const pdyn_constraint_type type = {.name = "crash",
                                          .summary = "ends the process",
                                          .params = params,
                                          .elements = elements,
                                          .rows = 1,
                                          .width = 1,
                                          .select = nothing,
                                          .weight = nothing,
                                          .project = nothing};

static const pdyn_constraint_type *const types[] = {&type, NULL};
const pdyn_plugin pdyn_plugin_table = {PDYN_ABI, "crash", types, NULL};
