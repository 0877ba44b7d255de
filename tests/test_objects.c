/* test_objects.c - kernels that are compiled on demand compute what those that are built in do.
 *
 * With arguments it is a job: SCENE METHOD[,METHOD ...] ISA [alone] takes the kernels of a
 * scene, whose lanes stand for those of a mechanism, compares them with the built-in ones and says
 * where they come from; tests/whole_objects.sh runs such jobs under all circumstances. `alone`:
 * there are no built-in ones to compare with or to fall back on, as for what is really new.
 */
#include "scratch.h"
#include "support.h"

#include "runner/base/units.h"
#include "runner/objects/objects.h"

#include "engine/tree.h"

enum { CHECKS = 64, STEPS = 50, CASES = 60, MOST = 8 };

static bool same(const struct object *object, const stance_scene *scene)
{
    const stance_kernel *const own = stance_kernel_find(scene, object->kernel.method, "scalar");
    return golden_hash(&object->kernel, scene, CASES, false, CASES) ==
           golden_hash(own, scene, CASES, false, CASES);
}

/* What is asked for, with all that it points to. */
struct asked {
    struct objects_request request;
    struct objects_wanted wanted[MOST];
    stance_case check[CHECKS];
    char tables[STANCE_TREE_TEXT];
};

static void ask(struct asked *asked, const char *scene, char *methods, const char *isa, bool alone)
{
    char *rest = NULL;
    uint64_t seed = 5;
    asked->request = (struct objects_request){.tables = asked->tables,
                                              .scene = stance_scene_find(scene),
                                              .wanted = asked->wanted,
                                              .check = asked->check,
                                              .checks = CHECKS,
                                              .patience = 1};
    stance_tree_text(asked->request.scene->tree, true, asked->tables);
    for (int i = 0; i < CHECKS; i++) {
        if (strcmp(scene, "biped") == 0)
            golden_case(&seed, i, &asked->check[i]);
        else
            scene_case(asked->request.scene, &seed, &asked->check[i]);
        asked->check[i].steps = STEPS;
        stance_case_robot(asked->request.scene, &asked->check[i]);
    }
    for (char *name = strtok_r(methods, ",", &rest); name; name = strtok_r(NULL, ",", &rest)) {
        const stance_method *const method = stance_method_find(name);
        const stance_kernel *const own = stance_kernel_find(asked->request.scene, method, isa);
        asked->wanted[asked->request.count++] =
            (struct objects_wanted){method, isa, alone ? NULL : own};
    }
}

static int compare(int argc, char **argv)
{
    char *const *const word = argv + 1;
    static const char *const origin[] = {
        [OBJECT_KEPT] = "kept",        [OBJECT_COMPILED] = "compiled",
        [OBJECT_UNKEPT] = "compiled",  [OBJECT_REFERENCE] = "built in",
        [OBJECT_MISSING] = "built in", [OBJECT_REFUSED] = "built in"};
    struct asked asked;
    struct object object[MOST];
    stance_message message;
    if (argc < 4)
        return -1;
    struct parallel ranks = parallel_start();
    ask(&asked, word[0], word[1], word[2], word[3] && strcmp(word[3], "alone") == 0);
    const double begin = clock_seconds();
    const enum exit_code code = objects_take(&ranks, &asked.request, object, NULL, &message);
    const double taken = clock_seconds() - begin;
    if (code != EXIT_DONE && ranks.rank == 0)
        fprintf(stderr, "%s\n", message.text);
    bool good = true;
    for (size_t k = 0; code == EXIT_DONE && k < asked.request.count; k++) {
        const bool equal = same(&object[k], asked.request.scene);
        good &= equal;
        printf("rank %d: %s %s: %s, %s bits, by %s\n", ranks.rank, object[k].kernel.method->name,
               object[k].kernel.isa, origin[object[k].origin], equal ? "the same" : "other",
               object[k].compiler);
    }
    if (code == EXIT_DONE) {
        printf("rank %d: %.2f ms\n", ranks.rank, 1e3 * taken);
        objects_release(object, asked.request.count);
    }
    parallel_finish(&ranks);
    return code == EXIT_DONE && !good ? EXIT_CASES_FAILED : (int)code;
}
static int (*instead)(int argc, char **argv) = compare;

static CMFixtureFunction before_tests = cache_make, after_tests = scratch_remove;

/* ---- tests --------------------------------------------------------------------------------- */

/* Objects of several scenes in one process, some of them gone: each is its own. */
TEST(one_after_the_other)
{
    static const char *const scene[] = {"ball", "rod", "block"};
    enum { SCENES = COUNT(scene) };
    const struct parallel alone = parallel_alone();
    struct object object[SCENES], again;
    for (int turn = 0; turn < 2; turn++) { /* compiled, kept */
        for (int k = 0; k < SCENES; k++) {
            struct asked asked;
            stance_message message;
            char method[] = "lagrange";
            ask(&asked, scene[k], method, "scalar", false);
            asked.request.quiet = true;
            assert_int_equal(objects_take(&alone, &asked.request, &object[k], NULL, &message),
                             EXIT_DONE);
            assert_int_equal(object[k].origin, turn == 0 ? OBJECT_COMPILED : OBJECT_KEPT);
            assert_int_equal(objects_take(&alone, &asked.request, &again, NULL, &message),
                             EXIT_DONE);
            assert_string_equal(again.key, object[k].key);
            objects_release(&again, 1);
        }
        for (int k = 0; k < SCENES; k++)
            assert_true(same(&object[k], stance_scene_find(scene[k])));
        objects_release(object, SCENES);
    }
}

/* An image of `size` bytes under a label. */
static struct image sealed(size_t size, const struct image_label *label)
{
    struct image image = {malloc(size), size};
    assert_non_null(image.bytes);
    for (size_t i = 0; i < size; i++)
        image.bytes[i] = (char)(i * i);
    assert_true(image_seal(&image, label));
    return image;
}

TEST(labels)
{
    const struct image_label given[] = {
        {"0123456789abcdef0123456789abcdef-0123456789abcdef0123456789abcdef",
         "gcc (Debian 12.2.0-14+deb12u1) 12.2.0"},
        {"k", ""},
        {"k", "a compiler whose name is as long as any name that may be kept is: 80 characters"}};
    for (size_t i = 0; i < COUNT(given); i++) {
        struct image image = sealed(1000 + i, &given[i]);
        struct image_label read;
        assert_true(image_label(&image, &read));
        assert_string_equal(read.key, given[i].key);
        assert_string_equal(read.compiler, given[i].compiler);
        image_free(&image);
    }
}

/* Whatever is cut off, added or turned over is seen. */
TEST(damage)
{
    const struct image_label label = {"key", "compiler"};
    struct image image = sealed(500, &label);
    struct image_label read;
    for (size_t size = 0; size < image.size; size++)
        assert_false(image_label(&(struct image){image.bytes, size}, &read));
    for (size_t i = 0; i < image.size; i++) {
        image.bytes[i] ^= 16;
        assert_false(image_label(&image, &read));
        image.bytes[i] ^= 16;
    }
    assert_true(image_label(&image, &read));
    image_free(&image);
}
