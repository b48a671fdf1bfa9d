/* Bad scenes and bad overrides, each with its message. */
#include "scene_support.h"

#include <string.h>

/* ---- scenes --------------------------------------------------------------------------------- */

#define FLUID(constraints)                                                                         \
    BODY("{'particles': {'radius': 0.1, 'fill': [{'box': " BOX "}]},\n"                            \
         " 'constraints': [" constraints "]}")
#define INLETS(text)    BODY("{'particles': {'radius': 0.1,\n" text "}}")
#define DISC            "'disc': {'center': [0, 0, 0], 'radius': 1}, "
#define RECTANGLE(size) "'rectangle': {'center': [0, 0, 0], 'size': [" size "]}, "
#define ATTACHED(to)                                                                               \
    BODY("{'name': 'sheet', 'surface': {'grid': {'size': [1, 1], 'vertices': [3, 3]}, "            \
         "'area_density': 1}},\n {'name': 'b', 'surface': {'grid': {'size': [1, 1], 'vertices': "  \
         "[2, 2]}, 'area_density': 1}, 'constraints': [\n  {'type': 'attachment', 'to':       " to \
         ", 'stiffness': 1, 'vertices': {'all': true}}]},\n {'name': 'water', 'particles': "       \
         "{'radius': 0.1, 'fill': [{'box': " BOX "}]}}")
#define LETTERS_13 "abcdefghijklm"
#define LETTERS_65 LETTERS_13 LETTERS_13 LETTERS_13 LETTERS_13 LETTERS_13

static const struct {
    const char *text, *error;
} bad_scenes[] = {
    /* syntax */
    {"", "scene.json:1:1: not valid JSON: *"},
    {"{'duration': 1,\n 'bodies': [}", "scene.json:2:13: not valid JSON: *"},
    {"{'duration': 1,\n 'duration': 2}",
     "scene.json:2:11: not valid JSON: duplicate object key near '\"duration\"'"},
    {"{'duration': 1} x", "scene.json:1:17: not valid JSON: *"},
    {"{'duration': 1e999}", "scene.json:1:18: not valid JSON: *"},
    {"{'duration': 99999999999999999999}", "scene.json:1:33: not valid JSON: *"},
    {"\xef\xbb\xbf{'duration': NaN}", "scene.json:1:19: not valid JSON: *"}, /* byte order mark */
    {"{'duration': NaN}", "scene.json:1:16: not valid JSON: *"},
    {"{'\xff': 1}", "scene.json:1:2: not valid JSON: *"},
    {"{'name': 'a\\u0000b'}", "scene.json:1:19: not valid JSON: *"},
    {"[1, 2]", "scene.json:1:1: expected an object, found an array of 2"},
    /* the scene */
    {"{}", "scene.json:1:1: duration: missing, expected a number from 1e-06 to 1000000 s"},
    {"{'duration': 1}", "scene.json:1:1: bodies: missing, expected at least one body"},
    {"{'duration': 1, 'bodies': []}",
     "scene.json:1:27: bodies: expected at least one body, found an array of 0"},
    {"{'duration': 1, 'bodies': {}}",
     "scene.json:1:27: bodies: expected an array of bodies, found an object"},
    {TOP("'gravty': [0, 0, 0]"),
     "scene.json:2:2: unknown key \"gravty\"; did you mean \"gravity\"?; known: $schema, "
     "name, gravity, time_step, solver, bodies, solids, outlets, contact, plugins, boundary, "
     "probes, duration, "
     "frame_interval"},
    {TOP("'\\u0067ravty': [0, 0, 0]"),
     "scene.json:2:2: unknown key \"gravty\"; did you mean \"gravity\"?; known: $schema, "
     "name, gravity, time_step, solver, bodies, solids, outlets, contact, plugins, boundary, "
     "probes, duration, "
     "frame_interval"},
    {TOP("'gravity': [0, -9.81]"),
     "scene.json:2:13: gravity: expected an array of 3 numbers (m/s^2), found an array of "
     "2"},
    {TOP("'gravity': [0, '-9.81', 0]"),
     "scene.json:2:17: gravity[1]: expected a number from -1000000 to 1000000 m/s^2, "
     "found \"-9.81\""},
    {TOP("'gravity': null"),
     "scene.json:2:13: gravity: expected an array of 3 numbers (m/s^2), found null"},
    {TOP("'$schema': 3"), "scene.json:2:13: $schema: expected a text, found 3"},
    {TOP("'name': 7"), "scene.json:2:10: name: expected a text, found 7"},
    {"{'name': '\xc3\xa4', 'duration': 0}",
     "scene.json:1:27: duration: expected a number from 1e-06 to 1000000 s, found 0"},
    {"{'duration': 0,\n 'bodies': [" WATER "]}",
     "scene.json:1:14: duration: expected a number from 1e-06 to 1000000 s, found 0"},
    {"{'duration': 'long', 'bodies': [" WATER "]}",
     "scene.json:1:14: duration: expected a number from 1e-06 to 1000000 s, found \"long\""},
    {TOP("'frame_interval': -0.1"),
     "scene.json:2:20: frame_interval: expected a number from 1e-06 to 1000 s, found -0.1"},
    /* steps and solvers */
    {TOP("'time_step': 0.1"), "scene.json:2:15: time_step: expected an object, found 0.1"},
    {TOP("'time_step': {'maximum': 0}"),
     "scene.json:2:27: time_step.maximum: expected a number from 1e-09 to 1000 s, found 0"},
    {TOP("'time_step': {'maximum': 1e-6}"),
     "scene.json:2:15: time_step: expected a minimum of at most the maximum, found 1e-05 "
     "and 1e-06 s"},
    {TOP("'time_step': {'fixed': 0.001, 'cfl': 2}"),
     "scene.json:2:32: time_step: \"cfl\" has no meaning beside \"fixed\""},
    {TOP("'time_step': {'fixed': 0}"),
     "scene.json:2:25: time_step.fixed: expected a number from 1e-09 to 1000 s, found 0"},
    {TOP("'time_step': {'max': 0.1}"), "scene.json:2:16: time_step: unknown key \"max\"; known: "
                                       "integrator, maximum, minimum, cfl, fixed"},
    {TOP("'solver': {'type': 'hybird'}"),
     "scene.json:2:21: solver.type: unknown solver \"hybird\"; did you mean "
     "\"hybrid\"?; known: auto, *"},
    {TOP("'solver': null"), "scene.json:2:12: solver: expected an object, found null"},
    {TOP("'solver': {'type': 1}"),
     "scene.json:2:21: solver.type: expected the name of a solver, found 1"},
    {TOP("'solver': {'acceleration': 'anderson'}"),
     "scene.json:2:29: solver.acceleration: only \"step\": \"projective\" is accelerated, found "
     "\"newton\""},
    {TOP("'solver': {'step': 'Newton'}"),
     "scene.json:2:21: solver.step: unknown step \"Newton\"; did you mean \"newton\"?; "
     "known: newton, projective"},
    {TOP("'solver': {'outer_iterations': 20.0}"),
     "scene.json:2:33: solver.outer_iterations: expected a whole number from 1 to 100000, "
     "found 20.0"},
    {TOP("'solver': {'outer_iterations': 0}"),
     "scene.json:2:33: solver.outer_iterations: expected a whole number from 1 to 100000, "
     "found 0"},
    {TOP("'solver': {'linear_iterations': 5000000000}"),
     "scene.json:2:34: solver.linear_iterations: expected a whole number from 1 to "
     "1000000, found 5000000000"},
    {TOP("'solver': {'linear_tolerance': 2}"),
     "scene.json:2:33: solver.linear_tolerance: expected a number from 0 to 1, found 2"},
    {TOP("'solver': {'iterations': 2}"),
     "scene.json:2:13: solver: unknown key \"iterations\"; did you mean "
     "\"linear_iterations\"?; known: type, step, acceleration, tolerance, outer_iterations, "
     "linear_tolerance, linear_iterations, retries"},
    /* bodies of particles */
    {BODY("7"), "scene.json:2:3: bodies[0]: expected an object, found 7"},
    {BODY("{'name': 'a'}"),
     "scene.json:2:3: bodies[0]: expected exactly one of \"particles\", \"surface\", "
     "\"volume\" and \"rigid\", found none"},
    {BODY("{'name': 'a', 'particles': {}, 'surface': {}}"),
     "scene.json:2:3: bodies[0]: expected exactly one of \"particles\", \"surface\", "
     "\"volume\" and \"rigid\", found more"},
    {BODY("{'partcles': {}}"),
     "scene.json:2:4: bodies[0]: unknown key \"partcles\"; did you mean \"particles\"?; "
     "known: name, particles, surface, volume, rigid, constraints, velocity"},
    {BODY("{'particles': {'raduis': 0.1}}"),
     "scene.json:2:18: bodies[0].particles: unknown key \"raduis\"; did you mean "
     "\"radius\"?; known: fill, inlets, overlap, radius, rest_density, budget"},
    {BODY("{'particles': {'density': 1000}}"),
     "scene.json:2:18: bodies[0].particles: unknown key \"density\"; did you mean "
     "\"rest_density\"?; known: fill, inlets, overlap, radius, rest_density, budget"},
    {BODY("{'particles': {'fill': []}}"),
     "scene.json:2:17: bodies[0].particles.radius: missing, expected a number from 1e-06 "
     "to 1000 m"},
    {BODY("{'particles': {'radius': 0.1}}"),
     "scene.json:2:17: bodies[0].particles.fill: missing, expected at least one volume "
     "to fill, or \"inlets\""},
    {BODY("{'particles': {'radius': 0.1, 'fill': []}}"),
     "scene.json:2:41: bodies[0].particles.fill: expected at least one volume to fill, or "
     "\"inlets\", found "
     "an array of 0"},
    {BODY("{'particles': {'radius': 0, 'fill': []}}"),
     "scene.json:2:28: bodies[0].particles.radius: expected a number from 1e-06 to 1000 "
     "m, found 0"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'spher': 1}]}}"),
     "scene.json:2:43: bodies[0].particles.fill[0]: unknown key \"spher\"; did you mean "
     "\"sphere\"?; known: box, sphere, mesh, file, scale, rotate, translate, velocity"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{}]}}"),
     "scene.json:2:42: bodies[0].particles.fill[0]: expected exactly one of \"box\", "
     "\"sphere\", \"mesh\" and \"file\", found none"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'box': 1, 'file': 2}]}}"),
     "scene.json:2:42: bodies[0].particles.fill[0]: expected exactly one of \"box\", "
     "\"sphere\", \"mesh\" and \"file\", found more"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'sphere': 1}]}}"),
     "scene.json:2:53: bodies[0].particles.fill[0].sphere: expected an object, found 1"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'sphere': {'center': [0, 0, 0], 'radius': "
          "0.09}}]}}"),
     "scene.json:2:53: bodies[0].particles.fill[0].sphere: no particle of radius 0.1 m fits "
     "into the shape"},
    {BODY("{'particles': {'radius': 1e-6, 'fill': [{'sphere': {'center': [0, 0, 0], 'radius': "
          "1e6}}]}}"),
     "scene.json:2:54: bodies[0].particles.fill[0].sphere: more than 536870911 points: the "
     "particle radius is too small for the size of the scene"},
    {BODY("{'particles': {'radius': 1, 'fill': [{'sphere': {'center': [-1e6, 0, 0], 'radius': "
          "3}}]}}"),
     "scene.json:2:51: bodies[0].particles.fill[0].sphere: expected particles at most 1e+06 m "
     "from the origin, found x = -1000002 m"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'box': " BOX ", 'scale': 2}]}}"),
     "scene.json:2:96: bodies[0].particles.fill[0]: \"scale\" needs a \"mesh\" or a \"file\""},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'box': " BOX ", 'velocity': 2}]}}"),
     "scene.json:2:108: bodies[0].particles.fill[0].velocity: expected an array of 3 numbers "
     "(m/s), found 2"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'mesh': 3}]}}"),
     "scene.json:2:51: bodies[0].particles.fill[0].mesh: expected the name of a mesh file, .obj "
     "or .ply, found 3"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'file': 3}]}}"),
     "scene.json:2:51: bodies[0].particles.fill[0].file: expected the name of a file of "
     "particles, .ply or .vtk, found 3"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'file': 'a.obj'}]}}"),
     "scene.json:2:51: bodies[0].particles.fill[0].file: a.obj: expected a file of particles "
     "ending with .ply or .vtk"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'box': {'minimum': [0, 0, 0]}}]}}"),
     "scene.json:2:50: bodies[0].particles.fill[0].box.maximum: missing, expected an "
     "array of 3 numbers (m)"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'box': {'minimum': [0, 0, 0],\n"
          "   'maximum': [1, 0, 1]}}]}}"),
     "scene.json:3:19: bodies[0].particles.fill[0].box.maximum[1]: expected a number "
     "above the minimum, 0 m, found 0 m"},
    {BODY("{'particles': {'radius': 0.6, 'fill': [\n   {'box': " BOX "}]}}"),
     "scene.json:3:12: bodies[0].particles.fill[0].box: expected edges of at least 1.2 m "
     "(twice the radius), found 1 m along x"},
    {BODY("{'particles': {'radius': 0.0005, 'fill': [\n   {'box': " BOX "}]}}"),
     "scene.json:3:12: bodies[0].particles.fill[0].box: expected at most 134217728 "
     "particles in the scene, found 1000000000 so far"},
    {BODY("{'particles': {'radius': 0.004, 'fill': [{'box': " BOX "}]}},\n"
          "  {'particles': {'radius': 0.00098, 'fill': [{'box': " BOX "}]}}"),
     "scene.json:3:54: bodies[1].particles.fill[0].box: expected at most 134217728 "
     "particles in the scene, found 134604125 so far"},
    {BODY(WATER ",\n  {'velocity': [1], 'particles': {}}"),
     "scene.json:3:16: bodies[1].velocity: expected an array of 3 numbers (m/s), found an "
     "array of 1"},
    /* names */
    {BODY("{'name': 'a b', 'particles': {}}"),
     "scene.json:2:12: bodies[0].name: expected a name of 1 to 64 letters, digits, '_' "
     "and '-', found \"a b\""},
    {BODY("{'name': '', 'particles': {}}"),
     "scene.json:2:12: bodies[0].name: expected a name of 1 to 64 letters, digits, '_' "
     "and '-', found \"\""},
    {BODY("{'name': 'w\xc3\xa4sser', 'particles': {}}"),
     "scene.json:2:12: bodies[0].name: expected a name of 1 to 64 letters, digits, '_' "
     "and '-', found \"w\xc3"
     "\xa4"
     "sser\""},
    {BODY("{'name': '" LETTERS_65 "', 'particles': {}}"),
     "scene.json:2:12: bodies[0].name: expected a name of 1 to 64 letters, digits, '_' "
     "and '-', found \"abcdefghijklm*"},
    {BODY("{'name': null, 'particles': {}}"),
     "scene.json:2:12: bodies[0].name: expected a name of 1 to 64 letters, digits, '_' "
     "and '-', found null"},
    {BODY("{'name': 'boundary', 'particles': {}}"),
     "scene.json:2:12: bodies[0].name: the name \"boundary\" is reserved for the files of "
     "the solids"},
    {BODY("{'name': 'body1', 'particles': {'radius': 0.1, 'fill': [{'box': " BOX "}]}},\n  " WATER),
     "scene.json:3:3: bodies[1].name: the name \"body1\" is already taken by another body, "
     "solid or probe"},
    {TOP("'solids': [{'name': 'body0', 'box': " BOX "}]"),
     "scene.json:2:22: solids[0].name: the name \"body0\" is already taken by another body, "
     "solid or probe"},
    /* surfaces */
    {BODY("{'surface': {'area_density': 1}}"),
     "scene.json:2:15: bodies[0].surface: expected exactly one of \"grid\" and \"mesh\", "
     "found neither"},
    {BODY("{'surface': {'grid': {}, 'mesh': 'a.obj'}}"),
     "scene.json:2:15: bodies[0].surface: expected exactly one of \"grid\" and \"mesh\", "
     "found both"},
    {BODY("{'surface': {'mesh': 'a.stl', 'area_density': 1}}"),
     "scene.json:2:24: bodies[0].surface.mesh: a.stl: expected a mesh file ending with "
     ".obj or .ply"},
    {BODY("{'surface': {'grid': {}}}"),
     "scene.json:2:15: bodies[0].surface.area_density: missing, expected a number from "
     "1e-06 to 1000000 kg/m^2"},
    {BODY("{'surface': {'grid': {}, 'area_density': 1}}"),
     "scene.json:2:24: bodies[0].surface.grid.size: missing, expected an array of 2 "
     "numbers (m)"},
    {BODY("{'surface': {'grid': {'size': [1, 0], 'vertices': [3, 3]}, 'area_density': 1}}"),
     "scene.json:2:37: bodies[0].surface.grid.size[1]: expected a number from 1e-06 to "
     "1000000 m, found 0"},
    {BODY("{'surface': {'grid': {'size': [1, 1], 'vertices': [3, 3], 'sag': [1]}, "
          "'area_density': 1}}"),
     "scene.json:2:68: bodies[0].surface.grid.sag: expected a number from -1000000 to 1000000 m, "
     "found an array of 1"},
    {BODY("{'surface': {'grid': {'size': [1, 1], 'vertices': [3]}, 'area_density': 1}}"),
     "scene.json:2:53: bodies[0].surface.grid.vertices: expected an array of 2 whole "
     "numbers, found an array of 1"},
    {BODY("{'surface': {'grid': {'size': [1, 1], 'vertices': [3, 1]}, 'area_density': 1}}"),
     "scene.json:2:57: bodies[0].surface.grid.vertices[1]: expected a whole number from 2 "
     "to 134217728, found 1"},
    {BODY("{'surface': {'grid': {'size': [1, 1], 'vertices': [90000, 90000]}, 'area_density': 1}}"),
     "scene.json:2:53: bodies[0].surface.grid.vertices: expected at most 134217728 "
     "particles in the scene, found 8100000000 so far"},
    {BODY("{'surface': {'grid': {'size': [1, 1], 'vertices': [8193, 16384]}, 'area_density': 1}}"),
     "scene.json:2:53: bodies[0].surface.grid.vertices: expected at most 134217728 "
     "particles in the scene, found 134234112 so far"},
    {BODY(SHEET(", 'scale': 0")),
     "scene.json:2:90: bodies[0].surface.scale: expected a number from 1e-06 to 1000000, "
     "found 0"},
    {BODY(SHEET(", 'scale': [1, -1, 1]")),
     "scene.json:2:94: bodies[0].surface.scale[1]: expected a number from 1e-06 to "
     "1000000, found -1"},
    {BODY(SHEET(", 'scale': [1, 1]")),
     "scene.json:2:90: bodies[0].surface.scale: expected an array of 3 numbers, found an "
     "array of 2"},
    {BODY(SHEET(", 'scale': [1e6, 1, 1e-6]")),
     "scene.json:2:24: bodies[0].surface.grid: as placed: triangle 0 (vertices 0, 3, 4) "
     "has no area"},
    {BODY(SHEET(", 'rotate': 90")),
     "scene.json:2:91: bodies[0].surface.rotate: expected an array of 3 numbers "
     "(degrees), found 90"},
    {BODY(SHEET(", 'translate': [0, 0, 1e7]")),
     "scene.json:2:101: bodies[0].surface.translate[2]: expected a number from -1000000 "
     "to 1000000 m, found 10000000.0"},
    /* constraints */
    {CLOTH("7"), "scene.json:3:18: bodies[0].constraints[0]: expected an object, found 7"},
    {CLOTH("{}"), "scene.json:3:18: bodies[0].constraints[0].type: missing, expected the name of a "
                  "constraint"},
    {CLOTH("{'type': 'sprnig'}"),
     "scene.json:3:27: bodies[0].constraints[0].type: unknown constraint \"sprnig\"; did "
     "you mean \"spring\"?; known: attachment, *"},
    {CLOTH("{'type': 'spring'}"),
     "scene.json:3:18: bodies[0].constraints[0].stretching_stiffness: missing, expected a "
     "number from 0 to 1e+12 N/m"},
    {CLOTH("{'type': 'spring', 'stiffness': 1}"),
     "scene.json:3:37: bodies[0].constraints[0]: unknown key \"stiffness\"; did you mean "
     "\"stretching_stiffness\"?; known: type, stretching_stiffness, damping"},
    {CLOTH("{'type': 'spring', 'stretching_stiffness': -1}"),
     "scene.json:3:61: bodies[0].constraints[0].stretching_stiffness: expected a number "
     "from 0 to 1e+12 N/m, found -1"},
    {CLOTH("{'type': 'spring', 'stretching_stiffness': 1},\n  {'type': 'spring'}"),
     "scene.json:4:12: bodies[0].constraints[1].type: a second \"spring\" constraint on "
     "body \"body0\""},
    {CLOTH("{'type': 'fluid'}"),
     "scene.json:3:27: bodies[0].constraints[0].type: \"fluid\" works on a body of "
     "particles, found a surface"},
    {CLOTH("{'type': 'surface_tension', 'tension': 0.07}"),
     "scene.json:3:27: bodies[0].constraints[0].type: \"surface_tension\" works on a body of "
     "particles, found a surface"},
    {FLUID("{'type': 'surface_tension'}"),
     "scene.json:3:18: bodies[0].constraints[0].tension: missing, expected a number from "
     "0 to 1000 N/m"},
    {FLUID("{'type': 'surface_tension', 'tension': -1}"),
     "scene.json:3:57: bodies[0].constraints[0].tension: expected a number from 0 to 1000 N/m, "
     "found -1"},
    {FLUID("{'type': 'surface_tension', 'tension': 1, 'contact_angle': 200}"),
     "scene.json:3:77: bodies[0].constraints[0].contact_angle: expected a number from 0 to 180 "
     "degrees, found 200"},
    {FLUID("{'type': 'bending'}"),
     "scene.json:3:27: bodies[0].constraints[0].type: \"bending\" works on a surface, "
     "found a body of particles"},
    {FLUID("{'type': 'fluid',\n 'stiffness': 1e5, 'compression': 0.001}"),
     "scene.json:4:20: bodies[0].constraints[0]: \"compression\" has no meaning beside "
     "\"stiffness\""},
    {FLUID("{'type': 'fluid',\n 'sound_speed': 50, 'compression': 0.001}"),
     "scene.json:4:2: bodies[0].constraints[0]: \"sound_speed\" has no meaning beside "
     "\"compression\""},
    {FLUID("{'type': 'fluid', 'stiffness': 1e6, 'sound_speed': 50}"),
     "scene.json:3:54: bodies[0].constraints[0]: \"sound_speed\" has no meaning beside "
     "\"stiffness\""},
    {FLUID("{'type': 'fluid', 'compression': 0}"),
     "scene.json:3:51: bodies[0].constraints[0].compression: expected a number from 1e-09 to 0.5, "
     "found 0"},
    {FLUID("{'type': 'fluid', 'sound_speed': '50'}"),
     "scene.json:3:51: bodies[0].constraints[0].sound_speed: expected a number from 0.001 to "
     "1000000 m/s, found \"50\""},
    {"{'duration': 1, 'gravity': [0, 0, 0], 'bodies': [{'particles': {'radius': 0.1, 'fill': [{"
     "'box': " BOX "}]},\n 'constraints': [{'type': 'fluid',\n  'compression': 0.001}]}]}",
     "scene.json:3:18: bodies[0].constraints[0].compression: without gravity no pressure "
     "compresses the fluid; give \"sound_speed\" or \"stiffness\""},
    {"{'duration': 1, 'gravity': [0, -1e6, 0], 'bodies': [{'particles': {'radius': 0.1, 'fill': [{"
     "'box': " BOX "}]},\n 'constraints': [{'type': 'fluid',\n  'compression': 1e-9}]}]}",
     "scene.json:3:18: bodies[0].constraints[0].compression: expected a value that gives a "
     "stiffness of at most 1e+15 N/m"},
    {FLUID("{'type': 'fluid', 'viscosity': true}"),
     "scene.json:3:49: bodies[0].constraints[0].viscosity: expected a number from 0 to 1, "
     "found true"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'box': " BOX
          "}]}, 'constraints': [{'type': 'fluid'}]},\n"
          "  {'particles': {'radius': 0.2, 'fill': [{'box': " BOX
          "}]}, 'constraints': [{'type': 'fluid'}]}"),
     "scene.json:3:124: bodies[1].constraints[0].type: all fluids need the same particle radius: "
     "that of body \"body0\" is 0.1 m, that of body \"body1\" 0.2 m"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'box': " BOX "}]}, 'constraints': {}}"),
     "scene.json:2:114: bodies[0].constraints: expected an array of constraints, found an "
     "object"},
    /* other bodies */
    {ATTACHED("'shee'"),
     "scene.json:4:38: bodies[1].constraints[0].to: unknown body \"shee\"; did you mean "
     "\"sheet\"?; known: sheet"},
    {ATTACHED("'b'"),
     "scene.json:4:38: bodies[1].constraints[0].to: expected another body that has "
     "a surface, found this body"},
    {ATTACHED("'water'"),
     "scene.json:4:38: bodies[1].constraints[0].to: expected another body that "
     "has a surface, found a body of particles"},
    {ATTACHED("'boundary'"), "scene.json:4:38: bodies[1].constraints[0].to: unknown body "
                             "\"boundary\"; known: sheet"},
    {ATTACHED("3"), "scene.json:4:38: bodies[1].constraints[0].to: expected the name of another "
                    "body, found 3"},
    {CLOTH("{'type': 'attachment', 'stiffness': 1, 'vertices': {'all': true}}"),
     "scene.json:3:18: bodies[0].constraints[0].to: missing, expected the name of another body"},
    /* selected vertices and paths */
    {CLOTH("{'type': 'pin'}"),
     "scene.json:3:18: bodies[0].constraints[0].vertices: missing, expected an object "
     "that selects vertices, or an array of such objects"},
    {PIN("'all'"),
     "scene.json:3:46: bodies[0].constraints[0].vertices: expected an object that selects "
     "vertices, or an array of such objects, found \"all\""},
    {PIN("[]"), "scene.json:3:46: bodies[0].constraints[0].vertices: selects none of 9 vertices"},
    {PIN("{}"), "scene.json:3:46: bodies[0].constraints[0].vertices: expected exactly one of "
                "\"all\", \"vertices\", \"box\", \"sphere\", \"border\", found 0 keys"},
    {PIN("{'all': false}"),
     "scene.json:3:54: bodies[0].constraints[0].vertices.all: expected true, found false"},
    {PIN("{'all': true, 'border': true}"),
     "scene.json:3:46: bodies[0].constraints[0].vertices: expected exactly one of "
     "\"all\", \"vertices\", \"box\", \"sphere\", \"border\", found 2 keys"},
    {PIN("{'everything': true}"),
     "scene.json:3:47: bodies[0].constraints[0].vertices: unknown key \"everything\"; "
     "known: all, vertices, box, sphere, border"},
    {PIN("{'vertices': 4}"),
     "scene.json:3:59: bodies[0].constraints[0].vertices.vertices: expected an array of "
     "vertex numbers, found 4"},
    {PIN("{'vertices': [0, 9]}"),
     "scene.json:3:63: bodies[0].constraints[0].vertices.vertices[1]: expected a whole "
     "number from 0 to 8, found 9"},
    {PIN("{'vertices': [0, -1]}"),
     "scene.json:3:63: bodies[0].constraints[0].vertices.vertices[1]: expected a whole "
     "number from 0 to 8, found -1"},
    {PIN("{'vertices': [0.5]}"),
     "scene.json:3:60: bodies[0].constraints[0].vertices.vertices[0]: expected a whole "
     "number from 0 to 8, found 0.5"},
    {PIN("{'box': {'minimum': [5, 5, 5], 'maximum': [6, 6, 6]}}"),
     "scene.json:3:46: bodies[0].constraints[0].vertices: selects none of 9 vertices"},
    {PIN("{'sphere': {'center': [0, 0, 0], 'radius': -1}}"),
     "scene.json:3:89: bodies[0].constraints[0].vertices.sphere.radius: expected a number "
     "from 0 to 1000000 m, found -1"},
    {PIN("[{'all': true}, {'sphere': {'centre': [0, 0, 0]}}]"),
     "scene.json:3:74: bodies[0].constraints[0].vertices[1].sphere: unknown key "
     "\"centre\"; did you mean \"center\"?; known: center, radius"},
    {PIN("{'all': true}, 'path': []"),
     "scene.json:3:69: bodies[0].constraints[0].path: expected an array of at least one "
     "[time, x, y, z] (s, m, m, m), found an array of 0"},
    {PIN("{'all': true}, 'path': [[0, 0, 0]]"),
     "scene.json:3:70: bodies[0].constraints[0].path[0]: expected an array of 4 numbers "
     "(s, m, m, m), found an array of 3"},
    {PIN("{'all': true}, 'path': [[0, 0, 0, 0],\n  [1, 0, 0, 0], [1, 0, 1, 0]]"),
     "scene.json:4:17: bodies[0].constraints[0].path[2]: expected a time after 1 s, found "
     "1 s"},
    /* solids */
    {TOP("'solids': {}"), "scene.json:2:12: solids: expected an array of solids, found an object"},
    {TOP("'solids': [{}]"),
     "scene.json:2:13: solids[0]: expected exactly one of \"box\", \"mesh\", \"sphere\", "
     "\"capsule\" and \"plane\", found none"},
    {TOP("'solids': [{'box': " BOX ", 'mesh': 'a.obj'}]"),
     "scene.json:2:13: solids[0]: expected exactly one of \"box\", \"mesh\", \"sphere\", "
     "\"capsule\" and \"plane\", found more"},
    {TOP("'solids': [{'box': " BOX ", 'open': ['y']}]"),
     "scene.json:2:76: solids[0].open[0]: unknown side \"y\"; did you mean \"-y\"?; "
     "known: -x, +x, -y, +y, -z, +z"},
    {TOP("'solids': [{'box': " BOX ", 'open': '+y'}]"),
     "scene.json:2:75: solids[0].open: expected an array of sides like \"+y\", found "
     "\"+y\""},
    {TOP("'solids': [{'box': " BOX ", 'open': ['+y', '+y']}]"),
     "scene.json:2:82: solids[0].open[1]: the side \"+y\" is given twice"},
    {TOP("'solids': [{'box': " BOX ", 'open': ['-x', '+x', '-y', '+y', '-z', '+z']}]"),
     "scene.json:2:75: solids[0].open: all six sides are open: no wall is left"},
    {TOP("'solids': [{'box': " BOX ", 'scale': 2}]"),
     "scene.json:2:67: solids[0]: \"scale\" needs a \"mesh\""},
    {TOP("'solids': [{'mesh': 'a.obj', 'open': []}]"),
     "scene.json:2:31: solids[0]: \"open\" needs a \"box\""},
    {TOP("'solids': [{'mesh': 'a.obj', 'scale': [1, 0, 1]}]"),
     "scene.json:2:40: solids[0].scale: expected a scale that is not 0, found an array of "
     "3"},
    {TOP("'solids': [{'mesh': 7}]"),
     "scene.json:2:22: solids[0].mesh: expected the name of a mesh file, .obj or .ply, "
     "found 7"},
    {TOP("'solids': [{'sphere': {'center': [0, 0, 0], 'radius': 0}}]"),
     "scene.json:2:56: solids[0].sphere.radius: expected a number from 1e-06 to 1000000 m, found "
     "0"},
    {TOP("'solids': [{'capsule': {'from': [0, 0, 0], 'radius': 1}}]"),
     "scene.json:2:25: solids[0].capsule.to: missing, expected an array of 3 numbers (m)"},
    {TOP("'solids': [{'plane': {'center': [0, 0, 0], 'normal': [0, 0, 0], 'size': 1}}]"),
     "scene.json:2:55: solids[0].plane.normal: expected a direction that is not 0, found an array "
     "of 3"},
    {TOP("'solids': [{'sphere': {'center': [0, 0, 0], 'radius': 1}, 'rotate': [0, 0, 0]}]"),
     "scene.json:2:60: solids[0]: \"rotate\" needs a \"mesh\""},
    /* contact */
    {TOP("'contact': {'thickness': 0.001}"),
     "scene.json:2:2: \"contact\" needs a body with a surface"},
    {"{'duration': 1, 'bodies': [" SHEET("") "],\n 'contact': {}}",
     "scene.json:2:13: contact.thickness: missing, expected a number from 1e-09 to 1000 m"},
    {"{'duration': 1, 'bodies': [" SHEET(
         "") "],\n 'contact': {'thickness': 0.001, 'friction': -1}}",
     "scene.json:2:46: contact.friction: expected a number from 0 to 100, found -1"},
    /* inlets */
    {INLETS("'fill': [{'box': " BOX "}], 'inlets': 1"),
     "scene.json:3:76: bodies[0].particles.inlets: expected an array of inlets, found 1"},
    {INLETS("'inlets': []"),
     "scene.json:2:17: bodies[0].particles.fill: missing, expected at least one "
     "volume to fill, or \"inlets\""},
    {INLETS("'inlets': [{" DISC "'direction': [0, 0, 0], 'speed': 1}]"),
     "scene.json:3:70: bodies[0].particles.inlets[0].direction: expected a direction that is not "
     "0, found an array of 3"},
    {INLETS("'inlets': [{" DISC "'direction': [1, 0, 0], 'speed': 0}]"),
     "scene.json:3:90: bodies[0].particles.inlets[0].speed: expected a number from 1e-06 to "
     "1000000 m/s, found 0"},
    {INLETS("'inlets': [{'direction': [1, 0, 0], 'speed': 1}]"),
     "scene.json:3:12: bodies[0].particles.inlets[0]: expected exactly one of \"rectangle\" and "
     "\"disc\", found neither"},
    {INLETS("'inlets': [{" DISC RECTANGLE("1, 1") "'direction': [1, 0, 0], 'speed': 1}]"),
     "scene.json:3:12: bodies[0].particles.inlets[0]: expected exactly one of \"rectangle\" and "
     "\"disc\", found both"},
    {INLETS("'inlets': [{" RECTANGLE("1, 0.1") "'direction': [1, 0, 0], 'speed': 1}]"),
     "scene.json:3:56: bodies[0].particles.inlets[0].rectangle.size: expected edges of at least "
     "0.2 m (twice the radius), found 0.1 m"},
    {INLETS("'inlets': [{" RECTANGLE("1e6, 1e6") "'direction': [1, 0, 0], 'speed': 1}]"),
     "scene.json:3:26: bodies[0].particles.inlets[0].rectangle: expected at most 134217728 "
     "particles in a layer, found about 2.5e+13"},
    {INLETS("'inlets': [{" DISC "'direction': [0, 2, 0], 'up': [0, -1, 0], 'speed': 1}]"),
     "scene.json:3:87: bodies[0].particles.inlets[0].up: expected a direction that is not 0 "
     "and not parallel to the flow, found an array of 3"},
    {INLETS("'inlets': [{" DISC "'direction': [1, 0, 0], 'speed': 1, 'stop': 1}]"),
     "scene.json:3:93: bodies[0].particles.inlets[0]: unknown key \"stop\"*"},
    {INLETS("'inlets': [{" DISC "'direction': [1, 0, 0], 'speed': 1e6, 'start': 0.5}]"),
     "scene.json:3:11: bodies[0].particles.inlets: expected at most 134217728 particles in the "
     "scene, found 202500000 so far"},
    {INLETS("'inlets': [{" DISC "'direction': [1, 0, 0], 'speed': 1}], 'budget': 0"),
     "scene.json:3:105: bodies[0].particles.budget: expected a whole number from 1 to 134217728, "
     "found 0"},
    {INLETS("'fill': [{'box': " BOX "}], 'budget': 5"),
     "scene.json:3:66: bodies[0].particles: \"budget\" needs \"inlets\""},
    /* outlets */
    {TOP("'outlets': {}"),
     "scene.json:2:13: outlets: expected an array of outlets, found an object"},
    {TOP("'outlets': [{'outside': true}]"),
     "scene.json:2:14: outlets[0].box: missing, expected an object"},
    {TOP("'outlets': [{'box': " BOX ", 'outside': 1}]"),
     "scene.json:2:79: outlets[0].outside: expected true or false, found 1"},
    {TOP("'solids': [{'box': " BOX ", 'pivot': [0, 0, 0]}]"),
     "scene.json:2:67: solids[0]: \"pivot\" needs a \"motion\""},
    {TOP("'solids': [{'box': " BOX ", 'motion': {}}]"),
     "scene.json:2:77: solids[0].motion: expected an array of keys, found an object"},
    {TOP("'solids': [{'box': " BOX ", 'motion': []}]"),
     "scene.json:2:77: solids[0].motion: expected at least one key, found an array of 0"},
    {TOP("'solids': [{'box': " BOX ", 'motion': [{'translate': [0, 0, 0]}]}]"),
     "scene.json:2:78: solids[0].motion[0].time: missing, expected a number from -1000000 to "
     "1000000 s"},
    {TOP("'solids': [{'box': " BOX ", 'motion': [{'time': 0, 'rotation': [0, 0, 0]}]}]"),
     "scene.json:2:90: solids[0].motion[0]: unknown key \"rotation\"; did you mean \"rotate\"?; "
     "known: time, translate, rotate"},
    {TOP("'solids': [{'box': " BOX ", 'motion': [{'time': 1},\n {'time': 1}]}]"),
     "scene.json:3:11: solids[0].motion[1].time: expected a time after 1 s, found 1 s"},
    {TOP("'solids': [{'box': " BOX ", 'motion': [{'time': 1}], 'pivot': [0, 0]}]"),
     "scene.json:2:101: solids[0].pivot: expected an array of 3 numbers (m), found an array of 2"},
};

static void test_bad_scenes(void **state) {
    (void)state;
    for (int k = 0; k < COUNT(bad_scenes); k++) {
        struct scene scene;
        assert_failure(read_text(bad_scenes[k].text, NULL, 0, &scene), &scene, bad_scenes[k].error);
    }
}

/* Nesting that would exhaust the stack of a careless reader. */
static void test_deep_nesting(void **state) {
    (void)state;
    struct scene scene;
    char text[5001];
    memset(text, '[', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    assert_failure(read_text(text, NULL, 0, &scene), &scene,
                   "scene.json:1:2049: not valid JSON: *");
}

static void test_bad_meshes(void **state) {
    (void)state;
    static const struct {
        const char *mesh, *error;
    } bad[] = {
        {"v 0 0 0\nv 1 0\n",
         "scene.json:2:24: bodies[0].surface.mesh: bad.obj:2: expected 3 coordinates after "
         "'v', found the end of the line"},
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nf 1 2 3\n",
         "scene.json:2:24: bodies[0].surface.mesh: as placed: vertex 3 is used by no triangle"},
        {"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n",
         "scene.json:2:24: bodies[0].surface.mesh: as placed: triangle 0 (vertices 0, 1, 2) "
         "has no area"},
        {"v 0 0 0\nv 1e12 0 0\nv 0 1e12 0\nf 1 2 3\n",
         "scene.json:2:24: bodies[0].surface.mesh: as placed: vertex 1: expected a finite x "
         "of at most 1e+12 m, found 1e+13"},
    };
    for (int k = 0; k < COUNT(bad); k++) {
        struct scene scene;
        test_write_text("bad.obj", bad[k].mesh);
        pdyn_status status =
            read_text(BODY("{'surface': {'mesh': 'bad.obj', 'scale': 10, 'area_density': 1}}"),
                      NULL, 0, &scene);
        assert_failure(status, &scene, bad[k].error);
    }
    test_remove_file("bad.obj");
}

/* ---- overrides ------------------------------------------------------------------------------ */

static const struct {
    const char *set, *error;
} bad_overrides[] = {
    {"duration", "--set duration: expected PATH=VALUE, found no '='"},
    {"=1", "--set =1: expected PATH=VALUE, found an empty key"},
    {"bodies..name=1", "--set bodies..name=1: expected PATH=VALUE, found an empty key"},
    {"duration.=1", "--set duration.=1: expected PATH=VALUE, found an empty key"},
    {"a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a=1",
     "--set a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a=1: expected "
     "PATH=VALUE, found more than 32 keys"},
    {"name=\xff", "--set name=\xff"
                  ": expected PATH=VALUE in UTF-8"},
    {"duration=soon",
     "--set duration=soon: duration: expected a number from 1e-06 to 1000000 s, found "
     "\"soon\""},
    {"duration=1e999",
     "--set duration=1e999: duration: expected a number from 1e-06 to 1000000 s, found "
     "\"1e999\""},
    {"duration=-1",
     "--set duration=-1: duration: expected a number from 1e-06 to 1000000 s, found -1"},
    {"duration.seconds=1",
     "--set duration.seconds=1: \"seconds\" is a key of a value that is neither an "
     "object nor an array"},
    {"solver.typ=cg",
     "--set solver.typ=cg: solver: unknown key \"typ\"; did you mean \"type\"?; known: "
     "type, step, acceleration, tolerance, outer_iterations, linear_tolerance, linear_iterations, "
     "retries"},
    {"solvr.type=cg",
     "--set solvr.type=cg: unknown key \"solvr\"; did you mean \"solver\"?; known: "
     "$schema, name, gravity, time_step, solver, bodies, solids, outlets, contact, plugins, "
     "boundary, "
     "probes, duration, "
     "frame_interval"},
    {"solver.type=gc",
     "--set solver.type=gc: solver.type: unknown solver \"gc\"; did you mean \"cg\"?; "
     "known: auto, *"},
    {"solver={\"type\": \"cg\", \"step\": 2}",
     "--set solver={\"type\": \"cg\", \"step\": 2}: solver.step: expected the name of a "
     "step, found 2"},
    {"bodies.shet.velocity=[0, 0, 1]",
     "--set bodies.shet.velocity=[0, 0, 1]: no element \"shet\"; did you mean \"sheet\"?; "
     "known: 0 (water), 1 (sheet)"},
    {"bodies.7.velocity=[0, 0, 1]",
     "--set bodies.7.velocity=[0, 0, 1]: no element \"7\"; known: 0 (water), 1 (sheet)"},
    {"bodies.sheet.constraints.pin.stiffness=1",
     "--set bodies.sheet.constraints.pin.stiffness=1: no element \"pin\"; known: 0 "
     "(spring)"},
    {"bodies.sheet.constraints.spring.stretching_stiffness=\"2\"",
     "--set bodies.sheet.constraints.spring.stretching_stiffness=\"2\": "
     "bodies[1].constraints[0].stretching_stiffness: expected a number from 0 to 1e+12 "
     "N/m, found \"2\""},
    {"bodies.0.particles.radius=true",
     "--set bodies.0.particles.radius=true: bodies[0].particles.radius: expected a number "
     "from 1e-06 to 1000 m, found true"},
    {"bodies.water.particles.fill.1.box=1",
     "--set bodies.water.particles.fill.1.box=1: no element \"1\"; known: 0"},
    {"bodies.water.particles.fill.0.box.maximum.1=-1",
     "--set bodies.water.particles.fill.0.box.maximum.1=-1: "
     "bodies[0].particles.fill[0].box.maximum[1]: expected a number above the minimum, 0 "
     "m, found -1 m"},
    {"bodies.0=null", "--set bodies.0=null: bodies[0]: expected an object, found null"},
    {"bodies=[]", "--set bodies=[]: bodies: expected at least one body, found an array of 0"},
    {"bodies.sheet.constraints=[]", ""},
    {"bodies.sheet.surface.grid.vertices=[3, 3.5]",
     "--set bodies.sheet.surface.grid.vertices=[3, 3.5]: "
     "bodies[1].surface.grid.vertices[1]: expected a whole number from 2 to 134217728, "
     "found 3.5"},
};

static void test_bad_overrides(void **state) {
    (void)state;
    for (int k = 0; k < COUNT(bad_overrides); k++) {
        struct scene scene;
        const char *const set[] = {"name=first", bad_overrides[k].set};
        pdyn_status status = read_text(BOTH, set, 2, &scene);
        if (status == PDYN_OK && !*bad_overrides[k].error) {
            free_good(&scene);
            continue;
        }
        assert_failure(status, &scene, bad_overrides[k].error);
    }
}

/* What an override leaves alone still stands in the file. */
static void test_place_beside_overrides(void **state) {
    (void)state;
    struct scene scene;
    static const char *const set[] = {"bodies.sheet.constraints.spring.stretching_stiffness=5",
                                      "bodies.sheet.velocity=[0, 0, 1]"};
    const char *text =
        "{'duration': 1, 'bodies': [\n {'name': 'sheet', 'surface': {'grid': {'size': [1, 1], "
        "'vertices': [3, 3]}, 'area_density': 1},\n"
        "  'constraints': [{'type': 'spring', 'stretching_stiffness': 1},\n"
        "   {'type': 'pin', 'vertices': {'all': 3}}]}]}";
    pdyn_status status = read_text(text, set, 2, &scene);
    assert_failure(
        status, &scene,
        "scene.json:4:40: bodies[0].constraints[1].vertices.all: expected true, found 3");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bad_scenes),
        cmocka_unit_test(test_deep_nesting),
        cmocka_unit_test(test_bad_meshes),
        cmocka_unit_test(test_bad_overrides),
        cmocka_unit_test(test_place_beside_overrides),
    };
    return cmocka_run_group_tests_name("bad_scenes", tests, scene_set_up, scene_tear_down);
}
