/* golden.c - prints "scene method isa hash" for every kernel with lanes that this machine runs, a
 * hash of every answer of CASES cases: a program of the engine alone, to be compared between
 * machines (tests/whole_machines.sh). The scenes are those that are compiled and TREES random trees
 * of bodies, whose structure is read at run time.
 * Usage: golden [CASES] */
#include "cases.h"
#include "random_mechanism.h"

#include <stdio.h>

enum { TREES = 8 };

static uint64_t hash_answers(const stance_result *r, int coordinates, uint64_t h)
{
    h = hash(&r->status, sizeof r->status, h);
#define ANSWER(name, type, how, told, unit, text) h = hash(&r->name, sizeof r->name, h);
    STANCE_ANSWERS(ANSWER)
    h = hash(r->position, (size_t)coordinates * sizeof *r->position, h);
    return hash(r->velocity, (size_t)coordinates * sizeof *r->velocity, h);
}

/* The kernels of a scene, by all methods and instruction sets. */
static void print_hashes(const stance_scene *scene, const char *name, stance_case *cases,
                         stance_result *results, size_t n)
{
    for (const stance_method *const *method = stance_methods(); *method; method++)
        for (int rank = 0; stance_isa(rank); rank++) {
            const stance_kernel *const k = stance_kernel_find(scene, *method, stance_isa(rank));
            if (!k || strcmp(k->isa, stance_isa(rank)) != 0)
                continue; /* a method, or a mechanism, that has one kernel only */
            uint64_t h = 0xcbf29ce484222325u;
            run_cases(k, cases, results, n);
            for (size_t i = 0; i < n; i++)
                h = hash_answers(&results[i], scene->coordinates, h);
            printf("%s %s %s %016llx\n", name, (*method)->name, k->isa, (unsigned long long)h);
        }
}

int main(int argc, char **argv)
{
    const long n = argc > 1 ? strtol(argv[1], NULL, 10) : 400;
    stance_case *const cases = n < 1 ? NULL : calloc((size_t)n, sizeof *cases);
    stance_result *const results = n < 1 ? NULL : calloc((size_t)n, sizeof *results);
    if (!cases || !results)
        return 2;
    for (const stance_scene *const *scene = stance_scenes(); *scene; scene++) {
        uint64_t seed = 99;
        for (int i = 0; i < n; i++)
            if (*scene == biped())
                golden_case(&seed, i, &cases[i]);
            else
                scene_case(*scene, &seed, &cases[i]);
        print_hashes(*scene, (*scene)->name, cases, results, (size_t)n);
    }
    for (int tree = 0; tree < TREES; tree++) {
        stance_scene *const scene = random_scene(tree, tree % 2 ? 0.4 : 0);
        char name[16];
        snprintf(name, sizeof name, "tree%d", tree);
        for (int i = 0; i < n; i++) {
            random_scene_case(scene, &cases[i]);
            cases[i].tolerance = 1e-8;
        }
        print_hashes(scene, name, cases, results, (size_t)n);
        stance_scene_free(scene);
    }
    free(cases);
    free(results);
    return 0;
}
