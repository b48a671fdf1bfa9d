/* Output of a run: files of bodies, boundary points and solids (VTK, PLY), metrics and report. */
#ifndef PDYN_OUTPUT_H
#define PDYN_OUTPUT_H

#include "run_files.h"
#include "sim/sim.h"

#include <jansson.h>

/* Writes the current state of a body to a file, numbers as 32-bit floats: positions, velocities,
 * and the triangles of a surface or density and pressure of particles. PDYN_IO_FAILED: no file is
 * left. */
pdyn_status vtk_write_body(const pdyn_sim *sim, int body, const char *path);
pdyn_status ply_write_body(const pdyn_sim *sim, int body, const char *path);
/* Writes the current shape of a surface as OBJ, with texture coordinates, groups and materials of
 * the scene's OBJ file, or texture coordinates of a grid. PDYN_BAD_INPUT: that file has changed. */
pdyn_status obj_write_body(const pdyn_sim *sim, int body, const char *path);
/* Writes the mesh that "cell" of a body has replaced, in its place at the start, and how it follows
 * the vertices of the body: the file of a surface with two fields of its points, "vertex", four
 * vertices of the body, and "weight", their weights. */
pdyn_status vtk_write_skin(const pdyn_sim *sim, int body, const char *path);
/* Writes the boundary points on solids at rest, or on those that move. */
pdyn_status vtk_write_boundary(const pdyn_sim *sim, bool moving, const char *path);
/* Writes the vertices of a solid at the current time, and its triangles. */
pdyn_status vtk_write_solid(const pdyn_sim *sim, int solid, const char *path);

/* The entry "strings" of report.json: an array of objects, one for each constraint between a body
 * and another one, {"body": name, "to": name, "from": s, "until": s, "ends": [[vertex, 3
 * corners, 3 weights], ...]}, with indices in their bodies; no "until": to the end. NULL: no
 * memory. */
json_t *report_strings(const pdyn_sim *sim);

/* The numbers of a step: X(column of metrics.csv, member of pdyn_step_info). */
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
    X(impacts, impacts)                                                                            \
    X(leaked, leaked)
enum {
#define STEP_INDEX(column, member) STEP_##column,
    STEP_NUMBERS(STEP_INDEX)
#undef STEP_INDEX
        STEP_COLUMNS
};
/* Converts the numbers of a step to an array in the order of the columns. */
void step_numbers(const pdyn_step_info *info, double number[STEP_COLUMNS]);

/* statistics of one number over the steps of a run */
struct report_stats {
    double sum, min, max;
};
struct report {
    double opened_ms, output_ms; /* wall clock, ms: start of the run; time spent on output */
    long steps, unsolved;        /* unsolved: number of steps with a residual above the tolerance */
    pdyn_step_info start, end;
    struct report_stats stats[STEP_COLUMNS]; /* over all steps */
    struct report_stats *residual;           /* bodies: step residuals */
};
/* Begins and ends a report; report_step adds a step. */
pdyn_status report_open(struct report *report, pdyn_sim *sim);
void report_close(struct report *report, const pdyn_sim *sim);
void report_step(struct report *report, const pdyn_sim *sim, const pdyn_step_info *info);
/* The members of report.json that are known before the first step: the scene. NULL: no memory. */
json_t *report_scene(const struct report *report, const pdyn_sim *sim);
/* Writes report.json. interrupted, failed: see pdyn_writer_report. Numbers that are not finite are
 * written as null. */
pdyn_status report_write(const struct report *report, const pdyn_sim *sim, const char *path,
                         bool interrupted, const char *failed);

#endif
