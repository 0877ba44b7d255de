/* kernels.c - what a plan asks of runner/objects. */
#include "kernels.h"

#include "engine/tree.h"

#include "runner/base/message.h"
#include "runner/base/words.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { OWN_CHECKS = 64, CHECKS = 256, CHECK_STEPS = 50 };

/* Steps that kernels which are built in compute in less time than it takes to compile others. */
static const double brief_steps = 2e6;

/* Whether cases of the plan have a method. */
static bool uses_method(const struct plan *plan, int method)
{
    return plan->single
               ? plan_method(plan, 0) == method
               : scenario_takes(plan->scenario, offsetof(struct scenario_values, method), method);
}

void kernels_instruction_sets(const struct plan *plan, char text[INSTRUCTION_SETS_SIZE])
{
    const char *last = "";
    text[0] = '\0';
    for (int m = 0; stance_methods()[m]; m++) {
        const stance_kernel *const kernel =
            uses_method(plan, m)
                ? instruction_set_kernel(plan->scenario->scene, stance_methods()[m])
                : NULL;
        if (!kernel || strcmp(kernel->isa, last) == 0)
            continue;
        last = kernel->isa;
        add_text(text, INSTRUCTION_SETS_SIZE, "%s%s", text[0] ? ", " : "", last);
    }
}

/* Methods that are chosen, or that cases of the plan have. */
static size_t list_methods(const struct plan *plan, const struct kernels_choice *choice,
                           struct objects_wanted *wanted)
{
    const char *const own = instruction_set(), *const *const isa =
                                                   choice->isas > 0 ? choice->isa : &own;
    const size_t isas = choice->isas > 0 ? choice->isas : 1;
    size_t count = 0;
    for (int m = 0; stance_methods()[m]; m++) {
        const stance_method *const method = stance_methods()[m];
        const bool used = choice->methods > 0 ? word_place(method->name, choice->method,
                                                           choice->methods) < choice->methods
                                              : uses_method(plan, m);
        for (size_t i = 0; used && i < isas && count < OBJECTS_MOST; i++) {
            wanted[count++] = (struct objects_wanted){
                method, isa[i],
                instruction_set_runs(isa[i])
                    ? stance_kernel_find(plan->scenario->scene, method, isa[i])
                    : NULL};
        }
    }
    return count;
}

/* ---- checks: what an object computes is held to what the reference does --------------------- */

/* Spread evenly over [-size, size], the k-th of a sequence of each `kind`. */
static double spread(uint64_t k, int kind, double size)
{
    const double turns = (double)k * 0.6180339887498949 + kind * 0.7548776662466927;
    return size * (2 * (turns - floor(turns)) - 1);
}

/* Moves and turns a case so that it stands on one support after the other, on all and on none, at
 * rest, disturbed, sliding and landing, with other friction and impacts than its scenario's: an
 * object may be taken by scenarios of other numbers and starts. */
static void disturb(const stance_scene *scene, uint64_t k, stance_case *c)
{
    enum manner { AT_REST, DISTURBED, SLIDING, LANDING, MANNERS };
    const bool free = scene->postures < scene->coordinates;
    const int first = scene->coordinates - scene->postures; /* the others move it as a whole */
    uint32_t support[STANCE_MAX_CONTACTS + 2] = {0}, contacts = 0;
    double before[STANCE_MAX_COORDINATES], gap[STANCE_MAX_CONTACTS];
    uint64_t supports = 2; /* none and all */
    for (int g = 0; g < scene->contacts; g++)
        if (scene->grip[g] == g) {
            for (int end = g; end < scene->contacts; end++)
                support[supports] |= scene->grip[end] == g ? 1u << end : 0;
            support[1] |= support[supports++];
        }
    const enum manner manner = (enum manner)(k / supports % MANNERS);
    const uint32_t stands = support[k % supports];
    memcpy(before, c->position, sizeof before);
    for (int i = 0; i < scene->coordinates; i++) {
        if (i >= first)
            c->position[i] += spread(k, i, 0.3);
        c->velocity[i] = manner == AT_REST ? 0 : spread(k + 7, i, 1);
    }
    scene->gaps(scene, c->robot, c->position, gap);
    for (int g = 0; g < scene->contacts; g++)
        if (scene->grip[g] < 0 && gap[g] < 0) /* beyond a stop */
            memcpy(c->position, before, sizeof before);
    if (free && stands)
        scene->stand(scene, c->robot, stands, c->position, c->velocity);
    if (free && manner == SLIDING)
        c->velocity[0] += k % 2 ? 0.5 : -0.5;
    if (free && manner == LANDING)
        c->position[1] += 2e-3, c->velocity[1] -= 0.5;
    scene->gaps(scene, c->robot, c->position, gap);
    for (int end = 0; end < scene->contacts; end++) {
        bool above = true; /* with what shares its friction */
        for (int other = 0; other < scene->contacts && scene->grip[end] >= 0; other++)
            above &= gap[other] >= -1e-12 || scene->grip[other] != scene->grip[end];
        contacts |= above ? 1u << end : 0;
    }
    c->contacts = contacts;
    c->settle = false;
    if (k % 3 == 1)
        c->friction = k % 2 ? 0.2 : 1.5;
    if (k % 5 == 2)
        c->restitution = 0.4, c->impacts = (stance_impacts)(k % 3);
}

/* Some cases of the plan, evenly spread, for a moment each, and as many disturbed ones for each:
 * check[CHECKS]. *steps: about as many as all cases have. */
static size_t list_checks(const struct plan *plan, stance_case *check, double *steps)
{
    const uint64_t tried = plan->rows < OWN_CHECKS ? plan->rows : OWN_CHECKS;
    size_t count = 0;
    *steps = 0;
    for (uint64_t i = 0; i < tried; i++) {
        const uint64_t row = (uint64_t)((double)plan->rows * i / tried);
        if (plan->design_status[plan_design(plan, plan_case(plan, row))] != STANCE_DONE ||
            !plan_resolve(plan, row, &check[count], NULL))
            continue;
        *steps += (double)plan->rows / (double)tried * (double)check[count].steps;
        if (check[count].steps > CHECK_STEPS)
            check[count].steps = CHECK_STEPS;
        count++;
    }
    const size_t own = count;
    if (own == 0)
        return 0;
    for (uint64_t k = 0; count < CHECKS; k++, count++) {
        check[count] = check[k % own];
        disturb(plan->scenario->scene, k, &check[count]);
    }
    return count;
}

/* Whether what the plan needs is compiled ahead. */
static bool all_ahead(const struct plan *plan)
{
    bool all = true;
    for (int m = 0; stance_methods()[m]; m++)
        if (uses_method(plan, m)) {
            const stance_kernel *const kernel =
                instruction_set_kernel(plan->scenario->scene, stance_methods()[m]);
            all = all && kernel && stance_kernel_ahead(kernel);
        }
    return all;
}

enum exit_code kernels_take(struct kernels *kernels, const struct plan *plan,
                            const struct kernels_choice *choice, const struct parallel *parallel,
                            stance_message *message)
{
    const struct scenario_values *const base = &plan->scenario->base;
    struct objects_wanted wanted[OBJECTS_MOST];
    char tables[STANCE_TREE_TEXT];
    double steps;
    kernels->count = 0;
    kernels->brief = true;
    kernels->later = NULL;
    if (!choice->again && all_ahead(plan))
        return EXIT_DONE;
    stance_case *const check = calloc(CHECKS, sizeof *check);
    if (!check)
        abort(); /* the others wait */
    stance_tree_text(plan->scenario->scene->tree,
                     scenario_law(base)->servos || scenario_far(base)->servos, tables);
    struct objects_request request = {
        .tables = tables,
        .scene = plan->scenario->scene,
        .wanted = wanted,
        .count = list_methods(plan, choice, wanted),
        .check = check,
        .checks = list_checks(plan, check, &steps),
        .quiet = choice->quiet,
        .again = choice->again,
        .looks = choice->looks,
        .stop = plan->stop,
        .context = plan->stop_context,
    };
    request.brief = !choice->always && steps <= brief_steps;
    for (size_t k = 0; k < request.count; k++)
        request.brief &= wanted[k].reference != NULL;
    request.patience = request.looks ? 0 : request.brief ? 0.01 : 0.1;
    kernels->brief = request.brief;
    const bool later = choice->later && parallel_on_one_host(parallel); /* with one cache */
    const enum exit_code code =
        objects_take(parallel, &request, kernels->object, later ? &kernels->later : NULL, message);
    free(check);
    if (code != EXIT_DONE)
        return code;
    kernels->count = request.count;
    for (size_t i = 0; i < kernels->count; i++)
        kernels->kernel[i] = &kernels->object[i].kernel;
    instruction_set_prefer(plan->scenario->scene, kernels->kernel, kernels->count);
    return code;
}

void kernels_change(struct kernels *kernels)
{
    objects_later_take(kernels->later, kernels->object);
    objects_later_free(kernels->later);
    kernels->later = NULL;
}

/* ---- what run would do ---------------------------------------------------------------------- */

struct kernels_outlook kernels_look(struct kernels *kernels, const struct plan *plan)
{
    const struct parallel alone = parallel_alone();
    const struct kernels_choice choice = {.quiet = true, .looks = true};
    const stance_scene *const scene = plan->scenario->scene;
    const int n = scene->coordinates;
    struct kernels_outlook outlook = {0, 1, true};
    stance_message ignored;
    const enum exit_code code = kernels_take(kernels, plan, &choice, &alone, &ignored);
    outlook.brief = kernels->brief;
    for (size_t i = 0; code == EXIT_DONE && i < kernels->count; i++)
        if (kernels->object[i].origin == OBJECT_MISSING) {
            /* About how long a compiler takes, s, and what compiled kernels take of the time of
             * those that are built in: by acrobot, cart-pole, rolling disc, compass, hopper,
             * RABBIT, flat feet and walker2d on one machine, by midpoint and capturing. */
            outlook.compiling += 3 + 0.25 * n * n + 1.3 * scene->contacts;
            outlook.share = 0.03 + 0.01 * (n + scene->contacts);
        }
    return outlook;
}

void kernels_give_back(struct kernels *kernels)
{
    instruction_set_prefer(NULL, NULL, 0);
    objects_later_free(kernels->later);
    kernels->later = NULL;
    objects_release(kernels->object, kernels->count);
    kernels->count = 0;
}
