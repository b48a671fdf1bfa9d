/* The steps of contact within a time step (contact.h), and saved states. */
#include "bearings.h"
#include "contact_parts.h"

#include "base/clock.h"
#include "scene/poses.h"

#include "projdyn/vec3.h"

#include <string.h>

double contact_ms(const struct contact *c) { return c->ms; }
void contact_clear_ms(struct contact *c) { c->ms = 0.0; }

/* ---- solids ---------------------------------------------------------------------------------- */

/* The coordinates of solids: the last ones of an array points x 3. */
static double *solids_in(const struct contact *c, double *points) {
    return points + 3 * (size_t)c->free;
}
static size_t solid_numbers(const struct contact *c) { return 3 * (size_t)(c->points - c->free); }

static void copy_solids(const struct contact *c, const double *from, double *to) {
    if (solid_numbers(c)) memcpy(to, from, solid_numbers(c) * sizeof *to);
}

/* The displacement of solids from c->path.x to their goals; 0 where none moves. */
static void step_solids(struct contact *c) {
    double *step = solids_in(c, c->path.step);
    const double *x = solids_in(c, c->path.x);
    for (size_t k = 0; k < solid_numbers(c); k++) step[k] = c->moving ? c->goal[k] - x[k] : 0.0;
}

/* Moves solids by the part of their displacement that is free. */
static void move_solids(struct contact *c) {
    double *at = solids_in(c, c->at);
    const double *x = solids_in(c, c->path.x), *step = solids_in(c, c->path.step);
    c->lagging = false;
    if (!c->moving) return;
    for (size_t k = 0; k < solid_numbers(c); k++) at[k] = x[k] + step[k];
    for (int i = c->free; i < c->points; i++) c->lagging |= c->path.taken[i] < 1.0;
}

static void set_goals(struct contact *c, double time) {
    for (int s = 0; s < c->groups - c->bodies; s++) {
        const struct contact_solid *solid = &c->solid[s];
        if (solid->solid->motion.keys)
            pose_place(&solid->solid->motion, c->rest + 3 * (size_t)solid->first, solid->count,
                       time, c->goal + 3 * (size_t)(solid->first - c->free));
    }
}

/* The poses at time 0: solids that do not move are at rest. */
static void place_solids(struct contact *c) {
    copy_solids(c, solids_in(c, c->rest), c->goal);
    set_goals(c, 0.0);
    copy_solids(c, c->goal, solids_in(c, c->at));
}

const double *contact_solid_at(const struct contact *c, int solid) {
    return c->at + 3 * (size_t)c->solid[solid].first;
}

bool contact_is_lagging(const struct contact *c) { return c->lagging; }

double contact_lag(const struct contact *c, int solid) {
    const double *at = contact_solid_at(c, solid);
    const double *goal = c->goal + 3 * (size_t)(c->solid[solid].first - c->free);
    double lag = 0.0;
    for (int i = 0; i < c->solid[solid].count; i++)
        lag = fmax(lag, vec3_distance(at + 3 * (size_t)i, goal + 3 * (size_t)i));
    return lag;
}

/* ---- positions ------------------------------------------------------------------------------- */

/* Collects the positions of all points, with free particles at x and solids where they are. */
static void gather(const struct contact *c, const double *x, double *at) {
    for (int i = 0; i < c->free; i++) memcpy(at + 3 * i, x + 3 * c->column[i], 3 * sizeof *at);
    if (at != c->at) copy_solids(c, solids_in(c, c->at), solids_in(c, at));
}

pdyn_status contact_local(struct contact *c, const double *x) {
    double start = clock_ms();
    gather(c, x, c->at);
    pdyn_status status = contact_update_pairs(c, c->at, NULL);
    if (status == PDYN_OK) status = contact_find(c);
    if (c->moving) contact_follow_solids(c);
    c->ms += clock_ms() - start;
    return status;
}

pdyn_status contact_place(struct contact *c, const double *x) {
    place_solids(c);
    gather(c, x, c->at);
    contact_set_start_positions(c);
    pdyn_status status = contact_local(c, x);
    return status == PDYN_OK ? contact_check(c, c->body.first, c->body.count) : status;
}

/* ---- the beginning of a step, and its end where it failed ------------------------------------ */

pdyn_status contact_begin(struct contact *c, const double *x, double time) {
    double start = clock_ms();
    c->common.known = false;
    memset(c->common.displacement, 0, 3 * (size_t)c->bodies * sizeof *c->common.displacement);
    copy_solids(c, solids_in(c, c->at), c->begin);
    if (c->moving) set_goals(c, time);
    contact_set_start_positions(c);
    pdyn_status status = contact_set_start(c);
    if (status == PDYN_OK && c->bearings) status = bearings_update(c, x);
    c->ms += clock_ms() - start;
    return status;
}

pdyn_status contact_take_back(struct contact *c, const double *x) {
    copy_solids(c, c->begin, solids_in(c, c->at));
    return contact_local(c, x);
}

/* ---- paths ----------------------------------------------------------------------------------- */

/* Shortens the displacements of the particles that carry rigid bodies as those of the bodies, from
 * x, moved by the common displacement (NULL: from 0), to target, particles x 3. */
static void shorten_carriers(const struct contact *c, const double *x, double *target) {
    for (int k = 0; k < c->rigids; k++) {
        double part = c->path.taken[c->rigid[k].first];
        const double *common = contact_common(c, c->rigid[k].group);
        size_t first = 3 * (size_t)c->rigid[k].carrier;
        for (size_t j = 0; part < 1.0 && j < 3 * (size_t)RIGID_POINTS; j++) {
            double from = x ? x[first + j] + common[j % 3] : 0.0;
            target[first + j] = from + part * (target[first + j] - from);
        }
    }
}

/* Sets the paths to target from x, bodies moved by their common displacement. */
static void set_paths(struct contact *c, const double *x, const double *target) {
    gather(c, x, c->path.x);
    for (int i = 0; i < c->free; i++) {
        vec3_add(c->path.x + 3 * i, 1.0, c->common.displacement + 3 * c->group[i]);
        for (int a = 0; a < 3; a++)
            c->path.step[3 * i + a] = target[3 * c->column[i] + a] - c->path.x[3 * i + a];
    }
    step_solids(c);
}

/* Finds the common motion for the rest of the step, at its first path that is not free. */
static pdyn_status find_common_motion(struct contact *c, const double *x, const double *target) {
    set_paths(c, x, target);
    pdyn_status status = common_motion_find(c);
    c->common.known = true;
    set_paths(c, x, target);
    return status == PDYN_OK ? contact_shorten_paths(c, CONTACT_GAP) : status;
}

pdyn_status contact_filter_start(struct contact *c, const double *x, double *target) {
    double start = clock_ms();
    copy_solids(c, c->begin, solids_in(c, c->at));
    set_paths(c, x, target);
    pdyn_status status = contact_shorten_paths(c, CONTACT_GAP);
    if (status == PDYN_OK && !c->common.known && contact_least(c) < 1.0)
        status = find_common_motion(c, x, target);
    for (int i = 0; i < c->free; i++)
        if (c->path.taken[i] < 1.0)
            for (int a = 0; a < 3; a++)
                target[3 * c->column[i] + a] = c->path.x[3 * i + a] + c->path.step[3 * i + a];
    shorten_carriers(c, x, target);
    move_solids(c);
    c->ms += clock_ms() - start;
    return status;
}

pdyn_status contact_filter(struct contact *c, const double *x, double *direction) {
    double start = clock_ms();
    gather(c, x, c->path.x);
    gather(c, direction, c->path.step);
    for (size_t k = 0; k < solid_numbers(c); k++) solids_in(c, c->path.step)[k] = 0.0;
    pdyn_status status = contact_shorten_paths(c, CONTACT_LEAST);
    for (int i = 0; i < c->free; i++)
        if (c->path.taken[i] < 1.0)
            memcpy(direction + 3 * c->column[i], c->path.step + 3 * i, 3 * sizeof *direction);
    shorten_carriers(c, NULL, direction);
    c->ms += clock_ms() - start;
    return status;
}

pdyn_status contact_advance(struct contact *c, const double *x) {
    double start = clock_ms();
    gather(c, x, c->path.x);
    memset(c->path.step, 0, 3 * (size_t)c->free * sizeof *c->path.step);
    step_solids(c);
    pdyn_status status = contact_shorten_paths(c, CONTACT_GAP);
    move_solids(c);
    c->ms += clock_ms() - start;
    return status;
}

const double *contact_common(const struct contact *c, int body) {
    return c->common.displacement + 3 * (size_t)body;
}

double contact_least(const struct contact *c) {
    double least = 1.0;
    for (int i = 0; i < c->free; i++) least = fmin(least, c->path.taken[i]);
    return least;
}

/* ---- saved states ---------------------------------------------------------------------------- */

/* Whether the regions contain their points, or are empty for a particle, and are as large as their
 * reaches say, up to rounding. A wrong size would make the list of pairs incomplete, or much too
 * long. */
static bool regions_are_valid(const struct contact *c) {
    bool valid = true;
    for (int i = 0; i < c->points; i++) {
        double far = 0.0, size = 0.0;
        if (is_particle(c, i) && box_is_empty(&c->broad.region[i])) continue;
        for (int a = 0; a < 3; a++) {
            double low = c->broad.built[3 * i + a] - c->broad.region[i].min[a];
            double high = c->broad.region[i].max[a] - c->broad.built[3 * i + a];
            double side = fmax(low, high);
            valid &= low >= 0.0 && high >= 0.0;
            far += side * side, size += fabs(c->broad.built[3 * i + a]);
        }
        double rounding = 1e-9 * (c->broad.reach[i] + size + c->settings->thickness);
        valid &= fabs(sqrt(far) - c->broad.reach[i]) <= rounding; /* false for NaN, too */
    }
    return valid;
}

/* After reading, the pairs are found again as in the last search, from regions and positions of
 * that time: particles that came, went or were moved since are looked at by the next step, with or
 * without a restart between. */
void contact_persist(struct contact *c, struct snapshot_file *file) {
    size_t n = (size_t)c->points;
    snapshot_file_bytes(file, c->broad.region, n * sizeof *c->broad.region);
    snapshot_file_numbers(file, c->broad.reach, n, "a reach of contact is not finite");
    snapshot_file_numbers(file, c->broad.built, 3 * n, "a position of contact is not finite");
    snapshot_file_range(file, c->at, 3 * n, STATE_MAX_POSITION,
                        "a position of contact is out of range");
    snapshot_file_flags(file, &c->lagging, 1, "the flag of solids is neither 0 nor 1");
    row_memory_persist(c->context, &c->pressed, sizeof *c->current.force, file);
    if (!file->view.reading || file->status != PDYN_OK) return;
    snapshot_file_require(file, regions_are_valid(c), "a region of contact is wrong");
    if (file->status == PDYN_OK) file->status = contact_search_pairs(c);
    contact_measure_moved(c, c->at);
    if (file->status == PDYN_OK) file->status = contact_find(c);
    if (file->status == PDYN_OK) contact_set_start_positions(c);
}
