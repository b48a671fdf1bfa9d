/* The live particles of fluids near a layer of an inlet. They are sorted into cells, so that the
 * particles near a place are found in the 27 cells around it. */
#ifndef PDYN_LAYER_NEIGHBOURS_H
#define PDYN_LAYER_NEIGHBOURS_H

struct pdyn_sim;

/* Cells share buckets by a hash (Teschner et al. 2003). */
struct layer_neighbours {
    double cell; /* m, edge of a cell */
    int *bucket; /* particles: the first particle of each bucket; -1: none */
    int *next;   /* particles: the next particle of the same bucket; -1: none */
};

/* Sorts the particles closer than `reach`, m, to the plane through `origin` into cells. */
void layer_neighbours_sort(struct pdyn_sim *sim, const double origin[3], const double normal[3],
                           double reach, double cell);

/* Writes the sorted particles closer than `radius`, which is less than a cell, to x into
 * sim->live->scratch. Returns their number. */
int layer_neighbours_find(struct pdyn_sim *sim, const double x[3], double radius);

#endif
