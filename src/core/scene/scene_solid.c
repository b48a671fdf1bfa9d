/* Reading a solid: its shape, placement and motion. */
#include "file_ref.h"
#include "motion.h"
#include "params.h"
#include "primitive_mesh.h"
#include "reader.h"
#include "transform.h"

#include <string.h>

/* ---- shape ----------------------------------------------------------------------------------- */

static pdyn_status read_open_side(struct reader *r, const struct json_at *at, int index) {
    static const char *const sides[] = {"-x", "+x", "-y", "+y", "-z", "+z"};
    struct scene_solid *solid = r->solid;
    int side;
    (void)index;
    pdyn_status status = reader_choice(at, "side", sides, 6, &side);
    if (status == PDYN_OK && solid->open >> side & 1u)
        status = json_fail(at, "the side \"%s\" is given twice", sides[side]);
    if (status == PDYN_OK) solid->open |= 1u << side;
    return status;
}

static pdyn_status read_walls(struct reader *r, const struct json_at *owner,
                              const struct json_at *box) {
    struct json_at open = json_member(owner, "open");
    int sides;
    struct box *walls = &r->solid->box;
    pdyn_status status = params_box(box, walls);
    for (int a = 0; a < 3; a++) r->solid->motion.pivot[a] = 0.5 * (walls->min[a] + walls->max[a]);
    if (status == PDYN_OK) status = reader_count(&open, "an array of sides like \"+y\"", &sides);
    if (status == PDYN_OK) status = reader_each(r, &open, read_open_side);
    if (status == PDYN_OK && r->solid->open == 0x3F)
        status = json_fail(&open, "all six sides are open: no wall is left");
    if (status != PDYN_OK) return status;
    return primitive_box(r->context, walls, r->solid->open, &r->solid->mesh);
}

static pdyn_status read_placed(struct reader *r, const struct json_at *owner,
                               const struct json_at *mesh) {
    struct transform transform;
    pdyn_status status = transform_read(owner, -1e6, &transform);
    if (status == PDYN_OK) status = file_ref_mesh(mesh, &r->solid->mesh, NULL);
    if (status != PDYN_OK) return status;
    transform_points(&transform, r->solid->mesh.vertex, r->solid->mesh.vertices);
    memcpy(r->solid->motion.pivot, transform.translate, sizeof transform.translate);
    return json_wrap(mesh, mesh_check(&r->solid->mesh, "as placed"));
}

const char *const scene_solid_kinds[SOLID_KINDS] = {"box", "mesh", "sphere", "capsule", "plane"};
static primitive_read_fn *const primitives[SOLID_KINDS] = {
    NULL, NULL, primitive_read_sphere, primitive_read_capsule, primitive_read_plane};

static pdyn_status read_shape(struct reader *r, const struct json_at *owner) {
    struct json_at open = json_member(owner, "open");
    int *kind = &r->solid->kind;
    pdyn_status status = reader_one_of(owner, scene_solid_kinds, SOLID_KINDS, kind);
    if (status == PDYN_OK && *kind != SOLID_BOX && open.value)
        status = json_fail_at_key(&open, "\"open\" needs a \"box\"");
    if (status == PDYN_OK && *kind != SOLID_MESH)
        status = transform_refuse(
            owner, "a \"mesh\"; a \"motion\" with one key turns and moves other solids");
    if (status != PDYN_OK) return status;
    struct json_at shape = json_member(owner, scene_solid_kinds[*kind]);
    if (*kind == SOLID_BOX) return read_walls(r, owner, &shape);
    if (*kind == SOLID_MESH) return read_placed(r, owner, &shape);
    return primitives[*kind](&shape, reader_bump(r), &r->solid->mesh, r->solid->motion.pivot);
}

pdyn_status scene_read_solid(struct reader *r, const struct json_at *at, int index) {
    static const char *const keys[] = {"name",      "color",  "box",   "mesh",  "sphere",
                                       "capsule",   "plane",  "open",  "scale", "rotate",
                                       "translate", "motion", "pivot", NULL};
    r->solid = &r->scene->solid[index];
    pdyn_status status = params_check_keys(at, NULL, keys);
    if (status == PDYN_OK) status = reader_name(r, at, "solid", index, &r->solid->name);
    if (status == PDYN_OK) status = reader_color(at, r->solid->color);
    if (status == PDYN_OK) status = read_shape(r, at);
    return status == PDYN_OK ? motion_read(at, &r->solid->motion) : status;
}
