/* projdyn mesh: triangle meshes of the surface of the fluid, and of bodies that "cell" has filled,
 * for every frame of a run. */
#include "new_file.h"
#include "surface_file.h"
#include "surface_make.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char usage[] =
    "Usage: projdyn mesh DIR [OPTIONS]\n"
    "\n"
    "Writes triangle meshes of the surface of each fluid of a run, with velocities and normals, "
    "to\n"
    "DIR/mesh/BODY_000000.vtk and so on. The meshes are closed, and end at cloth and solids. Of a\n"
    "body with \"cell\": the mesh of the scene, carried by its tetrahedra.\n"
    "\n"
    "      --format FORMAT   vtk (default), ply or obj\n"
    "      --frames A:B      only the frames A to B, counted from 0\n"
    "      --threads N       worker threads (default: one per core)\n"
    "  -h, --help            prints this text\n";

struct mesh_options {
    const struct surface_format *format;
    long first, last; /* frames */
    int threads;
};

/* What became of the frames of a body. */
struct mesh_summary {
    int frames, triangles;       /* triangles: most in a frame */
    double least, most, seconds; /* enclosed volume over that of the particles */
};

/* ---- arguments ------------------------------------------------------------------------------- */

static bool accept_format(struct mesh_options *options, const char *name) {
    options->format = surface_formats;
    while (options->format->name && strcmp(options->format->name, name)) options->format++;
    if (options->format->name) return true;
    fprintf(stderr, "projdyn: --format: found \"%s\", expected vtk, ply or obj\n", name);
    return false;
}

static bool accept_option(void *self, int option) {
    struct mesh_options *options = self;
    if (option == 'f') return accept_format(options, optarg);
    if (option == 'r') return parse_frames(optarg, &options->first, &options->last);
    return option == 't' && parse_integer("--threads", optarg, 1, 1024, &options->threads);
}

/* ---- frames ---------------------------------------------------------------------------------- */

static int write_surface(const struct run *run, const struct part *part, int f,
                         const struct mesh_options *options, const struct surface *surface) {
    char path[RUN_PATH], title[512];
    const char *name = part->name, *ending = options->format->name;
    run_path(path, run, "mesh/%s_%06d.%s", name, f, ending);
    snprintf(title, sizeof title, "%.200s t=%.9g s", name, part_time(part, f));
    return surface_write(surface, options->format, path, title);
}

static void add_to_summary(struct mesh_summary *summary, const struct surface *surface,
                           double volume) {
    double ratio = surface_volume(surface) / volume;
    summary->frames++;
    if (surface->triangles > summary->triangles) summary->triangles = surface->triangles;
    if (!(volume > 0.0)) return;
    summary->least = fmin(summary->least, ratio), summary->most = fmax(summary->most, ratio);
}

static int mesh_frame(const struct run *run, const struct part *part, int f,
                      const struct mesh_options *options, struct mesh_summary *summary) {
    struct surface surface;
    double spacing = 2.0 * part->radius;
    int code = part->skin.count ? surface_carry(run, part, f, options->threads, &surface)
                                : surface_make(run, part, f, true, options->threads, &surface);
    if (code == EXIT_GOOD) code = write_surface(run, part, f, options, &surface);
    if (code == EXIT_GOOD) add_to_summary(summary, &surface, surface.particles * pow(spacing, 3.0));
    surface_free(&surface);
    return code;
}

/* Writes DIR/mesh/BODY.vtk.series, which lists the frames with their times. */
static int write_series(const struct run *run, const struct part *part,
                        const struct mesh_options *options) {
    const char *name = part->name;
    char path[RUN_PATH], *temporary;
    run_path(path, run, "mesh/%s.vtk.series", name);
    FILE *file = new_file_open(path, &temporary);
    if (!file) return report_write_error(path);
    fprintf(file, "{\"file-series-version\": \"1.0\", \"files\": [");
    for (int f = (int)options->first; f <= options->last; f++)
        fprintf(file, "%s\n{\"name\": \"%s_%06d.vtk\", \"time\": %.17g}",
                f > options->first ? "," : "", name, f, part_time(part, f));
    fprintf(file, "]}\n");
    return new_file_close(file, temporary, path, true) ? EXIT_GOOD : report_write_error(path);
}

/* ---- the command ----------------------------------------------------------------------------- */

static int mesh_body(const struct run *run, const struct part *part,
                     const struct mesh_options *options) {
    struct mesh_summary s = {.least = INFINITY, .most = -INFINITY, .seconds = wall_seconds()};
    int code = EXIT_GOOD;
    for (int f = (int)options->first; f <= options->last && code == EXIT_GOOD; f++)
        code = mesh_frame(run, part, f, options, &s);
    if (code == EXIT_GOOD && !strcmp(options->format->name, "vtk"))
        code = write_series(run, part, options);
    if (code != EXIT_GOOD) return code;
    printf("%s: %d frame%s, at most %d triangles, %.2f s a frame", part->name, s.frames,
           s.frames == 1 ? "" : "s", s.triangles, (wall_seconds() - s.seconds) / s.frames);
    if (s.least <= s.most)
        printf(", volume %.1f to %.1f %% of the particles'", 100.0 * s.least, 100.0 * s.most);
    puts("");
    return EXIT_GOOD;
}

static int make_folder(const struct run *run) {
    char path[RUN_PATH];
    run_path(path, run, "mesh");
    if (!mkdir(path, 0777) || (errno == EEXIST && !access(path, X_OK))) return EXIT_GOOD;
    return run_error("%s: cannot make the directory: %s", path, strerror(errno));
}

static int mesh_run(struct run *run, struct mesh_options *options) {
    int code = run_open_with_report(run), bodies = 0;
    if (code != EXIT_GOOD) return code;
    if (options->last == LONG_MAX) options->last = run->frames - 1;
    if (options->last >= run->frames)
        return run_error("--frames: expected frames up to %d, found %ld", run->frames - 1,
                         options->last);
    code = make_folder(run);
    for (int p = 0; p < run->parts && code == EXIT_GOOD; p++)
        if (run->part[p].fluid || run->part[p].skin.count)
            code = mesh_body(run, &run->part[p], options), bodies++;
    if (code == EXIT_GOOD && !bodies)
        return run_error("%s/%s: expected a body with the constraint \"fluid\" or with \"cell\"",
                         run->directory, run->source);
    return code;
}

int mesh_main(int argc, char **argv) {
    static const struct option long_options[] = {{"format", required_argument, NULL, 'f'},
                                                 {"frames", required_argument, NULL, 'r'},
                                                 {"threads", required_argument, NULL, 't'},
                                                 {"help", no_argument, NULL, 'h'},
                                                 {0}};
    struct mesh_options options = {surface_formats, 0, LONG_MAX, usable_cores()};
    int code = parse_options(argc, argv, "h", long_options, usage, accept_option, &options);
    if (code >= 0) return code;
    if (argc - optind != 1) return report_usage(argv, "one directory", usage);
    struct run run = {.directory = argv[optind]};
    code = mesh_run(&run, &options);
    run_close(&run);
    return code;
}
