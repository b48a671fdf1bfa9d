/* Seven small scenes that differ in what a step computes and a saved state contains. */
#ifndef SMALL_SCENES_H
#define SMALL_SCENES_H

#include "scene_text.h"

static const char inlet[] =
    "{'duration': 1, 'frame_interval': 0.01, 'time_step': {'maximum': 0.005}, 'bodies': [{'name': "
    "'water', 'particles': {'radius': 0.0125, 'inlets': [{'rectangle': {'center': [0, 0.2, 0], "
    "'size': [0.1, 0.1]}, 'direction': [0, -1, 0], 'speed': 2}], 'budget': 400}, 'constraints': "
    "[{'type': 'fluid', 'stiffness': 1e5}]}], 'outlets': [{'box': {'minimum': [-1, 0.1, -1], "
    "'maximum': [1, 1, 1]}, 'outside': true}]}";

static const char fluid[] =
    "{'duration': 1, 'frame_interval': 0.01, 'time_step': {'maximum': 0.005}, 'solver': {'type': "
    "'dual'}, 'bodies': [{'name': 'water', 'particles': {'radius': 0.02, 'fill': [{'box': "
    "{'minimum': [0, 0, 0], 'maximum': [0.16, 0.12, 0.16]}}]}, 'constraints': [{'type': "
    "'fluid'}]}], 'solids': [{'name': 'tank', 'box': {'minimum': [0, 0, 0], 'maximum': [0.28, 0.2, "
    "0.2]}}, {'name': 'stirrer', 'sphere': {'center': [0.22, 0.1, 0.1], 'radius': 0.03}, 'motion': "
    "[{'time': 0}, {'time': 1, 'translate': [0, 0.1, 0.1]}]}]}";

/* The sheet touches the sphere: the state contains contacts and friction. */
static const char cloth[] =
    SCENE("'duration': 1, 'frame_interval': 0.01, 'time_step': {'fixed': 0.01}, 'contact': "
          "{'thickness': 0.01, 'friction': 0.5}, 'gravity': [{'time': 0, 'gravity': [0, -10, 0]}, "
          "{'time': 0.1, 'gravity': [0, -9, 0]}]",
          GRID_SHEET("'name': 'sheet', ", "0.4, 0.4", "9, 9",
                     "'translate': [0.01, 0.12, 0], 'area_density': 0.5", SPRINGS("1000")),
          ", 'solids': [{'sphere': {'center': [0, 0, 0], 'radius': 0.1}, 'motion': [{'time': 0}, "
          "{'time': 1, 'translate': [0, 0.2, 0], 'rotate': [0, 90, 0]}]}]");

static const char hybrid[] =
    SCENE("'duration': 1, 'frame_interval': 0.01, 'time_step': {'maximum': 0.005}, 'solver': "
          "{'type': 'hybrid'}, 'contact': {'thickness': 0.01}",
          PAIR(FLUID_BOX("'name': 'water', ", "0.02", "0.04, 0.06, 0.04", "0.16, 0.14, 0.16",
                         ", 'stiffness': 1e5"),
               GRID_SHEET("'name': 'sheet', ", "0.2, 0.2", "6, 6",
                          "'translate': [0.1, 0.04, 0.1], 'area_density': 0.5",
                          PAIR(PAIR(SPRINGS("1000"), BENDING("1e-3")), PINS("'border': true")))),
          ", 'solids': [{'name': 'tank', 'box': {'minimum': [-0.1, -0.1, -0.1], 'maximum': [0.3, "
          "0.3, 0.3]}}]");

static const char tets[] =
    "{'duration': 1, 'frame_interval': 0.01, 'time_step': {'fixed': 0.01}, 'bodies': [{'volume': "
    "{'grid': {'size': [0.2, 0.2, 0.2], 'cells': [2, 2, 2]}, 'density': 500, 'translate': [0, "
    "0.105, 0]}, 'constraints': [{'type': 'tet', 'stiffness': [{'time': 0, 'stiffness': 2e4}, "
    "{'time': 1, 'stiffness': 3e4}], 'volume_stiffness': 1e5, "
    "'damping': 0.01}]}], 'contact': {'thickness': 0.01, 'friction': 0.2}, 'solids': [{'plane': "
    "{'center': [0, 0, 0], 'normal': [0, 1, 0], 'size': 1}}]}";

static const char cholesky[] =
    SCENE("'duration': 1, 'frame_interval': 0.01, 'time_step': {'fixed': 0.01}, 'solver': {'type': "
          "'cholesky', 'step': 'projective'}",
          GRID_SHEET("'name': 'sheet', ", "0.4, 0.4", "9, 9", "'area_density': 0.5",
                     PAIR(PAIR(SPRINGS("1000"), BENDING("1e-3")),
                          PINS("'box': {'minimum': [-1, -1, -1], 'maximum': [1, 1, -0.19]}"))),
          "");

static const char rigid[] =
    "{'duration': 1, 'frame_interval': 0.01, 'time_step': {'fixed': 0.01}, 'bodies': [{'rigid': "
    "{'box': {'minimum': [-0.1, -0.05, -0.1], 'maximum': [0.1, 0.05, 0.1]}, 'density': 500, "
    "'translate': [0, 0.055, 0], 'angular_velocity': [1, 2, 0]}}, {'rigid': {'box': {'minimum': "
    "[-0.05, 0.115, -0.05], 'maximum': [0.05, 0.215, 0.05]}, 'mass': 2}}], 'contact': "
    "{'thickness': 0.01, 'friction': 0.2}, 'solids': [{'plane': {'center': [0, 0, 0], 'normal': "
    "[0, 1, 0], 'size': 1}}]}";

static const char *const small_scenes[] = {inlet, fluid, cloth, hybrid, tets, cholesky, rigid};
enum { SMALL_SCENES = sizeof small_scenes / sizeof *small_scenes };

#endif
