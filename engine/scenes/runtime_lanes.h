/* runtime_lanes.h - the structure of a tree read at run time: the tables are those of the case, not
 * constants. Nothing that a compiler makes of constants changes a bit, so that this is what kernels
 * compiled for one structure are held to; and it is what runs where there is no compiler.
 */
#ifndef STANCE_SCENES_RUNTIME_LANES_H
#define STANCE_SCENES_RUNTIME_LANES_H

#include "engine/tree.h"

/* Room for every structure. */
#define TREE_RUNTIME
#define TREE_BASE 2
#define TREE_ANGLES STANCE_MAX_ANGLES
#define TREE_CONTACTS STANCE_MAX_CONTACTS
#define TREE_ACTUATORS STANCE_MAX_ACTUATORS
#define TREE_SPRINGS (STANCE_MAX_ANGLES + 1)
#define TREE_ROTORS (STANCE_MAX_ANGLES + 1)
#define TREE_POINTS STANCE_MAX_NAMED
#define TREE_TURNS STANCE_MAX_ANGLES
#define TREE_PUSHES STANCE_MAX_PUSHES
#define TREE_SERVOS 1
#define TREE_SLIDES 1
#define TREE_PLATES 1

enum { SCENE_POSTURE = STANCE_MAX_POSTURE };

/* That of the cases at hand: those of a stream share it. */
static _Thread_local const stance_tree *tree_now;
#define SCENE_BEGIN(c) (tree_now = (c)->tree)

#define tree_base_size (tree_now->base)
#define tree_angles (tree_now->angles)
#define tree_contacts (tree_now->contacts)
#define tree_actuators (tree_now->actuators)
#define tree_springs (tree_now->springs)
#define tree_rotors (tree_now->rotors)
#define tree_points (tree_now->points)
#define tree_turns (tree_now->turns)
#define tree_pushes (tree_now->pushes)
#define tree_plates (tree_now->plates)
#define tree_above (tree_now->above)
#define tree_slide (tree_now->slide)
#define tree_sliding (tree_now->sliding)
#define tree_slide_count (tree_now->slides)
#define tree_straight (tree_now->straight)
#define tree_straight_joint (tree_now->straight_joint)
#define tree_straight_end (tree_now->straight_end)
#define tree_alone (tree_now->alone)
#define tree_carries (tree_now->carries)
#define tree_kind (tree_now->kind)
#define tree_body (tree_now->body)
#define scene_other (tree_now->other)
#define scene_grip (tree_now->grip)
#define tree_rough (tree_now->rough)
#define tree_top (tree_now->top)
#define tree_point_top (tree_now->point_top)
#define tree_actuator (tree_now->actuator)
#define tree_spring (tree_now->spring)
#define tree_rotor (tree_now->rotor)
#define tree_turning (tree_now->turning)
#define tree_push_path (tree_now->push_path)
#define tree_push_impulse (tree_now->push_impulse)
#define tree_push_swings (tree_now->push_swings)
#define tree_coupled (tree_now->coupled)
#define tree_near (tree_now->near)
#define tree_through (tree_now->through)
#define tree_path (tree_now->path)
#define tree_loads (tree_now->loads)
#define tree_point_path (tree_now->point_path)

/* What the case has of the room. */
#define OWN_COORDINATES (tree_base_size + tree_angles)
#define OWN_CONTACTS tree_contacts
#define OWN_ACTUATORS tree_actuators
#define OWN_POSTURE ((tree_base_size == 1) + tree_angles)

#include "engine/scenes/tree_lanes.h"

#endif
