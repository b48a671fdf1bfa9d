/* Clocks for the times in reports. No decision of a simulation depends on them. */
#ifndef PDYN_CLOCK_H
#define PDYN_CLOCK_H

#include <time.h>

static inline double clock_read_ms(clockid_t clock) {
    struct timespec t;
    clock_gettime(clock, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

/* Wall-clock time since an arbitrary origin, ms. */
static inline double clock_ms(void) { return clock_read_ms(CLOCK_MONOTONIC); }

/* Processor time that all threads of the process have used, ms. */
static inline double clock_cpu_ms(void) { return clock_read_ms(CLOCK_PROCESS_CPUTIME_ID); }

#endif
