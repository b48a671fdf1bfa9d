#include "hint.h"

#include "base/text.h"

#include <ctype.h>
#include <stdbool.h>
#include <string.h>

enum { MAX_WORD = 64 }; /* longest word, in characters, for which a suggestion is made */

static int min_int(int a, int b) { return a < b ? a : b; }

/* Optimal string alignment distance: insertions, deletions, replacements and swaps of adjacent
 * letters that turn a into b, ignoring case. */
static int edit_distance(const char *a, const char *b) {
    int rows[3][MAX_WORD + 1], m = (int)strlen(a), n = (int)strlen(b);
    int *before = rows[0], *above = rows[1], *row = rows[2];
    for (int j = 0; j <= n; j++) row[j] = j;
    for (int i = 1; i <= m; i++) {
        int *oldest = before;
        before = above, above = row, row = oldest;
        row[0] = i;
        for (int j = 1; j <= n; j++) {
            int p = tolower((unsigned char)a[i - 1]), q = tolower((unsigned char)b[j - 1]);
            row[j] = min_int(above[j - 1] + (p != q), 1 + min_int(above[j], row[j - 1]));
            if (i > 1 && j > 1 && p == tolower((unsigned char)b[j - 2]) &&
                q == tolower((unsigned char)a[i - 2]))
                row[j] = min_int(row[j], before[j - 2] + 1);
        }
    }
    return row[n];
}

/* Whether the shorter word, of at least 4 letters, is a part of the longer one. */
static bool is_part(const char *a, const char *b) {
    return (strlen(a) > 3 && strstr(b, a)) || (strlen(b) > 3 && strstr(a, b));
}

const char *hint_closest(const char *word, const char *const *names, int count) {
    size_t length = strlen(word);
    if (!length || length > MAX_WORD) return NULL;
    const char *nearest = NULL;
    int least = MAX_WORD + 1;
    for (int i = 0; i < count; i++) {
        size_t longer = strlen(names[i]) > length ? strlen(names[i]) : length;
        if (longer > MAX_WORD) continue;
        int most = longer < 6 ? 1 : (int)longer / 3, distance = edit_distance(word, names[i]);
        if (is_part(word, names[i])) distance = min_int(distance, most);
        if (distance <= most && distance < least) least = distance, nearest = names[i];
    }
    return nearest;
}

/* Words of other programs, and keys at another place, each before the word that is meant. */
static const char *const translations[][2] = {
    {"fps", "frame_interval"},
    {"framerate", "frame_interval"},
    {"frame_rate", "frame_interval"},
    {"dt", "time_step"},
    {"dt", "fixed"},
    {"substeps", "time_step"},
    {"timeStepSize", "time_step"},
    {"steps", "duration"},
    {"end", "duration"},
    {"stopAt", "duration"},
    {"frames", "duration"},
    {"time", "duration"},
    {"end_time", "duration"},
    {"integrator", "time_step"},
    {"cfl", "time_step"},
    {"tolerance", "solver"},
    {"friction", "contact"},
    {"thickness", "contact"},
    {"collision", "contact"},
    {"collisions", "contact"},
    {"floor", "solids"},
    {"ground", "solids"},
    {"colliders", "solids"},
    {"obstacles", "solids"},
    {"fluids", "bodies"},
    {"rigid_bodies", "bodies"},
    {"emitters", "particles"},
    {"emitters", "inlets"},
    {"emitters", "bodies"},
    {"inlets", "particles"},
    {"fill", "particles"},
    {"particleRadius", "radius"},
    {"particle_radius", "radius"},
    {"mass", "area_density"},
    {"mass", "density"},
    {"viscosity", "constraints"},
    {"stiffness", "constraints"},
    {"volume_stiffness", "constraints"},
    {"stretching_stiffness", "constraints"},
    {"bending_rigidity", "constraints"},
    {"damping", "constraints"},
    {"attachment", "constraints"},
    {"attachment", "constraint"},
    {"tension", "constraint"},
    {"bending", "constraints"},
    {"fluid", "constraints"},
    {"gas", "constraints"},
    {"pin", "constraints"},
    {"spring", "constraints"},
    {"tet", "constraints"},
    {"triangle", "constraints"},
    {"wind", "constraints"},
    {"wind", "bodies"},
    {"mesh", "surface"},
    {"vertices", "surface"},
    {"cloth", "surface"},
    {"cloth", "spring"},
    {"soft", "volume"},
    {"soft_body", "volume"},
    {"softbody", "volume"},
    {"stretch", "spring"},
    {"elastic", "tet"},
    {"water", "fluid"},
    {"cylinder", "mesh"},
    {"gravitation", "gravity"},
    {"t_end", "duration"},
    {"output_interval", "frame_interval"},
    {"walls", "solids"},
    {"objects", "bodies"},
    {"entities", "bodies"},
    {"particles", "bodies"},
    {"iterations", "outer_iterations"},
    {"iterations", "solver"},
    {"cg_iterations", "linear_iterations"},
    {"tol", "tolerance"},
    {"scheme", "integrator"},
    {"mu", "friction"},
    {"file", "mesh"},
    {"filename", "mesh"},
    {"geometry", "mesh"},
    {"diameter", "radius"},
    {"spacing", "radius"},
    {"positions", "fill"},
    {"block", "fill"},
    {"box", "fill"},
    {"max_particles", "budget"},
    {"voxel_size", "cell"},
    {"resolution", "cell"},
    {"xsph", "viscosity"},
    {"position", "translate"},
    {"position", "center"},
    {"point", "center"},
    {"resolution", "cells"},
    {"resolution", "vertices"},
    {"resolution", "grid"},
    {"points", "vertices"},
    {"indices", "vertices"},
    {"margin", "thickness"},
    {"young", "stiffness"},
    {"youngs_modulus", "stiffness"},
    {"poisson", "volume_stiffness"},
    {"poisson_ratio", "volume_stiffness"},
    {"poissons_ratio", "volume_stiffness"},
    {"stiffness", "bending_rigidity"},
    {"distance", "spring"},
    {"strain", "triangle"},
    {"neohookean", "tet"},
    {"neo_hookean", "tet"},
    {"shape_matching", "tet"},
    {"volume", "tet"},
    {"corotated", "tet"},
    {"orientation", "rotate"},
    {"rotation", "rotate"},
    {"velocity", "speed"},
    {"velocity", "motion"},
    {"angular_velocity", "motion"},
    {"min", "minimum"},
    {"max", "maximum"},
    {"restitution", "contact"},
    {"constraints", "bodies"},
    {"adhesion", "contact_angle"},
    {"adhesion", "surface_tension"},
    {"cohesion", "surface_tension"},
    {"hinge", "attachment"},
    {"joint", "attachment"},
    {"ball_joint", "attachment"},
    {"joints", "bodies"},
    {"glue", "attachment"},
    {"seam", "attachment"},
    {"sewing", "attachment"},
    {"stitch", "attachment"},
    {"rope", "attachment"},
    {"string", "attachment"},
    {"tether", "attachment"},
    {"slack", "tension_only"},
    {"target", "path"},
    {"sigma", "tension"},
    {"gamma", "tension"},
    {"weld", "attachment"},
    {"balloon", "gas"},
    {"pressure", "gas"},
    {"boundary", "border"},
};

static const char *translate(const char *word, const char *const *names, int count) {
    for (size_t k = 0; k < sizeof translations / sizeof *translations; k++)
        for (int i = 0; i < count && !strcmp(word, translations[k][0]); i++)
            if (!strcmp(names[i], translations[k][1])) return names[i];
    return NULL;
}

void hint_append(char *text, size_t size, const char *word, const char *const *names, int count) {
    const char *nearest = translate(word, names, count);
    if (!nearest) nearest = hint_closest(word, names, count);
    if (nearest) text_append(text, size, "; did you mean \"%s\"?", nearest);
    for (int i = 0; i < count; i++)
        text_append(text, size, "%s%s", i ? ", " : "; known: ", names[i]);
}
