#include "strip.h"

#include "validation.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

int strip_vertex(const struct strip *strip, int i, int j) { return i * (strip->across + 1) + j; }

double strip_length(const struct strip *s, int n) {
    return s->segment * (s->growth == 1.0 ? n : (pow(s->growth, n) - 1.0) / (s->growth - 1.0));
}

/* Reproducible random numbers in [-1, 1). */
static double random_number(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) * 0x1p-52 - 1.0;
}

/* Vertices of borders and of the row next to a clamp are not moved. */
static void write_vertex(FILE *file, const struct strip *s, int i, int j, uint64_t *seed) {
    double dx = s->random * s->segment * random_number(seed);
    double dz = s->random * s->segment * random_number(seed);
    if (i <= 1 || i >= s->along) dx = 0.0;
    if (i == 0 || i == s->along || j == 0 || j == s->across) dz = 0.0;
    if (j == 0 || j == s->across) dx = 0.0;
    double arc = strip_length(s, i) + dx, xy[2] = {s->first + arc, 0.0};
    if (s->place) s->place(s, arc, xy);
    fprintf(file, "v %.17g %.17g %.17g\n", xy[0], xy[1], (j - 0.5 * s->across) * s->segment + dz);
}

static void write_cell(FILE *file, const struct strip *s, int i, int j, uint64_t *seed) {
    int a = strip_vertex(s, i, j) + 1, b = strip_vertex(s, i + 1, j) + 1, c = b + 1, d = a + 1;
    bool other = s->random > 0.0 ? random_number(seed) < 0.0 : (i + j) % 2;
    if (other) fprintf(file, "f %d %d %d\nf %d %d %d\n", a, d, b, d, c, b);
    else fprintf(file, "f %d %d %d\nf %d %d %d\n", a, d, c, a, c, b);
}

static void write_mesh(const char *directory, const struct strip *s) {
    char path[4096];
    uint64_t seed = 1;
    snprintf(path, sizeof path, "%s/%s.obj", directory, s->name);
    FILE *file = fopen(path, "w");
    if (!file) die("%s: cannot be written", path);
    for (int i = 0; i <= s->along; i++)
        for (int j = 0; j <= s->across; j++) write_vertex(file, s, i, j, &seed);
    for (int i = 0; i < s->along; i++)
        for (int j = 0; j < s->across; j++) write_cell(file, s, i, j, &seed);
    fclose(file);
}

pdyn_sim *strip_load(pdyn_context *context, const char *directory, const struct strip *s) {
    write_mesh(directory, s);
    return load_text(context,
                     "{'duration': 1e6, 'frame_interval': 1e3, 'time_step': {'integrator': "
                     "'euler', 'fixed': %.17g}, "
                     "'gravity': [%.17g, %.17g, %.17g], 'solver': {'type': '%s', "
                     "'tolerance': %.17g, 'outer_iterations': 200}, 'bodies': [{'name': "
                     "'strip', 'surface': {'mesh': '%s/%s.obj', 'area_density': %.17g}, "
                     "'constraints': [%s]}]}",
                     s->h, s->gravity[0], s->gravity[1], s->gravity[2],
                     s->solver ? s->solver : "cholesky", s->tolerance, directory, s->name,
                     s->area_density, s->constraints);
}

/* A swinging strip is momentarily at rest at its turning points: rest has to last some steps. */
void strip_settle(pdyn_sim *sim, const struct strip *s, double still) {
    const pdyn_state state = pdyn_get_state(sim);
    for (int n = 0, quiet = 0; quiet < 5; n++) {
        if (n == 20000) die("%s does not come to rest", s->name);
        double fastest = 0.0;
        take_step(sim);
        for (int k = 0; k < 3 * state.particles; k++) fastest = fmax(fastest, fabs(state.v[k]));
        quiet = fastest * s->h > still * s->segment ? 0 : quiet + 1;
    }
}

void strip_row(const pdyn_sim *sim, const struct strip *s, int i, double mean[3]) {
    const pdyn_state state = pdyn_get_state(sim);
    memset(mean, 0, 3 * sizeof *mean);
    for (int j = 0; j <= s->across; j++)
        for (int k = 0; k < 3; k++)
            mean[k] += state.x[3 * strip_vertex(s, i, j) + k] / (s->across + 1);
}
