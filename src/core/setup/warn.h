/* Warnings about values of a scene (base/warnings.h). */
#ifndef PDYN_WARN_H
#define PDYN_WARN_H

#include "scene/scene.h"

#include "projdyn/projdyn.h"

struct pdyn_sim;

/* A warning about the scene (printf format). */
#define WARN(sim, code, subject, ...)                                                              \
    warnings_say((sim)->context, sim_warning(sim, WARNING_##code, subject, 1, 0.0), __VA_ARGS__)

/* Warns of more memory than there is, which a system often answers by ending the program without a
 * word. Right after the bodies are made. */
void warn_of_memory(struct pdyn_sim *sim);
/* Warns of a contact thickness above the edges of a mesh. Before contact finds its pairs, for which
 * the memory may not suffice. */
void warn_of_thickness(struct pdyn_sim *sim);
/* Raises warnings about values that are legal but surely not meant. */
pdyn_status warn_of_scene(struct pdyn_sim *sim);
/* The same about one body, about meshes, about inlets, outlets and times, about values in a wrong
 * unit or with a wrong sign, about surfaces in a fluid, and about solids with many boundary points:
 * parts of it.
 */
pdyn_status warn_of_body(struct pdyn_sim *sim, int body);
void warn_of_meshes(struct pdyn_sim *sim);
pdyn_status warn_of_flow(struct pdyn_sim *sim);
void warn_of_values(struct pdyn_sim *sim);
void warn_of_water(struct pdyn_sim *sim);
void warn_of_points(struct pdyn_sim *sim);

/* Warns of particles of a body that are too close to each other, from the neighbour lists. */
void warn_of_fills(struct pdyn_sim *sim, int body);
/* Warns of a body of particles without room for the contact thickness of surfaces. */
pdyn_status warn_of_room(struct pdyn_sim *sim, int body);

/* ---- what several of them need --------------------------------------------------------------- */

/* Mean length of the edges of a surface at rest, m. */
double warn_mean_edge(const pdyn_body *body);
/* The path of the points that a constraint holds; NULL: none. */
const pdyn_path *warn_path(const struct scene_constraint *constraint);
/* The value of a parameter of the kind PDYN_REAL, at the first of its keys; 0: there is none. */
double warn_parameter(const struct scene_constraint *constraint, const char *name);
/* Whether a pin, or an attachment to another body that is not slack, holds the body. */
bool warn_is_held(const struct scene_body *body);
/* The body of particles with the least rest density; NULL: there is none. */
const pdyn_body *warn_lightest_fluid(const struct pdyn_sim *sim);

#endif
