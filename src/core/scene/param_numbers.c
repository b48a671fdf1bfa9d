/* Numbers within bounds, and boxes and spheres of numbers. */
#include "base/scan.h"
#include "base/text.h"
#include "geometry/sampling.h"
#include "params.h"

#include <limits.h>
#include <math.h>
#include <string.h>

enum { WHAT = 128 };

void params_describe_bounds(char *text, size_t size, const char *what, double min, double max,
                            const char *unit) {
    bool low = min > -HUGE_VAL, high = max < HUGE_VAL, named = *unit && strcmp(unit, "1") != 0;
    text_append(text, size, "%s", what);
    if (low && high) text_append(text, size, " from %.10g to %.10g", min, max);
    else if (low) text_append(text, size, " of at least %.10g", min);
    else if (high) text_append(text, size, " of at most %.10g", max);
    if (named) text_append(text, size, low || high ? " %s" : " (%s)", unit);
}

/* A text that is a number, as .1 or "0.1", has a hint how JSON writes it. */
static pdyn_status expected_number(const struct json_at *at, const char *what, double min,
                                   double max, const char *unit) {
    char text[WHAT] = "";
    const char *found = json_string_value(at->value);
    double meant;
    params_describe_bounds(text, sizeof text, what, min, max, unit);
    if (found && word_number((struct word){found, strlen(found)}, &meant) && isfinite(meant))
        return json_fail(at, "expected %s, found \"%.40s\"; JSON writes %.15g", text, found, meant);
    return json_expected(at, text);
}

pdyn_status params_real(const struct json_at *at, double min, double max, const char *unit,
                        double *out) {
    *out = json_number_value(at->value);
    if (json_is_number(at->value) && *out >= min && *out <= max) return PDYN_OK;
    return expected_number(at, "a number", min, max, unit);
}

pdyn_status params_int(const struct json_at *at, double min, double max, int *out) {
    min = fmax(min, INT_MIN), max = fmin(max, INT_MAX);
    double value = json_number_value(at->value); /* 30.0 is a whole number, too */
    bool fits = json_is_number(at->value) && value == floor(value) && value >= min && value <= max;
    *out = fits ? (int)value : 0;
    if (fits) return PDYN_OK;
    return expected_number(at, "a whole number", min, max, "");
}

pdyn_status params_counts(const struct json_at *at, int count, double min, int *out) {
    char text[WHAT] = "";
    text_append(text, sizeof text, "an array of %d whole numbers", count);
    if (json_array_size(at->value) != (size_t)count) return json_expected(at, text);
    pdyn_status status = PDYN_OK;
    for (int k = 0; k < count && status == PDYN_OK; k++) {
        struct json_at element = json_element(at, (size_t)k);
        status = params_int(&element, min, MAX_PARTICLES, &out[k]);
    }
    return status;
}

pdyn_status params_reals(const struct json_at *at, int count, double min, double max,
                         const char *unit, double *out) {
    char text[WHAT] = "";
    if (!json_is_array(at->value) || json_array_size(at->value) != (size_t)count) {
        text_append(text, sizeof text, "an array of %d numbers", count);
        if (*unit && strcmp(unit, "1") != 0) text_append(text, sizeof text, " (%s)", unit);
        return json_expected(at, text);
    }
    pdyn_status status = PDYN_OK;
    for (int k = 0; k < count && status == PDYN_OK; k++) {
        struct json_at element = json_element(at, (size_t)k);
        status = params_real(&element, min, max, unit, &out[k]);
    }
    return status;
}

pdyn_status params_box(const struct json_at *at, struct box *box) {
    static const pdyn_param table[] = {
        {"minimum", PDYN_VECTOR, offsetof(struct box, min), true, 0, -SCENE_MAX_POSITION,
         SCENE_MAX_POSITION, "m", ""},
        {"maximum", PDYN_VECTOR, offsetof(struct box, max), true, 0, -SCENE_MAX_POSITION,
         SCENE_MAX_POSITION, "m", ""},
        {0},
    };
    pdyn_status status = params_read_object(at, table, box);
    for (int a = 0; a < 3 && status == PDYN_OK; a++) {
        struct json_at maximum = json_member(at, "maximum"),
                       entry = json_element(&maximum, (size_t)a);
        if (!(box->max[a] > box->min[a]))
            status =
                json_fail(&entry, "expected a number above the minimum, %.10g m, found %.10g m",
                          box->min[a], box->max[a]);
    }
    return status;
}

pdyn_status params_sphere(const struct json_at *at, struct sphere *sphere) {
    static const pdyn_param table[] = {
        {"center", PDYN_VECTOR, offsetof(struct sphere, center), true, 0, -SCENE_MAX_POSITION,
         SCENE_MAX_POSITION, "m", ""},
        {"radius", PDYN_REAL, offsetof(struct sphere, radius), true, 0, 0, SCENE_MAX_POSITION, "m",
         ""},
        {0},
    };
    return params_read_object(at, table, sphere);
}
