/* sizes.h - numbers that follow from a scene's. */
#ifndef STANCE_CORE_LANES_SIZES_H
#define STANCE_CORE_LANES_SIZES_H

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
