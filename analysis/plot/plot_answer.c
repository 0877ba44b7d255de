/* plot_answer.c - the answers that `stance plot --answer` draws: their names, units and numbers. */
#include "analysis/draw/plot.h"
#include "runner/base/message.h"
#include "runner/store/store.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Not those that are codes: a map of outcomes is drawn anyway. */
const char *plot_answer_word(size_t k)
{
    for (size_t a = 0; a < STANCE_ANSWER_COUNT; a++)
        if (!stance_answers[a].word && k-- == 0)
            return stance_answers[a].name;
    return NULL;
}

bool plot_answer_find(const char *name, struct plot_answer *answer)
{
    size_t k = 0;
    while (k < STANCE_ANSWER_COUNT && strcmp(stance_answers[k].name, name) != 0)
        k++;
    if (k < STANCE_ANSWER_COUNT)
        *answer = (struct plot_answer){
            name, strcmp(stance_answers[k].unit, "1") == 0 ? "" : stance_answers[k].unit,
            stance_answers[k].text, RESULTS_KIND_COUNT};
    return k < STANCE_ANSWER_COUNT;
}

double *plot_answer_numbers(const struct plot *plot, const struct plot_answer *answer,
                            struct plot_range *range)
{
    const struct results *r = plot->r;
    const bool all = answer->of == RESULTS_KIND_COUNT;
    uint64_t inferred;
    bool *which; /* cases without numbers, whatever stands in the file */
    double *values = NULL;
    if (!statistics_inferred(r, &inferred, &which, plot->message))
        return NULL;
    const bool good = results_answer(r, answer->name, &values, plot->message);
    for (uint64_t i = 0; values && i < r->cases; i++)
        if (!(all || r->kind[i] == answer->of) || (which && which[i]))
            values[i] = NAN;
    free(which);
    if (!good || (values && plot_range_of(range, values, r->cases)))
        return values;
    complain(plot->message, "%.200s: no%s%s case has a number %s", r->file, all ? "" : " ",
             all ? "" : results_kind_names[answer->of], answer->name);
    free(values);
    return NULL;
}

void plot_answer_text(const struct plot_answer *answer, char *text, size_t size)
{
    const bool all = answer->of == RESULTS_KIND_COUNT;
    snprintf(text, size, "%s: %s%s%s%s", answer->name, answer->text, all ? "" : ", of the ",
             all ? "" : results_kind_names[answer->of], all ? "" : " cases");
}
