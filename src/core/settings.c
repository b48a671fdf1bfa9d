/* The parameters of a scene as a whole. A default outside the bounds means: absent. */
#include "registry.h"
#include "scene.h"

#define SETTING(field) offsetof(struct scene_settings, field)

/* gravity is not here: its default differs from entry to entry. */
const pdyn_param settings_general_params[] = {
    {"duration", PDYN_REAL, SETTING(duration), true, 0, 1e-6, 1e6, "s", "simulated time"},
    {"frame_interval", PDYN_REAL, SETTING(frame_interval), false, 1.0 / 30.0, 1e-6, 1e3, "s",
     "time between two frames of the output"},
    {0}};

const pdyn_param settings_time_step_params[] = {
    {"maximum", PDYN_REAL, SETTING(h_max), false, 0.005, 1e-9, 1e3, "s", "longest step"},
    {"minimum", PDYN_REAL, SETTING(h_min), false, 1e-5, 1e-9, 1e3, "s", "shortest step"},
    {"cfl", PDYN_REAL, SETTING(cfl), false, 1.0, 1e-3, 1e3, "1",
     "particle radii that a particle may travel in a step"},
    {"fixed", PDYN_REAL, SETTING(h_fixed), false, 0, 1e-9, 1e3, "s",
     "length of every step, instead of the other three"},
    {0}};

const pdyn_param settings_solver_params[] = {
    {"tolerance", PDYN_REAL, SETTING(tolerance), false, 0.1, 0, 1e3, "1",
     "a step is solved when |grad E| / |M g| falls below"},
    {"outer_iterations", PDYN_INT, SETTING(outer_iterations), false, 20, 1, 1e5, "",
     "local/global iterations of a step at most"},
    {"linear_tolerance", PDYN_REAL, SETTING(linear_tolerance), false, 0.01, 0, 1, "1",
     "a linear solve ends when its residual has fallen by this factor, or far enough for "
     "tolerance"},
    {"linear_iterations", PDYN_INT, SETTING(linear_iterations), false, 500, 1, 1e6, "",
     "iterations of a linear solve at most"},
    {"retries", PDYN_INT, SETTING(retries), false, 4, 0, 30, "",
     "attempts with shorter steps after one that diverged"},
    {0}};
