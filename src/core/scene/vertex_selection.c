/* Reading a selection of vertices. */
#include "vertex_selection.h"

#include "geometry/sampling.h"
#include "params.h"

#include "projdyn/vec3.h"

#include <string.h>

struct selection {
    pdyn_context *context;
    const struct mesh *surface;
    bool *selected; /* vertices */
};

static pdyn_status expect_true(const struct json_at *at) {
    return json_is_true(at->value) ? PDYN_OK : json_expected(at, "true");
}

static pdyn_status select_all(const struct json_at *at, struct selection *c) {
    memset(c->selected, true, (size_t)c->surface->vertices * sizeof *c->selected);
    return expect_true(at);
}

static pdyn_status select_border(const struct json_at *at, struct selection *c) {
    struct topology topology;
    pdyn_status status = expect_true(at);
    if (status == PDYN_OK) status = topology_build(c->context, c->surface, &topology);
    if (status != PDYN_OK) return status;
    for (int v = 0; v < c->surface->vertices; v++) c->selected[v] |= topology.on_border[v];
    topology_free(c->context, &topology);
    return PDYN_OK;
}

static pdyn_status select_listed(const struct json_at *at, struct selection *c) {
    if (!json_is_array(at->value)) return json_expected(at, "an array of vertex numbers");
    for (size_t k = 0; k < json_array_size(at->value); k++) {
        struct json_at element = json_element(at, k);
        int v;
        pdyn_status status = params_int(&element, 0, c->surface->vertices - 1, &v);
        if (status != PDYN_OK) return status;
        c->selected[v] = true;
    }
    return PDYN_OK;
}

static pdyn_status select_box(const struct json_at *at, struct selection *c) {
    struct box box;
    pdyn_status status = params_box(at, &box);
    for (int v = 0; v < c->surface->vertices && status == PDYN_OK; v++)
        c->selected[v] |= box_contains(&box, c->surface->vertex + 3 * v);
    return status;
}

static pdyn_status select_sphere(const struct json_at *at, struct selection *c) {
    struct sphere sphere;
    pdyn_status status = params_sphere(at, &sphere);
    for (int v = 0; v < c->surface->vertices && status == PDYN_OK; v++)
        c->selected[v] |= vec3_distance(c->surface->vertex + 3 * v, sphere.center) <= sphere.radius;
    return status;
}

static const char *const selector_names[] = {"all", "vertices", "box", "sphere", "border", NULL};
static pdyn_status (*const selectors[])(const struct json_at *at, struct selection *c) = {
    select_all, select_listed, select_box, select_sphere, select_border};

static pdyn_status select_vertices(const struct json_at *at, struct selection *c) {
    if (!json_is_object(at->value))
        return json_expected(at, "an object that selects vertices, such as {\"vertices\": [0, 4]}");
    pdyn_status status = params_check_keys(at, NULL, selector_names);
    if (status == PDYN_OK && json_object_size(at->value) != 1)
        status = json_fail(
            at,
            "expected exactly one of \"all\", \"vertices\", \"box\", \"sphere\", \"border\""
            ", found %zu keys",
            json_object_size(at->value));
    for (int k = 0; selector_names[k] && status == PDYN_OK; k++) {
        struct json_at selected = json_member(at, selector_names[k]);
        if (selected.value) status = selectors[k](&selected, c);
    }
    return status;
}

static pdyn_status select_each(const struct json_at *at, struct selection *c) {
    if (!json_is_array(at->value)) return select_vertices(at, c);
    pdyn_status status = PDYN_OK;
    for (size_t k = 0; k < json_array_size(at->value) && status == PDYN_OK; k++) {
        struct json_at element = json_element(at, k);
        status = select_vertices(&element, c);
    }
    return status;
}

static pdyn_status list_chosen(const struct json_at *at, const struct selection *c,
                               pdyn_vertices *out) {
    int count = 0;
    for (int v = 0; v < c->surface->vertices; v++) count += c->selected[v];
    if (!count) return json_fail(at, "selects none of %d vertices", c->surface->vertices);
    int *index = NEW_ARRAY(c->context, count, int);
    if (!index) return PDYN_NO_MEMORY;
    *out = (pdyn_vertices){count, index};
    for (int v = 0; v < c->surface->vertices; v++)
        if (c->selected[v]) *index++ = v;
    return PDYN_OK;
}

pdyn_status vertex_selection_read(const struct json_at *at, const struct mesh *surface,
                                  pdyn_vertices *out) {
    if (!json_is_object(at->value) && !json_is_array(at->value))
        return json_expected(at, "an object that selects vertices, such as {\"all\": true}, or an "
                                 "array of such objects");
    if (!surface) return json_fail(at, "vertices can be selected on a surface only");
    struct selection c = {at->file->context, surface,
                          NEW_ARRAY(at->file->context, surface->vertices, bool)};
    if (!c.selected) return PDYN_NO_MEMORY;
    pdyn_status status = select_each(at, &c);
    if (status == PDYN_OK) status = list_chosen(at, &c, out);
    FREE_ARRAY(c.context, c.selected, surface->vertices);
    return status;
}
