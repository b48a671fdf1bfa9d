/* Scenes, bodies and constraints as text, with ' for " (see quoted). Arguments are texts, too:
 *
 *     SCENE("'duration': 1",
 *           PAIR(FLUID_BOX("", "0.02", "0, 0, 0", "0.2, 0.2, 0.2", ""),
 *                GRID_SHEET("'name': 'sheet', ", "1, 1", "9, 9", "'area_density': 0.3",
 *                           SPRINGS("1000"))),
 *           "") */
#ifndef SCENE_TEXT_H
#define SCENE_TEXT_H

/* settings: keys before the bodies; rest: keys after them, each with a comma before it, or "" */
#define SCENE(settings, bodies, rest) "{" settings ", 'bodies': [" bodies "]" rest "}"

/* Two items of a list: bodies or constraints. */
#define PAIR(first, second) first ", " second

/* A rectangular sheet. keys: of the body, each with a comma after it, or ""; size: "x, z" in m;
 * vertices: "columns, rows"; surface: other keys of the surface */
#define GRID_SHEET(keys, size, vertices, surface, constraints)                                     \
    "{" keys "'surface': {'grid': {'size': [" size "], 'vertices': [" vertices "]}, " surface      \
    "}, 'constraints': [" constraints "]}"

/* A box of fluid particles from the corner `minimum` to the corner `maximum`, "x, y, z" in m. keys:
 * as above; fluid: keys of the fluid constraint, each with a comma before it, or "" */
#define FLUID_BOX(keys, radius, minimum, maximum, fluid)                                           \
    "{" keys "'particles': {'radius': " radius ", 'fill': [{'box': {'minimum': [" minimum          \
    "], 'maximum': [" maximum "]}}]}, 'constraints': [{'type': 'fluid'" fluid "}]}"

#define SPRINGS(stiffness) "{'type': 'spring', 'stretching_stiffness': " stiffness "}"
#define STRAIN(stiffness)  "{'type': 'triangle', 'stretching_stiffness': " stiffness "}"
#define BENDING(rigidity)  "{'type': 'bending', 'bending_rigidity': " rigidity "}"
#define PINS(vertices)     "{'type': 'pin', 'vertices': {" vertices "}}"

/* A whole scene: a drop in front of a free sheet whose triangles are three spacings wide. */
#define DROP_AND_SHEET                                                                             \
    SCENE("'duration': 1, 'gravity': [0, 0, 0], 'time_step': {'fixed': 0.004}, 'solver': "         \
          "{'tolerance': 1e-3, 'outer_iterations': 4}",                                            \
          PAIR("{'name': 'water', 'particles': {'radius': 0.01, 'fill': [{'box': {'minimum': "     \
               "[-0.05, 0.025, -0.05], 'maximum': [0.05, 0.105, 0.05]}, 'velocity': [0.1, -1, "    \
               "0.05]}]}, 'constraints': [{'type': 'fluid', 'stiffness': 1e5}]}",                  \
               GRID_SHEET("'name': 'sheet', ", "0.3, 0.3", "6, 6",                                 \
                          "'rotate': [0, 20, 10], 'area_density': 0.5",                            \
                          PAIR(SPRINGS("1000"), BENDING("0.001")))),                               \
          "")

#endif
