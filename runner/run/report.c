/* report.c - cases, dimensions, designs, file size and cost of a plan. */
#include "run.h"

#include "runner/base/checksum.h"
#include "runner/base/say.h"
#include "runner/base/units.h"
#include "runner/base/words.h"
#include "runner/plan/kernels.h"
#include "runner/plan/law.h"
#include "runner/plan/refine.h"
#include "runner/store/store.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What is said of a plan. */
struct estimate {
    const struct plan *plan;
    const char *file; /* where the results would go */
    int ranks;
    size_t designs_failed;
    uint64_t size;
    double seconds; /* on one rank; negative: no case can be tried, NAN: these take too long */
    bool bound;
    double compiling; /* s that a compiler takes while others compute; 0: none does */
    double searching; /* s on one rank that a search takes, as `seconds` */
    uint64_t coarse;  /* points of the coarse lattice; 0: the map is not refined */
    double probes;    /* expected number beyond these */
};

/* With the kernels that will compute, as far as they are there. */
static void measure(struct estimate *e)
{
    const struct plan *const plan = e->plan;
    struct kernels kernels = {.count = 0};
    e->seconds = e->searching = -1;
    if (!plan_simulates(plan))
        return;
    const struct kernels_outlook outlook = kernels_look(&kernels, plan);
    const double share = outlook.brief ? 1 : outlook.share;
    const double all = plan_cost(plan, PLAN_PATIENCE_COST, &e->bound);
    e->seconds = all * share * (double)plan_share(plan).count / (double)plan->rows;
    e->seconds += all >= 0 ? plan->design_seconds : 0;
    e->compiling = outlook.brief ? 0 : outlook.compiling;
    if (plan->scenario->search.given) /* a search always compiles */
        e->searching =
            all * outlook.share * scenario_search_cases(plan->scenario) / (double)plan->rows +
            outlook.compiling;
    kernels_give_back(&kernels);
    if (plan->scenario->refine.given && !plan->single) {
        const struct refine_map map = refine_map_of(plan->scenario);
        e->coarse = refine_coarse(&map);
        e->probes = map.probes * (double)(plan->rows - e->coarse);
        e->bound = true;
    }
}

/* "[0.1, 1.5] ... [2, 3] kg", "a, b, c": where a factor leads; the units are those of its first
 * path. */
static void factor_text(const struct scenario_axis *axis, const struct scenario_factor *f,
                        char *text, size_t size)
{
    enum { SHOWN = 4 };
    const struct scenario_axis listed = {.paths = f->paths,
                                         .count = f->points,
                                         .value = f->value,
                                         .meaning = axis->meaning + f->first};
    text[0] = '\0';
    for (size_t i = 0; i < f->points; i++) {
        if (i == SHOWN) {
            words_add(text, size, ", ... (%zu values)", f->points);
            break;
        }
        words_add(text, size, "%s%s",
                  i == 0      ? ""
                  : f->listed ? ", "
                              : " ... ",
                  f->paths > 1 ? "[" : "");
        for (int k = 0; k < f->paths; k++) {
            char value[64];
            scenario_axis_text(&listed, i, k, value, sizeof value);
            words_add(text, size, "%s%s", k ? ", " : "", value);
        }
        words_add(text, size, "%s", f->paths > 1 ? "]" : "");
    }
    if (f->paths == 1 && !listed.meaning[0].words && strcmp(listed.meaning[0].unit, "1") != 0)
        words_add(text, size, " %s", listed.meaning[0].unit);
    if (f->log)
        words_add(text, size, ", log");
}

static json_t *sample_json(const struct plan *plan)
{
    const struct scenario *s = plan->scenario;
    const struct doe *design = &s->sample.design;
    if (!s->sample.given || plan->single)
        return json_null();
    json_t *factors = json_array();
    const struct scenario_axis *axis = &s->axis[s->axes - 1];
    for (size_t j = 0; j < design->factors; j++) {
        const struct scenario_factor *f = &s->sample.factor[j];
        json_t *paths = json_array();
        char text[400];
        for (int k = 0; k < f->paths; k++)
            json_array_append_new(paths, json_string(axis->path[f->first + k]));
        factor_text(axis, f, text, sizeof text);
        json_t *const factor = json_pack("{s:o, s:s}", "paths", paths, "range", text);
        for (int k = 0; k < f->paths; k++)
            say_add(factor, ".paths", "%s%s", k ? ", " : "", axis->path[f->first + k]);
        json_array_append_new(factors, factor);
    }
    return json_pack("{s:s, s:I, s:I, s:I, s:o, s:I}", "method", doe_words[design->method], "count",
                     (json_int_t)design->count, "block", (json_int_t)doe_block(design), "points",
                     (json_int_t)doe_points(design), "factors", factors, ".factors",
                     (json_int_t)design->factors);
}

/* A law of the user's own, which a stranger's scenario may bring. */
static json_t *law_json(const struct scenario *s)
{
    char hash[CHECKSUM_SHA256_TEXT], begin[13];
    if (!s->law.source)
        return json_null();
    const bool trusted = law_is_trusted(s, hash);
    snprintf(begin, sizeof begin, "%.12s", hash);
    return json_pack("{s:s, s:s, s:b, s:s}", "file", s->law.name, "sha256", hash, "trusted",
                     trusted, ".begin", begin);
}

static json_t *dimensions_json(const struct plan *plan)
{
    const struct scenario *s = plan->scenario;
    json_t *dimensions = json_array();
    for (int a = 0; !plan->single && a < s->axes; a++) {
        const struct scenario_axis *const axis = &s->axis[a];
        json_t *const one = json_pack("{s:s, s:I, s:b}", "name", axis->name, "count",
                                      (json_int_t)axis->count, ".axis", true);
        if (!axis->sample) {
            char first[64], last[64];
            size_t ends[2];
            const bool sorted = scenario_ends(axis->words ? NULL : axis->value, axis->count,
                                              (size_t)axis->paths, ends);
            scenario_axis_text(axis, ends[0], 0, first, sizeof first);
            scenario_axis_text(axis, ends[1], 0, last, sizeof last);
            say_add(one, ".range", "%s ... %s %s%s", first, last,
                    axis->words || strcmp(axis->unit, "1") == 0 ? "" : axis->unit,
                    sorted ? "" : " (not sorted)");
        }
        json_array_append_new(dimensions, one);
    }
    if (json_array_size(dimensions) == 0)
        json_array_append_new(dimensions, json_pack("{s:s, s:i}", "name", "case", "count", 1));
    return dimensions;
}

/* What becomes of a sample time that is no whole number of steps, where neither is swept. */
static void add_step(json_t *facts, const struct scenario *s)
{
    const double interval = s->base.sample_time, step = s->base.step;
    const double pieces = fmax(1, ceil(interval / step - 1e-9));
    int k;
    if (s->base.law == 0 || !(interval > 0) || fabs(interval / pieces - step) <= 1e-9 * step ||
        scenario_axis_of(s, offsetof(struct scenario_values, sample_time), &k) ||
        scenario_axis_of(s, offsetof(struct scenario_values, step), &k))
        return;
    say_add(facts, ".step", "%.9g s: a sample of %.9g s is cut into %.0f step%s of at most %.9g s",
            interval / pieces, interval, pieces, pieces > 1 ? "s" : "", step);
}

/* What stance optimise makes of the scenario. */
static void add_search(json_t *facts, const struct estimate *e)
{
    const struct scenario_search *const search = &e->plan->scenario->search;
    char text[40];
    if (!search->given)
        return;
    text_of_seconds(text, sizeof text, e->searching / e->ranks);
    say_add(facts, ".search",
            "%d numbers, %" PRIu64 " candidates from %" PRIu64 " to %" PRIu64 " starts, %" PRIu64
            " fresh ones",
            search_numbers(e->plan->scenario), search->candidates, search->grow[0],
            search->grow[search->stages - 1], search->confirm);
    if (e->seconds >= 0)
        say_add(facts, ".search", "; %s %s", e->bound ? "at most about" : "at first guess", text);
}

static void add_cost(json_t *facts, const struct estimate *e)
{
    const double share = ((double)e->coarse + e->probes) / (double)e->plan->rows;
    char text[40], first[40];
    text_of_seconds(text, sizeof text, e->seconds / e->ranks);
    text_of_seconds(first, sizeof first, share * e->seconds / e->ranks);
    if (!plan_simulates(e->plan))
        say_add(facts, ".cost", "unknown: nothing is run by a law that is not trusted");
    else if (!(e->seconds >= 0))
        say_add(facts, ".cost", "unknown: %s",
                isnan(e->seconds) ? "the cases tried take too long to tell"
                                  : "none of the cases tried can be computed");
    else if (e->coarse > 0)
        say_add(facts, ".cost", "about %s for lattice and probes, %s for all, on %d rank%s", first,
                text, e->ranks, e->ranks == 1 ? "" : "s");
    else
        say_add(facts, ".cost", "%s %s on %d rank%s%s", e->bound ? "at most about" : "about", text,
                e->ranks, e->ranks == 1 ? "" : "s",
                e->compiling > 0 ? ", with the kernel that run compiles for this robot" : "");
    if (e->compiling > 0) {
        const double unit = pow(10, floor(log10(e->compiling))); /* more is not known */
        text_of_seconds(text, sizeof text, round(e->compiling / unit) * unit);
        say_add(facts, ".compiling", "%s", text);
    }
}

static json_t *facts_of(const struct estimate *e)
{
    const struct plan *const plan = e->plan;
    const struct scenario *s = plan->scenario;
    const stance_law *const law = scenario_law(&s->base);
    const size_t computed = plan->designs - plan->pending;
    char size[40], shard[SHARD_TEXT];
    text_of_bytes(size, sizeof size, (double)e->size);
    shard_text(&plan->shard, shard);
    json_t *facts = json_pack(
        "{s:o, s:s, s:s, s:I, s:o, s:I, s:I, s:I, s:I, s:o, s:I, s:i, s:o, s:b, s:f, s:o, "
        "s:o, s:o}",
        "scenario", json_string_nocheck(s->file), "title", s->title, "scene", s->scene->name,
        "cases", (json_int_t)plan->rows, "dimensions", dimensions_json(plan), "designs",
        (json_int_t)plan->designs, "designs_computed", (json_int_t)computed, "designs_failed",
        (json_int_t)e->designs_failed, "recorded_cases", (json_int_t)plan->record_cases, "file",
        json_string_nocheck(e->file), "file_bytes", (json_int_t)e->size, "ranks", e->ranks,
        "seconds_on_one_rank", e->seconds >= 0 ? json_real(e->seconds) : json_null(),
        "seconds_is_upper_bound", e->bound, "compile_seconds", e->compiling, "refine",
        e->coarse ? json_pack("{s:I, s:I, s:I}", "coarse_cases", (json_int_t)e->coarse, "probes",
                              (json_int_t)llround(e->probes), "most_cases", (json_int_t)plan->rows)
                  : json_null(),
        "sample", sample_json(plan), "law", law_json(s));
    json_t *const more =
        json_pack("{s:o, s:s*, s:b, s:b, s:I, s:I, s:I, s:s, s:s, s:b}", ".name",
                  json_string_nocheck(s->title[0] ? s->title : s->name), ".shard",
                  plan->shard.count > 0 ? shard : NULL, ".axes", !plan->single && s->axes > 0,
                  ".designed", law->designed, ".share", (json_int_t)plan_share(plan).count,
                  ".pending", (json_int_t)plan->pending, ".instants", (json_int_t)plan->record_rows,
                  ".size", size, ".law", law->name, ".alone", !law->designed && plan->designs == 1);
    json_object_update_new(facts, more);
    json_object_set_new(facts, ".some_failed",
                        json_boolean(e->designs_failed > 0 && e->designs_failed < computed));
    add_step(facts, s);
    add_cost(facts, e);
    add_search(facts, e);
    return facts;
}

static const char report_text[] =
    "{.name}\nscene {scene}, {cases} case{cases#s}"
    "[.axes:: [dimensions* x :{count}]\n"
    "[dimensions*:  {name%-32s} {count%8d}  [.range:{.range}|points, {sample/method}: "
    "[sample/block>1:{sample/count} [sample/method=morris:trajectories|blocks] of {sample/block}, ]"
    "{sample/.factors} factor{sample/.factors#s}"
    "[sample/factors*:\n    {.paths%-39s}  {range}]]\n]|\n]"
    "[.shard:shard       {.shard}, {.share} cases\n]"
    "[.alone:controller  {.law}|[.designed:designs    |equilibria ] {designs} distinct"
    "[.pending:, {designs_computed} of them computed: "
    "[.some_failed:{designs_failed} do not exist and their cases will fail"
    "|[designs_failed:none exists|all exist]]\n"
    "unchecked   the other {.pending} and the initial states of their cases"
    "|[designs_failed:, of which {designs_failed} do not exist: their cases will fail]]]"
    "[law:\nlaw         {file}, C code, SHA-256 {.begin}...: "
    "[trusted:trusted|not trusted yet, `run` asks for --trust]]"
    "[.step:\nstep        {.step}]"
    "[recorded_cases:\nrecorded    {recorded_cases} trajectories of {.instants} instants]"
    "[refine:\nrefine      {coarse_cases} cases of a coarse lattice and about {probes} probes, "
    "then those where outcomes differ: at most all]"
    "\nfile        {file}, about {.size}\n"
    "[.compiling:compiling   about {.compiling}, once for robots of this structure; till then "
    "kernels that are built in compute\n]"
    "cost        {.cost}\n"
    "[.search:optimise    {.search}: stance optimise {scenario}\n]";

/* A file or a time that hardly anybody wants. */
static void warn_of_size(const struct estimate *e, const char *who)
{
    const double much = 1e11, long_time = 30 * 86400; /* bytes, s */
    stance_message full = {""};
    char text[40];
    if (!store_fits(e->file, e->size, 0, &full)) {
        fprintf(stderr, "%s: warning: %s\n", who, full.text);
    } else if ((double)e->size > much) {
        text_of_bytes(text, sizeof text, (double)e->size);
        fprintf(stderr,
                "%s: warning: the file takes about %s: record.answers and record.cases choose "
                "what it holds, sweep.refine and sweep.sample take fewer cases\n",
                who, text);
    }
    if (e->seconds / e->ranks > long_time && e->coarse == 0) {
        text_of_seconds(text, sizeof text, e->seconds / e->ranks);
        fprintf(stderr,
                "%s: warning: %" PRIu64 " cases take %s %s on %d rank%s: sweep.refine "
                "and sweep.sample take fewer\n",
                who, e->plan->rows, e->bound ? "at most" : "about", text, e->ranks,
                e->ranks > 1 ? "s" : "");
    }
}

void report_plan(const struct plan *plan, int ranks, const char *file, bool json, const char *who)
{
    struct estimate e = {
        .plan = plan, .file = file, .ranks = ranks, .size = store_size(plan, ranks)};
    for (size_t d = 0; d < plan->designs; d++)
        e.designs_failed += plan->design_status[d] == STANCE_FAILED;
    measure(&e);
    say_facts(facts_of(&e), json, report_text, stdout);
    fflush(stdout);
    warn_of_size(&e, who);
}
