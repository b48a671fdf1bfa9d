/* Reads the frames of a run once more and streams them, quantised and compressed, into the page. */
#include "replay.h"
#include "replay_run.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

enum { CHUNK = 3 << 14, PLANES = 5 };

/* One number per point over time: quantised, coded against what the frames before predict. */
struct plane {
    bool wide;                        /* 16 bits, otherwise 8 */
    uint16_t *now, *before, *earlier; /* count */
};

/* What goes through deflate and base64 into the page. Errors stay until they are asked for. */
struct page {
    FILE *file;
    z_stream deflate;
    bool failed;
    struct plane (*plane)[PLANES]; /* of each part: x, y, z; if shaded also speed, density error */
    unsigned char packed[CHUNK];
};

/* ---- the page's data ------------------------------------------------------------------------- */

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

/* ---- planes ---------------------------------------------------------------------------------- */

static int planes_of(const struct body *body) { return body->shaded ? PLANES : 3; }

static int make_planes(const struct run *run, struct page *page) {
    page->plane = calloc((size_t)run->parts, sizeof *page->plane);
    if (!page->plane) return replay_no_memory();
    for (int b = 0; b < run->parts; b++) {
        size_t count = (size_t)run->body[b].count + 1; /* of particles that never came, too */
        for (int p = 0; p < planes_of(&run->body[b]); p++) {
            struct plane *plane = &page->plane[b][p];
            plane->wide = p < 3;
            plane->now = calloc(count, sizeof *plane->now);
            plane->before = calloc(count, sizeof *plane->before);
            plane->earlier = calloc(count, sizeof *plane->earlier);
            if (!plane->now || !plane->before || !plane->earlier) return replay_no_memory();
        }
    }
    return EXIT_GOOD;
}

static void free_planes(const struct run *run, struct page *page) {
    for (int b = 0; b < run->parts && page->plane; b++)
        for (int p = 0; p < PLANES; p++) {
            free(page->plane[b][p].now);
            free(page->plane[b][p].before);
            free(page->plane[b][p].earlier);
        }
    free(page->plane);
}

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
static void quantise_frame(const struct run *run, const struct body *body, struct plane *plane,
                           const struct vtk_frame *frame) {
    for (int p = 0; p < planes_of(body); p++)
        memset(plane[p].now, 0, (size_t)body->count * sizeof *plane[p].now);
    for (int i = 0; i < frame->count; i++) {
        for (int k = 0; k < 3; k++)
            plane[k].now[i] =
                quantise(frame->x[3 * i + k], run->box.min[k], run->box.max[k], 65535.0);
        if (!frame->density) continue;
        plane[3].now[i] = quantise(sqrt(replay_speed(frame, i)), 0.0, sqrt(body->max_speed), 255.0);
        plane[4].now[i] =
            quantise(sqrt(replay_density_error(body, frame, i)), 0.0, sqrt(body->max_error), 255.0);
    }
}

static int pack_frame(const struct run *run, struct page *page, int b, int f) {
    const struct body *body = &run->body[b];
    struct plane *plane = page->plane[b];
    char path[REPLAY_PATH];
    struct vtk_frame frame;
    int code = replay_read_frame(run, b, f, path, &frame);
    if (code != EXIT_GOOD) return code;
    code = replay_check_frame(body, &frame, path);
    if (code == EXIT_GOOD && frame.count != body->points[f])
        code = replay_fail("%s: expected %d points as a moment ago, found %d", path,
                           body->points[f], frame.count);
    unsigned char *scratch = malloc(2 * (size_t)body->count + 1);
    if (code == EXIT_GOOD && !scratch) code = replay_no_memory();
    if (code == EXIT_GOOD) {
        quantise_frame(run, body, plane, &frame);
        for (int p = 0; p < planes_of(body); p++)
            pack_plane(page, &plane[p], body->count, f, scratch);
    }
    free(scratch);
    vtk_frame_free(&frame);
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

static int pack_all(const struct run *run, struct page *page) {
    page->deflate = (z_stream){.next_out = page->packed, .avail_out = CHUNK};
    if (deflateInit(&page->deflate, Z_DEFAULT_COMPRESSION) != Z_OK) return replay_no_memory();
    int code = make_planes(run, page);
    for (int b = 0; b < run->count; b++) pack_triangles(page, &run->body[b]);
    pack_boundary(page, run);
    for (int f = 0; f < run->frames && code == EXIT_GOOD && !page->failed; f++)
        for (int b = 0; b < run->parts && code == EXIT_GOOD; b++)
            code = pack_frame(run, page, b, f);
    if (code == EXIT_GOOD) pack(page, NULL, 0, Z_FINISH);
    deflateEnd(&page->deflate);
    free_planes(run, page);
    return code;
}

/* ---- the page -------------------------------------------------------------------------------- */

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
    const json_t *step = json_object_get(run->report, "time_step");
    json_t *integrator = json_object_get(step, "integrator");
    if (json_is_string(integrator)) json_object_set(about, "integrator", integrator);
    for (int f = 0; f < run->frames; f++)
        json_array_append_new(times, json_real(replay_time(&run->body[0], f)));
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
    if (!text) return replay_no_memory();
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
static int write_page(const struct run *run, struct page *page) {
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
    replay_fail("%s: %s: %s", path, what, strerror(errno));
    return EXIT_FAILED;
}

/* Written aside: the page appears whole or not at all. What is no regular file is written directly.
 */
int replay_write(const struct run *run, const char *path) {
    static struct page page; /* too large for a stack */
    char aside[REPLAY_PATH];
    struct stat info;
    bool special = lstat(path, &info) == 0 && !S_ISREG(info.st_mode);
    int length = snprintf(aside, sizeof aside, "%s%s", path, special ? "" : ".tmp");
    if (length < 0 || length >= REPLAY_PATH) return replay_fail("%s: the path is too long", path);
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
