/* A scene as read from its JSON values: plain data, checked, with all defaults filled in.
 * src/core/setup/build.c turns a scene into a simulation. */
#ifndef PDYN_SCENE_H
#define PDYN_SCENE_H

#include "base/context.h"
#include "geometry/mesh.h"
#include "geometry/point_list.h"
#include "geometry/tets.h"
#include "projdyn/box.h"
#include "projdyn/module.h"
#include "sources.h"

struct json_file;

enum { RIGID_POINTS = 4 };  /* particles that carry a rigid body */
enum { FINGERPRINTS = 12 }; /* keys of a scene that a saved state belongs to (fingerprint.h) */
enum {
    MAX_PARTICLES = 1 << 27,      /* of a scene */
    MAX_FLUID_PARTICLES = 1 << 25 /* of a fluid: lists have 2^31 entries, 64 for each particle */
};
#define SCENE_MAX_POSITION 1e6 /* m, largest coordinate of an object that a scene places */
#define SCENE_MAX_TIME     1e6 /* s, largest time of a key */
#define SCENE_MAX_ANGLE    1e6 /* degrees, largest angle of a key */

/* Bounds of a step: a coordinate beyond them, m, or one that changes faster, m/s, has diverged. The
 * formulas of the integrators stay below ten times them, which a saved state may have. */
#define STEP_MAX_POSITION  1e9
#define STEP_MAX_SPEED     1e7
#define STATE_MAX_POSITION (10.0 * STEP_MAX_POSITION)
#define STATE_MAX_SPEED    (10.0 * STEP_MAX_SPEED)

struct scene_key {       /* a key of a motion, relative to the place at rest */
    double time;         /* s */
    double translate[3]; /* m */
    double rotate[3];    /* degrees about x, then y, then z, through the pivot */
};

extern const pdyn_param scene_key_params[]; /* ends with a NULL name */

struct scene_motion {      /* the pose over time: linear between keys, constant outside */
    int keys;              /* 0: at rest */
    struct scene_key *key; /* times ascending */
    double pivot[3];       /* m, world space */
};

struct scene_cover {                 /* particles of a layer that solids cover (inlet_cover.h) */
    int count;                       /* of them */
    const struct scene_solid *solid; /* that covers the first one; NULL: none */
    double first[3];                 /* m, place of that in the opening */
};

struct scene_inlet {        /* an inlet of particles: it emits layers one spacing apart */
    double direction[3];    /* unit vector of the flow */
    pdyn_path speed;        /* at least one key, of one number, m/s */
    double start, duration; /* s; duration 0: until the end of the scene */
    double end;             /* s; INFINITY: that of the scene */
    double travelled;       /* m, by the first layer until `start` */
    double area;            /* m^2, of the opening */
    struct scene_motion motion;
    struct point_list layer;     /* positions of the particles of one layer at rest, m */
    struct scene_cover left_out; /* of the layer, by solids */
    struct scene_cover covered;  /* those that stay, as the inlet or the solid moves */
};

struct scene_outlet { /* an outlet: a region in which particles are removed */
    struct box box;
    bool outside; /* removes particles outside of the box, not inside */
};

struct scene_keyed {         /* a parameter that changes over time */
    const pdyn_param *param; /* of 1 to 3 numbers; NULL: gravity */
    pdyn_path path;          /* no keys: it does not change */
    bool replaced; /* a program has set the parameter, and the keys do not count any more */
};

struct scene_constraint {
    const pdyn_constraint_type *type;
    void *params;         /* type->params_size bytes, filled by the table type->params */
    void *given;          /* `params` before type->resolve, with the same arrays; NULL without it */
    pdyn_scene_info info; /* for type->resolve */
    double from, until;   /* s: it acts in the steps that begin in this time; 0, INFINITY: always */
    int keyed_params;
    struct scene_keyed *keyed; /* parameters with keys; `params` has their first values */
};

extern const pdyn_param scene_constraint_times[]; /* ends with a NULL name */

static inline bool needs_neighbour_lists(const pdyn_constraint_type *type) {
    return type->matrix_free || type->flags & PDYN_NEIGHBOURS;
}

struct scene_fill { /* a volume of "fill" */
    int end;        /* index of the first particle behind it */
    double part;    /* of the volume, filled before overlaps are removed; 0: particles of a file */
};

struct scene_body {
    char color[8];    /* "#rrggbb", of pictures; "": none */
    char *name;       /* unique in the scene; letters, digits, '_', '-', because it names files */
    bool has_mesh;    /* a surface, volume or rigid body; otherwise a body of particles */
    struct mesh mesh; /* rest positions in world space, m: after scale, rotation and translation */
    char *obj;        /* the OBJ file that the mesh comes from; NULL: another source */
    int grid[2];      /* vertices along the sides of a grid; 0: another source */
    struct tets tets; /* of a volume, whose surface is `mesh` */
    double filled; /* volume of the tetrahedra over that of the mesh they fill; 0: another source */
    int crumbs;    /* loose pieces of these, each smaller than 8 cells */
    int missed;    /* vertices of `skin` that are far from them */
    struct mesh skin; /* the mesh that "cell" replaced, for pictures, m; no vertices: none */
    struct point_list start, start_v; /* particles: initial positions, m, and velocities, m/s */
    int fills;                        /* volumes of "fill" */
    struct scene_fill *fill;
    bool keep_overlap;   /* particles that overlap obstacles stay */
    int overlapping;     /* number of particles that overlapped with something and were left out */
    double radius;       /* m */
    double rest_density; /* kg/m^3 */
    double area_density; /* kg/m^2, of a surface */
    double fluid_friction;         /* Pa s/m, friction of a surface or a volume with the fluid */
    double permeability;           /* m/(Pa s), of a surface; 0: no fluid passes */
    double density;                /* kg/m^3, of a volume or a rigid body */
    int crossing;                  /* pieces of a closed mesh that are partly inside another one */
    bool is_rigid;                 /* a rigid body, whose surface is `mesh`: */
    double mass;                   /* kg */
    double point[RIGID_POINTS][3]; /* m: four points of a fourth of the mass each that have its
                                      centre and inertia tensor (rows/rigid_map.h) */
    double centre[3];              /* m, of its mass */
    double angular_velocity[3];    /* rad/s, at the start */
    int inlets;                    /* inlets of a body of particles */
    struct scene_inlet *inlet;
    int budget;         /* number of particles that the inlets may add to the initial ones */
    double velocity[3]; /* m/s, initial velocity; an entry of "fill" may override it */
    int constraints;
    struct scene_constraint *constraint; /* each type at most once, unless it has PDYN_SEVERAL */
};

enum solid_kind { SOLID_BOX, SOLID_MESH, SOLID_SPHERE, SOLID_CAPSULE, SOLID_PLANE, SOLID_KINDS };
extern const char *const scene_solid_kinds[SOLID_KINDS]; /* "box", "mesh", ...: keys of a scene */

struct scene_solid {
    char *name;
    char color[8]; /* "#rrggbb", of pictures; "": none */
    int kind;      /* enum solid_kind */
    struct box box;
    unsigned open;  /* open faces; bit 2 a: at the minimum of axis a, bit 2 a + 1: at the maximum */
    bool is_vessel; /* a box with the fluid inside; any other solid has it on all sides */
    struct mesh mesh; /* world space, m; for solids of every shape */
    struct scene_motion motion;
};

enum probe_kind { /* what a probe measures; keys of a scene: scene_probe.c */
                  PROBE_POINT,
                  PROBE_LINE,
                  PROBE_WALL,
                  PROBE_HEIGHT,
                  PROBE_BOX,
                  PROBE_SOLID,
                  PROBE_CONSTRAINT, /* "pins", or "body" with "constraint" */
                  PROBE_INSIDE,
                  PROBE_BODY,
                  PROBE_KINDS
};

struct scene_probe {
    char *name;           /* unique among bodies, solids and probes */
    int kind;             /* enum probe_kind */
    struct point_list at; /* m, where at time 0, not of a box, solid or body */
    struct box box;       /* of PROBE_BOX, at time 0 */
    int target;           /* index of the solid, or of the body */
    /* Of PROBE_CONSTRAINT: constraints of the body of this type, NULL: all with PDYN_REACTION. */
    const pdyn_constraint_type *type;
    int number;    /* the only one of these that counts; -1: all */
    int source;    /* enum pdyn_load_source: of PROBE_SOLID and PROBE_BODY */
    int on_solid;  /* the solid that carries the place; -1: none */
    int on_body;   /* the rigid body that carries the place; -1: none */
    double radius; /* m: particles and boundary points within it count; 0: two spacings */
    double time;   /* s, time constant of an exponential mean; 0: none */
};

extern const pdyn_param scene_probe_params[]; /* ends with a NULL name */

/* Whether a probe of the kind PROBE_CONSTRAINT counts constraints of this type. */
static inline bool scene_probe_counts(const struct scene_probe *probe,
                                      const pdyn_constraint_type *type) {
    return probe->type ? type == probe->type : (type->flags & PDYN_REACTION) != 0;
}

struct scene_contact {
    double thickness; /* m, distance that surfaces keep; 0: a scene without this entry */
    double friction;  /* Coulomb friction coefficient */
    double stiffness; /* N/m, of a pair at a distance of the thickness */
    double damping;   /* of rigid bodies on their contacts, ratio to critical damping */
    bool self;        /* contact of a surface with itself */
};

extern const pdyn_param scene_contact_params[]; /* ends with a NULL name */

struct integrator;

struct scene_settings { /* "time_step", "solver" and general values of a scene */
    double gravity[3];  /* m/s^2; with keys the largest one, until a simulation has started */
    struct scene_keyed gravity_keys;
    bool z_up;             /* gravity points mostly along -z: up in pictures */
    double duration;       /* s */
    double frame_interval; /* s */
    double h_fixed;        /* s; 0: adaptive by the CFL condition */
    double h_min, h_max;   /* s */
    double cfl;            /* particle radii that a particle may travel in a step */
    const struct integrator *integrator;
    const struct boundary_model *boundary;
    const struct kernel_model *kernel;
    int retries;             /* attempts with shorter steps after one that diverged */
    double tolerance;        /* step residual (residual.h) at which a step is solved */
    int outer_iterations;    /* largest number per step */
    double linear_tolerance; /* relative residual |r| / |r_0| at which a linear solve ends */
    int linear_iterations;   /* largest number per linear solve */
    bool newton;             /* true: "step": "newton"; false: "projective" */
    char solver_type[32];    /* "auto" or the name of a registered solver */
};

/* The values of the scene itself, of "time_step" and of "solver"; each ends with a NULL name. */
extern const pdyn_param settings_general_params[], settings_time_step_params[],
    settings_solver_params[];

struct scene {
    char *file;                         /* as given by the user, for messages and the report */
    char *name;                         /* "name" of the scene; may be empty */
    uint64_t fingerprint[FINGERPRINTS]; /* for each key (fingerprint.h): hash of its value, without
                                           what may change in a run; of bodies: and of tables */
    struct sources sources;             /* its file and those that it names */
    struct scene_settings settings;
    bool has_contact;
    struct scene_contact contact;
    int bodies, solids, outlets, probes;
    struct scene_body *body;
    struct scene_solid *solid;
    struct scene_outlet *outlet;
    struct scene_probe *probe;
};

/* Reads and checks a scene; `file` stays as it is. Names of files are relative to the folder of a
 * scene file. On failure *out is empty and the error text is FILE:LINE:COLUMN: JSON path: what was
 * expected, what was found; a value that a program has set has no line and column. */
pdyn_status scene_read(const struct json_file *file, struct scene *out);
void scene_free(pdyn_context *context, struct scene *scene);

#endif
