/* biped_lanes.h - the structure of the biped that the program carries (scenes/carried.c), as
 * stance_tree_text writes it: test_tree holds it to that. */
#define TREE_BASE 2
#define TREE_ANGLES 3
#define TREE_CONTACTS 2
#define TREE_ACTUATORS 2
#define TREE_SPRINGS 0
#define TREE_ROTORS 0
#define TREE_POINTS 2
#define TREE_TURNS 0
#define TREE_PUSHES 0
#define TREE_SERVOS 1
#define TREE_SLIDES 0
#define TREE_PLATES 0
static const int tree_above[] = {-1, 0, 0};
static const int tree_slide[] = {0, 0, 0};
static const int tree_sliding[] = {0};
static const int tree_straight[] = {1, 1, 1};
static const int tree_straight_joint[] = {1, 1, 1};
static const int tree_straight_end[] = {1, 1};
static const int tree_alone[] = {1, 1, 1};
static const int tree_carries[] = {0, 1, 1};
static const int tree_kind[] = {0, 0};
static const int tree_body[] = {1, 2};
static const int scene_other[] = {-1, -1};
static const int scene_grip[] = {0, 1};
static const int tree_rough[] = {0, 0};
static const int tree_top[] = {-1, -1};
static const int tree_point_top[] = {-1, -1};
static const int tree_actuator[] = {1, 2};
static const int tree_spring[] = {0};
static const int tree_rotor[] = {0};
static const int tree_push_impulse[] = {0};
static const int tree_push_swings[] = {0};
static const int tree_turning[] = {0};
static const int tree_coupled[][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
static const int tree_near[][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
static const int tree_through[][3] = {{-1, -1, -1}, {1, -1, -1}, {2, -1, -1}};
static const int tree_path[][3] = {{-1, 100, -1}, {-1, -1, 100}};
static const int tree_loads[][3] = {{-1, 0, -1}, {-1, -1, 0}};
static const int tree_push_path[][3] = {{0, 0, 0}};
static const int tree_point_path[][3] = {{-1, -1, -1}, {100, -1, -1}};
#include "engine/scenes/tree_lanes.h"
