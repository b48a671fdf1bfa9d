/* A program that uses an installed projdyn: a sheet of cloth falls for one step. */
#include <projdyn/projdyn.h>
#include <stdio.h>

int main(void) {
    static const char scene[] =
        "{\"duration\": 1, \"frame_interval\": 0.01, \"bodies\": [{\"surface\": {\"grid\": "
        "{\"size\": [1, 1], \"vertices\": [5, 5]}, \"area_density\": 0.2}, \"constraints\": "
        "[{\"type\": \"spring\", \"stretching_stiffness\": 1000}]}]}";
    pdyn_context *context = NULL;
    pdyn_sim *sim = NULL;
    bool good = pdyn_create(NULL, &context) == PDYN_OK &&
                pdyn_load_text(context, scene, "scene", NULL, 0, &sim) == PDYN_OK &&
                pdyn_step(sim, NULL) == PDYN_OK;
    printf("projdyn %s: %s\n", pdyn_version(), good ? "one step" : pdyn_last_error(context));
    pdyn_free(sim);
    pdyn_destroy(context);
    return !good;
}
