/* The warning about pins whose targets lie beyond a surface that does not yield. Contact keeps the
 * pinned points in front of it:
 *
 *     u -> | p        u: the point, p: its target, |: a solid, or what other pins hold
 *
 * The farther p is, the harder the pins pull. Steps may be solved all the same. */
#include "contact/contact.h"
#include "warn_of_step.h"

#include "projdyn/vec3.h"

/* Adds the way of a particle to its target, p - u of its pins. */
static void add_way_to_target(const struct pdyn_sim *sim, int particle, double way[3]) {
    for (int k = 0; k < sim->objective.batches; k++) {
        const struct batch *b = sim->objective.batch[k];
        if (b->linear || !batch_pins_particle(b, particle)) continue;
        const struct touch *touch = &b->touch[b->touch_start[particle - b->touch_first]];
        const double *u = b->view.u + 3 * (size_t)touch->row;
        const double *p = b->view.p + 3 * (size_t)touch->row;
        for (int a = 0; a < 3; a++) way[a] += touch->coefficient * (p[a] - u[a]);
        return;
    }
}

/* How far the targets of the particles of a contact lie beyond its other side, m: minus the
 * distance along its normal with the particles at their targets. */
static double depth_of_targets(const struct pdyn_sim *sim, const pdyn_contact *contact) {
    double change = 0.0;
    for (int k = 0; k < 4; k++) {
        double way[3] = {0};
        if (contact->coefficient[k] == 0.0) continue;
        add_way_to_target(sim, contact->particle[k], way);
        change += contact->coefficient[k] * vec3_dot(contact->separation, way);
    }
    return -contact->distance - change / contact->distance;
}

/* Less than the thickness is what pins that press on a surface need. */
void warn_of_pins(struct pdyn_sim *sim) {
    if (!sim->objective.contact) return;
    const pdyn_contacts *contacts = contact_current(sim->objective.contact);
    double deepest = sim->scene.contact.thickness;
    int particle = -1;
    for (int k = 0; k < contacts->count; k++) {
        int pinned = warn_pinned_particle(sim, &contacts->contact[k]);
        double depth = pinned < 0 ? 0.0 : depth_of_targets(sim, &contacts->contact[k]);
        if (depth > deepest) deepest = depth, particle = pinned;
    }
    if (particle < 0) return;
    const pdyn_body *body = &sim->body[objective_body_of(&sim->objective, particle)];
    struct warning *w = sim_warning(sim, WARNING_UNREACHABLE, body->name, 1, deepest);
    warnings_say(sim->context, w,
                 "in %ld of %ld steps its pins cannot reach their targets, which lie up to %.3g m "
                 "beyond a surface that does not yield",
                 w->count, sim->steps, w->worst);
}
