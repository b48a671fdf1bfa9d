/* Bad constraints, with their parameters and the vertices that they select, each with its
 * message. */
#include "scene_support.h"

#define FLUID(constraints)                                                                         \
    BODY("{'particles': {'radius': 0.1, 'fill': [{'box': " BOX "}]},\n"                            \
         " 'constraints': [" constraints "]}")
#define ATTACHED(to)                                                                               \
    BODY("{'name': 'sheet', 'surface': {'grid': {'size': [1, 1], 'vertices': [3, 3]}, "            \
         "'area_density': 1}},\n {'name': 'b', 'surface': {'grid': {'size': [1, 1], 'vertices': "  \
         "[2, 2]}, 'area_density': 1}, 'constraints': [\n  {'type': 'attachment', 'to':       " to \
         ", 'stiffness': 1, 'vertices': {'all': true}}]},\n {'name': 'water', 'particles': "       \
         "{'radius': 0.1, 'fill': [{'box': " BOX "}]}}")

static const struct bad_scene bad_constraints[] = {
    /* constraints */
    {CLOTH("7"),
     "scene.json:3:18: bodies[0].constraints[0]: expected an object with a \"type\", found 7"},
    {CLOTH("{}"), "scene.json:3:18: bodies[0].constraints[0].type: missing, expected the name of a "
                  "constraint"},
    {CLOTH("{'type': 'sprnig'}"),
     "scene.json:3:27: bodies[0].constraints[0].type: unknown constraint \"sprnig\"; did "
     "you mean \"spring\"?; known: attachment, *"},
    {CLOTH("{'type': 'seam'}"),
     "scene.json:3:27: bodies[0].constraints[0].type: unknown constraint \"seam\"; did you mean "
     "\"attachment\"?; known: attachment, *"},
    {CLOTH("{'type': 'spring'}"),
     "scene.json:3:18: bodies[0].constraints[0].stretching_stiffness: missing, expected a "
     "number from 0 to 1e+12 N/m"},
    {CLOTH("{'type': 'spring', 'stiffness': 1}"),
     "scene.json:3:37: bodies[0].constraints[0]: unknown key \"stiffness\"; did you mean "
     "\"stretching_stiffness\"?; known: type, from, until, stretching_stiffness, damping"},
    {CLOTH("{'type': 'spring', 'stretching_stiffness': -1}"),
     "scene.json:3:61: bodies[0].constraints[0].stretching_stiffness: expected a number "
     "from 0 to 1e+12 N/m, found -1"},
    {CLOTH("{'type': 'spring', 'stretching_stiffness': 1},\n  {'type': 'spring'}"),
     "scene.json:4:12: bodies[0].constraints[1].type: a second \"spring\" constraint on "
     "body \"body0\""},
    {CLOTH("{'type': 'pin', 'vertices': {'all': true},\n 'from': 0.5, 'until': 0.5}"),
     "scene.json:4:24: bodies[0].constraints[0].until: expected a time after 0.5 s, found 0.5 s"},
    {CLOTH("{'type': 'pin', 'vertices': {'all': true},\n 'until': 0}"),
     "scene.json:4:11: bodies[0].constraints[0].until: expected a time after 0 s, found 0 s"},
    {CLOTH("{'type': 'pin', 'vertices': {'all': true},\n 'from': -1}"),
     "scene.json:4:10: bodies[0].constraints[0].from: expected a number from 0 to 1000000000 s, "
     "found -1"},
    {CLOTH("{'type': 'spring', 'stretching_stiffness': [{'time': 1}]}"),
     "scene.json:3:62: bodies[0].constraints[0].stretching_stiffness[0].stretching_stiffness: "
     "missing, expected a number from 0 to 1e+12 N/m"},
    {CLOTH("{'type': 'spring', 'stretching_stiffness': [{'time': 1, 'value': 2}]}"),
     "scene.json:3:74: bodies[0].constraints[0].stretching_stiffness[0]: unknown key \"value\"; "
     "known: time, stretching_stiffness"},
    {CLOTH("{'type': 'spring', 'stretching_stiffness': [{'stretching_stiffness': 2}]}"),
     "scene.json:3:62: bodies[0].constraints[0].stretching_stiffness[0].time: missing, expected a "
     "number from -1000000 to 1000000 s"},
    {CLOTH("{'type': 'spring', 'stretching_stiffness': [\n"
           "{'time': 1, 'stretching_stiffness': 2}, {'time': 1, 'stretching_stiffness': 2}]}"),
     "scene.json:4:50: bodies[0].constraints[0].stretching_stiffness[1].time: expected a time "
     "after "
     "1 s, found 1 s"},
    {CLOTH("{'type': 'wind', 'velocity': [{'time': 1, 'velocity': 2}]}"),
     "scene.json:3:72: bodies[0].constraints[0].velocity[0].velocity: expected an array of 3 "
     "numbers (m/s), found 2"},
    {FLUID("{'type': 'fluid', 'stiffness': [{'time': 0, 'stiffness': 1}]}"),
     "scene.json:3:49: bodies[0].constraints[0].stiffness: \"stiffness\" cannot change over time, "
     "found keys"},
    {FLUID("{'type': 'fluid',\n 'until': 1}"),
     "scene.json:4:2: bodies[0].constraints[0]: \"fluid\" is matrix-free and acts all the time"},
    {CLOTH("{'type': 'fluid'}"),
     "scene.json:3:27: bodies[0].constraints[0].type: \"fluid\" works on a body of "
     "particles, found a surface"},
    {CLOTH("{'type': 'surface_tension', 'tension': 0.07}"),
     "scene.json:3:27: bodies[0].constraints[0].type: \"surface_tension\" works on a body of "
     "particles, found a surface"},
    {FLUID("{'type': 'surface_tension'}"),
     "scene.json:3:18: bodies[0].constraints[0].tension: missing, expected a number from "
     "0 to 1000 N/m"},
    {FLUID("{'type': 'surface_tension', 'sigma': 0.07}"),
     "scene.json:3:46: bodies[0].constraints[0]: unknown key \"sigma\"; did you mean \"tension\"?; "
     "known: type, from, until, tension, contact_angle"},
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
     "1000000 m/s, found \"50\"; JSON writes 50"},
    {"{'duration': 1, 'gravity': [0, 0, 0], 'bodies': [{'particles': {'radius': 0.1, 'fill': [{"
     "'box': " BOX "}]},\n 'constraints': [{'type': 'fluid',\n  'compression': 0.001}]}]}",
     "scene.json:3:18: bodies[0].constraints[0].compression: without gravity no pressure "
     "compresses the fluid; give \"sound_speed\" or \"stiffness\""},
    {"{'duration': 1, 'gravity': [0, -1e6, 0], 'bodies': [{'particles': {'radius': 0.1, 'fill': [{"
     "'box': " BOX "}]},\n 'constraints': [{'type': 'fluid',\n  'compression': 1e-9}]}]}",
     "scene.json:3:18: bodies[0].constraints[0].compression: expected a value that gives a "
     "stiffness of at most 1e+15 N/m"},
    {FLUID("{'type': 'fluid', 'viscosity': 5}"),
     "scene.json:3:49: bodies[0].constraints[0].viscosity: expected a number from 0 to 1, "
     "found 5; meaning: fraction of the velocity difference to the neighbours that a step removes "
     "(XSPH); the constraint \"viscosity\" has Pa s"},
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
    {"{'duration': 1, 'solids': [{'name': 'hook', 'box': " BOX
     "}], 'bodies': [{'surface': {'grid': "
     "{'size': [1, 1], 'vertices': [2, 2]}, 'area_density': 1}, 'constraints': [\n{'type': "
     "'attachment', 'to': 'hook', 'stiffness': 1, 'vertices': {'all': true}}]}]}",
     "scene.json:2:30: bodies[0].constraints[0].to: expected another body that has a surface, "
     "found a solid; take a rigid body whose \"pin\" moves all vertices by \"path\" and \"turn\" "
     "as the \"motion\" does, or hold points at the solid by such a \"pin\""},
    {ATTACHED("3"), "scene.json:4:38: bodies[1].constraints[0].to: expected the name of another "
                    "body, found 3"},
    {CLOTH("{'type': 'attachment', 'stiffness': 1, 'vertices': {'all': true}}"),
     "scene.json:3:18: bodies[0].constraints[0].to: missing, expected the name of another body"},
    /* selected vertices and paths */
    {CLOTH("{'type': 'pin'}"),
     "scene.json:3:18: bodies[0].constraints[0].vertices: missing, expected an object "
     "that selects vertices, such as {\"all\": true}, or an array of such objects"},
    {PIN("'all'"),
     "scene.json:3:46: bodies[0].constraints[0].vertices: expected an object that selects "
     "vertices, such as {\"all\": true}, or an array of such objects, found \"all\""},
    {PIN("[0]"),
     "scene.json:3:47: bodies[0].constraints[0].vertices[0]: expected an object that selects "
     "vertices, such as {\"vertices\": [0, 4]}, found 0"},
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
    {PIN("{'boundary': true}"),
     "scene.json:3:47: bodies[0].constraints[0].vertices: unknown key \"boundary\"; did you mean "
     "\"border\"?; known: all, vertices, box, sphere, border"},
    {PIN("[{'boundary': true}]"), "scene.json:3:48: bodies[0].constraints[0].vertices[0]: unknown "
                                  "key \"boundary\"; did you mean "
                                  "\"border\"?; known: all, vertices, box, sphere, border"},
    {PIN("{'all': true}, 'path': []"),
     "scene.json:3:69: bodies[0].constraints[0].path: expected an array of at least one "
     "[time, x, y, z] (s, m, m, m), found an array of 0"},
    {PIN("{'all': true}, 'path': [[0, 0, 0]]"),
     "scene.json:3:70: bodies[0].constraints[0].path[0]: expected an array of 4 numbers "
     "(s, m, m, m), found an array of 3"},
    {PIN("{'all': true}, 'path': [[0, 0, 0, 0],\n  [1, 0, 0, 0], [1, 0, 1, 0]]"),
     "scene.json:4:17: bodies[0].constraints[0].path[2]: expected a time after 1 s, found "
     "1 s"},
};

static void test_bad_constraints(void **state) {
    (void)state;
    assert_bad_scenes(bad_constraints, COUNT(bad_constraints));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bad_constraints),
    };
    return cmocka_run_group_tests_name("bad_constraints", tests, scene_set_up, scene_tear_down);
}
