/* Particles of sheets and solids in clusters of neighbours: those that share static rows. Clusters
 * that share rows have near numbers. */
#ifndef PDYN_CLUSTERS_H
#define PDYN_CLUSTERS_H

#include "../core/system.h"

struct clusters {
    struct system *system;
    int count;
    int *of;     /* particles: -1 for none */
    int *first;  /* particles + 1: where the members of each begin in, and one more */
    int *member; /* particles */
};

pdyn_status clusters_create(struct clusters *clusters, struct system *system); /* zeroed before */
void clusters_free(struct clusters *clusters);

#endif
