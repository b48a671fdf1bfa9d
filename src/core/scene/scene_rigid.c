/* Reading a rigid body: its shape, mass properties and rotation. */
#include "file_ref.h"
#include "filled_mesh.h"
#include "params.h"
#include "primitive_mesh.h"
#include "scene_body.h"
#include "transform.h"

#include "projdyn/box.h"
#include "projdyn/svd3.h"
#include "projdyn/vec3.h"

#include <string.h>

/* ---- shape ----------------------------------------------------------------------------------- */

static pdyn_status read_box(const struct json_at *at, double bump, struct mesh *mesh,
                            double middle[3]) {
    struct box box;
    (void)bump, (void)middle;
    pdyn_status status = params_box(at, &box);
    return status == PDYN_OK ? primitive_box(at->file->context, &box, 0, mesh) : status;
}

enum { MESH, SHAPES = 4 };
static const char *const shapes[SHAPES] = {"mesh", "box", "sphere", "capsule"};
static primitive_read_fn *const primitives[SHAPES] = {NULL, read_box, primitive_read_sphere,
                                                      primitive_read_capsule};

/* Checks that edges have two triangles, and turns triangles and pieces to face the same way. */
static pdyn_status check_surface(struct reader *r, const struct mesh *mesh) {
    pdyn_status status = mesh_check_cloth(r->context, mesh, "as placed");
    if (status == PDYN_OK) status = reader_orient_pieces(r);
    return status == PDYN_OK ? mesh_check_oriented(r->context, mesh, "as placed") : status;
}

static pdyn_status check_mesh(struct reader *r, const struct mesh *mesh) {
    pdyn_status status = mesh_check(mesh, "as placed");
    if (status == PDYN_OK) status = mesh_check_closed(r->context, mesh, "as placed");
    if (status != PDYN_OK) return status;
    status = check_surface(r, mesh);
    if (status != PDYN_BAD_INPUT) return status;
    return set_error(status, "%s; \"cell\" makes a surface without such faults",
                     pdyn_last_error(NULL));
}

/* Reads and places one of the shapes. */
static pdyn_status place_shape(struct reader *r, const struct json_at *at, int shape,
                               const struct transform *transform) {
    struct mesh *mesh = &r->body->mesh;
    double larger = fmax(fmax(transform->scale[0], transform->scale[1]), transform->scale[2]);
    double unused[3];
    pdyn_status status = shape == MESH
                             ? file_ref_mesh(at, mesh, &r->body->obj)
                             : primitives[shape](at, reader_bump(r) / larger, mesh, unused);
    if (status == PDYN_OK) transform_points(transform, mesh->vertex, mesh->vertices);
    return status;
}

static pdyn_status read_shape(struct reader *r, const struct json_at *at,
                              struct transform *transform) {
    int shape;
    pdyn_status status = reader_one_of(at, shapes, SHAPES, &shape);
    if (status == PDYN_OK) status = transform_read(at, 1e-6, transform);
    if (status != PDYN_OK) return status;
    struct json_at shape_at = json_member(at, shapes[shape]), cell = json_member(at, "cell");
    if (cell.value && shape != MESH) return json_fail_at_key(&cell, "\"cell\" needs a \"mesh\"");
    if (cell.value) status = filled_mesh_read_surface(&shape_at, &cell, transform, r->body);
    else status = place_shape(r, &shape_at, shape, transform);
    if (status == PDYN_OK)
        status = reader_add_particles(r, &shape_at, r->body->mesh.vertices + (double)RIGID_POINTS);
    return status == PDYN_OK ? json_wrap(&shape_at, check_mesh(r, &r->body->mesh)) : status;
}

/* ---- mass ------------------------------------------------------------------------------------ */

/* Four points of mass m/4 have the second moments m Q diag(d^2) Q' at c + Q diag(d) t, where t are
 * alternate corners of the cube of edge 2. */
static void place_points(struct scene_body *body, const double second[9]) {
    static const double corner[RIGID_POINTS][3] = {
        {1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    const svd3 axes = svd3_of(second);
    for (int a = 0; a < RIGID_POINTS; a++) {
        memcpy(body->point[a], body->centre, sizeof body->centre);
        for (int k = 0; k < 3; k++)
            vec3_add(body->point[a], corner[a][k] * sqrt(axes.s[k]), axes.right[k]);
    }
}

/* Smallest extent of a body over its largest: its inertia tensor is known to six digits then. */
static const double flattest = 1e-5;

static pdyn_status weigh(const struct json_at *at, struct scene_body *body) {
    double second[9], volume = mesh_moments(&body->mesh, body->centre, second);
    if (volume < 0.0) mesh_turn(&body->mesh);
    volume = fabs(volume);
    if (!(volume > 0.0)) return json_fail(at, "the mesh encloses no volume");
    const svd3 axes = svd3_of(second);
    if (!(axes.s[2] > flattest * flattest * axes.s[0]))
        return json_fail(at,
                         "the body is too flat: its extent along one axis is less than %g of "
                         "its length",
                         flattest);
    if (body->density > 0.0) body->mass = body->density * volume;
    body->density = body->mass / volume;
    place_points(body, second);
    return PDYN_OK;
}

/* "center_of_mass", a place in the shape as it is given: ballast moves the mass there, with the
 * inertia tensor that it has about its centre. */
static pdyn_status move_centre(const struct json_at *at, const struct transform *transform,
                               struct scene_body *body) {
    struct json_at centre = json_member(at, "center_of_mass");
    double x[3], moved[3];
    if (!centre.value) return PDYN_OK;
    pdyn_status status = params_reals(&centre, 3, -SCENE_MAX_POSITION, SCENE_MAX_POSITION, "m", x);
    if (status != PDYN_OK) return status;
    struct box box = box_around(body->mesh.vertex, body->mesh.vertices);
    transform_points(transform, x, 1);
    if (!box_contains(&box, x))
        return json_fail(&centre,
                         "expected a place inside of the body, found (%g, %g, %g) m as "
                         "placed, outside of its bounds",
                         x[0], x[1], x[2]);
    vec3_subtract(moved, x, body->centre);
    for (int k = 0; k < RIGID_POINTS; k++) vec3_add(body->point[k], 1.0, moved);
    memcpy(body->centre, x, sizeof x);
    return PDYN_OK;
}

/* ---- the body -------------------------------------------------------------------------------- */

/* 0: absent; one of density and mass is given. */
static const pdyn_param params[] = {
    {"density", PDYN_REAL, offsetof(struct scene_body, density), false, 0, 1e-6, 1e6, "kg/m^3", ""},
    {"mass", PDYN_REAL, offsetof(struct scene_body, mass), false, 0, 1e-12, 1e12, "kg", ""},
    {"angular_velocity", PDYN_VECTOR, offsetof(struct scene_body, angular_velocity), false, 0, -1e6,
     1e6, "rad/s", ""},
    {"fluid_friction", PDYN_REAL, offsetof(struct scene_body, fluid_friction), false, 0, 0, 1e9,
     "Pa s/m", ""},
    {0}};

static const char *const others[] = {"mesh",  "cell",   "box",       "sphere",         "capsule",
                                     "scale", "rotate", "translate", "center_of_mass", NULL};

static pdyn_status read(struct reader *r, const struct json_at *at) {
    static const char *const masses[] = {"density", "mass"};
    struct scene_body *body = r->body;
    struct transform transform;
    body->has_mesh = body->is_rigid = true;
    pdyn_status status = reader_one_of(at, masses, 2, NULL);
    if (status == PDYN_OK) status = read_shape(r, at, &transform);
    if (status == PDYN_OK) status = weigh(at, body);
    return status == PDYN_OK ? move_centre(at, &transform, body) : status;
}

const struct scene_kind scene_rigid = {"rigid", params, others, read};
