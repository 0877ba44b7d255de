/* tree.h - what of a mechanism is structure, and what are numbers: the tables of integers that
 * kernels are compiled from (scenes/tree_lanes.h has the equations), and the numbers that go with
 * them.
 *
 * Bodies that are fixed are merged into the one that carries them; what is left are the angles, in
 * the order of their bodies, the parent before its children. A joint inside the tree that slides is
 * one of the angles here, and marked as such: it has a place among them, and a displacement.
 */
#ifndef STANCE_TREE_H
#define STANCE_TREE_H

enum {
    /* Kinds of contacts. */
    STANCE_TREE_POINT,
    STANCE_TREE_DISC, /* or an end of a capsule */
    STANCE_TREE_SOLE, /* an end of a flat one */
    STANCE_TREE_LOW,  /* stops of a joint */
    STANCE_TREE_HIGH,

    STANCE_TREE_OWN = 100, /* in a path: the body that carries the point */
};
#define TREE_SLOTS(n) ((n) > 0 ? (n) : 1)

#ifndef TREE_ANGLES /* what follows is not for kernels */

#include "mechanism.h"

enum { STANCE_TREE_TEXT = 8192 }; /* bytes of the tables as text, at most */

/* All indices are of angles unless said otherwise; -1: none, the base, the rail. */
typedef struct stance_tree {
    int base; /* coordinates of the base: 2 free, 1 on a rail, 0 pinned */
    int angles, contacts, actuators, springs, rotors, points, turns, pushes, plates;
    int slides, sliding[STANCE_MAX_ANGLES]; /* the joints that slide */
    int above[STANCE_MAX_ANGLES];           /* whose frame the joint is in */
    int slide[STANCE_MAX_ANGLES];           /* is it one of them, and no frame? */
    int straight[STANCE_MAX_ANGLES];        /* its first moment has no x */
    int straight_joint[STANCE_MAX_ANGLES];  /* nor its joint in the frame above, or its axis */
    int coupled[STANCE_MAX_ANGLES][STANCE_MAX_ANGLES]; /* [i][j]: j above i moves its joint */
    int near[STANCE_MAX_ANGLES][STANCE_MAX_ANGLES];    /* or the elimination couples them */
    /* [i][j]: the joint in frame j through which i hangs from it; of a j that slides, >= 0 where it
     * moves i. */
    int through[STANCE_MAX_ANGLES][STANCE_MAX_ANGLES];
    int alone[STANCE_MAX_ANGLES];   /* nothing that hangs from it changes what it resists with */
    int carries[STANCE_MAX_ANGLES]; /* it is on a contact's path */
    int kind[STANCE_MAX_CONTACTS], body[STANCE_MAX_CONTACTS];
    int straight_end[STANCE_MAX_CONTACTS];
    int other[STANCE_MAX_CONTACTS]; /* contact: the other end of the sole */
    /* Contact that holds its friction; -1: a stop. On plates, which may be of different height,
     * each end of a sole holds its own. */
    int grip[STANCE_MAX_CONTACTS];
    int rough[STANCE_MAX_CONTACTS]; /* its coefficient is not the ground's */
    /* How frames carry a point, by the arm in each: -1: it has none; STANCE_TREE_OWN: to the point;
     * else to the joint of that angle; of what slides, >= 0: it moves the point. */
    int path[STANCE_MAX_CONTACTS][STANCE_MAX_ANGLES];
    int loads[STANCE_MAX_CONTACTS][STANCE_MAX_ANGLES]; /* >= 0: elimination has to do with it */
    int top[STANCE_MAX_CONTACTS];                      /* of a base that is not free: first frame,
                                                         or STANCE_TREE_OWN */
    int actuator[STANCE_MAX_ACTUATORS];
    int spring[STANCE_MAX_ANGLES + 1], rotor[STANCE_MAX_ANGLES + 1];
    int point_path[STANCE_MAX_NAMED][STANCE_MAX_ANGLES], point_top[STANCE_MAX_NAMED];
    int turning[STANCE_MAX_ANGLES];
    int push_path[STANCE_MAX_PUSHES][STANCE_MAX_ANGLES], push_impulse[STANCE_MAX_PUSHES],
        push_swings[STANCE_MAX_PUSHES];
} stance_tree;

/* Errors: BAD_ARGUMENT where there are more angles, contacts or else than fit. */
stance_error stance_tree_make(const stance_mechanism *m, stance_tree *tree,
                              stance_message *message);

/* The tables as C, for kernels; integers only. servos: laws need them, see stance_law. */
void stance_tree_text(const stance_tree *tree, bool servos, char text[STANCE_TREE_TEXT]);

/* What kernels take of robot[], gravity and slope included. */
void stance_tree_numbers_make(const stance_tree *tree, const stance_mechanism *m,
                              const double *robot, stance_tree_numbers *number);

#endif
#endif
