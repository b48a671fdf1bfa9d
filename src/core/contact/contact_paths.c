/* Continuous collision detection: paths without collision. Every point moves by a part of its
 * displacement. A pair that would collide shortens the parts of its four points; then all pairs of
 * these points are tested again, until no pair collides. All points of a solid or a rigid
 * body move by the same part, the smallest one. */
#include "contact_parts.h"

#include "projdyn/vec3.h"

/* Rounds, after which a pair that is still blocked is shortened so far that it cannot collide. */
enum { ROUNDS = 32 };

struct round {
    struct contact *contact;
    int number;
};

/* The distance that a path leaves a pair, m: half of its distance or thickness (a quarter after the
 * first round), so that only pairs in contact are stopped. */
static double kept(const struct contact *c, const struct pair *p, double distance, int round) {
    double some = (round ? 0.25 : 0.5) * fmin(distance, p->thickness);
    return fmax(some, fmin(distance, c->path.least * p->thickness));
}

static bool was_cut(const struct contact *c, const struct pair *p) {
    const double *cut = c->path.cut;
    return cut[p->point[0]] < 1.0 || cut[p->point[1]] < 1.0 || cut[p->point[2]] < 1.0 ||
           cut[p->point[3]] < 1.0;
}

/* The part of its displacement, 0 to 1, by which the pair may move. */
static double free_part(const struct contact *c, const struct pair *p, int round) {
    const struct pair_kind *kind = pair_kind_of(p->key);
    const double *x[4], *d[4];
    double unused[4], approach = pair_largest(p, c->path.length);
    pair_load(p->point, c->path.x, x);
    double distance = sqrt(kind->closest(x, unused)), keep = kept(c, p, distance, round);
    if (distance - approach >= keep) return 1.0;
    pair_load(p->point, c->path.step, d);
    if (distance - pair_closing_bound(kind, d) >= keep) return 1.0;
    if (round >= ROUNDS) return fmin(0.2 * distance, distance - keep) / approach;
    return pair_free_path(kind, x, d, keep);
}

/* Lists the pairs of a block whose displacements are not too short to block them. */
static void find_candidates(struct contact *c, int first, int last, int block) {
    int count = 0;
    for (int k = first; k < last; k++) {
        const struct pair *p = &c->pairs.pair[k];
        double least =
            p->distance - pair_largest(p, c->pairs.moved) - pair_largest(p, c->path.length);
        if (least < 0.5 * p->thickness) c->path.candidate[first + count++] = k;
    }
    c->path.candidates[block] = count;
}

static void find_blocked(void *arg, int first, int last, int block) {
    const struct round *r = arg;
    struct contact *c = r->contact;
    int count = 0;
    if (!r->number) find_candidates(c, first, last, block);
    for (int j = first; j < first + c->path.candidates[block]; j++) {
        int k = c->path.candidate[j];
        if (r->number && !was_cut(c, &c->pairs.pair[k])) continue;
        double part = free_part(c, &c->pairs.pair[k], r->number);
        if (part < 1.0) c->path.blocked[first + count++] = (struct blocked){k, part};
    }
    c->path.blocked_count[block] = count;
}

/* Makes the factors of some points the same, the smallest one. */
static void keep_whole(double *cut, int count) {
    double least = 1.0;
    for (int i = 0; i < count; i++) least = fmin(least, cut[i]);
    for (int i = 0; i < count; i++) cut[i] = least;
}

static void keep_rigid_whole(struct contact *c) {
    for (int s = 0; s < c->groups - c->bodies; s++)
        keep_whole(c->path.cut + c->solid[s].first, c->solid[s].count);
    for (int k = 0; k < c->rigids; k++)
        keep_whole(c->path.cut + c->rigid[k].first, c->rigid[k].count);
}

/* Shortens the displacements of blocked pairs. Returns false if there are none. */
static bool shorten(struct contact *c) {
    struct contact_paths *path = &c->path;
    bool any = false;
    for (int i = 0; i < c->points; i++) path->cut[i] = 1.0;
    for (int b = 0; b < pool_blocks(c->pairs.count, CONTACT_GRAIN); b++)
        for (int k = 0; k < path->blocked_count[b]; k++) {
            const struct blocked *at = &path->blocked[b * CONTACT_GRAIN + k];
            any = true;
            for (int m = 0; m < 4; m++) {
                double *cut = &path->cut[c->pairs.pair[at->pair].point[m]];
                *cut = fmin(*cut, at->part);
            }
        }
    if (!any) return false;
    keep_rigid_whole(c);
    for (int i = 0; i < c->points; i++) {
        if (path->cut[i] == 1.0) continue;
        path->taken[i] *= path->cut[i], path->length[i] *= path->cut[i];
        for (int a = 0; a < 3; a++) path->step[3 * i + a] *= path->cut[i];
    }
    return true;
}

pdyn_status contact_shorten_paths(struct contact *c, double least) {
    c->path.least = least;
    pdyn_status status = contact_update_pairs(c, c->path.x, c->path.step);
    struct round round = {.contact = c};
    for (int i = 0; i < c->points; i++) {
        c->path.length[i] = vec3_length(c->path.step + 3 * i);
        c->path.taken[i] = 1.0;
    }
    for (bool blocked = status == PDYN_OK; blocked; round.number++) {
        pool_for(c->context->pool, c->pairs.count, CONTACT_GRAIN, find_blocked, &round);
        blocked = shorten(c);
    }
    return status;
}
