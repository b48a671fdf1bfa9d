/* The built-in solver "cg" as a plug-in: its sources compiled against the installed headers alone,
 * under another name. */
#include "../../src/solvers/cg.c"

static const pdyn_global_solver copied = {
    .name = "copied_cg",
    .summary = "cg, built outside of the library",
    .state_size = sizeof(struct cg),
    .create = create,
    .solve = solve,
    .free = release,
};

static const pdyn_global_solver *const solvers[] = {&copied, NULL};
const pdyn_plugin pdyn_plugin_table = {PDYN_ABI, "copied_cg", NULL, solvers};
