/* For tests of warnings: scenes of dust and of a sheet, and looking for a warning. */
#ifndef WARNING_SUPPORT_H
#define WARNING_SUPPORT_H

#include "support.h"

/* A block of 6 x 6 x 6 particles without constraints; velocity: "x, y, z". */
#define DUST(velocity)                                                                             \
    "{'name': 'dust', 'velocity': [" velocity "], 'particles': {'radius': 0.01, 'fill': [{'box': " \
    "{'minimum': [-0.06, 0.02, -0.06], 'maximum': [0.06, 0.14, 0.06]}}]}, 'constraints': []}"
/* A sheet of 0.16 m at y = 0. */
#define SHEET(constraints)                                                                         \
    GRID_SHEET("'name': 'sheet', ", "0.16, 0.16", "9, 9", "'area_density': 0.2",                   \
               SPRINGS("100") ", " constraints)
#define SHEET_AT(name, height)                                                                     \
    GRID_SHEET("'name': '" name "', ", "0.16, 0.16", "9, 9",                                       \
               "'area_density': 0.2, 'translate': [0, " height ", 0]", SPRINGS("100"))
#define BORDER             SHEET(PINS("'border': true"))
#define STEPS              "'time_step': {'fixed': 0.01}, 'frame_interval': 0.01, 'duration': 1"
#define WEIGHTLESS         STEPS ", 'gravity': [0, 0, 0]"
#define CONTACT(thickness) ", 'contact': {'thickness': " thickness "}"

/* The warning of a code about a subject; without a code if there is none. */
pdyn_warning find_warning(const pdyn_sim *sim, const char *code, const char *subject);

/* Whether a scene has the warning when it is loaded. */
bool warns(const char *scene, const char *code, const char *subject);

#endif
