/* test_compiled - kernels compiled for random mechanisms compute, to the bit, what those that read
 * the structure as they go compute: thrown, and let go from rest on each support.
 *
 * test_compiled FIRST COUNT CASES [METHOD ISA]: mechanisms FIRST ... FIRST + COUNT - 1, CASES each;
 * method and instruction set go round, so that each pair has its share. Without arguments one
 * mechanism, or with STANCE_TEST_LONG twenty and all pairs.
 */
#include "random_mechanism.h"
#include "scratch.h"

#include "runner/objects/objects.h"

enum { MOST_CASES = 2000 };

static const char *const method_name[] = {"capturing", "midpoint", "implicit", "lagrange"};
enum { METHODS = COUNT(method_name) };

/* Let go at rest, or nearly so, on one support after the other, the posture as it was thrown. */
static void let_go(const stance_scene *scene, int k, stance_case *c)
{
    uint32_t support[STANCE_MAX_CONTACTS];
    int supports = 0;
    double gap[STANCE_MAX_CONTACTS];
    for (int g = 0; g < scene->contacts; g++)
        if (scene->grip[g] == g) {
            support[supports] = 0;
            for (int end = g; end < scene->contacts; end++)
                support[supports] |= scene->grip[end] == g ? 1u << end : 0;
            supports++;
        }
    for (int i = 0; i < scene->coordinates; i++)
        c->velocity[i] *= k % 3 ? 0 : 0.02;
    if (supports == 0)
        return;
    const uint32_t stands = support[k / 2 % supports];
    scene->stand(scene, c->robot, stands, c->position, c->velocity);
    scene->gaps(scene, c->robot, c->position, gap);
    for (int a = 0; a < scene->contacts; a++)
        for (int b = 0; b < scene->contacts; b++)
            if (gap[a] < 0 && scene->grip[a] >= 0 && scene->grip[b] == scene->grip[a])
                c->contacts &= ~(1u << b);
    c->contacts |= stands;
}

static bool same_bits(const stance_scene *scene, const stance_result *a, const stance_result *b)
{
    const size_t size = (size_t)scene->coordinates * sizeof(double);
    bool same = a->status == b->status && memcmp(a->position, b->position, size) == 0 &&
                memcmp(a->velocity, b->velocity, size) == 0;
    for (int i = 0; i < STANCE_ANSWER_COUNT; i++) {
        const stance_answer *const answer = &stance_answers[i];
        const char *const x = (const char *)a + answer->offset,
                          *y = (const char *)b + answer->offset;
        double nan[2] = {0, 0};
        if (answer->type == STANCE_DOUBLE)
            memcpy(&nan[0], x, sizeof nan[0]), memcpy(&nan[1], y, sizeof nan[1]);
        if (memcmp(x, y, answer->size) != 0 && !(isnan(nan[0]) && isnan(nan[1]))) {
            print_message("# another %s\n", answer->name);
            same = false;
        }
    }
    return same;
}

/* Cases of one mechanism that differ; `object` is taken unchecked. */
static long compare(const stance_scene *scene, const struct object *object, int count)
{
    static stance_case cases[MOST_CASES];
    static stance_result built[MOST_CASES], compiled[MOST_CASES];
    long differ = 0;
    for (int k = 0; k < count; k++) {
        random_scene_case(scene, &cases[k]);
        cases[k].tolerance = object->kernel.method->tolerance;
        if (k % 2)
            let_go(scene, k, &cases[k]);
    }
    stance_kernel_find(scene, object->kernel.method, NULL)->run(cases, built, (size_t)count);
    object->kernel.run(cases, compiled, (size_t)count);
    for (int k = 0; k < count; k++)
        if (!same_bits(scene, &built[k], &compiled[k])) {
            differ++;
            print_message("# case %d: friction %g, step %g, contacts %x\n", k, cases[k].friction,
                          cases[k].step, cases[k].contacts);
        }
    return differ;
}

static long compare_mechanism(int tree, const char *method, const char *isa, int count)
{
    char tables[STANCE_TREE_TEXT];
    const struct parallel alone = parallel_alone();
    SCENE *scene = random_scene(tree, tree % 2 ? 0.4 : 0);
    struct object object;
    stance_message message;
    const struct objects_wanted wanted = {stance_method_find(method), isa, NULL};
    stance_tree_text(scene->tree, false, tables);
    const struct objects_request request = {
        .tables = tables, .scene = scene, .wanted = &wanted, .count = 1, .quiet = true};
    if (objects_take(&alone, &request, &object, NULL, &message) != EXIT_DONE)
        fail_msg("mechanism %d, %s, %s: %s", tree, method, isa, message.text);
    const long differ = compare(scene, &object, count);
    if (differ > 0)
        print_message("# mechanism %d, %s, %s: %ld of %d cases differ\n", tree, method, isa, differ,
                      count);
    objects_release(&object, 1);
    return differ;
}

static const char *only_method, *only_isa; /* NULL: they go round */
static int first_mechanism = 1, mechanisms = 1, cases_each = 200;

TEST(random_mechanisms)
{
    int isas = 0, turn = 0;
    long differ = 0;
    while (stance_isa(isas))
        isas++;
    const bool all = long_tests();
    for (int tree = first_mechanism; tree < first_mechanism + mechanisms; tree++, turn++) {
        if (!all)
            differ += compare_mechanism(
                tree, only_method ? only_method : method_name[turn % METHODS],
                only_isa ? only_isa : stance_isa(turn / METHODS % isas), cases_each);
        for (int k = 0; all && k < METHODS * isas; k++)
            differ += compare_mechanism(tree, method_name[k % METHODS], stance_isa(k / METHODS),
                                        cases_each);
    }
    print_message("## %d mechanisms, %ld of %ld cases differ\n", mechanisms, differ,
                  (long)mechanisms * cases_each * (all ? METHODS * isas : 1));
    assert_int_equal(differ, 0);
}

/* Its arguments say which. */
static int which(int argc, char **argv)
{
    if (long_tests())
        mechanisms = 20;
    if (argc > 3) {
        first_mechanism = atoi(argv[1]), mechanisms = atoi(argv[2]);
        cases_each = atoi(argv[3]) < MOST_CASES ? atoi(argv[3]) : MOST_CASES;
    }
    if (argc > 5)
        only_method = argv[4], only_isa = argv[5];
    return -1;
}
static int (*instead)(int argc, char **argv) = which;
static CMFixtureFunction before_tests = cache_make, after_tests = scratch_remove;
