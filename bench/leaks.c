/* Tightness of sheets: water hits a sheet, and a filled bag is shaken. After every step the
 * triangles above each particle are counted, independent of the library: an even number means above
 * the sheet, an odd number inside the bag. */
#include "coupling.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* ---- triangles above a particle -------------------------------------------------------------- */

enum { BINS = 256 };
static const double side = 1.2; /* m, of the sheet */

struct shadow { /* triangles projected to the horizontal plane, in bins of a square grid */
    const double *x;
    const int *triangle;
    double low[2], scale[2];
    int start[BINS * BINS + 2], *entry;
};

static int bin_of(const struct shadow *s, int axis, double at) {
    double bin = floor((at - s->low[axis]) * s->scale[axis]);
    return bin < 0.0 ? 0 : bin >= BINS ? BINS - 1 : (int)bin;
}

static const double *corner(const struct shadow *s, int triangle, int k) {
    return s->x + 3 * s->triangle[3 * triangle + k];
}

/* Adds a triangle to the counts, or to the entries, of the bins that it overlaps. */
static void enter(struct shadow *s, int t, bool count) {
    int from[2], to[2];
    for (int a = 0; a < 2; a++) {
        double p = corner(s, t, 0)[2 * a], q = corner(s, t, 1)[2 * a], r = corner(s, t, 2)[2 * a];
        from[a] = bin_of(s, a, fmin(p, fmin(q, r))), to[a] = bin_of(s, a, fmax(p, fmax(q, r)));
    }
    for (int i = from[0]; i <= to[0]; i++)
        for (int j = from[1]; j <= to[1]; j++) {
            int *place = &s->start[BINS * i + j + 1];
            if (count) place[1]++;
            else s->entry[(*place)++] = t;
        }
}

static void cast(struct shadow *s, const double *x, const pdyn_body_info *sheet) {
    double high[2] = {-INFINITY, -INFINITY};
    s->x = x + 3 * sheet->first, s->triangle = sheet->triangle;
    s->low[0] = s->low[1] = INFINITY;
    for (int i = 0; i < sheet->count; i++)
        for (int a = 0; a < 2; a++) {
            s->low[a] = fmin(s->low[a], s->x[3 * i + 2 * a]);
            high[a] = fmax(high[a], s->x[3 * i + 2 * a]);
        }
    for (int a = 0; a < 2; a++) s->scale[a] = BINS / (high[a] - s->low[a]);
    memset(s->start, 0, sizeof s->start);
    for (int t = 0; t < sheet->triangles; t++) enter(s, t, true);
    for (int b = 0; b <= BINS * BINS; b++) s->start[b + 1] += s->start[b];
    free(s->entry);
    s->entry = malloc(((size_t)s->start[BINS * BINS + 1] + 1) * sizeof *s->entry);
    if (!s->entry) die("out of memory");
    for (int t = 0; t < sheet->triangles; t++) enter(s, t, false);
}

static bool is_above(const struct shadow *s, int t, const double *p) {
    double w[3], whole = 0.0, height = 0.0;
    for (int k = 0; k < 3; k++) {
        const double *a = corner(s, t, (k + 1) % 3), *b = corner(s, t, (k + 2) % 3);
        w[k] = (a[0] - p[0]) * (b[2] - p[2]) - (b[0] - p[0]) * (a[2] - p[2]);
        whole += w[k], height += w[k] * corner(s, t, k)[1];
    }
    bool inside = (w[0] > 0.0) == (w[1] > 0.0) && (w[1] > 0.0) == (w[2] > 0.0);
    return inside && height / whole > p[1];
}

static int above(const struct shadow *s, const double *p) {
    int bin = BINS * bin_of(s, 0, p[0]) + bin_of(s, 1, p[2]), count = 0;
    for (int e = s->start[bin]; e < s->start[bin + 1]; e++) count += is_above(s, s->entry[e], p);
    return count;
}

/* ---- runs ------------------------------------------------------------------------------------ */

struct run {
    char name[16];
    int across, mesh; /* particles; vertices or cells of the sheet */
    double h, seconds;
    int outer, linear; /* maximum number of iterations */
    double speed;      /* of the water or the shaken bag, m/s */
};

struct watch {
    const pdyn_sim *sim;
    struct shadow shadow;
    bool odd;      /* the sheet is a bag */
    bool *spilled; /* particles beyond the border of the sheet in some iterate: they may be below it
                    */
};

static void see_spilled(void *user, const pdyn_iteration *iteration) {
    struct watch *w = user;
    const pdyn_body_info water = pdyn_get_body(w->sim, 0);
    for (int i = 0; i < water.count; i++) {
        const double *p = iteration->x + 3 * (water.first + i);
        w->spilled[i] |= !w->odd && fmax(fabs(p[0]), fabs(p[2])) > 0.5 * side;
    }
}

/* Number of particles on the wrong side. */
static int wrong_side(struct watch *watch) {
    struct shadow *s = &watch->shadow;
    const pdyn_state state = pdyn_get_state(watch->sim);
    const pdyn_body_info water = pdyn_get_body(watch->sim, 0);
    const pdyn_body_info sheet = pdyn_get_body(watch->sim, 1);
    int wrong = 0;
    cast(s, state.x, &sheet);
    for (int i = 0; i < water.count; i++) {
        const double *p = state.x + 3 * (water.first + i);
        /* off the edges, which symmetric positions would hit */
        double beside[3] = {p[0] + 1.1e-9, p[1], p[2] + 0.7e-9};
        wrong += !watch->spilled[i] && (above(s, beside) % 2 != 0) != watch->odd;
    }
    return wrong;
}

/* Runs the case, checks after every step and prints a row of the table. */
static void look(pdyn_sim *sim, FILE *csv, const struct run *run, bool odd) {
    static struct watch watch;
    const pdyn_body_info water = pdyn_get_body(sim, 0), sheet = pdyn_get_body(sim, 1);
    watch.sim = sim, watch.odd = odd;
    watch.spilled = calloc((size_t)water.count, sizeof *watch.spilled);
    if (!watch.spilled) die("out of memory");
    pdyn_observe(sim, see_spilled, &watch);
    long steps = 0, wrong = wrong_side(&watch), over = 0;
    double worst = 0.0, contact = 0.0;
    clock_t start = clock();
    for (; pdyn_time(sim) < run->seconds - 1e-9; steps++) {
        pdyn_step_info info = take_step(sim);
        worst = fmax(worst, info.step_residual), contact += info.ms_contact;
        wrong += wrong_side(&watch);
    }
    double spent = 1e3 * (double)(clock() - start) / CLOCKS_PER_SEC / (double)steps;
    for (int i = 0; i < water.count; i++) over += watch.spilled[i];
    printf("| %s | %g | %d | %d | %g | %d x %d | %ld | %ld | %ld | %.2g | %.0f |\n", run->name,
           run->speed, water.count, sheet.count, 1e3 * run->h, run->outer, run->linear, steps,
           wrong, over, worst, spent);
    fprintf(csv, "%s,%g,%d,%d,%g,%d,%d,%ld,%ld,%ld,%g,%g,%g\n", run->name, run->speed, water.count,
            sheet.count, run->h, run->outer, run->linear, steps, wrong, over, worst, spent,
            contact / (double)steps);
    fflush(stdout), fflush(csv);
    free(watch.spilled);
    pdyn_free(sim);
}

#define SOLVER                                                                                     \
    "'time_step': {'integrator': 'euler', 'fixed': %g}, 'contact': {'thickness': 0.002}, "         \
    "'solver': {'tolerance': 0.5, "                                                                \
    "'outer_iterations': %d, 'linear_iterations': %d}"

/* A cube of water of 0.3 m and n^3 particles falls on the middle of a sheet. */
static void impact(pdyn_context *context, FILE *csv, const struct run *run) {
    int n = run->across;
    double half = 0.15, d = 2.0 * half / n;
    look(load_text(
             context,
             "{'duration': 1000, " SOLVER ", 'bodies': [{'name': 'water', 'velocity': [0, %g, "
             "0], 'particles': {'radius': %.17g, 'fill': [{'box': {'minimum': [%g, 0.02, %g], "
             "'maximum': [%.17g, %.17g, %.17g]}}]}, 'constraints': [{'type': 'fluid', "
             "'stiffness': 1e5}]}, {'name': 'sheet', 'surface': {'grid': {'size': [%g, %g], "
             "'vertices': [%d, %d]}, 'area_density': 0.3}, 'constraints': [{'type': 'triangle', "
             "'stretching_stiffness': 2e4}, {'type': 'bending', 'bending_rigidity': 1e-4}, "
             "{'type': 'pin', 'vertices': {'border': true}}]}]}",
             run->h, run->outer, run->linear, -run->speed, 0.5 * d, -half, -half, half + 1e-9,
             0.02 + n * d + 1e-9, half + 1e-9, side, side, run->mesh, run->mesh),
         csv, run, false);
}

/* Surface of a ball: a cube whose faces are grids, projected to the sphere. */
static void write_ball(const char *path, double radius, int cells) {
    FILE *file = fopen(path, "w");
    if (!file) die("%s: cannot be written", path);
    int *number = calloc((size_t)(cells + 1) * (cells + 1) * (cells + 1), sizeof *number),
        count = 0;
    if (!number) die("out of memory");
    for (int face = 0; face < 6; face++)
        for (int i = 0; i <= cells; i++)
            for (int j = 0; j <= cells; j++) {
                int c[3];
                c[face % 3] = face < 3 ? 0 : cells;
                c[(face + 1) % 3] = i, c[(face + 2) % 3] = j;
                int *place = &number[(c[0] * (cells + 1) + c[1]) * (cells + 1) + c[2]];
                double p[3], length = 0.0;
                if (*place) continue;
                for (int a = 0; a < 3; a++) p[a] = tan(0.7853981634 * (2.0 * c[a] / cells - 1.0));
                for (int a = 0; a < 3; a++) length += p[a] * p[a];
                for (int a = 0; a < 3; a++) p[a] *= radius / sqrt(length);
                fprintf(file, "v %.17g %.17g %.17g\n", p[0], p[1], p[2]);
                *place = ++count;
            }
    for (int face = 0; face < 6; face++)
        for (int i = 0; i < cells; i++)
            for (int j = 0; j < cells; j++) {
                int v[4];
                for (int k = 0; k < 4; k++) {
                    int c[3];
                    c[face % 3] = face < 3 ? 0 : cells;
                    c[(face + 1) % 3] = i + (k == 1 || k == 2), c[(face + 2) % 3] = j + (k > 1);
                    v[k] = number[(c[0] * (cells + 1) + c[1]) * (cells + 1) + c[2]];
                }
                int b = face < 3 ? 3 : 1, d = face < 3 ? 1 : 3; /* all faces outward */
                fprintf(file, "f %d %d %d\nf %d %d %d\n", v[0], v[b], v[2], v[0], v[2], v[d]);
            }
    free(number);
    fclose(file);
}

/* A ball of 0.2 m, n particles across, held at its top and shaken 40 times by 0.1 m sideways, and
 * by half of that up and down. */
static void bag(pdyn_context *context, const char *directory, FILE *csv, const struct run *run) {
    char path[4096], way[4096] = "";
    double radius = 0.1, d = 2.0 * radius / run->across;
    snprintf(path, sizeof path, "%s/bag.obj", directory);
    write_ball(path, radius, run->mesh);
    for (int k = 0, used = 0; k <= 40; k++)
        used += snprintf(way + used, sizeof way - (size_t)used, "%s[%g, %g, %g, 0]", k ? ", " : "",
                         0.1 / run->speed * k,
                         k % 4 == 1   ? 0.1
                         : k % 4 == 3 ? -0.1
                                      : 0.0,
                         k % 2 ? 0.05 : 0.0);
    look(load_text(
             context,
             "{'duration': 1000, " SOLVER ", 'bodies': [{'name': 'water', 'particles': {'radius': "
             "%.17g, 'fill': [{'sphere': {'center': [0, 0, 0], 'radius': %.17g}}]}, "
             "'constraints': [{'type': 'fluid', 'stiffness': 1e4}]}, {'name': 'bag', 'surface': "
             "{'mesh': '%s', 'area_density': 0.3}, 'constraints': [{'type': 'triangle', "
             "'stretching_stiffness': 5e3}, {'type': 'bending', 'bending_rigidity': 1e-4}, "
             "{'type': 'pin', 'stiffness': 1e5, 'vertices': {'box': {'minimum': [-1, 0.085, -1], "
             "'maximum': [1, 1, "
             "1]}}, 'path': [%s]}]}]}",
             run->h, run->outer, run->linear, 0.5 * d, radius - 0.8 * d, path, way),
         csv, run, true);
}

void leaks(pdyn_context *context, const char *directory, int count, char **runs) {
    FILE *csv = open_csv(directory, "leaks");
    fprintf(csv,
            "run,speed,particles,vertices,h,outer,linear,steps,wrong,spilled,worst_residual,ms,"
            "ms_contact\n");
    printf("| run | m/s | particles | vertices | h, ms | iterations | steps | on the wrong side, "
           "all steps "
           "| around the border | largest residual | ms a step "
           "|\n|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (int r = 0; r < count; r++) {
        struct run run;
        if (sscanf(runs[r], "%15[a-z]:%d:%d:%lf:%lf:%dx%d:%lf", run.name, &run.across, &run.mesh,
                   &run.h, &run.seconds, &run.outer, &run.linear, &run.speed) != 8)
            die("expected impact|bag:ACROSS:MESH:MS:SECONDS:OUTERxLINEAR:SPEED, found %s", runs[r]);
        run.h *= 1e-3;
        if (!strcmp(run.name, "bag")) bag(context, directory, csv, &run);
        else impact(context, csv, &run);
    }
    fclose(csv);
}
