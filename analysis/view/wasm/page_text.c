/* page_text.c - what the engine tells a page in words: JSON (RFC 8259). */
#include "page.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- text that grows; without memory it ends where it was ----------------------------------- */

void text_begin(struct text *text)
{
    free(text->bytes);
    text->bytes = NULL;
    text->out = open_memstream(&text->bytes, &text->length);
}

static void add_string(FILE *out, const char *string)
{
    putc('"', out);
    for (const char *s = string; *s; s++)
        fprintf(out, (unsigned char)*s < ' ' || *s == '"' || *s == '\\' ? "\\u%04x" : "%c",
                (unsigned)(unsigned char)*s);
    putc('"', out);
}

/* Whether nothing stands before what is added next, but what opens it. */
static bool is_first(struct text *text)
{
    fflush(text->out);
    return text->length == 0 || strchr("[{", text->bytes[text->length - 1]);
}

void text_json(struct text *text, const char *format, ...)
{
    FILE *const out = text->out;
    va_list arguments;
    va_start(arguments, format);
    for (; out && *format; format++) {
        if (*format == '$') {
            add_string(out, va_arg(arguments, const char *));
        } else if (*format == '#') {
            const double number = va_arg(arguments, double);
            fprintf(out, isfinite(number) ? "%.17g" : "null", number);
        } else if (*format == '&') {
            fprintf(out, "%llu", va_arg(arguments, unsigned long long));
        } else if (*format == '?') {
            fputs(va_arg(arguments, int) ? "true" : "false", out);
        } else if (*format != '~' || !is_first(text)) {
            putc(*format == '~' ? ',' : *format == '\'' ? '"' : *format, out);
        }
    }
    va_end(arguments);
}

const char *text_done(struct text *text)
{
    if (text->out)
        fclose(text->out);
    return text->bytes ? text->bytes : "";
}

static void add_words(struct text *text, const char *const *word, size_t words)
{
    text_json(text, words ? ",'words':[" : ",'words':null");
    for (size_t i = 0; i < words; i++)
        text_json(text, "~$", word[i]);
    text_json(text, words ? "]" : "");
}

/* ---- fields that may be changed ----------------------------------------------------------- */

/* The value of item i of a field. */
static void add_value(struct text *text, const struct scenario_field *field,
                      const struct scenario_values *values, size_t i)
{
    const double number = schema_number(field, values, i);
    if (field->type == FIELD_NUMBER && isinf(number) && field->words)
        text_json(text, "$", field->words[0]);
    else if (field->type == FIELD_WORD && number >= 0 && number < (double)field->word_count)
        text_json(text, "$", field->words[(size_t)number]);
    else
        text_json(text, "#", number);
}

/* Calls `tell` with each item of each field that may be changed: with its path. */
static void each_field(struct text *text, const struct scenario_values *values,
                       void (*tell)(struct text *, const struct scenario_field *,
                                    const struct scenario_values *, const char *, size_t))
{
    for (size_t k = 0; k < page.schema.count; k++) {
        const struct scenario_field *const field = &page.schema.field[k];
        const bool number = field->type == FIELD_NUMBER || field->type == FIELD_INTEGER;
        if (!field->sweep || field->offset == NO_OFFSET ||
            !schema_allows(field->use, field->law, &page.view.base) ||
            (!number && field->type != FIELD_WORD))
            continue;
        for (size_t i = 0; i < (strchr(field->path, '[') ? schema_items(field) : 1); i++) {
            char path[128];
            tell(text, field, values, schema_item_path(field, i, path), i);
        }
    }
}

static void tell_field(struct text *text, const struct scenario_field *field,
                       const struct scenario_values *values, const char *path, size_t item)
{
    const size_t size = field->type == FIELD_NUMBER ? sizeof(double) : sizeof(int);
    int k;
    const bool swept = scenario_axis_of(&page.view, field->offset + item * size, &k) != NULL;
    text_json(text, "~{'path':$,'text':$,'unit':$,'type':$,'value':", path, field->text,
              field->unit,
              field->type == FIELD_WORD                      ? "word"
              : field->type == FIELD_INTEGER || field->whole ? "integer"
                                                             : "number");
    add_value(text, field, values, item);
    text_json(text, ",'low':#,'high':#,'lowOpen':?,'highOpen':?,'design':?,'swept':?", field->low,
              field->high, field->low_open, field->high_open, field->design, swept);
    add_words(text, field->words, field->words ? field->word_count : 0);
    text_json(text, "}");
}

static void tell_value(struct text *text, const struct scenario_field *field,
                       const struct scenario_values *values, const char *path, size_t item)
{
    text_json(text, "~$:", path);
    add_value(text, field, values, item);
}

/* ---- the texts ---------------------------------------------------------------------------- */

/* Contacts with the ground come first, then the stops of joints. */
static void add_bodies(struct text *text, const stance_scene *scene)
{
    text_json(text, ",'coordinates':[");
    for (int i = 0; i < scene->coordinates; i++)
        text_json(text, "~{'name':$,'unit':$}", scene->coordinate[i].name,
                  scene->coordinate[i].unit);
    text_json(text, "],'actuators':[");
    for (int a = 0; a < scene->actuators; a++) {
        const bool turns = strcmp(scene->coordinate[scene->actuated[a]].unit, "rad") == 0;
        text_json(text, "~{'name':$,'unit':$}", scene->actuator_name[a], turns ? "N m" : "N");
    }
    text_json(text, "],'contacts':[");
    for (int c = 0; c < scene->contacts && scene->grip[c] >= 0; c++)
        text_json(text, "~$", scene->contact_name[c]);
    text_json(text, "]");
}

static void add_axes(struct text *text, const struct scenario *s)
{
    text_json(text, ",'axes':[");
    for (int a = 0; a < s->axes; a++) {
        const struct scenario_axis *const axis = &s->axis[a];
        text_json(text, "~{'count':#,'sample':?,'paths':[", (double)axis->count, axis->sample);
        for (int k = 0; k < axis->paths; k++)
            text_json(text, "~$", axis->path[k]);
        text_json(text, "]}");
    }
    text_json(text, "]");
}

EXPORTED(const char *, view_text, void)
{
    static struct text text;
    const struct scenario *const s = &page.view;
    const stance_law *const law = scenario_law(&s->base);
    text_begin(&text);
    text_json(&text,
              "{'scene':$,'title':$,'method':$,'law':$,'designed':?,'seed':&,'step':#,"
              "'stop_time':#,'slope':#,'cases':#",
              s->scene->name, s->title, stance_methods()[s->base.method]->name, law->name,
              law->designed && s->base.design != DESIGN_GAINS, (unsigned long long)s->seed,
              s->base.step, s->base.stop_time, s->base.robot[STANCE_ROBOT_SLOPE],
              (double)page.view_plan.rows);
    add_bodies(&text, s->scene);
    add_axes(&text, s);
    text_json(&text, ",'fields':[");
    each_field(&text, &s->base, tell_field);
    text_json(&text, "]}");
    return text_done(&text);
}

EXPORTED(const char *, answers_text, void)
{
    static struct text text;
    text_begin(&text);
    text_json(&text, "[");
    for (int a = 0; a < STANCE_ANSWER_COUNT; a++) {
        const stance_answer *const answer = &stance_answers[a];
        const char *word[STANCE_MAX_WORDS];
        const int words = stance_answer_words(page.file.scene, a, word);
        text_json(&text, "~{'name':$,'unit':$,'text':$,'type':$", answer->name, answer->unit,
                  answer->text,
                  words                           ? "code"
                  : answer->type == STANCE_DOUBLE ? "number"
                                                  : "count");
        add_words(&text, word, (size_t)words);
        text_json(&text, "}");
    }
    text_json(&text, "]");
    return text_done(&text);
}

EXPORTED(const char *, case_values, double index)
{
    static struct text text;
    struct scenario_values values;
    text_begin(&text);
    text_json(&text, "{");
    if (index >= 0 && index < (double)page.view_plan.rows) {
        scenario_case_values(&page.view, plan_case(&page.view_plan, (uint64_t)index), &values);
        each_field(&text, &values, tell_value);
    }
    text_json(&text, "}");
    return text_done(&text);
}
