/* Tetrahedra, .msh. */
#include "fuzz.h"
#include "geometry/tets.h"

#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct mesh mesh;
    struct tets tets;
    pdyn_context *context = fuzz_context();
    const char *path = fuzz_file(data, size, ".msh");
    if (tets_read(context, path, &mesh, &tets) == PDYN_OK) tets_finish(context, path, &mesh, &tets);
    tets_free(context, &tets), mesh_free(context, &mesh);
    unlink(path);
    fuzz_end(context, fuzz_bound(size));
    return 0;
}
