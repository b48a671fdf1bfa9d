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

/* u = sum_i stretch_i left_i right_i', the larger stretch first; left[2] is the normal of the
 * deformed triangle. The left vector of a stretch of 0 is any unit vector normal to the others. */
struct principal {
    double stretch[2], right[2][2], left[3][3];
};

/* From the eigenvectors of the 2 x 2 matrix u' u. */
static struct principal principal_of(const double *u) {
    struct principal s;
    double xx = vec3_dot(u, u), xy = vec3_dot(u, u + 3), yy = vec3_dot(u + 3, u + 3);
    double turn = 0.5 * atan2(2.0 * xy, xx - yy);
    memcpy(s.right[0], (double[2]){cos(turn), sin(turn)}, sizeof s.right[0]);
    memcpy(s.right[1], (double[2]){-sin(turn), cos(turn)}, sizeof s.right[1]);
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 3; k++) s.left[i][k] = s.right[i][0] * u[k] + s.right[i][1] * u[3 + k];
        s.stretch[i] = vec3_length(s.left[i]);
    }
    if (vec3_normalise(s.left[0]) == 0.0) s.left[0][0] = 1.0;
    svd3_make_normal(s.left[1], s.left[0], 0.0);
    vec3_cross(s.left[2], s.left[0], s.left[1]);
    return s;
}

/* Stretch i clamped to its range. */
static double clamp(const struct range *range, int i, double stretch) {
    return fmin(fmax(stretch, range->low[i]), range->high[i]);
}

/* p = sum_i stretch_i left_i right_i' */
static void compose(const struct principal *s, const double stretch[2], double p[6]) {
    memset(p, 0, 6 * sizeof *p);
    for (int i = 0; i < 2; i++)
        for (int c = 0; c < 2; c++) vec3_add(p + 3 * c, stretch[i] * s->right[i][c], s->left[i]);
}

/* p of a damper. Returns the values and vectors of u U (strain_damper.h). */
static struct principal project_damper(const struct range *range, const double *u, double p[6]) {
    double product[6], turn[6];
    strain_damper_product(u, range->rest, 2, product);
    struct principal s = principal_of(product);
    compose(&s, (double[2]){1.0, 1.0}, turn);
    strain_damper_product(turn, range->rest, 2, p);
    return s;
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int t = first; t < last; t++) {
        const struct range *range = (const struct range *)b->data + t;
        const double *u = b->u + 6 * t;
        if (range->damps > 0.0) {
            project_damper(range, u, b->p + 6 * t);
            continue;
        }
        struct principal s = principal_of(u);
        double stretch[2];
        for (int i = 0; i < 2; i++) stretch[i] = clamp(range, i, s.stretch[i]);
        compose(&s, stretch, b->p + 6 * t);
    }
}

/* J += factor m m' with the unit 6-vector m of a x' + sign b y'; a, b: unit vectors in space, x, y:
 * in the plane of the rest shape, sign: 0 for a x' alone. The factor is clamped to [0, 1]. */
static void add_mode(double *J, double factor, const double *a, const double *x, double sign,
                     const double *b, const double *y) {
    double m[6];
    factor = fmin(fmax(factor, 0.0), 1.0) / (1.0 + sign * sign);
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
static void tangent_of(const struct principal *s, const struct range *range, double *J) {
    double p[2], sum = s->stretch[0] + s->stretch[1], gap = s->stretch[0] - s->stretch[1];
    for (int i = 0; i < 2; i++) p[i] = clamp(range, i, s->stretch[i]);
    double free0 = p[0] == s->stretch[0], free1 = p[1] == s->stretch[1];
    double apart = gap > 1e-9 * sum ? (p[0] - p[1]) / gap : fmin(free0, free1);
    const double *a = s->left[0], *b = s->left[1], *n = s->left[2];
    const double *x = s->right[0], *y = s->right[1];
    add_mode(J, free0, a, x, 0.0, a, x), add_mode(J, free1, b, y, 0.0, b, y);
    add_mode(J, sum > 0.0 ? (p[0] + p[1]) / sum : 1.0, a, y, -1.0, b, x);
    add_mode(J, apart, a, y, 1.0, b, x);
    for (int i = 0; i < 2; i++) {
        double along = s->stretch[i] > 0.0 ? p[i] / s->stretch[i] : 1.0;
        add_mode(J, along, n, s->right[i], 0.0, n, s->right[i]);
    }
}

static void tangent_of_damper(const struct range *range, const double *u, double *J) {
    double p[6];
    struct principal s = project_damper(range, u, p);
    const double value[3] = {s.stretch[0], s.stretch[1], 0.0};
    strain_damper_tangent(value, s.left[0], p, 2, J);
}

static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    (void)par;
    for (int t = first; t < last; t++, J += 36) {
        const struct range *range = (const struct range *)b->data + t;
        if (range->damps > 0.0) {
            tangent_of_damper(range, b->u + 6 * t, J);
            continue;
        }
        struct principal s = principal_of(b->u + 6 * t);
        tangent_of(&s, range, J);
    }
}

static double damping(const void *par) { return ((const struct params *)par)->damping; }

static void damping_rest(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int t = first; t < last; t++) {
        struct range *range = (struct range *)b->data + t;
        struct principal s = principal_of(b->u + 6 * t);
        range->damps = 1.0;
        strain_damper_rest(s.stretch, s.right[0], 2, range->rest);
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
