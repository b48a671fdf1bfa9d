/* Names of the files in the directory of a run. NAME: of a body, a solid, or BOUNDARY. */
#ifndef PDYN_RUN_FILES_H
#define PDYN_RUN_FILES_H

#include <stddef.h>
#include <string.h>

#define REPORT_FILE  "report.json"
#define LIST_FILE    "files.json" /* of the files and series of the run (previous_run.c) */
#define RECORD_FILE  "run.json"   /* written by `projdyn run` */
#define METRICS_FILE "metrics.csv"
#define PROBES_FILE  "probes.csv"
#define STATE_FILE   "state.pdyn"
#define LOCK_FILE    "lock"

#define BOUNDARY      "boundary" /* of the boundary points */
#define SOLIDS_FOLDER "solids/"  /* of the files of solids */
#define MESH_FOLDER   "mesh/"    /* of the surfaces of fluids by `projdyn mesh` */

#define SHAPE_ENDING  ".vtk" /* of frames, and of the one file of a solid at rest */
#define SERIES_ENDING ".vtk.series"
#define SKIN_ENDING   ".skin.vtk"
#define PLY_ENDING    ".ply"
#define OBJ_ENDING    ".obj"

/* The ending of a frame NAME_dddddd.ENDING, with six to ten digits, from its dot on. number: what
 * follows NAME. NULL: only such files are frames. */
static inline const char *frame_ending(const char *number) {
    size_t digits = *number == '_' ? strspn(number + 1, "0123456789") : 0;
    const char *ending = number + 1 + digits;
    return digits >= 6 && digits <= 10 && *ending == '.' ? ending : NULL;
}

#endif
