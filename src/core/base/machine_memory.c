/* The memory that the program may have (machine_memory.h). */
#include "machine_memory.h"

#include <math.h>
#include <sys/resource.h>
#include <unistd.h>

double machine_memory(void) {
    struct rlimit limit;
    double bytes = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
    if (getrlimit(RLIMIT_AS, &limit) || limit.rlim_cur == RLIM_INFINITY) return bytes;
    return fmin(bytes, (double)limit.rlim_cur);
}
