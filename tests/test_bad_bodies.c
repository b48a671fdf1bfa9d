/* Bad bodies, inlets, outlets and solids, each with its message. */
#include "scene_support.h"

#define INLETS(text)    BODY("{'particles': {'radius': 0.1,\n" text "}}")
#define DISC            "'disc': {'center': [0, 0, 0], 'radius': 1}, "
#define RECTANGLE(size) "'rectangle': {'center': [0, 0, 0], 'size': [" size "]}, "
#define LETTERS_13      "abcdefghijklm"
#define LETTERS_65      LETTERS_13 LETTERS_13 LETTERS_13 LETTERS_13 LETTERS_13

static const struct bad_scene bad_bodies[] = {
    /* bodies of particles */
    {BODY("7"),
     "scene.json:2:3: bodies[0]: expected an object {name, color, particles, surface, volume, "
     "rigid, constraints, velocity}, found 7"},
    {BODY("{'name': 'a'}"),
     "scene.json:2:3: bodies[0]: expected exactly one of \"particles\", \"surface\", "
     "\"volume\" and \"rigid\", found none"},
    {BODY("{'name': 'a', 'particles': {}, 'surface': {}}"),
     "scene.json:2:3: bodies[0]: expected exactly one of \"particles\", \"surface\", "
     "\"volume\" and \"rigid\", found more"},
    {BODY("{'partcles': {}}"),
     "scene.json:2:4: bodies[0]: unknown key \"partcles\"; did you mean \"particles\"?; "
     "known: name, color, particles, surface, volume, rigid, constraints, velocity"},
    {BODY("{'pin': {}}"),
     "scene.json:2:4: bodies[0]: unknown key \"pin\"; did you mean \"constraints\"?; known: name, "
     "color, particles, surface, volume, rigid, constraints, velocity"},
    {BODY("{'softbody': {}}"),
     "scene.json:2:4: bodies[0]: unknown key \"softbody\"; did you mean \"volume\"?; known: *"},
    {BODY("{'rigid': {'static': true}}"),
     "scene.json:2:14: bodies[0].rigid: unknown key \"static\"; did you mean \"solids\" of the "
     "scene?"},
    {BODY("{'particles': {'box': {}}}"),
     "scene.json:2:18: bodies[0].particles: unknown key \"box\"; did you mean \"fill\"?; known: "
     "fill, inlets, overlap, radius, rest_density, budget"},
    {BODY("{'color': '#12345', 'surface': {}}"),
     "scene.json:2:13: bodies[0].color: expected a color \"#rrggbb\" of six hexadecimal digits, "
     "found \"#12345\""},
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
     "scene.json:2:53: bodies[0].particles.fill[0].sphere: expected an object {center, radius}, "
     "found 1"},
    {BODY("{'particles': {'radius': 0.1, 'fill': [{'sphere': {'center': [0, 0, 0], 'radius': "
          "0.09}}]}}"),
     "scene.json:2:53: bodies[0].particles.fill[0].sphere: no particle of radius 0.1 m fits "
     "into the shape"},
    {BODY("{'particles': {'radius': 1e-6, 'fill': [{'sphere': {'center': [0, 0, 0], 'radius': "
          "1e6}}]}}"),
     "scene.json:2:54: bodies[0].particles.fill[0].sphere: more than 536870911 points: the "
     "particle radius is too small for the size of the scene*"},
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
     "scene.json:2:51: bodies[0].particles.fill[0].mesh: expected the name of a mesh file, .obj, "
     ".ply or .stl, found 3"},
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
    {BODY("{'name': 'b', 'rigid': {'box': {'minimum': [0, 0, 0], 'maximum': [1, 1, 1]}, 'mass': 1, "
          "'translate': [0, 2, 0], 'center_of_mass': [0, -0.1, 0]}}"),
     "scene.json:2:133: bodies[0].rigid.center_of_mass: expected a place inside of the body, found "
     "(0, 1.9, 0) m as placed, outside of its bounds"},
    {BODY("{'name': 'ball_000001', 'particles': {}}"),
     "scene.json:2:12: bodies[0].name: names like \"ball_000001\" are those of frames: expected "
     "another ending"},
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
    {BODY("{'fluid_friction': 1, 'surface': {}}"),
     "scene.json:2:4: bodies[0]: unknown key \"fluid_friction\"; did you mean "
     "\"surface.fluid_friction\"?"},
    {BODY("{'surface': {'grid': {}, 'mesh': 'a.obj', 'area_density': 1}}"),
     "scene.json:2:15: bodies[0].surface: expected exactly one of \"grid\" and \"mesh\", "
     "found both"},
    {BODY("{'surface': {'mesh': 'a.off', 'area_density': 1}}"),
     "scene.json:2:24: bodies[0].surface.mesh: a.off: expected a mesh file ending with "
     ".obj, .ply or .stl"},
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
     "scene, found 202500162 so far"},
    {INLETS("'inlets': [{" DISC "'direction': [1, 0, 0], 'speed': 1}], 'budget': 0"),
     "scene.json:3:105: bodies[0].particles.budget: expected a whole number from 1 to 134217728, "
     "found 0"},
    {INLETS("'fill': [{'box': " BOX "}], 'budget': 5"),
     "scene.json:3:66: bodies[0].particles: \"budget\" needs \"inlets\""},
    {BODY("{'constraints': [{'type': 'fluid'}],\n 'particles': {'radius': 0.1, 'inlets': [{" DISC
          "'direction': [1, 0, 0], 'speed': 1}], 'budget': 40000000}}"),
     "scene.json:2:29: bodies[0].constraints[0].type: \"fluid\" works on at most 33554432 "
     "particles, budgets of inlets included, found 40000000"},
};

static const struct bad_scene bad_solids[] = {
    /* solids */
    {TOP("'solids': {}"), "scene.json:2:12: solids: expected an array of solids, found an object"},
    {TOP("'solids': [{}]"),
     "scene.json:2:13: solids[0]: expected exactly one of \"box\", \"mesh\", \"sphere\", "
     "\"capsule\" and \"plane\", found none"},
    {TOP("'solids': [{'box': " BOX ", 'mesh': 'a.obj'}]"),
     "scene.json:2:13: solids[0]: expected exactly one of \"box\", \"mesh\", \"sphere\", "
     "\"capsule\" and \"plane\", found more"},
    {TOP("'solids': [{'color': [1, 0, 0], 'box': " BOX "}]"),
     "scene.json:2:23: solids[0].color: expected a color \"#rrggbb\" of six hexadecimal digits, "
     "found an array of 3"},
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
     "scene.json:2:67: solids[0]: \"scale\" needs a \"mesh\"; a \"motion\" with one key turns and "
     "moves "
     "other solids"},
    {TOP("'solids': [{'mesh': 'a.obj', 'open': []}]"),
     "scene.json:2:31: solids[0]: \"open\" needs a \"box\""},
    {TOP("'solids': [{'mesh': 'a.obj', 'scale': [1, 0, 1]}]"),
     "scene.json:2:40: solids[0].scale: expected a scale that is not 0, found an array of "
     "3"},
    {TOP("'solids': [{'mesh': 7}]"),
     "scene.json:2:22: solids[0].mesh: expected the name of a mesh file, .obj, .ply or .stl, "
     "found 7"},
    {TOP("'solids': [{'sphere': {'center': [0, 0, 0], 'radius': 0}}]"),
     "scene.json:2:56: solids[0].sphere.radius: expected a number from 1e-06 to 1000000 m, found "
     "0"},
    {TOP("'solids': [{'capsule': {'from': [0, 0, 0], 'radius': 1}}]"),
     "scene.json:2:25: solids[0].capsule.to: missing, expected an array of 3 numbers (m)"},
    {TOP("'solids': [{'plane': {'center': [0, 0, 0], 'normal': 'y', 'size': 1}}]"),
     "scene.json:2:55: solids[0].plane.normal: expected an array of 3 numbers, found \"y\""},
    {TOP("'solids': [{'plane': {'center': [0, 0, 0], 'normal': [0, 0, 0], 'size': 1}}]"),
     "scene.json:2:55: solids[0].plane.normal: expected a direction that is not 0, found an array "
     "of 3"},
    {TOP("'solids': [{'sphere': {'center': [0, 0, 0], 'radius': 1}, 'rotate': [0, 0, 0]}]"),
     "scene.json:2:60: solids[0]: \"rotate\" needs a \"mesh\"; a \"motion\" with one key turns and "
     "moves "
     "other solids"},
    /* outlets */
    {TOP("'outlets': {}"),
     "scene.json:2:13: outlets: expected an array of outlets, found an object"},
    {TOP("'outlets': [{'outside': true}]"),
     "scene.json:2:14: outlets[0].box: missing, expected an object {minimum, maximum}"},
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
    {TOP("'solids': [{'box': " BOX ", 'motion': [{'time': 0, 'pivot': [0, 0, 0]}]}]"),
     "scene.json:2:90: solids[0].motion[0]: unknown key \"pivot\"; it is one for all keys, beside "
     "\"motion\""},
    {TOP("'solids': [{'box': " BOX ", 'motion': [{'time': 1},\n {'time': 1}]}]"),
     "scene.json:3:11: solids[0].motion[1].time: expected a time after 1 s, found 1 s"},
    {TOP("'solids': [{'box': " BOX ", 'motion': [{'time': 1}], 'pivot': [0, 0]}]"),
     "scene.json:2:101: solids[0].pivot: expected an array of 3 numbers (m), found an array of 2"},
};

static void test_bad_bodies(void **state) {
    (void)state;
    assert_bad_scenes(bad_bodies, COUNT(bad_bodies));
}

static void test_bad_solids(void **state) {
    (void)state;
    assert_bad_scenes(bad_solids, COUNT(bad_solids));
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
int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bad_bodies),
        cmocka_unit_test(test_bad_solids),
        cmocka_unit_test(test_bad_meshes),
    };
    return cmocka_run_group_tests_name("bad_bodies", tests, scene_set_up, scene_tear_down);
}
