/* Tables of plug-ins: rows of a vertex, of four, and two numbers. */
#include "scene/table.h"
#include "fuzz.h"
#include "scene/table_file.h"

#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const pdyn_param param = {.name = "fibre",
                                     .kind = PDYN_VERTEX_TABLE(PDYN_ROWS, 1, 3),
                                     .min = -1.0,
                                     .max = 1.0,
                                     .unit = "1"};
    pdyn_table table = {0};
    pdyn_context *context = fuzz_context();
    const char *path = fuzz_file(data, size, ".txt");
    table_file_read(context, path, &param, 0, 4, &table);
    table_free(context, &param, &table);
    unlink(path);
    fuzz_end(context, fuzz_bound(size));
    return 0;
}
