/* Water displaced by a submerged sheet: the pins carry its weight minus the buoyancy, so with the
 * sheet's area A
 *
 *     thickness = (weight - vertical reaction of the pins) / (rho g A)
 *
 * The exact value is the sheet's own thickness: 0, or that of contact. It includes the water
 * displaced around the border. */
#include "interface.h"

#include <math.h>
#include <string.h>

static const double area_density = 0.1; /* kg/m^2 */
static const double gap = 0.1;          /* initial distance beyond half a spacing, in spacings */
enum { BESIDE = 4, ABOVE = 5 };         /* spacings of water around the sheet */

enum shape { LEVEL, TILTED, CURVED, SHAPES };
static const char *const names[SHAPES] = {"level", "tilted", "curved"};

struct pinned {
    enum shape shape;
    double d, width, edge; /* m */
    double radius;         /* m, of the cylinder that a curved sheet is part of */
    double middle[3];      /* m: of the sheet; of its top line if it is curved */
    int cells[3];          /* of the water */
};

static void place(const void *user, double s, double t, double x[3]) {
    const struct pinned *p = user;
    double u = (s - 0.5) * p->width, turn = u / p->radius;
    x[0] = p->middle[0], x[1] = p->middle[1], x[2] = p->middle[2] + (t - 0.5) * p->width;
    if (p->shape == LEVEL) x[0] += u;
    else if (p->shape == TILTED) x[0] += u * sqrt(0.5), x[1] += u * sqrt(0.5);
    else x[0] += p->radius * sin(turn), x[1] -= p->radius * (1.0 - cos(turn));
}

/* Keeps lattice points half a spacing from the sheet. Water above a level sheet starts a little
 * higher: where the sheet keeps a larger distance, that layer would be thrown up. */
static bool keep(const void *user, double at[3]) {
    const struct pinned *p = user;
    if (p->shape == LEVEL && at[1] > p->middle[1]) at[1] += 2.0 * gap * p->d;
    double x = at[0] - p->middle[0], y = at[1] - p->middle[1], u = x, w = y;
    if (p->shape == TILTED) u = (x + y) * sqrt(0.5), w = (y - x) * sqrt(0.5);
    if (p->shape == CURVED) {
        u = p->radius * atan2(x, y + p->radius);
        w = hypot(x, y + p->radius) - p->radius;
    }
    double half = 0.5 * p->width + 0.5 * p->d;
    return fabs(w) > 0.499 * p->d || fabs(u) > half || fabs(at[2] - p->middle[2]) > half;
}

static void layout(struct pinned *p) {
    double turn = 0.5 * p->width / p->radius, along = p->width, high = 0.0;
    if (p->shape == TILTED) along = high = p->width * sqrt(0.5);
    if (p->shape == CURVED)
        along = 2.0 * p->radius * sin(turn), high = p->radius * (1.0 - cos(turn));
    p->cells[0] = (int)ceil(along / p->d - 1e-9) + 2 * BESIDE;
    p->cells[1] = (int)ceil(high / p->d - 1e-9) + 2 * ABOVE;
    p->cells[2] = (int)ceil(p->width / p->d - 1e-9) + 2 * BESIDE;
    for (int k = 0; k < 3; k++) p->middle[k] = 0.5 * p->cells[k] * p->d;
    if (p->shape == CURVED) p->middle[1] += 0.5 * high;
    if (p->shape == LEVEL) p->middle[1] += gap * p->d;
}

static pdyn_sim *load_pinned(const struct job *job, const struct pinned *p, double contact) {
    char water[4096], sheet[4096];
    static struct scene s;
    int n = (int)fmax(1.0, floor(p->width / p->edge + 0.5));
    lattice_write(job_file(job, "displaced.ply", water), p->d, p->cells, keep, p);
    sheet_write(job_file(job, "displaced.obj", sheet), n, n, place, p);
    scene_start(&s, ordinary, contact);
    scene_water(&s, p->d, p->cells[1] * p->d, calming, "{'file': '%s'}", water);
    scene_sheet(&s, sheet, area_density);
    scene_put(&s, "'constraints': [{'type': 'triangle', 'stretching_stiffness': 1e4}, {'type': "
                  "'pin', 'vertices': {'all': true}}]}");
    scene_tank(&s, p->cells[0] * p->d, (p->cells[1] + 10) * p->d, p->cells[2] * p->d);
    return scene_load(job, &s);
}

static void run(const struct job *job, FILE *csv, const struct pinned *p, double seconds,
                double contact) {
    pdyn_sim *sim = load_pinned(job, p, contact);
    double weight = body_weight(sim, 1), area = body_area(sim, 1);
    struct sample thickness = {0};
    int unsolved = 0, steps = 0;
    while (pdyn_time(sim) < seconds) {
        pdyn_step_info info = take_step(sim);
        double value = (weight - info.pin_reaction[1]) / (density * g * area * p->d);
        fprintf(csv, "%s,%g,%g,%.6g,%.6g,%.4g\n", names[p->shape], 1e3 * p->d, p->edge / p->d,
                info.time, value, info.step_residual);
        steps++, unsolved += info.step_residual > job->tolerance;
        if (info.time > 0.6 * seconds) sample_add(&thickness, info.h, value);
    }
    printf("| %s | %g | %g | %d | %.3f | %.3f | %.3f | %.0f %% |\n", names[p->shape], 1e3 * p->d,
           p->edge / p->d, pdyn_get_body(sim, 0).count, sample_mean(&thickness),
           sample_deviation(&thickness), sample_mean(&thickness) - contact / p->d,
           100.0 * unsolved / steps);
    fflush(stdout);
    pdyn_free(sim);
}

/* SECONDS WIDTH CONTACT_MM SHAPE:MM:EDGE... */
void displaced(const struct job *job) {
    double seconds = job_number(job, 0, 1.0), width = job_number(job, 1, 16.0);
    double contact = 1e-3 * job_number(job, 2, 0.0);
    FILE *csv = open_csv(job->directory, "displaced");
    fprintf(csv, "shape,spacing_mm,edge_d,time_s,displaced_d,residual\n");
    printf("| sheet | spacing d, mm | edges, d | particles | displaced thickness, d | standard "
           "deviation, d | less contact's thickness, d | unsolved "
           "|\n|---|---|---|---|---|---|---|---|\n");
    for (int k = 3; k < job->count; k++) {
        char name[16];
        double mm, edge;
        struct pinned p = {.shape = SHAPES};
        if (sscanf(job->argument[k], "%15[a-z]:%lf:%lf", name, &mm, &edge) == 3)
            for (p.shape = 0; p.shape < SHAPES && strcmp(name, names[p.shape]);) p.shape++;
        if (p.shape == SHAPES) die("expected SHAPE:MM:EDGE, found %s", job->argument[k]);
        p.d = 1e-3 * mm, p.width = width * p.d, p.edge = edge * p.d, p.radius = 8.0 * p.d;
        layout(&p);
        run(job, csv, &p, seconds, contact);
    }
    fclose(csv);
}
