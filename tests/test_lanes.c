/* test_lanes - a case's numbers are its own: whatever lane it runs in, however many there are, and
 * whatever runs beside it. Cases of ordinary and of extreme proportions run
 *
 *   alone, the structure read at run time where no one-lane kernel is built: the reference,
 *   alone in a kernel that doubts: all it may ask of its neighbours (mask_any, the set of contacts
 *     that touch anywhere) it is told yes at random; a kernel that passes computes the same
 * whatever its neighbours do, since that is all they can do to it, among others, in random order,
 * in every instruction set that the processor runs.
 *
 * Usage: test_lanes [SCENE METHOD ordinary|extreme COUNT [SEED [KERNELS]]]
 * without arguments: a share of everything; KERNELS: of these names only, as in doubting,avx2
 */
#include "hunt.h"
#include "long.h"

#include <stdio.h>

enum { BATCH = 2048, SHARE = 512 };

/* The kernels that doubt, from the Makefile's list: KERNEL(biped, implicit) ... */
#define KERNEL(scene, method)                                                                      \
    extern const stance_kernel stance_kernel_##scene##_##method##_doubting;
STANCE_DOUBTING_LIST
#undef KERNEL
#define KERNEL(scene, method) &stance_kernel_##scene##_##method##_doubting,
static const stance_kernel *const doubting[] = {STANCE_DOUBTING_LIST NULL};
#undef KERNEL

struct hunt {
    const stance_scene *scene;
    const stance_kernel *kernel;
    stance_case cases[BATCH], shuffled[BATCH];
    stance_result alone[BATCH], beside[BATCH];
    size_t order[BATCH];
    size_t n; /* cases of a batch */
    double differ, failed, done;
};
static struct hunt hunt;
static const char *only; /* NULL, or names of the kernels to be held against the reference */

static bool wanted(const char *isa)
{
    return !only || strstr(only, isa);
}

static void compare(const char *name, size_t i, const stance_result *r)
{
    if (memcmp(&hunt.alone[i], r, sizeof *r) == 0)
        return;
    if (hunt.differ++ < 5)
        printf("# %s, %s: case %.0f differs: status %d and %d, vx %.17g and %.17g\n",
               hunt.kernel->method->name, name, hunt.done + (double)i, hunt.alone[i].status,
               r->status, hunt.alone[i].velocity[0], r->velocity[0]);
}

static void run_beside(const stance_kernel *k, uint64_t *seed)
{
    for (size_t i = 0; i < hunt.n; i++)
        hunt.order[i] = i;
    for (size_t i = hunt.n - 1; i > 0; i--) {
        const size_t j = (size_t)uniform(seed, 0, (double)(i + 1)), x = hunt.order[i];
        hunt.order[i] = hunt.order[j], hunt.order[j] = x;
    }
    for (size_t i = 0; i < hunt.n; i++)
        hunt.shuffled[i] = hunt.cases[hunt.order[i]];
    run_cases(k, hunt.shuffled, hunt.beside, hunt.n);
    for (size_t i = 0; i < hunt.n; i++)
        compare(k->isa, hunt.order[i], &hunt.beside[i]);
}

/* One batch of the cases that follow from *seed. */
static void batch(bool extreme, uint64_t *seed)
{
    const stance_scene *const scene = hunt.scene;
    for (size_t i = 0; i < hunt.n; i++)
        hunt_case(scene, seed, extreme, &hunt.cases[i]);
    for (size_t i = 0; i < hunt.n; i++) {
        run_cases(hunt.kernel, &hunt.cases[i], &hunt.alone[i], 1);
        hunt.failed += hunt.alone[i].status == STANCE_FAILED;
    }
    for (int k = 0; doubting[k]; k++)
        if (wanted("doubting") && stance_kernel_fits(doubting[k], scene) &&
            doubting[k]->method == hunt.kernel->method)
            for (size_t i = 0; i < hunt.n; i++) {
                run_cases(doubting[k], &hunt.cases[i], &hunt.beside[i], 1);
                compare("doubting", i, &hunt.beside[i]);
            }
    for (int rank = 0; stance_isa(rank); rank++) {
        const stance_kernel *const k =
            stance_kernel_find(scene, hunt.kernel->method, stance_isa(rank));
        if (strcmp(k->isa, "scalar") != 0 && strcmp(k->isa, stance_isa(rank)) == 0 &&
            wanted(k->isa))
            run_beside(k, seed);
    }
    hunt.done += (double)hunt.n;
}

static bool run(const stance_scene *scene, const stance_method *method, bool extreme, double count,
                uint64_t seed)
{
    hunt.scene = scene;
    hunt.kernel = stance_kernel_find(scene, method, "scalar");
    hunt.differ = hunt.failed = hunt.done = 0;
    hunt.n = count < BATCH ? (size_t)count : BATCH;
    while (hunt.done < count)
        batch(extreme, &seed);
    printf("# %s, %s, %s: %.0f of %.0f cases differ, %.0f failed\n", scene->name, method->name,
           extreme ? "extreme" : "ordinary", hunt.differ, hunt.done, hunt.failed);
    fflush(stdout);
    return hunt.differ == 0;
}

int main(int argc, char **argv)
{
    if (argc > 4) {
        const stance_scene *const scene = stance_scene_find(argv[1]);
        const stance_method *const method = stance_method_find(argv[2]);
        if (!scene || !method)
            return 2;
        only = argc > 6 ? argv[6] : NULL;
        return !run(scene, method, strcmp(argv[3], "extreme") == 0, strtod(argv[4], NULL),
                    argc > 5 ? strtoull(argv[5], NULL, 0) : 1);
    }
    int tests = 0;
    bool all = true;
    for (int k = 0; doubting[k]; k++)
        for (int extreme = 0; extreme < 2; extreme++) {
            const double count = long_tests() ? 50 * BATCH : extreme ? SHARE / 8 : SHARE;
            const bool good = run(stance_scene_find(doubting[k]->structure), doubting[k]->method,
                                  extreme, count, 7 + (uint64_t)k);
            printf("%sok %d - %s, %s, %s cases\n", good ? "" : "not ", ++tests,
                   doubting[k]->structure, doubting[k]->method->name,
                   extreme ? "extreme" : "ordinary");
            all &= good;
        }
    printf("1..%d\n", tests);
    return !all;
}
