/* test_scenario.c - scenario files: what is read, what is refused and how, what is written back.
 *
 * Every file of tests/bad begins with "# LINE:COLUMN: MESSAGE", the one line that it must lead to.
 */
#include "long.h"
#include "reading.h"

#include "runner/scenario/schema.h"
#include "runner/store/store.h"

#include <dirent.h>

static void refused(const char *text, const char *const *sets, size_t set_count, const char *wanted)
{
    SCENARIO s = {0}, empty = {0};
    assert_false(read_as(&s, "bad.yaml", text, sets, set_count));
    assert_string_equal(errors, wanted);
    assert_memory_equal(&s, &empty, sizeof s);
}

/* The first of them are read, damaged and read back. */
static char texts[10][BASE_SIZE];
static const char *const full = texts[0], *const holds = texts[1], *const gives_gains = texts[2],
                         *const places = texts[3], *const regulates = texts[4],
                         *const bounces = texts[5], *const decouples = texts[6],
                         *const follows = texts[7], *const switches = texts[8],
                         *const bends = texts[9];
enum { GOOD_TEXTS = 6 };

static int read_texts(void **state __attribute__((unused)))
{
    return read_bases("tests/scenario_texts.txt", texts);
}
static CMFixtureFunction before_tests = read_texts;

static const uint64_t one = 1;

/* ---- good scenarios ------------------------------------------------------------------------- */

static void check_numbers(const double *found, const double *wanted, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (isnan(wanted[i]))
            assert_true(isnan(found[i]));
        else
            assert_near(found[i], wanted[i], 0);
}

TEST(every_key_is_read)
{
    static const double robot[] = {0.5, 0.6, 1.5, 2, 5}, model[] = {0.51, NAN, NAN, NAN, 5.5};
    static const double offset[] = {1, 2, 0.1, 0.2, 0.3, 3, 4, 5, 6, 0.7};
    static const double re[] = {-3, -3.3, -4, -5, -4, -4.6}, im[] = {0, 0, 1.5, 0, -1.5, 0};
    static const double start[] = {-0.41, 0.5, NAN}, target[] = {-0.4, NAN, 0.8};
    SCENARIO s = {0};
    read_good(&s, full, NULL, 0);
    const struct scenario_values *v = &s.base;

    assert_string_equal(s.file, "good.yaml");
    assert_string_equal(s.name, "good");
    assert_string_equal(s.title, "Every key: \"one\" of them");
    assert_ptr_equal(s.scene, stance_scene_find("biped"));
    assert_true(s.seed == (uint64_t)INT64_MAX);
    check_numbers(v->robot, robot, 5);
    check_numbers(v->model, model, 5);
    check_numbers(&v->friction, (double[]){0.7}, 1);
    check_numbers(&v->restitution, (double[]){0.25}, 1);
    assert_int_equal(v->contacts, 2);
    assert_true(v->equilibrium.given && v->design_point.given && !v->state_given);
    check_numbers(v->equilibrium.posture, start, 3);
    check_numbers(v->design_point.posture, target, 3);
    assert_int_equal(v->equilibrium.branch, 1);
    assert_int_equal(v->design_point.branch, 0);
    assert_int_equal(v->support_foot, 2);
    check_numbers(v->offset, offset, 10);
    assert_string_equal(scenario_law(&s.base)->name, "state-feedback");
    assert_int_equal(v->design, DESIGN_PLACE);
    check_numbers(v->pole_re, re, 6);
    check_numbers(v->pole_im, im, 6);
    check_numbers((double[]){v->sample_time, v->torque_limit, v->noise}, (double[]){0.002, 10, 0.1},
                  3);
    assert_string_equal(stance_methods()[v->method]->name, "midpoint");
    check_numbers(
        (double[]){v->step, v->tolerance, v->stop_time, v->robot[STANCE_ROBOT_FALL_HEIGHT]},
        (double[]){5e-4, 1e-7, 8.5, 0.3}, 4);
    assert_int_equal(v->settle, 1);
    check_numbers((double[]){v->settle_angle, v->settle_rate, v->settle_hold},
                  (double[]){0.04, 0.4, 0.6}, 3);
    check_numbers(&s.record_every, (double[]){0.02}, 1);
    assert_int_equal(s.record_cases, RECORD_LIST);
    assert_int_equal(s.record_count, 2);
    assert_true(s.record_list[0] == 3 && s.record_list[1] == 5);
    assert_int_equal(s.answers, one << STANCE_ANSWER_outcome | one << STANCE_ANSWER_steps |
                                    one << SCENARIO_FINAL_STATE);
    int line = 0, column = 0;
    assert_true(scenario_place(&s, "initial: a message", &line, &column));
    assert_int_equal(line, 6);
    assert_int_equal(column, 1);
    assert_true(scenario_place(&s, "controller.unknown: a message", &line, &column));
    assert_int_equal(line, 10);
}

TEST(defaults_hold)
{
    SCENARIO s = {0};
    read_good(&s,
              "stance: 1\nscene: biped\ninitial: {equilibrium: {q1: 0.5, q2: 1}}\n"
              "stop: {time: 2}\n",
              NULL, 0);
    const struct scenario_values *v = &s.base;
    for (int i = 0; i < s.scene->robot_count; i++) {
        assert_near(v->robot[i], s.scene->robot[i].fallback, 0);
        assert_true(isnan(v->model[i]));
    }
    check_numbers((double[]){v->friction, v->restitution, v->step, v->sample_time, v->noise,
                             v->settle_angle, v->settle_rate, v->settle_hold, v->settle_place,
                             v->robot[STANCE_ROBOT_FALL_HEIGHT]},
                  (double[]){0.8, 0, 0.001, 0, 0, 0.05, 0.5, 0.5, 0.5, 0.2}, 10);
    assert_true(isinf(v->torque_limit));
    assert_true(isnan(v->tolerance)); /* the method's own */
    assert_int_equal(v->contacts, 3);
    assert_int_equal(v->support_foot, 1);
    assert_string_equal(scenario_law(&s.base)->name, "none");
    assert_int_equal(v->settle, 1);
    assert_string_equal(stance_methods()[v->method]->name, "capturing");
    assert_true(isnan(v->equilibrium.posture[0]));
    assert_false(v->design_point.given);
    assert_true(s.seed == 1 && s.cases == 1 && s.axes == 0);
    assert_string_equal(s.title, "good");
    assert_int_equal(s.record_cases, RECORD_NONE);
    check_numbers(&s.record_every, (double[]){0}, 1);
    assert_true(s.answers == UINT64_MAX);

    read_good(&s, holds, NULL, 0);
    assert_string_equal(scenario_law(&s.base)->name, "hold");
    assert_int_equal(s.base.settle, 0);
    assert_int_equal(s.base.support_foot, 0);
    assert_true(s.base.state_given && !s.base.equilibrium.given);
    check_numbers(s.base.state, (double[]){0, 1.5, -0.5, 0.9, -1, 2, 0, 0, 0, 0}, 10);
    check_numbers(scenario_law_value(&s.base, "hold", "target"), (double[]){NAN, -0.9}, 2);
    check_numbers((double[]){*scenario_law_value(&s.base, "hold", "kp"),
                             *scenario_law_value(&s.base, "hold", "kd"), s.record_every},
                  (double[]){500, 50, 0.01}, 3);
    assert_int_equal(s.record_cases, RECORD_ALL);

    read_good(&s, gives_gains, (const char *[]){"controller.torque_limit=none"}, 1);
    assert_int_equal(s.base.design, DESIGN_GAINS);
    check_numbers(s.base.gains, (double[]){1, 2, 3, 4, 5, 6, -1, -2, -3, -4, -5, -6}, 12);
    assert_true(isinf(s.base.torque_limit));

    read_good(&s, regulates, NULL, 0);
    assert_int_equal(s.base.design, DESIGN_LQR);
    assert_int_equal(s.base.design_time, DESIGN_SAMPLED);
    assert_int_equal(s.base.delay, 1);
    check_numbers(s.base.state_weights, (double[]){1, 2, 0, 4, 5, 6}, 6);
    check_numbers(s.base.torque_weights, (double[]){0.1, 0.2}, 2);

    read_good(&s, regulates, (const char *[]){"controller.weights={torques: [3, 4]}"}, 1);
    check_numbers(s.base.state_weights, (double[]){1, 1, 1, 1, 1, 1}, 6);
    check_numbers(s.base.torque_weights, (double[]){3, 4}, 2);
    read_good(&s, places, NULL, 0);
    assert_int_equal(s.base.design_time, DESIGN_CONTINUOUS);
    assert_int_equal(s.base.delay, 0);
}

TEST(axes_make_cases)
{
    SCENARIO s = {0};
    struct scenario_values v;
    char text[64];
    uint64_t index = 0;
    read_good(&s, full, NULL, 0);
    assert_int_equal(s.axes, 5);
    assert_int_equal(s.cases, 4 * 3 * 2 * 3);
    assert_string_equal(s.axis[0].name, "ground.friction");
    assert_string_equal(s.axis[0].unit, "1");
    assert_string_equal(s.axis[0].text, "Coulomb coefficient of friction");
    assert_string_equal(s.axis[3].name, "initial.offset.theta");
    assert_string_equal(s.axis[3].path[1], "controller.poles[1]");
    assert_string_equal(s.axis[3].unit, "rad");
    assert_string_equal(s.axis[4].unit, "s");
    assert_false(s.axis[0].design || s.axis[2].design || s.axis[4].design);
    assert_true(s.axis[1].design && s.axis[3].design);
    assert_true(s.axis[2].words && s.axis[2].enumeration[0] && !s.axis[3].words);
    assert_int_equal(s.axis[1].line, 24);
    assert_int_equal(s.axis[1].column, 7);
    for (int f = 0; f < 4; f++) {
        for (int m = 0; m < 3; m++) {
            for (int method = 0; method < 2; method++) {
                for (int t = 0; t < 3; t++, index++) {
                    scenario_case_values(&s, index, &v);
                    assert_near(v.friction, 0.1 + 0.2 * f, 1e-15);
                    assert_near(v.robot[4], pow(10, m), 1e-13);
                    assert_string_equal(stance_methods()[v.method]->name,
                                        method ? "implicit" : "midpoint");
                    assert_near(v.offset[2], (t + 1) / 10.0, 0);
                    assert_near(v.pole_re[1], -3 - t, 0);
                    assert_near(v.stop_time, 3, 0);
                    assert_near(v.offset[3], 0.2, 0); /* as the base has it */
                }
            }
        }
    }
    /* Ends are exact. */
    assert_near(scenario_axis_value(&s.axis[0], 3, 0), 0.7, 0);
    assert_near(scenario_axis_value(&s.axis[1], 0, 0), 1, 0);
    assert_near(scenario_axis_value(&s.axis[1], 2, 0), 100, 0);
    scenario_axis_text(&s.axis[2], 1, 0, text, sizeof text);
    assert_string_equal(text, "implicit");
    scenario_axis_text(&s.axis[3], 2, 1, text, sizeof text);
    assert_string_equal(text, "-5");

    /* Words and numbers together; a billion points take no memory. */
    read_good(&s,
              "stance: 1\nscene: biped\ninitial: {state: {z: 1}}\nstop: {time: 1}\nsweep:\n"
              "  grid:\n"
              "  - paths: [method.step, method.name]\n"
              "    values: [[1e-3, implicit], [2e-3, midpoint]]\n"
              "  - {path: initial.state.vx, from: -1, to: 1, count: 1000000000}\n",
              NULL, 0);
    assert_int_equal(s.cases, 2000000000);
    assert_true(s.axis[0].words && !s.axis[0].enumeration[0] && s.axis[0].enumeration[1]);
    assert_string_equal(s.axis[0].word[2], "2e-3");
    scenario_case_values(&s, 1999999999, &v);
    assert_true(v.step == 2e-3 && v.state[5] == 1);
    assert_string_equal(stance_methods()[v.method]->name, "midpoint");
}

/* Scenes without controller: their own keys and defaults, and no designs. */
TEST(other_scenes_are_read)
{
    static const struct {
        const char *text;
        const char *scene;
        double robot[4], start[3];
    } plain[] = {
        {"stance: 1\nscene: ball\ninitial: {state: {}}\nstop: {time: 1}\n",
         "ball",
         {1, 0.1},
         {0, 1}},
        {"stance: 1\nscene: block\nrobot: {slope: -0.5}\ninitial: {state: {x: 2}}\n"
         "stop: {time: 1}\n",
         "block",
         {1, 0, 1},
         {2, 0}},
        {"stance: 1\nscene: rod\ninitial: {state: {theta: 1}}\ncontroller: {kind: none}\n"
         "stop: {time: 1}\n",
         "rod",
         {1, 1, 1. / 12},
         {0, 1, 1}},
    };
    SCENARIO s = {0};
    struct scenario_values v;
    read_good(&s, bounces, NULL, 0);
    assert_ptr_equal(s.scene, stance_scene_find("ball"));
    assert_int_equal(s.base.contacts, 1);
    assert_int_equal(s.base.support_foot, 0);
    check_numbers(s.base.state, (double[]){0, 1, 1, 0}, 4);
    check_numbers(s.base.robot, (double[]){1, 0}, 2);
    assert_string_equal(s.axis[0].unit, "m, rad");
    assert_false(s.axis[0].design || s.axis[1].design);
    scenario_case_values(&s, 9, &v);
    assert_true(v.tolerance == 1e-5 && v.robot[0] == 2);
    assert_int_equal(s.answers, one << STANCE_ANSWER_events | one << STANCE_ANSWER_energy_gain |
                                    one << STANCE_ANSWER_dissipation_residual);
    for (size_t i = 0; i < COUNT(plain); i++) {
        read_good(&s, plain[i].text, NULL, 0);
        assert_string_equal(s.scene->name, plain[i].scene);
        assert_true(s.base.state_given && s.base.law == 0);
        check_numbers(s.base.robot, plain[i].robot, (size_t)s.scene->robot_count);
        check_numbers(s.base.state, plain[i].start, (size_t)s.scene->coordinates);
    }
}

/* What only a sweep gives counts as given. */
TEST(swept_fields_count_as_given)
{
    SCENARIO s = {0};
    static const char *const design[] = {
        "controller.poles=[-1, -2, -3, -4, -5, -6]",
        "sweep.grid=[{path: controller.design, values: [gains, place]}]"};
    read_good(&s,
              "stance: 1\nscene: biped\ninitial: {equilibrium: {theta: 0.1}}\n"
              "controller: {kind: hold, kd: 1}\nsweep:\n  grid:\n"
              "  - {path: initial.equilibrium.q2, from: 0, to: 1, count: 2}\n"
              "  - {path: controller.kp, from: 0, to: 1, count: 2}\n"
              "  - {path: stop.time, from: 1, to: 2, count: 2}\n",
              NULL, 0);
    assert_true(s.base.equilibrium.given);
    read_good(&s, gives_gains, design, 2);
    assert_true(s.axis[0].design);
}

/* ---- round trip ----------------------------------------------------------------------------- */

static void same_scenario(const struct scenario *a, const struct scenario *b)
{
    assert_memory_equal(&a->base, &b->base, sizeof a->base);
    assert_string_equal(a->title, b->title);
    assert_ptr_equal(a->scene, b->scene);
    assert_true(a->seed == b->seed && a->cases == b->cases && a->axes == b->axes);
    assert_true(a->record_every == b->record_every && a->record_cases == b->record_cases &&
                a->record_count == b->record_count && a->answers == b->answers);
    if (a->record_count) {
        assert_memory_equal(a->record_list, b->record_list,
                            a->record_count * sizeof *a->record_list);
    }
    for (int i = 0; i < a->axes; i++) {
        const struct scenario_axis *x = &a->axis[i], *y = &b->axis[i];
        assert_true(x->count == y->count && x->paths == y->paths && x->log == y->log);
        assert_true(x->design == y->design && x->words == y->words);
        for (int k = 0; k < x->paths; k++) {
            assert_string_equal(x->path[k], y->path[k]);
            for (size_t p = 0; p < x->count && p < 100; p++)
                assert_true(scenario_axis_value(x, p, k) == scenario_axis_value(y, p, k));
        }
    }
    assert_string_equal(a->text, b->text);
}

TEST(resolved_text_reads_back)
{
    static const char *const sets[] = {"title=\"caf\\u00e9 \\\"q\\\" \\\\ : # \\u2028\"",
                                       "stop.time=3.25", "ground.restitution=0.25", "seed=5"};
    DIR *directory = opendir("scenarios");
    SCENARIO a = {0}, b = {0};
    for (size_t i = 0; i < GOOD_TEXTS; i++) {
        for (size_t n = 0; n <= 4; n += 4) {
            read_good(&a, texts[i], sets, n);
            read_good(&b, a.text, NULL, 0);
            same_scenario(&a, &b);
        }
    }
    assert_non_null(directory);
    for (struct dirent *entry; (entry = readdir(directory)) != NULL;) {
        char file[512];
        snprintf(file, sizeof file, "scenarios/%s", entry->d_name);
        if (!strstr(entry->d_name, ".yaml"))
            continue;
        if (!read_as(&a, file, NULL, NULL, 0))
            fail_msg("%s", errors);
        read_good(&b, a.text, NULL, 0);
        same_scenario(&a, &b);
    }
    closedir(directory);
}

/* Order and layout of the file do not matter, nor where a value comes from. */
TEST(resolved_text_is_canonical)
{
    SCENARIO a = {0}, b = {0};
    read_good(&a, places, (const char *[]){"ground.friction=0.5", "method.step=0.002"}, 2);
    read_good(&b,
              "# the same\nscene:   biped\nground: {friction: &f 0.5}\nstop:\n    time: 8\n"
              "method: {step: 0.002}\ncontroller: {poles: [-3, -3.3, -3.6,\n  -3.9, -4.2, "
              "-4.6], torque_limits: [10, none], kind: state-feedback}\ninitial:\n  equilibrium:\n "
              "   q2: 0.82\n"
              "    theta: -0.41\nstance: 1\n",
              NULL, 0);
    same_scenario(&a, &b);
}

/* ---- --set ---------------------------------------------------------------------------------- */

TEST(sets_edit)
{
    SCENARIO s = {0};
    read_good(&s, full,
              (const char *[]){"sweep.grid[0].count=7", "controller.poles[0]=-3.1",
                               "sweep.grid[2]={path: ground.restitution, values: [0]}",
                               "sweep.grid[5].path=stop.fall_height",
                               "sweep.grid[5].values=[0.1, 0.2]", "robot={}", "record.cases=none",
                               "stop.settle=off"},
              8);
    assert_int_equal(s.axis[0].count, 7);
    assert_true(s.base.pole_re[0] == -3.1 && s.base.robot[0] == 0.535);
    assert_string_equal(s.axis[2].name, "ground.restitution");
    assert_int_equal(s.axis[5].count, 2);
    assert_int_equal(s.base.settle, 0);
    read_good(&s, full, (const char *[]){"sweep={}", "record.cases=[0]"}, 2);
    assert_true(s.axes == 0 && s.cases == 1);
}

/* Long axes of numbers are refined, words and short lists are not. */
TEST(refinement)
{
    SCENARIO s = {0};
    read_good(&s, full, NULL, 0);
    assert_false(s.refine.given);
    for (int along = 0; along < 2; along++) { /* all that are, or one of them */
        read_good(
            &s, full,
            (const char *[]){
                along ? "sweep.refine={start: 4, along: stop.time}" : "sweep.refine={start: 4}",
                "sweep.grid[4]={path: stop.time, from: 1, to: 3, count: 5}",
                "sweep.grid[5]={path: ground.restitution, from: 0, to: 1, count: 9}", "record={}"},
            4);
        assert_true(s.refine.start == 4 && s.refine.margin == 1 && s.refine.probes == 0.01);
        for (int a = 0; a < s.axes; a++)
            assert_int_equal(s.axis[a].refined, along ? a == 4 : a >= 4);
    }
}

TEST(bad_sets_are_refused)
{
    static const char *const wanted[][2] = {
        {"stop.time=x", "stop.time: expected a number, found 'x'"},
        {"stop.time=", "stop.time: expected a number, found nothing"},
        {"stop.tim=1", "stop: unknown key 'tim'; did you mean 'time'? (known: time, settle, "
                       "walks, footfalls, fall_height)"},
        {"stop.time", "a value must follow; write stop.time=VALUE"},
        {"=1", "'' is not a path such as sweep.grid[0].count"},
        {"a[=1", "'a[' is not a path such as sweep.grid[0].count"},
        {"a[01]=1", "'a[01]' is not a path such as sweep.grid[0].count"},
        {"stop..time=1", "'stop..time' is not a path such as sweep.grid[0].count"},
        {"stop[0]=1", "stop is not a list; set it as a whole"},
        {"scene.x=1", "scene is not a mapping; set it as a whole"},
        {"controller.poles[7]=1", "controller.poles has 6 items, so [7] is beyond its end"},
        {"controller.poles[6]=-1", "controller.poles: expected 6 poles, found 7"},
        {"ground={friction: 0.1, friction: 0.2}", "duplicate key 'friction' (first in line 1)"},
        {"ground=[1", "not YAML: did not find expected ',' or ']', while parsing a flow sequence "
                      "(line 1)"},
        {"title=\xff", "not UTF-8 text (byte 0xff)"},
        {"sweep.grid=[{path: stop.time, from: 0, to: 1, count: 2}]",
         "stop.time: 0 is out of range (more than 0, at most 1e+09 s)"},
    };
    char line[1024];
    for (size_t i = 0; i < COUNT(wanted); i++) {
        snprintf(line, sizeof line, "--set %s: %s\n", wanted[i][0], wanted[i][1]);
        refused(places, &wanted[i][0], 1, line);
    }
}

/* ---- bad scenarios -------------------------------------------------------------------------- */

TEST(bad_files_lead_to_one_line)
{
    DIR *directory = opendir("tests/bad");
    int files = 0;
    assert_non_null(directory);
    for (struct dirent *entry; (entry = readdir(directory)) != NULL;) {
        char file[512], head[1024], wanted[2048];
        SCENARIO s = {0};
        if (!strstr(entry->d_name, ".yaml"))
            continue;
        snprintf(file, sizeof file, "tests/bad/%s", entry->d_name);
        FILE *in = fopen(file, "r");
        assert_non_null(in);
        assert_non_null(fgets(head, sizeof head, in));
        fclose(in);
        snprintf(wanted, sizeof wanted, "%s:%s", file, head + 2);
        assert_false(read_as(&s, file, NULL, NULL, 0));
        assert_string_equal(errors, wanted);
        files++;
    }
    closedir(directory);
    assert_true(files >= 70);
}

TEST(unreadable_files_lead_to_one_line)
{
    SCENARIO s = {0};
    assert_false(read_as(&s, "tests/bad/absent.yaml", NULL, NULL, 0));
    assert_string_equal(errors, "tests/bad/absent.yaml: No such file or directory\n");
    assert_false(read_as(&s, "tests/bad", NULL, NULL, 0));
    assert_string_equal(errors, "tests/bad: is a directory, not a file\n");
    refused("", NULL, 0, "bad.yaml: nothing stands in this file\n");
    refused("# a comment\n", NULL, 0, "bad.yaml: nothing stands in this file\n");
    refused("stance: 1\ntitle: \xc3(\n", NULL, 0, "bad.yaml:2:8: not UTF-8 text (byte 0xc3)\n");
    refused("stance: 1\n\x01\n", NULL, 0,
            "bad.yaml:2:1: not text: the control character U+0001 stands here\n");

    OWN char *large = room((1 << 20) + 2);
    memset(large, '#', (1 << 20) + 1);
    large[(1 << 20) + 1] = '\0';
    refused(large, NULL, 0, "bad.yaml: larger than 1 MiB\n");
}

/* All errors, in order of position, those of --set last; at most 20. */
TEST(several_errors_are_sorted)
{
    char text[4096] = "stance: 1\nscene: biped\n"
                      "stop: {time: soon, fall_height: 2}\n"
                      "initial: {state: {z: 1, x: y}}\n"
                      "ground: {friction: 11, grip: 1}\n";
    refused(text, (const char *[]){"method.step=1", "seed=-1"}, 2,
            "bad.yaml:3:14: stop.time: expected a number, found 'soon'\n"
            "bad.yaml:3:33: stop.fall_height: 2 is out of range (0 ... 1)\n"
            "bad.yaml:4:28: initial.state.x: expected a number, found 'y'\n"
            "bad.yaml:5:20: ground.friction: 11 is out of range (0 ... 10)\n"
            "bad.yaml:5:24: ground: unknown key 'grip' (known: friction, restitution, slope, "
            "gravity, law, lands, prefer, plates, contacts)\n"
            "--set method.step=1: method.step: 1 is out of range (more than 0, at most 0.1 s)\n"
            "--set seed=-1: seed: -1 is out of range (0 ... 9223372036854775807)\n");

    strcpy(text, "stance: 1\nscene: biped\ninitial: {state: {z: 1}}\nstop: {time: 1}\nsweep:\n"
                 "  grid:\n  - path: stop.time\n    values: [");
    for (int i = 0; i < 300; i++)
        strcat(text, "x, ");
    strcat(text, "y]\n");
    SCENARIO s = {0};
    int lines = 0;
    assert_false(read_as(&s, "bad.yaml", text, NULL, 0));
    for (const char *at = errors; (at = strchr(at, '\n')) != NULL; at++)
        lines++;
    assert_int_equal(lines, 21);
    assert_non_null(strstr(errors, "\nbad.yaml: 281 more errors\n"));
}

/* ---- every row of the table ----------------------------------------------------------------- */

/* A scenario in which a field may be given. */
static const char *text_for(const struct scenario_field *field)
{
    const enum field_use use = field->use;
    const char *const law = use == USE_LAW ? stance_laws()[field->law]->name : "";
    return strcmp(law, "hold") == 0 || use == USE_STATE      ? holds
           : use == USE_GAINS                                ? gives_gains
           : use == USE_LQR                                  ? regulates
           : strcmp(law, "decoupling") == 0                  ? decouples
           : strcmp(law, "bimodal-feedback") == 0            ? bends
           : strcmp(law, "outputs") == 0 || use == USE_WALKS ? follows
           : use == USE_FAR                                  ? switches
                                                             : places;
}

static void set_path(const struct scenario_field *field, char *path, size_t size)
{
    size_t n = 0;
    for (const char *s = field->path; *s && n + 2 < size; s++) {
        path[n++] = *s;
        if (*s == '[')
            path[n++] = '1';
    }
    path[n] = '\0';
}

/* Sets and sweeps the field to a random value; both must arrive where the table says. */
static void set_and_sweep(const struct scenario_field *field, uint64_t *random)
{
    char path[128], number[40], set[256], axis[512];
    const bool real = field->type == FIELD_NUMBER;
    double low = fmax(field->low, -1e6), high = fmin(field->high, 1e6), found;
    SCENARIO s = {0};
    struct scenario_values v;
    int word = 0;

    set_path(field, path, sizeof path);
    snprintf(number, sizeof number, "%.17g", uniform(random, low, high));
    if (field->type == FIELD_INTEGER) {
        word = (int)field->low;
        snprintf(number, sizeof number, "%d", word);
    } else if (field->type == FIELD_WORD) {
        word = field->use == USE_FEEDBACK ? (int)field->fallback : (int)field->word_count - 1;
        snprintf(number, sizeof number, "%s", field->words[word]);
    }
    snprintf(set, sizeof set, "%s=%s", path, number);
    snprintf(axis, sizeof axis, "sweep.grid=[{path: '%s', values: [%s]}]", path, number);
    size_t offset = field->offset;
    if (strchr(path, '['))
        offset += (1 + field->columns) * sizeof(double);
    for (int k = 0; k < 2; k++) {
        const char *const sets[] = {k == 0 ? set : axis};
        read_good(&s, text_for(field), sets, 1);
        scenario_case_values(&s, 0, &v);
        if (real) {
            memcpy(&found, (const char *)&v + offset, sizeof found);
            assert_near(found, strtod(number, NULL), 0);
        } else {
            int integer;
            memcpy(&integer, (const char *)&v + offset, sizeof integer);
            assert_int_equal(integer, word);
        }
    }
}

TEST(every_field_can_be_set_and_swept)
{
    OWN struct schema *schema = malloc(sizeof *schema);
    uint64_t random = 1;
    int fields = 0;
    assert_non_null(schema);
    assert_true(schema_build(schema, stance_scene_find("biped"), NULL, false));
    for (int round = 0; round < 20; round++) {
        for (size_t i = 0; i < schema->count; i++) {
            const struct scenario_field *field = &schema->field[i];
            /* A third angle of an equilibrium is an error; noise, a lag and a sampled design ask
             * for a sample time; the biped's ground is level, on Earth. */
            if (field->sweep && !strstr(field->path, "equilibrium.") &&
                !strstr(field->path, ".slope") && !strstr(field->path, ".gravity") &&
                !strstr(field->path, "noise") && !strstr(field->path, "design_time") &&
                !strstr(field->path, "lag") && !strstr(field->path, "torque_rate")) {
                set_and_sweep(field, &random);
                fields++;
            }
        }
    }
    assert_true(fields > 20 * 40);
}

/* ---- damaged text --------------------------------------------------------------------------- */

/* Changes, removes, doubles some bytes. */
static void damage(char *text, size_t size, uint64_t *random)
{
    static const char letters[] = " \n:-[]{},#&*!|>'\"%@`019.eE+xi~\t\\\xc3\xff";
    for (int edits = (int)uniform(random, 0, 5); edits > 0 && text[0]; edits--) {
        size_t length = strlen(text), at = (size_t)uniform(random, 0, (double)length);
        size_t run = 1 + (size_t)uniform(random, 0, 12);
        run = run < length - at ? run : length - at;
        switch ((int)uniform(random, 0, 4)) {
        case 0:
            memmove(text + at, text + at + run, length - at - run + 1);
            break;
        case 1:
            if (length + run < size)
                memmove(text + at + run, text + at, length - at + 1);
            break;
        default:
            text[at] = letters[(size_t)uniform(random, 0, sizeof letters - 1)];
        }
    }
}

/* Whatever becomes of good scenarios, nothing crashes, and what is accepted reads back. */
TEST(damaged_text_is_survived)
{
    static const char *const sets[] = {"sweep.grid[0].count=2", "controller.poles[2]=-3+1.5i",
                                       "ground={friction: 0.5, contacts: [foot1]}", "seed=1"};
    const long rounds = long_tests() ? 200000 : 20000;
    uint64_t random = 7;
    char text[4096], set[256];
    for (long round = 0; round < rounds; round++) {
        const char *const edits[] = {set};
        SCENARIO a = {0}, b = {0};
        snprintf(text, sizeof text, "%s", texts[round % GOOD_TEXTS]);
        snprintf(set, sizeof set, "%s", sets[round / GOOD_TEXTS % 4]);
        damage(text, sizeof text, &random);
        damage(set, sizeof set, &random);
        if (read_as(&a, "good.yaml", text, edits, round % 3 == 0)) {
            read_good(&b, a.text, NULL, 0);
            same_scenario(&a, &b);
        } else {
            assert_true(strncmp(errors, "good.yaml:", 10) == 0 ||
                        strncmp(errors, "--set ", 6) == 0);
        }
    }
}
