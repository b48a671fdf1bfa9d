/* Tetrahedra, .node and .ele: in one input, with a line "%" between them. */
#include "fuzz.h"
#include "geometry/tets.h"

#include <string.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct mesh mesh;
    struct tets tets;
    char node[128];
    const uint8_t *cut = size ? memchr(data, '%', size) : NULL;
    size_t first = cut ? (size_t)(cut - data) : size, rest = cut ? size - first - 1 : 0;
    pdyn_context *context = fuzz_context();
    strcpy(node, fuzz_file(data, first, ".node"));
    const char *ele = fuzz_file(cut ? cut + 1 : data, rest, ".ele");
    if (tets_read(context, node, &mesh, &tets) == PDYN_OK) tets_finish(context, node, &mesh, &tets);
    tets_free(context, &tets), mesh_free(context, &mesh);
    unlink(node), unlink(ele);
    fuzz_end(context, fuzz_bound(size));
    return 0;
}
