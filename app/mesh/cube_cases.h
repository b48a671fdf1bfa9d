/* The triangles of marching cubes (Lorensen and Cline 1987) for each set of corners inside of the
 * surface. Corner c of a cell has the offset c & 1, c >> 1 & 1, c >> 2 along x, y, z. */
#ifndef CUBE_CASES_H
#define CUBE_CASES_H

enum { CUBE_EDGES = 12, CUBE_TRIANGLES = 5 };

struct cube_case {
    int triangles;
    signed char edge[3 * CUBE_TRIANGLES]; /* the edges with the corners of the triangles */
};

/* Edge e runs along axis e / 4 from this corner. */
int cube_edge_corner(int edge);

/* Makes the table; bit c of the index: corner c is inside. Where two diagonal corners of a face are
 * inside, the surface separates them: both cells at a face cut it in the same way, so the mesh is
 * closed. No triangle has an edge across a face other than these cuts, so no edge has more than two
 * triangles. Triangles face away from the corners inside. */
void cube_cases_make(struct cube_case table[256]);

#endif
