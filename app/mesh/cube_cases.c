/* The table of marching cubes, traced instead of listed: on every face of a cell the surface is a
 * set of cuts from edge to edge; the cuts of the six faces join to loops, and a loop is divided
 * into triangles. */
#include "cube_cases.h"

#include <string.h>

int cube_edge_corner(int edge) {
    int axis = edge / 4, u = (axis + 1) % 3, v = (axis + 2) % 3;
    return (edge & 1) << u | (edge >> 1 & 1) << v;
}

/* The edge between two corners that differ in one axis. */
static int edge_between(int a, int b) {
    int axis = (a ^ b) == 1 ? 0 : (a ^ b) == 2 ? 1 : 2, low = a & b;
    return 4 * axis + (low >> (axis + 1) % 3 & 1) + 2 * (low >> (axis + 2) % 3 & 1);
}

/* The corners of a face, counter-clockwise seen from outside. face: 2 axis + side. */
static void face_corners(int face, int corner[4]) {
    int axis = face / 2, side = face & 1, u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
    int base = side << axis;
    const int round[4] = {base, base + u, base + u + v, base + v};
    for (int k = 0; k < 4; k++) corner[k] = round[side ? k : 3 - k];
}

/* Cuts a face: next[e] is the edge to which the cut from edge e leads. Each run of corners inside
 * has its own cut, from the edge where the walk around the face enters it to the one where it
 * leaves. */
static void cut_face(int inside, int face, int next[CUBE_EDGES]) {
    int corner[4];
    face_corners(face, corner);
    for (int k = 0; k < 4; k++) {
        if (!(inside >> corner[k] & 1) || inside >> corner[(k + 3) % 4] & 1) continue;
        int end = k;
        while (inside >> corner[(end + 1) % 4] & 1) end++;
        int enters = edge_between(corner[(k + 3) % 4], corner[k]);
        next[enters] = edge_between(corner[end % 4], corner[(end + 1) % 4]);
    }
}

/* Whether two edges lie on one face: they agree in a coordinate along which neither runs. */
static int share_face(int e, int f) {
    for (int a = 0; a < 3; a++)
        if (a != e / 4 && a != f / 4 &&
            (cube_edge_corner(e) >> a & 1) == (cube_edge_corner(f) >> a & 1))
            return 1;
    return 0;
}

/* Divides a loop of `count` edges by cutting off corners whose new edge lies on no face. */
static void divide_loop(int *loop, int count, struct cube_case *out) {
    while (count > 2) {
        int k = 0;
        while (count > 3 && k < count - 1 &&
               share_face(loop[(k + count - 1) % count], loop[(k + 1) % count]))
            k++;
        signed char *corner = out->edge + 3 * out->triangles++;
        for (int c = 0; c < 3; c++) corner[c] = (signed char)loop[(k + count - 1 + c) % count];
        memmove(loop + k, loop + k + 1, (size_t)(count - k - 1) * sizeof *loop);
        count--;
    }
}

static void make_case(int inside, struct cube_case *out) {
    int next[CUBE_EDGES];
    out->triangles = 0;
    memset(next, -1, sizeof next);
    for (int face = 0; inside != 255 && face < 6; face++) cut_face(inside, face, next);
    for (int e = 0; e < CUBE_EDGES; e++) {
        int loop[CUBE_EDGES], count = 0;
        for (int at = e; next[at] >= 0;) {
            loop[count++] = at;
            int to = next[at];
            next[at] = -1;
            at = to;
        }
        divide_loop(loop, count, out);
    }
}

void cube_cases_make(struct cube_case table[256]) {
    for (int inside = 0; inside < 256; inside++) make_case(inside, &table[inside]);
}
