/* Areas of triangles, and volume integrals over the inside of a closed mesh. */
#include "mesh.h"

#include "projdyn/vec3.h"

#include <string.h>

double mesh_triangle_area(const struct mesh *mesh, int t) {
    const double *c[3];
    double n[3];
    mesh_corners(mesh, t, c);
    vec3_normal(n, c[0], c[1], c[2]);
    return 0.5 * vec3_length(n);
}

double mesh_area(const struct mesh *mesh) {
    double area = 0.0;
    for (int t = 0; t < mesh->triangles; t++) area += mesh_triangle_area(mesh, t);
    return area;
}

double mesh_volume(int triangles, const int *triangle, const double *x) {
    const double *origin = x + 3 * (size_t)triangle[0];
    double sum = 0.0;
    for (int t = 0; t < triangles; t++) {
        double side[3][3], normal[3];
        for (int k = 0; k < 3; k++)
            vec3_subtract(side[k], x + 3 * (size_t)triangle[3 * t + k], origin);
        vec3_cross(normal, side[1], side[2]);
        sum += vec3_dot(side[0], normal) / 6.0;
    }
    return sum;
}

/* A tetrahedron (0, a, b, c) of volume V has the first moments V/4 (a + b + c) and the second ones
 * V/20 ((a + b + c)(a + b + c)' + a a' + b b' + c c'). */
double mesh_moments(const struct mesh *mesh, double centre[3], double second[9]) {
    double volume = 0.0;
    memset(centre, 0, 3 * sizeof *centre), memset(second, 0, 9 * sizeof *second);
    for (int t = 0; t < mesh->triangles; t++) {
        const double *corner[3];
        double r[3][3], normal[3], sum[3] = {0};
        mesh_corners(mesh, t, corner);
        for (int k = 0; k < 3; k++) {
            vec3_subtract(r[k], corner[k], mesh->vertex);
            vec3_add(sum, 1.0, r[k]);
        }
        vec3_cross(normal, r[1], r[2]);
        double V = vec3_dot(r[0], normal) / 6.0;
        volume += V;
        vec3_add(centre, 0.25 * V, sum);
        for (int k = 0; k < 9; k++) {
            int i = k / 3, j = k % 3;
            second[k] +=
                V / 20.0 *
                (sum[i] * sum[j] + r[0][i] * r[0][j] + r[1][i] * r[1][j] + r[2][i] * r[2][j]);
        }
    }
    for (int a = 0; a < 3; a++) centre[a] /= volume;
    for (int k = 0; k < 9; k++) second[k] = second[k] / volume - centre[k / 3] * centre[k % 3];
    vec3_add(centre, 1.0, mesh->vertex);
    return volume;
}
