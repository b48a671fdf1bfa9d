/* projdyn replay: finds the bodies of a run, reads its frames twice (first the ranges, then the
 * values) and streams them, quantised and compressed, into the page. */
#include "replay.h"
#include "app.h"
#include "frames.h"

#include <dirent.h>
#include <errno.h>
#include <getopt.h>
#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

enum { PATH = 4096, CHUNK = 3 << 14, PLANES = 5, SAMPLES = 64 };

static const char usage[] =
    "Usage: projdyn replay DIR [-o FILE]\n"
    "\n"
    "Packs the frames of a run into one HTML page that any browser with WebGL 2 plays.\n"
    "\n"
    "  -o, --output FILE  where to write (default DIR/replay.html)\n"
    "  -h, --help         this text\n";

/* One number per point over time: quantised, coded against what the frames before predict. */
struct plane {
    bool wide;                        /* 16 bits, otherwise 8 */
    uint16_t *now, *before, *earlier; /* count */
};

struct body {
    const char *name;            /* owned by the run's `bodies` */
    json_t *series;              /* its file */
    json_t *files;               /* the frames in it */
    int count, triangles;        /* count: the most points of a frame */
    int *points;                 /* frames: particles may come and go */
    int *triangle;               /* triangles x 3 */
    double radius, rest_density; /* of particles; rest density 0: unknown */
    double max_speed, max_error;
    int planes;
    struct plane plane[PLANES]; /* x, y, z; of particles also speed, density error */
};

struct box {
    double min[3], max[3];
};

struct run {
    const char *directory;
    json_t *report, *bodies, *metrics; /* report NULL: there is none */
    int count, parts, frames;
    struct body *body; /* parts: the bodies, then boundary points that move, if there are any */
    struct box box;
    struct frame boundary; /* no points: there is none */
    struct box boundary_box;
};

/* What goes through deflate and base64 into the page. Errors stay until they are asked for. */
struct page {
    FILE *file;
    z_stream deflate;
    bool failed;
    unsigned char packed[CHUNK];
};

/* ---- messages and paths -------------------------------------------------------------------------
 */

static int fail(const char *format, ...) PDYN_PRINTF(1, 2);
static int fail(const char *format, ...) {
    va_list args;
    fputs("projdyn: ", stderr);
    va_start(args, format);
    vfprintf(stderr, format, args);
    va_end(args);
    fputc('\n', stderr);
    return EXIT_BAD_INPUT;
}

static int no_memory(void) {
    fail("out of memory");
    return EXIT_FAILED;
}

static bool make_path(char path[PATH], const struct run *run, const char *name,
                      const char *ending) {
    int length = snprintf(path, PATH, "%s/%s%s", run->directory, name, ending);
    return length >= 0 && length < PATH;
}

static bool is_plain_name(const char *name) { return name && *name && !strchr(name, '/'); }

static int load_json(const char *path, json_t **out) {
    char *text;
    size_t size;
    json_error_t error;
    int code = file_read(path, &text, &size);
    if (code != EXIT_GOOD) return code;
    *out = json_loadb(text, size, JSON_REJECT_DUPLICATES, &error);
    free(text);
    if (!*out)
        return fail("%s:%d:%d: expected JSON: %s", path, error.line, error.column, error.text);
    if (!json_is_object(*out)) return fail("%s: expected a JSON object", path);
    return EXIT_GOOD;
}

/* ---- the bodies ---------------------------------------------------------------------------------
 */

static int by_name(const struct dirent **a, const struct dirent **b) {
    return strcmp((*a)->d_name, (*b)->d_name);
}

static int is_series(const struct dirent *entry) {
    static const char ending[] = ".vtk.series";
    size_t length = strlen(entry->d_name), tail = sizeof ending - 1;
    return length > tail && !strcmp(entry->d_name + length - tail, ending) &&
           strcmp(entry->d_name, "boundary.vtk.series") != 0;
}

/* A run that was killed left no report: every series but that of the boundary is a body. */
static int find_series(struct run *run) {
    struct dirent **entry;
    int count = scandir(run->directory, &entry, is_series, by_name);
    if (count < 0)
        return fail("%s: cannot read the directory: %s", run->directory, strerror(errno));
    run->bodies = json_array();
    for (int i = 0; i < count; i++) {
        int length = (int)(strlen(entry[i]->d_name) - strlen(".vtk.series"));
        json_array_append_new(run->bodies,
                              json_pack("{s:s%}", "name", entry[i]->d_name, (size_t)length));
        free(entry[i]);
    }
    free(entry);
    return EXIT_GOOD;
}

static int find_bodies(struct run *run) {
    char path[PATH];
    if (!make_path(path, run, "report", ".json"))
        return fail("%s: the path is too long", run->directory);
    bool there = access(path, F_OK) == 0;
    int code = there ? load_json(path, &run->report) : find_series(run);
    if (code != EXIT_GOOD) return code;
    if (there) run->bodies = json_incref(json_object_get(run->report, "bodies"));
    if (json_array_size(run->bodies)) return EXIT_GOOD;
    if (there) return fail("%s: expected an array \"bodies\" with a body in it", path);
    return fail("%s: expected the output of a run (report.json or NAME.vtk.series), found neither",
                run->directory);
}

/* Frames are plain file names with finite, rising times. */
static int check_series(const struct body *body, const char *path) {
    double last = -INFINITY;
    if (!json_is_array(body->files)) return fail("%s: expected an array \"files\"", path);
    for (size_t f = 0; f < json_array_size(body->files); f++) {
        json_t *entry = json_array_get(body->files, f), *time = json_object_get(entry, "time");
        if (!is_plain_name(json_string_value(json_object_get(entry, "name"))))
            return fail("%s: files[%zu]: expected the \"name\" of a file in the same directory",
                        path, f);
        if (!json_is_number(time) || json_number_value(time) <= last)
            return fail("%s: files[%zu]: expected a \"time\" after that of the frame before", path,
                        f);
        last = json_number_value(time);
    }
    return EXIT_GOOD;
}

/* A size of a body in the report; 0 where it is not told. */
static int read_size(const struct run *run, int b, const char *key, double *out) {
    json_t *value = json_object_get(json_array_get(run->bodies, (size_t)b), key);
    *out = json_number_value(value);
    if (!value || json_is_null(value)) return EXIT_GOOD;
    if (json_is_number(value) && *out >= 0.0 && *out < 1e9) return EXIT_GOOD;
    return fail("%s/report.json: bodies[%d].%s: expected a number from 0 to 1e9", run->directory, b,
                key);
}

static int open_body(struct run *run, int b) {
    struct body *body = &run->body[b];
    char path[PATH];
    json_t *entry = json_array_get(run->bodies, (size_t)b);
    body->name = json_string_value(json_object_get(entry, "name"));
    if (!is_plain_name(body->name) || !make_path(path, run, body->name, ".vtk.series"))
        return fail("%s/report.json: bodies[%d]: expected a \"name\" without '/'", run->directory,
                    b);
    int code = load_json(path, &body->series);
    body->files = json_object_get(body->series, "files");
    if (code == EXIT_GOOD) code = check_series(body, path);
    if (code == EXIT_GOOD) code = read_size(run, b, "radius_m", &body->radius);
    if (code == EXIT_GOOD) code = read_size(run, b, "rest_density", &body->rest_density);
    return code;
}

/* Points on solids that move: a body of nothing but points. */
static int open_moving(struct run *run) {
    struct body *moving = &run->body[run->count];
    char path[PATH];
    if (!make_path(path, run, "boundary", ".vtk.series") || access(path, F_OK)) return EXIT_GOOD;
    run->parts++;
    moving->name = "boundary";
    int code = load_json(path, &moving->series);
    moving->files = json_object_get(moving->series, "files");
    return code == EXIT_GOOD ? check_series(moving, path) : code;
}

static double frame_time(const struct body *body, int f) {
    return json_number_value(json_object_get(json_array_get(body->files, (size_t)f), "time"));
}

/* A run may be killed between the bodies of a frame: what all have counts. */
static int count_frames(struct run *run) {
    size_t frames = json_array_size(run->body[0].files);
    for (int b = 1; b < run->parts; b++) {
        size_t more = json_array_size(run->body[b].files);
        if (more < frames) frames = more;
    }
    if (!frames) return fail("%s: expected at least one frame, found none", run->directory);
    run->frames = (int)frames;
    for (int b = 1; b < run->parts; b++)
        for (int f = 0; f < run->frames; f++) {
            double time = frame_time(&run->body[b], f), expected = frame_time(&run->body[0], f);
            if (fabs(time - expected) > 1e-9 * (1.0 + fabs(expected)))
                return fail("%s/%s.vtk.series: files[%d]: expected the time %.9g of \"%s\", found "
                            "%.9g",
                            run->directory, run->body[b].name, f, expected, run->body[0].name,
                            time);
        }
    return EXIT_GOOD;
}

static int open_run(struct run *run) {
    int code = find_bodies(run);
    if (code != EXIT_GOOD) return code;
    run->count = run->parts = (int)json_array_size(run->bodies);
    run->body = calloc((size_t)run->count + 1, sizeof *run->body);
    if (!run->body) return no_memory();
    for (int b = 0; b < run->count && code == EXIT_GOOD; b++) code = open_body(run, b);
    if (code == EXIT_GOOD) code = open_moving(run);
    return code == EXIT_GOOD ? count_frames(run) : code;
}

static void close_run(struct run *run) {
    for (int b = 0; b < run->parts; b++) {
        struct body *body = &run->body[b];
        json_decref(body->series);
        free(body->triangle);
        free(body->points);
        for (int p = 0; p < body->planes; p++) {
            free(body->plane[p].now);
            free(body->plane[p].before);
            free(body->plane[p].earlier);
        }
    }
    free(run->body);
    frame_free(&run->boundary);
    json_decref(run->metrics);
    json_decref(run->bodies);
    json_decref(run->report);
}

/* ---- first pass: what there is ------------------------------------------------------------------
 */

static const struct box nothing = {{INFINITY, INFINITY, INFINITY},
                                   {-INFINITY, -INFINITY, -INFINITY}};

static void grow_box(struct box *box, const struct frame *frame) {
    for (int i = 0; i < frame->count; i++)
        for (int k = 0; k < 3; k++) {
            box->min[k] = fmin(box->min[k], frame->x[3 * i + k]);
            box->max[k] = fmax(box->max[k], frame->x[3 * i + k]);
        }
}

static double speed_of(const struct frame *frame, int i) {
    const float *v = frame->velocity + 3 * i;
    return sqrt((double)v[0] * v[0] + (double)v[1] * v[1] + (double)v[2] * v[2]);
}

static double error_of(const struct body *body, const struct frame *frame, int i) {
    if (body->rest_density <= 0.0) return 0.0;
    return fmin(1e9, fmax(0.0, frame->density[i] / body->rest_density - 1.0)); /* finite */
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Without a report: half the median distance of a few particles to their nearest. */
static double guess_radius(const struct frame *frame) {
    double nearest[SAMPLES];
    int samples = frame->count < SAMPLES ? frame->count : SAMPLES;
    for (int s = 0; s < samples; s++) {
        int i = (int)((long)s * frame->count / samples);
        nearest[s] = INFINITY;
        for (int j = 0; j < frame->count; j++) {
            double square = 0.0;
            for (int k = 0; k < 3; k++) {
                double d = (double)frame->x[3 * i + k] - frame->x[3 * j + k];
                square += d * d;
            }
            if (j != i) nearest[s] = fmin(nearest[s], sqrt(square));
        }
    }
    qsort(nearest, (size_t)samples, sizeof *nearest, by_size);
    double radius = 0.5 * nearest[samples / 2];
    return isfinite(radius) && radius > 0.0 ? radius : 0.01;
}

static int begin_body(struct body *body, struct frame *frame, int frames) {
    body->triangles = frame->triangles;
    body->triangle = frame->triangle;
    body->count = frame->count;
    frame->triangle = NULL;
    body->planes = frame->density || !frame->count ? PLANES : 3;
    body->points = calloc((size_t)frames, sizeof *body->points);
    return body->points ? EXIT_GOOD : no_memory();
}

static int make_planes(struct body *body) {
    size_t count = (size_t)body->count + 1; /* of particles that never came, too */
    for (int p = 0; p < body->planes; p++) {
        struct plane *plane = &body->plane[p];
        plane->wide = p < 3;
        plane->now = calloc(count, sizeof *plane->now);
        plane->before = calloc(count, sizeof *plane->before);
        plane->earlier = calloc(count, sizeof *plane->earlier);
        if (!plane->now || !plane->before || !plane->earlier) return no_memory();
    }
    return EXIT_GOOD;
}

static int check_frame(const struct body *body, const struct frame *frame, const char *path) {
    bool other_count = body->triangles && frame->count != body->count;
    if (other_count || frame->triangles != body->triangles)
        return fail("%s: expected %d points and %d triangles as in the first frame, found %d and "
                    "%d",
                    path, body->count, body->triangles, frame->count, frame->triangles);
    size_t size = 3 * (size_t)frame->triangles * sizeof *frame->triangle;
    if (size && memcmp(frame->triangle, body->triangle, size))
        return fail("%s: expected the same triangles as in the first frame", path);
    return EXIT_GOOD;
}

static int check_report(const struct run *run, int b, const struct frame *frame, const char *path) {
    json_t *count = json_object_get(json_array_get(run->bodies, (size_t)b), "count");
    long long most = json_integer_value(count), least = frame->triangles ? most : 0;
    if (!run->report || b == run->count || (frame->count >= least && frame->count <= most))
        return EXIT_GOOD;
    return fail("%s: expected %s%lld points as report.json says, found %d", path,
                frame->triangles ? "" : "at most ", most, frame->count);
}

static int survey_frame(struct run *run, int b, struct frame *frame, int f, const char *path) {
    struct body *body = &run->body[b];
    int code = f ? check_frame(body, frame, path) : EXIT_GOOD;
    if (code == EXIT_GOOD) code = check_report(run, b, frame, path);
    if (code == EXIT_GOOD && !f) code = begin_body(body, frame, run->frames);
    if (code != EXIT_GOOD) return code;
    body->points[f] = frame->count;
    if (frame->count > body->count) body->count = frame->count;
    if (frame->density && frame->count && !(body->radius > 0.0)) body->radius = guess_radius(frame);
    grow_box(&run->box, frame);
    for (int i = 0; i < frame->count && frame->density; i++) {
        body->max_speed = fmax(body->max_speed, speed_of(frame, i));
        body->max_error = fmax(body->max_error, error_of(body, frame, i));
    }
    return EXIT_GOOD;
}

static int read_body_frame(const struct run *run, int b, int f, char path[PATH],
                           struct frame *frame) {
    json_t *entry = json_array_get(run->body[b].files, (size_t)f);
    const char *name = json_string_value(json_object_get(entry, "name"));
    if (!make_path(path, run, name, "")) return fail("%s: the path is too long", name);
    return b < run->count ? frame_read(path, frame) : frame_read_boundary(path, frame);
}

static int survey(struct run *run) {
    char path[PATH];
    int code = EXIT_GOOD;
    run->box = run->boundary_box = nothing;
    for (int f = 0; f < run->frames; f++)
        for (int b = 0; b < run->parts; b++) {
            struct frame frame;
            code = read_body_frame(run, b, f, path, &frame);
            if (code != EXIT_GOOD) return code;
            code = survey_frame(run, b, &frame, f, path);
            frame_free(&frame);
            if (code != EXIT_GOOD) return code;
        }
    if (run->box.min[0] > run->box.max[0])
        return fail("%s: expected at least one particle in some frame, found none", run->directory);
    for (int b = 0; b < run->parts && code == EXIT_GOOD; b++) code = make_planes(&run->body[b]);
    if (code == EXIT_GOOD && make_path(path, run, "boundary", ".vtk") && access(path, F_OK) == 0)
        code = frame_read_boundary(path, &run->boundary);
    grow_box(&run->boundary_box, &run->boundary);
    return code;
}

/* ---- metrics ------------------------------------------------------------------------------------
 */

static const char *const columns[] = {
    "time_s",    "outer_iterations", "linear_iterations", "density_error_mean", "density_error_max",
    "kinetic_J", "potential_J",      "constraint_J"};

enum { COLUMNS = sizeof columns / sizeof *columns };

/* Which of ours a column of the file is: its index, COLUMNS for none. */
static int find_column(const char *cell) {
    int k = 0;
    while (k < COLUMNS && strcmp(columns[k], cell)) k++;
    return k;
}

/* An empty cell stands for a number that is not finite. */
static json_t *parse_cell(const char *cell) {
    char *end;
    if (!*cell) return json_null();
    double value = strtod(cell, &end);
    return *end || !isfinite(value) ? NULL : json_real(value);
}

static int parse_header(struct run *run, char *line, const char *path, json_t *order) {
    for (char *cell; (cell = strsep(&line, ","));) {
        int k = find_column(cell);
        json_array_append_new(order, json_integer(k));
        if (k < COLUMNS) json_object_set_new(run->metrics, columns[k], json_array());
    }
    for (int k = 0; k < COLUMNS; k++)
        if (!json_object_get(run->metrics, columns[k]))
            return fail("%s:1: expected the column \"%s\"", path, columns[k]);
    return EXIT_GOOD;
}

static int parse_row(struct run *run, char *line, const char *path, int number,
                     const json_t *order) {
    size_t cells = 0;
    for (char *cell; (cell = strsep(&line, ",")); cells++) {
        int k = (int)json_integer_value(json_array_get(order, cells));
        if (cells >= json_array_size(order) || k >= COLUMNS) continue;
        json_t *value = parse_cell(cell);
        if (!value)
            return fail("%s:%d: %s: expected a number, found \"%.40s\"", path, number, columns[k],
                        cell);
        json_array_append_new(json_object_get(run->metrics, columns[k]), value);
    }
    if (cells != json_array_size(order))
        return fail("%s:%d: expected %zu cells, found %zu", path, number, json_array_size(order),
                    cells);
    return EXIT_GOOD;
}

/* Only the page's plots need them: no file, no plots. */
static int read_metrics(struct run *run) {
    char path[PATH], *text;
    size_t size;
    if (!make_path(path, run, "metrics", ".csv") || access(path, F_OK)) return EXIT_GOOD;
    int code = file_read(path, &text, &size);
    if (code != EXIT_GOOD) return code;
    run->metrics = json_object();
    json_t *order = json_array();
    int number = 0;
    char *rest = text;
    for (char *line; code == EXIT_GOOD && (line = strsep(&rest, "\n"));) {
        if (!rest && !*line && number) break; /* the end */
        code = number++ ? parse_row(run, line, path, number, order)
                        : parse_header(run, line, path, order);
    }
    json_decref(order);
    free(text);
    return code;
}

/* ---- the page's data ----------------------------------------------------------------------------
 */

static void write_text(struct page *page, const char *text, size_t size) {
    if (fwrite(text, 1, size, page->file) != size) page->failed = true;
}

/* Only the last piece of all may have a size that 3 does not divide. */
static void write_base64(struct page *page, const unsigned char *bytes, size_t size) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        size_t left = size - i;
        unsigned word = (unsigned)bytes[i] << 16 | (left > 1 ? (unsigned)bytes[i + 1] << 8 : 0U) |
                        (left > 2 ? bytes[i + 2] : 0U);
        char text[4] = {digits[word >> 18], digits[word >> 12 & 63],
                        left > 1 ? digits[word >> 6 & 63] : '=',
                        left > 2 ? digits[word & 63] : '='};
        write_text(page, text, sizeof text);
    }
}

static void pack(struct page *page, const unsigned char *bytes, size_t size, int flush) {
    z_stream *z = &page->deflate;
    z->next_in = (unsigned char *)bytes;
    z->avail_in = (uInt)size;
    int status = Z_OK;
    while (status == Z_OK && (z->avail_in || flush == Z_FINISH)) {
        status = deflate(z, flush);
        if (z->avail_out && status != Z_STREAM_END) continue;
        write_base64(page, page->packed, CHUNK - z->avail_out);
        z->next_out = page->packed;
        z->avail_out = CHUNK;
    }
}

static uint16_t quantise(double value, double min, double max, double levels) {
    if (!(max > min)) return 0;
    return (uint16_t)lrint(levels * fmin(1.0, fmax(0.0, (value - min) / (max - min))));
}

/* ---- second pass: the values --------------------------------------------------------------------
 */

/* What a plane is predicted from: nothing, the frame before, the line through two of them. */
static const struct predictor { int before, earlier; } predictors[] = {{0, 0}, {1, 0}, {2, -1}};

enum { PREDICTORS = sizeof predictors / sizeof *predictors };

/* The difference to the prediction, small both ways: 0, -1, 1, -2, 2, ... as 0, 1, 2, 3, 4, ... */
static unsigned residual(const struct plane *plane, const struct predictor *p, int i) {
    int difference = plane->now[i] - p->before * plane->before[i] - p->earlier * plane->earlier[i];
    int wrapped = plane->wide ? (int16_t)difference : (int8_t)difference;
    return wrapped < 0 ? 2U * (unsigned)-wrapped - 1U : 2U * (unsigned)wrapped;
}

static int best_predictor(const struct plane *plane, int count, int frame) {
    int best = 0;
    uint64_t least = UINT64_MAX;
    for (int p = 0; p < PREDICTORS && p <= frame; p++) {
        uint64_t sum = 0;
        for (int i = 0; i < count; i++) sum += residual(plane, &predictors[p], i);
        if (sum < least) {
            least = sum;
            best = p;
        }
    }
    return best;
}

/* The predictor; the high bytes of a wide plane; the low bytes. */
static void pack_plane(struct page *page, struct plane *plane, int count, int frame,
                       unsigned char *scratch) {
    int best = best_predictor(plane, count, frame);
    unsigned char *low = scratch + 1 + (plane->wide ? count : 0);
    scratch[0] = (unsigned char)best;
    for (int i = 0; i < count; i++) {
        unsigned value = residual(plane, &predictors[best], i);
        if (plane->wide) scratch[1 + i] = (unsigned char)(value >> 8);
        low[i] = (unsigned char)value;
    }
    pack(page, scratch, (size_t)(low - scratch) + (size_t)count, Z_NO_FLUSH);
    uint16_t *oldest = plane->earlier;
    plane->earlier = plane->before;
    plane->before = plane->now;
    plane->now = oldest;
}

/* The square root keeps small values apart: a few large ones set the range. Points that are missing
 * are zeros. */
static void quantise_frame(const struct run *run, struct body *body, const struct frame *frame) {
    for (int p = 0; p < body->planes; p++)
        memset(body->plane[p].now, 0, (size_t)body->count * sizeof *body->plane[p].now);
    for (int i = 0; i < frame->count; i++) {
        for (int k = 0; k < 3; k++)
            body->plane[k].now[i] =
                quantise(frame->x[3 * i + k], run->box.min[k], run->box.max[k], 65535.0);
        if (!frame->density) continue;
        body->plane[3].now[i] =
            quantise(sqrt(speed_of(frame, i)), 0.0, sqrt(body->max_speed), 255.0);
        body->plane[4].now[i] =
            quantise(sqrt(error_of(body, frame, i)), 0.0, sqrt(body->max_error), 255.0);
    }
}

static int pack_frame(struct run *run, struct page *page, int b, int f) {
    struct body *body = &run->body[b];
    char path[PATH];
    struct frame frame;
    int code = read_body_frame(run, b, f, path, &frame);
    if (code != EXIT_GOOD) return code;
    code = check_frame(body, &frame, path);
    if (code == EXIT_GOOD && frame.count != body->points[f])
        code = fail("%s: expected %d points as a moment ago, found %d", path, body->points[f],
                    frame.count);
    unsigned char *scratch = malloc(2 * (size_t)body->count + 1);
    if (code == EXIT_GOOD && !scratch) code = no_memory();
    if (code == EXIT_GOOD) {
        quantise_frame(run, body, &frame);
        for (int p = 0; p < body->planes; p++)
            pack_plane(page, &body->plane[p], body->count, f, scratch);
    }
    free(scratch);
    frame_free(&frame);
    return code;
}

/* Little endian, as the page reads typed arrays. */
static void pack_triangles(struct page *page, const struct body *body) {
    for (int i = 0; i < 3 * body->triangles; i++) {
        unsigned corner = (unsigned)body->triangle[i];
        unsigned char bytes[4] = {(unsigned char)corner, (unsigned char)(corner >> 8),
                                  (unsigned char)(corner >> 16), (unsigned char)(corner >> 24)};
        pack(page, bytes, sizeof bytes, Z_NO_FLUSH);
    }
}

static void pack_boundary(struct page *page, const struct run *run) {
    const struct box *box = &run->boundary_box;
    for (int i = 0; i < 3 * run->boundary.count; i++) {
        unsigned value = quantise(run->boundary.x[i], box->min[i % 3], box->max[i % 3], 65535.0);
        unsigned char bytes[2] = {(unsigned char)value, (unsigned char)(value >> 8)};
        pack(page, bytes, sizeof bytes, Z_NO_FLUSH);
    }
}

static int pack_all(struct run *run, struct page *page) {
    page->deflate = (z_stream){.next_out = page->packed, .avail_out = CHUNK};
    if (deflateInit(&page->deflate, Z_DEFAULT_COMPRESSION) != Z_OK) return no_memory();
    int code = EXIT_GOOD;
    for (int b = 0; b < run->count; b++) pack_triangles(page, &run->body[b]);
    pack_boundary(page, run);
    for (int f = 0; f < run->frames && code == EXIT_GOOD && !page->failed; f++)
        for (int b = 0; b < run->parts && code == EXIT_GOOD; b++)
            code = pack_frame(run, page, b, f);
    if (code == EXIT_GOOD) pack(page, NULL, 0, Z_FINISH);
    deflateEnd(&page->deflate);
    return code;
}

/* ---- the page -----------------------------------------------------------------------------------
 */

static json_t *json_box(const struct box *box) {
    return json_pack("[[f,f,f],[f,f,f]]", box->min[0], box->min[1], box->min[2], box->max[0],
                     box->max[1], box->max[2]);
}

static json_t *json_points(const struct run *run, const struct body *body) {
    json_t *points = json_array();
    for (int f = 0; f < run->frames; f++)
        json_array_append_new(points, json_integer(body->points[f]));
    return points;
}

static json_t *json_bodies(const struct run *run) {
    json_t *bodies = json_array();
    int failed = 0;
    for (int b = 0; b < run->count; b++) {
        const struct body *body = &run->body[b];
        failed |= json_array_append_new(
            bodies,
            json_pack("{s:s, s:i, s:o, s:i, s:f, s:b, s:f, s:f}", "name", body->name, "count",
                      body->count, "points", json_points(run, body), "triangles", body->triangles,
                      "radius", body->radius, "density", body->rest_density > 0.0, "max_speed",
                      body->max_speed, "max_error", body->max_error));
    }
    if (!failed) return bodies;
    json_decref(bodies);
    return NULL;
}

static json_t *compose_meta(const struct run *run) {
    static const char *const told[] = {"name",    "scene",       "version",
                                       "threads", "simulated_s", "wall_s"};
    json_t *about = json_object(), *times = json_array();
    for (size_t k = 0; k < sizeof told / sizeof *told; k++) {
        json_t *value = json_object_get(run->report, told[k]);
        if (json_is_string(value) || json_is_number(value)) json_object_set(about, told[k], value);
    }
    for (int f = 0; f < run->frames; f++)
        json_array_append_new(times, json_real(frame_time(&run->body[0], f)));
    json_t *boundary = run->boundary.count ? json_pack("{s:i, s:o}", "count", run->boundary.count,
                                                       "box", json_box(&run->boundary_box))
                                           : json_null();
    json_t *moving = run->parts > run->count
                         ? json_pack("{s:i}", "count", run->body[run->count].count)
                         : json_null();
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:O?}", "about", about, "times", times, "box",
                     json_box(&run->box), "bodies", json_bodies(run), "boundary", boundary,
                     "moving", moving, "metrics", run->metrics);
}

/* Inside a script element: no '<' may stand there, and JSON has it in strings alone. */
static int write_meta(struct page *page, const struct run *run) {
    json_t *meta = compose_meta(run);
    char *text =
        meta ? json_dumps(meta, JSON_COMPACT | JSON_ENSURE_ASCII | JSON_REAL_PRECISION(9)) : NULL;
    json_decref(meta);
    if (!text) return no_memory();
    for (const char *at = text; *at;) {
        size_t plain = strcspn(at, "<");
        write_text(page, at, plain);
        at += plain;
        if (!*at) break;
        write_text(page, "\\u003c", 6);
        at++;
    }
    free(text);
    return EXIT_GOOD;
}

/* The page with its two placeholders filled. */
static int write_page(struct run *run, struct page *page) {
    static const char meta[] = "@META@", data[] = "@DATA@";
    const char *end = replay_page + replay_page_size();
    const char *at_meta = strstr(replay_page, meta), *at_data = strstr(replay_page, data);
    write_text(page, replay_page, (size_t)(at_meta - replay_page));
    int code = write_meta(page, run);
    at_meta += sizeof meta - 1;
    write_text(page, at_meta, (size_t)(at_data - at_meta));
    if (code == EXIT_GOOD) code = pack_all(run, page);
    at_data += sizeof data - 1;
    write_text(page, at_data, (size_t)(end - at_data));
    return code;
}

static int fail_write(const char *path, const char *what) {
    fail("%s: %s: %s", path, what, strerror(errno));
    return EXIT_FAILED;
}

/* Written aside: the page appears whole or not at all. What is no regular file is written directly.
 */
static int write_file(struct run *run, const char *path) {
    static struct page page; /* too large for a stack */
    char aside[PATH];
    struct stat info;
    bool special = lstat(path, &info) == 0 && !S_ISREG(info.st_mode);
    int length = snprintf(aside, sizeof aside, "%s%s", path, special ? "" : ".tmp");
    if (length < 0 || length >= PATH) return fail("%s: the path is too long", path);
    page = (struct page){.file = fopen(aside, "wbe")};
    if (!page.file) return fail_write(aside, "cannot create the file");
    int code = write_page(run, &page);
    if (fflush(page.file) || ferror(page.file)) page.failed = true;
    if (code == EXIT_GOOD && page.failed) code = fail_write(aside, "writing failed");
    if (fclose(page.file) && code == EXIT_GOOD) code = fail_write(aside, "writing failed");
    if (special) return code;
    if (code == EXIT_GOOD && rename(aside, path)) code = fail_write(path, "cannot rename to it");
    if (code != EXIT_GOOD) unlink(aside);
    return code;
}

static int replay(struct run *run, const char *output) {
    char path[PATH];
    int code = open_run(run);
    if (code == EXIT_GOOD && !run->report)
        fputs("projdyn: no report.json: radii are estimated, density errors are not shown\n",
              stderr);
    if (code == EXIT_GOOD) code = read_metrics(run);
    if (code == EXIT_GOOD) code = survey(run);
    if (code == EXIT_GOOD && !output && !make_path(path, run, "replay", ".html"))
        code = fail("%s: the path is too long", run->directory);
    if (code == EXIT_GOOD) code = write_file(run, output ? output : path);
    if (code == EXIT_GOOD) printf("%d frames written to %s\n", run->frames, output ? output : path);
    return code;
}

int replay_main(int argc, char **argv) {
    static const struct option long_options[] = {
        {"output", required_argument, NULL, 'o'}, {"help", no_argument, NULL, 'h'}, {0}};
    const char *output = NULL;
    int option;
    while ((option = getopt_long(argc, argv, "o:h", long_options, NULL)) != -1) {
        if (option == 'h') {
            fputs(usage, stdout);
            return EXIT_GOOD;
        }
        if (option != 'o') return EXIT_BAD_INPUT;
        output = optarg;
    }
    if (argc - optind != 1) {
        fprintf(stderr, "projdyn: replay: expected one directory\n\n%s", usage);
        return EXIT_BAD_INPUT;
    }
    struct run run = {.directory = argv[optind]};
    int code = replay(&run, output);
    close_run(&run);
    return code;
}
