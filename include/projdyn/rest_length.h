/* Callbacks of a constraint whose element is one row u that keeps its rest length l:
 *
 *     p = l u / |u|,     J = min(1, l / |u|) (I - n n'),  n = u / |u|
 *
 * The element's data is one double, l in the unit of u (pdyn_constraint_type.data_size = sizeof
 * (double)); `select` sets it. l = 0 gives p = 0 and J = 0: a quadratic energy. */
#ifndef PROJDYN_REST_LENGTH_H
#define PROJDYN_REST_LENGTH_H

#include "module.h"
#include "vec3.h"

/* Inlined into a caller that is compiled for several instruction sets, as spring.c does. */
#if defined(__GNUC__)
#define REST_LENGTH_INLINE static inline __attribute__((always_inline))
#else
#define REST_LENGTH_INLINE static inline
#endif

/* pdyn_constraint_type.project */
REST_LENGTH_INLINE void rest_length_project(const void *params, const pdyn_batch *b, int first,
                                            int last) {
    const double *length = (const double *)b->data;
    (void)params;
    for (int e = first; e < last; e++) vec3_project_length(b->p + 3 * e, b->u + 3 * e, length[e]);
}

/* pdyn_constraint_type.tangent_rank1. The square roots of a group of elements form one loop without
 * other memory accesses, which compilers turn into vector instructions. */
REST_LENGTH_INLINE void rest_length_tangent(const void *params, const pdyn_batch *b, int first,
                                            int last, double *axis) {
    enum { GROUP = 64 };
    double s[GROUP], t[GROUP];
    (void)params;
    for (int e = first; e < last; e += GROUP) {
        const double *length = (const double *)b->data + e, *u = b->u + 3 * e;
        int count = last - e < GROUP ? last - e : GROUP;
        for (int k = 0; k < count; k++) vec3_contraction(&s[k], &t[k], u + 3 * k, length[k]);
        for (int k = 0; k < count; k++, u += 3, axis += 4) {
            for (int a = 0; a < 3; a++) axis[a] = t[k] * u[a];
            axis[3] = s[k];
        }
    }
}

/* pdyn_constraint_type.damping_rest: the current length becomes the rest length. */
REST_LENGTH_INLINE void rest_length_damping_rest(const void *params, const pdyn_batch *b, int first,
                                                 int last) {
    double *length = (double *)b->data;
    (void)params;
    for (int e = first; e < last; e++) length[e] = vec3_length(b->u + 3 * e);
}

#endif
