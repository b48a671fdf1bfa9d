/* Soft solids in a state: submerged fraction and rotation; a tetrahedral mesh of a ball. */
#include "interface.h"

#include "projdyn/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Signed volume between a triangle and y = 0: the triangle's contribution to its surface's volume.
 */
static double below(const double *a, const double *b, const double *c) {
    double area = 0.5 * ((b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2]));
    return area * (a[1] + b[1] + c[1]) / 3.0;
}

double body_volume(const pdyn_sim *sim, int body) {
    const pdyn_state s = pdyn_get_state(sim);
    const pdyn_body_info b = pdyn_get_body(sim, body);
    double sum = 0.0;
    for (int t = 0; t < b.triangles; t++) {
        const int *corner = b.triangle + 3 * t;
        sum += below(s.x + 3 * (b.first + corner[0]), s.x + 3 * (b.first + corner[1]),
                     s.x + 3 * (b.first + corner[2]));
    }
    return fabs(sum);
}

/* Clips a triangle to y < 0: at most four corners. */
static int clip(double corner[3][3], double out[4][3]) {
    int n = 0;
    for (int k = 0; k < 3; k++) {
        const double *a = corner[k], *b = corner[(k + 1) % 3];
        if (a[1] <= 0.0) memcpy(out[n++], a, sizeof *out);
        if ((a[1] <= 0.0) == (b[1] <= 0.0)) continue;
        double share = a[1] / (a[1] - b[1]);
        for (int m = 0; m < 3; m++) out[n][m] = a[m] + share * (b[m] - a[m]);
        n++;
    }
    return n;
}

double body_submerged(const pdyn_sim *sim, int body, double level) {
    const pdyn_state s = pdyn_get_state(sim);
    const pdyn_body_info b = pdyn_get_body(sim, body);
    double under = 0.0, all = 0.0;
    for (int t = 0; t < b.triangles; t++) {
        double corner[3][3], part[4][3];
        for (int k = 0; k < 3; k++) {
            memcpy(corner[k], s.x + 3 * (b.first + b.triangle[3 * t + k]), sizeof *corner);
            corner[k][1] -= level;
        }
        all += below(corner[0], corner[1], corner[2]);
        int n = clip(corner, part);
        for (int k = 2; k < n; k++) under += below(part[0], part[k - 1], part[k]);
    }
    return under / all;
}

void body_ends(const pdyn_sim *sim, const struct ends *ends, double low[3], double high[3]) {
    const pdyn_state s = pdyn_get_state(sim);
    for (int k = 0; k < 3; k++) low[k] = high[k] = 0.0;
    for (int i = 0; i < ends->lows; i++) vec3_add(low, 1.0 / ends->lows, s.x + 3 * ends->low[i]);
    for (int i = 0; i < ends->highs; i++)
        vec3_add(high, 1.0 / ends->highs, s.x + 3 * ends->high[i]);
}

void ends_find(struct ends *ends, const pdyn_sim *sim, int body) {
    const pdyn_state s = pdyn_get_state(sim);
    const pdyn_body_info b = pdyn_get_body(sim, body);
    if (b.count < 1) die("body %d: expected at least one point", body);
    double low = INFINITY, high = -INFINITY;
    for (int i = 0; i < b.count; i++) {
        low = fmin(low, s.x[3 * (b.first + i) + 1]);
        high = fmax(high, s.x[3 * (b.first + i) + 1]);
    }
    ends->lows = ends->highs = 0;
    ends->low = calloc((size_t)b.count, sizeof *ends->low);
    ends->high = calloc((size_t)b.count, sizeof *ends->high);
    if (!ends->low || !ends->high) die("out of memory");
    for (int i = b.first; i < b.first + b.count; i++) {
        if (s.x[3 * i + 1] < low + 1e-6 * (high - low)) ends->low[ends->lows++] = i;
        if (s.x[3 * i + 1] > high - 1e-6 * (high - low)) ends->high[ends->highs++] = i;
    }
}

void ends_free(struct ends *ends) { free(ends->low), free(ends->high); }

/* ---- a ball ---------------------------------------------------------------------------------- */

static const int kuhn[6][4] = {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7},
                               {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}};

static void write_nodes(FILE *file, int n) {
    int m = n + 1;
    fprintf(file, "%d 3 0 0\n", m * m * m);
    for (int i = 0; i < m * m * m; i++) {
        double x[3] = {2.0 * (i % m) / n - 1.0, 2.0 * (i / m % m) / n - 1.0,
                       2.0 * (i / (m * m)) / n - 1.0};
        double shell = fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2]))), length = vec3_length(x);
        double scale = length > 0.0 ? shell / length : 0.0;
        fprintf(file, "%d %.9f %.9f %.9f\n", i + 1, scale * x[0], scale * x[1], scale * x[2]);
    }
    fclose(file);
}

/* The tetrahedra of a cell share the diagonal that points outward in every octant. */
static void write_cell(FILE *file, int n, const int cell[3], int *count) {
    int m = n + 1;
    for (int t = 0; t < 6; t++) {
        fprintf(file, "%d", ++*count);
        for (int k = 0; k < 4; k++) {
            int corner[3];
            for (int a = 0; a < 3; a++) {
                int bit = kuhn[t][k] >> a & 1;
                corner[a] = cell[a] + (cell[a] < n / 2 ? 1 - bit : bit);
            }
            fprintf(file, " %d", 1 + corner[0] + m * corner[1] + m * m * corner[2]);
        }
        fprintf(file, "\n");
    }
}

void ball_write(const struct job *job, const char *name, int n, char *path) {
    char file_name[64], elements[4096];
    int count = 0;
    snprintf(file_name, sizeof file_name, "%s.ele", name);
    FILE *file = job_file(job, file_name, elements);
    fprintf(file, "%d 4 0\n", 6 * n * n * n);
    for (int i = 0; i < n * n * n; i++)
        write_cell(file, n, (const int[3]){i % n, i / n % n, i / (n * n)}, &count);
    fclose(file);
    snprintf(file_name, sizeof file_name, "%s.node", name);
    write_nodes(job_file(job, file_name, path), n);
}
