/* Quantities of a run that can be compared between two runs of one scene: positions of surfaces,
 * the distribution of fluid particles along the axes, energies. Single particles of a fluid
 * follow chaotic paths, but their distribution converges with the step length. */
#ifndef RUN_METRICS_H
#define RUN_METRICS_H

#include <stdbool.h>

/* Errors of a run against a reference, see run_metrics_compare(). */
enum run_metric {
    RUN_METRIC_DENSITY,
    RUN_METRIC_CLOTH,
    RUN_METRIC_FRONT,
    RUN_METRIC_PROFILE,
    RUN_METRIC_ENERGY,
    RUN_METRIC_GAINED,
    RUN_METRICS_COUNT
};
extern const char *const run_metric_names[RUN_METRICS_COUNT];

enum { RUN_METRICS_LEVELS = 64 }; /* quantiles of a fluid along an axis */

struct body_metrics {
    char *name;
    bool surface;  /* triangles; otherwise particles */
    int count;     /* vertices of a surface */
    double size;   /* m: diagonal of the bounding box in the first frame in which that is not 0, as
                      inlets may begin later */
    double *value; /* frames x stride, m. Surface: vertex positions. Particles, for each axis:
                      RUN_METRICS_LEVELS evenly spaced quantiles of the coordinate, then the 5 % and
                      the 95 % quantile. */
    int stride;    /* 3 count, or 3 (RUN_METRICS_LEVELS + 2) */
};

struct run_metrics {
    int frames, bodies;
    double *time; /* frames, s */
    struct body_metrics *body;
    double *energy;       /* frames: total energy, J; NAN if no step ends at the frame */
    double scale;         /* exchanged energy, J: maximum of the kinetic energy and of the range of
                             the potential energy */
    double gained;        /* largest rise of the total energy above its start, J */
    double density;       /* mean density error, mean over the steps */
    double residual;      /* step residual, mean over the steps */
    double ms_per_second; /* processor time, ms per simulated second */
};

/* Reads a run with frames. Returns EXIT_GOOD, or another exit code after a message with nothing
 * to be freed. */
int run_metrics_read(const char *directory, struct run_metrics *metrics);
void run_metrics_free(struct run_metrics *metrics);

/* Errors of a run against a reference with the same frames. All are relative (1 = 100 %), and 0
 * where the scene has no such body. Of several bodies the largest error counts.
 *
 *     density   mean density error of the run itself
 *     cloth     root mean square distance of the vertices over all frames / size
 *     front     distance of the 5 % and 95 % quantiles, the larger one of both;
 *               root mean square over the frames, maximum over the axes / size
 *     profile   mean distance of the quantiles (earth mover's distance along an axis);
 *               root mean square over the frames, maximum over the axes / size
 *     energy    root mean square difference of the total energy / exchanged energy
 *     gained    energy gained beyond that of the reference / exchanged energy
 *
 * with size = body_metrics.size and exchanged energy = run_metrics.scale. The quantiles of
 * `front` leave out spray, which is chaotic. `gained` shows steps that end before they are
 * solved: these add energy. */
void run_metrics_compare(const struct run_metrics *metrics, const struct run_metrics *reference,
                         double error[RUN_METRICS_COUNT]);

#endif
