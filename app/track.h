/* What a run did, as far as two runs of one scene can be compared: where its surfaces went, how its
 * fluids were spread, its energies. Single particles of a fluid go chaotic ways; how many of them
 * are where converges. */
#ifndef TRACK_H
#define TRACK_H

#include <stdbool.h>

enum track_measure {
    TRACK_DENSITY,
    TRACK_CLOTH,
    TRACK_FRONT,
    TRACK_PROFILE,
    TRACK_ENERGY,
    TRACK_GAINED,
    TRACK_MEASURES
};
extern const char *const track_names[TRACK_MEASURES];

enum { TRACK_LEVELS = 64 }; /* of the distribution of a fluid along an axis */

struct track_body {
    char *name;
    bool surface;
    int count;     /* points of a surface */
    double size;   /* m, diagonal of its box at the start */
    double *value; /* frames x stride */
    int stride;    /* 3 count: positions, m; or 3 (TRACK_LEVELS + 2): for each axis the coordinates
                      below which an even share of the particles is, then 5 % and 95 %, m */
};

struct track {
    int frames, bodies;
    double *time; /* frames, s */
    struct track_body *body;
    double *energy;       /* frames, J; NAN at the first */
    double scale;         /* J: energy that goes from one form to another */
    double gained;        /* J, the most that the total rose above that at the start */
    double density;       /* mean over the steps of the mean density error */
    double residual;      /* mean step residual */
    double ms_per_second; /* of processor time, per simulated second */
};

/* Of a run with frames. EXIT_GOOD, or an exit code with a message and nothing to be freed. */
int track_read(const char *directory, struct track *track);
void track_free(struct track *track);

/* How far a run is from another with the same frames; 0 where the scene has no such thing. Density:
 * that of the run itself. Cloth: root mean square distance of the vertices over the size of the
 * surface. Front: of the planes that 5 % of the fluid is beyond, the worst axis and side, root mean
 * square over the frames, over the size of the body; what goes beyond as spray is chance. Profile:
 * how far the fluid would have to be carried along an axis to be spread in the same way. Energy:
 * over what goes from one form to another. Gained: the most that it rose above that at the start,
 * beyond what the reference did, over the same; a step that is cut off too early puts energy in. */
void track_compare(const struct track *track, const struct track *reference,
                   double error[TRACK_MEASURES]);

#endif
