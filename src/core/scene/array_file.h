/* Arrays that stand for files which a scene names: surfaces, soft solids, particles. */
#ifndef PDYN_ARRAY_FILE_H
#define PDYN_ARRAY_FILE_H

#include "geometry/mesh.h"
#include "geometry/tets.h"

struct array_file;
struct file_out;

struct array_kind {
    const char *ending;          /* of the file */
    const char *call;            /* function that makes it, for messages */
    const char *point, *element; /* words for messages */
    int corners;                 /* of an element; 0: it has none */
    void (*write)(struct file_out *out, const struct array_file *file);
};
extern const struct array_kind array_surface, array_volume, array_particles;

struct array_file {
    struct array_file *next;
    const struct array_kind *kind;
    char name[256];
    int points;
    const double *x; /* points x 3, m */
    const double *v; /* points x 3, m/s; NULL: none */
    int elements;
    const int *corner; /* elements x kind->corners, from 0 */
};

/* Checks the arrays as the readers of files do, and adds a copy with this name to the list, in
 * place of one that has the name. PDYN_BAD_INPUT, PDYN_NO_MEMORY. */
pdyn_status array_file_add(pdyn_context *context, struct array_file **list, const char *name,
                           const struct array_file *from);
const struct array_file *array_file_find(const struct array_file *list, const char *name);
void array_file_free_all(pdyn_context *context, struct array_file **list);

/* Copies of the arrays, as mesh_read, tets_read and particles_read return them. PDYN_BAD_INPUT: the
 * file is of another kind; particles are taken from a surface, too. */
pdyn_status array_file_mesh(pdyn_context *context, const struct array_file *file,
                            struct mesh *mesh);
pdyn_status array_file_tets(pdyn_context *context, const struct array_file *file, struct mesh *mesh,
                            struct tets *tets);
pdyn_status array_file_particles(pdyn_context *context, const struct array_file *file,
                                 struct particles *particles);

/* Writes the file in the folder of `scene`, a path. The readers give the same bits. */
pdyn_status array_file_write(pdyn_context *context, const struct array_file *file,
                             const char *scene);

#endif
