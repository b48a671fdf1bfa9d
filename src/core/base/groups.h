/* Groups of indices (a disjoint-set forest): parent[i] leads from an index to the smallest of its
 * group, which is its own parent. */
#ifndef PDYN_GROUPS_H
#define PDYN_GROUPS_H

/* The smallest index of the group of i; shortens the way to it. */
static inline int groups_first(int *parent, int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

static inline void groups_join(int *parent, int a, int b) {
    a = groups_first(parent, a), b = groups_first(parent, b);
    if (a < b) parent[b] = a;
    else parent[a] = b;
}

#endif
