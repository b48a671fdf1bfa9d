#include "outer_edges.h"

#include <stdlib.h>
#include <string.h>

enum { FACE_KEYS = 3, EDGE_KEYS = 2 };

static int compare_lists(const int64_t *p, const int64_t *q, int keys) {
    int order = 0;
    for (int k = 0; k < keys && !order; k++) order = keys_compare(p + k, q + k);
    return order;
}

static int compare_faces(const void *a, const void *b) { return compare_lists(a, b, FACE_KEYS); }
static int compare_edges(const void *a, const void *b) { return compare_lists(a, b, EDGE_KEYS); }

/* Number of lists equal to the first, of those from `first` to `end`, which are sorted. */
static size_t count_equal(const int64_t *list, size_t first, size_t end, int keys) {
    size_t next = first + 1;
    while (next < end &&
           !compare_lists(list + (size_t)keys * first, list + (size_t)keys * next, keys))
        next++;
    return next - first;
}

/* Writes the faces of all tetrahedra to `face`, sorted; keeps those of a single one, and returns
 * their number. */
static size_t find_outer_faces(size_t tets, const int64_t *corner, int64_t *face) {
    size_t kept = 0, faces = 4 * tets;
    for (size_t f = 0; f < faces; f++) {
        int64_t *to = face + FACE_KEYS * f;
        for (size_t c = 0, k = 0; c < 4; c++)
            if (c != f % 4) to[k++] = corner[f / 4 * 4 + c];
        qsort(to, FACE_KEYS, sizeof *to, keys_compare);
    }
    qsort(face, faces, FACE_KEYS * sizeof *face, compare_faces);
    for (size_t f = 0, equal; f < faces; f += equal) {
        equal = count_equal(face, f, faces, FACE_KEYS);
        if (equal == 1)
            memmove(face + FACE_KEYS * kept++, face + FACE_KEYS * f, FACE_KEYS * sizeof *face);
    }
    return kept;
}

/* Writes the edges of the faces to `edge`, sorted. */
static void find_edges(size_t faces, const int64_t *face, int64_t *edge) {
    static const int ends[3][EDGE_KEYS] = {{0, 1}, {0, 2}, {1, 2}};
    for (size_t e = 0; e < 3 * faces; e++)
        for (int k = 0; k < EDGE_KEYS; k++)
            edge[EDGE_KEYS * e + (size_t)k] = face[e / 3 * FACE_KEYS + (size_t)ends[e % 3][k]];
    qsort(edge, 3 * faces, EDGE_KEYS * sizeof *edge, compare_edges);
}

pdyn_status outer_edges_visit(pdyn_context *context, size_t tets, const int64_t *corner,
                              void (*visit)(void *user, int64_t key), void *user) {
    size_t size = 4 * FACE_KEYS * tets;
    int64_t *face = NEW_ARRAY(context, size, int64_t);
    if (!face) return PDYN_NO_MEMORY;
    size_t faces = find_outer_faces(tets, corner, face), edges = 3 * faces;
    int64_t *edge = NEW_ARRAY(context, EDGE_KEYS * edges, int64_t);
    if (edge) find_edges(faces, face, edge);
    for (size_t e = 0, equal; edge && e < edges; e += equal) {
        equal = count_equal(edge, e, edges, EDGE_KEYS);
        for (size_t k = 0; equal > 2 && k < EDGE_KEYS; k++) visit(user, edge[EDGE_KEYS * e + k]);
    }
    pdyn_status status = edge ? PDYN_OK : PDYN_NO_MEMORY;
    FREE_ARRAY(context, edge, EDGE_KEYS * edges);
    FREE_ARRAY(context, face, size);
    return status;
}
