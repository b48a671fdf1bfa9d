/* The page holds a JSON description and one deflated block of bytes: for each surface its triangles
 * (uint32), then for each frame and body x, y, z as 16 bit in the box of the whole run, as
 * differences to the frame before, low bytes and high bytes apart (they compress better so), then
 * one byte of speed and one of density error for each point. Frames are read one at a time. */
#include "replay.h"

#include "app.h"
#include "frames.h"
#include "replay_page.h"

#include <dirent.h>
#include <errno.h>
#include <getopt.h>
#include <jansson.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { MAX_BODIES = 64, MAX_PATH = 4096 };

struct body {
    char name[256];
    json_t *files; /* of the series */
    int points;
    double rest_density, radius;
    uint16_t *last; /* points x 3: quantised positions of the frame before */
};

struct replay {
    const char *directory;
    struct body body[MAX_BODIES];
    int bodies, frames;
    double min[3], max[3], speed_max, error_max;
    json_t *report; /* or NULL */
    z_stream stream;
    unsigned char *packed;
    size_t size, capacity;
};

static bool complain(const char *path, const char *expected) {
    fprintf(stderr, "projdyn: %s: expected %s\n", path, expected);
    return false;
}

/* ---- finding what there is
 * ------------------------------------------------------------------------ */

static bool add_series(struct replay *r, const char *file) {
    char path[MAX_PATH];
    size_t stem = strlen(file) - strlen(".vtk.series");
    if (r->bodies == MAX_BODIES || stem >= sizeof r->body->name)
        return complain(file, "at most 64 bodies");
    struct body *b = &r->body[r->bodies++];
    memcpy(b->name, file, stem);
    snprintf(path, sizeof path, "%s/%s", r->directory, file);
    json_t *series = json_load_file(path, 0, NULL);
    b->files = json_incref(json_object_get(series, "files"));
    json_decref(series);
    if (!json_array_size(b->files)) return complain(path, "a series with at least one frame");
    if (r->frames && r->frames != (int)json_array_size(b->files))
        r->frames = (int)fmin(r->frames, (double)json_array_size(b->files));
    else r->frames = (int)json_array_size(b->files);
    return true;
}

static int is_series(const struct dirent *entry) {
    const char *dot = strstr(entry->d_name, ".vtk.series");
    return dot && dot != entry->d_name && !dot[strlen(".vtk.series")];
}

static bool find_bodies(struct replay *r) {
    struct dirent **list;
    int count = scandir(r->directory, &list, is_series, alphasort);
    bool good = count > 0;
    if (count < 0) fprintf(stderr, "projdyn: %s: %s\n", r->directory, strerror(errno));
    if (count == 0) complain(r->directory, "a folder that 'projdyn run' wrote (*.vtk.series)");
    for (int k = 0; k < count; k++) {
        good = good && add_series(r, list[k]->d_name);
        free(list[k]);
    }
    if (count >= 0) free(list);
    return good;
}

/* Radius and rest density from the report; an interrupted run may have none. */
static void read_report(struct replay *r) {
    char path[MAX_PATH];
    size_t index;
    json_t *entry;
    snprintf(path, sizeof path, "%s/report.json", r->directory);
    r->report = json_load_file(path, 0, NULL);
    for (int b = 0; b < r->bodies; b++) {
        r->body[b].rest_density = 1000.0;
        json_array_foreach(json_object_get(r->report, "bodies"), index, entry) {
            const char *name = json_string_value(json_object_get(entry, "name"));
            if (!name || strcmp(name, r->body[b].name)) continue;
            r->body[b].radius = json_number_value(json_object_get(entry, "radius_m"));
            double rest = json_number_value(json_object_get(entry, "rest_density"));
            if (rest > 0.0) r->body[b].rest_density = rest;
        }
    }
}

static bool load_frame(const struct replay *r, int body, int frame, struct frame *out) {
    char path[MAX_PATH];
    const struct body *b = &r->body[body];
    const char *name =
        json_string_value(json_object_get(json_array_get(b->files, (size_t)frame), "name"));
    if (!name || strchr(name, '/')) return complain(b->name, "a series that names its frames");
    snprintf(path, sizeof path, "%s/%s", r->directory, name);
    if (frame_read(path, out) != EXIT_GOOD) return false;
    if (!frame || out->count == b->points) return true;
    frame_free(out);
    return complain(path, "as many points as in the first frame");
}

static double speed_of(const struct frame *f, int i) {
    const float *v = f->velocity + 3 * (size_t)i;
    return sqrt((double)v[0] * v[0] + (double)v[1] * v[1] + (double)v[2] * v[2]);
}

static double error_of(const struct frame *f, const struct body *b, int i) {
    return f->density ? fmax(0.0, (double)f->density[i] / b->rest_density - 1.0) : 0.0;
}

static void measure_frame(struct replay *r, const struct frame *f, const struct body *b) {
    for (int i = 0; i < f->count; i++) {
        for (int a = 0; a < 3; a++) {
            r->min[a] = fmin(r->min[a], (double)f->x[3 * i + a]);
            r->max[a] = fmax(r->max[a], (double)f->x[3 * i + a]);
        }
        r->speed_max = fmax(r->speed_max, speed_of(f, i));
        r->error_max = fmax(r->error_max, error_of(f, b, i));
    }
}

/* Boxes and ranges over all frames. */
static bool measure(struct replay *r) {
    struct frame f;
    r->speed_max = r->error_max = 1e-9;
    for (int a = 0; a < 3; a++) r->min[a] = HUGE_VAL, r->max[a] = -HUGE_VAL;
    for (int k = 0; k < r->frames; k++)
        for (int b = 0; b < r->bodies; b++) {
            if (!load_frame(r, b, k, &f)) return false;
            r->body[b].points = f.count;
            measure_frame(r, &f, &r->body[b]);
            frame_free(&f);
        }
    return true;
}

/* ---- packing
 * -------------------------------------------------------------------------------------- */

static bool pack(struct replay *r, const void *data, size_t size, int flush) {
    r->stream.next_in = (unsigned char *)data;
    r->stream.avail_in = (unsigned)size;
    do {
        if (r->size == r->capacity) {
            size_t capacity = 2 * r->capacity + (1u << 20);
            unsigned char *packed = realloc(r->packed, capacity);
            if (!packed) return complain("replay", "more memory");
            r->packed = packed, r->capacity = capacity;
        }
        unsigned room = (unsigned)fmin((double)(r->capacity - r->size), 1e9);
        r->stream.next_out = r->packed + r->size;
        r->stream.avail_out = room;
        deflate(&r->stream, flush);
        r->size += room - r->stream.avail_out;
    } while (!r->stream.avail_out);
    return true;
}

static uint16_t quantise(const struct replay *r, double x, int axis) {
    double size = r->max[axis] - r->min[axis];
    return (uint16_t)(size > 0.0 ? lround((x - r->min[axis]) / size * 65535.0) : 0);
}

static bool pack_frame(struct replay *r, struct body *b, const struct frame *f) {
    size_t n = (size_t)f->count;
    unsigned char *bytes = malloc(8 * n + 1);
    if (!bytes) return complain("replay", "more memory");
    for (size_t k = 0; k < 3 * n; k++) {
        uint16_t q = quantise(r, (double)f->x[k], (int)(k % 3)), d = (uint16_t)(q - b->last[k]);
        size_t place = k % 3 * n + k / 3;
        bytes[place] = (unsigned char)d;
        bytes[3 * n + place] = (unsigned char)(d >> 8);
        b->last[k] = q;
    }
    for (int i = 0; i < f->count; i++) {
        bytes[6 * n + (size_t)i] = (unsigned char)lround(255.0 * speed_of(f, i) / r->speed_max);
        bytes[7 * n + (size_t)i] =
            (unsigned char)lround(255.0 * sqrt(error_of(f, b, i) / r->error_max));
    }
    bool good = pack(r, bytes, 8 * n, Z_NO_FLUSH);
    free(bytes);
    return good;
}

static json_t *describe(const struct body *b, const struct frame *first) {
    return json_pack("{s:s, s:i, s:i, s:f}", "name", b->name, "points", b->points, "triangles",
                     first->triangles, "radius", b->radius);
}

/* Triangles first, then the frames. */
static bool pack_all(struct replay *r, json_t *bodies) {
    struct frame f;
    for (int b = 0; b < r->bodies; b++) {
        if (!load_frame(r, b, 0, &f)) return false;
        json_array_append_new(bodies, describe(&r->body[b], &f));
        bool good = pack(r, f.triangle, 3 * (size_t)f.triangles * sizeof *f.triangle, Z_NO_FLUSH);
        frame_free(&f);
        r->body[b].last = calloc(3 * (size_t)r->body[b].points + 1, sizeof(uint16_t));
        if (!good || !r->body[b].last) return false;
    }
    for (int k = 0; k < r->frames; k++)
        for (int b = 0; b < r->bodies; b++) {
            if (!load_frame(r, b, k, &f)) return false;
            bool good = pack_frame(r, &r->body[b], &f);
            frame_free(&f);
            if (!good) return false;
        }
    return pack(r, "", 0, Z_FINISH);
}

/* ---- the page
 * ------------------------------------------------------------------------------------- */

static json_t *numbers_of(const double *x, int count) {
    json_t *list = json_array();
    for (int k = 0; k < count; k++) json_array_append_new(list, json_real(x[k]));
    return list;
}

static json_t *meta_of(const struct replay *r, json_t *bodies) {
    char path[MAX_PATH];
    json_t *meta = json_object(), *times = json_array();
    size_t size = 0;
    for (int k = 0; k < r->frames; k++)
        json_array_append(times,
                          json_object_get(json_array_get(r->body[0].files, (size_t)k), "time"));
    const char *name = json_string_value(json_object_get(r->report, "name"));
    json_object_set_new(meta, "name", json_string(name && *name ? name : r->directory));
    json_object_set_new(meta, "min", numbers_of(r->min, 3));
    json_object_set_new(meta, "max", numbers_of(r->max, 3));
    json_object_set_new(meta, "speed", json_real(r->speed_max));
    json_object_set_new(meta, "error", json_real(r->error_max));
    json_object_set_new(meta, "times", times);
    json_object_set(meta, "bodies", bodies);
    snprintf(path, sizeof path, "%s/metrics.csv", r->directory);
    char *metrics = NULL; /* a run that was killed at once has none */
    if (file_read(path, &metrics, &size) != EXIT_GOOD) metrics = NULL;
    json_object_set_new(meta, "metrics", json_string(metrics ? metrics : ""));
    free(metrics);
    return meta;
}

static void write_base64(FILE *out, const unsigned char *data, size_t size) {
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t k = 0; k < size; k += 3) {
        unsigned a = data[k], b = k + 1 < size ? data[k + 1] : 0,
                 c = k + 2 < size ? data[k + 2] : 0;
        unsigned bits = a << 16 | b << 8 | c;
        fputc(digit[bits >> 18], out);
        fputc(digit[bits >> 12 & 63], out);
        fputc(k + 1 < size ? digit[bits >> 6 & 63] : '=', out);
        fputc(k + 2 < size ? digit[bits & 63] : '=', out);
    }
}

/* JSON inside a script element must not close it. */
static void write_script(FILE *out, const char *text) {
    for (; *text; text++) *text == '<' ? fputs("\\u003c", out) : fputc(*text, out);
}

static bool write_page(const struct replay *r, json_t *meta, const char *path) {
    char aside[MAX_PATH + 8];
    const char *m = strstr(replay_page, "@META@"), *d = strstr(replay_page, "@DATA@");
    char *text = json_dumps(meta, JSON_COMPACT);
    snprintf(aside, sizeof aside, "%s.tmp", path);
    FILE *out = fopen(aside, "wb");
    if (out && text) {
        fwrite(replay_page, 1, (size_t)(m - replay_page), out);
        write_script(out, text);
        fwrite(m + 6, 1, (size_t)(d - m - 6), out);
        write_base64(out, r->packed, r->size);
        fputs(d + 6, out);
    }
    free(text);
    bool good = out && !ferror(out);
    if (out && fclose(out)) good = false;
    if (good && !rename(aside, path)) return true;
    fprintf(stderr, "projdyn: %s: %s\n", path, strerror(errno));
    remove(aside);
    return false;
}

static int make(struct replay *r, const char *output) {
    json_t *bodies = json_array(), *meta = NULL;
    int code = EXIT_BAD_INPUT;
    deflateInit(&r->stream, 6);
    if (find_bodies(r)) {
        read_report(r);
        if (measure(r) && pack_all(r, bodies)) {
            meta = meta_of(r, bodies);
            code = write_page(r, meta, output) ? EXIT_GOOD : EXIT_FAILED;
        }
    }
    deflateEnd(&r->stream);
    json_decref(meta);
    json_decref(bodies);
    json_decref(r->report);
    for (int b = 0; b < r->bodies; b++) {
        json_decref(r->body[b].files);
        free(r->body[b].last);
    }
    free(r->packed);
    return code;
}

int replay_main(int argc, char **argv) {
    static const struct option long_options[] = {
        {"output", required_argument, NULL, 'o'}, {"help", no_argument, NULL, 'h'}, {0}};
    static const char usage[] =
        "Usage: projdyn replay DIR [-o FILE]\n\n"
        "Packs the frames in DIR, as 'projdyn run' wrote them, into one HTML page\n"
        "(default DIR/replay.html) that opens in Firefox and Chromium.\n";
    static struct replay replay;
    char path[MAX_PATH];
    const char *output = NULL;
    int option;
    while ((option = getopt_long(argc, argv, "o:h", long_options, NULL)) != -1) {
        if (option == 'h') fputs(usage, stdout);
        if (option != 'o') return option == 'h' ? EXIT_GOOD : EXIT_BAD_INPUT;
        output = optarg;
    }
    if (argc - optind != 1) {
        fputs(usage, stderr);
        return EXIT_BAD_INPUT;
    }
    replay.directory = argv[optind];
    snprintf(path, sizeof path, "%s/replay.html", replay.directory);
    if (!output) output = path;
    int code = make(&replay, output);
    if (code == EXIT_GOOD) printf("%d frames packed into %s\n", replay.frames, output);
    return code;
}
