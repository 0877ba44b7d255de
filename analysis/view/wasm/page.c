/* page.c - opens scenarios, runs cases, refines maps: all for a page. */
#include "page.h"

#include "runner/base/checksum.h"
#include "runner/base/message.h"
#include "runner/plan/refine.h"
#include "runner/store/results.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_SETS = 64 };

struct page page;

EXPORTED(void *, alloc, size_t bytes)
{
    return malloc(bytes > 0 ? bytes : 1);
}

EXPORTED(void, release, void *memory)
{
    free(memory);
}

EXPORTED(const char *, message, void)
{
    return page.message.text;
}

/* ---- scenarios ---------------------------------------------------------------------------- */

static bool begins(const char *text, const char *with)
{
    return strncmp(text, with, strlen(with)) == 0;
}

/* The first complaint without where it is: "page:1:1: TEXT", "page: TEXT", "--set SET: TEXT". */
static const char *plain(char *complaint, const char *const *sets, size_t count)
{
    complaint[strcspn(complaint, "\n")] = '\0';
    for (size_t i = 0; i < count; i++) {
        const size_t length = strlen(sets[i]);
        if (begins(complaint, "--set ") && begins(complaint + 6, sets[i]) &&
            begins(complaint + 6 + length, ": "))
            return complaint + 6 + length + 2;
    }
    const char *const text = strstr(complaint, ": ");
    return begins(complaint, "page:") && text ? text + 2 : complaint;
}

/* Reads a text, with sets; false with the reader's first complaint. */
static bool read_scenario(struct scenario *s, const char *text, const char *const *sets,
                          size_t count)
{
    char *complaint = NULL;
    size_t length = 0;
    FILE *const errors = open_memstream(&complaint, &length);
    if (!errors)
        return no_memory(&page.message);
    const bool good = scenario_read(s, "page", text, sets, count, errors);
    fclose(errors);
    if (!good)
        complain(&page.message, "%.230s", plain(complaint, sets, count));
    free(complaint);
    return good;
}

static void close_view(void)
{
    plan_free(&page.view_plan);
    scenario_free(&page.view);
}

static bool open_plan(struct plan *plan, const struct scenario *s, bool single, uint64_t index)
{
    struct plan_error error;
    if (plan_make(plan, s, single, index, false, &error))
        return true;
    page.message = error.message;
    return false;
}

EXPORTED(int, file_open, const char *wire, double single)
{
    close_view();
    page_designs_forget();
    plan_free(&page.file_plan);
    scenario_free(&page.file);
    free(page.wire);
    page.wire = strdup(wire);
    page.stored = UINT64_MAX;
    page.number = -1;
    if (!page.wire)
        return no_memory(&page.message);
    return read_scenario(&page.file, wire, NULL, 0) &&
           open_plan(&page.file_plan, &page.file, single >= 0, single < 0 ? 0 : (uint64_t)single);
}

/* Numbers of an axis, one after the other, take the place of what it computes. */
static bool give_values(struct scenario_axis *axis, const double *value)
{
    const size_t numbers = axis->count * (size_t)axis->paths;
    double *const own = malloc(numbers * sizeof *own);
    if (!own)
        return no_memory(&page.message);
    memcpy(own, value, numbers * sizeof *own);
    free(axis->value);
    axis->value = own;
    return true;
}

EXPORTED(int, file_axis, int axis, const double *value, size_t numbers)
{
    struct scenario_axis *const own = &page.file.axis[axis];
    if (axis < 0 || axis >= page.file.axes || numbers != own->count * (size_t)own->paths)
        return complain(&page.message, "the page's axes are not those of its scenario");
    return give_values(own, value);
}

EXPORTED(int, file_designs, const double *number, const uint8_t *status, size_t count)
{
    struct plan *const plan = &page.file_plan;
    if (count != plan->designs)
        return complain(&page.message, "the page's designs are not those of its scenario");
    memcpy(plan->design, number, count * plan->design_size * sizeof *number);
    memcpy(plan->design_status, status, count);
    return 1;
}

EXPORTED(void, file_stored, double answers, int number)
{
    page.stored = (uint64_t)answers;
    page.number = number;
}

EXPORTED(int, view_open, const char *sets)
{
    const char *set[MOST_SETS];
    size_t count = 0;
    const char *text = sets;
    close_view();
    page.message.text[0] = '\0';
    page.resweeps = false;
    for (; *text; text += strlen(text) + 1) {
        if (count == MOST_SETS)
            return complain(&page.message, "more than %d changes", MOST_SETS);
        page.resweeps |= begins(text, "sweep");
        set[count++] = text;
    }
    page.changed = count > 0;
    if (!read_scenario(&page.view, page.wire, set, count) || !page_take_law(&page.view))
        return 0;
    for (int a = 0; !page.resweeps && a < page.view.axes; a++)
        if (page.file.axis[a].value && page.file.axis[a].count == page.view.axis[a].count &&
            !give_values(&page.view.axis[a], page.file.axis[a].value))
            return 0;
    return open_plan(&page.view_plan, &page.view, page.file_plan.single && !page.resweeps,
                     page.file_plan.single_case) &&
           schema_build(&page.schema, page.view.scene, &page.view.law, false) &&
           (page_design(0) || !page.message.text[0]);
}

EXPORTED(double, view_cases, void)
{
    return (double)page.view_plan.rows;
}

/* ---- cases -------------------------------------------------------------------------------- */

bool page_case(double index, stance_case *out, const stance_kernel **kernel)
{
    int method = 0;
    page.message.text[0] = '\0';
    if (!(index >= 0 && index < (double)page.view_plan.rows))
        return complain(&page.message, "there is no case %.0f", index);
    const uint64_t row = (uint64_t)index;
    if (!page_design(plan_design(&page.view_plan, plan_case(&page.view_plan, row))) ||
        !plan_resolve(&page.view_plan, row, out, &method))
        return false;
    *kernel = stance_kernel_find(page.view.scene, stance_methods()[method], NULL);
    return *kernel || complain(&page.message, "a page cannot simulate by %s, stance does",
                               stance_methods()[method]->name);
}

void page_fail(stance_result *result)
{
    stance_result_clear(result);
    result->status = STANCE_FAILED;
    result->failure = STANCE_FAILURE_INITIAL;
}

void page_simulated(stance_result *result)
{
    if (result->status == STANCE_DONE)
        result->evidence = STANCE_SIMULATED;
}

uint8_t page_kind(const stance_result *result)
{
    static const uint8_t kinds[] = {
#define OUTCOME_KIND(NAME, name, number, text) [number] = RESULTS_##NAME,
        [STANCE_NONE] = RESULTS_DONE, STANCE_OUTCOMES(OUTCOME_KIND)};
    return result->status == STANCE_FAILED ? RESULTS_FAILED : kinds[result->outcome];
}

void page_answers(const stance_result *result, double *answer)
{
    for (int a = 0; a < STANCE_ANSWER_COUNT; a++)
        answer[a] = stance_answer_of(result, a);
}

uint32_t page_checksum(const stance_result *result)
{
    const size_t n = (size_t)page.view.scene->coordinates;
    const uint8_t number = (uint8_t)page.number, status = (uint8_t)result->status;
    uint32_t crc = 0;
    for (int a = 0; a < STANCE_ANSWER_COUNT; a++)
        if (page.stored >> a & 1)
            crc = checksum_crc32c(crc, (const char *)result + stance_answers[a].offset,
                                  stance_answers[a].size);
    if (page.stored >> SCENARIO_FINAL_STATE & 1) {
        crc = checksum_crc32c(crc, result->position, n * sizeof *result->position);
        crc = checksum_crc32c(crc, result->velocity, n * sizeof *result->velocity);
    }
    if (page.number >= 0)
        crc = checksum_crc32c(crc, &number, sizeof number);
    return checksum_crc32c(crc, &status, sizeof status);
}

/* Cases by their numbers, each resolved when a lane is free. Those of one stream have one kernel:
 * where methods are swept, a case of another ends the stream and begins the next. */
enum { STREAM_CASES = 64 };
struct stream_of_cases {
    const double *index;
    int n, next;
    const stance_kernel *kernel;
    bool ready, broken; /* `ahead` is resolved, but of another kernel; cannot go on */
    stance_case ahead;
    const stance_kernel *ahead_kernel;
    stance_case input[STREAM_CASES];
    stance_result output[STREAM_CASES];
    int place[STREAM_CASES]; /* which case; -1: free */
    uint8_t *kind;
    uint32_t *checksum;
    double *answer;
};

static void put_result(struct stream_of_cases *s, int i, stance_result *result)
{
    page_simulated(result);
    s->kind[i] = page_kind(result);
    s->checksum[i] = page_checksum(result);
    page_answers(result, &s->answer[(size_t)i * STANCE_ANSWER_COUNT]);
}

/* Resolves up to the next case that exists. */
static bool look_ahead(struct stream_of_cases *s)
{
    for (; !s->ready && s->next < s->n; s->next++) {
        if (page_case(s->index[s->next], &s->ahead, &s->ahead_kernel)) {
            s->ready = true;
            return true;
        }
        if (page.message.text[0]) {
            s->broken = true;
            return false;
        }
        stance_result failed;
        page_fail(&failed);
        put_result(s, s->next, &failed);
    }
    return s->ready;
}

static bool next_case(void *context, const stance_case **c, stance_result **result)
{
    struct stream_of_cases *const s = context;
    int slot = 0;
    if (!look_ahead(s) || s->ahead_kernel != s->kernel)
        return false;
    while (s->place[slot] >= 0)
        slot++;
    s->input[slot] = s->ahead;
    s->place[slot] = s->next++;
    s->ready = false;
    *c = &s->input[slot];
    *result = &s->output[slot];
    return true;
}

static void case_done(void *context, const stance_case *c, stance_result *result)
{
    struct stream_of_cases *const s = context;
    const ptrdiff_t slot = c - s->input;
    put_result(s, s->place[slot], result);
    s->place[slot] = -1;
}

EXPORTED(int, run, const double *index, int n, uint8_t *kind, uint32_t *checksum, double *answer)
{
    static struct stream_of_cases s; /* large */
    s.index = index, s.n = n, s.next = 0;
    s.kind = kind, s.checksum = checksum, s.answer = answer;
    s.ready = s.broken = false;
    for (int slot = 0; slot < STREAM_CASES; slot++)
        s.place[slot] = -1;
    const stance_feed feed = {&s, next_case, case_done, NULL};
    while (look_ahead(&s)) {
        s.kernel = s.ahead_kernel;
        s.kernel->stream(&feed);
    }
    return s.broken ? 0 : n;
}

EXPORTED(int, answer_count, void)
{
    return STANCE_ANSWER_COUNT;
}

/* ---- maps --------------------------------------------------------------------------------- */

static struct refine *refining;
static uint64_t *asked;
static size_t asked_room;

EXPORTED(int, refine_begin, int start, int margin)
{
    struct refine_map map = refine_map_of(&page.view);
    refine_free(refining);
    refining = NULL;
    map.start = start < 2 ? 2 : (size_t)start;
    map.margin = margin < 0 ? 0 : (size_t)margin;
    map.probes = 0;
    for (int a = 0; a < map.axes; a++)
        map.refined[a] = map.count[a] > map.start && !page.view.axis[a].sample;
    if (!((double)page.view.cases <= SCENARIO_MOST_REFINED))
        return complain(&page.message, "the map has more than %g points", SCENARIO_MOST_REFINED);
    refining = refine_make(&map);
    return refining ? 1 : no_memory(&page.message);
}

EXPORTED(int, refine_ask, double *index, int room)
{
    if (asked_room < (size_t)room) {
        free(asked);
        asked = malloc((size_t)room * sizeof *asked);
        asked_room = asked ? (size_t)room : 0;
    }
    const size_t n = asked ? refine_next(refining, asked, (size_t)room) : 0;
    for (size_t i = 0; i < n; i++)
        index[i] = (double)asked[i];
    return (int)n;
}

/* Kinds as labels: outcomes come in another order. */
static int label_of(uint8_t kind)
{
    static const int label[] = {
#define OUTCOME_LABEL(NAME, name, number, text) [RESULTS_##NAME] = (number) + 1,
        STANCE_OUTCOMES(OUTCOME_LABEL)};
    return kind < sizeof label / sizeof *label ? label[kind] : REFINE_FAILED;
}

EXPORTED(void, refine_tell, const double *index, const uint8_t *kind, int n)
{
    for (int i = 0; i < n; i++)
        refine_set(refining, (uint64_t)index[i], label_of(kind[i]));
}

EXPORTED(int, refine_end, uint8_t *kind, uint8_t *inferred)
{
    refine_infer(refining);
    for (uint64_t row = 0; row < page.view.cases; row++) {
        const int label = refine_label(refining, row);
        kind[row] = RESULTS_FAILED;
        for (int k = 0; k < RESULTS_OUTCOMES; k++)
            if (label_of((uint8_t)k) == label)
                kind[row] = (uint8_t)k;
        inferred[row] = refine_inferred(refining, row);
    }
    return 1;
}
