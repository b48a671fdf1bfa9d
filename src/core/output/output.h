/* What a run leaves behind: files of one body each, and the report. */
#ifndef PDYN_OUTPUT_H
#define PDYN_OUTPUT_H

#include "step/sim.h"

/* The current state of a body in a file of its own, float: positions, velocity, and the triangles
 * of a surface or the density and pressure of particles. PDYN_IO_FAILED: the file is not there. */
pdyn_status vtk_write_body(const pdyn_sim *sim, int body, const char *path);
pdyn_status ply_write_body(const pdyn_sim *sim, int body, const char *path);
/* The points on the solids that rest, or on those that move. */
pdyn_status vtk_write_boundary(const pdyn_sim *sim, bool moving, const char *path);

/* The numbers of a step, as columns of metrics.csv and members of pdyn_step_info. */
#define STEP_NUMBERS(X)                                                                            \
    X(time_s, time)                                                                                \
    X(h_s, h)                                                                                      \
    X(outer_iterations, outer_iterations)                                                          \
    X(linear_iterations, linear_iterations)                                                        \
    X(particles, particles)                                                                        \
    X(density_error_mean, density_error_mean)                                                      \
    X(density_error_max, density_error_max)                                                        \
    X(step_residual, step_residual)                                                                \
    X(kinetic_J, kinetic_energy)                                                                   \
    X(potential_J, potential_energy)                                                               \
    X(constraint_J, constraint_energy)                                                             \
    X(momentum_x, momentum[0])                                                                     \
    X(momentum_y, momentum[1])                                                                     \
    X(momentum_z, momentum[2])                                                                     \
    X(pin_reaction_x_N, pin_reaction[0])                                                           \
    X(pin_reaction_y_N, pin_reaction[1])                                                           \
    X(pin_reaction_z_N, pin_reaction[2])                                                           \
    X(ms_neighbours, ms_neighbours)                                                                \
    X(ms_local, ms_local)                                                                          \
    X(ms_global, ms_global)                                                                        \
    X(ms_contact, ms_contact)                                                                      \
    X(retries, retries)                                                                            \
    X(ms_cpu, ms_cpu)                                                                              \
    X(impacts, impacts)
enum {
#define STEP_INDEX(column, member) STEP_##column,
    STEP_NUMBERS(STEP_INDEX)
#undef STEP_INDEX
        STEP_COLUMNS
};
void step_numbers(const pdyn_step_info *info, double number[STEP_COLUMNS]);

/* A run so far. */
struct report_tally {
    double sum, min, max;
};
struct report {
    double opened_ms, output_ms; /* wall clock: when the run began, and what its files took */
    long steps, unsolved;        /* unsolved: with a residual above the tolerance */
    pdyn_step_info start, end;
    struct report_tally tally[STEP_COLUMNS]; /* over all steps */
    struct report_tally *residual;           /* bodies */
};
pdyn_status report_open(struct report *report, pdyn_sim *sim);
void report_close(struct report *report, const pdyn_sim *sim);
void report_step(struct report *report, const pdyn_sim *sim, const pdyn_step_info *info);
/* interrupted, failed: see pdyn_writer_report. What is not finite becomes null. */
pdyn_status report_write(const struct report *report, const pdyn_sim *sim, const char *path,
                         bool interrupted, const char *failed);

#endif
