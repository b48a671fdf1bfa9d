/* Common motion of bodies. A path stops a vertex at a part of its displacement. Where bodies fly
 * together, the others would move on by the rest of the common displacement, which can be many
 * times the thickness. Therefore paths of bodies in flight begin where the bodies are after their
 * common displacement F, the mean over their points:
 *
 *     x_i -> x_i + F -> x_i + F + t_i (d_i - F),     0 <= t_i <= 1
 *
 * Bodies that may come close to each other on their ways are a cluster. The first part of the path
 * moves a cluster as a whole. It is left out (F = 0) where it may bring the cluster close to other
 * surfaces, and for clusters with a fluid or a held body, or that may come close to a solid. */
#include "contact_parts.h"

#include "projdyn/vec3.h"

#include <string.h>

/* ---- clusters -------------------------------------------------------------------------------- */

/* The first body of the cluster of a body. */
static int root_of(const struct contact *c, int body) {
    while (c->common.cluster[body] != body) body = c->common.cluster[body];
    return body;
}

static void join(struct contact *c, int a, int b) {
    int low = a < b ? a : b, high = a < b ? b : a;
    c->common.cluster[high] = low;
    c->common.held_cluster[low] |= c->common.held_cluster[high];
}

static void begin_clusters(struct contact *c) {
    for (int b = 0; b < c->bodies; b++)
        c->common.cluster[b] = b, c->common.held_cluster[b] = c->common.held[b];
    for (int i = c->vertices; i < c->free; i++) c->common.held_cluster[c->group[i]] = true;
}

/* The cluster of a group; -1: a solid. */
static int cluster_of(const struct contact *c, int group) {
    return group < c->bodies ? root_of(c, group) : -1;
}

/* Joins the clusters of each pair of the list. stay: they count as held instead. */
static void join_pairs(struct contact *c, bool stay) {
    for (int k = 0; k < c->pairs.count; k++) {
        const struct pair *p = &c->pairs.pair[k];
        int a = cluster_of(c, c->group[p->point[0]]), b = cluster_of(c, c->group[p->point[3]]);
        if (a >= 0 && b >= 0 && a != b && !stay) join(c, a, b);
        else if (a != b) {
            if (a >= 0) c->common.held_cluster[a] = true;
            if (b >= 0) c->common.held_cluster[b] = true;
        }
    }
}

/* ---- the common displacement ----------------------------------------------------------------- */

/* Sets c->common.displacement to the means of c->path.step over the clusters. */
static void find_means(struct contact *c) {
    struct common_motion *m = &c->common;
    memset(m->displacement, 0, 3 * (size_t)c->bodies * sizeof *m->displacement);
    for (int b = 0; b < c->bodies; b++) m->members[b] = 0;
    for (int i = 0; i < c->free; i++) {
        int root = root_of(c, c->group[i]);
        m->members[root]++;
        vec3_add(m->displacement + 3 * root, 1.0, c->path.step + 3 * i);
    }
    for (int b = 0; b < c->bodies; b++) {
        int root = root_of(c, b);
        for (int a = 0; a < 3; a++)
            m->displacement[3 * b + a] = m->held_cluster[root] ? 0.0
                                         : b == root ? m->displacement[3 * b + a] / m->members[b]
                                                     : m->displacement[3 * root + a];
    }
}

pdyn_status common_motion_find(struct contact *c) {
    struct common_motion *m = &c->common;
    begin_clusters(c);
    join_pairs(c, false);
    find_means(c);
    for (int i = 0; i < c->free; i++)
        memcpy(c->path.step + 3 * i, m->displacement + 3 * c->group[i],
               3 * sizeof *m->displacement);
    pdyn_status status = contact_update_pairs(c, c->path.x, c->path.step);
    join_pairs(c, true);
    for (int b = 0; b < c->bodies; b++)
        if (m->held_cluster[root_of(c, b)])
            memset(m->displacement + 3 * b, 0, 3 * sizeof *m->displacement);
    return status;
}

void contact_hold(struct contact *c, int body, bool held) { c->common.held[body] = held; }
