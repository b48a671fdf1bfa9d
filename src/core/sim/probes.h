/* The probes of a scene: numbers that every step measures for probes.csv. */
#ifndef PDYN_PROBES_H
#define PDYN_PROBES_H

#include "base/snapshot_file.h"
#include "projdyn/probe.h"
#include "solid_load.h"

struct json_file;
struct pdyn_sim;
struct probe_place;

enum { PROBE_COLUMN = 96 }; /* bytes of the name of a column */

struct probes {
    int count, values;
    pdyn_probe_info *probe;      /* count */
    double *value;               /* values: of all probes */
    double *now;                 /* values: without the mean over time */
    double *force[LOAD_SOURCES]; /* particles x 3, N: by each source, in the last step. NULL: no
                                    probe of a body needs it */
    struct probe_place *place;   /* count: where they are now */
    double *x;                   /* points of all probes x 3, m: the places' points */
    double *sample_force; /* samples x 3, N: of the fluids, in the last step. NULL: no probe of a
                             wall of a rigid body */
    char *text;           /* values x PROBE_COLUMN */
    const char **column;  /* values: pointers into text */
};

/* sim->probes stays NULL in a scene without probes. PDYN_BAD_INPUT, with the place in the file:
 * there is no wall where a probe needs one. */
pdyn_status probes_create(struct pdyn_sim *sim, const struct json_file *json);
void probes_free(struct pdyn_sim *sim);

/* Measures at the end of a step of length h, s, whose forces are known. */
void probes_step(struct pdyn_sim *sim, double h);

/* Saves or reads the values: means over time continue. */
void probes_persist(struct pdyn_sim *sim, struct snapshot_file *snapshot);

#endif
