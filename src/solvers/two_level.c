#include "two_level.h"

static void precondition(void *self, const double *r, double *z) {
    struct two_level *s = self;
    block_jacobi_apply(&s->jacobi, r, z);
    coarse_space_correct(&s->coarse, r, z);
}

pdyn_status two_level_create(struct two_level *s, pdyn_model *model) {
    pdyn_status status = pcg_create(&s->pcg, model, precondition, s);
    if (status == PDYN_OK) status = block_jacobi_create(&s->jacobi, model);
    return status == PDYN_OK ? coarse_space_create(&s->coarse, model) : status;
}

void two_level_free(struct two_level *s) {
    pcg_free(&s->pcg);
    block_jacobi_free(&s->jacobi);
    coarse_space_free(&s->coarse);
}

void two_level_update(struct two_level *s, bool first_of_step) {
    block_jacobi_update(&s->jacobi);
    coarse_space_update(&s->coarse, first_of_step);
}
