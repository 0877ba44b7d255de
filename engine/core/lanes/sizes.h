/* sizes.h - numbers that follow from a scene's. */
#ifndef STANCE_CORE_LANES_SIZES_H
#define STANCE_CORE_LANES_SIZES_H

enum {
    SECOND = SCENE_CONTACTS - 1, /* the other contact, where there are two */
    FIRST_ANGLE = SCENE_COORDINATES - SCENE_ANGLES,
    ACTUATORS = SLOTS(SCENE_ACTUATORS), /* lengths of arrays that may be empty */
    POSTURES = SLOTS(SCENE_POSTURE),
};

#endif
