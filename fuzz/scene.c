/* Scenes, up to what is simulated. */
#include "scene/scene.h"
#include "fuzz.h"
#include "scene/scene_file.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    pdyn_scene *file = NULL;
    struct scene scene;
    pdyn_context *context = fuzz_context();
    char *text = malloc(size + 1);
    memcpy(text, data, size), text[size] = '\0';
    if (pdyn_scene_parse(context, text, "scene.json", &file) == PDYN_OK) {
        scene_read(&file->json, &scene);
        scene_free(context, &scene);
    }
    pdyn_scene_free(file);
    free(text);
    fuzz_end(context, SIZE_MAX);
    return 0;
}
