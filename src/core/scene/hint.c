#include "hint.h"

#include "base/text.h"

#include <ctype.h>
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

const char *hint_closest(const char *name, const char *const *names, int count) {
    size_t length = strlen(name);
    if (!length || length > MAX_WORD) return NULL;
    const char *nearest = NULL;
    int best = (int)(length + 2) / 3 + 1; /* at most a third of the letters may differ */
    for (int i = 0; i < count; i++) {
        if (strlen(names[i]) > MAX_WORD) continue;
        int distance = edit_distance(name, names[i]);
        bool within = (length > 3 && strstr(names[i], name)) ||
                      (strlen(names[i]) > 3 && strstr(name, names[i]));
        if (within) distance = min_int(distance, best - 1);
        if (distance < best) best = distance, nearest = names[i];
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
    {"inlets", "particles"},
    {"fill", "particles"},
    {"radius", "particles"},
    {"particleRadius", "radius"},
    {"particle_radius", "radius"},
    {"mass", "area_density"},
    {"viscosity", "constraints"},
    {"stiffness", "constraints"},
    {"mesh", "surface"},
    {"cloth", "surface"},
    {"cloth", "spring"},
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
    {"tol", "tolerance"},
    {"scheme", "integrator"},
    {"mu", "friction"},
    {"file", "mesh"},
    {"geometry", "mesh"},
    {"diameter", "radius"},
    {"spacing", "radius"},
    {"positions", "fill"},
    {"block", "fill"},
    {"max_particles", "budget"},
    {"voxel_size", "cell"},
    {"resolution", "cell"},
    {"xsph", "viscosity"},
    {"position", "translate"},
    {"position", "center"},
    {"resolution", "cells"},
    {"resolution", "vertices"},
    {"points", "vertices"},
    {"indices", "vertices"},
    {"margin", "thickness"},
    {"young", "stiffness"},
    {"youngs_modulus", "stiffness"},
    {"poisson", "volume_stiffness"},
    {"poissons_ratio", "volume_stiffness"},
    {"stiffness", "bending_rigidity"},
    {"distance", "spring"},
    {"strain", "triangle"},
    {"neohookean", "tet"},
    {"corotated", "tet"},
    {"orientation", "rotate"},
    {"velocity", "speed"},
    {"velocity", "motion"},
    {"min", "minimum"},
    {"max", "maximum"},
    {"restitution", "contact"},
    {"constraints", "bodies"},
    {"adhesion", "contact_angle"},
    {"adhesion", "surface_tension"},
    {"cohesion", "surface_tension"},
    {"hinge", "attachment"},
    {"joint", "attachment"},
    {"rope", "attachment"},
    {"weld", "attachment"},
    {"balloon", "gas"},
    {"pressure", "gas"},
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
