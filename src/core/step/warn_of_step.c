/* Warnings about steps: unsolved, repeated, compressed, particles that passed a surface or fell. */
#include "warn_of_step.h"

#include "contact/contact.h"
#include "sim/crossings.h"
#include "sim/energy_budget.h"
#include "sim/extent.h"
#include "sim/live_particles.h"

#include "projdyn/vec3.h"

static const double max_density_error = 0.1; /* mean over the fluid */

static void warn_unsolved(struct pdyn_sim *sim) {
    double tolerance = sim->scene.settings.tolerance;
    for (int b = 0; b < sim->bodies; b++) {
        double residual = sim->objective.body[b].residual;
        if (residual <= tolerance) continue;
        struct warning *w = sim_warning(sim, WARNING_UNSOLVED, sim->body[b].name, 1, residual);
        warnings_say(sim->context, w,
                     "%ld of %ld steps are unsolved: step residual up to %.2g, tolerance %.2g",
                     w->count, sim->steps, w->worst, tolerance);
    }
}

/* Half of the kinetic energy is a loss that pictures show. */
static const double much_slower = 0.5;

static void warn_slowed(struct pdyn_sim *sim) {
    if (sim->slowed <= much_slower) return;
    struct warning *w = sim_warning(sim, WARNING_SLOWED, "", 1, sim->slowed);
    warnings_say(sim->context, w,
                 "%ld of %ld steps end so far from solved that they take away more than half of "
                 "the motion (up to %.0f %% of the kinetic energy): more \"outer_iterations\" or "
                 "shorter steps",
                 w->count, sim->steps, 100.0 * w->worst);
}

static void warn_retries(struct pdyn_sim *sim, int retries, const char *why) {
    if (!retries) return;
    struct warning *w = sim_warning(sim, WARNING_RETRIES, "", retries, retries);
    warnings_say(
        sim->context, w,
        "%ld attempt%s at a step failed and w%s repeated with a shorter one; reason of the "
        "last one: %s",
        w->count, w->count == 1 ? "" : "s", w->count == 1 ? "as" : "ere", why);
}

/* After the first step, also if the fluid was compressed at the start. */
static void warn_compressed(struct pdyn_sim *sim, double error) {
    if (sim->steps == 1) error = fmax(error, sim->energy.density_error);
    if (error <= max_density_error) return;
    struct warning *w = sim_warning(sim, WARNING_COMPRESSED, "", 1, error);
    warnings_say(sim->context, w,
                 "the mean density error is above %g %% in %ld of %ld steps, up to %.3g %%",
                 100.0 * max_density_error, w->count, sim->steps, 100.0 * w->worst);
}

/* ---- bodies that move far in a step ---------------------------------------------------------- */

/* Longest side of the box around the rest shape, m. */
static double size_of(const pdyn_body *body) {
    struct box box = box_around(body->rest, body->count);
    return box_extent(&box);
}

/* Contact keeps surfaces from passing through each other, not two bodies from getting around each
 * other in a single step. */
static void warn_fast(struct pdyn_sim *sim, double h) {
    for (int b = 0; sim->objective.contact && b < sim->bodies; b++) {
        const pdyn_body *body = &sim->body[b];
        if (body_is_particles(body)) continue;
        double v[3] = {0}, size = size_of(body);
        for (int i = body->first; i < body->first + body->count; i++)
            vec3_add(v, 1.0 / body->count, sim->v + 3 * (size_t)i);
        double moved = h * vec3_length(v);
        if (moved <= 0.5 * size) continue;
        struct warning *w = sim_warning(sim, WARNING_FAST, body->name, 1, moved);
        warnings_say(
            sim->context, w,
            "moves by up to %.3g m in a step, more than half of its size of %.3g m: it may "
            "get around other bodies despite contact",
            w->worst, size);
    }
}

/* ---- contact pressed to its end -------------------------------------------------------------- */

/* Part of the thickness at which a contact has 31 times the force of stiffness times thickness: the
 * barrier has become a wall, on which a step makes little progress. */
static const double pressed_flat = 0.125;

/* Smallest distance of a contact over its thickness; 1: nothing touches. */
static double least_distance(const pdyn_contacts *contacts) {
    double least = 1.0;
    for (int k = 0; k < contacts->count; k++)
        least = fmin(least, contacts->contact[k].distance / contacts->contact[k].thickness);
    return least;
}

static bool is_pinned(const struct pdyn_sim *sim, int particle) {
    for (int k = 0; k < sim->objective.batches; k++)
        if (batch_pins_particle(sim->objective.batch[k], particle)) return true;
    return false;
}

int warn_pinned_particle(const struct pdyn_sim *sim, const pdyn_contact *contact) {
    int pinned = -1;
    for (int k = 0; k < 4; k++) {
        if (contact->coefficient[k] == 0.0) continue;
        if (!is_pinned(sim, contact->particle[k])) return -1;
        pinned = contact->particle[k];
    }
    return pinned;
}

/* The body of a contact that is pressed flat between pins and a solid, or between pins; NULL: none.
 * No stiffness of contact moves either side. */
static const pdyn_body *find_pinned_flat(const struct pdyn_sim *sim) {
    const pdyn_contacts *contacts = contact_current(sim->objective.contact);
    for (int k = 0; k < contacts->count; k++) {
        const pdyn_contact *c = &contacts->contact[k];
        if (c->distance >= pressed_flat * c->thickness) continue;
        int pinned = warn_pinned_particle(sim, c);
        if (pinned >= 0) return &sim->body[objective_body_of(&sim->objective, pinned)];
    }
    return NULL;
}

/* A solid that waits presses with a force that no stiffness carries. */
static void warn_pressed(struct pdyn_sim *sim) {
    const struct contact *contact = sim->objective.contact;
    if (!contact || contact_is_lagging(contact) || sim->solved) return;
    double least = least_distance(contact_current(contact));
    if (least >= pressed_flat) return;
    const pdyn_body *pinned = find_pinned_flat(sim);
    struct warning *w =
        sim_warning(sim, WARNING_CONTACT_STIFFNESS, pinned ? pinned->name : "", 1, 1.0 / least);
    if (pinned)
        warnings_say(sim->context, w,
                     "%ld of %ld steps are unsolved with pins that hold points as close as %.2g of "
                     "the contact thickness to a surface that does not yield: place or move them "
                     "at least a thickness away",
                     w->count, sim->steps, 1.0 / w->worst);
    else
        warnings_say(
            sim->context, w,
            "%ld of %ld steps are unsolved with surfaces as close as %.2g of the contact "
            "thickness: \"contact.stiffness\" of %g N/m is too small for what presses them, or a "
            "fast impact or a joint leaves them no room",
            w->count, sim->steps, 1.0 / w->worst, sim->scene.contact.stiffness);
}

/* ---- solids that wait ------------------------------------------------------------------------ */

/* Contact holds up a solid that would pass through a surface. Less than the thickness is what a
 * press leaves for the cloth in it. */
static void warn_waiting(struct pdyn_sim *sim) {
    const struct contact *contact = sim->objective.contact;
    for (int s = 0; contact && contact_is_lagging(contact) && s < sim->scene.solids; s++) {
        double lag = contact_lag(contact, s);
        if (lag <= sim->scene.contact.thickness) continue;
        struct warning *w = sim_warning(sim, WARNING_SOLID_WAITS, sim->scene.solid[s].name, 1, lag);
        warnings_say(sim->context, w,
                     "in %ld of %ld steps a surface in its way holds this solid up, at up to "
                     "%.3g m from where its motion puts it",
                     w->count, sim->steps, w->worst);
    }
}

/* ---- particles that fell out of the scene ---------------------------------------------------- */

/* Particles of the body that fell out of the scene. */
static int count_fallen(const struct pdyn_sim *sim, const pdyn_body *body) {
    int count = 0;
    for (int i = body->first; i < body->first + body->count; i++)
        count +=
            particle_is_live(sim, i) && extent_height(sim, sim->x + 3 * (size_t)i) < sim->floor;
    return count;
}

/* An outlet around the scene removes all particles of fluids that fall. */
static bool has_outlet_around(const struct scene *scene) {
    for (int k = 0; k < scene->outlets; k++)
        if (scene->outlet[k].outside) return true;
    return false;
}

/* Particles that nothing holds fall for ever, and make steps short. Pins may lower a body as far as
 * they like. */
static void warn_fallen(struct pdyn_sim *sim) {
    bool removed = has_outlet_around(&sim->scene);
    for (int b = 0; b < sim->bodies; b++) {
        if ((removed && !sim->scene.body[b].has_mesh) || sim_pins_body(sim, b)) continue;
        bool particles = body_is_particles(&sim->body[b]);
        int count = count_fallen(sim, &sim->body[b]);
        if (!count) continue;
        struct warning *w = sim_warning(sim, WARNING_FELL_OUT, sim->body[b].name, 0, count);
        w->count = count;
        warnings_say(sim->context, w,
                     "%d of %d %s are far below everything else and fall for ever: %s", count,
                     sim->body[b].count, particles ? "particles" : "vertices",
                     particles ? "nothing holds them and no outlet removes them"
                               : "nothing holds them; if they are meant to fall, a floor below all "
                                 "of their way, or a shorter duration, ends this warning");
    }
}

void warn_of_step(struct pdyn_sim *sim, const pdyn_step_info *info, const char *why_repeated) {
    warn_unsolved(sim);
    warn_slowed(sim);
    warn_retries(sim, info->retries, why_repeated);
    warn_compressed(sim, info->density_error_mean);
    warn_of_gaps(sim, info->density_error_max);
    crossings_warn(sim);
    warn_fast(sim, info->h);
    warn_pressed(sim);
    warn_waiting(sim);
    warn_of_pins(sim);
    energy_budget_step(sim, info);
    if (info->frame) warn_fallen(sim);
}
