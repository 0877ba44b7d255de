/* kernels.c - what a plan asks of runner/objects. */
#include "kernels.h"

#include "instruction_set.h"

#include "engine/tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CHECKS = 64, CHECK_STEPS = 50 };

/* Steps that kernels which are built in compute in less time than it takes to compile others. */
static const double brief_steps = 2e6;

static bool listed(const char *word, const char *const *list, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(word, list[i]) == 0)
            return true;
    return false;
}

/* Methods that are chosen, or that cases of the plan have. */
static size_t list_methods(const struct plan *plan, const struct kernels_choice *choice,
                           struct objects_wanted *wanted)
{
    const char *const own = instruction_set(), *const *isa = &own;
    size_t isas = 1;
    const struct scenario *s = plan->scenario;
    const struct scenario_axis *axis;
    size_t count = 0;
    int k;
    axis = scenario_axis_of(s, offsetof(struct scenario_values, method), &k);
    for (int m = 0; stance_methods()[m]; m++) {
        bool used = !axis && s->base.method == m;
        for (size_t i = 0; axis && i < axis->count; i++)
            used |= (int)scenario_axis_value(axis, i, k) == m;
        if (choice && choice->methods > 0)
            used = listed(stance_methods()[m]->name, choice->method, choice->methods);
        if (choice && choice->isas > 0)
            isa = choice->isa, isas = choice->isas;
        for (size_t i = 0; used && i < isas && count < OBJECTS_MOST; i++) {
            wanted[count++] = (struct objects_wanted){
                .method = stance_methods()[m],
                .isa = isa[i],
                .reference = stance_kernel_find(s->scene, stance_methods()[m], NULL),
            };
        }
    }
    return count;
}

/* Some cases, evenly spread, for a moment each. *steps: about as many as all have. */
static size_t list_checks(const struct plan *plan, stance_case *check, double *steps)
{
    const uint64_t tried = plan->rows < CHECKS ? plan->rows : CHECKS;
    size_t count = 0;
    *steps = 0;
    for (uint64_t i = 0; i < tried; i++) {
        int method;
        const uint64_t row = tried == plan->rows ? i : (uint64_t)((double)plan->rows * i / CHECKS);
        if (plan->design_status[plan_design(plan, plan_case(plan, row))] != STANCE_DONE ||
            !plan_resolve(plan, row, &check[count], &method))
            continue;
        *steps += (double)plan->rows / (double)tried * (double)check[count].steps;
        if (check[count].steps > CHECK_STEPS)
            check[count].steps = CHECK_STEPS;
        count++;
    }
    return count;
}

bool kernels_compiled(const struct plan *plan)
{
    stance_case *const check =
        plan->scenario->scene->mechanism ? calloc(CHECKS, sizeof *check) : NULL;
    double steps = 0;
    if (check)
        list_checks(plan, check, &steps);
    free(check);
    return steps > brief_steps;
}

enum exit_code kernels_take(struct kernels *kernels, const struct plan *plan,
                            const struct kernels_choice *choice, const struct parallel *parallel,
                            bool quiet, stance_message *message)
{
    const stance_scene *const scene = plan->scenario->scene;
    const struct scenario_values *const base = &plan->scenario->base;
    struct objects_wanted wanted[OBJECTS_MOST];
    char tables[STANCE_TREE_TEXT];
    kernels->count = 0;
    if (!scene->mechanism)
        return EXIT_DONE;
    stance_case *const check = calloc(CHECKS, sizeof *check);
    if (!check)
        abort(); /* the others wait */
    double steps = INFINITY;
    const size_t checks = parallel->rank == 0 ? list_checks(plan, check, &steps) : 0;
    const size_t count = list_methods(plan, choice, wanted);
    bool brief = !choice && steps <= brief_steps;
    for (size_t k = 0; k < count; k++)
        brief &= wanted[k].reference != NULL;
    stance_tree_text(scene->tree, scenario_law(base)->servos || scenario_far(base)->servos, tables);
    const struct objects_request request = {
        .tables = tables,
        .scene = scene,
        .wanted = wanted,
        .count = count,
        .check = check,
        .checks = checks,
        .quiet = quiet,
        .brief = brief,
    };
    const enum exit_code code = objects_take(parallel, &request, kernels->object, message);
    free(check);
    if (code != EXIT_DONE)
        return code;
    kernels->count = request.count;
    for (size_t i = 0; i < kernels->count; i++)
        kernels->kernel[i] = &kernels->object[i].kernel;
    instruction_set_prefer(kernels->kernel, kernels->count);
    return code;
}

void kernels_give_back(struct kernels *kernels)
{
    instruction_set_prefer(NULL, 0);
    objects_release(kernels->object, kernels->count);
    kernels->count = 0;
}
