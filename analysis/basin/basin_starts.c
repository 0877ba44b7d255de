/* basin_starts.c - see basin_starts.h. */
#include "basin_starts.h"

#include "runner/base/message.h"
#include "runner/plan/instruction_set.h"

#include <stdlib.h>
#include <string.h>

uint8_t starts_outcome(enum results_kind kind)
{
    static const uint8_t outcome[RESULTS_OUTCOMES] = {
#define STARTS_OUTCOME(NAME, name, number, text) [RESULTS_##NAME] = STANCE_##NAME,
        STANCE_OUTCOMES(STARTS_OUTCOME)
#undef STARTS_OUTCOME
    };
    return outcome[kind];
}

bool starts_begin(struct starts *starts, const struct scenario *s, uint64_t index,
                  stance_message *message)
{
    *starts =
        (struct starts){.s = s, .index = index, .tell = starts->tell, .context = starts->context};
    scenario_case_values(s, index, &starts->values);
    starts->values.offset_scale = 1;
    if (instruction_set())
        starts->kernel = instruction_set_kernel(s->scene, stance_methods()[starts->values.method]);
    if (!starts->kernel)
        return complain(message, "this version has no method %s for the scene %s",
                        stance_methods()[starts->values.method]->name, s->scene->name);
    return resolve_design(s->scene, &starts->values, &starts->design, message);
}

/* Makes the case of a start; false: there is none. */
static bool place(struct starts *starts, const double *x, stance_case *out)
{
    for (int f = 0; f < starts->fields; f++) {
        const struct starts_field *const field = &starts->field[f];
        const double value = field->centre + field->along * x[field->axis];
        memcpy((char *)&starts->values + field->offset, &value, sizeof value);
    }
    return resolve_case(starts->s, &starts->values, &starts->design, starts->index, out,
                        &starts->why);
}

bool starts_possible(struct starts *starts, const double *x)
{
    stance_case *out = malloc(sizeof *out);
    const bool good = out && place(starts, x, out);
    free(out);
    return good;
}

/* Cases at hand, and how many of them are done. */
struct array {
    const struct starts *starts;
    const stance_case *cases;
    stance_result *results;
    size_t next, count;
    uint64_t done;
};

static bool array_next(void *context, const stance_case **c, stance_result **result)
{
    struct array *const a = context;
    if (a->next == a->count)
        return false;
    *c = &a->cases[a->next];
    *result = &a->results[a->next++];
    return true;
}

static void array_done(void *context, const stance_case *c, stance_result *result)
{
    struct array *const a = context;
    (void)c, (void)result;
    a->done++;
}

static bool array_tell(void *context)
{
    const struct array *const a = context;
    if (a->starts->tell)
        a->starts->tell(a->starts->context, a->starts->simulated + a->done);
    return false;
}

bool starts_run(void *context, size_t count, const double *x, uint8_t *end)
{
    struct starts *const starts = context;
    stance_case *cases = calloc(count + 1, sizeof *cases);
    stance_result *results = calloc(count + 1, sizeof *results);
    const bool good = cases && results;
    size_t possible = 0;
    for (size_t i = 0; good && i < count; i++) {
        const bool made = place(starts, x + i * (size_t)starts->axes, &cases[possible]);
        end[i] = made ? STANCE_NONE : STARTS_IMPOSSIBLE;
        possible += made;
    }
    if (good && possible > 0)
        starts->kernel->stream(
            &(stance_feed){&(struct array){starts, cases, results, 0, possible, 0}, array_next,
                           array_done, array_tell});
    for (size_t i = 0, k = 0; good && i < count; i++) {
        if (end[i] == STARTS_IMPOSSIBLE)
            continue;
        const bool failed = results[k].status != STANCE_DONE;
        starts->failed += failed;
        end[i] = failed ? STARTS_FAILED : results[k].outcome;
        k++;
    }
    starts->simulated += possible;
    free(cases);
    free(results);
    return good;
}
