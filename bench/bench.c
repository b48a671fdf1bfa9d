#include "bench.h"

#include "projdyn/vec3.h"

#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>

void die(const char *format, ...) {
    va_list args;
    va_start(args, format);
    fprintf(stderr, "%s: ", program_invocation_short_name);
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
    va_end(args);
    exit(1);
}

pdyn_context *make_context(int threads) {
    pdyn_options options = pdyn_default_options();
    pdyn_context *context;
    options.threads = threads;
    if (pdyn_create(&options, &context) != PDYN_OK) die("no context");
    return context;
}

pdyn_sim *load_text(pdyn_context *context, const char *format, ...) {
    static char text[1 << 17];
    pdyn_sim *sim;
    va_list args;
    va_start(args, format);
    int length = vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (length < 0 || (size_t)length >= sizeof text) die("too long a scene");
    for (char *c = text; *c; c++)
        if (*c == '\'') *c = '"';
    if (pdyn_load_text(context, text, program_invocation_short_name, NULL, 0, &sim) != PDYN_OK)
        die("%s", pdyn_last_error(context));
    return sim;
}

pdyn_step_info take_step(pdyn_sim *sim) {
    pdyn_step_info info;
    if (pdyn_step(sim, &info) != PDYN_OK) die("%s", pdyn_last_error(NULL));
    return info;
}

FILE *open_csv(const char *directory, const char *name) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s.csv", directory, name);
    FILE *file = fopen(path, "w");
    if (!file) die("%s: cannot be written", path);
    return file;
}

void write_triangles(FILE *file, int along, int across) {
    int n = across + 1;
    for (int i = 0; i < along; i++)
        for (int j = 1; j < n; j++) {
            int a = i * n + j, b = a + 1, c = a + n, d = c + 1;
            if ((i + j) % 2) fprintf(file, "f %d %d %d\nf %d %d %d\n", a, b, c, b, d, c);
            else fprintf(file, "f %d %d %d\nf %d %d %d\n", a, b, d, a, d, c);
        }
}

struct momenta momenta_of(const pdyn_sim *sim) {
    const pdyn_state s = pdyn_get_state(sim);
    struct momenta sum = {0};
    for (int i = 0; i < s.particles; i++) {
        double moment[3];
        vec3_cross(moment, s.x + 3 * i, s.v + 3 * i);
        vec3_add(sum.linear, s.mass[i], s.v + 3 * i);
        vec3_add(sum.angular, s.mass[i], moment);
        sum.size += s.mass[i] * vec3_length(s.v + 3 * i);
        sum.moment += s.mass[i] * vec3_length(moment);
    }
    return sum;
}
