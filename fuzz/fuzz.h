/* What the fuzz targets share: a context whose memory is limited, and a file with the input. */
#ifndef FUZZ_H
#define FUZZ_H

#include "base/context.h"

#include <stddef.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* One thread; allocations fail beyond 64 MB. Ends the process without one. */
pdyn_context *fuzz_context(void);
/* Nothing may be left, and no more was taken than `most` bytes; ends the process otherwise. */
void fuzz_end(pdyn_context *context, size_t most);

/* Memory that reading a file of that size may take. */
size_t fuzz_bound(size_t size);

/* Writes the input into a file of this process with that ending; returns its path. */
const char *fuzz_file(const uint8_t *data, size_t size, const char *ending);

#endif
