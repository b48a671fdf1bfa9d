/* A scene as read from its JSON file, checked and with all defaults filled in: plain data, nothing
 * simulated yet. scene_read is the only place that sees text; build.c turns a scene into a
 * pdyn_sim. */
#ifndef PDYN_SCENE_H
#define PDYN_SCENE_H

#include "base/context.h"
#include "geometry/mesh.h"
#include "geometry/point_list.h"
#include "geometry/primitives.h"
#include "geometry/tets.h"
#include "projdyn/module.h"

struct scene_inlet {         /* lets one layer of particles in after the other, a spacing apart */
    double direction[3];     /* of length 1 */
    double speed;            /* m/s */
    double start, duration;  /* s; duration 0: until the end of the scene */
    double layers;           /* in all, whole */
    struct point_list layer; /* where its particles enter */
};

struct scene_outlet { /* removes particles */
    struct scene_box box;
    bool outside; /* those outside the box, not those inside */
};

struct scene_constraint {
    const pdyn_constraint_type *type;
    void *params; /* type->params_size bytes, filled from type->params */
};

struct scene_body {
    char *name; /* unique in the scene; letters, digits, '_', '-' (it names files) */
    /* exactly one of the two: */
    bool is_surface;
    struct mesh mesh; /* surface: rest positions in the world, after scale, rotation, translation */
    struct tets tets; /* of a surface that is the outside of a volume */
    struct point_list start, start_v; /* particles: where they begin, and how fast, m/s */
    double radius;                    /* m */
    double rest_density;              /* kg/m^3 */
    double area_density;              /* kg/m^2 */
    double fluid_friction;            /* Pa s/m, of a surface or a volume */
    double density;                   /* kg/m^3, of a volume */
    int inlets;                       /* of particles */
    struct scene_inlet *inlet;
    int budget;         /* particles that the inlets may add to those at the start */
    double velocity[3]; /* m/s, at the start; of particles, what a fill says goes first */
    int constraints;
    struct scene_constraint *constraint; /* a type at most once per body */
};

struct scene_key {       /* where a solid is at a time, from where it was put */
    double time;         /* s */
    double translate[3]; /* m */
    double rotate[3];    /* degrees about x, then y, then z, through the pivot */
};

extern const pdyn_param scene_key_params[]; /* ends with a name of NULL */

struct scene_solid {
    char *name;
    bool is_box;
    struct scene_box box;
    unsigned open;    /* bit 2 a: no face at the minimum of axis a; bit 2 a + 1: at the maximum */
    struct mesh mesh; /* in the world; of any shape */
    int keys;         /* 0: it rests */
    struct scene_key *key; /* times ascending; in between linear in all numbers, outside held */
    double pivot[3];       /* m, in the world */
};

struct scene_contact {
    double thickness; /* m: surfaces keep about this distance */
    double friction;  /* coefficient */
    double stiffness; /* N/m, of a pair at its thickness */
    bool self;        /* surfaces touch themselves */
};

extern const pdyn_param scene_contact_params[]; /* ends with a name of NULL */

struct acceleration_type;
struct integrator;

struct scene_settings {    /* the scene's own "solver" and "time_step" and general values */
    double gravity[3];     /* m/s^2 */
    double duration;       /* s */
    double frame_interval; /* s */
    double h_fixed;        /* s; 0: adaptive by the CFL condition */
    double h_min, h_max;   /* s */
    double cfl;            /* particle radii that a particle may travel in a step */
    const struct integrator *integrator;
    const struct boundary_model *boundary;
    int retries;                                  /* of a step that cannot be taken */
    double tolerance;                             /* step residual at which a step is solved */
    int outer_iterations;                         /* cap */
    double linear_tolerance;                      /* |r| / |r_0| of the linear solve */
    int linear_iterations;                        /* cap */
    bool newton;                                  /* step: "newton", otherwise "projective" */
    const struct acceleration_type *acceleration; /* of the projective step */
    char solver_type[32];                         /* "auto" or a registered solver */
};

struct scene {
    char *file;           /* as named by the user, for messages and the report */
    char *name;           /* "name" of the scene; may be empty */
    uint64_t fingerprint; /* of all values in the file but its name and duration */
    struct scene_settings settings;
    bool has_contact;
    struct scene_contact contact;
    int bodies, solids, outlets;
    struct scene_body *body;
    struct scene_solid *solid;
    struct scene_outlet *outlet;
};

/* Reads and checks a scene. Meshes are found relative to the scene file's folder. `text` NULL: read
 * the file `path`; otherwise `path` only names the text in messages. On failure *out is empty and
 * the error says: FILE:LINE:COLUMN: JSON path: what was found, what was expected. */
pdyn_status scene_read(pdyn_context *context, const char *path, const char *text,
                       const char *const *set, int sets, struct scene *out);
void scene_free(pdyn_context *context, struct scene *scene);

#endif
