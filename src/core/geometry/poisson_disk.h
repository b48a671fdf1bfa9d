/* A set of points with a least distance between them, which takes a point or refuses it. */
#ifndef PDYN_POISSON_DISK_H
#define PDYN_POISSON_DISK_H

#include "point_list.h"

/* Points are in cells more than twice as wide as the distance, so that the points closer than it to
 * a place are in the eight cells nearest to it. Cells share buckets by a hash (Teschner et al.
 * 2003). */
struct poisson_disk {
    double distance; /* m */
    struct point_list at;
    size_t chained, buckets; /* capacities; the number of buckets is a power of two */
    int *next;               /* points: the next point of its bucket; -1: none */
    int *bucket;             /* its first point; -1: none */
    int last;                /* the point that was in the way of the last one */
};

/* Takes the point x, m, if no point of the set is closer than the distance. *taken: whether it did.
 * PDYN_BAD_INPUT: the set would exceed POINT_LIST_MAX. */
pdyn_status poisson_disk_offer(pdyn_context *context, struct poisson_disk *set, const double x[3],
                               bool *taken);
void poisson_disk_free(pdyn_context *context, struct poisson_disk *set);

#endif
