/* Selection of near points, the inner loop of neighbour searches. */
#ifndef PDYN_COMPRESS_H
#define PDYN_COMPRESS_H

/* Writes to `list` (room for `count`) the ids with squared[k] < limit, in their order, except the
 * id `without`. Returns their number. */
int compress_ids(const double *squared, const int *id, int count, double limit, int without,
                 int *list);

#endif
