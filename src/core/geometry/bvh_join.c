#include "bvh_join.h"

/* A divided join has at least so many parts, unless they are single groups. */
enum { ENOUGH = BVH_PARTS / (BVH_WIDTH * BVH_WIDTH) };

static const struct box_group *group_at(const struct bvh *tree, int level, int group) {
    return &tree->group[tree->first[level] + group];
}

/* Whether the part is a group of a hierarchy with itself. */
static bool is_twice(const struct bvh_join *join, const struct group_pair *p) {
    return join->tree[0] == join->tree[1] && p->group[0] == p->group[1];
}

/* Sets meets[i][k] where lane i of the first group and lane k of the second one have pairs. */
INLINE void find_meetings(const struct bvh_join *join, const struct group_pair *p,
                          int64_t meets[BVH_WIDTH][BVH_WIDTH]) {
    const struct box_group *a = group_at(join->tree[0], p->level[0], p->group[0]);
    const struct box_group *b = group_at(join->tree[1], p->level[1], p->group[1]);
    bool twice = is_twice(join, p);
    for (int i = 0; i < BVH_WIDTH; i++) {
        struct box box = {{a->min[0][i], a->min[1][i], a->min[2][i]},
                          {a->max[0][i], a->max[1][i], a->max[2][i]}};
        box_group_test(b, &box, meets[i]);
        if (!(meets[i][0] | meets[i][1] | meets[i][2] | meets[i][3])) continue;
        for (int k = 0; k < BVH_WIDTH; k++) {
            bool same = a->owner[i] >= 0 && a->owner[i] == b->owner[k];
            bool once = !twice || k > i || (k == i && p->level[0] > 0);
            if (same || !once || !(a->changed[i] || b->changed[k])) meets[i][k] = 0;
        }
    }
}

/* Lists the parts of a part; returns their number. The group of the higher level is divided, or
 * both where they are of one level. */
INLINE int divide(const struct group_pair *p, int64_t meets[BVH_WIDTH][BVH_WIDTH],
                  struct group_pair *out) {
    bool first = p->level[0] >= p->level[1], second = p->level[1] >= p->level[0];
    int count = 0;
    for (int i = 0; i < BVH_WIDTH; i++)
        for (int k = 0; k < BVH_WIDTH; k++) {
            if (!meets[i][k]) continue;
            struct group_pair part = {{p->level[0] - first, p->level[1] - second},
                                      {first ? BVH_WIDTH * p->group[0] + i : p->group[0],
                                       second ? BVH_WIDTH * p->group[1] + k : p->group[1]}};
            bool known = false; /* from another lane of a group that is not divided */
            for (int m = 0; first != second && m < count; m++)
                known |= !memcmp(&out[m], &part, sizeof part);
            if (!known) out[count++] = part;
        }
    return count;
}

static bool is_single(const struct group_pair *p) { return !p->level[0] && !p->level[1]; }

WIDE static void visit_meetings(const struct bvh_join *join, struct group_pair part,
                                bool (*visit)(void *user, int a, int b), void *user) {
    /* a division adds fewer than 16 parts, and is followed by fewer than BVH_LEVELS others; 4 kB,
     * not set to 0 */
    struct group_pair stack[BVH_LEVELS * BVH_WIDTH * BVH_WIDTH];
    stack[0] = part;
    for (int waiting = 1; waiting;) {
        int64_t meets[BVH_WIDTH][BVH_WIDTH];
        struct group_pair p = stack[--waiting];
        find_meetings(join, &p, meets);
        if (!is_single(&p)) {
            waiting += divide(&p, meets, stack + waiting);
            continue;
        }
        const int *a = join->tree[0]->order + BVH_WIDTH * p.group[0];
        const int *b = join->tree[1]->order + BVH_WIDTH * p.group[1];
        for (int i = 0; i < BVH_WIDTH; i++)
            for (int k = 0; k < BVH_WIDTH; k++)
                if (meets[i][k] && !visit(user, a[i], b[k])) return;
    }
}

void bvh_join_visit(const struct bvh_join *join, struct group_pair part,
                    bool (*visit)(void *user, int a, int b), void *user) {
    visit_meetings(join, part, visit, user);
}

int bvh_join_divide(const struct bvh_join *join, struct group_pair part[BVH_PARTS]) {
    int tops[] = {join->tree[0]->levels - 1, join->tree[1]->levels - 1}, count = 1;
    if (!join->tree[0]->count || !join->tree[1]->count) return 0;
    part[0] = (struct group_pair){{tops[0], tops[1]}, {0, 0}};
    for (bool more = true; more && count < ENOUGH;) {
        struct group_pair next[BVH_PARTS];
        int found = 0;
        more = false;
        for (int k = 0; k < count; k++) {
            int64_t meets[BVH_WIDTH][BVH_WIDTH];
            if (is_single(&part[k])) {
                next[found++] = part[k];
                continue;
            }
            find_meetings(join, &part[k], meets);
            found += divide(&part[k], meets, next + found);
            more = true;
        }
        memcpy(part, next, (size_t)found * sizeof *part);
        count = found;
    }
    return count;
}
