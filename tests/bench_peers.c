/* bench_peers.c - other simulators on the charts of `stance bench accuracy`.
 *
 * bench_peers [SCENARIO]... [--peer PROGRAM]... [--peer-starts N] [--peer-effort S], and the
 * options of `stance bench accuracy`: each program (tests/peer_NAME) computes the cases of the
 * studies; its accelerations must be ours, its errors are found by the same code, and a sentence
 * says what each method costs for the same error and what error it has for the same cost. `make
 * bench-peers` asks those that are installed.
 *   --peer-starts N   of a map peers compute no more cells than these, evenly spread; 1024
 *   --peer-effort S   settings of peers that would take longer are left out, and a peer that says
 *                     nothing for ten times as long is given up; 60 s
 */
#include "peer_talk.h"

#include "analysis/bench/accuracy.h"
#include "analysis/bench/studies.h"
#include "analysis/draw/gnuplot.h"
#include "runner/base/message.h"

#include <inttypes.h>

enum { PEERS = 4 };
static const double budget = 0.3; /* s per method and step */

/* One method and step; or one setting of a peer. */
struct line {
    struct accuracy_row row;
    const struct peer *peer; /* NULL: ours */
    const char *setting;     /* of a peer: integrator, solver and so on ... */
    bool usual;              /* ... which are its defaults */
    bool front;              /* nothing of the same maker is as cheap and as exact */
};

static const char *programs[PEERS];
static size_t asked, starts = 1024; /* programs; cells of a map */
static double effort = 60;

/* Of the present study. */
static struct accuracy a;
static struct peer peers[PEERS];
static struct line *lines; /* ours first */
static size_t count, cases_asked, *cell;
static stance_case *cases;
static struct scenario scenario;

/* ---- the cases that are asked for --------------------------------------------------------- */

/* Is cell i of a grid whose every stride-th point along each axis after the first is taken? */
static bool is_taken(const struct results *r, size_t i, size_t stride)
{
    for (int axis = r->axes - 1; axis >= 1; axis--) {
        if (i % r->axis[axis].count % stride != stride / 2)
            return false;
        i /= r->axis[axis].count;
    }
    return true;
}

static void choose_cases(const struct results *r, const struct plan *plan)
{
    const size_t n = accuracy_cases(&a, r);
    int method;
    cases = peer_room(n, sizeof *cases);
    cell = peer_room(n, sizeof *cell);
    size_t stride = 1;
    do {
        cases_asked = 0;
        for (size_t i = 0; i < n; i++)
            if (is_taken(r, i, stride))
                cell[cases_asked++] = i;
    } while (cases_asked > starts && ++stride <= n);
    size_t kept = 0;
    for (size_t k = 0; k < cases_asked; k++)
        if (r->kind[a.truth * n + cell[k]] != RESULTS_FAILED &&
            plan_resolve(plan, a.truth * n + cell[k], &cases[kept], &method))
            cell[kept++] = cell[k];
    cases_asked = kept;
}

/* Why nobody is asked; NULL: the talk has words for it. */
static const char *unspeakable(void)
{
    bool alike = true, linear = true;
    for (size_t i = 0; i < cases_asked; i++) {
        const stance_case *const c = &cases[i];
        stance_case as_first = *cases; /* but for the state */
        memcpy(as_first.position, c->position, sizeof c->position);
        memcpy(as_first.velocity, c->velocity, sizeof c->velocity);
        alike &= memcmp(as_first.robot, c->robot, sizeof c->robot) == 0 &&
                 memcmp(&as_first.near, &c->near, sizeof c->near) == 0 &&
                 c->friction == as_first.friction && c->restitution == as_first.restitution &&
                 c->contacts == as_first.contacts && c->torque_limit == as_first.torque_limit &&
                 c->sample_every == as_first.sample_every;
        /* Descriptions, slopes, other gravity are not told. */
        linear &= c->scene == stance_scene_find(c->scene->name) &&
                  c->robot[STANCE_ROBOT_SLOPE] == 0 &&
                  c->robot[STANCE_ROBOT_GRAVITY] == STANCE_GRAVITY;
        linear &= !c->decouples && !c->switches && !c->bends && !c->lands_ahead &&
                  !(c->angle_noise > 0 || c->rate_noise > 0 || c->noise > 0 || c->lag > 0) &&
                  c->delay == 0 && !(c->torque_rate > 0 && isfinite(c->torque_rate));
    }
    return !cases_asked ? "no case that peers could be asked for"
           : !alike     ? "starts that differ in more than their states"
           : !linear    ? "a law or a robot that peers are not told of"
                        : NULL;
}

/* ---- their answers ------------------------------------------------------------------------ */

/* Into *row; a setting's states, case by case, beside those of the truth. */
static bool compare_states(const struct results *r, const struct peer_setting *s, size_t instants,
                           struct accuracy_row *row, stance_message *message)
{
    uint64_t *list;
    size_t recorded;
    const size_t m = (size_t)scenario.scene->coordinates;
    double *const split = peer_room(2 * m * instants, sizeof *split);
    bool good = results_recorded(r, &list, &recorded, message);
    for (size_t i = 0; good && i < cases_asked; i++) {
        const size_t place = a.truth * accuracy_cases(&a, r) + cell[i];
        struct results_trajectory truth;
        const struct results_trajectory other = {.rows = s->rows[i],
                                                 .coordinates = m,
                                                 .position = split,
                                                 .velocity = split + m * instants};
        if (s->kind[i] == RESULTS_FAILED)
            continue;
        if (!(good = results_trajectory(r, place, list[place], &truth, message)))
            break;
        for (size_t k = 0; k < s->rows[i]; k++) {
            const double *const state = s->state + (i * instants + k) * 2 * m;
            memcpy(other.position + k * m, state, m * sizeof *state);
            memcpy(other.velocity + k * m, state + m, m * sizeof *state);
        }
        accuracy_trajectory(&truth, &other, row);
        results_trajectory_free(&truth);
    }
    if (good)
        free(list);
    free(split);
    return good;
}

static bool ask(const struct results *r, const struct peer_task *task, size_t p,
                stance_message *message)
{
    peer_ask(programs[p], task, &peers[p]);
    for (size_t k = 0; k < peers[p].settings; k++) {
        const struct peer_setting *const s = &peers[p].setting[k];
        struct line line = {
            .peer = &peers[p],
            .setting = s->name,
            .usual = s->usual,
            .row = {.step = s->step, .tolerance = NAN, .cases = cases_asked, .cost = s->cost}};
        for (size_t i = 0; i < cases_asked; i++) {
            line.row.failed += s->kind[i] == RESULTS_FAILED;
            if (a.labels)
                accuracy_label(&a, r, cell[i], s->kind[i], &line.row);
        }
        if (!a.labels && !compare_states(r, s, task->instants, &line.row, message))
            return false;
        lines = realloc(lines, (count + 1) * sizeof *lines);
        lines[count++] = line;
    }
    return true;
}

/* ---- fronts ------------------------------------------------------------------------------- */

/* The error that the rows of a chart compete in: of positions, or the share of cells unlike, of
 * which less than one cannot be told. NAN: none. */
static double error_of(const struct line *line)
{
    const struct accuracy_row *const row = &line->row;
    if (row->compared == 0 || row->failed > 0 || line == &lines[a.truth])
        return NAN;
    if (!a.labels)
        return row->position > 0 ? row->position : NAN;
    return fmax((double)row->differ, 1) / (double)row->compared;
}

static double cost_of(const struct line *line)
{
    return line->row.cost.median;
}

static void mark_fronts(void)
{
    for (size_t k = 0; k < count; k++) {
        struct line *const line = &lines[k];
        const double error = error_of(line), cost = cost_of(line);
        line->front = error > 0 && cost > 0;
        for (size_t j = 0; j < count; j++) {
            const struct line *const by = &lines[j];
            const double other = error_of(by), price = cost_of(by);
            if (j != k && by->row.method == line->row.method && by->peer == line->peer &&
                price <= cost && other <= error && (price < cost || other < error || j < k))
                line->front = false;
        }
    }
}

/* The row of a peer that counts: the smallest error, of its defaults or of all its settings. */
static const struct line *best_of(const struct peer *peer, bool usual)
{
    const struct line *best = NULL;
    for (size_t k = a.rows; k < count; k++) {
        const struct line *const line = &lines[k];
        const double error = error_of(line);
        if (line->peer == peer && (line->usual || !usual) && error > 0 &&
            (!best || error < error_of(best) ||
             (error == error_of(best) && cost_of(line) < cost_of(best))))
            best = line;
    }
    return best;
}

/* y at x on the straight line through two points, in logarithms. */
static double between(double x, double x0, double y0, double x1, double y1)
{
    return exp(log(y0) + (log(y1) - log(y0)) * (log(x) - log(x0)) / (log(x1) - log(x0)));
}

/* How a method does beside a row, from its front, interpolated between logarithms. */
struct against {
    double cheaper; /* the row's cost over the method's for as small an error; NAN: it has none */
    bool at_least;  /* its cheapest row is better than that */
    double error;   /* at the row's cost; NAN: it has none as cheap */
    bool at_most;   /* its dearest row is cheaper than that */
};
static struct against compare(const struct line *best, const stance_method *method)
{
    struct against against = {NAN, false, NAN, false};
    const double error = error_of(best), cost = cost_of(best);
    const struct line *worse = NULL, *better = NULL, *below = NULL, *above = NULL;
    for (size_t k = 0; k < a.rows; k++) {
        const struct line *const line = &lines[k];
        if (line->row.method != method || !line->front)
            continue;
        const double e = error_of(line), c = cost_of(line);
        if (e > error && (!worse || c > cost_of(worse)))
            worse = line;
        if (e <= error && (!better || c < cost_of(better)))
            better = line;
        if (c <= cost && (!below || c > cost_of(below)))
            below = line;
        if (c > cost && (!above || c < cost_of(above)))
            above = line;
    }
    if (better) {
        against.cheaper = cost / (worse ? between(error, error_of(worse), cost_of(worse),
                                                  error_of(better), cost_of(better))
                                        : cost_of(better));
        against.at_least = !worse;
    }
    if (below) {
        against.error =
            above ? between(cost, cost_of(below), error_of(below), cost_of(above), error_of(above))
                  : error_of(below);
        against.at_most = !above;
    }
    return against;
}

/* ---- text and JSON ------------------------------------------------------------------------ */

static void add_row(struct table *t, const struct line *line)
{
    const struct accuracy_row *const row = &line->row;
    const bool truth = line == &lines[a.truth];
    char remark[96];
    snprintf(remark, sizeof remark, "gave up %" PRIu64 " of %" PRIu64 "%s%s", row->failed,
             row->cases, line->peer ? "" : ": ",
             line->peer ? "" : stance_failure_name[row->failure]);
    TABLE_FACTS(
        t,
        {{"method", "method", .width = 13, .left = true},
         as_text(line->peer ? line->peer->name : row->method->name)},
        {{"setting", "setting", .width = 20, .left = true, .empty = ""}, as_text(line->setting)},
        {{"step", "step/s", "%.1e", .width = 8}, as_number(row->step)},
        {{"tolerance", "toler.", "%.0e", .width = 6}, as_number(row->tolerance)},
        {{.name = "reference"}, as_truth(truth)}, {{.name = "cases"}, as_whole(row->cases)},
        {{.name = "failed"}, as_whole(row->failed)},
        {{"microseconds_per_second", "us per s", "%.3g", .width = 10}, as_number(cost_of(line))});
    accuracy_errors(t, row, truth, a.labels);
    TABLE_FACTS(t, {{"remark", .hidden = TABLE_VIEW_ONLY, .before = "  ", .empty = ""},
                    as_nothing(row->failed > 0 ? remark : NULL)});
    table_end_row(t);
}

/* How one row of a peer stands beside every method. */
static void print_against(const struct line *best, const char *which)
{
    const char *const unit = a.labels ? " of the cells" : " m or rad", *comma = "";
    const struct accuracy_row *const row = &best->row;
    printf("  %s, %s (%s, %g s): ", best->peer->name, which, best->setting, row->step);
    if (a.labels && row->differ == 0) /* no number tells how much fewer than one */
        printf("none of %" PRIu64 " cells unlike, taken as one,", row->compared);
    else if (a.labels)
        printf("%" PRIu64 " of %" PRIu64 " cells unlike", row->differ, row->compared);
    else
        printf("error %.2g%s", error_of(best), unit);
    printf(" at %.3g us per s.\n    As exact:", cost_of(best));
    for (size_t m = 0; stance_methods()[m]; m++) {
        const struct against x = compare(best, stance_methods()[m]);
        const bool dearer = x.cheaper < 1;
        if (isnan(x.cheaper))
            continue;
        printf("%s %s is %s%.3g times %s", comma, stance_methods()[m]->name,
               !x.at_least ? ""
               : dearer    ? "at most "
                           : "at least ",
               dearer ? 1 / x.cheaper : x.cheaper, dearer ? "dearer" : "cheaper");
        comma = ",";
    }
    printf("%s.\n    At that cost:", *comma ? "" : " none");
    comma = "";
    for (size_t m = 0; stance_methods()[m]; m++) {
        const struct against x = compare(best, stance_methods()[m]);
        if (isnan(x.error))
            continue;
        printf("%s %s has %s%.2g%s", comma, stance_methods()[m]->name, x.at_most ? "at most " : "",
               x.error, *comma ? "" : unit);
        comma = ",";
    }
    puts(*comma ? "." : " none.");
}

static void print_peer(const struct peer *peer)
{
    const struct line *const best = best_of(peer, false), *const usual = best_of(peer, true);
    if (peer->cannot[0]) {
        printf("  %s cannot: %s\n", peer->name, peer->cannot);
        return;
    }
    printf("  %s: %zu settings, of which those nothing else of it beats and its defaults are "
           "listed; accelerations within %.0e of ours\n",
           peer->name, peer->settings, peer->off);
    if (best)
        print_against(best, "at its best");
    if (usual && usual != best)
        print_against(usual, "by default");
}

static bool print_text(const struct results *r, const struct table *t)
{
    printf("\n%s\n", r->title);
    const bool good =
        table_write_text(t, stdout,
                         a.labels ? "method setting step tolerance microseconds_per_second "
                                    "cells_unlike of share cells_unlike_inside remark"
                                  : "method setting step tolerance microseconds_per_second "
                                    "position_error velocity_error remark",
                         0);
    for (size_t p = 0; p < asked; p++)
        print_peer(&peers[p]);
    return good && fflush(stdout) == 0;
}

static json_t *best_json(const struct line *best)
{
    if (!best)
        return NULL;
    json_t *list = json_array();
    for (size_t m = 0; stance_methods()[m]; m++) {
        const struct against x = compare(best, stance_methods()[m]);
        if (!isnan(x.cheaper) || !isnan(x.error))
            json_array_append_new(list, TABLE_OBJECT({"method", as_text(stance_methods()[m]->name)},
                                                     {"times_cheaper", as_number(x.cheaper)},
                                                     {"at_least", as_truth(x.at_least)},
                                                     {"error", as_number(x.error)},
                                                     {"at_most", as_truth(x.at_most)}));
    }
    return TABLE_OBJECT({"setting", as_text(best->setting)}, {"step", as_number(best->row.step)},
                        {"microseconds_per_second", as_number(cost_of(best))},
                        {"error", as_number(error_of(best))}, {"methods", as_tree(list)});
}

static json_t *study_json(const struct results *r, const struct table *t)
{
    json_t *list = json_array();
    for (size_t p = 0; p < asked; p++) {
        const struct peer *const peer = &peers[p];
        const bool can = !peer->cannot[0];
        json_array_append_new(
            list, TABLE_OBJECT({"name", as_text(peer->name)},
                               {"cannot", as_text(can ? NULL : peer->cannot)},
                               {"settings", as_whole(peer->settings)},
                               {"acceleration_difference", as_number(can ? peer->off : NAN)},
                               {"best", as_tree(best_json(best_of(peer, false)))},
                               {"defaults", as_tree(best_json(best_of(peer, true)))}));
    }
    return TABLE_OBJECT({"name", as_text(r->name)}, {"title", as_text(r->title)},
                        {"file", as_text(r->file)}, {"rows", as_tree(table_json(t, false))},
                        {"peers", as_tree(list)});
}

/* ---- the picture -------------------------------------------------------------------------- */

/* What has a colour and an entry in the legend: a method, or a peer by its defaults or by all of
 * its other settings. */
struct series {
    const stance_method *method;
    const struct peer *peer;
    bool usual;
    const char *hue;
    int mark;
};

static bool belongs(const struct line *line, const struct series *s)
{
    return line != &lines[a.truth] && line->row.method == s->method && line->peer == s->peer &&
           line->usual == s->usual;
}

/* Points of a series, and what its line goes through: all of them, of a peer's many settings their
 * front by cost. */
static void put_series(struct gnuplot *g, const struct series *s, enum accuracy_shown shown)
{
    const bool many = s->peer && !s->usual;
    double last = 0;
    gnuplot_series(g, "using 1:2 with lines lc rgb %s lw %g dt %d", s->hue, s->peer ? 2.2 : 1.6,
                   s->usual ? 3 : 1);
    for (size_t k = 0; k < count; k++) {
        const struct line *next = belongs(&lines[k], s) && !many ? &lines[k] : NULL;
        for (size_t j = 0; many && j < count; j++)
            if (belongs(&lines[j], s) && lines[j].front && cost_of(&lines[j]) > last &&
                (!next || cost_of(&lines[j]) < cost_of(next)))
                next = &lines[j];
        if (many)
            last = next ? cost_of(next) : INFINITY;
        if (next)
            accuracy_point(g, &next->row, shown);
    }
    accuracy_points(g, s->hue, s->mark, many ? 0.5 : 0.9);
    for (size_t k = 0; k < count; k++)
        if (belongs(&lines[k], s))
            accuracy_point(g, &lines[k].row, shown);
}

static void put_legend(struct gnuplot *g, const struct series *s)
{
    uint64_t failed = 0, all = 0;
    size_t settings = 0;
    for (size_t k = 0; k < count; k++) {
        if (belongs(&lines[k], s)) {
            failed += lines[k].row.failed, all += lines[k].row.cases;
            settings++;
        }
    }
    gnuplot_legend(g, s->hue, 0, 0, s->peer ? s->peer->name : s->method->name,
                   s->usual ? "defaults" : "");
    if (s->peer && s->peer->cannot[0])
        gnuplot_about(g, "cannot: %.40s", s->peer->cannot);
    else if (s->peer)
        gnuplot_about(g, "%zu settings%s", settings, s->usual ? "" : "; the line joins the best");
    for (size_t k = 0; k < a.orders; k++)
        if (a.order[k].method == s->method && !isnan(a.order[k].position))
            gnuplot_about(g, "order %.2f of %s %.0e ... %.0e", a.order[k].position,
                          a.order[k].by_tolerance ? "tolerance" : "step", a.order[k].from,
                          a.order[k].to);
    if (failed > 0)
        gnuplot_about(g, "gave up in %" PRIu64 " of %" PRIu64 " cases", failed, all);
}

static bool draw(const struct plot *plot)
{
    struct accuracy_ranges ranges = accuracy_ranges();
    struct series series[ACCURACY_METHODS + 2 * PEERS];
    size_t n = 0;
    struct gnuplot g;
    for (size_t m = 0; stance_methods()[m]; m++)
        for (size_t k = 0; k < a.rows; k++)
            if (lines[k].row.method == stance_methods()[m] && k != a.truth) {
                /* As in the charts of `stance bench accuracy`. */
                series[n++] = (struct series){.method = stance_methods()[m],
                                              .hue = gnuplot_hue(m % 5),
                                              .mark = gnuplot_mark(m % 5)};
                break;
            }
    for (size_t p = 0; p < 2 * asked; p++)
        series[n++] = (struct series){.peer = &peers[p / 2],
                                      .usual = p % 2,
                                      .hue = gnuplot_hue(5 + p / 2 % 2),
                                      .mark = gnuplot_mark(5)};
    for (size_t k = 0; k < count; k++)
        if (k != a.truth)
            accuracy_widen(&ranges, &lines[k].row);
    if (!accuracy_picture(&a, &g, plot))
        return false;
    for (int p = 0; p < (a.labels ? 1 : 2); p++) {
        const enum accuracy_shown shown = a.labels ? ACCURACY_LABELS : (enum accuracy_shown)p;
        accuracy_panel(&g, &ranges, shown);
        for (size_t m = 0; m < n; m++)
            put_series(&g, &series[m], shown);
    }
    for (size_t m = 0; m < n; m++)
        put_legend(&g, &series[m]);
    return gnuplot_end(&g);
}

/* ---- the program -------------------------------------------------------------------------- */

static bool ask_all(const struct results *r, const char *stem, stance_message *message)
{
    const struct parallel alone = parallel_alone();
    struct plan plan;
    struct plan_error error = {0};
    if (!results_scenario(r, &scenario) || !plan_make(&plan, &scenario, false, 0, false, &error) ||
        !plan_compute_designs(&plan, &alone, &error))
        return complain(message, "the file's scenario cannot be planned: %.150s",
                        error.message.text);
    choose_cases(r, &plan);
    const char *const why = unspeakable();
    const struct peer_task task = {
        .name = stem,
        .scene = scenario.scene,
        .cases = cases,
        .count = cases_asked,
        .time = (double)cases->steps * cases->step,
        .every = a.labels ? cases->step : plan.record_interval,
        .instants = (size_t)((double)cases->steps * cases->step / plan.record_interval + 1.5),
        .labels = a.labels,
        .budget = budget,
        .effort = effort,
    };
    bool good = true;
    for (size_t p = 0; good && p < asked; p++) {
        peers[p] = (struct peer){.settings = 0};
        if (why) {
            snprintf(peers[p].name, PEER_NAME, "%s", programs[p]);
            snprintf(peers[p].cannot, PEER_REASON, "%s", why);
        } else {
            good = ask(r, &task, p, message);
        }
    }
    plan_free(&plan);
    return good;
}

static bool study(const struct plot *plot, json_t **object)
{
    const struct results *const r = plot->r;
    struct table t = {0};
    if (!accuracy_make(&a, r, budget, plot->message))
        return false;
    count = a.rows;
    lines = peer_room(count, sizeof *lines);
    for (size_t k = 0; k < count; k++)
        lines[k].row = a.row[k];
    bool good = ask_all(r, plot->stem, plot->message);
    mark_fronts();
    for (size_t k = 0; k < count; k++)
        if (object || !lines[k].peer || lines[k].front || lines[k].usual)
            add_row(&t, &lines[k]);
    if (good && object)
        *object = study_json(r, &t);
    else if (good)
        good = print_text(r, &t) && draw(plot);
    table_free(&t);
    for (size_t p = 0; p < asked; p++)
        peer_forget(&peers[p]);
    scenario_free(&scenario);
    accuracy_free(&a);
    free(lines);
    free(cases);
    free(cell);
    return good;
}

static double number(const char *text)
{
    char *end = NULL;
    const double x = text ? strtod(text, &end) : 0;
    if (x > 0 && x < 1e9 && !*end)
        return x;
    fputs("bench_peers: --peer-starts and --peer-effort take a number above 0\n", stderr);
    exit(EXIT_USAGE);
}

int main(int argc, char **argv)
{
    static const struct option options[] = {
        {.rows = studies_options},
        {"--json", OPTION_TO(struct studies, json), .text = "the same as JSON"},
        {0},
    };
    static const struct command self = {.name = "bench_peers",
                                        .summary = "other simulators on the charts",
                                        .options = options,
                                        .help = "The head of tests/bench_peers.c explains."};
    static const struct study_kind kind = {"accuracy", accuracy_fits, study};
    int left = 1; /* options that are those of `stance bench accuracy` */
    for (int i = 1; i < argc; i++)
        if (strcmp(argv[i], "--peer") == 0 && i + 1 < argc && asked < PEERS)
            programs[asked++] = argv[++i];
        else if (strcmp(argv[i], "--peer-starts") == 0)
            starts = (size_t)fmax(1, number(argv[++i]));
        else if (strcmp(argv[i], "--peer-effort") == 0)
            effort = number(argv[++i]);
        else
            argv[left++] = argv[i];
    argv[left] = NULL;
    return studies_run(&self, &kind, left, argv);
}
