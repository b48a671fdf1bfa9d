/* Scenes of the interface measurements: JSON text and mesh files. */
#include "interface.h"

#include "projdyn/vec3.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>

static void put(struct scene *s, const char *format, va_list args) {
    size_t left = sizeof s->text - s->length;
    int length = vsnprintf(s->text + s->length, left, format, args);
    if (length < 0 || (size_t)length >= left) die("too long a scene");
    for (char *c = s->text + s->length; *c; c++)
        if (*c == '\'') *c = '"';
    s->length += (size_t)length;
}

void scene_put(struct scene *s, const char *format, ...) {
    va_list args;
    va_start(args, format);
    put(s, format, args);
    va_end(args);
}

void scene_start(struct scene *s, const char *time_step, double contact) {
    s->length = 0;
    scene_put(s, "{'duration': 1000, 'frame_interval': 1000, 'time_step': {%s}, ", time_step);
    if (contact > 0.0) scene_put(s, "'contact': {'thickness': %.17g}, ", contact);
}

void scene_water(struct scene *s, double d, double depth, double viscosity, const char *fill, ...) {
    va_list args;
    scene_put(s,
              "'bodies': [{'name': 'water', 'constraints': [{'type': 'fluid', 'stiffness': %.17g, "
              "'viscosity': "
              "%.17g}],"
              " 'particles': {'radius': %.17g, 'fill': [",
              0.45 * density * g * depth * d / 1e-3, viscosity, 0.5 * d);
    va_start(args, fill);
    put(s, fill, args);
    va_end(args);
    scene_put(s, "]}}");
}

void scene_sheet(struct scene *s, const char *mesh, double area_density) {
    scene_permeable(s, mesh, area_density, 0.0);
}

void scene_permeable(struct scene *s, const char *mesh, double area_density, double permeability) {
    scene_put(s,
              ", {'name': 'sheet', 'surface': {'mesh': '%s', 'area_density': %.17g, "
              "'permeability': %.17g}, ",
              mesh, area_density, permeability);
}

void scene_tank(struct scene *s, double x, double y, double z) {
    scene_put(s,
              "], 'solids': [{'name': 'tank', 'box': {'minimum': [0, 0, 0], 'maximum': [%.17g, "
              "%.17g, %.17g]}, 'open': ['+y']}], 'outlets': [{'box': {'minimum': [-0.05, -0.05, "
              "-0.05], 'maximum': [%.17g, %.17g, %.17g]}, 'outside': true}]}",
              x, y, z, x + 0.05, y + 1.0, z + 0.05);
}

pdyn_sim *scene_load(const struct job *job, const struct scene *s) {
    pdyn_sim *sim;
    if (pdyn_load_text(job->context, s->text, "interface", job->set, job->sets, &sim) != PDYN_OK)
        die("%s", pdyn_last_error(job->context));
    return sim;
}

FILE *job_file(const struct job *job, const char *name, char *path) {
    snprintf(path, 4096, "%s/%s", job->directory, name);
    FILE *file = fopen(path, "w");
    if (!file) die("%s: cannot be written", path);
    return file;
}

/* Calls `keep` for every lattice point; writes the accepted ones unless `file` is NULL. */
static int visit(FILE *file, double d, const int cells[3],
                 bool (*keep)(const void *user, double x[3]), const void *user) {
    int count = 0;
    for (int k = 0; k < cells[0] * cells[1] * cells[2]; k++) {
        int i = k % cells[0], j = k / cells[0] % cells[1], l = k / cells[0] / cells[1];
        double x[3] = {(i + 0.5) * d, (j + 0.5) * d, (l + 0.5) * d};
        if (keep && !keep(user, x)) continue;
        count++;
        if (file) fprintf(file, "%.9g %.9g %.9g\n", x[0], x[1], x[2]);
    }
    return count;
}

static void write_header(FILE *file, int count) {
    fprintf(file,
            "ply\nformat ascii 1.0\nelement vertex %d\nproperty double x\nproperty double y\n"
            "property double z\nend_header\n",
            count);
}

void particles_write(FILE *file, int count, const double *x) {
    write_header(file, count);
    for (int i = 0; i < count; i++)
        fprintf(file, "%.17g %.17g %.17g\n", x[3 * i], x[3 * i + 1], x[3 * i + 2]);
    fclose(file);
}

int lattice_write(FILE *file, double d, const int cells[3],
                  bool (*keep)(const void *user, double x[3]), const void *user) {
    int count = visit(NULL, d, cells, keep, user);
    write_header(file, count);
    visit(file, d, cells, keep, user);
    fclose(file);
    return count;
}

void sheet_write(FILE *file, int along, int across,
                 void (*place)(const void *user, double s, double t, double x[3]),
                 const void *user) {
    int n = across + 1;
    for (int i = 0; i <= along; i++)
        for (int j = 0; j < n; j++) {
            double x[3];
            place(user, (double)i / along, (double)j / across, x);
            fprintf(file, "v %.17g %.17g %.17g\n", x[0], x[1], x[2]);
        }
    write_triangles(file, along, across);
    fclose(file);
}

void sphere_write(FILE *file, int n, double radius) {
    const double quarter_turn = 0.785398163397448;
    int m = n + 1, count = 0;
    int *number = calloc((size_t)(m * m * m), sizeof *number);
    if (!number) die("out of memory");
    for (int i = 0; i < m * m * m; i++) {
        int c[3] = {i % m, i / m % m, i / (m * m)}, sides = 0;
        double x[3];
        for (int k = 0; k < 3; k++) {
            sides += c[k] == 0 || c[k] == n;
            x[k] = tan(quarter_turn * (2.0 * c[k] / n - 1.0));
        }
        if (!sides) continue;
        double scale = radius / vec3_length(x);
        number[i] = ++count;
        fprintf(file, "v %.17g %.17g %.17g\n", scale * x[0], scale * x[1], scale * x[2]);
    }
    for (int side = 0; side < 6; side++)
        for (int k = 0; k < n * n; k++) {
            const int stride[3] = {1, m, m * m};
            int axis = side / 2, far = side % 2; /* triangles face outward */
            int u = stride[(axis + 1 + !far) % 3], v = stride[(axis + 1 + far) % 3];
            int a = far * n * stride[axis] + k % n * u + k / n * v;
            fprintf(file, "f %d %d %d\nf %d %d %d\n", number[a], number[a + u], number[a + u + v],
                    number[a], number[a + u + v], number[a + v]);
        }
    free(number);
    fclose(file);
}
