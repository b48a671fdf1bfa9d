/* Particles, .vtk. */
#include "fuzz.h"
#include "geometry/mesh.h"

#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct particles particles;
    pdyn_context *context = fuzz_context();
    const char *path = fuzz_file(data, size, ".vtk");
    particles_read(context, path, &particles);
    particles_free(context, &particles);
    unlink(path);
    fuzz_end(context, fuzz_bound(size));
    return 0;
}
