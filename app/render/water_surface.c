/* Hands the surfaces of fluids to the page: the call setSurface(BODY, X, NORMAL, TRIANGLE) with
 * arrays in base64, little endian as the processors that projdyn runs on. */
#include "water_surface.h"

#include "replay_stream.h"
#include "surface_make.h"

#include <stdlib.h>

static int evaluate(struct browser *browser, const char *expression, bool *answer) {
    json_t *value;
    int code = browser_evaluate(browser, expression, &value);
    if (code != EXIT_GOOD) return code;
    *answer = *json_string_value(value);
    json_decref(value);
    return EXIT_GOOD;
}

static void add_array(struct stream *stream, const void *numbers, size_t count) {
    stream_text(stream, ", \"", 3);
    stream_base64(stream, numbers, 4 * count);
    stream_text(stream, "\"", 1);
}

static int send_surface(struct browser *browser, int body, const struct surface *surface) {
    static struct stream stream; /* static: 48 KiB are too much for a stack */
    char *text = NULL;
    size_t size, vertices = (size_t)surface->vertices;
    bool answer;
    stream = (struct stream){.file = open_memstream(&text, &size)};
    if (!stream.file) return report_no_memory();
    fprintf(stream.file, "setSurface(%d", body);
    add_array(&stream, surface->x, 3 * vertices);
    add_array(&stream, surface->normal, 3 * vertices);
    add_array(&stream, surface->triangle, 3 * (size_t)surface->triangles);
    stream_text(&stream, ")", 1);
    bool good = !fclose(stream.file) && !stream.failed;
    int code = good ? evaluate(browser, text, &answer) : report_no_memory();
    free(text);
    return code;
}

/* Vertices at obstacles get no normal: the page takes that of the triangle. */
static void flatten(struct surface *surface) {
    for (int v = 0; v < surface->vertices; v++)
        for (int a = 0; a < 3 && surface->walls[v]; a++)
            surface->normal[3 * (size_t)v + (size_t)a] = 0.0f;
}

int water_surface_send(struct browser *browser, const struct run *run, int frame) {
    bool wanted;
    int code = evaluate(browser, "drawsMeshes() ? 'yes' : ''", &wanted);
    if (code != EXIT_GOOD || !wanted) return code;
    for (int b = 0; b < run->parts && code == EXIT_GOOD; b++) { /* bodies are the first parts */
        struct surface surface;
        if (!run->part[b].fluid) continue;
        code = surface_make(run, &run->part[b], frame, false, usable_cores(), &surface);
        if (code == EXIT_GOOD) {
            flatten(&surface);
            code = send_surface(browser, b, &surface);
        }
        surface_free(&surface);
    }
    return code;
}
