/* schema_rows.c - the scenario format: its table. */
#include "schema_rows.h"

#include <math.h>

/* ---- words ----------------------------------------------------------------------------------- */

/* In the order of the enumerations in scenario.h. */
static const char *const design_words[] = {"place", "place-schur", "lqr", "gains"};
static const char *const design_time_words[] = {"continuous", "sampled"};
static const char *const branch_words[] = {"upper", "lower"};
static const char *const prefer_words[] = {"least-energy", "most-energy"};
static const char *const impacts_words[] = {"limited", "newton", "moreau"};
static const char *const lands_words[] = {"anywhere", "ahead"};
static const char *const spacing_words[] = {"linear", "log"};
static const char *const truth_words[] = {"false", "true"};
static const char *const record_words[] = {"none", "all"};
static const char *const settle_words[] = {"off"};
static const char *const vary_words[] = {"gains", "poles", "weights", "law"};
static const char *const weight_words[] = {"even", "normal"};
static const char *const over_words[] = {"worst", "mean"};
const char *const schema_none[1] = {"none"};

static const char *const answer_words[] = {
#define ANSWER_WORD(name, ...) #name,
    STANCE_ANSWERS(ANSWER_WORD)
#undef ANSWER_WORD
        "final_state",
};
static const char *const aim_words[] = {"share", "nearest",
#define ANSWER_WORD(name, ...) #name,
                                        STANCE_ANSWERS(ANSWER_WORD)
#undef ANSWER_WORD
};

#define WORDS(list) .words = (list), .word_count = sizeof(list) / sizeof((list)[0])

/* ---- the table ------------------------------------------------------------------------------- */

/* What is not said of a row is 0, and its default, too; when it may be given, and whether the scene
 * decides what it is, are as of the mapping that it stands in. Without VALUE it is bound by hand.
 */
#define VALUE(member) .offset = offsetof(struct scenario_values, member)
#define NUMBER(member) .type = FIELD_NUMBER, .sweep = true, VALUE(member)
#define WHOLE(member) .type = FIELD_INTEGER, .sweep = true, VALUE(member)
#define WORD(member, list) .type = FIELD_WORD, .sweep = true, VALUE(member), WORDS(list)
#define RANGE(least, largest) .low = (least), .high = (largest)
#define ABOVE(bound, largest) RANGE(bound, largest), .low_open = true
#define NEW "it is new at each sample"
#define ACTS "it acts on what is sampled"

/* Loose bounds that keep nonsense out where physics gives none. */
#define LARGE 1e9
#define RIGHT 1.5708 /* a right angle, rounded up */

/* One member a line would make the table hard to read. */
/* clang-format off */
const struct row schema_rows[] = {
    {0, {.path = "stance", .type = FIELD_INTEGER, .required = true, RANGE(1, 1), .fallback = NAN,
         .text = "version of this format"}},
    {0, {.path = "title", .type = FIELD_TEXT, .fallback_text = "the file's name",
         .text = "what the study is about, in a line"}},
    {FAMILY_SCENES, {.path = "scene", .type = FIELD_WORD, .required = true, .fallback = NAN,
         .text = "what is simulated"}},

    {0, {.path = "robot", .type = FIELD_MAP, .by_scene = true,
         .text = "the body that is simulated"}},
    {FAMILY_ROBOT, {.path = "robot.*", NUMBER(robot), .design = true, .text = "%s"}},

    {0, {.path = "robot.slope", NUMBER(robot[STANCE_ROBOT_SLOPE]), .by_scene = true,
         .unit = "rad", RANGE(-1.5, 1.5),
         .text = "angle of the plane; positive: the block's +x is downhill"}},

    {0, {.path = "ground", .type = FIELD_MAP, .text = "the ground, a half plane z <= 0"}},
    {0, {.path = "ground.friction", NUMBER(friction), .unit = "1", .fallback = 0.8, RANGE(0, 10),
         .text = "Coulomb coefficient of friction"}},
    {0, {.path = "ground.restitution", NUMBER(restitution), .unit = "1", RANGE(0, 1),
         .text = "coefficient of restitution",
         .more = "Of the velocity with which a contact meets the ground: see ground.law."}},
    {0, {.path = "ground.slope", NUMBER(robot[STANCE_ROBOT_SLOPE]), .design = true, .unit = "rad",
         .quiet = true, RANGE(-RIGHT, RIGHT),
         .text = "slope of the ground, positive: +x is downhill",
         .more = "x and z stay level and upright."}},
    {0, {.path = "ground.gravity", NUMBER(robot[STANCE_ROBOT_GRAVITY]), .design = true,
         .unit = "m/s^2", .fallback = STANCE_GRAVITY, .quiet = true, RANGE(0, 1e4),
         .text = "acceleration of gravity"}},
    {0, {.path = "ground.law", WORD(impacts, impacts_words), .quiet = true,
         .text = "what restitution asks for",
         .more = "newton: normal velocities, -e times those before, whatever energy friction then "
                 "adds. limited: the same with the largest e that adds none, where e would "
                 "(limited_impacts counts them). moreau: of tangential velocities the same as of "
                 "normal ones, by which nothing is added."}},
    {0, {.path = "ground.lands", WORD(lands_ahead, lands_words), .quiet = true,
         .text = "where a foot in the air may come to the ground",
         .more = "ahead: only where it is further along the ground than all other feet on it, as "
                 "walkers without knees need, whose swinging foot would scuff; elsewhere it goes "
                 "through the ground. Decided at the end of each step. Both ends of a sole are one "
                 "foot."}},
    {0, {.path = "ground.prefer", WORD(most_energy, prefer_words), .quiet = true,
         .text = "which motion, where several obey the contact laws",
         .more = "The one that leaves the least kinetic energy, or the most; contacts go on as "
                 "they do, standing or sliding, while they can. Such steps are counted as "
                 "ambiguous_steps. Swept over both, each case is followed down both branches."}},
    {FAMILY_PLATES, {.path = "ground.plates", .type = FIELD_MAP, .by_scene = true, .sweep = true,
         VALUE(robot), .text = "pieces of uneven ground, in their order along it",
         .more = "At most 8, each a mapping with a name: {from: 0.5, height: -0.05}. Before the "
                 "first one is the plane, at height 0; of those that begin at a place or before it "
                 "the last in the list holds. For contacts that are points or flat soles, whose "
                 "ends are held."}},
    {FAMILY_CONTACTS, {.path = "ground.contacts", .type = FIELD_WORDS, .by_scene = true,
         VALUE(contacts), .fallback_text = "all of the scene's",
         .text = "points that may touch the ground"}},

    {0, {.path = "initial", .type = FIELD_MAP, .required = true,
         .text = "how a run begins: from an equilibrium or from a given state"}},
    {0, {.path = "initial.equilibrium", .type = FIELD_MAP, .by_scene = true, .use = USE_EQUILIBRIUM,
         .text = "the position of rest that the run begins at",
         .more = "Give any of its coordinates, or none: the others are found. Excludes "
                 "initial.state."}},
    {FAMILY_POSTURE, {.path = "initial.equilibrium.*", NUMBER(equilibrium.posture), .design = true,
         .fallback = NAN, .fallback_text = "follows from the others", .text = "equilibrium: %s"}},
    {FAMILY_BRANCH, {.path = "initial.equilibrium.branch", WORD(equilibrium.branch, branch_words),
         .design = true, .quiet = true,
         .text = "which of the two solutions: hip above or below the foot"}},
    {FAMILY_FOOT, {.path = "initial.support_foot", WHOLE(support_foot), .by_scene = true,
         .design = true, .fallback = NAN, .unit = "1", .quiet = true,
         .fallback_text = "1 with an equilibrium, else none",
         .text = "number of the foot that the robot stands on",
         .more = "With an equilibrium this foot stands at rest at the origin: offsets of angles "
                 "and their rates apply first, the translation follows from the foot, offsets of "
                 "the translation come last. With a state x, z and their rates follow."}},
    {FAMILY_CONTACTS, {.path = "initial.support", .type = FIELD_WORDS, .by_scene = true,
         .design = true, VALUE(support),
         .fallback_text = "the first contact with an equilibrium of a free root, else none",
         .text = "contacts that the robot stands on",
         .more = "They stand at rest, the first at the origin. With an equilibrium offsets apply "
                 "as with support_foot; with a state x, z and their rates follow."}},
    {0, {.path = "initial.offset", .type = FIELD_MAP, .by_scene = true, .use = USE_EQUILIBRIUM,
         .text = "how far from the equilibrium the run begins"}},
    {FAMILY_OFFSET, {.path = "initial.offset.*", NUMBER(offset), .quiet = true,
         .text = "initial offset: %s"}},
    {0, {.path = "initial.offset.scale", NUMBER(offset_scale), .unit = "1", .fallback = 1,
         .quiet = true, RANGE(-1e6, 1e6), .text = "factor of all other offsets",
         .more = "Swept beside directions (sweep.sample.method sphere) it goes along rays from the "
                 "equilibrium."}},
    {0, {.path = "initial.state", .type = FIELD_MAP, .by_scene = true, .use = USE_STATE,
         .text = "the whole initial state by hand", .more = "Excludes initial.equilibrium."}},
    {FAMILY_STATE, {.path = "initial.state.*", NUMBER(state), .quiet = true, .text = "initial %s"}},

    {0, {.path = "controller", .type = FIELD_MAP, .text = "what drives the actuators"}},
    {FAMILY_KINDS, {.path = "controller.kind", .type = FIELD_WORD, .design = true, VALUE(law),
         .samples = "this law acts on what is sampled", .text = "control law"}},
    {0, {.path = "controller.design", WORD(design, design_words), .use = USE_FEEDBACK,
         .design = true, .text = "where the gains come from",
         .more = "place: robust pole placement. place-schur: the same poles by SLICOT's Schur "
                 "method. lqr: linear quadratic regulator. gains: they are given."}},
    {0, {.path = "controller.design_time", WORD(design_time, design_time_words), .use = USE_MODEL,
         .design = true, .samples = "it makes the sampled model",
         .text = "model that the gains are designed for",
         .more = "sampled: the robot sampled every controller.sample_time with torques held in "
                 "between; a pole s becomes exp(s T), the cost of lqr stays the integral over all "
                 "time. Each sample time of a sweep is then a design of its own."}},
    {FAMILY_POLES, {.path = "controller.poles", .type = FIELD_POLES, .by_scene = true,
         .use = USE_PLACE, .required = true, .design = true, .unit = "1/s",
         .text = "poles of the closed loop, in the open left half plane",
         .more = "Real, or complex as -3+1.5i with -3-1.5i beside it; with place none may stand "
                 "there more often than there are actuators. As many as the robot has states while "
                 "the contacts that it stands on hold. A list, or a mapping of names of states."}},
    {FAMILY_POLES, {.path = "controller.poles[]", NUMBER(pole_re), .design = true, .unit = "1/s",
         .fallback = NAN, RANGE(-1e6, 0), .high_open = true, .text = "pole of the closed loop",
         .more = "Only a real pole can be swept."}},
    {FAMILY_STATES, {.path = "controller.poles.*", NUMBER(pole_re), .design = true, .unit = "1/s",
         .fallback = NAN, RANGE(-1e6, 0), .high_open = true, .text = "a pole, in the place of %s",
         .more = "Which state has which pole makes no difference: names count them."}},
    {FAMILY_MATRIX, {.path = "controller.gains", .type = FIELD_MATRIX, .by_scene = true,
         .use = USE_GAINS, .required = true, .design = true, .unit = "N m/rad, N m s/rad",
         .text = "gains: a row for each actuator; angles, then rates",
         .more = "Or by name: {hip: {trunk: 100, vtrunk: 10}}; what is not named has 0."}},
    {FAMILY_MATRIX, {.path = "controller.gains[][]", NUMBER(gains), .design = true,
         .unit = "N m/rad, N m s/rad", .fallback = NAN, RANGE(-LARGE, LARGE),
         .text = "gain of an actuator on an angle or a rate"}},
    {FAMILY_GAINS, {.path = "controller.gains.*", NUMBER(gains), .design = true,
         RANGE(-LARGE, LARGE), .text = "gain on %s"}},
    {0, {.path = "controller.weights", .type = FIELD_MAP, .by_scene = true, .use = USE_LQR,
         .text = "what the regulator minimises: weights times squares, integrated over time",
         .more = "Of the states in a list, `states`, or by name: {trunk: 100, vtrunk: 10}; what is "
                 "not named has 1."}},
    {FAMILY_POLES, {.path = "controller.weights.states", .type = FIELD_NUMBERS, .design = true,
         .unit = "1/rad^2, s^2/rad^2", .fallback_text = "1 each",
         .text = "weights of the angles, then of the rates"}},
    {FAMILY_POLES, {.path = "controller.weights.states[]", NUMBER(state_weights), .design = true,
         .unit = "1/rad^2, s^2/rad^2", .fallback = 1, RANGE(0, LARGE),
         .text = "weight of an angle or a rate"}},
    {FAMILY_ACTUATORS, {.path = "controller.weights.torques", .type = FIELD_NUMBERS, .design = true,
         .unit = "1/(N m)^2", .fallback_text = "1 each", .text = "weights of the torques",
         .more = "A list, or a mapping of actuators."}},
    {FAMILY_ACTUATORS, {.path = "controller.weights.torques[]", NUMBER(torque_weights),
         .design = true, .unit = "1/(N m)^2", .fallback = 1, ABOVE(0, LARGE),
         .text = "weight of a torque"}},
    {FAMILY_INPUTS, {.path = "controller.weights.torques.*", NUMBER(torque_weights), .design = true,
         .fallback = 1, ABOVE(0, LARGE), .text = "weight of %s"}},
    {FAMILY_STATES, {.path = "controller.weights.*", NUMBER(state_weights), .design = true,
         .fallback = 1, RANGE(0, LARGE), .text = "weight of %s"}},
    {0, {.path = "controller.model", .type = FIELD_MAP, .by_scene = true, .use = USE_FEEDBACK,
         .text = "the robot that the design believes in"}},
    {FAMILY_ROBOT, {.path = "controller.model.*", NUMBER(model), .design = true, .fallback = NAN,
         .fallback_text = "as the robot", .text = "model of the design: %s"}},
    {0, {.path = "controller.model.slope", NUMBER(model[STANCE_ROBOT_SLOPE]), .design = true,
         .unit = "rad", .fallback = NAN, .fallback_text = "as the ground", RANGE(-RIGHT, RIGHT),
         .text = "model of the design: slope of the ground"}},
    {0, {.path = "controller.model.gravity", NUMBER(model[STANCE_ROBOT_GRAVITY]), .design = true,
         .unit = "m/s^2", .fallback = NAN, .fallback_text = "as on the ground", RANGE(0, 1e4),
         .text = "model of the design: acceleration of gravity"}},
    {0, {.path = "controller.equilibrium", .type = FIELD_MAP, .by_scene = true, .use = USE_FEEDBACK,
         .fallback_text = "initial.equilibrium",
         .text = "the equilibrium that the controller is designed at"}},
    {FAMILY_POSTURE, {.path = "controller.equilibrium.*", NUMBER(design_point.posture),
         .design = true, .fallback = NAN, .fallback_text = "follows from the others",
         .text = "equilibrium of the controller: %s"}},
    {FAMILY_BRANCH, {.path = "controller.equilibrium.branch",
         WORD(design_point.branch, branch_words), .design = true, .quiet = true,
         .text = "which of the two solutions: hip above or below the foot"}},
    {FAMILY_FAR, {.path = "controller.far", .type = FIELD_WORD, .use = USE_FEEDBACK, VALUE(far),
         .quiet = true, .samples = "which law acts is decided at each sample",
         .text = "law that acts outside an ellipsoid about the target",
         .more = "state-feedback acts inside it, where sum((angle/near.angle)^2) + "
                 "sum((rate/near.rate)^2) <= 1 for the deviations from the target."}},
    {0, {.path = "controller.near", .type = FIELD_MAP, .use = USE_FAR,
         .text = "the ellipsoid inside which state-feedback acts"}},
    {0, {.path = "controller.near.angle", NUMBER(near_angle), .use = USE_FAR,
         .required = true, .unit = "rad", .fallback = NAN, ABOVE(0, LARGE), .text = "its semi-axis in each angle"}},
    {0, {.path = "controller.near.rate", NUMBER(near_rate), .use = USE_FAR,
         .required = true, .unit = "rad/s", .fallback = NAN, ABOVE(0, LARGE), .text = "its semi-axis in each rate"}},
    {0, {.path = "controller.file", .type = FIELD_TEXT, .use = USE_PROGRAM,
         .fallback_text = "none: controller.source",
         .text = "C file of the law, beside the scenario",
         .more = "One function, called at each sample; stance_law.h says what it is told and "
                 "gives. Its PARAMETERS are keys here, too: controller.NAME. It may do what any "
                 "program may: one that this user has not trusted yet is run with --trust only."}},
    {0, {.path = "controller.source", .type = FIELD_TEXT, .use = USE_PROGRAM,
         .fallback_text = "what controller.file holds", .text = "the law's text itself",
         .more = "Results files hold it."}},
    {0, {.path = "controller.data", .type = FIELD_DATA, .use = USE_PROGRAM, .fallback_text = "none",
         .text = "numbers for the law: its array data[DATA]",
         .more = "Such as a network's weights."}},
    {FAMILY_PARAMETERS, {.path = "controller.*", .type = FIELD_NUMBER, .use = USE_LAW,
         .sweep = true}},
    {0, {.path = "controller.sample_time", NUMBER(sample_time), .use = USE_CONTROL, .unit = "s",
         RANGE(0, LARGE), .text = "time between samples of the controller",
         .more = "Torques are held in between; 0: it acts continuously, inside the step "
                 "(decoupling with implicit and midpoint: once a step)."}},
    {0, {.path = "controller.delay", WHOLE(delay), .use = USE_CONTROL, .unit = "1",
         RANGE(0, STANCE_MAX_DELAY), .quiet = true, .samples = "it counts samples",
         .text = "whole samples between measuring and acting",
         .more = "1: the torques of a sample act from the next one on, until then those that "
                 "state-feedback has at its target (none with hold and decoupling). Gains do not "
                 "take it into account."}},
    {0, {.path = "controller.lag", NUMBER(lag), .use = USE_CONTROL, .unit = "s", RANGE(0, LARGE),
         .quiet = true, .samples = ACTS, .text = "time constant of the actuators",
         .more = "A torque approaches what is commanded as exp(-t/lag), from what state-feedback "
                 "has at its target. Gains do not take it into account."}},
    {0, {.path = "controller.torque_limit", NUMBER(torque_limit), .use = USE_CONTROL, .unit = "N m",
         .fallback = INFINITY, .fallback_text = "none", ABOVE(0, LARGE), WORDS(schema_none),
         .text = "largest torque of each actuator",
         .more = "Of a slide a force, in N. A positive torque turns its leg, or body, "
                 "counter-clockwise, and what it hangs from the other way: stance plot --model "
                 "SCENARIO draws it."}},
    {FAMILY_ACTUATORS, {.path = "controller.torque_limits", .type = FIELD_NUMBERS, .by_scene = true,
         .use = USE_CONTROL, .unit = "N m", .fallback_text = "none",
         .text = "largest torque of each actuator by itself",
         .more = "Of a slide in N. Each is limited by this, by torque_limit and by what the "
                 "robot's description says, whichever is smallest."}},
    {FAMILY_ACTUATORS, {.path = "controller.torque_limits[]", NUMBER(torque_limits), .unit = "N m",
         .fallback = INFINITY, .fallback_text = "none", ABOVE(0, LARGE), .quiet = true,
         WORDS(schema_none), .text = "largest torque of an actuator"}},
    {0, {.path = "controller.torque_rate", NUMBER(torque_rate), .use = USE_CONTROL, .unit = "N m/s",
         .fallback = INFINITY, .fallback_text = "none", ABOVE(0, LARGE), WORDS(schema_none),
         .quiet = true, .samples = ACTS, .text = "how fast a torque changes at most",
         .more = "Of a slide N/s. With a lag, too, torques come up no faster than this."}},
    {0, {.path = "controller.noise", NUMBER(noise), .use = USE_CONTROL, .unit = "N m",
         RANGE(0, LARGE), .samples = NEW, .text = "half-width of uniform noise on the torques",
         .more = "Of a slide in N. White, added before the limit."}},
    {0, {.path = "controller.angle_noise", NUMBER(angle_noise), .use = USE_CONTROL, .unit = "rad",
         RANGE(0, LARGE), .quiet = true, .samples = NEW,
         .text = "half-width of noise on measured angles",
         .more = "Uniform, on each angle of the posture that the controller sees (of a slide in "
                 "m). A decoupling law knows all the same which feet touch the ground."}},
    {0, {.path = "controller.rate_noise", NUMBER(rate_noise), .use = USE_CONTROL, .unit = "rad/s",
         RANGE(0, LARGE), .quiet = true, .samples = NEW,
         .text = "half-width of noise on measured rates",
         .more = "As controller.angle_noise; of a slide in m/s."}},

    {0, {.path = "method", .type = FIELD_MAP, .text = "how time is stepped"}},
    {FAMILY_METHODS, {.path = "method.name", .type = FIELD_WORD, .sweep = true, VALUE(method),
         .text = "time stepping method"}},
    {0, {.path = "method.step", NUMBER(step), .unit = "s", .fallback = 0.001, ABOVE(0, 0.1),
         .text = "time step",
         .more = "An upper bound: a sample interval is cut into equal steps no longer than this."}},
    {FAMILY_TOLERANCE, {.path = "method.tolerance", NUMBER(tolerance), .unit = "m, rad",
         .fallback = NAN, .fallback_text = "the method's own", ABOVE(0, 1),
         .text = "admitted error of a step"}},

    {0, {.path = "stop", .type = FIELD_MAP, .required = true,
         .text = "when a run ends and what it counts as"}},
    {0, {.path = "stop.time", NUMBER(stop_time), .required = true, .unit = "s", .fallback = NAN,
         ABOVE(0, LARGE), .text = "longest duration of a run"}},
    {0, {.path = "stop.settle", .type = FIELD_MAP_OR_WORD, WORDS(settle_words),
         .text = "when a run counts as stabilised or at rest",
         .more = "\"off\": a run lasts its whole time, unless the robot falls, and is judged at "
                 "its end. (In quotes: tools of YAML 1.1 take a bare off for false. Here both are "
                 "the word.)"}},
    {0, {.path = "stop.settle.angle", NUMBER(settle_angle), .use = USE_SETTLE, .unit = "rad",
         .fallback = 0.05, ABOVE(0, LARGE),
         .text = "largest deviation of an angle that counts as settled"}},
    {0, {.path = "stop.settle.rate", NUMBER(settle_rate), .use = USE_SETTLE, .unit = "rad/s",
         .fallback = 0.5, ABOVE(0, LARGE),
         .text = "largest rate that counts as settled, in m/s for the translation"}},
    {0, {.path = "stop.settle.hold", NUMBER(settle_hold), .use = USE_SETTLE, .unit = "s",
         .fallback = 0.5, RANGE(0, LARGE), .text = "how long it must stay settled"}},
    {0, {.path = "stop.settle.place", NUMBER(settle_place), .use = USE_SETTLE, .unit = "m",
         .fallback = 0.5, ABOVE(0, LARGE), WORDS(schema_none),
         .text = "how far from where it began a support may be that counts as stabilised",
         .more = "Along the ground, either way, however it came there: a robot that stands at its "
                 "target further away has hopped, slid or rolled off and is rested. none: "
                 "anywhere."}},
    {0, {.path = "stop.walks", .type = FIELD_MAP,
         .text = "when a robot counts as walking, which ends the run"}},
    {0, {.path = "stop.walks.steps", .type = FIELD_INTEGER, VALUE(walk_steps), .unit = "1",
         RANGE(0, 1000), .quiet = true,
         .text = "steps in a row that are like the one 1 to 4 before; 0: nobody walks",
         .more = "Alike in angles and rates just after the footfall, legs exchanged, in the second "
                 "half of them no less than in the first; see the answers walked_steps, step_time, "
                 "step_length, walking_speed, cost_of_transport, gait_period and gait_change."}},
    {0, {.path = "stop.walks.enough", WHOLE(walk_enough), .use = USE_WALKS, .unit = "1",
         RANGE(0, 1e9), .quiet = true,
         .text = "steps that are walking whatever they are like; 0: no number is",
         .more = "On rough ground no two are alike. gait_period and settle_time are then none."}},
    {0, {.path = "stop.walks.length", NUMBER(walk_length), .use = USE_WALKS, .unit = "m",
         .fallback = 0.05, ABOVE(0, LARGE), .quiet = true,
         .text = "shortest step: what lands nearer to the other foot is none",
         .more = "Steps go one way, along +x or along -x."}},
    {0, {.path = "stop.walks.time", NUMBER(walk_time), .use = USE_WALKS, .unit = "s",
         .fallback = 0.05, RANGE(0, LARGE), .quiet = true,
         .text = "time that a step takes at least: what lands sooner is none"}},
    {0, {.path = "stop.walks.angle", NUMBER(walk_angle), .use = USE_WALKS, .unit = "rad",
         .fallback = 0.01, ABOVE(0, LARGE), .quiet = true,
         .text = "largest difference of an angle between steps that are alike"}},
    {0, {.path = "stop.walks.rate", NUMBER(walk_rate), .use = USE_WALKS, .unit = "rad/s",
         .fallback = 0.1, ABOVE(0, LARGE), .quiet = true,
         .text = "largest difference of a rate between steps that are alike"}},
    {0, {.path = "stop.footfalls", WHOLE(footfalls), .unit = "1", RANGE(0, 1e9), .quiet = true,
         .text = "footfalls after which the run ends, just after the last; 0: it goes on",
         .more = "capturing, event-driven and lagrange end where it falls, the others at the end "
                 "of its step. A footfall is the landing of another foot than the one that landed "
                 "last. As an axis from 1 on it makes a table of footfalls: end_time is their "
                 "time, final_state the state just after."}},
    {0, {.path = "stop.fall_height", NUMBER(robot[STANCE_ROBOT_FALL_HEIGHT]), .unit = "1",
         .fallback = STANCE_FALL_HEIGHT, RANGE(0, 1),
         .text = "height of the hip, in leg lengths, below which the robot has fallen",
         .more = "Its fall_cause is then hip, and trunk where the trunk touches the ground. "
                 "implicit, midpoint and lagrange look at the ends of steps only."}},

    {0, {.path = "sweep", .type = FIELD_MAP, .text = "what varies between cases"}},
    {0, {.path = "sweep.grid", .type = FIELD_AXES,
         .text = "axes whose product are the cases, the last one fastest",
         .more = "An axis is {path, from, to, count, spacing}, {path, values: [...]} or {paths: "
                 "[...], values: [[...], ...]}; the last varies several fields together, as does "
                 "{paths: [...], from: [...], to: [...], count}, along a line."}},
    {0, {.path = "sweep.grid[].path", .type = FIELD_PATH,
         .text = "the field that varies along the axis",
         .more = "Any number of this format, such as controller.gains[0][3] or ground.friction."}},
    {0, {.path = "sweep.grid[].paths", .type = FIELD_PATHS, .high = SCENARIO_MAX_PATHS,
         .text = "fields that vary together along the axis"}},
    {0, {.path = "sweep.grid[].from", .type = FIELD_ENDS,
         .text = "value at the first point, with `paths` a list"}},
    {0, {.path = "sweep.grid[].to", .type = FIELD_ENDS,
         .text = "value at the last point, with `paths` a list"}},
    {0, {.path = "sweep.grid[].count", .type = FIELD_INTEGER, .fallback = NAN, RANGE(1, 1e9),
         .text = "number of points"}},
    {0, {.path = "sweep.grid[].spacing", .type = FIELD_WORD, WORDS(spacing_words),
         .text = "equal differences or equal ratios between points"}},
    {0, {.path = "sweep.grid[].values", .type = FIELD_VALUES,
         .text = "the points one by one: numbers or words, with `paths` a list for each point"}},
    {0, {.path = "sweep.sample", .type = FIELD_MAP,
         .text = "a designed sample of several fields, at each point of the grid",
         .more = "A further dimension, sample, after the grid's. Points follow from seed and their "
                 "number alone, whatever count is (but for lhs): stance run --extend adds some."}},
    {0, {.path = "sweep.sample.method", .type = FIELD_WORD, .required = true, .fallback = NAN,
         .words = doe_words, .word_count = DOE_METHODS, .text = "how points are chosen",
         .more = "random: independent. lhs: Latin hypercube, each of count strata of each factor "
                 "holds one point. sobol: Sobol' sequence, shifted digitally; best with a power of "
                 "two. saltelli: blocks of factors + 2 points for Sobol' indices. morris: "
                 "trajectories of factors + 1 points for elementary effects. sphere: directions, "
                 "uniform on the ellipsoid inscribed in the box of the ranges."}},
    {0, {.path = "sweep.sample.count", .type = FIELD_INTEGER, .required = true, .fallback = NAN,
         RANGE(1, 1 << DOE_MAX_BITS),
         .text = "number of points; of blocks with saltelli, of trajectories with morris"}},
    {0, {.path = "sweep.sample.second_order", .type = FIELD_WORD, .use = USE_SALTELLI,
         WORDS(truth_words),
         .text = "whether saltelli's blocks have what second-order indices need",
         .more = "2 factors + 2 points in each."}},
    {0, {.path = "sweep.sample.levels", .type = FIELD_INTEGER, .fallback = 4, .use = USE_MORRIS,
         RANGE(2, 1000), .text = "levels of each factor, an even number",
         .more = "A step of a trajectory is levels / (2 (levels - 1)) of the range."}},
    {0, {.path = "sweep.sample.vary", .type = FIELD_FACTORS, .required = true,
         .text = "the factors: what varies, and within which bounds",
         .more = "A factor is {path, from, to, spacing}, {path, values: [...]}, or of several "
                 "fields that move together {paths: [...], from: [...], to: [...]} or {paths: "
                 "[...], values: [[...], ...]}."}},
    {0, {.path = "sweep.sample.vary[].path", .type = FIELD_PATH,
         .text = "the field that the factor varies", .more = "Whatever may be swept."}},
    {0, {.path = "sweep.sample.vary[].paths", .type = FIELD_PATHS, .high = SCENARIO_MAX_PATHS,
         .text = "fields that the factor varies together"}},
    {0, {.path = "sweep.sample.vary[].from", .type = FIELD_ENDS,
         .text = "lower bound; with paths a list, one end of the segment",
         .more = "Whole numbers between the bounds are equally likely, both included."}},
    {0, {.path = "sweep.sample.vary[].to", .type = FIELD_ENDS,
         .text = "upper bound; with paths a list, the other end"}},
    {0, {.path = "sweep.sample.vary[].spacing", .type = FIELD_WORD, WORDS(spacing_words),
         .text = "uniform in the value or in its logarithm"}},
    {0, {.path = "sweep.sample.vary[].values", .type = FIELD_VALUES,
         .text = "equally likely values: numbers or words, with paths a list for each"}},
    {0, {.path = "sweep.refine", .type = FIELD_MAP, .use = USE_UNSOUGHT,
         .text = "map the outcomes adaptively: simulate a coarse lattice, then only where they "
                 "differ",
         .more = "Along axes of numbers with more than start points; others are taken in full, "
                 "each combination a map of its own. Cases that are not simulated take the outcome "
                 "of their cell, with evidence inferred and no other answers. The same for any "
                 "number of ranks."}},
    {0, {.path = "sweep.refine.along", .type = FIELD_TEXT, .fallback_text = "all axes of numbers",
         .text = "path of the one axis that is refined",
         .more = "Each combination of the others' values is then bisected by itself, as stance "
                 "critical has it."}},
    {0, {.path = "sweep.refine.start", .type = FIELD_INTEGER, .fallback = 32, RANGE(2, 1e9),
         .text = "most cells of the coarse lattice along an axis",
         .more = "Its stride is the smallest power of two that leaves no more; each level halves "
                 "it."}},
    {0, {.path = "sweep.refine.margin", .type = FIELD_INTEGER, .fallback = 1, RANGE(0, 1e9),
         .text = "cells around one of several outcomes that are refined with it"}},
    {0, {.path = "sweep.refine.probes", .type = FIELD_NUMBER, .unit = "1", .fallback = 0.01,
         RANGE(0, 1), .text = "share of all cases that is simulated in search of islands",
         .more = "Chosen by seed. An island of k cases between the points of the lattice stays "
                 "unseen with probability (1 - probes)^k."}},

    {0, {.path = "optimise", .type = FIELD_MAP,
         .text = "what stance optimise varies in search of a better controller",
         .more = "The scenario as it is is the first candidate; the points of sweep.sample are the "
                 "starts that all candidates get, those of sweep.grid the circumstances. Other "
                 "commands pass over this section."}},
    {0, {.path = "optimise.vary", .type = FIELD_VARIED, .required = true, WORDS(vary_words),
         .text = "what differs between candidates",
         .more = "gains: all gains of state-feedback, those of the scenario's design to begin "
                 "with; of coordinates that follow from the others while the contacts hold they "
                 "stay 0. poles: all poles, real ones. weights: all weights of lqr. law: the "
                 "parameters of controller.kind. A mapping is {path, from, to, spacing} or {path, "
                 "unit}: any number that may be swept and need not be whole."}},
    {0, {.path = "optimise.vary[].path", .type = FIELD_PATH,
         .text = "the number that differs between candidates"}},
    {0, {.path = "optimise.vary[].from", .type = FIELD_NUMBER, .fallback = NAN,
         RANGE(-LARGE, LARGE), .text = "its lower bound"}},
    {0, {.path = "optimise.vary[].to", .type = FIELD_NUMBER, .fallback = NAN, RANGE(-LARGE, LARGE),
         .text = "its upper bound"}},
    {0, {.path = "optimise.vary[].spacing", .type = FIELD_WORD, WORDS(spacing_words),
         .text = "whether it is moved evenly or by equal ratios"}},
    {0, {.path = "optimise.vary[].unit", .type = FIELD_NUMBER, .fallback = NAN, RANGE(1e-12, LARGE),
         .text = "what first_step is a part of",
         .more = "By default the range; with spacing log of the logarithm."}},
    {0, {.path = "optimise.maximise", .type = FIELD_WORD, WORDS(aim_words),
         .text = "what makes a candidate better",
         .more = "share: of the starts, those that end as stabilised. nearest: the largest scale "
                 "up to which all directions (method sphere, with initial.offset.scale in the "
                 "grid) are stabilised. An answer: its mean over all starts, 0 for those that are "
                 "not stabilised; a start counts at most 50000 either way."}},
    {0, {.path = "optimise.weight", .type = FIELD_WORD, WORDS(weight_words), .use = USE_SHARES,
         .text = "what a start counts",
         .more = "even: all the same. normal: as a normal density about the middle of the ranges "
                 "whose standard deviation is a quarter of each range."}},
    {0, {.path = "optimise.price", .type = FIELD_MAP, .use = USE_SHARES,
         .text = "what a stabilised start costs, taken from what it is worth (1 with share)"}},
    {0, {.path = "optimise.price.peak_torque", .type = FIELD_NUMBER, .unit = "1/(N m)",
         RANGE(0, LARGE), .text = "price of the largest torque"}},
    {0, {.path = "optimise.price.friction_used", .type = FIELD_NUMBER, .unit = "1", RANGE(0, LARGE),
         .text = "price of the friction used"}},
    {0, {.path = "optimise.price.settle_time", .type = FIELD_NUMBER, .unit = "1/s", RANGE(0, LARGE),
         .text = "price of the time to settle"}},
    {0, {.path = "optimise.price.cost_of_transport", .type = FIELD_NUMBER, .unit = "1",
         RANGE(0, LARGE), .text = "price of the cost of transport of one that walks"}},
    {0, {.path = "optimise.price.gain", .type = FIELD_NUMBER, .unit = "1", RANGE(0, LARGE),
         .text = "price of the gains' root mean square, in their units",
         .more = "The unit of a gain is the torque limit over the half-width of the starts."}},
    {0, {.path = "optimise.over", .type = FIELD_WORD, WORDS(over_words), .use = USE_SHARES,
         .text = "which of the circumstances of sweep.grid counts, or all alike"}},
    {0, {.path = "optimise.require", .type = FIELD_MAP,
         .text = "what a candidate must have to be simulated",
         .more = "In every circumstance. A loop that is unstable as it is sampled, late and with "
                 "the lag of its actuators never counts as recovered."}},
    {0, {.path = "optimise.require.critical_sample_time", .type = FIELD_NUMBER, .unit = "s",
         .fallback = NAN, .fallback_text = "twice controller.sample_time", RANGE(0, LARGE),
         .text = "least critical sample time of its loop without delay",
         .more = "Only of laws that linear theory knows; 0: none."}},
    {0, {.path = "optimise.candidates", .type = FIELD_INTEGER, .fallback = 1000, RANGE(1, 1e6),
         .text = "candidates, over all generations",
         .more = "Whole generations; with restarts each beginning has so many."}},
    {0, {.path = "optimise.grow", .type = FIELD_NUMBERS, .unit = "1",
         .fallback_text = "a quarter of sweep.sample.count, that, four times that",
         .text = "starts of the stages of the search",
         .more = "Of three stages they have 50, 35 and 15 % of the candidates, of others equal "
                 "parts. A stage has the starts of those before it."}},
    {0, {.path = "optimise.grow[]", .type = FIELD_INTEGER, .unit = "1", .fallback = NAN,
         RANGE(1, 1 << 20), .text = "starts of a stage"}},
    {0, {.path = "optimise.confirm", .type = FIELD_INTEGER, .unit = "1", .fallback = NAN,
         .fallback_text = "eight times the last stage's", RANGE(1, 1 << 20),
         .text = "starts by which the best candidates are compared, and as many fresh ones from "
                 "which they are reported"}},
    {0, {.path = "optimise.restarts", .type = FIELD_INTEGER, RANGE(0, SCENARIO_MAX_RESTARTS),
         .text = "times that the search begins again at its best with twice the candidates a "
                 "generation"}},
    {0, {.path = "optimise.first_step", .type = FIELD_NUMBER, .unit = "1", .fallback = 0.1,
         ABOVE(0, 10),
         .text = "standard deviation of the first generation, in units of each number"}},

    {0, {.path = "record", .type = FIELD_MAP, .text = "what is stored besides the parameters"}},
    {0, {.path = "record.every", .type = FIELD_NUMBER, .unit = "s", .fallback = 0.01,
         .use = USE_UNSOUGHT, ABOVE(0, LARGE), .text = "time between rows of a trajectory"}},
    {0, {.path = "record.cases", .type = FIELD_CASES, WORDS(record_words), .use = USE_UNSOUGHT,
         .text = "cases whose trajectories are stored",
         .more = "A list counts them from 0, the last axis fastest."}},
    {0, {.path = "record.answers", .type = FIELD_WORDS, WORDS(answer_words), .fallback_text = "all",
         .text = "answers that are stored"}},

    {0, {.path = "seed", .type = FIELD_INTEGER, .fallback = 1, RANGE(0, 0x1p63),
         .text = "seed of the random numbers, up to 9223372036854775807"}},
};
/* clang-format on */
const size_t schema_row_count = sizeof schema_rows / sizeof *schema_rows;
