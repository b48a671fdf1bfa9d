/* Warnings about particles of a fluid that are too close to each other at the start: volumes of
 * `fill` that overlap. */
#include "sim/sim.h"
#include "warn.h"

#include "projdyn/vec3.h"

/* Particles of volumes that do not overlap are at least a spacing apart; of two lattices in each
 * other they are at most 0.87 spacings apart. In particle spacings. */
static const double too_close = 0.9;

/* What is too close to a volume of `fill`. */
struct close {
    int count;      /* particles of the body that are too close to those of another volume */
    int fill;       /* volume of the first such particle */
    int other_body; /* body of the particle that it is too close to */
    int other_fill; /* volume of that particle */
};

/* Index of the volume of `fill` that a particle comes from; -1: from an inlet. */
static int fill_of(const struct scene_body *body, int particle) {
    for (int k = 0; k < body->fills; k++)
        if (particle < body->fill[k].end) return k;
    return -1;
}

/* Whether neighbour j, which is no boundary point, comes from another volume and is too close. */
static bool is_too_close(const struct pdyn_sim *sim, int b, int i, int j, struct close *out) {
    int c = objective_body_of(&sim->objective, j);
    double distance = vec3_distance(sim->x + 3 * (size_t)i, sim->x + 3 * (size_t)j);
    double spacing = sim->body[b].radius + sim->body[c].radius;
    if (!(distance > 0.0 && distance < too_close * spacing)) return false;
    out->other_body = c;
    out->fill = fill_of(&sim->scene.body[b], i - sim->body[b].first);
    out->other_fill = fill_of(&sim->scene.body[c], j - sim->body[c].first);
    return out->fill >= 0 && out->other_fill >= 0 && (b != c || out->fill != out->other_fill);
}

/* Each pair is seen from the particle with the larger index. */
static struct close find_close(const struct pdyn_sim *sim, int b) {
    const pdyn_neighbours *view = neighbours_view(sim->objective.neighbours);
    const pdyn_body *body = &sim->body[b];
    struct close found = {0}, pair = {0};
    for (int i = body->first; i < body->first + body->count; i++)
        for (int k = view->start[i]; k < view->boundary_start[i]; k++) {
            if (view->index[k] >= i || !is_too_close(sim, b, i, view->index[k], &pair)) continue;
            if (!found.count) found = pair;
            found.count++;
            break;
        }
    return found;
}

static void check_volumes(struct pdyn_sim *sim, int b) {
    struct close close = find_close(sim, b);
    if (!close.count) return;
    bool same = close.other_body == b;
    WARN(sim, OVERLAP, sim->body[b].name,
         "fill[%d] and fill[%d]%s%s%s overlap: %d particle%s closer than %g spacings to those of "
         "another volume",
         close.fill, close.other_fill, same ? "" : " of \"",
         same ? "" : sim->body[close.other_body].name, same ? "" : "\"", close.count,
         close.count == 1 ? " is" : "s are", too_close);
}

/* Particles at one place: constraints have no direction to separate them. */
static void check_coincident(struct pdyn_sim *sim, const pdyn_body *fluid) {
    const pdyn_neighbours *view = neighbours_view(sim->objective.neighbours);
    int count = 0;
    for (int i = fluid->first; i < fluid->first + fluid->count; i++)
        for (int k = view->start[i]; k < view->boundary_start[i]; k++) {
            int j = view->index[k];
            if (j == i || j >= sim->objective.particles) continue;
            if (vec3_distance(sim->x + 3 * i, sim->x + 3 * j) > 0.0) continue;
            count++;
            break;
        }
    if (!count) return;
    warnings_say(sim->context, sim_warning(sim, WARNING_COINCIDENT, fluid->name, count, 0.0),
                 "%d particles lie at the place of another one; nothing parts them: do volumes of "
                 "its fill overlap?",
                 count);
}

void warn_of_fills(struct pdyn_sim *sim, int body) {
    check_coincident(sim, &sim->body[body]);
    check_volumes(sim, body);
}
