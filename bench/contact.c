/* Contact in a scene: runs it and counts intersecting triangles in every frame (tests/intersect.h).
 * Prints a row of CSV: vertices, steps, frames, intersections, mean elements in contact, mean outer
 * iterations, mean and largest step residual, ms per step of contact and of everything else,
 * largest displacement of a vertex in the second half, mm. */
#include "contact/contact.h"
#include "../tests/intersect.h"
#include "bench.h"

#include "projdyn/vec3.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct tally {
    long steps, frames, intersections, contacts;
    double outer, residual, worst, ms_contact, ms_rest;
};

static void add(struct tally *t, const pdyn_sim *sim, const pdyn_step_info *info) {
    t->steps++;
    t->outer += info->outer_iterations;
    t->residual += info->step_residual;
    t->worst = fmax(t->worst, info->step_residual);
    t->ms_contact += info->ms_contact;
    t->ms_rest += info->ms_local + info->ms_global + info->ms_neighbours;
    if (!info->frame) return;
    struct soup soup = soup_of(sim);
    int a = 0, b = 0, found = soup_intersections(&soup, &a, &b);
    if (found && !t->intersections)
        fprintf(stderr, "at %g s: %d pairs intersect, first triangles %d and %d\n", info->time,
                found, a, b);
    t->frames++, t->intersections += found;
    soup_free(&soup);
}

/* Largest displacement of a vertex between two states, m. */
static double most_moved(const double *a, const double *b, int particles) {
    double most = 0.0;
    for (int i = 0; i < particles; i++) most = fmax(most, vec3_distance(a + 3 * i, b + 3 * i));
    return most;
}

int main(int argc, char **argv) {
    pdyn_sim *sim = NULL;
    struct tally t = {0};
    if (argc < 2) die("usage: contact SCENE [PATH=VALUE]...");
    pdyn_context *context = make_context(1);
    if (pdyn_load(context, argv[1], (const char *const *)argv + 2, argc - 2, &sim) != PDYN_OK)
        die("%s", pdyn_last_error(context));
    size_t bytes = 3 * (size_t)sim->objective.particles * sizeof(double);
    double *half = malloc(bytes);
    if (!half) die("out of memory");
    while (!pdyn_is_finished(sim)) {
        const pdyn_step_info info = take_step(sim);
        add(&t, sim, &info);
        if (pdyn_time(sim) < 0.5 * pdyn_duration(sim) + 1e-9) memcpy(half, sim->x, bytes);
        t.contacts += contact_current(sim->objective.contact)->count;
    }
    double n = (double)t.steps;
    printf("%d,%ld,%ld,%ld,%.0f,%.1f,%.3g,%.3g,%.2f,%.2f,%.3g\n", sim->objective.particles, t.steps,
           t.frames, t.intersections, (double)t.contacts / n, t.outer / n, t.residual / n, t.worst,
           t.ms_contact / n, t.ms_rest / n,
           1e3 * most_moved(half, sim->x, sim->objective.particles));
    free(half);
    pdyn_free(sim);
    pdyn_destroy(context);
    return EXIT_SUCCESS;
}
