/* page_data.c - what a page holds of a results file. */
#include "page_data.h"

#include "analysis/draw/gnuplot.h"
#include "analysis/statistics/statistics.h"
#include "analysis/table/table.h"
#include "runner/base/message.h"
#include "runner/objects/program.h"
#include "runner/plan/plan.h"
#include "runner/store/build_info.h"
#include "runner/store/results.h"

#include "runner/base/command.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_LISTED = 100, ROWS = 4096 };

struct page {
    FILE *out, *more; /* see page_data_write */
    const struct results *r;
    const struct page_request *request;
    struct scenario *scenario; /* whose cases are the file's; NULL: there is none */
    struct plan plan;
    json_t *head, *blocks, *left_out;
    double bytes; /* of answers so far */
    stance_message *message;
};

static bool put_block(struct page *p, const char *name, const char *type, const void *numbers,
                      size_t count)
{
    return page_block(p->more, p->blocks, name, type, numbers, count, NULL) ||
           no_memory(p->message);
}

/* ---- axes --------------------------------------------------------------------------------- */

/* Of an axis, or of what is varied. */
static void add_values(json_t *list, json_t *object, json_t *words, const struct results_axis *axis)
{
    json_t *const values = json_array();
    for (size_t i = 0; i < axis->count; i++)
        table_append(values, as_number(axis->value[i]));
    table_put(object, "words", as_tree(words));
    table_put(object, "values", as_tree(values));
    json_array_append_new(list, object);
}

static void put_axes(struct page *p)
{
    const struct results *const r = p->r;
    json_t *const axes = json_array(), *const varied = json_array();
    for (int k = 0; k < r->axes && !r->single; k++) {
        const struct results_axis *const a = &r->axis[k];
        add_values(axes,
                   TABLE_OBJECT({"path", as_text(a->name)}, {"unit", as_text(a->unit)},
                                {"text", as_text(a->text)}, {"count", as_whole(a->count)},
                                {"offset", as_truth(a->offset)}),
                   table_list((const char *const *)a->word, a->count), a);
    }
    for (int k = 0; k < r->varied; k++) {
        const struct results_varied *const v = &r->vary[k];
        json_t *const words = v->word ? json_array() : NULL;
        for (int i = 0; v->word && i < v->words; i++)
            table_append(words, as_text(v->word[i]));
        add_values(varied,
                   TABLE_OBJECT({"path", as_text(v->of.name)}, {"unit", as_text(v->of.unit)},
                                {"text", as_text(v->of.text)},
                                {"factor", as_whole((uint64_t)v->factor)}),
                   words, &v->of);
    }
    table_put(p->head, "axes", as_tree(axes));
    table_put(p->head, "varied", as_tree(varied));
    table_put(p->head, "sample", as_tree(json_integer(r->single ? -1 : r->sample)));
}

/* ---- what the engine needs ---------------------------------------------------------------- */

/* The numbers of each axis as the file has them: those of logarithmic ranges and of samples do not
 * follow from the scenario to the last bit everywhere. */
static bool put_axis_values(struct page *p)
{
    struct scenario *const s = p->scenario;
    bool good = true;
    for (int a = 0; a < s->axes && good && !p->r->single; a++) {
        struct scenario_axis *const axis = &s->axis[a];
        const size_t count = axis->count * (size_t)axis->paths;
        char name[32];
        double *const value = malloc(count * sizeof *value);
        good = (value || no_memory(p->message)) && store_read_axes(p->r->file, axis, 1, p->message);
        for (size_t i = 0; good && i < count; i++)
            value[i] =
                scenario_axis_value(axis, i / (size_t)axis->paths, (int)(i % (size_t)axis->paths));
        snprintf(name, sizeof name, "axis-%d", a);
        good = good && put_block(p, name, "f64", value, count);
        free(value);
    }
    return good;
}

static bool put_designs(struct page *p)
{
    struct plan *const plan = &p->plan;
    struct plan_error error;
    struct store *store = NULL;
    if (!plan_make(plan, p->scenario, p->r->single, p->r->index, false, &error)) {
        *p->message = error.message;
        return false;
    }
    bool good = store_open_to_read(&store, p->r->file, plan, p->message) &&
                store_read_designs(store, plan, p->message);
    if (store)
        store_abandon(store);
    table_put(p->head, "designs",
              as_tree(TABLE_OBJECT({"count", as_whole(plan->designs)},
                                   {"numbers", as_whole(plan->design_size)})));
    return good &&
           put_block(p, "designs", "f64", plan->design, plan->designs * plan->design_size) &&
           put_block(p, "design-status", "u8", plan->design_status, plan->designs);
}

/* Which answers a case's checksum covers, a bit each. */
static bool put_stored(struct page *p)
{
    uint64_t stored = 0;
    for (int a = 0; a <= SCENARIO_FINAL_STATE; a++) {
        const char *const name = a < SCENARIO_FINAL_STATE ? stance_answers[a].name : "final_state";
        struct results_column column;
        if (!results_column_open(p->r, name, &column, p->message))
            return false;
        stored |= (uint64_t)(column.id >= 0) << a;
        results_column_close(&column);
    }
    table_put(p->head, "stored", as_whole(stored));
    return true;
}

/* A law of the user's own, for the page; false: there is no clang that compiles it, which is said,
 * and the page shows what the file holds. */
static bool put_law(struct page *p)
{
    const struct law_file *const law = &p->scenario->law;
    const struct program_text text = {
        .file = law->name, .source = law->source, .data = law->data, .count = law->data_count};
    struct image image;
    stance_message why;
    if (!law->source)
        return true;
    if (!program_for_page(&text, p->scenario->scene, &image, &why)) {
        fprintf(stderr,
                "stance view: the page shows what is in the file and simulates nothing: %s\n",
                why.text);
        return false;
    }
    const bool good = put_block(p, "law", "u8", image.bytes, image.size);
    image_free(&image);
    return good;
}

/* Nothing of this where the scenario cannot be read: then the page shows what the file holds. */
static bool put_engine(struct page *p)
{
    char *const wire = page_wire(p->r->scenario);
    if (wire && (p->r->single || results_swept(p->r, p->message)))
        p->scenario = p->r->read;
    table_put(p->head, "wire", as_text(p->scenario ? wire : NULL));
    free(wire);
    if (!p->scenario)
        return true;
    const stance_scene *const scene = p->scenario->scene;
    size_t size;
    const stance_kernel *const kernel = stance_kernel_find(scene, stance_methods()[0], NULL);
    const uint8_t *const engine = put_law(p) ? page_engine(kernel->structure, &size) : NULL;
    if (engine)
        page_base64(p->more, "engine", engine, size);
    table_put(p->head, "engine", as_truth(engine != NULL));
    return put_stored(p) && put_axis_values(p) && put_designs(p);
}

/* ---- cases -------------------------------------------------------------------------------- */

static bool put_checksums(struct page *p)
{
    const size_t cases = (size_t)p->r->cases;
    struct results_column column;
    uint32_t *const crc = calloc(cases, sizeof *crc);
    double *const rows = malloc(ROWS * sizeof *rows);
    if (!crc || !rows || !results_column_open(p->r, "checksum", &column, p->message)) {
        free(crc);
        free(rows);
        return no_memory(p->message);
    }
    const bool there = column.id >= 0;
    bool good = true;
    for (size_t at = 0; there && good && at < cases; at += ROWS) {
        const size_t n = cases - at < ROWS ? cases - at : ROWS;
        good = results_column_read(p->r, &column, at, n, rows, p->message);
        for (size_t i = 0; good && i < n; i++)
            crc[at + i] = p->r->kind[at + i] == RESULTS_PENDING ? 0 : (uint32_t)rows[i];
    }
    results_column_close(&column);
    free(rows);
    table_put(p->head, "checksums", as_truth(there));
    good = good && (!there || put_block(p, "checksum", "u32", crc, cases));
    free(crc);
    return good;
}

/* NULL: it has none. */
static json_t *answer_words(const struct page *p, int answer)
{
    const char *word[STANCE_MAX_WORDS];
    if (answer == STANCE_ANSWER_fall_cause && !p->scenario)
        return NULL;
    const int words = stance_answer_words(p->scenario ? p->scenario->scene : NULL, answer, word);
    return table_list(words ? word : NULL, (size_t)words);
}

/* The numbers of one answer: codes as bytes, others in single precision, which is what a picture
 * needs; how exact a case is again says its checksum. */
static bool put_answer(struct page *p, int answer, json_t *list)
{
    const stance_answer *const a = &stance_answers[answer];
    const size_t cases = (size_t)p->r->cases;
    double *value;
    char name[64];
    size_t bytes = 0;
    if (!results_answer(p->r, a->name, &value, p->message))
        return false;
    if (!value)
        return true;
    json_t *const words = answer_words(p, answer);
    const bool code = words != NULL;
    bool asked = p->request->whole || code;
    for (size_t i = 0; i < p->request->answers; i++)
        asked |= strcmp(p->request->answer[i], a->name) == 0;
    const bool carried = asked || (p->request->answers == 0 && p->bytes < PAGE_BYTES);
    void *const numbers = malloc(cases * (code ? 1 : sizeof(float)));
    bool good = numbers != NULL || no_memory(p->message);
    for (size_t i = 0; good && i < cases; i++)
        if (code)
            ((uint8_t *)numbers)[i] = isnan(value[i]) ? 0 : (uint8_t)value[i];
        else
            ((float *)numbers)[i] = (float)value[i];
    free(value);
    snprintf(name, sizeof name, "answer-%s", a->name);
    good = good &&
           (!carried ||
            page_block(p->more, p->blocks, name, code ? "u8" : "f32", numbers, cases, &bytes) ||
            no_memory(p->message));
    free(numbers);
    p->bytes += asked ? 0 : (double)bytes;
    const char *const type = code ? "code" : a->type == STANCE_DOUBLE ? "number" : "count";
    json_array_append_new(list, TABLE_OBJECT({"name", as_text(a->name)}, {"unit", as_text(a->unit)},
                                             {"text", as_text(a->text)}, {"type", as_text(type)},
                                             {"words", as_tree(words)},
                                             {"block", as_text(carried ? name : NULL)}));
    if (!carried)
        table_append(p->left_out, as_text(a->name));
    return good;
}

/* Where a run went on with another scenario: which one each case is of. */
static bool put_scenario_numbers(struct page *p)
{
    const size_t cases = (size_t)p->r->cases;
    struct ancestry ancestry;
    double *value = NULL;
    if (!ancestry_read(p->r, &ancestry, p->message))
        return false;
    const int last = (int)ancestry.scenarios - 1;
    table_put(p->head, "number", as_tree(json_integer(last > 0 ? last : -1)));
    if (last <= 0)
        return true;
    if (!results_answer(p->r, "scenario_number", &value, p->message))
        return false;
    uint8_t *const number = malloc(cases);
    for (size_t i = 0; number && i < cases; i++)
        number[i] = isnan(value[i]) ? (uint8_t)last : (uint8_t)value[i];
    free(value);
    const bool good = number ? put_block(p, "number", "u8", number, cases) : no_memory(p->message);
    free(number);
    return good;
}

/* A code of each case that the map is drawn from. */
static bool put_drawn(struct page *p, const char *name, const void *code)
{
    return page_block(p->out, p->blocks, name, "u8", code, (size_t)p->r->cases, NULL) ||
           no_memory(p->message);
}

static bool put_cases(struct page *p)
{
    uint64_t count;
    bool *inferred;
    if (!statistics_inferred(p->r, &count, &inferred, p->message))
        return false;
    bool good = put_drawn(p, "kind", p->r->kind) &&
                (!inferred || put_drawn(p, "inferred", inferred)) && put_checksums(p) &&
                put_scenario_numbers(p);
    free(inferred);
    json_t *const list = json_array();
    for (int a = 0; good && a < STANCE_ANSWER_COUNT; a++)
        good = put_answer(p, a, list);
    json_object_set_new(p->head, "answers", list);
    return good;
}

/* ---- the head ----------------------------------------------------------------------------- */

/* Makes the head. */
static bool put_provenance(struct page *p)
{
    const struct results *const r = p->r;
    uint64_t *recorded;
    size_t count;
    json_t *const kinds = json_array(), *const list = json_array();
    for (int k = 0; k < RESULTS_KIND_COUNT; k++) {
        char colour[8];
        gnuplot_kind_colour(results_kind_names[k], colour);
        json_array_append_new(kinds, TABLE_OBJECT({"name", as_text(results_kind_names[k])},
                                                  {"colour", as_text(colour)}));
    }
    const bool good = results_recorded(r, &recorded, &count, p->message);
    for (size_t i = 0; good && i < count && i < MOST_LISTED; i++)
        table_append(list, as_whole(recorded[i]));
    if (good)
        free(recorded);
    p->head = TABLE_OBJECT(
        {"format", as_whole(1)}, {"program", as_text(STANCE_VERSION)},
        {"revision", as_text(build_revision)}, {"file_program", as_text(r->version)},
        {"file_revision", as_text(r->revision)}, {"file", as_text(r->name)},
        {"command_file", as_text(p->request->file)}, {"title", as_text(r->title)},
        {"date", as_text(r->date)}, {"scenario", as_text(r->scenario)},
        {"cases", as_whole(r->cases)}, {"single", as_truth(r->single)},
        {"index", as_whole(r->index)}, {"kinds", as_tree(kinds)}, {"recorded", as_tree(list)});
    return good;
}

bool page_data_write(FILE *out, FILE *more, const struct results *r,
                     const struct page_request *request, stance_message *message)
{
    struct page *const p = calloc(1, sizeof *p); /* large */
    if (!p)
        return no_memory(message);
    *p = (struct page){.out = out, .more = more, .r = r, .request = request, .message = message};
    p->blocks = json_object(), p->left_out = json_array();
    json_t *const charts = page_charts(r, message);
    const bool good = charts && put_provenance(p) && put_engine(p) && put_cases(p);
    json_object_set_new(p->head, "charts", charts ? charts : json_array());
    if (good) {
        put_axes(p);
        json_object_set(p->head, "blocks", p->blocks);
        json_object_set(p->head, "left_out", p->left_out);
        page_json(out, "head", p->head);
    }
    json_decref(p->head), json_decref(p->blocks), json_decref(p->left_out);
    plan_free(&p->plan);
    free(p);
    return good;
}

bool page_search_write(FILE *out, const char *file, stance_message *message)
{
    char title[256];
    json_t *const charts = page_search_charts(file, title, message);
    const char *const slash = strrchr(file, '/');
    if (!charts)
        return false;
    json_t *const head =
        TABLE_OBJECT({"format", as_whole(1)}, {"program", as_text(STANCE_VERSION)},
                     {"revision", as_text(build_revision)}, {"title", as_text(title)},
                     {"file", as_text(slash ? slash + 1 : file)}, {"cases", as_whole(0)},
                     {"charts", as_tree(charts)});
    page_json(out, "head", head);
    json_decref(head);
    return true;
}
