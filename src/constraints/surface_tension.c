/* Surface tension and contact angle of a fluid: springs between the particles of its surface.
 *
 * The area of a surface is at most half the integral of |grad x|^2 over the surface where it was
 * when the step began, with equality there (Dziuk 1991); the tension times that integral is the
 * energy of springs of rest length 0 between neighbours on the surface (Belkin and Niyogi 2008):
 *
 *     E = sum over pairs w_ij/2 |x_i - x_j|^2
 *     w_ij = b_ij/2 (s_i a_j + s_j a_i),   s_i = 4 A tension a_i / sum_j b_ij a_j r_ij^2
 *     a_i = 2 V |n_i|,   n_i = sum_j V grad W(x_i - x_j),   b = q^3 (1 - q)^2,  q = r / support
 *
 * a_i is the surface's area at particle i (Brackbill, Kothe and Zemach 1992). The sum of w r^2 over
 * pairs is 2 A tension times the area, whatever b is. Weights are those of the beginning of the
 * step. The fluid has two surfaces: the free one, which has the tension, and the wet one at walls,
 * with -tension (cos(contact angle) + o) (Young 1805; o is measured), whose springs push where that
 * is negative. Walls count as fluid in n_i, so the free surface ends where the wet one begins.
 * Particles nearer than d / 2 count as that far in s_i: the weight of two that are alone has a
 * bound.
 * docs/theory/surface-tension.md */
#include "fluid.h"
#include "listed_points.h"

#include <string.h>

struct params {
    double tension, contact_angle;
};

static const pdyn_param params[] = {
    {"tension", PDYN_REAL, offsetof(struct params, tension), true, 0, 0, 1e3, "N/m",
     "energy per area of the surface"},
    {"contact_angle", PDYN_REAL, offsetof(struct params, contact_angle), false, 90, 0, 180,
     "degrees", "angle in the fluid between its surface and walls, sheets and solids"},
    {0}};

/* Measured on drops on a plate. The work of adhesion is done within 1/reach of a spacing, about as
 * far as a wall is felt; the lowest layer of a drop has no free surface with this part of m. */
static const double reach = 2.5, wall_part = 0.8;

/* The part of a particle in one of the two surfaces. */
struct share {
    double area; /* a, m^2; 0: none */
    double rate; /* s for a tension A of 1 N/m, 1/m^2 */
};

struct site {         /* a particle */
    double normal[3]; /* n, with walls, 1/m: into the fluid */
    double wall[3];   /* m, the part by walls, 1/m: into the wall */
    struct share free, wet;
    int sample; /* the nearest sample of sheets and bodies; -1: a solid is nearer, or none */
};

enum { ENDS = 4 };

struct link { /* an element: the sum of coefficient x particle is pulled to `target` */
    int end[ENDS];
    double coefficient[ENDS]; /* 0: the end is not used */
    double weight, target[3];
};

struct links { /* of a step: those beyond `room` are counted, not stored */
    struct link *link;
    int count, room;
};

/* 0 inside, where |n| d is noise; 1 on a surface, where it is about 0.5 */
static double is_surface(double slope) {
    double t = fmin(1.0, fmax(0.0, (slope - 0.1) / 0.3));
    return t * t * (3.0 - 2.0 * t);
}

static double cosine(const struct params *p) {
    return cos(p->contact_angle / 180.0 * 3.14159265358979323846);
}

/* ---- particles ------------------------------------------------------------------------------- */

static void add_fluid(const pdyn_batch *b, const double *x, int i, struct site *site) {
    const pdyn_neighbours *l = b->neighbours;
    struct kernel kernel = fluid_kernel(l->kernel, 2.0 * b->body->radius);
    for (int k = l->start[i]; k < l->surface_start[i]; k++) {
        int j = l->index[k];
        if (!body_has(b->body, j)) continue;
        double r[3] = {x[3 * i] - x[3 * j], x[3 * i + 1] - x[3 * j + 1],
                       x[3 * i + 2] - x[3 * j + 2]};
        vec3_add(site->normal, kernel_slope(&kernel, vec3_length(r)), r);
    }
}

/* Without "points" the density of walls is twice as steep as that of a layer of fluid. */
static void add_walls(const pdyn_batch *b, const double *x, int i, struct site *site) {
    const pdyn_neighbours *l = b->neighbours;
    struct kernel kernel = fluid_kernel(l->kernel, 2.0 * b->body->radius);
    struct surface_kernel surface = fluid_surface_kernel(l->kernel, 2.0 * b->body->radius);
    double share = (l->has_volumes ? 1.0 : 0.5) / fluid_particle_volume(b->body),
           nearest = HUGE_VAL;
    for (int k = l->surface_start[i]; k < l->end[i]; k++) {
        double at[3], r[3];
        listed_position(l, x, l->index[k], at);
        for (int a = 0; a < 3; a++) r[a] = x[3 * i + a] - at[a];
        double squared = vec3_dot(r, r), slope = listed_has_area(l, i, k)
                                                     ? surface_kernel_slope(&surface, squared)
                                                     : kernel_slope(&kernel, sqrt(squared));
        vec3_add(site->wall, share * l->volume[l->index[k]] * slope, r);
        if (squared >= nearest) continue;
        nearest = squared, site->sample = l->index[k] < l->particles ? l->index[k] : -1;
    }
}

static void find_site(const pdyn_batch *b, const double *x, int i, struct site *site) {
    double d = 2.0 * b->body->radius;
    *site = (struct site){.sample = -1};
    add_fluid(b, x, i, site);
    add_walls(b, x, i, site);
    vec3_add(site->normal, wall_part, site->wall);
    double slope = d * vec3_length(site->normal);
    site->free.area = 2.0 * d * d * slope * is_surface(slope);
    site->wet.area = d * d * fmin(1.0, 2.0 * d * vec3_length(site->wall));
}

/* Whether a particle is in no surface. */
static bool is_inside(const struct site *site) {
    return !(site->free.area > 0.0 || site->wet.area > 0.0);
}

/* ---- pairs ----------------------------------------------------------------------------------- */

static double bond(double support, double r) {
    double q = r / support;
    return q < 1.0 ? q * q * q * (1.0 - q) * (1.0 - q) : 0.0;
}

/* 4 a_i over the sum of b_ij a_j max(r_ij, d / 2)^2, for both surfaces */
static void find_rates(const pdyn_batch *b, const double *x, int i, struct site *site) {
    const pdyn_neighbours *l = b->neighbours;
    double free = 0.0, wet = 0.0, nearest = b->body->radius;
    if (is_inside(&site[i])) return;
    for (int k = l->start[i]; k < l->surface_start[i]; k++) {
        int j = l->index[k];
        if (!body_has(b->body, j)) continue;
        double r = vec3_distance(x + 3 * i, x + 3 * j), far = fmax(r, nearest);
        double moment = bond(l->support, r) * far * far;
        free += moment * site[j].free.area, wet += moment * site[j].wet.area;
    }
    site[i].free.rate = free > 0.0 ? 4.0 * site[i].free.area / free : 0.0;
    site[i].wet.rate = wet > 0.0 ? 4.0 * site[i].wet.area / wet : 0.0;
}

static double pair_weight(const struct share *i, const struct share *j) {
    return 0.5 * (i->rate * j->area + j->rate * i->area);
}

/* Pairs of particle i, ascending, so that their order is not that of the lists. */
static void add_pairs(const struct params *p, const pdyn_batch *b, const double *x, int i,
                      const struct site *site, struct links *links) {
    const pdyn_neighbours *l = b->neighbours;
    const struct kernel_model *kernel = l->kernel;
    struct link *link = links->link;
    if (is_inside(&site[i])) return;
    double free = kernel->tension * p->tension,
           wet = -p->tension * (cosine(p) + kernel->wetting_offset);
    int first = links->count;
    for (int k = l->start[i]; k < l->surface_start[i]; k++) {
        int j = l->index[k];
        if (j <= i || !body_has(b->body, j) || is_inside(&site[j])) continue;
        double near = bond(l->support, vec3_distance(x + 3 * i, x + 3 * j));
        double pull = near * free * pair_weight(&site[i].free, &site[j].free),
               along = near * wet * pair_weight(&site[i].wet, &site[j].wet), w = pull + fabs(along);
        if (!(w > 0.0)) continue;
        int at = links->count++;
        if (at >= links->room) continue;
        for (; at > first && link[at - 1].end[1] > j; at--) link[at] = link[at - 1];
        link[at] = (struct link){{i, j, i, i}, {1.0, -1.0}, w, {0}};
        if (along < 0.0) /* a spring of twice their distance pushes with the force of this one */
            for (int a = 0; a < 3; a++)
                link[at].target[a] = -2.0 * along / w * (x[3 * i + a] - x[3 * j + a]);
    }
}

/* ---- walls ----------------------------------------------------------------------------------- */

/* From particle i to a sample, at the weights of its corners: the sum of coefficient x particle. */
static void tie_to_sample(const pdyn_batch *b, int i, int sample, struct link *link) {
    const pdyn_neighbours *l = b->neighbours;
    for (int k = 1; k < ENDS; k++) link->end[k] = i;
    link->end[0] = i, link->coefficient[0] = 1.0;
    if (sample < 0) return;
    for (int k = 1; k < ENDS; k++) {
        int corner = sample_corner(l, sample) + k - 1;
        link->end[k] = l->sample_vertex[corner];
        link->coefficient[k] = -l->sample_weight[corner];
    }
}

/* The pull of walls, sheets and solids on a particle that touches them, which does the work of
 * adhesion tension (1 + cos angle) per area (Dupre 1869) within a spacing: a spring to a point one
 * spacing away; its force changes little in a step. */
static void add_pull(const struct params *p, const pdyn_batch *b, const double *x, int i,
                     const struct site *site, struct links *links) {
    if (!(site->wet.area > 0.0)) return;
    double d = 2.0 * b->body->radius, steep = vec3_length(site->wall),
           force = reach * p->tension * (1.0 + cosine(p)) * site->wet.area / d;
    if (!(force > 0.0)) return;
    struct link link = {.weight = force / d};
    tie_to_sample(b, i, site->sample, &link);
    for (int k = 0; k < ENDS; k++)
        vec3_add(link.target, link.coefficient[k], x + 3 * (size_t)link.end[k]);
    vec3_add(link.target, d / steep, site->wall);
    if (links->count < links->room) links->link[links->count] = link;
    links->count++;
}

/* ---- callbacks ------------------------------------------------------------------------------- */

static int update(const void *par, const pdyn_batch *b, const double *x, const double *v,
                  int room) {
    (void)v;
    const struct params *p = par;
    int first = b->body->first, last = first + b->body->count;
    struct links links = {.link = b->data, .room = room};
    struct site *site = (struct site *)b->scratch - first;
    for (int i = first; i < last; i++) find_site(b, x, i, &site[i]);
    for (int i = first; i < last; i++) find_rates(b, x, i, site);
    for (int i = first; i < last; i++) {
        add_pairs(p, b, x, i, site, &links);
        add_pull(p, b, x, i, &site[i], &links);
    }
    return links.count;
}

static void select(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) {
        const struct link *link = (const struct link *)b->data + e;
        memcpy(b->column + ENDS * e, link->end, sizeof link->end);
        memcpy(b->coefficient + ENDS * e, link->coefficient, sizeof link->coefficient);
    }
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->weight[e] = ((const struct link *)b->data)[e].weight;
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++)
        memcpy(b->p + 3 * e, ((const struct link *)b->data)[e].target, 3 * sizeof(double));
}

const pdyn_constraint_type pdyn_constraint_surface_tension = {
    .name = "surface_tension",
    .summary = "surface tension and contact angle of a fluid",
    .flags = PDYN_ON_PARTICLES | PDYN_NEIGHBOURS,
    .params_size = sizeof(struct params),
    .params = params,
    .data_size = sizeof(struct link),
    .scratch_size = sizeof(struct site),
    .update = update,
    .rows = 1,
    .width = ENDS,
    .select = select,
    .weight = weight,
    .project = project,
};
