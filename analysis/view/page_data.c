/* page_data.c - what a page holds of a results file. */
#include "page_data.h"
#include "page_charts.h"
#include "page_template.h"

#include "analysis/statistics/statistics.h"
#include "runner/base/message.h"
#include "runner/plan/plan.h"
#include "runner/store/ancestry.h"
#include "runner/store/build_info.h"
#include "runner/store/results_rows.h"

#include "runner/base/command.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_LISTED = 100, ROWS = 4096 };

struct page {
    FILE *out, *more; /* see page_data_write */
    const struct results *r;
    const struct page_request *request;
    struct scenario scenario;
    struct plan plan;
    json_t *head, *blocks, *left_out;
    double bytes; /* of answers so far */
    stance_message *message;
};

const char *const page_kind_colour[RESULTS_KIND_COUNT] = {
    [RESULTS_STABILISED] = "#005a92", [RESULTS_RESTED] = "#56b4e9", [RESULTS_FELL] = "#f3bb4c",
    [RESULTS_UNDECIDED] = "#a45288",  [RESULTS_DONE] = "#009e73",   [RESULTS_FAILED] = "#000000",
    [RESULTS_PENDING] = "#e4e4e4",
};

/* NaN and infinities: null. */
static json_t *number_of(double x)
{
    return isfinite(x) ? json_real(x) : json_null();
}

static bool put_block(struct page *p, const char *name, const char *type, const void *numbers,
                      size_t size, size_t count)
{
    return page_block(p->more, p->blocks, name, type, numbers, size, count, SIZE_MAX, NULL) ||
           no_memory(p->message);
}

/* ---- axes --------------------------------------------------------------------------------- */

static json_t *words_of(char **word, size_t count)
{
    json_t *const list = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(list, page_text(word[i]));
    return list;
}

static json_t *values_of(const double *value, size_t count)
{
    json_t *const list = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(list, number_of(value[i]));
    return list;
}

static json_t *axis_of(const struct results_axis *axis)
{
    return json_pack("{s:o,s:o,s:o,s:I,s:b,s:o,s:o}", "path", page_text(axis->name), "unit",
                     page_text(axis->unit), "text", page_text(axis->text), "count",
                     (json_int_t)axis->count, "offset", axis->offset, "words",
                     axis->word ? words_of(axis->word, axis->count) : json_null(), "values",
                     values_of(axis->value, axis->count));
}

static json_t *varied_of(const struct results_varied *v)
{
    json_t *words = json_null();
    if (v->word) {
        words = json_array();
        for (int i = 0; i < v->words; i++)
            json_array_append_new(words, page_text(v->word[i]));
    }
    return json_pack("{s:o,s:o,s:o,s:i,s:o,s:o}", "path", page_text(v->of.name), "unit",
                     page_text(v->of.unit), "text", page_text(v->of.text), "factor", v->factor,
                     "words", words, "values", values_of(v->of.value, v->of.count));
}

static void put_axes(struct page *p)
{
    const struct results *const r = p->r;
    json_t *const axes = json_array(), *const varied = json_array();
    for (int a = 0; a < r->axes && !r->single; a++)
        json_array_append_new(axes, axis_of(&r->axis[a]));
    for (int k = 0; k < r->varied; k++)
        json_array_append_new(varied, varied_of(&r->vary[k]));
    json_object_set_new(p->head, "axes", axes);
    json_object_set_new(p->head, "varied", varied);
    json_object_set_new(p->head, "sample", json_integer(r->single ? -1 : r->sample));
}

/* ---- what the engine needs ---------------------------------------------------------------- */

/* The numbers of each axis as the file has them: those of logarithmic ranges and of samples do not
 * follow from the scenario to the last bit everywhere. */
static bool put_axis_values(struct page *p)
{
    struct scenario *const s = &p->scenario;
    bool good = true;
    for (int a = 0; a < s->axes && good && !p->r->single; a++) {
        struct scenario_axis *const axis = &s->axis[a];
        const size_t count = axis->count * (size_t)axis->paths;
        char name[32];
        double *const value = malloc(count * sizeof *value);
        good = (value || no_memory(p->message)) && store_read_axis(p->r->file, axis, p->message);
        for (size_t i = 0; good && i < count; i++)
            value[i] =
                scenario_axis_value(axis, i / (size_t)axis->paths, (int)(i % (size_t)axis->paths));
        snprintf(name, sizeof name, "axis-%d", a);
        good = good && put_block(p, name, "f64", value, sizeof *value, count);
        free(value);
    }
    return good;
}

static bool put_designs(struct page *p)
{
    struct plan *const plan = &p->plan;
    struct plan_error error;
    struct store *store = NULL;
    if (!plan_make(plan, &p->scenario, p->r->single, p->r->index, false, &error)) {
        *p->message = error.message;
        return false;
    }
    bool good = store_open_to_read(&store, p->r->file, plan, p->message) &&
                store_read_designs(store, plan, p->message);
    if (store)
        store_abandon(store);
    json_object_set_new(p->head, "designs",
                        json_pack("{s:I,s:I}", "count", (json_int_t)plan->designs, "numbers",
                                  (json_int_t)plan->design_size));
    return good &&
           put_block(p, "designs", "f64", plan->design, sizeof *plan->design,
                     plan->designs * plan->design_size) &&
           put_block(p, "design-status", "u8", plan->design_status, 1, plan->designs);
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
    json_object_set_new(p->head, "stored", json_integer((json_int_t)stored));
    return true;
}

/* Nothing of this where the scenario cannot be read: then the page shows what the file holds. */
static bool put_engine(struct page *p)
{
    char *const wire = page_wire(p->r->scenario);
    const bool known = wire && (p->r->single ? results_scenario(p->r, &p->scenario)
                                             : results_swept(p->r, &p->scenario, p->message));
    json_object_set_new(p->head, "wire", known ? page_text(wire) : json_null());
    free(wire);
    if (!known)
        return true;
    const stance_scene *const scene = p->scenario.scene;
    size_t size;
    const stance_kernel *const kernel = stance_kernel_find(scene, stance_methods()[0], NULL);
    const uint8_t *const engine = page_engine(kernel->structure, &size);
    if (engine)
        page_base64(p->more, "engine", engine, size);
    json_object_set_new(p->head, "engine", json_boolean(engine != NULL));
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
    json_object_set_new(p->head, "checksums", json_boolean(there));
    good = good && (!there || put_block(p, "checksum", "u32", crc, sizeof *crc, cases));
    free(crc);
    return good;
}

static bool is_asked(const struct page *p, const char *name)
{
    bool found = p->request->whole;
    for (size_t i = 0; i < p->request->answers; i++)
        found |= strcmp(p->request->answer[i], name) == 0;
    return found;
}

static json_t *answer_words(const struct page *p, int answer)
{
    const char *word[STANCE_MAX_WORDS];
    if (answer == STANCE_ANSWER_fall_cause && !p->scenario.scene)
        return json_null();
    const int words = stance_answer_words(p->scenario.scene, answer, word);
    json_t *const list = words ? json_array() : json_null();
    for (int i = 0; i < words; i++)
        json_array_append_new(list, page_text(word[i]));
    return list;
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
    const bool code = json_is_array(words), asked = is_asked(p, a->name) || code;
    const size_t limit = asked || p->bytes < PAGE_BYTES ? SIZE_MAX : 0;
    void *const numbers = malloc(cases * (code ? 1 : sizeof(float)));
    bool good = numbers != NULL || no_memory(p->message);
    for (size_t i = 0; good && i < cases; i++)
        if (code)
            ((uint8_t *)numbers)[i] = isnan(value[i]) ? 0 : (uint8_t)value[i];
        else
            ((float *)numbers)[i] = (float)value[i];
    free(value);
    snprintf(name, sizeof name, "answer-%s", a->name);
    const bool carried = asked || (p->request->answers == 0 && limit > 0);
    good = good && (!carried ||
                    page_block(p->more, p->blocks, name, code ? "u8" : "f32", numbers,
                               code ? 1 : sizeof(float), cases, limit, &bytes) ||
                    no_memory(p->message));
    free(numbers);
    p->bytes += asked ? 0 : (double)bytes;
    json_array_append_new(list, json_pack("{s:s,s:s,s:s,s:s,s:o,s:o}", "name", a->name, "unit",
                                          a->unit, "text", a->text, "type",
                                          code                       ? "code"
                                          : a->type == STANCE_DOUBLE ? "number"
                                                                     : "count",
                                          "words", words, "block",
                                          carried ? page_text(name) : json_null()));
    if (!carried)
        json_array_append_new(p->left_out, page_text(a->name));
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
    json_object_set_new(p->head, "number", json_integer(last > 0 ? last : -1));
    if (last <= 0)
        return true;
    if (!results_answer(p->r, "scenario_number", &value, p->message))
        return false;
    uint8_t *const number = malloc(cases);
    for (size_t i = 0; number && i < cases; i++)
        number[i] = isnan(value[i]) ? (uint8_t)last : (uint8_t)value[i];
    free(value);
    const bool good =
        number ? put_block(p, "number", "u8", number, 1, cases) : no_memory(p->message);
    free(number);
    return good;
}

/* A code of each case that the map is drawn from. */
static bool put_drawn(struct page *p, const char *name, const void *code)
{
    return page_block(p->out, p->blocks, name, "u8", code, 1, (size_t)p->r->cases, SIZE_MAX,
                      NULL) ||
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

static bool put_provenance(struct page *p)
{
    const struct results *const r = p->r;
    uint64_t *recorded;
    size_t count;
    json_t *const kinds = json_array(), *const list = json_array();
    for (int k = 0; k < RESULTS_KIND_COUNT; k++)
        json_array_append_new(kinds, json_pack("{s:s,s:s}", "name", results_kind_names[k], "colour",
                                               page_kind_colour[k]));
    const bool good = results_recorded(r, &recorded, &count, p->message);
    for (size_t i = 0; good && i < count && i < MOST_LISTED; i++)
        json_array_append_new(list, json_integer((json_int_t)recorded[i]));
    if (good)
        free(recorded);
    json_t *const head = p->head;
    json_object_set_new(head, "format", json_integer(1));
    json_object_set_new(head, "program", page_text(STANCE_VERSION));
    json_object_set_new(head, "revision", page_text(build_revision()));
    json_object_set_new(head, "file_program", page_text(r->version));
    json_object_set_new(head, "file_revision", page_text(r->revision));
    json_object_set_new(head, "file", page_text(r->name));
    json_object_set_new(head, "command_file", page_text(p->request->file));
    json_object_set_new(head, "title", page_text(r->title));
    json_object_set_new(head, "date", page_text(r->date));
    json_object_set_new(head, "scenario", page_text(r->scenario));
    json_object_set_new(head, "cases", json_integer((json_int_t)r->cases));
    json_object_set_new(head, "single", json_boolean(r->single));
    json_object_set_new(head, "index", json_integer((json_int_t)r->index));
    json_object_set_new(head, "kinds", kinds);
    json_object_set_new(head, "recorded", list);
    return good;
}

bool page_data_write(FILE *out, FILE *more, const struct results *r,
                     const struct page_request *request, stance_message *message)
{
    struct page *const p = calloc(1, sizeof *p); /* large */
    if (!p)
        return no_memory(message);
    *p = (struct page){.out = out, .more = more, .r = r, .request = request, .message = message};
    p->head = json_object(), p->blocks = json_object(), p->left_out = json_array();
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
    scenario_free(&p->scenario);
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
        json_pack("{s:i,s:s,s:s,s:o,s:o,s:i,s:o}", "format", 1, "program", STANCE_VERSION,
                  "revision", build_revision(), "title", page_text(title), "file",
                  page_text(slash ? slash + 1 : file), "cases", 0, "charts", charts);
    page_json(out, "head", head);
    json_decref(head);
    return true;
}
