/* A plug-in whose table of parameters has no end {0}: it runs on into other data. */
#include <projdyn/module.h>

static const struct {
    pdyn_param param[1];
    const char *next;
} table = {{{"stiffness", PDYN_REAL, 0, false, 1, 0, 1, "N/m", "stiffness"}}, (const char *)1};

static const pdyn_constraint_type type = {.name = "endless",
                                          .summary = "has a table of parameters without its end",
                                          .params_size = sizeof(double),
                                          .params = table.param};
static const pdyn_constraint_type *const types[] = {&type, NULL};
const pdyn_plugin pdyn_plugin_table = {PDYN_ABI, "endless", types, NULL};
