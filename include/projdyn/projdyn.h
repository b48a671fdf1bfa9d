/* projdyn: Projective Dynamics for fluids, cloth and solids in one solve.
 *
 * Public functions for users: create a context, load a scene, step it, read its state, write
 * frames. Quantities are in SI units: metres, kilograms, seconds, newtons. Numbers are double
 * precision.
 *
 * Threads. Different contexts are independent. Within a context, different threads may load, step,
 * read, write and free different simulations at the same time; each simulation and its writers
 * belong to one thread at a time. The threads of the context work for one simulation at a time; a
 * step of another one meanwhile runs on its caller's thread, with the same bits. Calls that
 * register types need the context alone: pdyn_load_plugin, pdyn_register, loading a scene with
 * "plugins"; so does pdyn_destroy. Each thread has its own pdyn_last_error. A log function and an
 * allocator must be thread-safe. A forked child may go on with its copy of a simulation, on one
 * thread.
 *
 * Structs that a caller fills or gets may grow at their end in a later version. Programs call
 * inline functions that pass the size they were compiled with to the exported function
 * (NAME_sized), which reads or writes no more; members that a caller does not know have their
 * defaults, those that the library does not know become 0. Bindings of other languages call
 * NAME_sized.
 *
 * NULL where it is not allowed: functions with a status return PDYN_BAD_CALL, functions without one
 * return zeros, "" or NULL, or do nothing.
 *
 *     pdyn_context *context = NULL;
 *     pdyn_sim *sim = NULL;
 *     if (pdyn_create(NULL, &context) == PDYN_OK
 *         && pdyn_load(context, "scene.json", NULL, 0, &sim) == PDYN_OK)
 *         while (!pdyn_is_finished(sim) && pdyn_step(sim, NULL) == PDYN_OK)
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

/* Version of this header; pdyn_version() gives the version of the library that is linked. */
#define PDYN_VERSION_MAJOR 0
#define PDYN_VERSION_MINOR 1
#define PDYN_VERSION_PATCH 0

#if defined(__GNUC__)
#define PDYN_API                __attribute__((visibility("default")))
#define PDYN_PRINTF(text, args) __attribute__((format(printf, text, args)))
#else
#define PDYN_API
#define PDYN_PRINTF(text, args)
#endif

/* Name, value, text. Positive: the call failed and had no effect. Negative: a step failed. After a
 * failed step of either sign, see pdyn_step. */
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
typedef struct pdyn_sim pdyn_sim;         /* a scene that is simulated */

typedef enum pdyn_log_level { PDYN_LOG_INFO, PDYN_LOG_WARNING } pdyn_log_level;

typedef struct pdyn_options {
    int threads; /* number of threads, the caller's included; 0: one per core that the process
                    may use (taskset), at most 64 */
    /* Allocator: block NULL allocates, new_size 0 frees. Must be thread-safe. NULL: the C
     * library's. */
    void *(*allocate)(void *user, void *block, size_t old_size, size_t new_size);
    void *allocate_user;
    void (*log)(void *user, pdyn_log_level level, const char *message); /* NULL: no messages */
    void *log_user;
    /* A scene with "plugins" is refused (PDYN_BAD_INPUT); false: its plug-ins are loaded. */
    bool refuse_scene_plugins;
} pdyn_options;

/* Version of the library, "MAJOR.MINOR.PATCH". */
PDYN_API const char *pdyn_version(void);
/* Names of the built-in solvers, with a space between them. "cholesky" is one of them unless the
 * library was built without CHOLMOD. */
PDYN_API const char *pdyn_solvers(void);
/* The text of PDYN_STATUS_LIST; "unknown status" for any other number. */
PDYN_API const char *pdyn_status_text(pdyn_status status);
/* Options that are all default: all members 0, but for `allocate`. */
PDYN_API void pdyn_default_options_sized(pdyn_options *out, size_t size);
static inline pdyn_options pdyn_default_options(void) {
    pdyn_options out;
    pdyn_default_options_sized(&out, sizeof out);
    return out;
}

/* Creates a context. options NULL: defaults. On failure *out is NULL. PDYN_BAD_CALL: `threads` is
 * below 0 or above 1024. PDYN_NO_MEMORY. */
PDYN_API pdyn_status pdyn_create_sized(const pdyn_options *options, size_t size,
                                       pdyn_context **out);
static inline pdyn_status pdyn_create(const pdyn_options *options, pdyn_context **out) {
    return pdyn_create_sized(options, sizeof *options, out);
}
/* All simulations and scenes (scene.h) of the context must be freed before. NULL: does nothing. */
PDYN_API void pdyn_destroy(pdyn_context *context);
/* Text of the last call of the calling thread that failed: what was given, what was expected; after
 * PDYN_BAD_CALL with the names of the function and the argument. Every call that fails sets it, no
 * other changes it. Never NULL. A thread has one text for all contexts; context NULL is allowed,
 * e.g. after pdyn_create. Copy the text to read it on another thread. */
PDYN_API const char *pdyn_last_error(const pdyn_context *context);
/* Number of threads, the caller's included. */
PDYN_API int pdyn_thread_count(const pdyn_context *context);
/* Bytes that the context and all that it made hold: at this moment, and at most so far. */
PDYN_API size_t pdyn_bytes_in_use(const pdyn_context *context);
PDYN_API size_t pdyn_peak_bytes(const pdyn_context *context);

/* Loads the shared object of a plug-in (module.h) and registers its types. A path without a slash
 * is relative to the current directory. Runs code of the plug-in, which stays loaded until the
 * program ends. Scenes can load plug-ins, too. PDYN_BAD_INPUT: no plug-in, or tables that are not
 * valid. */
PDYN_API pdyn_status pdyn_load_plugin(pdyn_context *context, const char *path);

/* Describes the registered constraint types and solvers as text for users: name NULL lists all,
 * otherwise one with its parameters, units, defaults and bounds. Calls `write` with pieces of the
 * text, which are valid during the call. PDYN_BAD_INPUT: unknown name. PDYN_NO_MEMORY. */
PDYN_API pdyn_status pdyn_describe(pdyn_context *context, const char *name,
                                   void (*write)(void *user, const char *text), void *user);

/* Loads a scene. set: `count` overrides "path=value" of values in the file, e.g.
 * "solver.type=cholesky" or "bodies.sheet.constraints.spring.stretching_stiffness=2000". On failure
 * *out is NULL. PDYN_BAD_CALL: count < 0 or a NULL. PDYN_BAD_INPUT, PDYN_IO_FAILED, PDYN_NO_MEMORY:
 * pdyn_last_error gives file, line, column and JSON path. */
PDYN_API pdyn_status pdyn_load(pdyn_context *context, const char *path, const char *const *set,
                               int count, pdyn_sim **out);
/* Loads a scene from a JSON text. `name` stands for the file in messages; relative names of mesh
 * files are resolved from the current directory. Errors as pdyn_load. */
PDYN_API pdyn_status pdyn_load_text(pdyn_context *context, const char *text, const char *name,
                                    const char *const *set, int count, pdyn_sim **out);
PDYN_API void pdyn_free(pdyn_sim *sim); /* NULL: does nothing */

/* Results of a step. A step never passes the time of the next frame. */
typedef struct pdyn_step_info {
    double time;               /* s, at the end of the step */
    double h;                  /* s, length of the step */
    bool frame;                /* the step ended exactly at a frame */
    int outer_iterations;      /* local/global iterations */
    int linear_iterations;     /* of the linear solver, all outer iterations together */
    int impacts;               /* one-sided constraints that stopped a motion; 0 with "euler" */
    int retries;               /* rejected attempts: each made the step shorter */
    int particles;             /* live particles of all bodies of particles */
    double density_error_mean; /* mean over fluid particles of max(0, rho/rho_0 - 1) */
    double density_error_max;
    double step_residual; /* largest pdyn_body_info.residual, at the end */
    /* J: of all particles; in gravity, relative to the origin; stored by constraints and contact */
    double kinetic_energy, potential_energy, constraint_energy;
    double momentum[3];     /* kg m/s */
    double pin_reaction[3]; /* N, force of all pins on their bodies: the gradient of all other terms
                               at the pinned points */
    double ms_neighbours, ms_local, ms_global, ms_contact; /* ms, wall-clock time */
    double ms_cpu; /* ms, processor time of all threads of the process */
    long leaked;   /* particles that are beyond a surface or solid which they passed through */
} pdyn_step_info;

/* Computes one step. info NULL: no results. After a failure (PDYN_DIVERGED, PDYN_SOLVER_FAILED,
 * PDYN_NO_MEMORY; PDYN_BAD_INPUT: rows of a plug-in that make no sense, more pairs of contact than
 * memory) *info is not written, and the simulation has the state of its last successful step, which
 * can be read and saved. Every later step fails with PDYN_BAD_CALL, until pdyn_restore has
 * succeeded: then the simulation continues with the same bits as a new one that restores this
 * state. */
PDYN_API pdyn_status pdyn_step_sized(pdyn_sim *sim, pdyn_step_info *info, size_t size);
static inline pdyn_status pdyn_step(pdyn_sim *sim, pdyn_step_info *info) {
    return pdyn_step_sized(sim, info, sizeof *info);
}

/* An iteration of a step, e.g. to study convergence. */
typedef struct pdyn_iteration {
    int iteration;         /* 0: the starting point of the step */
    int linear_iterations; /* in this iteration */
    double energy;         /* J, minimised function */
    double residual;       /* largest pdyn_body_info.residual, at x */
    double damping;        /* eps of the next iteration, 0 to 1: adapted by "newton"; 1 with
                              "projective" */
    const double *x;       /* m, particles x 3: the iterate; valid during the call */
} pdyn_iteration;
/* Sets the observer that every later step calls at its starting point and after each local/global
 * iteration, on the thread of the step. It must not free the simulation; functions that change,
 * save or restore it return PDYN_BAD_CALL. observer NULL: none. */
PDYN_API void pdyn_observe(pdyn_sim *sim, void (*observer)(void *user, const pdyn_iteration *),
                           void *user);

/* State. Pointers are valid until the simulation is freed; values change with every step. */
PDYN_API double pdyn_time(const pdyn_sim *sim);           /* s */
PDYN_API double pdyn_duration(const pdyn_sim *sim);       /* s, from the scene */
PDYN_API double pdyn_frame_interval(const pdyn_sim *sim); /* s */
/* Whether the time of the simulation is `time`, s, or later; whether it is the duration or later.
 * Both allow for the rounding of sums of steps, 1e-9 of the time: `pdyn_time(sim) <
 * pdyn_duration(sim)` may take one step too many. NULL: true. */
PDYN_API bool pdyn_has_reached(const pdyn_sim *sim, double time);
PDYN_API bool pdyn_is_finished(const pdyn_sim *sim);
/* Name of the linear solver, and in words why it was chosen. With several, as in "auto": of the
 * first one. */
PDYN_API const char *pdyn_solver_type(const pdyn_sim *sim);
PDYN_API const char *pdyn_solver_reason(const pdyn_sim *sim);
PDYN_API const char *pdyn_integrator(const pdyn_sim *sim); /* "bdf2" or "euler" */
/* N/m: `contact.stiffness` of the scene, or its default; 0 without contact. */
PDYN_API double pdyn_contact_stiffness(const pdyn_sim *sim);
PDYN_API const char *pdyn_step_type(const pdyn_sim *sim); /* "projective" or "newton" */
PDYN_API uint64_t
pdyn_state_hash(const pdyn_sim *sim); /* FNV-1a hash of x and v of the live particles */

typedef struct pdyn_state {
    int particles;          /* all particles, body after body */
    const double *x;        /* m,   particles x 3 */
    const double *v;        /* m/s, particles x 3 */
    const double *mass;     /* kg,  particles; that of a rigid body is at four points, which follow
                               its vertices and belong to no body */
    const double *density;  /* kg/m^3, particles; rest density without a fluid constraint */
    const double *pressure; /* Pa, particles; 0 without a fluid constraint */
    const bool *live;       /* particles: is in the scene; NULL: all are */
    int boundary;           /* number of boundary points on solids */
    int moving;             /* number of these, the last ones, on moving solids */
    const double *boundary_x; /* m, boundary x 3 */
    int bodies;
    int constraints; /* batches: one per constraint of the scene */
    int samples;     /* points on surfaces of bodies by which these act on a fluid */
} pdyn_state;
PDYN_API void pdyn_get_state_sized(const pdyn_sim *sim, pdyn_state *out, size_t size);
static inline pdyn_state pdyn_get_state(const pdyn_sim *sim) {
    pdyn_state out;
    pdyn_get_state_sized(sim, &out, sizeof out);
    return out;
}

typedef struct pdyn_body_info {
    const char *name;
    int first, count;    /* its particles */
    int live;            /* number of these that are in the scene */
    double radius;       /* m, of a body of particles; 0 for a surface */
    double rest_density; /* kg/m^3, of a body of particles; 0 for a surface */
    int triangles;       /* of a surface; 0 for a body of particles */
    const int *triangle; /* triangles x 3, relative to `first` */
    double residual;     /* |grad E| / (max(|M g|, impact) + load) of its particles, at the end of
                            the last step; impact: force that changes its motion, in scenes with
                            contact; load: norm of the forces by fluids */
    const double *rest;  /* m, count x 3: positions in the scene, before the first step */
    int edges;           /* of a surface or soft solid */
    const int *edge;     /* edges x 2, relative to `first` */
    int tets;            /* of a soft solid */
    const int *tet;      /* tets x 4, relative to `first` */
} pdyn_body_info;
/* All members 0: no such body. */
PDYN_API void pdyn_get_body_sized(const pdyn_sim *sim, int body, pdyn_body_info *out, size_t size);
static inline pdyn_body_info pdyn_get_body(const pdyn_sim *sim, int body) {
    pdyn_body_info out;
    pdyn_get_body_sized(sim, body, &out, sizeof out);
    return out;
}

typedef struct pdyn_constraint_info {
    const char *type, *body; /* names */
    int elements;            /* at this moment; of some types another number after each step */
    double energy;           /* J, at the end of the last step */
} pdyn_constraint_info;
/* All members 0: no such constraint. */
PDYN_API void pdyn_get_constraint_sized(const pdyn_sim *sim, int constraint,
                                        pdyn_constraint_info *out, size_t size);
static inline pdyn_constraint_info pdyn_get_constraint(const pdyn_sim *sim, int constraint) {
    pdyn_constraint_info out;
    pdyn_get_constraint_sized(sim, constraint, &out, sizeof out);
    return out;
}

typedef struct pdyn_parameter_info {
    const char *name, *unit; /* unit "1": dimensionless */
    double value;
    double minimum, maximum; /* allowed values */
    bool changeable;         /* by pdyn_set_parameter (control.h) */
    const char *doc;         /* what it is, for users */
} pdyn_parameter_info;
/* The numeric parameters of a constraint, and those that are true (1) or false (0), as the
 * simulation uses them: given, default, or computed. parameter: index from 0. All members 0: no
 * such parameter. */
PDYN_API void pdyn_get_parameter_sized(const pdyn_sim *sim, int constraint, int parameter,
                                       pdyn_parameter_info *out, size_t size);
static inline pdyn_parameter_info pdyn_get_parameter(const pdyn_sim *sim, int constraint,
                                                     int parameter) {
    pdyn_parameter_info out;
    pdyn_get_parameter_sized(sim, constraint, parameter, &out, sizeof out);
    return out;
}

/* A vector, a path over time, or a table with a row for each part of the body. */
typedef struct pdyn_vector_info {
    const char *name, *unit;
    int count;           /* 3 numbers of a vector; 4 for each key of a path, time in s first; the
                            numbers of all rows of a table */
    const double *value; /* count; valid until the parameter is set */
    bool changeable;     /* by pdyn_set_parameter (control.h) */
    const char *doc;
    int width; /* numbers in each row of a table; 0: a vector or a path */
} pdyn_vector_info;
/* The vectors, paths and tables of a constraint. vector: index from 0. All members 0: no such
 * vector. */
PDYN_API void pdyn_get_vector_sized(const pdyn_sim *sim, int constraint, int vector,
                                    pdyn_vector_info *out, size_t size);
static inline pdyn_vector_info pdyn_get_vector(const pdyn_sim *sim, int constraint, int vector) {
    pdyn_vector_info out;
    pdyn_get_vector_sized(sim, constraint, vector, &out, sizeof out);
    return out;
}

/* A warning: a value of the scene that is legal but surely not meant, or something that went wrong
 * in steps. docs/guide/troubleshooting.md explains each code. */
typedef struct pdyn_warning {
    const char *code;    /* for example "leak" */
    const char *subject; /* name of the body or solid, "" for the whole scene */
    const char *text;    /* what was found, with numbers */
    long count;          /* number of steps or of particles, as the text says */
    double first, last;  /* s, times of the first and of the last occurrence; 0 for the scene */
} pdyn_warning;
/* The warnings so far, those about the scene first. warning: index from 0. Texts are valid until
 * the next step. All members 0: no such warning. */
PDYN_API void pdyn_get_warning_sized(const pdyn_sim *sim, int warning, pdyn_warning *out,
                                     size_t size);
static inline pdyn_warning pdyn_get_warning(const pdyn_sim *sim, int warning) {
    pdyn_warning out;
    pdyn_get_warning_sized(sim, warning, &out, sizeof out);
    return out;
}

/* Name of a solid, in the order of the scene. NULL: no such solid. */
PDYN_API const char *pdyn_solid_name(const pdyn_sim *sim, int solid);
/* The vertices of the mesh of a solid, where they are at the current time, m, vertices x 3; with
 * contact, a surface may hold the solid up before the place that its motion gives. x NULL: not
 * wanted. Returns the number of vertices; 0: no such solid. */
PDYN_API int pdyn_solid_vertices(const pdyn_sim *sim, int solid, double *x);
/* The triangles of this mesh, triangles x 3, indices of its vertices. They face outwards, those of
 * a box, too; its open sides have none. triangle NULL: not wanted. Returns the number of
 * triangles; 0: no such solid. */
PDYN_API int pdyn_solid_triangles(const pdyn_sim *sim, int solid, int *triangle);

/* The load on a solid at the end of the last step: force, N, and moment, N m, about the origin of
 * the world. It is the sum of
 *   - the pressure of the fluid: minus the gradient of the fluid's energy with respect to the
 *     solid's boundary points, at these points (pdyn_state.boundary_x). Those of a box lie behind
 *     its faces, 1.01 particle spacings with the boundary "surface", 1.29 with the kernel
 *     "wendland", and 0.6 with "points"; those of other solids lie on their surface;
 *   - shear of a fluid with the constraint no_slip;
 *   - contact and friction of cloth and of rigid and soft bodies that touch it.
 * It does not contain the springs of surface_tension at walls. With "euler" and without those, the
 * forces on all solids sum to the weight, plus the loads of pins and wind (pdyn_constraint_load,
 * probe.h), minus the change of momentum over h, up to the residual of the step. Particles removed
 * by an outlet at the end of the step are not included.
 *
 * The first call after a step computes the loads of all solids, on one thread, with the same bits
 * for any number of threads. Zero before the first step, after pdyn_restore until the next step,
 * and after a failed step. PDYN_BAD_CALL: an argument is NULL, or there is no such solid. */
PDYN_API pdyn_status pdyn_solid_load(const pdyn_sim *sim, int solid, double force[3],
                                     double moment[3]);

/* Save the state to a file, or restore it in a simulation loaded from the same scene. Only these
 * keys of the scene may differ: duration, step lengths, retries, tolerances and iterations of the
 * solver, and names and colours that no result depends on. Without a difference, the restored
 * simulation continues with the same bits as without interruption. The file appears complete or not
 * at all. PDYN_BAD_INPUT: not a saved state, or of another scene or
 * version, or a field is not valid. PDYN_IO_FAILED, PDYN_NO_MEMORY. After a failure the simulation
 * continues from its state before, but loads on solids may be zero until the next step; without
 * memory to bring that state back, later steps fail with PDYN_BAD_CALL. A successful pdyn_restore
 * revives a simulation that has failed. */
PDYN_API pdyn_status pdyn_save(pdyn_sim *sim, const char *path);
PDYN_API pdyn_status pdyn_restore(pdyn_sim *sim, const char *path);
/* The same with a buffer of the caller, which gets the bytes of the file of pdyn_save. *size:
 * number of bytes of the state; it changes from step to step. buffer NULL with capacity 0: computes
 * *size only. PDYN_BAD_CALL: the buffer is smaller, capacity < *size, and what it contains is no
 * state. */
PDYN_API pdyn_status pdyn_save_memory(pdyn_sim *sim, void *buffer, size_t capacity, size_t *size);
PDYN_API pdyn_status pdyn_restore_memory(pdyn_sim *sim, const void *buffer, size_t size);

/* Output directory. A frame has one file per body, DIR/NAME_000012.vtk (legacy VTK 4.2, binary),
 * listed with its time in DIR/NAME.vtk.series; `ply` adds NAME_000012.ply. DIR/NAME.obj has a
 * surface at the start, with the texture coordinates, groups and materials of the scene's OBJ file.
 * Boundary points of solids at rest are in DIR/boundary.vtk; those of moving solids have a file per
 * frame like a body "boundary". DIR/solids has the mesh of every solid: NAME.vtk, or for a solid
 * that moves a file per frame and NAME.vtk.series. Triangles face outwards, those of a box, too;
 * its open sides have none. DIR/files.json lists the files of bodies and solids:
 * pdyn_writer_open makes the directory and removes the files of the previous run in it, and no
 * other files. Files appear complete or not at all.
 *
 * On failure *out is NULL. PDYN_IO_FAILED: a file cannot be written. PDYN_BAD_INPUT: another
 * process writes to the directory, or the scene reads a file that this run would replace.
 * PDYN_NO_MEMORY. Close a writer before its simulation is freed. */
typedef struct pdyn_writer pdyn_writer;
PDYN_API pdyn_status pdyn_writer_open(pdyn_sim *sim, const char *directory, bool ply,
                                      pdyn_writer **out);
/* Writes a frame of the current state, in place of those of its time and later. PDYN_IO_FAILED,
 * PDYN_NO_MEMORY, also of the next three functions. */
PDYN_API pdyn_status pdyn_writer_frame(pdyn_writer *writer);
/* Adds a row to DIR/metrics.csv, and to DIR/probes.csv in a scene with probes. info: of the last
 * step; another one is PDYN_BAD_CALL. Rows of later times stay where a program has restored an
 * earlier state. */
PDYN_API pdyn_status pdyn_writer_step_sized(pdyn_writer *writer, const pdyn_step_info *info,
                                            size_t size);
static inline pdyn_status pdyn_writer_step(pdyn_writer *writer, const pdyn_step_info *info) {
    return pdyn_writer_step_sized(writer, info, sizeof *info);
}
/* Writes the report to `path`; path NULL: DIR/report.json. failed: why the run stopped early, or
 * NULL. */
PDYN_API pdyn_status pdyn_writer_report(pdyn_writer *writer, const char *path, bool interrupted,
                                        const char *failed);
/* Saves simulation and writer to DIR/state.pdyn. */
PDYN_API pdyn_status pdyn_writer_save(pdyn_writer *writer);
/* Continues the output of a run saved in DIR/state.pdyn. `sim` must be loaded from the same scene;
 * its state is restored. Errors as pdyn_restore and pdyn_writer_open. */
PDYN_API pdyn_status pdyn_writer_resume(pdyn_sim *sim, const char *directory, pdyn_writer **out);
/* Frees the writer; its files are complete without it. NULL: does nothing. */
PDYN_API void pdyn_writer_close(pdyn_writer *writer);

#ifdef __cplusplus
}
#endif
#endif
