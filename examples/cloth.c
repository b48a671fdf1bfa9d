/* How a program runs a simulation, here of a sheet that hangs from two corners. C or C++.
 *
 *     cc -o cloth cloth.c $(pkg-config --cflags --libs projdyn) && ./cloth
 */
#include <projdyn/projdyn.h>

#include <stdio.h>

static const char scene[] =
    "{\"duration\": 1, \"bodies\": [{\"name\": \"sheet\","
    " \"surface\": {\"grid\": {\"size\": [1, 1], \"vertices\": [30, 30]}, \"area_density\": 0.2},"
    " \"constraints\": [{\"type\": \"triangle\", \"stretching_stiffness\": 500},"
    "                 {\"type\": \"bending\", \"bending_rigidity\": 1e-4},"
    "                 {\"type\": \"pin\", \"vertices\": {\"vertices\": [0, 29]}}]}]}";

int main(void) {
    pdyn_context *context = NULL;
    pdyn_sim *sim = NULL;
    pdyn_status status = pdyn_create(NULL, &context);
    if (status == PDYN_OK) status = pdyn_load_text(context, scene, "scene", NULL, 0, &sim);
    while (status == PDYN_OK && !pdyn_is_finished(sim)) {
        pdyn_step_info info;
        status = pdyn_step(sim, &info);
        if (status == PDYN_OK && info.frame) {
            pdyn_state state = pdyn_get_state(sim);
            printf("%.3f s: the last corner is at y = %.3f m\n", info.time,
                   state.x[3 * (state.particles - 1) + 1]);
        }
    }
    if (status != PDYN_OK) fprintf(stderr, "%s\n", pdyn_last_error(context));
    pdyn_free(sim);
    pdyn_destroy(context);
    return status != PDYN_OK;
}
