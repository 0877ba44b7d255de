/* report.c - cases, dimensions, designs, file size and cost of a plan. */
#include "report.h"

#include "runner/base/units.h"
#include "runner/base/words.h"
#include "runner/plan/kernels.h"
#include "runner/plan/refine.h"
#include "runner/plan/search_numbers.h"
#include "runner/store/store.h"

#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct estimate {
    size_t designs_failed;
    uint64_t size;
    double seconds; /* on one rank; negative: no case can be tried, NAN: these take too long */
    bool bound;
    double compiling; /* s that run needs first, for kernels that it compiles; 0: it does not */
    double searching; /* s on one rank that a search takes, as `seconds` */
    uint64_t coarse;  /* points of the coarse lattice; 0: the map is not refined */
    double probes;    /* expected number beyond these */
};

/* With the kernels that will compute, as far as they are there. */
static void measure(const struct plan *plan, struct estimate *e)
{
    struct kernels *const kernels = calloc(1, sizeof *kernels);
    struct kernels_outlook outlook = {0, 1, true};
    if (kernels)
        outlook = kernels_look(kernels, plan);
    const double share = outlook.brief ? 1 : outlook.share;
    const double all = plan_cost(plan, PLAN_PATIENCE_COST, &e->bound);
    e->seconds = all * share * (double)plan_share(plan).count / (double)plan->rows;
    e->seconds += all >= 0 ? plan->design_seconds : 0;
    e->compiling = outlook.brief ? 0 : outlook.compiling;
    if (plan->scenario->search.given) /* a search always compiles */
        e->searching =
            all * outlook.share * scenario_search_cases(plan->scenario) / (double)plan->rows +
            outlook.compiling;
    if (kernels)
        kernels_give_back(kernels);
    free(kernels);
}

static struct estimate estimate(const struct plan *plan, int ranks)
{
    struct estimate e = {.size = store_size(plan, ranks)};
    for (size_t d = 0; d < plan->designs; d++)
        e.designs_failed += plan->design_status[d] == STANCE_FAILED;
    measure(plan, &e);
    if (plan->scenario->refine.given && !plan->single) {
        const struct refine_map map = refine_map_of(plan->scenario);
        e.coarse = refine_coarse(&map);
        e.probes = map.probes * (double)(plan->rows - e.coarse);
        e.bound = true;
    }
    return e;
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

static json_t *factor_json(const struct scenario_axis *axis, const struct scenario_factor *f)
{
    json_t *paths = json_array();
    char text[400];
    for (int k = 0; k < f->paths; k++)
        json_array_append_new(paths, json_string(axis->path[f->first + k]));
    factor_text(axis, f, text, sizeof text);
    return json_pack("{s:o, s:s}", "paths", paths, "range", text);
}

static json_t *sample_json(const struct plan *plan)
{
    const struct scenario *s = plan->scenario;
    const struct doe *design = &s->sample.design;
    if (!s->sample.given || plan->single)
        return json_null();
    json_t *factors = json_array();
    for (size_t j = 0; j < design->factors; j++)
        json_array_append_new(factors, factor_json(&s->axis[s->axes - 1], &s->sample.factor[j]));
    return json_pack("{s:s, s:I, s:I, s:I, s:o}", "method", doe_words[design->method], "count",
                     (json_int_t)design->count, "block", (json_int_t)doe_block(design), "points",
                     (json_int_t)doe_points(design), "factors", factors);
}

static void report_sample(const struct scenario *s, FILE *out)
{
    static const char *const blocks[] = {[DOE_SALTELLI] = "blocks", [DOE_MORRIS] = "trajectories"};
    const struct doe *design = &s->sample.design;
    const struct scenario_axis *axis = &s->axis[s->axes - 1];
    const uint64_t block = doe_block(design);

    fprintf(out, "  %-32s %8zu  points, %s: ", axis->name, axis->count, doe_words[design->method]);
    if (block > 1) {
        fprintf(out, "%" PRIu64 " %s of %" PRIu64 ", ", design->count, blocks[design->method],
                block);
    }
    fprintf(out, "%zu factor%s\n", design->factors, design->factors == 1 ? "" : "s");
    for (size_t j = 0; j < design->factors; j++) {
        const struct scenario_factor *f = &s->sample.factor[j];
        char text[400];
        factor_text(axis, f, text, sizeof text);
        fprintf(out, "    ");
        int used = 0;
        for (int k = 0; k < f->paths; k++)
            used += fprintf(out, "%s%s", k ? ", " : "", axis->path[f->first + k]);
        fprintf(out, "%*s  %s\n", used < 39 ? 39 - used : 0, "", text);
    }
}

static void report_json(const struct plan *plan, const struct estimate *e, int ranks,
                        const char *file, FILE *out)
{
    const struct scenario *s = plan->scenario;
    json_t *dimensions = json_array();
    for (int a = 0; !plan->single && a < s->axes; a++) {
        json_array_append_new(dimensions, json_pack("{s:s, s:I}", "name", s->axis[a].name, "count",
                                                    (json_int_t)s->axis[a].count));
    }
    if (plan->single || s->axes == 0)
        json_array_append_new(dimensions, json_pack("{s:s, s:i}", "name", "case", "count", 1));
    json_t *root = json_pack(
        "{s:s, s:s, s:s, s:I, s:o, s:I, s:I, s:I, s:I, s:s, s:I, s:i, s:o, s:b, s:f, s:o, "
        "s:o}",
        "scenario", s->file, "title", s->title, "scene", s->scene->name, "cases",
        (json_int_t)plan->rows, "dimensions", dimensions, "designs", (json_int_t)plan->designs,
        "designs_computed", (json_int_t)(plan->designs - plan->pending), "designs_failed",
        (json_int_t)e->designs_failed, "recorded_cases", (json_int_t)plan->record_cases, "file",
        file, "file_bytes", (json_int_t)e->size, "ranks", ranks, "seconds_on_one_rank",
        e->seconds >= 0 ? json_real(e->seconds) : json_null(), "seconds_is_upper_bound", e->bound,
        "compile_seconds", e->compiling, "refine",
        e->coarse ? json_pack("{s:I, s:I, s:I}", "coarse_cases", (json_int_t)e->coarse, "probes",
                              (json_int_t)llround(e->probes), "most_cases", (json_int_t)plan->rows)
                  : json_null(),
        "sample", sample_json(plan));
    json_dumpf(root, out, JSON_INDENT(2));
    fputc('\n', out);
    json_decref(root);
}

static void report_designs(const struct plan *plan, const struct estimate *e, FILE *out)
{
    const size_t computed = plan->designs - plan->pending;
    const stance_law *const law = scenario_law(&plan->scenario->base);
    if (!law->designed && plan->designs == 1) {
        fprintf(out, "controller  %s", law->name);
        return;
    }
    fprintf(out, "%s %zu distinct", law->designed ? "designs    " : "equilibria ", plan->designs);
    if (plan->pending == 0) {
        if (e->designs_failed > 0)
            fprintf(out, ", of which %zu do not exist: their cases will fail", e->designs_failed);
        return;
    }
    fprintf(out, ", %zu of them computed: ", computed);
    if (e->designs_failed == 0)
        fputs("all exist", out);
    else if (e->designs_failed == computed)
        fputs("none exists", out);
    else
        fprintf(out, "%zu do not exist and their cases will fail", e->designs_failed);
    fprintf(out, "\nunchecked   the other %zu and the initial states of their cases",
            plan->pending);
}

static void report_axis(const struct scenario_axis *axis, FILE *out)
{
    char first[64], last[64];
    size_t ends[2];
    const bool sorted =
        scenario_ends(axis->words ? NULL : axis->value, axis->count, (size_t)axis->paths, ends);
    scenario_axis_text(axis, ends[0], 0, first, sizeof first);
    scenario_axis_text(axis, ends[1], 0, last, sizeof last);
    fprintf(out, "  %-32s %8zu  %s ... %s %s%s\n", axis->name, axis->count, first, last,
            axis->words || strcmp(axis->unit, "1") == 0 ? "" : axis->unit,
            sorted ? "" : " (not sorted)");
}

/* What becomes of a sample time that is no whole number of steps, where neither is swept. */
static void report_step(const struct scenario *s, FILE *out)
{
    const double interval = s->base.sample_time, step = s->base.step;
    const double pieces = fmax(1, ceil(interval / step - 1e-9));
    int k;
    if (s->base.law == 0 || !(interval > 0) || fabs(interval / pieces - step) <= 1e-9 * step ||
        scenario_axis_of(s, offsetof(struct scenario_values, sample_time), &k) ||
        scenario_axis_of(s, offsetof(struct scenario_values, step), &k))
        return;
    fprintf(out,
            "\nstep        %.9g s: a sample of %.9g s is cut into %.0f step%s of at most %.9g s",
            interval / pieces, interval, pieces, pieces > 1 ? "s" : "", step);
}

/* One digit: that is all that is known. */
static double round_roughly(double x)
{
    const double unit = pow(10, floor(log10(x)));
    return round(x / unit) * unit;
}

static void report_text(const struct plan *plan, const struct estimate *e, int ranks,
                        const char *file, FILE *out)
{
    const struct scenario *s = plan->scenario;
    char text[40];

    fprintf(out, "%s\nscene %s, %" PRIu64 " case%s", s->title[0] ? s->title : s->name,
            s->scene->name, plan->rows, plan->rows == 1 ? "" : "s");
    for (int a = 0; !plan->single && a < s->axes; a++)
        fprintf(out, "%s%zu", a ? " x " : ": ", s->axis[a].count);
    fputc('\n', out);
    for (int a = 0; !plan->single && a < s->axes; a++)
        if (s->axis[a].sample)
            report_sample(s, out);
        else
            report_axis(&s->axis[a], out);
    if (plan->shard.count > 0) {
        fprintf(out, "shard       %" PRIu64 "/%" PRIu64 ", %" PRIu64 " cases\n", plan->shard.number,
                plan->shard.count, plan_share(plan).count);
    }
    report_designs(plan, e, out);
    report_step(s, out);
    if (plan->record_cases > 0) {
        fprintf(out, "\nrecorded    %" PRIu64 " trajectories of %" PRId64 " instants",
                plan->record_cases, plan->record_rows);
    }
    if (e->coarse > 0) {
        fprintf(out,
                "\nrefine      %" PRIu64 " cases of a coarse lattice and about %.0f probes, then "
                "those where outcomes differ: at most all",
                e->coarse, e->probes);
    }
    text_of_bytes(text, sizeof text, (double)e->size);
    fprintf(out, "\nfile        %s, about %s\n", file, text);
    if (e->compiling > 0) {
        text_of_seconds(text, sizeof text, round_roughly(e->compiling));
        fprintf(out, "compiling   about %s first, once for robots of this structure\n", text);
    }
    if (!(e->seconds >= 0)) {
        fprintf(out, "cost        unknown: %s\n",
                isnan(e->seconds) ? "the cases tried take too long to tell"
                                  : "none of the cases tried can be computed");
        return;
    }
    if (e->coarse > 0) {
        const double share = ((double)e->coarse + e->probes) / (double)plan->rows;
        char first[40];
        text_of_seconds(first, sizeof first, share * e->seconds / ranks);
        text_of_seconds(text, sizeof text, e->seconds / ranks);
        fprintf(out, "cost        about %s for lattice and probes, %s for all, on %d rank%s\n",
                first, text, ranks, ranks == 1 ? "" : "s");
        return;
    }
    text_of_seconds(text, sizeof text, e->seconds / ranks);
    fprintf(out, "cost        %s %s on %d rank%s%s\n", e->bound ? "at most about" : "about", text,
            ranks, ranks == 1 ? "" : "s",
            e->compiling > 0 ? ", with the kernel that run compiles for this robot first" : "");
}

/* What stance optimise makes of the scenario. */
static void report_search(const struct scenario *s, const struct estimate *e, int ranks, FILE *out)
{
    char text[40] = "";
    if (!s->search.given)
        return;
    if (e->seconds >= 0)
        text_of_seconds(text, sizeof text, e->searching / ranks);
    fprintf(out,
            "optimise    %d numbers, %" PRIu64 " candidates from %" PRIu64 " to %" PRIu64
            " starts, %" PRIu64 " fresh ones%s%s: stance optimise %s\n",
            search_numbers(s), s->search.candidates, s->search.grow[0],
            s->search.grow[s->search.stages - 1], s->search.confirm,
            !text[0]   ? ""
            : e->bound ? "; at most about "
                       : "; at first guess ",
            text, s->file);
}

/* A file or a time that hardly anybody wants. */
static void warn_of_size(const struct plan *plan, const struct estimate *e, int ranks,
                         const char *file, const char *who)
{
    const double much = 1e11, long_time = 30 * 86400; /* bytes, s */
    stance_message full = {""};
    char size[40], text[40];
    text_of_bytes(size, sizeof size, (double)e->size);
    const bool fits = store_fits(file, e->size, 0, &full);
    if (!fits)
        fprintf(stderr, "%s: warning: %s\n", who, full.text);
    else if ((double)e->size > much)
        fprintf(stderr,
                "%s: warning: the file takes about %s: record.answers and record.cases choose "
                "what it holds, sweep.refine and sweep.sample take fewer cases\n",
                who, size);
    if (e->seconds / ranks > long_time && e->coarse == 0) {
        text_of_seconds(text, sizeof text, e->seconds / ranks);
        fprintf(stderr,
                "%s: warning: %" PRIu64 " cases take %s %s on %d rank%s: sweep.refine "
                "and sweep.sample take fewer\n",
                who, plan->rows, e->bound ? "at most" : "about", text, ranks, ranks > 1 ? "s" : "");
    }
}

void report_plan(const struct plan *plan, int ranks, const char *file, bool json, const char *who,
                 FILE *out)
{
    struct estimate e = estimate(plan, ranks);
    if (json)
        report_json(plan, &e, ranks, file, out);
    else
        report_text(plan, &e, ranks, file, out);
    if (!json)
        report_search(plan->scenario, &e, ranks, out);
    fflush(out);
    warn_of_size(plan, &e, ranks, file, who);
}
