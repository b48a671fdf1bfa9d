/* Mesh files: valid files of every format, messages for invalid files, checks, allocation failures,
 * truncated and corrupted files. */
#include "mesh_support.h"
#include "support.h"

#include <locale.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static pdyn_context *context;
static struct counter counter;

static int set_up(void **state) {
    context = test_counting_context(1, &counter);
    return test_enter_directory(state);
}

static int tear_down(void **state) {
    pdyn_destroy(context);
    return test_leave_directory(state);
}

static pdyn_status read_bytes(const char *name, const char *data, size_t size, struct mesh *mesh) {
    test_write_file(name, data, size);
    pdyn_status status = mesh_read(context, name, mesh);
    test_remove_file(name);
    return status;
}

/* ---- good files ------------------------------------------------------------------------------ */

/* Every text describes the square (0,0,0) (1,0,0) (1,2,0) (0,2,0.5) as a fan of two triangles. */
struct sample {
    const char *name, *data;
    size_t size;
};
#define TEXT(name, text)                                                                           \
    { name, text, sizeof(text) - 1 }

#define PLY_VERTICES "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
#define PLY_FACES    "element face 1\nproperty list uchar int vertex_indices\n"
#define PLY_TAIL     PLY_VERTICES PLY_FACES "end_header\n"
#define ASCII        "ply\nformat ascii 1.0\n"
#define LITTLE       "ply\nformat binary_little_endian 1.0\n"
#define BIG          "ply\nformat binary_big_endian 1.0\n"
#define SQUARE_TEXT  "0 0 0\n1 0 0\n1 2 0\n0 2 0.5\n"

#define LITTLE_VERTICES                                                                            \
    "\0\0\0\0\0\0\0\0\0\0\0\0"                                                                     \
    "\0\0\x80\x3f\0\0\0\0\0\0\0\0"                                                                 \
    "\0\0\x80\x3f\0\0\0\x40\0\0\0\0"                                                               \
    "\0\0\0\0\0\0\0\x40\0\0\0\x3f"
#define LITTLE_FACE "\x04\0\0\0\0\x01\0\0\0\x02\0\0\0\x03\0\0\0"
#define BIG_VERTICES                                                                               \
    "\0\0\0\0\0\0\0\0\0\0\0\0"                                                                     \
    "\x3f\x80\0\0\0\0\0\0\0\0\0\0"                                                                 \
    "\x3f\x80\0\0\x40\0\0\0\0\0\0\0"                                                               \
    "\0\0\0\0\x40\0\0\0\x3f\0\0\0"
#define BIG_FACE "\x04\0\0\0\0\0\0\0\x01\0\0\0\x02\0\0\0\x03"

/* STL: the two triangles of the square. */
#define FACET(a, b, c)                                                                             \
    "facet normal 0 0 1\n outer loop\n  vertex " a "\n  vertex " b "\n  vertex " c                 \
    "\n endloop\nendfacet\n"
#define STL_0      "\0\0\0\0"
#define STL_1      "\0\0\x80\x3f"
#define STL_2      "\0\0\0\x40"
#define STL_HALF   "\0\0\0\x3f"
#define STL_MINUS  "\0\0\0\x80" /* -0 */
#define STL_HEAD   "solid, in spite of its first word a binary file: this head has 80 bytes, it has:"
#define STL_NORMAL "\0\0\xc0\x7f\0\0\0\0\0\0\0\0"
#define STL_O      STL_0 STL_0 STL_0
#define STL_X      STL_1 STL_0 STL_MINUS
#define STL_XY     STL_1 STL_2 STL_0
#define STL_FIRST  STL_NORMAL STL_O STL_X STL_XY "\0\0"
#define STL_SECOND STL_NORMAL STL_MINUS STL_0 STL_0 STL_XY STL_0 STL_2 STL_HALF "ab"

static const struct sample good[] = {
    TEXT("text.stl", "solid of two\n" FACET("0 0 0", "1 0 0", "1 2 0")
                         FACET("-0 0 0", "1 2 0", "0 2 0.5") "endsolid of two\n"),
    TEXT("solids.STL",
         "\r\nSOLID a\r\n FACET NORMAL 0 0 1\r\n OUTER LOOP\r\nVERTEX 0 0 0\r\nVERTEX 1.0 0 0\r\n"
         "VERTEX 1 2e0 0\r\nENDLOOP\r\nENDFACET\r\nENDSOLID\r\n\r\nsolid\n" FACET(
             "1 0 0", "1 0 0", "1 2 0") FACET("0 0 0", "1 2 0", "0 2 .5") "endsolid"),
    TEXT("binary.stl", STL_HEAD "\x02\0\0\0" STL_FIRST STL_SECOND),
    TEXT("plain.obj", "v 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 2 0.5\nf 1 2 3\nf 1 3 4\n"),
    TEXT("polygon.obj", "# a comment\n\nv 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 2 5e-1\nf 1 2 3 4"),
    TEXT("windows.OBJ", "v 0 0 0\r\nv 1 0 0\r\nv 1 2 0\r\n\r\nv 0 2 .5\r\nf 1 2 3 4\r\n"),
    TEXT("texture.obj", "vt 0 0\nv 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 2 .5\nf 1/1 2/1 3/1 4/1\n"),
    TEXT("normal.obj", "vn 0 0 1\nv 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 2 .5\nf 1//1 2//1 3//1 4//-1\n"),
    TEXT("both.obj",
         "mtllib a.mtl\no thing\ng a b\ns off\nusemtl red\nv 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 2 .5\n"
         "vt 0 0\nvn 0 0 1\nvp 0\nl 1 2\np 1\nf 1/1/1 2/1/1 3/1/1 4/-1/-1\n"),
    TEXT("backwards.obj", "v 0 0 0\nv 1 0 0\nv 1 2 0\nf -3 -2 -1\nv 0 2 .5\nf 1 -2 -1\n"),
    TEXT("colours.obj", "v 0 0 0 1\n v 1 0 0 0.5 0.5 0.5\nv 1 2 0 1 0 0 1 # red\n\tv 0 2 .5\n"
                        "f 1 2 3 4 # all\n"),
    TEXT("continued.obj", "# a \\\nv 0 0 0\nv 1 0 \\\n 0\nv 1 2 0\nv 0 2 .5\nusemtl \\\n red\n"
                          "f 1 2\\\n3 \\\r\n4"),
    TEXT("marked.obj", "\xef\xbb\xbfv 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 2 .5\nf 1 2 3 4\\\n"),
    TEXT("plain.ply", ASCII PLY_TAIL SQUARE_TEXT "4 0 1 2 3\n"),
    TEXT("windows.Ply", "ply\r\nformat ascii 1.0\r\ncomment by hand\r\nobj_info none\r\n"
                        "element vertex 4\r\nproperty float64 x\r\nproperty double y\r\n"
                        "property float32 z\r\nelement face 2\r\n"
                        "property list uint8 int32 vertex_index\r\nend_header\r\n"
                        "0 0 0\r\n1 0 0\r\n\r\n1 2 0\r\n0 2 0.5\r\n3 0 1 2\r\n3 0 2 3"),
    TEXT("order.ply",
         ASCII "element note 2\nproperty list int double values\nproperty char kind\n"
               "element vertex 4\nproperty uchar red\nproperty double z\nproperty list uchar "
               "short extra\nproperty float y\nproperty int x\nproperty float nx\n"
               "element face 1\nproperty list char float uv\n"
               "property list uint ushort vertex_indices\nproperty float quality\n"
               "element edge 1\nproperty int a\nproperty int b\nend_header\n"
               "3 1 nan 2.5 -128\n0 7\n255 0 2 -3 4 0 0 1\n0 0 0 0 1 1\n0 0 0 2 1 1\n"
               "0 .5 0 2 0 inf\n2 0.5 0.25 4 0 1 2 3 1e-3\n0 1\n\n"),
    TEXT("little.ply", LITTLE PLY_TAIL LITTLE_VERTICES LITTLE_FACE),
    TEXT("big.ply", BIG PLY_TAIL BIG_VERTICES BIG_FACE),
    TEXT("types.ply", BIG "element vertex 4\nproperty char x\nproperty uint16 y\n"
                          "property list uchar uint skipped\nproperty double z\n"
                          "element face 1\nproperty list short int16 vertex_index\n"
                          "element note 1\nproperty int32 a\nend_header\n"
                          "\0\0\0\0\0\0\0\0\0\0\0\0"
                          "\x01\0\0\x01\xde\xad\xbe\xef\0\0\0\0\0\0\0\0"
                          "\x01\0\x02\0\0\0\0\0\0\0\0\0"
                          "\0\0\x02\0\x3f\xe0\0\0\0\0\0\0"
                          "\0\x04\0\0\0\x01\0\x02\0\x03"
                          "\xff\xff\xff\xff\n"),
};
enum { GOOD = sizeof good / sizeof *good };

static void test_good_files(void **state) {
    (void)state;
    static const double square[12] = {0, 0, 0, 1, 0, 0, 1, 2, 0, 0, 2, 0.5};
    static const int fan[6] = {0, 1, 2, 0, 2, 3};
    size_t before = pdyn_bytes_in_use(context);
    for (int i = 0; i < GOOD; i++) {
        struct mesh mesh;
        if (read_bytes(good[i].name, good[i].data, good[i].size, &mesh) != PDYN_OK)
            fail_msg("%s", pdyn_last_error(context));
        assert_int_equal(mesh.vertices, 4);
        assert_int_equal(mesh.triangles, 2);
        assert_memory_equal(mesh.vertex, square, sizeof square);
        assert_memory_equal(mesh.triangle, fan, sizeof fan);
        assert_int_equal(pdyn_bytes_in_use(context) - before, sizeof square + sizeof fan);
        assert_int_equal(mesh_check(&mesh, "m"), PDYN_OK);
        assert_int_equal(mesh_check_cloth(context, &mesh, "m"), PDYN_OK);
        mesh_free(context, &mesh);
        assert_null(mesh.vertex);
        assert_int_equal(pdyn_bytes_in_use(context), before);
    }
}

static void test_signed_numbers(void **state) {
    (void)state;
    static const char data[] = LITTLE "element vertex 3\nproperty int8 x\nproperty short y\n"
                                      "property int z\nelement face 1\n"
                                      "property list uint uint vertex_indices\nend_header\n"
                                      "\xff\xfe\xff\xfd\xff\xff\xff"
                                      "\x80\xff\x7f\xff\xff\xff\x7f"
                                      "\x7f\0\x80\0\0\0\x80"
                                      "\x03\0\0\0\x02\0\0\0\x01\0\0\0\0\0\0\0";
    static const double expected[9] = {-1,         -2,  -3,     -128,         32767,
                                       2147483647, 127, -32768, -2147483648.0};
    struct mesh mesh;
    assert_int_equal(read_bytes("signed.ply", data, sizeof data - 1, &mesh), PDYN_OK);
    assert_memory_equal(mesh.vertex, expected, sizeof expected);
    assert_int_equal(mesh.triangle[0], 2);
    mesh_free(context, &mesh);
}

/* A locale with a decimal comma does not change what is read. */
static void test_locale(void **state) {
    (void)state;
    if (!setlocale(LC_ALL, "de_DE.UTF-8")) skip();
    struct mesh mesh;
    pdyn_status status = read_bytes(good[0].name, good[0].data, good[0].size, &mesh);
    setlocale(LC_ALL, "C");
    assert_int_equal(status, PDYN_OK);
    assert_true(mesh.vertex[11] == 0.5);
    mesh_free(context, &mesh);
}

/* ---- bad files ------------------------------------------------------------------------------- */

#define CORNERS   "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
#define FACE_LINE "3 0 1 2\n"
#define HEADER(vertices, faces)                                                                    \
    "element vertex " vertices "\nproperty float x\nproperty float y\nproperty float z\n"          \
    "element face " faces "\nproperty list char int vertex_indices\nend_header\n"
#define TRIANGLE_TEXT "0 0 0\n1 0 0\n0 1 0\n"

static const struct bad {
    struct sample file;
    const char *message; /* the message after the path */
} bad[] = {
    {TEXT("a.obj", ""), ": the file is empty"},
    {TEXT("a.ply", ""), ": the file is empty"},
    {TEXT("a.stl", "solid"), ":1: expected facet or endsolid, found the end of the file"},
    {TEXT("obj", "v 0 0 0"), ": expected a mesh file ending with .obj, .ply or .stl"},
    {TEXT("a.stl", "solid a\nendsolid a\n"), ": the mesh has no triangles"},
    {TEXT("a.stl", "solid a\n" FACET("0 0 0", "0 0 0", "1 0 0") "endsolid"),
     ": the mesh has no triangles"},
    {TEXT("a.stl", "solid a\n" FACET("0 0 0", "1 0 0", "nan 1 0") "endsolid"),
     ":6: vertex 2: expected a finite x of at most 1e+12 m, found nan"},
    {TEXT("a.stl", "solid a\n" FACET("0 0 0", "1 0 0", "1 2") "endsolid"),
     ":6: expected 3 coordinates after 'vertex', found the end of the line"},
    {TEXT("a.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop\n"),
     ":5: expected vertex, found 'endloop'"},
    {TEXT("a.stl", "solid a\n" FACET("0 0 0", "1 0 0", "1 2 0")),
     ":9: expected facet or endsolid, found the end of the file"},
    {TEXT("a.stl", "v 0 0 0\n"),
     ": byte 0: expected 'solid', or a binary STL of at least 84 bytes"},
    {TEXT("a.stl", STL_HEAD "\x02\0\0\0" STL_FIRST),
     ": byte 80: 2 triangles: expected a file of 184 bytes, found 134"},
    {TEXT("a.stl", STL_HEAD "\x01\0\0\0" STL_FIRST STL_SECOND),
     ": byte 80: 1 triangles: expected a file of 134 bytes, found 184"},
    {TEXT("a.stl", STL_HEAD "\xff\xff\xff\xff" STL_FIRST),
     ": byte 80: 4294967295 triangles: expected a file of 214748364834 bytes, found 134"},
    {TEXT("a.stl", STL_HEAD "\0\0\0\0"), ": the mesh has no triangles"},
    {TEXT("a.stl", STL_HEAD "\x01\0\0\0" STL_NORMAL STL_O STL_X "\0\0\xc0\x7f" STL_2 STL_0 "\0\0"),
     ": byte 96: vertex 2: expected a finite x of at most 1e+12 m, found nan"},
    {TEXT("a.obj", "# nothing\n"), ": the mesh has no triangles"},
    {TEXT("a.obj", CORNERS), ": the mesh has no triangles"},
    {TEXT("a.obj", "v 0 0 0\nv nan 0 0\n"),
     ":2: vertex 2: expected a finite x of at most 1e+12 m, found nan"},
    {TEXT("a.obj", "v 0 -inf 0\n"),
     ":1: vertex 1: expected a finite y of at most 1e+12 m, found -inf"},
    {TEXT("a.obj", "v 0 0 1e999\n"),
     ":1: vertex 1: expected a finite z of at most 1e+12 m, found inf"},
    {TEXT("a.obj", "v 0 0 1e13\n"),
     ":1: vertex 1: expected a finite z of at most 1e+12 m, found 1e+13"},
    {TEXT("a.obj", "v 0 0\n"), ":1: expected 3 coordinates after 'v', found the end of the line"},
    {TEXT("a.obj", "v 0 0"), ":1: expected 3 coordinates after 'v', found the end of the file"},
    {TEXT("a.obj", "v 0 1,5 0\n"), ":1: expected 3 coordinates after 'v', found '1,5'"},
    {TEXT("a.obj", "v 0 0 0 red\n"), ":1: expected a number, found 'red'"},
    {TEXT("a.obj", CORNERS "f 0 1 2\n"), ":4: the face uses vertex 0, but 3 are given so far "
                                         "(from 1 on, or backwards from -1)"},
    {TEXT("a.obj", CORNERS "f 1 2 4\nv 1 1 1\n"), ":4: the face uses vertex 4, but 3 are given"},
    {TEXT("a.obj", CORNERS "f 1 -4 3\n"), ":4: the face uses vertex -4, but 3 are given so far"},
    {TEXT("a.obj", CORNERS "f 1 2 99999999999999999999\n"),
     ":4: the face uses vertex 9223372036854775807, but 3 are given so far"},
    {TEXT("a.obj", CORNERS "f 1 -9223372036854775808 2\n"),
     ":4: the face uses vertex -9223372036854775808, but 3 are given so far"},
    {TEXT("a.obj", CORNERS "f 1 2\n"), ":4: expected a face of at least 3 vertices, found 2"},
    {TEXT("a.obj", CORNERS "\nf\n"), ":5: expected a face of at least 3 vertices, found 0"},
    {TEXT("a.obj", CORNERS "f 1 2 2\n"), ":4: the face uses vertex 2 twice"},
    {TEXT("a.obj", CORNERS "f 1 2 3 -2\n"), ":4: the face uses vertex 2 twice"},
    {TEXT("a.obj", "v 0 0 0\nv 1 -1 0\nv 0.2 0 0\nv 1 1 0\nf 2 3 4 1\n"),
     ":5: the polygon of 4 vertices is concave: expected convex polygons or triangles"},
    {TEXT("a.obj", CORNERS "f 1 2 3/x\n"),
     ":4: expected a face corner v, v/t, v//n or v/t/n, found '3/x'"},
    {TEXT("a.obj", CORNERS "f 1/ 2 3\n"), ", found '1/'"},
    {TEXT("a.obj", CORNERS "f 1// 2 3\n"), ", found '1//'"},
    {TEXT("a.obj", CORNERS "f 1/1/1/1 2 3\n"), ", found '1/1/1/1'"},
    {TEXT("a.obj", CORNERS "f 1.5 2 3\n"), ", found '1.5'"},
    {TEXT("a.obj", "v 0 \\\n0 0\nv 1 \\\r\n0 \\\n0\nv 1 \\\n2 0\nf 1 2 4\n"),
     ":8: the face uses vertex 4"},
    {TEXT("a.obj", CORNERS "f 1 2 3 \\"), ":4: expected a face corner"},
    {TEXT("a.obj", CORNERS "face 1 2 3\n"),
     ":4: expected v, f or another keyword of OBJ, found 'face'"},
    {TEXT("a.obj", "\x7f"
                   "ELF\x01\x02\0\0\0\n"),
     ":1: expected v, f or another keyword of OBJ, found '?ELF?\?'"},
    {TEXT("a.ply", "PLY\nformat ascii 1.0\n"), ":1: expected 'ply', found 'PLY'"},
    {TEXT("a.ply", "v 0 0 0\n"), ":1: expected 'ply', found 'v'"},
    {TEXT("a.ply", "ply"), ":1: expected format, element, property, comment or end_header, found "
                           "the end of the file"},
    {TEXT("a.ply", ASCII "elements vertex 3\n"), ":3: expected format, element, property, comment "
                                                 "or end_header, found 'elements'"},
    {TEXT("a.ply", "ply\nformat binary_middle_endian 1.0\n"),
     ":2: expected format ascii, binary_little_endian or binary_big_endian, found "
     "'binary_middle_endian'"},
    {TEXT("a.ply", "ply\nformat ascii 2.0\n"), ":2: expected version 1.0, found '2.0'"},
    {TEXT("a.ply", "ply\nformat ascii 1.0 beta\n"),
     ":2: expected the end of the line, found 'beta'"},
    {TEXT("a.ply", "ply\n" PLY_TAIL SQUARE_TEXT), "expected a format line in the header"},
    {TEXT("a.ply", ASCII "property float x\n"), ":3: expected an element before its properties"},
    {TEXT("a.ply", ASCII "element\n"), ":3: expected an element name, found the end of the line"},
    {TEXT("a.ply", ASCII "element vertex -3\n"), ":3: expected a number of elements, found '-3'"},
    {TEXT("a.ply", ASCII "element vertex 3.5\n"), ":3: expected a number of elements, found '3.5'"},
    {TEXT("a.ply", ASCII "element vertex 1e99\n"), ", found '1e99'"},
    {TEXT("a.ply", ASCII "element vertex nan\n"), ", found 'nan'"},
    {TEXT("a.ply", ASCII "element vertex 3\nproperty real x\n"),
     ":4: expected a type such as float or int, found 'real'"},
    {TEXT("a.ply", ASCII "element vertex 3\nproperty float\n"),
     ":4: expected a property name, found the end of the line"},
    {TEXT("a.ply", ASCII "element vertex 3\nproperty list float int x\n"),
     ":4: expected an integer type for the list's length, found 'float'"},
    {TEXT("a.ply", ASCII "element vertex 3\nproperty list uchar float x\n"),
     ":4: expected property 'x' to be a number, found a list"},
    {TEXT("a.ply", ASCII "element face 3\nproperty int vertex_index\n"),
     ":4: expected property 'vertex_index' to be a list"},
    {TEXT("a.ply", ASCII "element face 3\nproperty list uchar float vertex_index\n"),
     ":4: expected a list of integers, found float"},
    {TEXT("a.ply", ASCII "element vertex 3\nproperty float x\nproperty float x\n"),
     ":5: property 'x' is given twice"},
    {TEXT("a.ply", ASCII "element vertex 3\nproperty float y\nproperty float z\n" PLY_FACES
                         "end_header\n" TRIANGLE_TEXT FACE_LINE),
     "expected property 'x' of element 'vertex' in the header"},
    {TEXT("a.ply", ASCII PLY_VERTICES "end_header\n" SQUARE_TEXT),
     "expected property 'vertex_indices' of element 'face' in the header"},
    {TEXT("a.ply", ASCII PLY_VERTICES PLY_FACES "element empty 1\nend_header\n" SQUARE_TEXT),
     "element 'empty' has no properties"},
    {TEXT("a.ply", LITTLE HEADER("1000000000", "1") LITTLE_VERTICES LITTLE_FACE),
     ":10: 1000000000 of element 'vertex' take at least 12000000000 bytes, but 65 are left in the "
     "file"},
    {TEXT("a.ply", ASCII HEADER("1000000000000000", "1") TRIANGLE_TEXT FACE_LINE),
     ":10: 1000000000000000 of element 'vertex' take at least 6000000000000000 bytes, but 26 are "
     "left in the file"},
    {TEXT("a.ply", LITTLE HEADER("4", "66") LITTLE_VERTICES LITTLE_FACE),
     ":10: 66 of element 'face' take at least 66 bytes, but 65 are left in the file"},
    {TEXT("a.ply", ASCII HEADER("3", "1") "0 0 0\n1 0 0\n0 1\n3 0 1 2\n"),
     ":12: expected float for 'z' of vertex 2 (of 3), found the end of the line"},
    {TEXT("a.ply", ASCII HEADER("3", "1") "0 0 0\n1 0 0\n0 1 0 0\n3 0 1 2\n"),
     ":12: expected the end of the line, found '0'"},
    {TEXT("a.ply", ASCII HEADER("3", "1") "0 0 0\n1 0 x\n0 1 0\n3 0 1 2\n"),
     ":11: expected float for 'z' of vertex 1 (of 3), found 'x'"},
    {TEXT("a.ply", ASCII HEADER("3", "1") "0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n"),
     ":11: vertex 1: expected a finite z of at most 1e+12 m, found nan"},
    {TEXT("a.ply", ASCII HEADER("3", "1") TRIANGLE_TEXT "3 0 1"),
     ":13: expected int for 'vertex_indices' of face 0 (of 1), found the end of the file"},
    {TEXT("a.ply", ASCII HEADER("3", "2") TRIANGLE_TEXT FACE_LINE),
     ":14: expected char for 'vertex_indices' of face 1 (of 2), found the end of the file"},
    {TEXT("a.ply", ASCII HEADER("3", "1") TRIANGLE_TEXT "3 0 1 1.5\n"),
     ":13: expected int for 'vertex_indices' of face 0 (of 1), found '1.5'"},
    {TEXT("a.ply", ASCII HEADER("3", "1") TRIANGLE_TEXT "3 0 1 5000000000\n"),
     "found '5000000000'"},
    {TEXT("a.ply", ASCII HEADER("3", "1") TRIANGLE_TEXT "3 0 1 3\n"),
     ":13: the face uses vertex 3, but 3 are given so far (from 0 on)"},
    {TEXT("a.ply", ASCII HEADER("3", "1") TRIANGLE_TEXT "3 0 1 -1\n"),
     ":13: the face uses vertex -1, but 3 are given so far (from 0 on)"},
    {TEXT("a.ply", ASCII HEADER("3", "1") TRIANGLE_TEXT "3 0 1 1\n"),
     ":13: the face uses vertex 1 twice"},
    {TEXT("a.ply", ASCII HEADER("3", "1") TRIANGLE_TEXT "2 0 1\n"),
     ":13: expected a face of at least 3 vertices, found 2"},
    {TEXT("a.ply", ASCII HEADER("3", "1") TRIANGLE_TEXT "-3 0 1 2\n"),
     ":13: expected a list length of 0 or more, found -3"},
    {TEXT("a.ply", ASCII HEADER("3", "1") TRIANGLE_TEXT "300 0 1 2\n"),
     ":13: expected char for 'vertex_indices' of face 0 (of 1), found '300'"},
    {TEXT("a.ply", ASCII HEADER("3", "1") TRIANGLE_TEXT FACE_LINE FACE_LINE),
     ":14: expected the end of the file after the last element"},
    {TEXT("a.ply", ASCII HEADER("3", "0") TRIANGLE_TEXT), ": the mesh has no triangles"},
    {TEXT("a.ply", ASCII PLY_FACES PLY_VERTICES "end_header\n" FACE_LINE SQUARE_TEXT),
     ":10: the face uses vertex 0, but 0 are given so far (from 0 on)"},
    {TEXT("a.ply", LITTLE HEADER("4", "1") LITTLE_VERTICES "\xff\0\0\0\0"),
     ": byte 216: expected a list length of 0 or more, found -1"},
    {TEXT("a.ply", LITTLE HEADER("4", "1") LITTLE_VERTICES "\x7f\0\0\0\0\x01\0\0\0\x02\0\0\0"),
     ": byte 229: expected int for 'vertex_indices' of face 0 (of 1), found the end of the file"},
    {TEXT("a.ply", BIG HEADER("4", "1") LITTLE_VERTICES LITTLE_FACE), "the face uses vertex "},
    {TEXT("a.ply", BIG HEADER("1", "1") "\x7f\xc0\0\0\0\0\0\0\0\0\0\0\0"),
     ": byte 173: vertex 0: expected a finite x of at most 1e+12 m, found nan"},
    {TEXT("a.ply", BIG HEADER("4", "1") BIG_VERTICES BIG_FACE "\0"),
     ": byte 230: expected the end of the file after the last element"},
};
enum { BAD = sizeof bad / sizeof *bad };

static void test_bad_files(void **state) {
    (void)state;
    size_t before = pdyn_bytes_in_use(context);
    for (int i = 0; i < BAD; i++) {
        struct mesh mesh;
        const struct sample *file = &bad[i].file;
        pdyn_status status = read_bytes(file->name, file->data, file->size, &mesh);
        const char *error = pdyn_last_error(context), *path = file->name;
        if (status != PDYN_BAD_INPUT || strncmp(error, path, strlen(path)) ||
            !strstr(error, bad[i].message) ||
            (bad[i].message[0] == ':' && strstr(error, bad[i].message) != error + strlen(path)))
            fail_msg("case %d: status %d, expected '%s', found '%s'", i, status, bad[i].message,
                     error);
        assert_null(mesh.vertex);
        assert_null(mesh.triangle);
        assert_int_equal(pdyn_bytes_in_use(context), before);
    }
    assert_true(pdyn_peak_bytes(context) <
                100000); /* a count in the file's header is not trusted */
}

static void expect_unreadable(const char *name, const char *message) {
    struct mesh mesh;
    assert_int_equal(mesh_read(context, name, &mesh), PDYN_IO_FAILED);
    assert_error(name);
    assert_error(message);
    assert_null(mesh.vertex);
}

static void test_unreadable(void **state) {
    (void)state;
    expect_unreadable("missing.obj", ": cannot open the file: No such file or directory");
    assert_int_equal(mkdir("folder.ply", 0700), 0);
    expect_unreadable("folder.ply", ": expected a regular file");
    assert_int_equal(rmdir("folder.ply"), 0);
    assert_int_equal(mkfifo("pipe.obj", 0600), 0);
    expect_unreadable("pipe.obj", ": expected a regular file");
    test_remove_file("pipe.obj");
}

/* ---- checks ---------------------------------------------------------------------------------- */

static void expect_rejected(pdyn_status status, const char *message) {
    assert_int_equal(status, PDYN_BAD_INPUT);
    assert_string_equal(pdyn_last_error(context), message);
}

static void test_check(void **state) {
    (void)state;
    double vertex[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
    int triangle[6] = {0, 1, 2, 2, 1, 3};
    struct mesh mesh = {4, vertex, 2, triangle};
    assert_int_equal(mesh_check(&mesh, "sheet"), PDYN_OK);
    triangle[5] = 4;
    expect_rejected(mesh_check(&mesh, "sheet"), "sheet: triangle 1 uses vertex 4, expected 0 to 3");
    triangle[5] = -1;
    expect_rejected(mesh_check(&mesh, "sheet"),
                    "sheet: triangle 1 uses vertex -1, expected 0 to 3");
    triangle[5] = 2;
    expect_rejected(mesh_check(&mesh, "sheet"), "sheet: triangle 1 uses vertex 2 twice");
    triangle[5] = 3;
    vertex[7] = (double)INFINITY;
    expect_rejected(mesh_check(&mesh, "sheet"),
                    "sheet: vertex 2: expected a finite y of at most 1e+12 m, found inf");
    mesh.triangles = 0;
    expect_rejected(mesh_check(&mesh, "sheet"), "sheet: the mesh has no triangles");
}

/* Meshes that cloth cannot use are read: solids can use them. */
static void test_check_cloth(void **state) {
    (void)state;
    static const struct {
        const char *data, *message;
    } cases[] = {
        {CORNERS "v 1 1 1\nv 2 2 2\nf 1 2 3\n", "sheet: vertex 3 is used by no triangle"},
        {CORNERS "v 2 0 0\nf 1 2 3\nf 1 2 4\n", "sheet: triangle 1 (vertices 0, 1, 3) has no area"},
        {"v 0 0 0\nv 1 0 0\nv .5 1e-13 0\nf 1 2 3\n",
         "sheet: triangle 0 (vertices 0, 1, 2) has no area"},
        {CORNERS "v 0 1 0\nf 1 2 3\nf 1 3 4\n", "sheet: triangle 1 (vertices 0, 2, 3) has no area"},
        {"v 0 0 0\nv 1e-200 0 0\nv 0 1e-200 0\nf 1 2 3\n",
         "sheet: triangle 0 (vertices 0, 1, 2) has no area"},
        {CORNERS "v 0 0 1\nv 0 0 -1\nf 1 2 3\nf 2 1 4\nf 1 2 5\n",
         "sheet: the edge between vertices 0 and 1, at (0, 0, 0) m, has 3 triangles, expected at "
         "most 2"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct mesh mesh;
        assert_int_equal(read_bytes("a.obj", cases[i].data, strlen(cases[i].data), &mesh), PDYN_OK);
        size_t before = pdyn_bytes_in_use(context);
        expect_rejected(mesh_check_cloth(context, &mesh, "sheet"), cases[i].message);
        assert_int_equal(pdyn_bytes_in_use(context), before);
        mesh_free(context, &mesh);
    }
}

/* ---- no memory ------------------------------------------------------------------------------- */

static pdyn_status read_and_build(const void *path) {
    struct mesh mesh;
    struct topology topology;
    pdyn_status status = mesh_read(context, path, &mesh);
    if (status != PDYN_OK) return status;
    status = mesh_check_cloth(context, &mesh, path);
    if (status == PDYN_OK) status = topology_build(context, &mesh, &topology);
    if (status == PDYN_OK) topology_free(context, &topology);
    mesh_free(context, &mesh);
    return status;
}

static pdyn_status make_grid(const void *unused) {
    (void)unused;
    struct mesh mesh;
    pdyn_status status = mesh_grid(context, (double[]){1, 1}, (int[]){3, 3}, 0.0, &mesh);
    mesh_free(context, &mesh);
    return status;
}

static void test_no_memory(void **state) {
    (void)state;
    for (int i = 0; i < GOOD; i++) {
        test_write_file(good[i].name, good[i].data, good[i].size);
        long needed = test_failing_allocations(context, &counter, read_and_build, good[i].name);
        assert_true(needed > 15 && needed < 1000);
        test_remove_file(good[i].name);
    }
    assert_int_equal(test_failing_allocations(context, &counter, make_grid, NULL), 2);
}

/* ---- damaged files --------------------------------------------------------------------------- */

/* Any file is either refused with a message or gives a mesh that passes the checks. */
static void expect_sane(const void *what, const char *data, size_t size) {
    const struct sample *sample = what;
    size_t before = pdyn_bytes_in_use(context);
    struct mesh mesh;
    pdyn_status status = read_bytes(sample->name, data, size, &mesh);
    if (status == PDYN_OK) {
        assert_int_equal(mesh_check(&mesh, sample->name), PDYN_OK);
        struct topology topology;
        if (mesh_check_cloth(context, &mesh, sample->name) == PDYN_OK) {
            assert_int_equal(topology_build(context, &mesh, &topology), PDYN_OK);
            check_structure(&mesh, &topology);
            topology_free(context, &topology);
        }
        mesh_free(context, &mesh);
    } else {
        assert_int_equal(status, PDYN_BAD_INPUT);
        assert_error(sample->name);
    }
    assert_int_equal(pdyn_bytes_in_use(context), before);
}

static void test_damaged(void **state) {
    (void)state;
    for (int i = 0; i < GOOD; i++)
        test_damaged_copies(good[i].data, good[i].size, expect_sane, &good[i]);
}

/* ---- pieces ---------------------------------------------------------------------------------- */

#define CUBE(r)                                                                                    \
    "v -" r " -" r " -" r "\nv " r " -" r " -" r "\nv " r " " r " -" r "\nv -" r " " r " -" r "\n" \
    "v -" r " -" r " " r "\nv " r " -" r " " r "\nv " r " " r " " r "\nv -" r " " r " " r "\n"
#define OUTWARDS "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 4 8 7 3\nf 1 5 8 4\nf 2 3 7 6\n"

/* A hollow cube stays as it is, although a side of the hollow has a triangle without area. */
static void test_hollow(void **state) {
    (void)state;
    struct mesh mesh;
    struct mesh_turned turned;
    const char *text = CUBE("2") CUBE("1") "v 0 -1 -1\n" OUTWARDS
                                           "f 9 17 10 11 12\nf 16 15 14 13\nf 13 14 10 17 9\n"
                                           "f 11 15 16 12\nf 12 16 13 9\nf 14 15 11 10\n";
    assert_int_equal(read_bytes("hollow.obj", text, strlen(text), &mesh), PDYN_OK);
    assert_int_equal(mesh_check_closed(context, &mesh, "hollow"), PDYN_OK);
    assert_int_equal(mesh_orient_pieces(context, &mesh, &turned), PDYN_OK);
    assert_true(turned.triangles == 0 && turned.pieces == 0 && turned.crossing == 0);
    assert_true(fabs(mesh_volume(mesh.triangles, mesh.triangle, mesh.vertex) - 56.0) < 1e-9);
    mesh_free(context, &mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_good_files),  cmocka_unit_test(test_signed_numbers),
        cmocka_unit_test(test_locale),      cmocka_unit_test(test_bad_files),
        cmocka_unit_test(test_unreadable),  cmocka_unit_test(test_check),
        cmocka_unit_test(test_check_cloth), cmocka_unit_test(test_no_memory),
        cmocka_unit_test(test_damaged),     cmocka_unit_test(test_hollow),
    };
    return cmocka_run_group_tests_name("mesh", tests, set_up, tear_down);
}
