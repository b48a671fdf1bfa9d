/* The simulation of a live view: loading, steps, the clock. */
#include "live.h"
#include "first_page.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum { LONGEST_LAG_MS = 250 }; /* a simulation further behind the clock does not catch up */

int live_open(struct live *live, const struct scene_options *scene, char **page) {
    *live = (struct live){.scene = scene, .running = true, .stale = true, .held = -1, .starts = 1};
    live->notes = json_array();
    live->told = json_object();
    if (!live->notes || !live->told) return report_no_memory();
    int code = scene_load(scene, &live->context, &live->sim);
    return code == EXIT_GOOD ? first_page_make(live, page) : code;
}

void live_close(struct live *live) {
    run_close(&live->run);
    json_decref(live->notes);
    json_decref(live->told);
    pdyn_free(live->sim);
    pdyn_destroy(live->context);
}

void live_note(struct live *live, bool bad, const char *format, ...) {
    char *text;
    va_list args;
    va_start(args, format);
    int length = vasprintf(&text, format, args);
    va_end(args);
    live->stale = true;
    if (length < 0) return;
    json_array_append_new(live->notes, json_pack("{s:s, s:b}", "text", text, "bad", bad));
    free(text);
}

/* Whether two simulations have the same bodies and solids, of as many points and triangles. */
static bool have_same_parts(const pdyn_sim *a, const pdyn_sim *b) {
    for (int k = 0;; k++) {
        pdyn_body_info one = pdyn_get_body(a, k), other = pdyn_get_body(b, k);
        if (!one.name && !other.name) break;
        if (!one.name || !other.name || strcmp(one.name, other.name)) return false;
        if (one.count != other.count || one.triangles != other.triangles) return false;
    }
    for (int k = 0;; k++) {
        const char *one = pdyn_solid_name(a, k), *other = pdyn_solid_name(b, k);
        if (!one && !other) return true;
        if (!one || !other || strcmp(one, other)) return false;
        if (pdyn_solid_vertices(a, k, NULL) != pdyn_solid_vertices(b, k, NULL)) return false;
    }
}

void live_restart(struct live *live) {
    const struct scene_options *scene = live->scene;
    pdyn_sim *sim;
    pdyn_status status = pdyn_load(live->context, scene->scene, scene->set, scene->sets, &sim);
    if (status != PDYN_OK) {
        live_note(live, true, "%s", pdyn_last_error(live->context));
        return;
    }
    if (!have_same_parts(live->sim, sim)) {
        live_note(live, true, "%s has other bodies or solids, which need a new `projdyn view`",
                  scene->scene);
        pdyn_free(sim);
        return;
    }
    pdyn_free(live->sim);
    live->sim = sim;
    live->step = (pdyn_step_info){0};
    live->steps = 0;
    live->step_ms = live->clock_s = 0.0;
    live->starts++;
    live->held = -1;
    live->failed = live->single = false;
    live->stale = true;
}

void live_step(struct live *live) {
    double start = wall_seconds();
    pdyn_status status = pdyn_step(live->sim, &live->step);
    live->step_ms = 1e3 * (wall_seconds() - start);
    live->running &= !live->single;
    live->single = false;
    live->stale = true;
    if (status == PDYN_OK) {
        live->steps++;
        return;
    }
    live->failed = true;
    live->running = false;
    live_note(live, true, "%s", pdyn_last_error(live->context));
}

double live_due(struct live *live) {
    double now = wall_seconds(), time = pdyn_time(live->sim);
    if (!live->real_time || live->single) return 0.0;
    if (live->clock_s + time < now - 1e-3 * LONGEST_LAG_MS) live->clock_s = now - time;
    return live->clock_s + time;
}
