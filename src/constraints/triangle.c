/* In-plane strain of a sheet (Bouaziz et al. 2014, section 5.1). u = sqrt(A) F: the 3 x 2
 * deformation gradient F of a triangle of area A, column by column. With the singular values of F,
 * the principal stretches s_i, and w = Y,
 *
 *     u = sqrt(A) sum_i s_i l_i r_i',     p = sqrt(A) sum_i clamp(s_i, shortest, longest) l_i r_i'
 *     E = Y/2 A sum_i (s_i - clamp(s_i))^2
 *
 * That is a sheet of Young's modulus times thickness Y without Poisson's effect, on any mesh. */
#include "frame.h"
#include "strain_damper.h"

#include "projdyn/svd3.h"

#include <string.h>

struct params {
    double stretching_stiffness, shortest, longest, damping;
};

static const pdyn_param params[] = {
    {"stretching_stiffness", PDYN_REAL, offsetof(struct params, stretching_stiffness), true, 0, 0,
     1e12, "N/m", "tension per strain of the sheet: Young's modulus times thickness"},
    {"shortest", PDYN_REAL, offsetof(struct params, shortest), false, 1, 0, 1, "1",
     "length over that at rest, below which the sheet resists compression"},
    {"longest", PDYN_REAL, offsetof(struct params, longest), false, 1, 1, 1e3, "1",
     "length over that at rest, above which the sheet resists tension"},
    {"damping", PDYN_REAL, offsetof(struct params, damping), false, 0, 0, 1e6, "s",
     "stress = stiffness (strain + damping x rate of strain)"},
    {0}};

struct range { /* bounds of the two principal stretches times sqrt(A), m */
    double low[2], high[2];
    double damps, rest[3]; /* of a damper: 1 and its shape at rest; else 0 */
};

static int elements(const void *par, const pdyn_body *body) {
    (void)par;
    return body->triangles;
}

static void select(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = par;
    for (int t = first; t < last; t++) {
        struct frame f = frame_of(b->body, t);
        double root = sqrt(f.area);
        struct range *range = (struct range *)b->data + t;
        for (int i = 0; i < 2; i++)
            range->low[i] = q->shortest * root, range->high[i] = q->longest * root;
        range->damps = 0.0;
        for (int k = 0; k < 6; k++) {
            b->column[6 * t + k] = b->body->first + b->body->triangle[3 * t + k % 3];
            b->coefficient[6 * t + k] = root * f.gradient[k % 3][k / 3];
        }
    }
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    for (int t = first; t < last; t++)
        b->weight[t] = ((const struct params *)par)->stretching_stiffness;
}

WIDE static void decompose_triangles(const double *const u[SVD3_LANES], svd3 d[SVD3_LANES]) {
    svd3_of_lanes(u, d, 2, SVD3_LANES);
}

/* Decomposes the u, or u U of a damper (strain_damper.h), of `count` triangles from `first` on. */
static void decompose(const pdyn_batch *b, int first, int count, svd3 d[SVD3_LANES]) {
    const double *u[SVD3_LANES];
    double product[SVD3_LANES][6];
    for (int l = 0; l < SVD3_LANES; l++) {
        int t = first + (l < count ? l : 0);
        const struct range *range = (const struct range *)b->data + t;
        u[l] = b->u + 6 * (size_t)t;
        if (!(range->damps > 0.0)) continue;
        strain_damper_product(u[l], range->rest, 2, product[l]);
        u[l] = product[l];
    }
    decompose_triangles(u, d);
}

/* Stretch i clamped to its range. */
static double clamp(const struct range *range, int i, double stretch) {
    return fmin(fmax(stretch, range->low[i]), range->high[i]);
}

/* p = sum_i stretch_i left_i right_i' */
static void compose(const svd3 *d, const double stretch[2], double p[6]) {
    memset(p, 0, 6 * sizeof *p);
    for (int i = 0; i < 2; i++)
        for (int c = 0; c < 2; c++) vec3_add(p + 3 * c, stretch[i] * d->right[i][c], d->left[i]);
}

static void project_triangle(const struct range *range, const svd3 *d, double p[6]) {
    double stretch[2] = {1.0, 1.0}, turn[6];
    if (range->damps > 0.0) {
        compose(d, stretch, turn);
        strain_damper_product(turn, range->rest, 2, p);
        return;
    }
    for (int i = 0; i < 2; i++) stretch[i] = clamp(range, i, d->s[i]);
    compose(d, stretch, p);
}

static int lanes_of(int first, int last) {
    return last - first < SVD3_LANES ? last - first : SVD3_LANES;
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    svd3 d[SVD3_LANES];
    for (; first < last; first += SVD3_LANES) {
        int count = lanes_of(first, last);
        const struct range *range = (const struct range *)b->data + first;
        decompose(b, first, count, d);
        for (int l = 0; l < count; l++)
            project_triangle(range + l, &d[l], b->p + 6 * (size_t)(first + l));
    }
}

/* J += factor m m' with the unit 6-vector m of a x' + sign b y'; a, b: unit vectors in space, x, y:
 * in the plane of the rest shape, sign: 0 for a x' alone. The factor is clamped to [0, 1]. */
static void add_mode(double *J, double factor, const double *a, const double *x, double sign,
                     const double *b, const double *y) {
    double m[6];
    if (!(factor > 0.0)) return;
    factor = fmin(factor, 1.0) / (1.0 + sign * sign);
    for (int k = 0; k < 6; k++) m[k] = a[k % 3] * x[k / 3] + sign * b[k % 3] * y[k / 3];
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++) J[6 * i + j] += factor * m[i] * m[j];
}

/* J = dp/du by its eigenvectors, with a, b: left[0], left[1], n: left[2], x, y: right[0], right[1]
 * and p_i = clamp(s_i) (the differential of a singular value decomposition):
 *
 *     a x', b y'           one stretch changes:     1 inside its range, 0 outside
 *     a y' - b x'          rotation in the plane:   (p_0 + p_1) / (s_0 + s_1)
 *     a y' + b x'          shear:                   (p_0 - p_1) / (s_0 - s_1)
 *     n x', n y'           the plane tilts:         p_i / s_i */
static void tangent_of(const svd3 *d, const struct range *range, double *J) {
    double p[2], sum = d->s[0] + d->s[1], gap = d->s[0] - d->s[1];
    for (int i = 0; i < 2; i++) p[i] = clamp(range, i, d->s[i]);
    double free0 = p[0] == d->s[0], free1 = p[1] == d->s[1];
    double apart = gap > 1e-9 * sum ? (p[0] - p[1]) / gap : fmin(free0, free1);
    const double *a = d->left[0], *b = d->left[1], *n = d->left[2];
    const double *x = d->right[0], *y = d->right[1];
    add_mode(J, free0, a, x, 0.0, a, x), add_mode(J, free1, b, y, 0.0, b, y);
    add_mode(J, sum > 0.0 ? (p[0] + p[1]) / sum : 1.0, a, y, -1.0, b, x);
    add_mode(J, apart, a, y, 1.0, b, x);
    for (int i = 0; i < 2; i++) {
        double along = d->s[i] > 0.0 ? p[i] / d->s[i] : 1.0;
        add_mode(J, along, n, d->right[i], 0.0, n, d->right[i]);
    }
}

static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    (void)par;
    svd3 d[SVD3_LANES];
    for (; first < last; first += SVD3_LANES) {
        int count = lanes_of(first, last);
        decompose(b, first, count, d);
        for (int l = 0; l < count; l++, J += 36) {
            const struct range *range = (const struct range *)b->data + first + l;
            double p[6];
            if (range->damps > 0.0) {
                project_triangle(range, &d[l], p);
                strain_damper_tangent(&d[l], p, 2, J);
            } else tangent_of(&d[l], range, J);
        }
    }
}

static double damping(const void *par) { return ((const struct params *)par)->damping; }

static void damping_rest(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    const double *u[SVD3_LANES];
    svd3 d[SVD3_LANES];
    for (; first < last; first += SVD3_LANES) {
        int count = lanes_of(first, last);
        struct range *range = (struct range *)b->data + first;
        for (int l = 0; l < SVD3_LANES; l++)
            u[l] = b->u + 6 * (size_t)(first + (l < count ? l : 0));
        decompose_triangles(u, d);
        for (int l = 0; l < count; l++) {
            range[l].damps = 1.0;
            strain_damper_rest(&d[l], 2, range[l].rest);
        }
    }
}

const pdyn_constraint_type pdyn_constraint_triangle = {
    .name = "triangle",
    .summary = "stretching and shear of a sheet, the same on any mesh",
    .flags = PDYN_ON_SURFACE,
    .params_size = sizeof(struct params),
    .params = params,
    .data_size = sizeof(struct range),
    .elements = elements,
    .rows = 2,
    .width = 3,
    .select = select,
    .weight = weight,
    .project = project,
    .tangent = tangent,
    .damping = damping,
    .damping_rest = damping_rest,
};
