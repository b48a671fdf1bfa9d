/* Shared by the tests of changes while a simulation runs: a pinned sheet, and what calls return. */
#ifndef TEST_CONTROL_SUPPORT_H
#define TEST_CONTROL_SUPPORT_H

#include "projdyn/control.h"
#include "projdyn/module.h"
#include "small_scenes.h"
#include "support.h"

#define FIXED "'duration': 10, 'frame_interval': 0.05, 'time_step': {'fixed': 0.005}"
#define PINNED(settings, stiffness)                                                                \
    SCENE(settings,                                                                                \
          GRID_SHEET("'name': 'sheet', ", "0.4, 0.4", "7, 7", "'area_density': 0.5",               \
                     PAIR(PAIR(SPRINGS(stiffness), BENDING("1e-3")), PINS("'vertices': [0, 6]"))), \
          "")
#define SOLVER(type, step)                                                                         \
    FIXED ", 'solver': {'type': '" type "', 'step': '" step "', 'tolerance': 1e-3}"

#define SHEET PINNED(FIXED, "1000")
enum { VERTICES = 49, SPRING = 0, BENDS = 1, PIN = 2, CORNER = 48 }; /* of the sheet */

/* Of a group: a context, and a directory for states. */
extern pdyn_context *context;
int control_set_up(void **state);
int control_tear_down(void **state);

void good(pdyn_status status);
void refused(pdyn_status status, const char *expected);
void take_steps(pdyn_sim *sim, int count);

/* Callbacks of a type whose elements are the points of a body, pulled to the plane y = 0. */
int all_points(const void *par, const pdyn_body *body);
void select_point(const void *par, const pdyn_batch *b, int first, int last);
void put_on_plane(const void *par, const pdyn_batch *b, int first, int last);

/* A simulation restored from a state saved now ends with the same bits; text: its scene. */
void continues(pdyn_sim *sim, const char *text);

#endif
