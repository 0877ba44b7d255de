/* test_yaml.c - what YAML means: texts that are the same scenario; letters that cannot be seen. */
#include "reading.h"

#define HEAD "stance: 1\nscene: ball\ninitial: {state: {z: 1}}\nstop: {time: 1}\n"

static void are_the_same(const char *text, const char *plain)
{
    SCENARIO s = {0}, of = {0};
    read_good(&s, text, NULL, 0);
    read_good(&of, plain, NULL, 0);
    assert_string_equal(s.text, of.text);
}

static void refused(const char *text, const char *set, const char *said)
{
    SCENARIO s = {0};
    assert_false(read_as(&s, "bad.yaml", text, &set, set ? 1 : 0));
    assert_string_equal(errors, said);
}

/* As YAML's merge keys are defined: own keys first, then the mappings in their order. */
TEST(merge_keys_are_read)
{
    are_the_same(HEAD "x-a: &a {restitution: 0.3, friction: 0.4}\n"
                      "ground: {<<: *a, friction: 0.9}\n",
                 HEAD "ground: {friction: 0.9, restitution: 0.3}\n");
    are_the_same(HEAD "x-a: &a {restitution: 0.3, friction: 0.4}\n"
                      "ground:\n  friction: 0.9\n  <<: *a\n",
                 HEAD "ground: {friction: 0.9, restitution: 0.3}\n");
    are_the_same(HEAD "x-a: [&a {friction: 0.4}, &b {friction: 0.5, restitution: 0.6}]\n"
                      "ground: {<<: [*a, *b]}\n",
                 HEAD "ground: {friction: 0.4, restitution: 0.6}\n");
    are_the_same(HEAD "x-a: &a {<<: {restitution: 1}, friction: 0.4}\nground: {<<: *a}\n",
                 HEAD "ground: {friction: 0.4, restitution: 1}\n");
    refused(HEAD "ground: {<<: [1]}\n", NULL,
            "bad.yaml:5:14: << takes a mapping, or a list of mappings, such as *NAME\n");
    refused(HEAD "x-a: &a {fricton: 1}\nground: {<<: *a}\n", NULL,
            "bad.yaml:5:10: ground: unknown key 'fricton'; did you mean 'friction'? (known: "
            "friction, restitution, slope, gravity, law, lands, prefer, plates, contacts)\n");
    refused(HEAD "ground: {<<: {friction: 1}, <<: {friction: 2}}\n", NULL,
            "bad.yaml:5:29: duplicate key '<<'; write <<: [*A, *B]\n");
    refused(HEAD, "x-a=1",
            "--set x-a=1: unknown key 'x-a' (known: stance, title, scene, robot, ground, initial, "
            "controller, method, stop, sweep, record, seed)\n");
}

/* YAML 1.2, of which libyaml reads 1.1: a colon before a bracket ends a key. Places are those of
 * the file. */
TEST(colons_before_brackets_end_keys)
{
    are_the_same(HEAD "sweep: {grid:[{path: ground.friction, values:[0, 1]}]}\n",
                 HEAD "sweep: {grid: [{path: ground.friction, values: [0, 1]}]}\n");
    refused(HEAD "robot: {mass:, radius:{a:}, size: 1}\n", NULL,
            "bad.yaml:5:14: robot.mass: expected a number, found nothing\n"
            "bad.yaml:5:23: robot.radius: expected a number, found a mapping\n"
            "bad.yaml:5:29: robot: unknown key 'size' (known: mass, radius, points)\n");
    char text[2000] = HEAD "ground: [";
    for (int i = 0; i < 65; i++) /* more than are mended */
        strcat(text, "{a:}, ");
    strcat(text, "]\n");
    refused(text, NULL,
            "bad.yaml:5:396: not YAML: found unexpected ':', while scanning a plain scalar (line "
            "5)\n");
}

/* Every letter that cannot be seen is named where it does harm, and nowhere else. */
TEST(hidden_letters_are_named)
{
    static const struct {
        const char *letter, *name;
        bool blank;
    } hidden[] = {
        {"\u00a0", "U+00A0 (no-break space)", true},
        {"\u00ad", "U+00AD (soft hyphen)", false},
        {"\u2003", "U+2003 (quad or em space)", true},
        {"\u2009", "U+2009 (thin space)", true},
        {"\u200b", "U+200B (zero width space)", false},
        {"\u200e", "U+200E (direction mark)", false},
        {"\u202a", "U+202A (direction mark)", false},
        {"\u202f", "U+202F (narrow no-break space)", true},
        {"\u2060", "U+2060 (word joiner)", false},
        {"\u2067", "U+2067 (direction mark)", false},
        {"\u3000", "U+3000 (ideographic space)", true},
        {"\ufe0f", "U+FE0F (variation selector)", false},
        {"\U000e0041", "U+E0041 (tag or variation selector)", false},
    };
    char text[500], said[500], set[64];
    for (size_t i = 0; i < COUNT(hidden); i++) {
        const char *const letter = hidden[i].letter, *const name = hidden[i].name,
                          *const it = hidden[i].blank ? "is no blank" : "cannot be seen";
        snprintf(text, sizeof text, HEAD "robot: {mass: 1%s}\n", letter);
        snprintf(said, sizeof said,
                 "bad.yaml:5:16: %s stands in column 16: it %s; write robot: {mass: 1}\n", name,
                 it);
        refused(text, NULL, said);
        snprintf(text, sizeof text, HEAD "%srobot: {mass: 1}\n", letter);
        snprintf(said, sizeof said,
                 "bad.yaml:5:1: %s stands in column 1: it %s; write robot: {mass: 1}\n", name, it);
        refused(text, NULL, said);
        snprintf(set, sizeof set, "robot.mass=1%s", letter);
        snprintf(said, sizeof said,
                 "--set robot.mass=1<%.*s>: %s is letter 13: it %s; write robot.mass=1\n",
                 (int)strcspn(name, " "), name, name, it);
        refused(HEAD, set, said);
        snprintf(text, sizeof text, HEAD "title: A%sball # 'no%squote\nseed: 1 # \"%s\n", letter,
                 letter, letter);
        are_the_same(text, text);
        snprintf(text, sizeof text, HEAD "title: A%sball # 'no%squote\nseed: x\n", letter, letter);
        refused(text, NULL, "bad.yaml:6:7: seed: expected a whole number, found 'x'\n");
    }
    refused(HEAD "seed: 1\ufeff\n", NULL,
            "bad.yaml:5:8: U+FEFF (byte order mark) stands here and cannot be seen; remove it\n");
    refused(HEAD "title: \"it's\u00a0\"\nseed: '\u00a0'\n", NULL,
            "bad.yaml:6:7: seed: expected a whole number, found the text \"<U+00A0>\"\n");
}

#define ROBOT                                                                                      \
    "stance: 1\nscene: biped\ninitial: {equilibrium: {theta: -0.41, q2: 0.82}}\n"                  \
    "stop: {time: 1}\ncontroller: {kind: state-feedback, design: "

/* Weights, poles and gains by name are the lists that they stand for. */
TEST(names_stand_for_lists)
{
    SCENARIO s = {0}, of = {0};
    double re[SCENARIO_MAX_POLES], im[SCENARIO_MAX_POLES];
    are_the_same(ROBOT "lqr, weights: {vq1: 5, theta: 100}}\n",
                 ROBOT "lqr, weights: {states: [100, 1, 1, 1, 5, 1]}}\n");
    are_the_same(ROBOT "lqr, weights: {states: {q1: 2}, torques: {hip2: 3}}}\n",
                 ROBOT "lqr, weights: {states: [1, 2, 1, 1, 1, 1], torques: [1, 3]}}\n");
    are_the_same(ROBOT "gains, gains: {hip2: {q1: 7, vq2: -8}}}\n",
                 ROBOT "gains, gains: [[0, 0, 0, 0, 0, 0], [0, 7, 0, 0, 0, -8]]}\n");
    are_the_same(ROBOT "gains, gains: [{q1: 1}, [1, 2, 3, 4, 5, 6]]}\n",
                 ROBOT "gains, gains: [[0, 1, 0, 0, 0, 0], [1, 2, 3, 4, 5, 6]]}\n");
    refused(ROBOT "lqr, weights: {theta: 1, states: [1, 1, 1, 1, 1, 1]}}\n", NULL,
            "bad.yaml:5:59: controller.weights: weights of states stand in a list and by name; "
            "give one of them\n");
    refused(ROBOT "gains, gains: {hip3: {q1: 1}, hip1: {q3: 1}}}\n", NULL,
            "bad.yaml:5:59: controller.gains: unknown key 'hip3'; did you mean 'hip1'? (known: "
            "hip1, hip2)\n"
            "bad.yaml:5:81: controller.gains.hip1: unknown key 'q3'; did you mean 'q1'? (known: "
            "theta, q1, q2, vtheta, vq1, vq2)\n");
    read_good(&s,
              ROBOT "place, poles: {vq2: -6, theta: -1, q1: -2+1i, q2: -2-1i, vtheta: -4, "
                    "vq1: -5}}\n",
              NULL, 0);
    assert_int_equal(scenario_poles(&s.base, re, im), 6);
    for (int i = 0; i < 6; i++) {
        static const double wanted[2][6] = {{-1, -2, -2, -4, -5, -6}, {0, 1, -1}};
        assert_near(re[i], wanted[0][i], 0);
        assert_near(im[i], wanted[1][i], 0);
    }
    refused(ROBOT "place, poles: {theta: -1, q1: -2+1i, q2: -3}}\n", NULL,
            "bad.yaml:5:74: controller.poles.q1: -2+1i lacks its conjugate\n");
    static const char *const sets[][2] = {
        {"controller={kind: state-feedback, design: lqr, weights: {torques: [1, 9]}}",
         "controller.weights.torques.hip2=9"},
        {"controller={kind: state-feedback, design: lqr, weights: {states: [1, 1, 1, 4, 1, 1]}}",
         "controller.weights.vtheta=4"},
    };
    for (size_t i = 0; i < 2; i++) { /* without a list, and with one */
        read_good(&s, ROBOT "lqr}\n", &sets[i][1], 1);
        read_good(&of, ROBOT "lqr}\n", &sets[i][0], 1);
        assert_string_equal(s.text, of.text);
        read_good(&s, of.text, &sets[i][1], 1);
        assert_string_equal(s.text, of.text);
    }
    refused(ROBOT "lqr}\nsweep: {grid: [{path: controller.weights.q2, values: [1, 2]}, {path: "
                  "'controller.weights.states[2]', values: [3]}]}\n",
            NULL,
            "bad.yaml:6:70: sweep.grid[1]: controller.weights.states[2] is swept twice (first in "
            "sweep.grid[0])\n");
}

/* A robot of another kind than the scene is told in one line, not in one for each of its keys. */
TEST(robots_of_other_scenes)
{
    refused("stance: 1\nscene: biped\nrobot: {bodies: {a: {joint: free, mass: 1}}, contacts: {f: "
            "{body: a}}}\ninitial: {equilibrium: {a: 0}, support: [f]}\nstop: {time: 1}\n",
            NULL,
            "bad.yaml:2:8: scene: robot.bodies is given, which biped has not; write scene: "
            "mechanism\n");
    refused("stance: 1\nscene: mechanism\nrobot: {leg_length: 1, hip_mass: 2}\n"
            "initial: {equilibrium: {theta: 0}}\nstop: {time: 1}\n",
            NULL,
            "bad.yaml:2:8: scene: robot.leg_length is a number of the scene biped, a mechanism "
            "has bodies; write scene: biped\n");
}
