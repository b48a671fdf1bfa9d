/* Triangle meshes; the build says which: ENDING is ".obj", ".ply" or ".stl". */
#include "geometry/mesh.h"
#include "fuzz.h"

#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct mesh mesh;
    struct topology topology;
    pdyn_context *context = fuzz_context();
    const char *path = fuzz_file(data, size, ENDING);
    if (mesh_read(context, path, &mesh) == PDYN_OK &&
        mesh_check_cloth(context, &mesh, path) == PDYN_OK &&
        topology_build(context, &mesh, &topology) == PDYN_OK)
        topology_free(context, &topology);
    mesh_free(context, &mesh);
    unlink(path);
    fuzz_end(context, fuzz_bound(size));
    return 0;
}
