/* regroup.h - moves cases between bundles so that those side by side have the same contacts: a
 * bundle in which one robot stands on two feet pays for two feet in every lane, and one whose step
 * is not ordinary has all lanes take the slow way.
 *
 * A case's arithmetic is its lane's alone, so that it may move whenever no step is under way.
 */
#ifndef STANCE_CORE_LOOP_REGROUP_H
#define STANCE_CORE_LOOP_REGROUP_H

#include "bundle.h"

/* What a lane's next step will cost: its closed contacts, and whether it is ordinary if it is like
 * the last one; idle lanes come last. */
static uint64_t regroup_key(const struct bundle *b, int lane)
{
    uint64_t touching = 0, rank = 0;
    if (!b->which[lane])
        return UINT64_MAX;
    for (int c = 0; c < OWN_CONTACTS; c++)
        if (lane_get(&b->set.may_touch[c], lane) > 0 &&
            lane_get(&b->now.gap[c], lane) <= STEP_CLOSED)
            touching |= (uint64_t)1 << c;
    for (; touching; touching >>= 1) /* its place in Gray's code: neighbours share contacts */
        rank ^= touching;
#ifdef ADVANCE_ORDINARY
    return 2 * rank + (uint64_t)advance_was_ordinary(&b->advance, lane);
#else
    return 2 * rank;
#endif
}

_Static_assert(sizeof(struct bundle) % sizeof(lanes) == 0 &&
                   offsetof(struct bundle, set) % sizeof(lanes) == 0,
               "a bundle's lanes are columns");

/* Exchanges two lanes with everything that is kept of them. */
static void regroup_swap(struct bundle *a, int i, struct bundle *b, int j)
{
    const stance_case *const which = a->which[i];
    stance_result *const result = a->result[i];
    const struct walking walk = a->walk[i];
    a->which[i] = b->which[j], b->which[j] = which;
    a->result[i] = b->result[j], b->result[j] = result;
    a->walk[i] = b->walk[j], b->walk[j] = walk;
    const size_t begin = offsetof(struct bundle, set), column = LANES * sizeof(double);
    char *const p = (char *)a + begin + (size_t)i * sizeof(double);
    char *const q = (char *)b + begin + (size_t)j * sizeof(double);
    for (size_t k = 0; k + column <= sizeof *a - begin; k += column) {
        double x, y;
        memcpy(&x, p + k, sizeof x);
        memcpy(&y, q + k, sizeof y);
        memcpy(p + k, &y, sizeof y);
        memcpy(q + k, &x, sizeof x);
    }
}

/* What a bundle knows of its lanes together. */
static void regroup_recount(struct bundle *b)
{
    b->live = MASK_NONE;
    b->filled = b->recorded = b->unusual = b->bending = b->choosy = b->walking = b->programs =
        b->noisy = 0;
    for (int lane = 0; lane < LANES; lane++)
        if (b->which[lane]) {
            b->live |= mask_of_lane(lane);
            b->filled++;
            bundle_count(b, b->which[lane], 1);
        }
}

/* Sorts the lanes of n bundles by their contacts; what is sorted stays where it is. */
COLD void regroup(struct bundle *b, int n)
{
    uint64_t key[STREAM_BUNDLES * LANES], sorted[STREAM_BUNDLES * LANES];
    const int lanes_in_all = n * LANES;
    bool moved = false;
    for (int i = 0; i < lanes_in_all; i++) {
        int at = i;
        key[i] = regroup_key(&b[i / LANES], i % LANES);
        for (; at > 0 && sorted[at - 1] > key[i]; at--)
            sorted[at] = sorted[at - 1];
        sorted[at] = key[i];
    }
    for (int i = 0; i < lanes_in_all; i++) {
        int j = i;
        while (key[j] != sorted[i])
            j++;
        if (j == i)
            continue;
        regroup_swap(&b[i / LANES], i % LANES, &b[j / LANES], j % LANES);
        key[j] = key[i], key[i] = sorted[i];
        moved = true;
    }
    for (int k = 0; k < n && moved; k++)
        regroup_recount(&b[k]);
}

#endif
