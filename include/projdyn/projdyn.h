/* projdyn: Projective Dynamics for fluids and cloth in one solve.
 *
 * User API: create a context, load a scene, step it, read its state, write frames.
 * All quantities are SI: metres, kilograms, seconds, newtons. All state is double precision.
 *
 *     pdyn_context *context = NULL;
 *     pdyn_sim *sim = NULL;
 *     if (pdyn_create(NULL, &context) == PDYN_OK
 *         && pdyn_load(context, "scene.json", NULL, 0, &sim) == PDYN_OK)
 *         while (pdyn_time(sim) < pdyn_duration(sim) && pdyn_step(sim, NULL) == PDYN_OK)
 *             ;
 *     else
 *         fprintf(stderr, "%s\n", pdyn_last_error(context));
 *     pdyn_free(sim);
 *     pdyn_destroy(context);
 */
#ifndef PROJDYN_H
#define PROJDYN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define PDYN_API                __attribute__((visibility("default")))
#define PDYN_PRINTF(text, args) __attribute__((format(printf, text, args)))
#else
#define PDYN_API
#define PDYN_PRINTF(text, args)
#endif

/* Name, value, text. Positive: the simulation is untouched and usable. Negative: it stopped at its
 * last good step and takes no further one. */
#define PDYN_STATUS_LIST(X)                                                                        \
    X(PDYN_OK, 0, "success")                                                                       \
    X(PDYN_BAD_INPUT, 1, "bad input")                                                              \
    X(PDYN_BAD_CALL, 2, "call with arguments that make no sense")                                  \
    X(PDYN_NO_MEMORY, 3, "out of memory")                                                          \
    X(PDYN_IO_FAILED, 4, "reading or writing a file failed")                                       \
    X(PDYN_DIVERGED, -1, "the simulation diverged")                                                \
    X(PDYN_SOLVER_FAILED, -2, "the linear solver failed")

typedef enum pdyn_status {
#define PDYN_STATUS_ENUM(name, value, text) name = (value),
    PDYN_STATUS_LIST(PDYN_STATUS_ENUM)
#undef PDYN_STATUS_ENUM
} pdyn_status;

typedef struct pdyn_context pdyn_context; /* threads, memory, messages, registered types */
typedef struct pdyn_sim pdyn_sim;         /* one scene being simulated */

typedef enum pdyn_log_level { PDYN_LOG_INFO, PDYN_LOG_WARNING } pdyn_log_level;

typedef struct pdyn_options {
    int threads; /* worker threads, the caller's included; 0: one per available core */
    /* Allocator: block NULL allocates, new_size 0 frees; NULL uses the C library. Must be
     * thread-safe. */
    void *(*allocate)(void *user, void *block, size_t old_size, size_t new_size);
    void *allocate_user;
    void (*log)(void *user, pdyn_log_level level, const char *message); /* NULL: silent */
    void *log_user;
} pdyn_options;

PDYN_API const char *pdyn_version(void);
PDYN_API const char *pdyn_status_text(pdyn_status status);
PDYN_API pdyn_options pdyn_default_options(void);

/* options NULL: defaults. On failure *out is NULL. */
PDYN_API pdyn_status pdyn_create(const pdyn_options *options, pdyn_context **out);
PDYN_API void pdyn_destroy(pdyn_context *context); /* after every simulation of it; NULL is fine */
PDYN_API const char *pdyn_last_error(const pdyn_context *context); /* never NULL */
PDYN_API int pdyn_thread_count(const pdyn_context *context);
PDYN_API size_t pdyn_bytes_in_use(const pdyn_context *context);
PDYN_API size_t pdyn_peak_bytes(const pdyn_context *context);

/* Loads the shared object of a plug-in (module.h) and registers its types; a path without a slash
 * means the current directory. It runs the plug-in's code and stays loaded until the program ends.
 * Scenes load plug-ins, too. */
PDYN_API pdyn_status pdyn_load_plugin(pdyn_context *context, const char *path);

/* Describes the registered constraint types and solvers as text, for people: name NULL lists all,
 * otherwise one with its parameters, units, defaults and bounds. `write` gets pieces of text. */
PDYN_API pdyn_status pdyn_describe(pdyn_context *context, const char *name,
                                   void (*write)(void *user, const char *text), void *user);

/* Scenes. `set` holds `count` texts "path=value" that override the file ("solver.type=cholesky",
 * "bodies.sheet.constraints.spring.stretching_stiffness=2000"). On failure *out is NULL and
 * pdyn_last_error names file, line, column and JSON path. */
PDYN_API pdyn_status pdyn_load(pdyn_context *context, const char *path, const char *const *set,
                               int count, pdyn_sim **out);
/* The same from a JSON text; `name` stands for the file in messages, meshes are found from the
 * current directory. */
PDYN_API pdyn_status pdyn_load_text(pdyn_context *context, const char *text, const char *name,
                                    const char *const *set, int count, pdyn_sim **out);
/* The JSON text of a scene with its overrides done, not checked any further. */
PDYN_API pdyn_status pdyn_scene_text(pdyn_context *context, const char *path,
                                     const char *const *set, int count,
                                     void (*write)(void *user, const char *text), void *user);
PDYN_API void pdyn_free(pdyn_sim *sim); /* NULL is fine */

/* One step of the simulation; it never passes the time of the next frame. */
typedef struct pdyn_step_info {
    double time;          /* s, at the end of the step */
    double h;             /* s, length of the step */
    bool frame;           /* the step ended exactly at a frame */
    int outer_iterations; /* local/global iterations */
    int linear_iterations;
    int impacts;               /* one-sided constraints that stopped an approach; 0 with "euler" */
    int retries;               /* attempts that were taken back: the step became shorter */
    int particles;             /* live ones, of bodies of particles */
    double density_error_mean; /* mean over fluid particles of max(0, rho/rho_0 - 1) */
    double density_error_max;
    double step_residual; /* |grad E| / |M g| of the body where it is largest, at the end */
    double kinetic_energy, potential_energy, constraint_energy; /* J */
    double momentum[3];                                         /* kg m/s */
    double
        pin_reaction[3]; /* N, what the pins carry: the gradient of all else at the pinned points */
    double ms_neighbours, ms_local, ms_global, ms_contact; /* wall clock */
    double ms_cpu; /* processor time of the process, of all its threads */
} pdyn_step_info;

/* info NULL: not wanted. PDYN_DIVERGED leaves the state of the last good step. */
PDYN_API pdyn_status pdyn_step(pdyn_sim *sim, pdyn_step_info *info);

/* Called after every local/global iteration of a step, e.g. to study convergence. x: particles x 3.
 */
typedef struct pdyn_iteration {
    int iteration;         /* 0: the starting point of the step */
    int linear_iterations; /* in this iteration */
    double energy;         /* J, the minimised function */
    double residual;       /* |grad E| / |M g| of the body where it is largest */
    double damping;        /* eps: 0 newton, 1 projective */
    const double *x;       /* particles x 3 */
} pdyn_iteration;
PDYN_API void pdyn_observe(pdyn_sim *sim, void (*observer)(void *user, const pdyn_iteration *),
                           void *user);

/* State. Pointers stay valid until the simulation is freed; values change with every step. */
PDYN_API double pdyn_time(const pdyn_sim *sim);           /* s */
PDYN_API double pdyn_duration(const pdyn_sim *sim);       /* s, of the scene */
PDYN_API double pdyn_frame_interval(const pdyn_sim *sim); /* s */
PDYN_API const char *pdyn_solver_type(const pdyn_sim *sim);
PDYN_API const char *pdyn_solver_reason(const pdyn_sim *sim);
PDYN_API const char *pdyn_integrator(const pdyn_sim *sim); /* "bdf2" or "euler" */
PDYN_API const char *pdyn_step_type(const pdyn_sim *sim);  /* "projective" or "newton" */
PDYN_API uint64_t
pdyn_state_hash(const pdyn_sim *sim); /* FNV-1a over the bits of the live x and v */

typedef struct pdyn_state {
    int particles;          /* all unknowns, bodies one after the other */
    const double *x;        /* m,   particles x 3 */
    const double *v;        /* m/s, particles x 3 */
    const double *mass;     /* kg,  particles */
    const double *density;  /* kg/m^3, particles; rest density where there is no fluid constraint */
    const double *pressure; /* Pa, particles; 0 where there is no fluid constraint */
    const bool *live;       /* particles: the others are not in the scene, now; NULL: all are */
    int boundary;           /* boundary points: on solids */
    int moving;             /* the last of these: on solids that move */
    const double *boundary_x; /* m, boundary x 3 */
    int bodies;
    int constraints; /* batches: a constraint type on a body */
} pdyn_state;
PDYN_API pdyn_state pdyn_get_state(const pdyn_sim *sim);

typedef struct pdyn_body_info {
    const char *name;
    int first, count;    /* its particles */
    int live;            /* how many of these are in the scene, now */
    double radius;       /* m, of a body of particles; 0 for a surface */
    double rest_density; /* kg/m^3, of a body of particles; 0 for a surface */
    int triangles;       /* of a surface; 0 for a body of particles */
    const int *triangle; /* triangles x 3, counted from the body's first particle */
    double residual;     /* |grad E| / |M g| of its particles, at the end of the last step */
} pdyn_body_info;
PDYN_API pdyn_body_info pdyn_get_body(const pdyn_sim *sim, int body); /* all 0: there is none */

typedef struct pdyn_constraint_info {
    const char *type, *body;
    int elements;
    double energy; /* J, at the end of the last step */
} pdyn_constraint_info;
/* All 0: there is none. */
PDYN_API pdyn_constraint_info pdyn_get_constraint(const pdyn_sim *sim, int constraint);

typedef struct pdyn_parameter_info {
    const char *name, *unit; /* unit "1": a ratio */
    double value;
} pdyn_parameter_info;
/* The numbers among a constraint's parameters, as the simulation uses them: given, by default, or
 * computed from others. parameter: counted from 0. All 0: there is none. */
PDYN_API pdyn_parameter_info pdyn_get_parameter(const pdyn_sim *sim, int constraint, int parameter);

/* The solids of a scene, in its order. NULL: there is none. */
PDYN_API const char *pdyn_solid_name(const pdyn_sim *sim, int solid);

/* The load on a solid at the end of the last step: force, N, and moment about the origin of the
 * world, N m. It is the sum of
 *   - the pressure of the fluid: minus the gradient of the fluid's energy with respect to the
 *     solid's boundary points, at these points. Those of a box lie about a particle spacing behind
 *     its faces (pdyn_state.boundary_x), those of other solids on their surface;
 *   - contact and friction of cloth and soft solids that touch it.
 * A fluid has no friction with solids. With implicit Euler ("euler") the forces on all solids sum
 * up to the weight, plus pin_reaction and the force of wind, less the change of momentum over h,
 * but for the residual of the step. Particles that an outlet removed at the end of the step are
 * left out.
 *
 * Computed on the first call after a step, for all solids, on one thread: the same bits for any
 * number of threads. Zero before the first step, after pdyn_restore until the next step, and after
 * a step that failed. PDYN_BAD_CALL: an argument is NULL, or there is no such solid.
 * PDYN_NO_MEMORY. */
PDYN_API pdyn_status pdyn_solid_load(const pdyn_sim *sim, int solid, double force[3],
                                     double moment[3]);

/* Saves the state in one file, or brings a simulation that was loaded from the same scene to a
 * saved one: what follows has the same bits as without the interruption. The scene may have another
 * duration. The file appears whole or not at all. PDYN_BAD_INPUT: this is no saved state, or one of
 * another scene or version. */
PDYN_API pdyn_status pdyn_save(pdyn_sim *sim, const char *path);
PDYN_API pdyn_status pdyn_restore(pdyn_sim *sim, const char *path);

/* Output. A frame is one file per body, DIR/NAME_000012.vtk (legacy VTK 4.2, binary), listed with
 * its time in DIR/NAME.vtk.series; `ply` adds NAME_000012.ply. The points of solids that rest are
 * in DIR/boundary.vtk, those of solids that move are one more body, "boundary". Files appear whole
 * or not at all. */
typedef struct pdyn_writer pdyn_writer;
PDYN_API pdyn_status pdyn_writer_open(pdyn_sim *sim, const char *directory, bool ply,
                                      pdyn_writer **out);
PDYN_API pdyn_status pdyn_writer_frame(pdyn_writer *writer);
/* Adds a row to DIR/metrics.csv. */
PDYN_API pdyn_status pdyn_writer_step(pdyn_writer *writer, const pdyn_step_info *info);
/* Writes the report, to DIR/report.json or to `path` if given. `failed`: why the run stopped early,
 * or NULL. */
PDYN_API pdyn_status pdyn_writer_report(pdyn_writer *writer, const char *path, bool interrupted,
                                        const char *failed);
/* Saves simulation and writer in DIR/state.pdyn. */
PDYN_API pdyn_status pdyn_writer_save(pdyn_writer *writer);
/* Goes on where DIR/state.pdyn was saved, with a simulation loaded from the same scene. */
PDYN_API pdyn_status pdyn_writer_resume(pdyn_sim *sim, const char *directory, pdyn_writer **out);
PDYN_API void pdyn_writer_close(pdyn_writer *writer); /* NULL is fine */

#ifdef __cplusplus
}
#endif
#endif
