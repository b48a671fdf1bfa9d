/* Strain and volume of a soft solid (Bouaziz et al. 2014, sections 5.1 and 5.2). u = sqrt(V) F: the
 * deformation gradient F of a tetrahedron of volume V, column by column. The projection changes the
 * singular values s of F, the principal stretches, and leaves the singular vectors:
 *
 *     strain:  s_i -> clamp(s_i, shortest, longest)                w = E
 *     volume:  s -> the closest p with                             w = K
 *              p_1 p_2 p_3 = clamp(det F, smallest, largest)
 *
 * so the strain energy is E/2 V sum_i (s_i - clamp(s_i))^2: a rod has Young's modulus E where K is
 * 0 (without Poisson's effect). For small strains the volume adds the energy K/6 V (tr strain)^2.
 * s_3 < 0 for an inverted tetrahedron, which both projections turn back. Elements: for every
 * tetrahedron its strain, then its volume if K > 0, which has the same u. */
#include "strain_damper.h"

#include "projdyn/module.h"
#include "projdyn/svd3.h"

#include <string.h>

struct params {
    double stiffness, volume_stiffness, shortest, longest, smallest, largest, damping;
};

static const pdyn_param params[] = {
    {"stiffness", PDYN_REAL, offsetof(struct params, stiffness), true, 0, 0, 1e12, "Pa",
     "twice the shear modulus; without volume_stiffness also Young's modulus: stress per strain"},
    {"volume_stiffness", PDYN_REAL, offsetof(struct params, volume_stiffness), false, 0, 0, 1e12,
     "Pa", "additional resistance to a change of volume, three times Lame's first parameter"},
    {"shortest", PDYN_REAL, offsetof(struct params, shortest), false, 1, 0, 1, "1",
     "principal stretch below which the solid resists compression"},
    {"longest", PDYN_REAL, offsetof(struct params, longest), false, 1, 1, 1e3, "1",
     "principal stretch above which the solid resists tension"},
    {"smallest", PDYN_REAL, offsetof(struct params, smallest), false, 1, 0.01, 1, "1",
     "volume over that at rest, below which it resists compression"},
    {"largest", PDYN_REAL, offsetof(struct params, largest), false, 1, 1, 100, "1",
     "volume over that at rest, above which it resists expansion"},
    {"damping", PDYN_REAL, offsetof(struct params, damping), false, 0, 0, 1e6, "s",
     "stress = stiffness (strain + damping x rate of strain)"},
    {0}};

struct target {             /* bounds of the singular values of u */
    double low[3], high[3]; /* strain: of each value, m^(3/2) */
    double least, most;     /* volume: of the product, m^(9/2) */
    double damps, rest[6];  /* strain of a damper: 1 and its shape at rest; else 0 */
};

static int elements_of_tet(const void *par) {
    return ((const struct params *)par)->volume_stiffness > 0.0 ? 2 : 1;
}
static bool is_volume(const void *par, int e) { return e % elements_of_tet(par) == 1; }

static int elements(const void *par, const pdyn_body *body) {
    return elements_of_tet(par) * body->tets;
}

/* Gradients of the four barycentric coordinates in the rest shape, 1/m. */
static void gradients_of(const pdyn_body *body, int t, double g[4][3]) {
    const int *c = body->tet + 4 * (size_t)t;
    double side[3][3];
    for (int k = 0; k < 3; k++)
        vec3_subtract(side[k], body->rest + 3 * (size_t)c[1 + k], body->rest + 3 * (size_t)c[0]);
    for (int k = 0; k < 3; k++) {
        vec3_cross(g[1 + k], side[(k + 1) % 3], side[(k + 2) % 3]);
        for (int a = 0; a < 3; a++) g[1 + k][a] /= 6.0 * body->tet_volume[t];
    }
    for (int a = 0; a < 3; a++) g[0][a] = -g[1][a] - g[2][a] - g[3][a];
}

static void select(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = par;
    for (int e = first; e < last; e++) {
        int t = e / elements_of_tet(par);
        double g[4][3], root = sqrt(b->body->tet_volume[t]), cube = root * root * root;
        struct target *target = (struct target *)b->data + e;
        gradients_of(b->body, t, g);
        for (int k = 0; k < 12; k++) {
            b->column[12 * e + k] = b->body->first + b->body->tet[4 * t + k % 4];
            b->coefficient[12 * e + k] = root * g[k % 4][k / 4];
        }
        for (int i = 0; i < 3; i++)
            target->low[i] = q->shortest * root, target->high[i] = q->longest * root;
        target->least = q->smallest * cube, target->most = q->largest * cube;
        target->damps = 0.0;
    }
}

static void weight(const void *par, const pdyn_batch *b, int first, int last) {
    const struct params *q = par;
    for (int e = first; e < last; e++)
        b->weight[e] = is_volume(par, e) ? q->volume_stiffness : q->stiffness;
}

static const struct target *target_of(const pdyn_batch *b, int e) {
    return (const struct target *)b->data + e;
}

static double clamp(double value, double low, double high) { return fmin(fmax(value, low), high); }

static double product(const double s[3]) { return s[0] * s[1] * s[2]; }

/* Gradient of product(s). */
static void product_gradient(const double s[3], double g[3]) {
    for (int i = 0; i < 3; i++) g[i] = s[(i + 1) % 3] * s[(i + 2) % 3];
}

/* The point p closest to s with product(p) = c: p = s + l g(p), g the gradient of the product
 * (Bouaziz et al. 2014, appendix). Each iteration projects s to the tangent plane of
 * product = c at p; it ends at a relative change of 1e-14. */
static void onto_product(const double s[3], double c, double p[3]) {
    memcpy(p, s, 3 * sizeof *p);
    for (int k = 0; k < 100; k++) {
        double g[3], d[3], before[3] = {p[0], p[1], p[2]};
        product_gradient(p, g);
        vec3_subtract(d, p, s);
        double squares = vec3_dot(g, g);
        if (!(squares > 0.0)) return;
        double l = (vec3_dot(g, d) + c - product(p)) / squares;
        for (int i = 0; i < 3; i++) p[i] = s[i] + l * g[i];
        if (vec3_distance(p, before) <= 1e-14 * vec3_length(p)) return;
    }
}

/* Singular values p of the projection of element e from the singular values s of u. */
static void project_values(const void *par, const pdyn_batch *b, int e, const double s[3],
                           double p[3]) {
    const struct target *target = target_of(b, e);
    double volume = product(s), c = clamp(volume, target->least, target->most);
    if (!is_volume(par, e))
        for (int i = 0; i < 3; i++) p[i] = clamp(s[i], target->low[i], target->high[i]);
    else if (c == volume) memcpy(p, s, 3 * sizeof *p);
    else onto_product(s, c, p);
}

struct decomposed {             /* some elements that follow each other */
    int last;                   /* the element after them */
    int number[2 * SVD3_LANES]; /* of each element, in d */
    svd3 d[SVD3_LANES];
};

WIDE static void decompose_tets(const double *const u[SVD3_LANES], svd3 d[SVD3_LANES]) {
    svd3_of_lanes(u, d, 3, SVD3_LANES);
}

/* Decomposes the u, or u U of a damper (strain_damper.h), of elements from `first` on, not beyond
 * `last`. Strain and volume of a tetrahedron have the same u, which is decomposed once. */
static void decompose(const pdyn_batch *b, int first, int last, struct decomposed *to) {
    const double *u[SVD3_LANES] = {b->u + 9 * (size_t)first};
    double product[SVD3_LANES][9];
    int count = 0, e = first;
    for (; e < last && e < first + 2 * SVD3_LANES; e++) {
        const double *own = b->u + 9 * (size_t)e;
        bool damps = target_of(b, e)->damps > 0.0;
        if (e == first || damps || memcmp(own, u[count - 1], 9 * sizeof *own)) {
            if (count == SVD3_LANES) break;
            if (damps) strain_damper_product(own, target_of(b, e)->rest, 3, product[count]);
            u[count] = damps ? product[count] : own;
            count++;
        }
        to->number[e - first] = count - 1;
    }
    while (count < SVD3_LANES) u[count++] = u[0];
    decompose_tets(u, to->d);
    to->last = e;
}

static void project_element(const void *par, const pdyn_batch *b, int e, const svd3 *d,
                            double p[9]) {
    static const double ones[3] = {1.0, 1.0, 1.0};
    const struct target *target = target_of(b, e);
    double value[3], turn[9];
    if (target->damps > 0.0) {
        svd3_compose(d, ones, turn);
        strain_damper_product(turn, target->rest, 3, p);
    } else {
        project_values(par, b, e, d->s, value);
        svd3_compose(d, value, p);
    }
}

static void project(const void *par, const pdyn_batch *b, int first, int last) {
    struct decomposed at;
    for (; first < last; first = at.last) {
        decompose(b, first, last, &at);
        for (int e = first; e < at.last; e++)
            project_element(par, b, e, &at.d[at.number[e - first]], b->p + 9 * (size_t)e);
    }
}

/* ---- tangent --------------------------------------------------------------------------------- */

/* J += factor m m'; m: 9 numbers, as u column by column */
static void add_outer_product(double *J, double factor, const double m[9]) {
    for (int i = 0; i < 9; i++)
        for (int j = 0; j < 9; j++) J[9 * i + j] += factor * m[i] * m[j];
}

/* J += factor m m' with the unit vector m of left_a right_c' + sign left_c right_a'. The factor is
 * clamped to [0, 1]. */
static void add_mode(double *J, const svd3 *d, double factor, int a, int c, double sign) {
    double m[9];
    if (!(factor > 0.0)) return;
    factor = fmin(factor, 1.0) / (a == c ? 1.0 : 2.0);
    for (int k = 0; k < 9; k++)
        m[k] = d->left[a][k % 3] * d->right[c][k / 3] +
               (a == c ? 0.0 : sign * d->left[c][k % 3] * d->right[a][k / 3]);
    add_outer_product(J, factor, m);
}

/* dp/ds on the surface product = c with s = p + l g(p): in the tangent plane ds = (I + l B) dp, B
 * the second derivatives of the product. way: the two unit eigenvectors of dp/ds there, part: their
 * eigenvalues. Along the normal g, dp/ds is 0. */
static void product_tangent(const double s[3], const double p[3], double way[2][3],
                            double part[2]) {
    double g[3], d[3], bend[2][2]; /* bend: l B in the basis way */
    vec3_subtract(d, s, p);
    product_gradient(p, g);
    double length = vec3_length(g), l = length > 0.0 ? vec3_dot(d, g) / (length * length) : 0.0;
    for (int i = 0; i < 3; i++) g[i] = length > 0.0 ? g[i] / length : i == 0;
    for (int i = 0; i < 3; i++) way[0][i] = 0.0;
    svd3_make_normal(way[0], g, 0.5);
    vec3_cross(way[1], g, way[0]);
    for (int k = 0; k < 4; k++) {
        const double *x = way[k / 2], *y = way[k % 2];
        bend[k / 2][k % 2] = 0.0;
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                if (i != j) bend[k / 2][k % 2] += l * p[3 - i - j] * x[i] * y[j];
    }
    double turn = 0.5 * atan2(2.0 * bend[0][1], bend[0][0] - bend[1][1]);
    double c = cos(turn), n = sin(turn), middle = 0.5 * (bend[0][0] + bend[1][1]);
    double apart = hypot(0.5 * (bend[0][0] - bend[1][1]), bend[0][1]);
    for (int i = 0; i < 3; i++) {
        double x = way[0][i], y = way[1][i];
        way[0][i] = c * x + n * y, way[1][i] = c * y - n * x;
    }
    part[0] = 1.0 / (1.0 + middle + apart), part[1] = 1.0 / (1.0 + middle - apart);
}

/* J += sum_k part_k m_k m_k', m_k = sum_i way_k,i left_i right_i'; factors are clamped to [0, 1].
 */
static void add_ways(double *J, const svd3 *d, double way[2][3], const double part[2]) {
    for (int w = 0; w < 2; w++) {
        double m[9], factor = part[w] > 0.0 ? fmin(part[w], 1.0) : 1.0;
        svd3_compose(d, way[w], m);
        add_outer_product(J, factor, m);
    }
}

/* J = dp/du by its eigenvectors, each eigenvalue clamped to [0, 1]: changes of the singular values
 * (dp/ds), then, for each pair of singular directions i and j,
 *
 *     left_i right_j' - left_j right_i'    rotation:   (p_i + p_j) / (s_i + s_j)
 *     left_i right_j' + left_j right_i'    shear:      (p_i - p_j) / (s_i - s_j) */
static void tangent_of(const void *par, const pdyn_batch *b, int e, const svd3 *d, double *J) {
    double p[3], way[2][3], part[2];
    const double *s = d->s;
    project_values(par, b, e, s, p);
    if (is_volume(par, e) && memcmp(p, s, sizeof p)) {
        product_tangent(s, p, way, part);
        add_ways(J, d, way, part);
    } else
        for (int i = 0; i < 3; i++) add_mode(J, d, p[i] == s[i], i, i, 0.0);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3;
        double sum = s[i] + s[j], gap = s[i] - s[j], size = fabs(s[i]) + fabs(s[j]);
        double turn = sum > 1e-9 * size ? (p[i] + p[j]) / sum : 1.0;
        double shear = fabs(gap) > 1e-9 * size ? (p[i] - p[j]) / gap : p[i] == s[i];
        add_mode(J, d, turn, i, j, -1.0);
        add_mode(J, d, shear, i, j, 1.0);
    }
}

static void tangent(const void *par, const pdyn_batch *b, int first, int last, double *J) {
    struct decomposed at;
    for (; first < last; first = at.last) {
        decompose(b, first, last, &at);
        for (int e = first; e < at.last; e++, J += 81) {
            const svd3 *d = &at.d[at.number[e - first]];
            double p[9];
            if (target_of(b, e)->damps > 0.0) {
                project_element(par, b, e, d, p);
                strain_damper_tangent(d, p, 3, J);
            } else tangent_of(par, b, e, d, J);
        }
    }
}

/* ---- damping --------------------------------------------------------------------------------- */

static double damping(const void *par) { return ((const struct params *)par)->damping; }

static void set_rest(const void *par, int e, const svd3 *d, struct target *target) {
    target->damps = !is_volume(par, e);
    strain_damper_rest(d, 3, target->rest);
    target->least = target->most = product(d->s);
}

static void damping_rest(const void *par, const pdyn_batch *b, int first, int last) {
    const double *u[SVD3_LANES];
    svd3 d[SVD3_LANES];
    for (; first < last; first += SVD3_LANES) {
        int count = last - first < SVD3_LANES ? last - first : SVD3_LANES;
        for (int l = 0; l < SVD3_LANES; l++)
            u[l] = b->u + 9 * (size_t)(first + (l < count ? l : 0));
        decompose_tets(u, d);
        for (int l = 0; l < count; l++)
            set_rest(par, first + l, &d[l], (struct target *)b->data + first + l);
    }
}

const pdyn_constraint_type pdyn_constraint_tet = {
    .name = "tet",
    .summary = "strain and volume of a soft solid",
    .flags = PDYN_ON_VOLUME,
    .params_size = sizeof(struct params),
    .params = params,
    .data_size = sizeof(struct target),
    .elements = elements,
    .rows = 3,
    .width = 4,
    .select = select,
    .weight = weight,
    .project = project,
    .tangent = tangent,
    .damping = damping,
    .damping_rest = damping_rest,
};
