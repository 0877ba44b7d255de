/* answers.c - the tables of stance.h as data. */
#include "stance.h"

#include <math.h>
#include <string.h>

#define NAME(NAME, name, ...) #name,
#define TEXT(NAME, name, text) text,
#define OUTCOME(NAME, name, number, text) [number] = #name,
const char *const stance_outcome_name[] = {"none", STANCE_OUTCOMES(OUTCOME)};
const char *const stance_evidence_name[] = {STANCE_EVIDENCES(NAME)};
const char *const stance_failure_name[] = {STANCE_FAILURES(NAME)};
const char *const stance_failure_text[] = {STANCE_FAILURES(TEXT)};

#define TYPE(type)                                                                                 \
    _Generic((type)0, uint8_t : STANCE_UINT8, int64_t : STANCE_INT64, double : STANCE_DOUBLE)
#define NO_ANSWER(type) _Generic((type)0, double : NAN, int64_t : STANCE_NO_COUNT, default : 0)

const stance_answer stance_answers[] = {
#define ANSWER(name_, type_, how, told, unit_, text_)                                              \
    [STANCE_ANSWER_##name_] = {.name = #name_,                                                     \
                               .unit = unit_,                                                      \
                               .text = text_,                                                      \
                               .type = TYPE(type_),                                                \
                               .size = sizeof(type_),                                              \
                               .offset = offsetof(stance_result, name_)},
    STANCE_ANSWERS(ANSWER)
#undef ANSWER
#define CODE(name_)                                                                                \
    [STANCE_ANSWER_##name_].word = stance_##name_##_name,                                          \
    [STANCE_ANSWER_##name_].words = sizeof stance_##name_##_name / sizeof *stance_##name_##_name
        CODE(outcome),
    CODE(evidence),
    CODE(failure),
};

int stance_answer_words(const stance_scene *scene, int answer, const char **word)
{
    const stance_answer *const a = &stance_answers[answer];
    int count = 0;
    for (; count < a->words; count++)
        word[count] = a->word[count];
    if (answer == STANCE_ANSWER_fall_cause) {
        word[count++] = "none";
        for (int k = 0; k < scene->causes; k++)
            word[count++] = scene->cause[k];
    }
    return count;
}

void stance_result_clear(stance_result *result)
{
    memset(result, 0, sizeof *result);
#define CLEAR(name, type, how, told, unit, text) result->name = NO_ANSWER(type);
    STANCE_ANSWERS(CLEAR)
#undef CLEAR
    for (int i = 0; i < STANCE_MAX_COORDINATES; i++)
        result->position[i] = result->velocity[i] = NAN;
}

double stance_answer_of(const stance_result *result, int answer)
{
    const stance_answer *const a = &stance_answers[answer];
    const char *const at = (const char *)result + a->offset;
    double number;
    int64_t count;
    switch (a->type) {
    case STANCE_UINT8:
        return (uint8_t)*at;
    case STANCE_INT64:
        memcpy(&count, at, sizeof count);
        return count == STANCE_NO_COUNT ? NAN : (double)count;
    default:
        memcpy(&number, at, sizeof number);
        return number;
    }
}
