/* Scenes, up to what is simulated. */
#include "scene/scene.h"
#include "fuzz.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct scene scene;
    pdyn_context *context = fuzz_context();
    char *text = malloc(size + 1);
    memcpy(text, data, size), text[size] = '\0';
    scene_read(context, "scene.json", text, NULL, 0, &scene);
    scene_free(context, &scene);
    free(text);
    fuzz_end(context, SIZE_MAX);
    return 0;
}
