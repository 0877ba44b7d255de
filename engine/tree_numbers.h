/* tree_numbers.h - what of a mechanism are numbers, as kernels take them: a part of stance.h, which
 * has the sizes. */
#ifndef STANCE_TREE_NUMBERS_H
#define STANCE_TREE_NUMBERS_H

/* What a piece of the ground is: one plate; `count` plates of `width`, each `height` above the one
 * before; or `count` plates of `width`, each as high as what is before them and up to `height` more
 * or less, at random. See core/loop/plates.h. */
typedef enum stance_ground_kind { STANCE_PLATE, STANCE_STAIRS, STANCE_ROUGH } stance_ground_kind;

/* A piece of the ground, from `from` to where the next one begins. */
typedef struct stance_plate_numbers {
    double from;         /* m along the ground; of one by footfall, ahead of a foot */
    double footfall;     /* that lands on it or beyond: a number from 1; 0: it is at `from` */
    double height;       /* m above the plane of the ground; of stairs and rough ground as above */
    double width, count; /* of them: m, > 0, of each; how many, may be INFINITY */
    double seed;         /* of rough ground: which, < 0: another at each point of a sample */
    double friction_factor; /* of its coefficient of friction by the ground's, > 0 */
} stance_plate_numbers;

/* What kernels take of a mechanism (engine/tree.c has the meanings and makes them), arrays by
 * angles, contacts and so on in the order of its tables. */
typedef struct stance_tree_numbers {
    double mass;         /* kg */
    double gravity[2];   /* minus gravity, m/s^2, in the ground's axes */
    double slope[3];     /* angle, sine, cosine */
    double lift[2];      /* gravity as a rail feels it, which may have an armature */
    double rail[2];      /* its direction */
    double reference[2]; /* m, of the root's frame: what x and z are of */
    double curvature[3]; /* for Newton's stop rule */
    double moment[STANCE_MAX_ANGLES][2];     /* kg m, first */
    double inertia[STANCE_MAX_ANGLES];       /* kg m^2, second, about the joint, rotors included; of
                                              * a slide kg */
    double inverse[STANCE_MAX_ANGLES];       /* 1 / inertia */
    double joint[STANCE_MAX_ANGLES][2];      /* m, in the frame above; of a slide its direction */
    double rotor[STANCE_MAX_ANGLES + 1];     /* kg m^2, kg */
    double spring[STANCE_MAX_ANGLES + 1][3]; /* stiffness, damping, where it rests */
    double end[STANCE_MAX_CONTACTS][3]; /* m: place in its frame, radius; of a stop: the limit */
    double rough[STANCE_MAX_CONTACTS];  /* its coefficient of friction by the ground's */
    double point[STANCE_MAX_NAMED][2];  /* m: points that may fall, in their frames ... */
    double lowest[STANCE_MAX_NAMED];    /* ... and how far */
    double turn[STANCE_MAX_ANGLES][2];  /* rad, that bodies may turn; their angles at 0 */
    double limit[STANCE_MAX_ACTUATORS]; /* N m, N: what an actuator gives at most */
    double push[STANCE_MAX_PUSHES][7];  /* m: place in its frame; N, or N s where it is at an
                                         * instant,  in the ground's axes; s: from, to; Hz */
    int plates;
    stance_ground_kind plate_kind[STANCE_MAX_PLATES];
    stance_plate_numbers plate[STANCE_MAX_PLATES];
} stance_tree_numbers;

#endif
