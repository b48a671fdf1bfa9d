#include "time_estimate.h"

#include <math.h>
#include <stdio.h>

/* Steps are tried for so long, s; the first few for longer. */
enum { FEW_STEPS = 5 };
static const double trial_seconds = 0.5, few_seconds = 2.0;

/* Vertices, and particles that are in the scene. */
static double count_points(const pdyn_sim *sim) {
    double count = 0.0;
    for (int b = 0; b < pdyn_get_state(sim).bodies; b++) count += pdyn_get_body(sim, b).live;
    return count;
}

/* The mean number of points in a run whose inlets go on as in the time since the start, until there
 * are no more particles. */
static double mean_points(const pdyn_sim *sim, double at_start) {
    double duration = pdyn_duration(sim), rate = (count_points(sim) - at_start) / pdyn_time(sim);
    double vacant = 0.0;
    for (int b = 0; b < pdyn_get_state(sim).bodies; b++)
        vacant += pdyn_get_body(sim, b).count - pdyn_get_body(sim, b).live;
    double full = fmin(duration, pdyn_time(sim) + vacant / fmax(rate, 1e-300));
    return at_start + fmax(rate, 0.0) * full * (1.0 - 0.5 * full / duration);
}

/* Whether surfaces can meet others or a fluid: such steps took up to 20 times as long as those of
 * the fall before, in eight scenes of cloth, rigid bodies and water. */
static bool may_meet(const pdyn_sim *sim) {
    bool fluid = false, surface = false;
    pdyn_body_info body;
    for (int b = 0; (body = pdyn_get_body(sim, b)).name; b++)
        fluid |= body.rest_density > 0.0, surface |= body.triangles > 0;
    return surface && (fluid || pdyn_contact_stiffness(sim) > 0.0);
}

int print_time_estimate(const pdyn_context *context, pdyn_sim *sim) {
    double start = wall_seconds(), spent = 0.0, duration = pdyn_duration(sim);
    double at_start = count_points(sim), points = 0.0;
    int steps = 0;
    do {
        points += count_points(sim);
        pdyn_status status = pdyn_step(sim, NULL);
        if (status != PDYN_OK) return report_status(context, status);
        steps++;
        spent = wall_seconds() - start;
    } while (pdyn_time(sim) < duration &&
             spent < (steps < FEW_STEPS ? few_seconds : trial_seconds));
    double h = pdyn_time(sim) / steps;
    printf("steps of %.3g s: %.0f per frame, %.0f in all, %.3g ms each on %d thread%s; a run takes "
           "about ",
           h, ceil(pdyn_frame_interval(sim) / h - 1e-6), duration / h, 1e3 * spent / steps,
           pdyn_thread_count(context), pdyn_thread_count(context) == 1 ? "" : "s");
    bool whole = pdyn_time(sim) >= duration;
    double usual = fmax(at_start, points / steps), growth = 1.0;
    if (usual > 0.0 && !whole) growth = mean_points(sim, at_start) / usual;
    printf("%s", rounded_time(spent / steps * duration / h * growth).text);
    if (growth > 1.0) printf(", with %.2g times as many particles by inlets,", growth);
    if (!whole) {
        printf(" if all is like the first %.2g s", pdyn_time(sim));
        if (may_meet(sim))
            printf(", and up to 20 times as long where a surface meets another or a fluid later");
    }
    printf("\n");
    return EXIT_GOOD;
}
