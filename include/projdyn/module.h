/* projdyn for authors of constraints and solvers: the tables that a module fills in. A module is a
 * file of the library or a plug-in. It calls only what these tables give it, and the C library.
 * Programs include projdyn.h, and scene.h, control.h or probe.h.
 *
 * A constraint type describes elements. An element has rows of a sparse selector G, a weight w, and
 * the projection p of u = G x (one 3-vector per row) onto the manifold of the constraint;
 * optionally the tangent J = dp/du. Core derives energy, gradient, Hessian product, block diagonal
 * and assembled matrix:
 *
 *     E(x) = 1/(2 h^2) |M^(1/2) (x - s)|^2 + sum w/2 |G x - p|^2
 *     H    = M/h^2 + sum w G' ((1 - eps) (I - J) + eps I) G
 *
 * x: positions of all particles of the system, m (particles x 3); M: masses, kg; h: effective
 * length of the step, s; s: where inertia and gravity alone take the particles, m; eps = 1: classic
 * Projective Dynamics (Bouaziz et al. 2014), 0: Newton's method (docs/theory/step.md).
 *
 * Callbacks work on a range of elements [first, last). They read only the u and p of these elements
 * and write only what belongs to them, run on any thread and in any order, keep no state of their
 * own, and cannot fail.
 *
 * A program may change parameters between two steps (pdyn_set_parameter), and keys of a scene do.
 * Core then calls `resolve`, `select` and `weight` again; a value is refused for which `resolve`
 * reports a fault, or which gives other numbers of elements or rows. */
#ifndef PROJDYN_MODULE_H
#define PROJDYN_MODULE_H

#include "projdyn.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- parameters: core reads, checks and documents them --------------------------------------- */

typedef enum pdyn_param_kind {
    PDYN_REAL,     /* double */
    PDYN_INT,      /* int */
    PDYN_BOOL,     /* bool */
    PDYN_VECTOR,   /* double[3] */
    PDYN_VERTICES, /* pdyn_vertices: chosen points of the body */
    PDYN_PATH,     /* pdyn_path: three numbers over time */
    PDYN_OTHER,    /* pdyn_other: the name of another body that has a surface */
    /* Rows of a pdyn_table; the kind is for example PDYN_TABLE(PDYN_PER_TET, 3). Rows per vertex or
     * triangle need PDYN_ON_SURFACE or PDYN_ON_VOLUME, rows per tetrahedron PDYN_ON_VOLUME. */
    PDYN_ROWS = 0x100,            /* any number of rows, at least one */
    PDYN_PER_VERTEX = 0x200,      /* one row for each vertex of the body */
    PDYN_PER_TRIANGLE = 0x300,    /* one row for each triangle */
    PDYN_PER_TET = 0x400,         /* one row for each tetrahedron */
    PDYN_VERTEX_COLUMN = 0x10000, /* of PDYN_VERTEX_TABLE, for each column of vertices */
    PDYN_LARGEST_KIND = 0xFFFFFF, /* the enumeration holds every table */
} pdyn_param_kind;

/* A pdyn_table with `width` numbers in each row, 1 to 255. */
#define PDYN_TABLE(rows, width) ((pdyn_param_kind)((rows) + (width)))

/* A pdyn_table whose rows begin with `vertices` numbers of vertices of the body, counted from its
 * first one, different ones in a row; `width` counts them, too. Core checks them; `min` and `max`
 * are bounds of the other numbers. Has no default, and needs PDYN_ON_SURFACE or PDYN_ON_VOLUME. */
#define PDYN_VERTEX_TABLE(rows, vertices, width)                                                   \
    ((pdyn_param_kind)((int)(rows) + (int)(width) + (int)(vertices) * (int)PDYN_VERTEX_COLUMN))

typedef struct pdyn_table {
    int count;           /* rows; 0: a parameter without a default that the scene does not give */
    const double *value; /* count x width, in the order of the body's arrays */
} pdyn_table;

typedef struct pdyn_vertices {
    int count;        /* chosen points */
    const int *index; /* count, counted from the body's first point, ascending */
} pdyn_vertices;

typedef struct pdyn_path { /* piecewise linear; before the first and after the last key constant */
    int count;             /* keys */
    const double *key;     /* count x 4: time in s, ascending, and three numbers in the unit of the
                              parameter */
} pdyn_path;

typedef struct pdyn_other {
    const char *name;
    const struct pdyn_body *body; /* rows may select its particles, too */
} pdyn_other;

typedef struct pdyn_param {
    const char *name;
    pdyn_param_kind kind;
    size_t offset;    /* in the parameter struct */
    bool required;    /* true: there is no default, the scene must give the parameter */
    double def;       /* default of PDYN_REAL, PDYN_INT, PDYN_BOOL and of each number of PDYN_VECTOR
                         and PDYN_TABLE; below the bounds, or not finite: the parameter is absent
                         unless the scene gives it, and has this number; above them: an error */
    double min, max;  /* bounds of the same kinds; both are allowed values */
    const char *unit; /* "N/m", "1" for a ratio, "" without a unit */
    const char *doc;
} pdyn_param;

/* The scene around a constraint when it was read, from which `resolve` computes parameters. */
typedef struct pdyn_scene_info {
    double gravity[3];   /* m/s^2 */
    double radius;       /* m, of the body's particles; 0 for a surface */
    double rest_density; /* kg/m^3, of the body's particles; 0 for a surface */
    double head;         /* m, hydrostatic head: largest height + speed^2 / (2 |gravity|) of the
                            body at its start; heights are above the lowest point of all bodies and
                            solids. With several fluids it is scaled: rest_density |gravity| head is
                            the largest hydrostatic pressure of all of them. 0 without gravity */
    const struct kernel_model *kernel; /* of the scene (kernel.h) */
    double pressure; /* Pa, estimate of the largest pressure on the body. It is the maximum of
                        density (|gravity| height + speed^2 / 2) over all bodies at their start,
                        with rest_density where that is more than their own density, and of
                        rest_density speed^2 / 2 over moving solids. 0 without gravity */
    double size;     /* m, edge of a cube with the volume of the particles of all bodies at their
                        start; 0 for a surface */
    double step;     /* s, the length of the longest step, time_step.maximum or fixed */
    int vertices, triangles, tets; /* of the body; 0 for a body of particles */
} pdyn_scene_info;

typedef struct pdyn_param_fault {
    const char *message; /* NULL: no fault */
    const char *param;   /* the parameter at fault; NULL: the constraint as a whole */
} pdyn_param_fault;

/* ---- bodies ---------------------------------------------------------------------------------- */

typedef struct pdyn_body {
    const char *name;
    int first, count;    /* its particles in the system: first to before first + count */
    const double *rest;  /* count x 3: rest positions, m */
    const double *mass;  /* count, kg */
    double radius;       /* m, particle radius; 0 for a surface */
    double rest_density; /* kg/m^3; 0 for a surface */
    double area_density; /* kg/m^2; 0 for particles */
    /* Surfaces and volumes; 0 and NULL for a body of particles. Vertices count from the body's
     * first particle. */
    int triangles;
    const int *triangle; /* triangles x 3: vertices */
    const int *across; /* triangles x 3: for each corner, the corner beyond the opposite side, as an
                          index into `triangle`; -1 where that side is on the border */
    const double *triangle_area; /* triangles, m^2 */
    const double *vertex_area;   /* count: a third of the areas of the adjacent triangles, m^2 */
    int edges;
    const int *edge;          /* edges x 2: vertices, ascending; the sides of the triangles, on a
                                 volume those of its boundary */
    const double *edge_share; /* edges: the sum over the one or two adjacent triangles of their
                                 area over their sum of squared side lengths */
    /* Volumes; 0 and NULL for other bodies. The triangles of a volume are its boundary. */
    int tets;
    const int *tet;           /* tets x 4: vertices, (b - a) x (c - a) . (d - a) > 0 */
    const double *tet_volume; /* tets, m^3 */
    double permeability;      /* m/(Pa s): velocity of a fluid through the surface for a pressure
                                 difference; 0: none passes */
} pdyn_body;

/* ---- contacts and wet sides: core finds them, constraints act on them ------------------------ */

/* Two primitives that are closer to each other than their thickness: a vertex of a surface or a
 * solid, or a particle of a fluid, and a face; or two edges. The shortest vector from the second to
 * the first is u + offset, with u = sum over k of coefficient_k x_k. */
typedef struct pdyn_contact {
    uint64_t key;          /* names the two primitives; the same in every step */
    int particle[4];       /* in the system; an arbitrary one where coefficient is 0 */
    double coefficient[4]; /* 0 for a point of a solid */
    double offset[3];      /* m: part of the shortest vector by points of solids */
    double separation[3];  /* m: the shortest vector when the contact was found */
    double side[3];        /* a direction that turns with the primitives, of any length */
    double shift[3]; /* m: change of the shortest vector by moving solids in this step; 0 in a local
                        step */
    double force;    /* N: mean normal force of the contact in the step before, with its share of
                        the dashpots of rigid bodies; 0 for a new contact, and in a local step */
    double distance; /* m: length of the shortest vector, below the thickness */
    double thickness; /* m: the distance at which contact begins */
    double share;     /* of the stiffness, up to 1; less for nearly parallel edges, whose
                         vertices touch faces in the same place */
} pdyn_contact;

/* A dashpot across the contacts of a rigid body with another one or a solid, of the beginning of
 * the step: it resists the change of u = sum over k of coefficient_k x_k along the normal. */
typedef struct pdyn_dashpot {
    int particle[8]; /* in the system: four that carry the one body, then four of the other; an
                        arbitrary one where coefficient is 0 */
    double coefficient[8];
    double normal[3]; /* length 1; contact pushes u along it */
    double damping;   /* N s/m */
    double limit;     /* N: the largest force that pulls */
    double shift;     /* m: what a solid that moves adds to u along the normal in this step */
} pdyn_dashpot;

/* Constraints with PDYN_EVERY_ITERATION see the contacts of the local step. Other constraints see
 * those of the beginning of the step, without contacts of fluid particles; their `offset` follows
 * solids that move during the step. The order is the same for any number of threads. */
typedef struct pdyn_contacts {
    double stiffness; /* N/m, of the scene's "contact" */
    double friction;  /* Coulomb's coefficient, of the scene's "contact" */
    int particles;    /* of the system; rows may select all of them */
    int count;
    const pdyn_contact *contact; /* count */
    int dashpots;                /* 0 in a local step */
    const pdyn_dashpot *dashpot; /* dashpots */
} pdyn_contacts;

/* One side of a surface's sample (pdyn_neighbours) with fluid on it when the step begins:
 * u = sum over k of coefficient_k x_k is the mean position of that fluid minus that of the sample.
 */
typedef struct pdyn_wet_side {
    int particle[19];       /* in the system: the three corners of the sample's triangle, then the
                               fluid's; an arbitrary one where coefficient is 0 */
    double coefficient[19]; /* sum 0 */
    double normal[3];       /* of the surface, length 1 */
    double along, across;   /* N s/m: force per velocity along the surface, and through it */
} pdyn_wet_side;

typedef struct pdyn_wet_sides {
    int particles; /* of the system; rows may select all of them */
    int count;
    const pdyn_wet_side *side; /* count */
} pdyn_wet_sides;

/* ---- rows tier ------------------------------------------------------------------------------- */

typedef struct pdyn_batch { /* one constraint type on one body; core owns all arrays */
    const pdyn_body *body;
    int elements;
    const int *element_row;                   /* elements + 1: first row of each element */
    const int *row_entry;                     /* rows + 1: first entry of each row */
    int *column;                              /* entries: particle in the system */
    double *coefficient;                      /* entries */
    double *weight;                           /* elements, N/m, >= 0 */
    void *data;                               /* elements x data_size: free for the type to use */
    double time;                              /* s, at the end of the step */
    double h;                                 /* s, of the step; 0 before the first */
    const double *u;                          /* rows x 3: G x */
    double *p;                                /* rows x 3: the projection of u */
    const struct pdyn_neighbours *neighbours; /* NULL in a scene without SPH sums */
    const pdyn_contacts *contacts;            /* NULL in a scene without contact */
    const pdyn_wet_sides *wet_sides;          /* NULL where no fluid rubs or passes a surface */
    uint64_t *key;                            /* elements: see `end`; NULL without memory_size */
    void *memory;                             /* elements x memory_size: see `end` */
    /* The integrator: h above is the effective length of a step of this length, s, and `begin` gets
     * x^ = x_n + extrapolation (x_n - x_(n-1)). Implicit Euler: h and 0. */
    double length, extrapolation;
    void *scratch; /* particles of the body x scratch_size: free for
                      `update` to use, not kept */
} pdyn_batch;

/* ---- saved states ---------------------------------------------------------------------------- */

/* The state of a simulation while it is written to a file or read from one. A module hands over all
 * that its next step depends on, in the same order for both. */
typedef struct pdyn_snapshot {
    bool reading;
    void (*bytes)(struct pdyn_snapshot *snapshot, void *data, size_t size);
} pdyn_snapshot;

/* ---- operator tier: for a constraint that is too large for generic rows ----------------------
 * A body of particles may have several operators, and so may several bodies of particles, which
 * then have the same radius and the same neighbour lists. A callback that is NULL is a property
 * that the operator does not have. */

typedef void pdyn_range_fn(void *arg, int first, int last, int block);

typedef struct pdyn_core pdyn_core; /* opaque to modules */

typedef struct pdyn_services { /* what core offers to operators and solvers */
    pdyn_core *core;
    /* Runs fn over [0, count) in blocks of `grain`; blocks may run in parallel. A block should take
     * some ten microseconds. */
    void (*parallel_for)(pdyn_core *core, int count, int grain, pdyn_range_fn *fn, void *arg);
    /* New memory is zeroed. block NULL allocates, new_size 0 frees. Returns NULL: no memory. */
    void *(*allocate)(pdyn_core *core, void *block, size_t old_size, size_t new_size);
    /* Sets the text of pdyn_last_error and returns the status. For the thread of the callback, not
     * within parallel_for. A callback that fails without it gets the text of the status. */
    pdyn_status (*set_error)(pdyn_core *core, pdyn_status status, const char *message);
} pdyn_services;

/* The points of SPH sums and their neighbour lists. Points are the particles of the system, then
 * samples on its surfaces, then boundary points on solids. A vector over `particles` ends with the
 * samples: their values are interpolated from the corners of their triangles, and what an operator
 * adds to them core distributes to these corners. */
typedef struct pdyn_neighbours {
    double support;           /* m: all pairs of points with volumes that are closer are listed */
    double surface_support;   /* m: the same for a fluid particle and a sample, or a boundary point
                                 that has an area */
    bool has_volumes;         /* true: samples have volumes and the kernel of particles;
                                 false: they have areas and the surface kernel */
    int particles;            /* particles of the system and samples */
    int points;               /* particles + boundary points */
    int samples;              /* the last ones of the particles */
    const int *sample_vertex; /* samples x 3: corners, particles of the system */
    const double *sample_weight; /* samples x 3: weights of the corners, sum 1 */
    const double *volume;        /* points, m^3: rest volume, or area times particle spacing; 0 for
                                    a point that takes no part in sums */
    const double *boundary_x;    /* (points - particles) x 3, m */
    /* The list of particle i in `index`: fluid particles, those of all bodies with operators, from
     * start[i] to surface_start[i], samples from there to boundary_start[i], boundary points with
     * volumes from there to patch_start[i], boundary points with areas from there to end[i]. The
     * list of a sample has fluid particles only. All five: particles. */
    const int *start, *surface_start, *boundary_start, *patch_start, *end;
    const int *index;                  /* numbers of points */
    const double *granted;             /* particles: C may exceed 0 by this; NULL: by nothing */
    unsigned revision;                 /* changes when the lists do */
    unsigned volume_revision;          /* changes when volumes do */
    unsigned boundary_revision;        /* changes when boundary points do */
    const struct kernel_model *kernel; /* of the scene (kernel.h) */
    const double *sample_share;        /* samples, m: volume over the area of the sample's triangle;
                                          `volume` has the product at the beginning of a step */
    int moving;            /* the last ones of the boundary points: those of moving solids */
    const double *layer_x; /* moving x 3, m: where the first layer of fluid rests in front of a
                              point of a box, moved with the solid; else the point. NULL if no
                              type in the scene has PDYN_FIRST_LAYER */
} pdyn_neighbours;

/* One-sided scalar constraints C_i <= 0 at the last local step. The energy of constraint i, J, is
 * k_i / 2 max(0, C_i)^2; k_i is constant in a step. C_i may have any unit c: that of k_i is J/c^2,
 * of a multiplier k_i C_i J/c. */
typedef struct pdyn_one_sided {
    int count;                /* first one for each particle of the body, then further ones */
    const double *value;      /* count: C_i, negative where the constraint has slack */
    const double *stiffness;  /* count: k_i; 0 for a constraint without energy */
    const double *squares;    /* count: |grad C_i|^2 over all its particles */
    const double *weight_sum; /* particles: sum of the weights of all constraints that select the
                                particle, N/m; eps = 1 adds it to the diagonal of H, that of
                                a sample to the vertices of its triangle */
} pdyn_one_sided;

/* Vectors (x, u, y, gradient: particles x 3) have room for one more number, so that the position of
 * the last particle can be loaded as four numbers. */
typedef struct pdyn_operator {
    /* Returns the operator's state, or NULL without memory. */
    void *(*create)(const void *params, const pdyn_body *body, const pdyn_services *services);
    void (*free)(void *self);
    /* Takes new neighbour lists, also the first ones. Returns false without memory. */
    bool (*neighbours)(void *self, const pdyn_neighbours *lists);
    /* A step of length h, s, begins. A step that is repeated begins again. NULL: nothing to do. */
    void (*begin)(void *self, double h);
    /* Local step at x: returns the energy, J, and adds its gradient, N (particles x 3). */
    double (*local)(void *self, const double *x, double *gradient);
    /* This and the next three: the constraints at the x of the last local step. */
    pdyn_one_sided (*one_sided)(void *self);
    /* rate_i = grad C_i . u for the constraints marked in `which` (count), 0 for the others. */
    void (*rate)(void *self, const bool *which, const double *u, double *rate);
    /* y += sum of multiplier_i grad C_i */
    void (*force)(void *self, const double *multiplier, double *y);
    /* Adds the 3 x 3 block diagonal of the sum of stiffness_i grad C_i grad C_i', packed xx xy xz
     * yy yz zz, particles x 6. */
    void (*diagonal)(void *self, const double *stiffness, double *blocks);
    /* Writes the density of the body's particles at the x of the last local step, kg/m^3. The last
     * operator of a body that has this callback decides; so for `pressure`. NULL: none. */
    void (*density)(void *self, double *density);
    /* Writes the pressure of the body's particles at the x of the last local step, Pa. NULL: none.
     */
    void (*pressure)(void *self, double *pressure);
    /* Changes the velocities v, m/s, after the step (viscosity), at the x of the last local step.
     * NULL: none. */
    void (*velocity)(void *self, double *v);
    /* Writes or reads what the next step depends on. PDYN_BAD_INPUT, with an error text: a value
     * that was read is not valid. NULL: nothing. */
    pdyn_status (*persist)(void *self, pdyn_snapshot *snapshot);
    /* Lowers max_step (particles and samples, m) to the distance that each may move from x without
     * a particle of the body passing a surface. No iterate moves farther at once. NULL: no limit.
     */
    void (*limit)(void *self, const double *x, double *max_step);
    /* The energy, J, that constraint i stores at the x of the last local step, where that of the
     * local step contains what damping takes away. NULL: k_i / 2 max(0, C_i)^2. */
    double (*stored)(const void *self, int i);
    /* The step that ended at the x of the last local step was accepted. NULL: nothing to do. */
    void (*accept)(void *self);
    /* Adds the force on every boundary point, N, at the x of the last local step: minus sum of
     * multiplier_i dC_i/dx of the point. force: (points - particles) x 3. Core calls it when forces
     * on solids are asked for, directly after `force`, which gets the multipliers. NULL: the
     * operator puts no force on solids. */
    void (*boundary_force)(void *self, double *force);
    /* Takes changed parameters, between two steps; those among `alternatives` do not change. NULL:
     * no parameter may change while a simulation runs. */
    void (*set_params)(void *self, const void *params);
} pdyn_operator;

/* ---- the constraint table -------------------------------------------------------------------- */

enum {                              /* pdyn_constraint_type.flags */
       PDYN_ANCHORED = 1,           /* its forces on particles do not sum to zero (pins); not needed
                                       for those that boundary_force gives to solids */
       PDYN_ON_SURFACE = 2,         /* needs a body with triangles: a sheet, or a soft or rigid
                                       body */
       PDYN_ON_PARTICLES = 4,       /* needs a body of particles */
       PDYN_REACTION = 8,           /* its force is reported as pin reaction */
       PDYN_LOSSY = 16,             /* its energy is dissipated in the step, not stored */
       PDYN_SEVERAL = 32,           /* a body may have several of them */
       PDYN_ON_VOLUME = 64,         /* needs a body with tetrahedra */
       PDYN_ONE_SIDED = 128,        /* it pushes on one side only; a force that begins is treated as
                                       an impact and not expected to last */
       PDYN_EVERY_ITERATION = 256,  /* `update` is called in every local step, not once a step */
       PDYN_ON_CLOSED = 512,        /* needs a body with triangles that enclose a volume: no border,
                                       all pieces face outwards, hollows inwards, or all the
                                       other way */
       PDYN_NEIGHBOURS = 1024,      /* works on the neighbour lists of its body of particles; every
                                       matrix-free type does */
       PDYN_NUMERIC_TANGENT = 2048, /* core computes J by central differences of `project`, which
                                       take 6 projections of an element for each of its rows: for a
                                       type without tangent whose elements have at most 12 rows */
       PDYN_CONTACT = 4096,         /* its forces are among those of pdyn_contact_forces */
       PDYN_FLUID = 8192,           /* its forces are loads by fluids (PDYN_LOAD_FLUID, probe.h) and
                                       not by contact; so are those of every type that works on
                                       neighbour lists */
       PDYN_FIRST_LAYER = 16384,    /* reads `layer_x` of the neighbour lists */
       PDYN_STEADY = 32768,         /* its weights depend on parameters alone although it has a
                                       `begin`; excludes update */
};

typedef struct pdyn_constraint_type {
    const char *name, *summary;
    unsigned flags;
    size_t params_size;
    const pdyn_param *params; /* ends with a name of NULL */
    /* Names of parameters of which a scene gives at most one: none of them is required and at most
     * one has a default. Ends with NULL. NULL: there are no alternatives. */
    const char *const *alternatives;
    /* Computes parameters from other parameters and from the scene, and checks rules between them.
     * Core calls it when it reads the scene, where a fault is an error of the scene, and each time
     * a parameter changes, where a fault refuses the change. It gets the parameters as they were
     * given, none that it computed before, and the scene as it was read. The order of calls must
     * not matter. NULL: nothing to compute. */
    pdyn_param_fault (*resolve)(void *params, const pdyn_scene_info *scene);
    size_t data_size; /* bytes of `data` per element */
    /* Number of elements on this body, 0 or more. NULL: `update` returns it. */
    int (*elements)(const void *params, const pdyn_body *body);
    /* Elements that come and go: tells which elements there are, given the positions x (m) and
     * velocities v (m/s) of all particles of the system (particles x 3). Each element has `rows`
     * rows of `width` entries.
     *
     * Core calls it at the beginning of every step with the state there, before `begin`; with
     * PDYN_EVERY_ITERATION, in every local step instead, with the iterate as x and v NULL. It
     * returns the number of elements, 0 or more, and writes `data`, and `key` where memory_size is
     * not 0, of the first `room` of them. If the number exceeds room, core grows the arrays and
     * calls it again. `select` and `weight` follow (`weight` after `begin`, where there is one).
     *
     * One thread calls it, so results are the same for any number of threads. An element must have
     * energy 0 and force 0 where it appears and where it disappears, otherwise E is not continuous.
     * The entries of a row select different particles, except for entries with the coefficient 0,
     * which are ignored. Excludes row_sizes, linear, damping and matrix_free, and
     * PDYN_EVERY_ITERATION excludes begin. NULL: the elements stay the same. */
    int (*update)(const void *params, const pdyn_batch *batch, const double *x, const double *v,
                  int room);
    size_t scratch_size; /* bytes of `scratch` per particle of the body. Only with `update`. */
    /* Rows of each element and entries of each row. Where this differs between elements, row_sizes
     * returns it instead. A row without entries has no effect. */
    int rows, width;
    void (*row_sizes)(const void *params, const pdyn_batch *batch, int element, int *rows,
                      int *width);
    /* Fills column, coefficient and data: G of these elements. */
    void (*select)(const void *params, const pdyn_batch *batch, int first, int last);
    /* Fills weight, which must not depend on u. Called once, and when parameters change; with
     * `update`, or with `begin` and without PDYN_STEADY, in every step. A weight that depends on
     * `memory`, on `time` or on the length of the step needs a `begin`, which may do nothing. */
    void (*weight)(const void *params, const pdyn_batch *batch, int first, int last);
    /* Fills p from u; finite for any u, also 0. Without `energy`, p is the point of the manifold
     * closest to u. */
    void (*project)(const void *params, const pdyn_batch *batch, int first, int last);
    /* J = dp/du of the elements, one after the other from J[0]: (3 rows)^2 numbers each, symmetric,
     * with eigenvalues in [0, 1] (clamp them: H must stay positive definite). A J that leaves out a
     * part of dp/du, as that of Gauss-Newton does, keeps H positive definite but takes more
     * iterations: the conformance check reports it, in elements of at most 12 rows. J is zero on
     * entry. Finite for any u, also 0. NULL: J = 0, or with PDYN_NUMERIC_TANGENT by differences. */
    void (*tangent)(const void *params, const pdyn_batch *batch, int first, int last, double *J);
    /* Instead of `tangent`, for elements with J = s I - a a', such as points on a plane or a
     * sphere: 3 rows + 1 numbers each, a and s. Takes less memory and time. An element may have
     * thousands of rows: preconditioners leave elements of several rows out. */
    void (*tangent_rank1)(const void *params, const pdyn_batch *batch, int first, int last,
                          double *axis);
    /* Returns true if p = 0 and J = 0 for all elements and all u: core then adds the rows up to one
     * constant matrix. Excludes begin. NULL: false. */
    bool (*linear)(const void *params, const pdyn_batch *batch);
    /* The energy E of these elements, J, where it is not w/2 |u - p|^2. Its gradient dE/du must be
     * w (u - p): `project` gives p = u - dE/du / w, where w is about the largest second derivative
     * of E (Liu, Bouaziz and Kavan 2017). Where no type has `begin`, `update`, `end`, PDYN_LOSSY or
     * a path, core refuses a step that gains more kinetic energy than gravity, moving solids and
     * all E can give: E of a type without them is at least 0. That of other types, such as the gas
     * in a balloon, may be negative. A `project` that depends on `time` needs a `begin`, which may
     * do nothing. NULL: E = w/2 |u - p|^2. */
    double (*energy)(const void *params, const pdyn_batch *batch, int first, int last);
    /* Called at the beginning of every step with u = G x and p = G v of all elements, which it may
     * read: data may change. `weight` is called after it, and not before the first step, unless the
     * type has PDYN_STEADY. A step that is repeated begins again: what lasts belongs into `memory`.
     * Elements of a type with it and without PDYN_STEADY are not steady (pdyn_elements): `hybrid`
     * leaves them out of its coarse space. NULL: nothing changes. */
    void (*begin)(const void *params, const pdyn_batch *batch, int first, int last);
    /* State of elements that lasts, as plastic strain or the slip of friction. `end` is called
     * after every accepted step, with u and p of its end, and writes `memory` (memory_size bytes
     * per element, zeros at first); no other callback changes it. It is not called for a step that
     * is repeated, other parameters leave the memory, and saved states contain it, so state belongs
     * here and not into `data`. With `update`, `memory` of an element is that of the one with the
     * same key in the step before, zeros for a new element; the keys of a batch differ from each
     * other. Both or none; not with linear, damping or matrix_free. */
    size_t memory_size;
    void (*end)(const void *params, const pdyn_batch *batch, int first, int last);
    /* Damping time, s: stress = stiffness (strain + damping x rate of strain). Above 0, core makes
     * a second batch of the same rows with the weights times damping / h. At the beginning of every
     * step, damping_rest makes u = G x the rest shape of that batch: it changes `data`, then at
     * most 512 doubles an element, such that p(u) = u. With bdf2 core extrapolates the
     * data of two steps. NULL: no damping; both or none. */
    double (*damping)(const void *params);
    void (*damping_rest)(const void *params, const pdyn_batch *batch, int first, int last);
    /* NULL: core derives everything from the rows above. Excludes begin and damping. */
    const pdyn_operator *matrix_free;
    /* As pdyn_operator.boundary_force, of rows whose p follows points of solids: a force of shear,
     * whose moment is that on the face of a box, before its point; of a moving box with
     * PDYN_FIRST_LAYER. */
    void (*boundary_force)(const void *params, const pdyn_batch *batch, double *force);
    /* Whether it acts on one side only with these parameters, as with PDYN_ONE_SIDED, which says so
     * for all. NULL: no. */
    bool (*one_sided)(const void *params);
} pdyn_constraint_type;

/* ---- the solver table ------------------------------------------------------------------------ */

/* A symmetric sparse matrix: lower triangle by columns. dim 1: one row and column per particle,
 * the same for x, y and z. dim 3: row and column 3 i + a belong to component a of particle i;
 * entries above the diagonal of a diagonal block are present, too, and have to be ignored. */
typedef struct pdyn_matrix {
    int dim;
    int size;         /* dim x particles */
    const int *start; /* size + 1: first entry of each column */
    const int *row;   /* entries; ascending in a column */
    const double *value;
    unsigned pattern, values; /* counters: they change when the pattern, when the values change */
} pdyn_matrix;

/* The elements of one constraint whose rows always exist; they add sum of G' B G to H. */
typedef struct pdyn_elements {
    const pdyn_batch *rows;    /* G: element_row, row_entry, column, coefficient; weight */
    const double *block;       /* B of each element; NULL: B = weight x identity */
    const size_t *block_start; /* first number of each element in block, (3 rows)^2 of them,
                                  symmetric; NULL: B = m m' + a I, 4 numbers per element, m and a */
    bool constant;             /* B = weight x identity for any x and any eps */
    bool steady; /* weights depend on parameters alone: a solver may choose its structure by them */
} pdyn_elements;

/* Parts of H. PDYN_DYNAMIC: the constraints that change from step to step, which are the
 * matrix-free ones and those whose elements come and go. */
typedef enum pdyn_part { PDYN_WHOLE, PDYN_DYNAMIC } pdyn_part;

/* The quadratic model of E around an iterate, 1/2 d.H d - b.d, with every one-sided constraint on a
 * fixed side. Vectors are particles x 3, with room for one number more. */
typedef struct pdyn_model {
    const pdyn_services *services;
    int particles;
    const double *mass; /* particles, kg; more for particles that an inlet moves */
    double h;           /* s, effective length of the step: H contains mass / h^2; 0 before the
                           first step */
    double eps;         /* of H: 0 newton, 1 projective */
    bool newton;        /* the scene asks for the newton step, and some constraint has a tangent: H
                           depends on x and on eps */
    bool dynamic;       /* some constraint changes from step to step */
    bool bodies_alone;  /* of `remainder`: the rows at the iterate tie rigid bodies alone, for which
                           solve_bodies is exact; elsewhere this H is diagonal */
    const bool *in_rows; /* particles: selected by a row that always exists (of `remainder`: by a
                            row of the iterate), or of a rigid body */
    int elements_count;  /* constraints whose rows always exist */
    int one_sided_count; /* matrix-free constraints */
    int dynamic_count;   /* constraints whose elements come and go */
    /* y = H u, N for u in m */
    void (*product)(struct pdyn_model *model, const double *u, double *y);
    /* The 3 x 3 block diagonal of a part of H, N/m, packed xx xy xz yy yz zz: particles x 6. */
    void (*diagonal)(struct pdyn_model *model, pdyn_part part, double *blocks);
    /* A preconditioner of rigid bodies: z of their particles becomes B^-1 r, where B is the block
     * diagonal of H, as of the last call of `diagonal` for PDYN_WHOLE, and the part of H by rows
     * that come and go between rigid bodies. NULL in a scene without rigid bodies. Call it after
     * z = D^-1 r: the blocks D of rigid bodies have no meaning of their own. */
    void (*solve_bodies)(struct pdyn_model *model, const double *r, double *z);
    /* a . b, the same bits for any number of threads. */
    double (*dot)(struct pdyn_model *model, const double *a, const double *b);
    /* The length of a residual: the root of the sum over bodies of |r|^2 / scale^2, so that no body
     * hides another. scale: |M g|, or for a surface in a scene with contact |M (x - s) / h^2| where
     * that is larger, plus the norm of the forces that fluids put on the body. */
    double (*norm)(struct pdyn_model *model, const double *r);
    /* H assembled; valid until the next call. NULL in `remainder`. */
    pdyn_status (*matrix)(struct pdyn_model *model, pdyn_matrix *matrix);
    /* The sum of weight G' G over all steady elements, without inertia, dim 1: which particles are
     * tied, and how stiffly. Couplings with vertices of rigid bodies are 0, as if the bodies stood
     * still: what ties a particle to them is on its diagonal alone. Valid until the next call. */
    pdyn_status (*graph)(struct pdyn_model *model, pdyn_matrix *matrix);
    /* Elements of constraint k < elements_count, as H contains them. None of a constraint that has
     * tangent_rank1 and elements of several rows, or a row of more than 300 entries, which `graph`
     * leaves out, too: such an element couples all its particles. */
    pdyn_elements (*elements)(struct pdyn_model *model, int k);
    /* The one-sided constraints of matrix-free constraint k < one_sided_count at the iterate, and
     * the body that they belong to. */
    pdyn_one_sided (*one_sided)(struct pdyn_model *model, int k, const pdyn_body **body);
    /* rate_i = grad C_i . u, force += sum of multiplier_i grad C_i: as in pdyn_operator. */
    void (*rate)(struct pdyn_model *model, int k, const bool *which, const double *u, double *rate);
    void (*force)(struct pdyn_model *model, int k, const double *multiplier, double *force);
    /* The same model without the one-sided constraints of matrix-free ones, whose product and
     * diagonals are those of the remainder of H. NULL in itself. */
    struct pdyn_model *remainder;
    /* Runs fn over the particles that the vectors of a solve concern, in blocks of `grain`; returns
     * the number of blocks. All particles; of `remainder`, a range that contains every particle of
     * in_rows: elsewhere this H is diagonal, and product, dot and norm take vectors as 0. */
    int (*for_particles)(struct pdyn_model *model, int grain, pdyn_range_fn *fn, void *arg);
} pdyn_model;

typedef struct pdyn_stop { /* a solve ends at the first of these */
    double rel_tol;        /* |b - H y| has fallen by this factor, in the model's norm */
    double min_progress;   /* an iteration lowers the model by less than this part of the mean of
                              all iterations of the solve; 0: never */
    int max_iterations;    /* so many iterations */
    int min_iterations;    /* run at least this many, even if another criterion is met; above 0, the
                              progress of the first iteration does not count in the mean */
    bool first_of_step;    /* the first solve of a step, or of an attempt at one: later models of
                              the same step differ little from this one */
} pdyn_stop;

typedef struct pdyn_global_solver {
    const char *name, *summary;
    bool direct; /* factors H: costs a factorisation wherever H changes */
    bool dual;   /* solves for multipliers and keeps them from step to step: it decides on the sides
                    of one-sided constraints itself, and the next step starts from s */
    size_t state_size; /* at least 1; zeroed before create */
    /* How well it suits the scene: 0: it cannot solve it; otherwise the solver with the largest bid
     * is chosen where a scene asks for none. *reason: why, in words, for the report, or, with 0,
     * for the error. NULL: 1. */
    int (*suits)(const pdyn_model *model, const char **reason);
    /* Refers to the model from now on. After a failure free is called, too. It is called when a
     * scene is loaded, and again in a run, where a constraint begins or ends or its rows or weights
     * change: what it chooses by values, such as a coarse space, must follow from steady elements,
     * or a resumed run differs. */
    pdyn_status (*create)(void *self, pdyn_model *model);
    /* Solves H y = b. y: particles x 3, zero on entry. b: particles x 3, becomes the residual
     * b - H y. *iterations: 1 for a direct solver. */
    pdyn_status (*solve)(void *self, double *b, double *y, const pdyn_stop *stop, int *iterations);
    /* Drops what it keeps from step to step. NULL: nothing. */
    void (*forget)(void *self);
    void (*free)(void *self);
    /* Writes or reads what the next step depends on. NULL: nothing. */
    pdyn_status (*persist)(void *self, pdyn_snapshot *snapshot);
} pdyn_global_solver;

/* ---- plug-ins -------------------------------------------------------------------------------- */

/* Version of these tables: raised when the layout of one of them changes. */
#define PDYN_ABI 20u

typedef struct pdyn_plugin {
    unsigned abi; /* PDYN_ABI: stays the first of all */
    const char *name;
    const pdyn_constraint_type *const *constraints; /* ends with NULL; NULL: none */
    const pdyn_global_solver *const *solvers;       /* ends with NULL; NULL: none */
} pdyn_plugin;

/* The one symbol of a shared object that pdyn_load_plugin loads:
 *     const pdyn_plugin pdyn_plugin_table = {PDYN_ABI, "NAME", constraints, solvers}; */
PDYN_API extern const pdyn_plugin pdyn_plugin_table;

/* Makes the types of a plug-in that is linked with the program known to the context, which refers
 * to it from then on. Twice the same does nothing. PDYN_BAD_INPUT: another abi, a table that makes
 * no sense, a name that is taken; nothing is registered then. */
PDYN_API pdyn_status pdyn_register(pdyn_context *context, const pdyn_plugin *plugin);

#ifdef __cplusplus
}
#endif
#endif
