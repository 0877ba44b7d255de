/* along.c - continuation: each gait begins where a straight line through the last two leads.
 *
 * Where the least real multiplier passes -1 or the largest one 1 between two values the place is
 * found by the Illinois method (Dowell and Jarratt, BIT 11 (1971) 168), gaits between included,
 * down to what the multipliers' error leaves. Where it ends without one the gaits on both sides
 * belong to different branches, which is said as `jump`. A step along the path that finds no gait
 * is halved. */
#include "gait.h"

#include "runner/base/message.h"
#include "runner/plan/asked.h"
#include "runner/plan/instruction_set.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

extern const struct command command_gait;

#define CLEAR 0.02 /* m: a foot so far off the ground is not inside a changed one */
#define VIEW "value period step_length speed re im modulus holds place"
#define PLACE 1e-4 /* of a multiplier that is at -1 or 1 */
#define OFF 1e-3   /* rad, rad/s: slightly off a gait */
#define SAME 1e-6  /* s: of times of steps that are alike */
enum { HALVINGS = 5, PLACES = 40 };

struct follow {
    const struct along *along;
    char *plain; /* the scenario's text without its sweep */
    const char *file;
    struct return_map map;
    bool begun;
    struct return_point guess;
    struct gait gait; /* the last one that was found ... */
    double last;      /* ... at this value; and the one before */
    double before[RETURN_MAP_MOST], last_before;
    struct gait next, there; /* what is looked for; at the end of the stretch that is looked at */
    int found;
    double at, asked; /* the value that is looked at; of which it is asked what it comes to */
    int settled;      /* times of steps there */
    double time[ALONG_TIMES];
    struct along_gait *row; /* what is told */
    size_t rows;
    bool refused; /* the scenario does not admit a value */
    stance_message message;
};

static int take(const struct scenario *s, const stance_case *c, void *context)
{
    struct follow *const f = context;
    const stance_kernel *const kernel =
        instruction_set_kernel(s->scene, stance_methods()[s->base.method]);
    bool good = f->begun ? return_map_change(&f->map, c, &f->message)
                         : return_map_begin(&f->map, c, kernel, f->along->steps, f->along->settle,
                                            &f->guess, &f->message);
    f->begun |= good;
    good = good && gait_find(&f->map, &f->guess, &f->next, &f->message);
    if (good)
        f->gait = f->next;
    if (good && f->along->settled && f->at == f->asked) { /* what it comes to, slightly off it */
        struct return_point off = f->gait.from;
        for (int i = 0; i < f->map.n; i++)
            off.z[i] += i % 2 ? -OFF : OFF;
        f->settled =
            return_map_settle(&f->map, &off, ALONG_WALKED, ALONG_TIMES, f->time) ? ALONG_TIMES : 0;
    }
    return good ? EXIT_DONE : EXIT_USAGE;
}

void along_blame(const char *path, double value, stance_message *message)
{
    const stance_message why = *message;
    if (why.text[0])
        complain(message, "with %.40s %.6g: %.150s", path, value, why.text);
}

/* The gait at a value; false, with f->message: none is found. */
static bool find(struct follow *f, double value)
{
    const char *const path = f->along->path;
    const struct return_point from = f->gait.from;
    f->message.text[0] = '\0';
    f->at = value;
    struct scenario *const s =
        along_at(f->file, f->plain, path, value, f->begun ? &f->map : NULL, &from);
    if (!s) {
        f->refused = true;
        return complain(&f->message, "the scenario does not admit %.60s=%.17g", path, value);
    }
    if (f->found > 0)
        f->guess = from;
    for (int i = 0; f->found > 1 && i < f->map.n; i++)
        f->guess.z[i] +=
            (from.z[i] - f->before[i]) / (f->last - f->last_before) * (value - f->last);
    const bool good = asked_first(&command_gait, s, take, f) == EXIT_DONE;
    scenario_drop(s);
    if (good) {
        memcpy(f->before, from.z, sizeof f->before);
        f->last_before = f->last;
        f->last = value;
        f->found++;
    } else {
        along_blame(path, value, &f->message);
    }
    return good;
}

/* How far the least real multiplier is from -1 (sign -1), the largest one from 1. */
static double room(const struct follow *f, int sign)
{
    double most = -INFINITY;
    for (int i = 0; i < f->map.n; i++)
        if (f->gait.im[i] == 0)
            most = fmax(most, sign * f->gait.re[i]);
    return 1 - most;
}

/* The last gait as it is told; NULL: no memory. Of a `place` what it comes to is not asked. */
static struct along_gait *note(struct follow *f, const char *place)
{
    struct along_gait *const more = realloc(f->row, (f->rows + 1) * sizeof *more);
    if (!more)
        return NULL;
    f->row = more;
    struct along_gait *const row = &more[f->rows++];
    const struct gait *const g = &f->gait;
    *row = (struct along_gait){.value = f->last,
                               .period = g->at.time,
                               .length = g->at.length,
                               .n = f->map.n,
                               .error = g->error[0],
                               .stable = g->stable,
                               .place = place};
    memcpy(row->re, g->re, sizeof row->re);
    memcpy(row->im, g->im, sizeof row->im);
    if (!place) {
        row->settled = f->settled;
        memcpy(row->time, f->time, sizeof row->time);
    }
    return row;
}

/* After how many steps the times repeat; 0: after none. */
static int repeats(const struct along_gait *row)
{
    for (int k = 1; k <= row->settled / 2; k++) {
        bool same = true;
        for (int i = k; i < row->settled; i++)
            same = same && fabs(row->time[i] - row->time[i - k]) < SAME;
        if (same)
            return k;
    }
    return 0;
}

/* What is told of a gait; `list` and `times` are of tell. */
#define ROW(X)                                                                                     \
    X("value", "", as_number(row->value), along->path, "%.12g", .width = 16)                       \
    X("period", "", as_number(row->period), "period (s)", "%.9f", .width = 13)                     \
    X("step_length", "", as_number(row->length / along->steps), "step (m)", "%.7f", .width = 11)   \
    X("speed", "", as_number(row->length / row->period), "speed (m/s)", "%.6f", .width = 12)       \
    X("re", "", as_number(row->re[0]), "multiplier", "%.6f", .width = 11)                          \
    X("im", "", as_number(row->im[0]), "+- i", "%.6f", .width = 9)                                 \
    X("modulus", "of the largest multiplier", as_number(hypot(row->re[0], row->im[0])), "modulus", \
      "%.6f", .width = 9)                                                                          \
    X("holds", "", as_text(row->stable ? "holds" : ""), "", .left = true, .width = 5)              \
    X("place", "flip, fold or jump, to another gait", as_text(row->place), "", .left = true,       \
      .width = 4, .empty = "")                                                                     \
    X("repeats", "", row->settled ? as_number(repeats(row)) : as_nothing(NULL), "repeats", "%.0f", \
      .width = 7, .empty = "")                                                                     \
    X("settled", "the 16 times", as_tree(times))                                                   \
    X("multipliers", "[{re, im}]", as_tree(list))

const struct say_key along_keys[] = {ROW(TABLE_KEY){0}};

static void tell(const struct along *along, const struct along_gait *row, struct table *t)
{
    json_t *const list = json_array(), *const times = row->settled ? json_array() : NULL;
    for (int i = 0; i < row->n; i++)
        if (row->im[i] >= 0)
            TABLE_APPEND(list, {"re", as_number(row->re[i])}, {"im", as_number(row->im[i])});
    for (int i = 0; i < row->settled; i++)
        table_append(times, as_number(row->time[i]));
    TABLE_FACTS(t, ROW(TABLE_FACT));
    table_end_row(t);
}

/* Between two gaits, at values a and b with so much room there, where there is none. */
static bool meet(struct follow *f, int sign, double a, double at_a, double b, double at_b)
{
    for (int k = 0; k < PLACES && fabs(b - a) > 1e-13 * (fabs(a) + fabs(b)); k++) {
        const double c = b - at_b * (b - a) / (at_b - at_a);
        if (c == a || c == b || !find(f, c))
            return c == a || c == b;
        const double at_c = room(f, sign);
        if (fabs(at_c) < 1e-12)
            return true;
        if ((at_c < 0) != (at_b < 0))
            a = b, at_a = at_b;
        else
            at_a *= 0.5;
        b = c, at_b = at_c;
        if (fabs(at_c) < f->gait.error[0] * 1e-3)
            return true;
    }
    return true;
}

/* The gait at a value, from the last one on, by shorter steps where that is too far. */
static bool reach(struct follow *f, double value)
{
    for (int halved = 0; halved <= HALVINGS; halved++) {
        const double step = (value - f->last) / (1 << halved);
        bool good = true;
        while (good && f->last != value)
            good =
                find(f, halved == 0 || fabs(value - f->last) < 1.5 * fabs(step) ? value
                                                                                : f->last + step);
        if (good || f->refused)
            return good;
    }
    return false;
}

static int follow(struct follow *f)
{
    const struct along *const a = f->along;
    f->asked = a->from;
    if (!find(f, a->from) || !note(f, NULL))
        return EXIT_USAGE;
    for (size_t k = 1; k < a->count; k++) {
        const double begin = f->last, at[2] = {room(f, 1), room(f, -1)};
        const double end = k + 1 == a->count
                               ? a->to
                               : a->from + (a->to - a->from) * (double)k / (double)(a->count - 1);
        f->asked = end;
        if (!reach(f, end) || !note(f, NULL))
            return EXIT_USAGE;
        f->there = f->gait;
        f->asked = NAN;
        for (int kind = 0; kind < 2; kind++) {
            const int sign = kind == 0 ? 1 : -1;
            f->gait = f->there, f->last = end;
            const double now = room(f, sign);
            if ((at[kind] < 0) == (now < 0) || !isfinite(at[kind]) || !isfinite(now))
                continue;
            if (!meet(f, sign, begin, at[kind], end, now) ||
                !note(f, fabs(room(f, sign)) > PLACE + f->gait.error[0] ? "jump"
                         : kind == 0                                    ? "fold"
                                                                        : "flip"))
                continue;
            /* it stands before the end */
            const struct along_gait place = f->row[f->rows - 1];
            f->row[f->rows - 1] = f->row[f->rows - 2];
            f->row[f->rows - 2] = place;
        }
        f->gait = f->there, f->last = end;
        memcpy(f->before, f->there.from.z, sizeof f->before);
        f->found = 1; /* the line begins anew behind a place */
    }
    return EXIT_DONE;
}

struct scenario *along_at(const char *file, const char *plain, const char *path, double value,
                          const struct return_map *map, const struct return_point *at)
{
    char set[160];
    char *const initial = map ? return_map_initial(map, at, CLEAR) : NULL;
    snprintf(set, sizeof set, "%.100s=%.17g", path, value);
    const char *const sets[] = {initial ? initial : set, set};
    struct scenario *const s = asked_again(file, plain, sets, 2);
    free(initial);
    return s;
}

char *along_plain(const struct scenario *s)
{
    static const char *const drop[] = {"sweep", "optimise", "record"};
    return scenario_rewrite(s->text, drop, sizeof drop / sizeof *drop, NULL, 0);
}

int along_say(const struct scenario *s, const struct along *along, enum table_form form)
{
    static const char text[] = "[title:{title}\n]{.rows}[stopped:it goes no further: {stopped}\n]";
    struct follow *const f = calloc(1, sizeof *f);
    struct table t = {0};
    if (!f)
        return EXIT_USAGE;
    f->along = along;
    f->file = s->file;
    f->plain = along_plain(s);
    int code = f->plain ? follow(f) : EXIT_USAGE;
    for (size_t k = 0; k < f->rows && !along->look; k++)
        tell(along, &f->row[k], &t);
    if (f->rows > 0 && along->look) {
        if (code != EXIT_DONE)
            fprintf(stderr, "stance gait: it goes no further: %s\n", f->message.text);
        code = along_draw(s, along, f->row, f->rows);
    } else if (table_rows(&t) == 0) {
        if (f->message.text[0] && !f->refused) /* else it has been said */
            fprintf(stderr, "stance gait: %s: %s\n", s->file, f->message.text);
        table_free(&t);
    } else {
        json_t *const facts = TABLE_OBJECT(
            {"title", as_text(s->title[0] ? s->title : NULL)}, {"path", as_text(along->path)},
            {"stopped", as_text(code == EXIT_DONE ? NULL : f->message.text)});
        const bool said = table_say(
            form, table_show(facts, "rows", &t, along->settled ? VIEW " repeats" : VIEW, 0), text,
            &t);
        code = said ? EXIT_DONE : EXIT_IO;
    }
    free(f->row);
    free(f->plain);
    free(f);
    return code;
}
