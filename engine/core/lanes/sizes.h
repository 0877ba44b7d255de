/* sizes.h - numbers that follow from a scene's. */
#ifndef STANCE_CORE_LANES_SIZES_H
#define STANCE_CORE_LANES_SIZES_H

/* What a scene takes of a case. */
#ifndef SCENE_NUMBERS
#define SCENE_NUMBERS(c) (c)->robot
#define SCENE_OF(c) KERNEL_SCENE
#define SCENE_POSTURE_ORIGIN(c, i) ((void)(c), 0)
#define SCENE_TORQUE_LIMIT(c, i) ((void)(c), INFINITY)
#endif

/* Of the last SCENE_ANGLES coordinates some may be displacements that scene_trig keeps in place of
 * the sine. */
#ifndef SCENE_SLIDES
#define SCENE_SLIDES(a) ((void)(a), false)
#endif

/* Pushes that a scene may get; without any: */
#ifndef SCENE_PUSHES
#define SCENE_PUSHES 0
#define scene_push(body, t, h) (void)(t), (void)(h)
#define scene_push_edge(body, t, h, least) ((void)(t), (void)(least), (h))
#define scene_pushed_until(body) lanes_of(0)
#define scene_strike(body, trig, t, within, w) ((void)(within), MASK_NONE)
#endif

/* What a case has of these, where the structure is read at run time: a scene's rows of arrays. */
#ifndef OWN_COORDINATES
#define OWN_COORDINATES SCENE_COORDINATES
#define OWN_CONTACTS SCENE_CONTACTS
#define OWN_ACTUATORS SCENE_ACTUATORS
#define OWN_POSTURE SCENE_POSTURE
#define SCENE_BEGIN(c) (void)(c)
#endif

/* Loops over no contacts are dead; these warnings look at them all the same. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wstringop-overflow"
#pragma GCC diagnostic ignored "-Wstringop-overread"
#endif

enum {
    FIRST_ANGLE = SCENE_COORDINATES - SCENE_ANGLES,
    CONTACTS = SLOTS(SCENE_CONTACTS), /* lengths of arrays that may be empty */
    ACTUATORS = SLOTS(SCENE_ACTUATORS),
    POSTURES = SLOTS(SCENE_POSTURE),
};

#endif
