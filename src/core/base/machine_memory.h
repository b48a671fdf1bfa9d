/* The memory that the program may have. */
#ifndef PDYN_MACHINE_MEMORY_H
#define PDYN_MACHINE_MEMORY_H

/* Bytes of memory of the machine, or fewer by `ulimit -v`. */
double machine_memory(void);

#endif
