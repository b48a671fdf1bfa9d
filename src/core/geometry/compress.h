/* Which of many points are near: the inner loop of neighbour searches. */
#ifndef PDYN_COMPRESS_H
#define PDYN_COMPRESS_H

/* Writes to `list` (room for `count`) the ids with squared[k] < limit, in their order and but for
 * the id `without`. Returns how many there are. */
int compact(const double *squared, const int *id, int count, double limit, int without, int *list);

#endif
