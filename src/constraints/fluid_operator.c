/* The density constraint as a matrix-free operator: its memory and its table. The local step is in
 * fluid_local.c, the passes over pairs in fluid_pairs.c. */
#include "fluid_operator.h"

/* ---- memory ---------------------------------------------------------------------------------- */

/* Resizes an array: block NULL allocates, count 0 frees. Returns NULL without memory. */
static void *resize(struct fluid *f, void *block, size_t old_count, size_t count, size_t size) {
    return f->services->allocate(f->services->core, block, old_count * size, count * size);
}

/* Allocates or frees all arrays whose length follows from the number of particles or points. */
static bool resize_particles(struct fluid *f, bool allocate) {
    size_t particles = (size_t)f->particles, points = (size_t)f->points;
    size_t samples = (size_t)f->samples + 1; /* none: one, as NULL means no memory */
    const struct {
        void *pointer; /* address of the pointer to the array */
        size_t count, size;
    } all[] = {
        {&f->block_start, particles / FLUID_GRAIN + 2, sizeof(int)},
        {&f->pair_start, particles, sizeof(int)},
        {&f->pair_end, particles, sizeof(int)},
        {&f->x, 4 * points, sizeof(double)},
        {&f->gradient, 4 * particles, sizeof(double)},
        {&f->vector, 4 * particles, sizeof(double)},
        {&f->listed_sample, samples, sizeof(int)},
        {&f->growth, 9 * samples, sizeof(double)},
        {&f->tension, samples, sizeof(double)},
        {&f->value_before, particles, sizeof(double)},
        {&f->squares_before, particles, sizeof(double)},
        {&f->value, particles, sizeof(double)},
        {&f->squares, particles, sizeof(double)},
        {&f->stiffness, particles, sizeof(double)},
        {&f->flux, particles, sizeof(double)},
        {&f->weight_sum, particles, sizeof(double)},
        {&f->multiplier, particles, sizeof(double)},
        {&f->partial, particles / FLUID_GRAIN + 1, sizeof(double)},
    };
    bool good = true;
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        size_t count = all[k].count;
        void *array; /* memcpy: the pointers have different types */
        memcpy(&array, all[k].pointer, sizeof array);
        array = resize(f, array, allocate ? 0 : count, allocate ? count : 0, all[k].size);
        memcpy(all[k].pointer, &array, sizeof array);
        good &= array != NULL;
    }
    return good;
}

static void release_pairs(struct fluid *f) {
    if (f->pair_index) f->pair_index = resize(f, f->pair_index, f->pairs, 0, sizeof(int));
    if (f->pair) f->pair = resize(f, f->pair, 4 * f->pairs, 0, sizeof(float));
    f->pairs = 0;
}

static void release(void *self) {
    struct fluid *f = self;
    release_pairs(f);
    resize_particles(f, false);
    resize(f, f, 1, 0, sizeof *f);
}

static void *create(const void *par, const pdyn_body *body, const pdyn_services *services) {
    struct fluid *f = services->allocate(services->core, NULL, 0, sizeof *f);
    if (!f) return NULL;
    f->services = services;
    f->params = *(const struct fluid_params *)par;
    f->spacing = 2.0 * body->radius, f->particle_volume = fluid_particle_volume(body);
    f->first = body->first, f->count = body->count;
    f->rest_density = body->rest_density;
    f->factor = 1.0;
    return f;
}

static void set_params(void *self, const void *par) {
    ((struct fluid *)self)->params = *(const struct fluid_params *)par;
}

static void copy_boundary(struct fluid *f) {
    for (int i = f->particles; i < f->points; i++)
        memcpy(f->x + 4 * i, f->lists->boundary_x + 3 * (i - f->particles), 3 * sizeof *f->x);
    f->boundary_revision = f->lists->boundary_revision;
}

/* The local step sets volumes of samples. */
static void set_points(struct fluid *f) {
    for (int i = 0; i < f->points; i++)
        if (i < f->particles - f->samples || i >= f->particles)
            f->x[4 * i + 3] = f->lists->volume[i] / f->particle_volume;
    f->volume_revision = f->lists->volume_revision;
    copy_boundary(f);
}

/* Number of listed neighbours of particle i that its pairs may be with (fluid_local.c). */
static int count_listed(const struct fluid *f, int i) {
    const pdyn_neighbours *l = f->lists;
    int own = 0;
    if (is_fluid(f, i)) return l->boundary_start[i] - l->start[i];
    for (int s = l->start[i]; s < l->surface_start[i]; s++) own += is_fluid(f, l->index[s]);
    return own;
}

/* Assigns each block of particles a range of pairs; returns the number of pairs. */
static size_t place_blocks(struct fluid *f) {
    int blocks = (f->particles + FLUID_GRAIN - 1) / FLUID_GRAIN;
    for (int b = 0; b < blocks; b++) f->block_start[b + 1] = 0;
    for (int i = 0; i < f->particles; i++)
        f->block_start[i / FLUID_GRAIN + 1] += count_listed(f, i);
    for (int b = 0; b < blocks; b++) f->block_start[b + 1] += f->block_start[b];
    return (size_t)f->block_start[blocks];
}

/* The local step visits only particles in blocks that take part. */
static void clear_others(struct fluid *f) {
    for (int i = 0; i < f->particles; i++) {
        if (takes_part(f, i, i + 1, i / FLUID_GRAIN)) continue;
        f->pair_start[i] = f->pair_end[i] = 0, f->weight_sum[i] = 0.0;
    }
}

static void list_samples(struct fluid *f) {
    const int first = f->particles - f->samples;
    f->listed = 0;
    for (int k = 0; k < f->samples; k++)
        if (f->lists->end[first + k] > f->lists->start[first + k])
            f->listed_sample[f->listed++] = k;
}

static bool neighbours(void *self, const pdyn_neighbours *lists) {
    struct fluid *f = self;
    f->lists = lists;
    if (!f->x) {
        f->kernel = fluid_kernel(lists->kernel, f->spacing);
        f->surface = fluid_surface_kernel(lists->kernel, f->spacing);
        f->particles = lists->particles, f->points = lists->points;
        f->samples = lists->samples;
        if (!resize_particles(f, true)) return false;
        for (int i = 0; i < f->particles; i++) f->value_before[i] = -1.0;
    }
    if (f->volume_revision != lists->volume_revision) set_points(f);
    size_t pairs = place_blocks(f);
    clear_others(f), list_samples(f);
    if (pairs <= f->pairs) return true;
    release_pairs(f);
    f->pairs = pairs + pairs / 4; /* spare room: later steps seldom allocate */
    f->pair_index = resize(f, NULL, 0, f->pairs, sizeof(int));
    f->pair = resize(f, NULL, 0, 4 * f->pairs, sizeof(float));
    if (f->pair_index && f->pair) return true;
    release_pairs(f);
    return false;
}

/* ---- callbacks ------------------------------------------------------------------------------- */

/* Within a step E is a function of x with an exact gradient: k_i and C^n are constant. Volumes of
 * samples follow the areas of their triangles (fluid_local.c). */
static void begin_range(void *arg, int first, int last, int block) {
    (void)block;
    struct fluid *f = ((const struct fluid_call *)arg)->f;
    for (int i = f->first + first; i < f->first + last; i++)
        f->stiffness[i] = f->factor * fluid_stiffness_at(f, f->squares_before[i]);
}

/* In the first step nothing is known of the step before: k_i is that of the first iterate, and
 * nothing is damped. */
static void begin(void *self, double h) {
    struct fluid *f = self;
    bool known = f->count && f->value_before[f->first] >= 0.0;
    double damping = known ? f->params.damping : 0.0;
    f->factor = 1.0 + damping / h, f->part = damping / (h + damping);
    if (known) for_particles(f, f->count, begin_range, NULL, NULL);
    else memset(f->stiffness + f->first, 0, (size_t)f->count * sizeof *f->stiffness);
}

static double local(void *self, const double *x, double *gradient) {
    struct fluid *f = self;
    if (f->volume_revision != f->lists->volume_revision) set_points(f);
    if (f->boundary_revision != f->lists->boundary_revision) copy_boundary(f);
    double energy = fluid_project(f, x);
    fluid_add_gradients(f, f->flux, gradient);
    return energy;
}

static pdyn_one_sided one_sided(void *self) {
    const struct fluid *f = self;
    return (pdyn_one_sided){.count = f->count,
                            .value = f->value + f->first,
                            .stiffness = f->stiffness + f->first,
                            .squares = f->squares + f->first,
                            .weight_sum = f->weight_sum};
}

/* C_i */
static double compression(const struct fluid *f, int i) {
    return f->value[i] + f->part * f->value_before[i];
}

static double stored(const void *self, int i) {
    const struct fluid *f = self;
    double c = fmax(0.0, compression(f, f->first + i));
    return 0.5 * f->stiffness[f->first + i] / f->factor * c * c;
}

static void density(void *self, double *out) {
    const struct fluid *f = self;
    for (int i = f->first; i < f->first + f->count; i++)
        out[i] = f->rest_density * (1.0 + compression(f, i));
}

/* Pressure from virtual work: flux dC = -p dV and dC = -dV / V give p = flux / V. */
static void pressure(void *self, double *out) {
    const struct fluid *f = self;
    for (int i = f->first; i < f->first + f->count; i++) out[i] = f->flux[i] / f->particle_volume;
}

/* Between steps value_i is C_i. */
static void end_step(void *arg, int first, int last, int block) {
    (void)block;
    struct fluid *f = ((const struct fluid_call *)arg)->f;
    for (int i = f->first + first; i < f->first + last; i++) {
        f->value[i] = compression(f, i);
        f->value_before[i] = fmax(0.0, f->value[i]);
        f->squares_before[i] = f->squares[i];
    }
}

static void accept(void *self) {
    struct fluid *f = self;
    for_particles(f, f->count, end_step, NULL, NULL);
    f->part = 0.0;
}

/* False for NaN. */
static bool in_range(double number) { return number >= 0.0 && number < 1e100; }

/* value_before is -1 before the first step. */
static pdyn_status persist(void *self, pdyn_snapshot *snapshot) {
    struct fluid *f = self;
    size_t bytes = (size_t)f->count * sizeof(double);
    bool valid = true;
    snapshot->bytes(snapshot, f->value_before + f->first, bytes);
    snapshot->bytes(snapshot, f->squares_before + f->first, bytes);
    for (int i = f->first; i < f->first + f->count; i++) {
        valid &= f->value_before[i] == -1.0 || in_range(f->value_before[i]);
        valid &= in_range(f->squares_before[i]);
    }
    return valid || !snapshot->reading
               ? PDYN_OK
               : f->services->set_error(
                     f->services->core, PDYN_BAD_INPUT,
                     "not a saved state of this scene: a density of the fluid is out of range");
}

const pdyn_operator fluid_operator = {
    .create = create,
    .free = release,
    .neighbours = neighbours,
    .begin = begin,
    .local = local,
    .one_sided = one_sided,
    .rate = fluid_rate,
    .force = fluid_force,
    .diagonal = fluid_diagonal,
    .density = density,
    .pressure = pressure,
    .velocity = fluid_viscosity,
    .persist = persist,
    .limit = fluid_limit,
    .stored = stored,
    .accept = accept,
    .boundary_force = fluid_boundary_force,
    .set_params = set_params,
};
