/* peer.h - what programs share that let another simulator take part in `make bench-peers`.
 *
 * An adapter (peer_NAME.c or .cpp) makes the robot in its simulator and gives the functions of
 * struct peer_engine; peer_main does the talking, in the words of tests/peer_talk.h, holds the
 * law's torques between samples, applies the outcome rule and takes the time. C and C++.
 */
#ifndef STANCE_TESTS_PEER_H
#define STANCE_TESTS_PEER_H

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { PEER_STATE = 10, PEER_CONTACTS = 2 };

/* What is asked for. A state is position[5], velocity[5] of the biped: x, z, theta, q1, q2. */
struct peer_request {
    char scene[32];
    int robots;
    double *robot; /* [robots] leg, trunk, foot's, trunk's and hip's mass */
    double gravity, friction, restitution;
    int feet[PEER_CONTACTS]; /* 1: may touch the ground */
    /* torque = feedforward - gain (posture - target, rates), within +-limit (which may be inf),
     * held for `sample` seconds; 0: it acts all the time. */
    double feedforward[2], gain[2][6], target[3], limit[2], sample;
    double time, every; /* s: length of a case; states are told, and outcomes judged, so often */
    int labels;         /* outcomes are asked for, not states */
    double settle[3], place, fall_height; /* angle, rate, how long */
    int support[PEER_CONTACTS];
    double budget, effort; /* s for each setting: repeated for so long; not begun beyond */
    int checks, cases;
    double *check, *start; /* [checks], [cases][PEER_STATE] */
};

struct peer_engine {
    const char *name;
    /* NULL: it can; else why not. */
    const char *(*cannot)(const struct peer_request *r);
    int settings;
    /* A name and a step, of one name from long to short; `usual`: the simulator's own defaults.
     * NULL: not for this request. */
    const char *(*setting)(const struct peer_request *r, int s, double *step, bool *usual);
    bool (*begin)(const struct peer_request *r, int s); /* false: this setting cannot be made */
    void (*end)(void);
    void (*acceleration)(const double *state, const double torque[2], double a[5]);
    void (*start)(const double *state);
    /* One step under `torque`; NULL: under the law, which acts all the time. False: it gave up. */
    bool (*step)(const double *torque);
    void (*state)(double *state, double load[PEER_CONTACTS]); /* N, of each foot */
};

/* ---- the law ------------------------------------------------------------------------------ */

static inline void peer_torque(const struct peer_request *r, const double *q, const double *v,
                               double torque[2])
{
    for (int i = 0; i < 2; i++) {
        double sum = r->feedforward[i];
        for (int j = 0; j < 3; j++)
            sum -= r->gain[i][j] * (q[2 + j] - r->target[j]) + r->gain[i][3 + j] * v[2 + j];
        torque[i] = fmax(fmin(sum, r->limit[i]), -r->limit[i]);
    }
}

/* A servo of its own in each hip joint: what simulators have springs and dampers for. */
static inline bool peer_is_servo(const struct peer_request *r)
{
    bool servo = r->sample <= 0;
    for (int i = 0; i < 2; i++) {
        servo = servo && isinf(r->limit[i]) && r->feedforward[i] == 0;
        for (int j = 0; j < 6; j++)
            servo = servo && (j % 3 == 1 + i || r->gain[i][j] == 0);
    }
    return servo;
}

/* ---- the outcome rule: engine/README.md, Outcomes ------------------------------------------ */

struct peer_window {
    double begin, measure; /* begin < 0: closed */
};

/* Has what `holds` lasted for long enough, and not grown? */
static inline bool peer_lasts(struct peer_window *w, bool holds, double measure, double t,
                              double length)
{
    const bool full = holds && w->begin >= 0 && t - w->begin >= length - 1e-9;
    const bool calm = measure <= fmax(w->measure, 1e-9);
    if (!holds)
        w->begin = -1;
    else if (w->begin < 0 || (full && !calm))
        w->begin = t, w->measure = measure;
    return full && calm;
}

/* Horizontal speed of a foot. */
static inline double peer_slip(const struct peer_request *r, const double *state, int foot)
{
    const double *q = state, *v = state + 5, l = r->robot[0], lt = r->robot[1];
    const double phi = q[2] + q[3 + foot];
    return v[0] + lt * cos(q[2]) * v[2] + l * cos(phi) * (v[2] + v[3 + foot]);
}

/* Where a foot is along the ground. */
static inline double peer_along(const struct peer_request *r, const double *state, int foot)
{
    const double *q = state, l = r->robot[0], lt = r->robot[1];
    return q[0] + lt * sin(q[2]) + l * sin(q[2] + q[3 + foot]);
}

/* NULL: none yet. */
static inline const char *peer_judge(const struct peer_request *r, struct peer_window window[2],
                                     const double *begin, const double *state, const double *load,
                                     double t)
{
    double angle = 0, speed = 0;
    bool alone = true;
    for (int j = 0; j < 3; j++) {
        angle = fmax(angle, fabs(state[2 + j] - r->target[j]));
        speed = fmax(speed, fabs(state[7 + j]));
    }
    for (int c = 0; c < PEER_CONTACTS; c++)
        alone =
            alone && (r->support[c] ? load[c] > 0 && fabs(peer_slip(r, state, c)) <= r->settle[1]
                                    : load[c] <= 0);
    for (int c = 0; c < PEER_CONTACTS; c++)
        alone = alone && (!r->support[c] ||
                          fabs(peer_along(r, state, c) - peer_along(r, begin, c)) <= r->place);
    const double all = fmax(speed, fmax(fabs(state[5]), fabs(state[6])));
    const double error = fmax(angle / r->settle[0], speed / r->settle[1]);
    const bool settled = peer_lasts(&window[0], alone && error <= 1, error, t, r->settle[2]);
    const bool rested =
        peer_lasts(&window[1], !alone && all <= r->settle[1], all / r->settle[1], t, r->settle[2]);
    const double hip = state[1] - r->robot[1] * cos(state[2]);
    if (hip < r->fall_height * r->robot[0] || state[1] <= 0)
        return "fell";
    return rested ? "rested" : settled ? "stabilised" : NULL;
}

/* ---- talking ------------------------------------------------------------------------------ */

static inline void peer_numbers(double *x, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (scanf("%lf", &x[i]) != 1)
            exit(3);
}
static inline double peer_number(void)
{
    double x;
    peer_numbers(&x, 1);
    return x;
}
static inline double *peer_list(int *count, size_t each)
{
    *count = (int)peer_number();
    double *const list = (double *)calloc((size_t)*count * each + 1, sizeof(double));
    if (!list)
        exit(3);
    peer_numbers(list, (size_t)*count * each);
    return list;
}

static inline void peer_whole(int *n, size_t count)
{
    for (size_t i = 0; i < count; i++)
        n[i] = (int)peer_number();
}

static inline void peer_read(struct peer_request *r)
{
    double version = 1;
    const struct {
        const char *word;
        double *x;
        int *n;
        size_t count;
    } known[] = {{"stance-peer", &version, NULL, 1},
                 {"gravity", &r->gravity, NULL, 1},
                 {"friction", &r->friction, NULL, 1},
                 {"restitution", &r->restitution, NULL, 1},
                 {"contacts", NULL, r->feet, PEER_CONTACTS},
                 {"feedforward", r->feedforward, NULL, 2},
                 {"gain", &r->gain[0][0], NULL, 12},
                 {"target", r->target, NULL, 3},
                 {"limit", r->limit, NULL, 2},
                 {"sample", &r->sample, NULL, 1},
                 {"time", &r->time, NULL, 1},
                 {"every", &r->every, NULL, 1},
                 {"labels", NULL, &r->labels, 1},
                 {"settle", r->settle, NULL, 3},
                 {"place", &r->place, NULL, 1},
                 {"fall_height", &r->fall_height, NULL, 1},
                 {"supports", NULL, r->support, PEER_CONTACTS},
                 {"budget", &r->budget, NULL, 1},
                 {"effort", &r->effort, NULL, 1}};
    enum { KNOWN = sizeof known / sizeof *known };
    char word[32];
    memset(r, 0, sizeof *r);
    while (scanf("%31s", word) == 1 && strcmp(word, "end") != 0) {
        size_t k = 0;
        while (k < KNOWN && strcmp(word, known[k].word) != 0)
            k++;
        if (k < KNOWN && known[k].x)
            peer_numbers(known[k].x, known[k].count);
        else if (k < KNOWN)
            peer_whole(known[k].n, known[k].count);
        else if (strcmp(word, "robot") == 0)
            r->robot = peer_list(&r->robots, 1);
        else if (strcmp(word, "checks") == 0)
            r->check = peer_list(&r->checks, PEER_STATE);
        else if (strcmp(word, "cases") == 0)
            r->start = peer_list(&r->cases, PEER_STATE);
        else if (strcmp(word, "scene") != 0 || scanf("%31s", r->scene) != 1)
            exit(3);
        if (k == 0 && version != 1)
            exit(3);
    }
}

/* ---- simulating --------------------------------------------------------------------------- */

static inline double peer_clock(clockid_t which)
{
    struct timespec now;
    clock_gettime(which, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* One case; its simulated time. `out`: what came of it is printed, as a line of each instant or of
 * the outcome. */
static inline double peer_case(const struct peer_engine *e, const struct peer_request *r, int i,
                               double step, bool out)
{
    const int chunk = (int)(r->every / step + 0.5), rows = (int)(r->time / r->every + 0.5);
    const int hold = r->sample > 0 ? (int)(r->sample / step + 0.5) : 0;
    struct peer_window window[2] = {{-1, 0}, {-1, 0}};
    double state[PEER_STATE], load[PEER_CONTACTS] = {0, 0}, torque[2] = {0, 0}, end = r->time;
    const char *outcome = NULL;
    long n = 0;
    e->start(r->start + (size_t)PEER_STATE * (size_t)i);
    memcpy(state, r->start + (size_t)PEER_STATE * (size_t)i, sizeof state);
    for (int row = 0; row <= rows && !outcome; row++) {
        for (int k = 0; row > 0 && k < chunk && !outcome; k++, n++) {
            if (hold > 0 && n % hold == 0) {
                e->state(state, load);
                peer_torque(r, state, state + 5, torque);
            }
            if (!e->step(hold > 0 ? torque : NULL))
                outcome = "failed";
        }
        end = row * r->every;
        if (row > 0 && !outcome)
            e->state(state, load);
        for (int k = 0; k < PEER_STATE && !outcome; k++)
            if (!isfinite(state[k]))
                outcome = "failed";
        if (out && !outcome && !r->labels) {
            printf("state %d %d", i, row);
            for (int k = 0; k < PEER_STATE; k++)
                printf(" %.17g", state[k]);
            putchar('\n');
        }
        if (r->labels && row > 0 && !outcome)
            outcome =
                peer_judge(r, window, r->start + (size_t)PEER_STATE * (size_t)i, state, load, end);
    }
    if (out)
        printf("case %d %s %.17g\n", i, outcome ? outcome : r->labels ? "undecided" : "done", end);
    return end;
}

static inline int peer_ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* All cases of a setting, repeated for the time there is; returns what one time took. States are
 * told in a pass of their own, which is not timed. */
static inline double peer_setting(const struct peer_engine *e, const struct peer_request *r,
                                  double step)
{
    enum { MOST = 101 };
    double time[MOST], spent = 0, simulated = 0;
    int n = 0;
    while (n < MOST && (n == 0 || spent < r->budget)) {
        const double clock = peer_clock(CLOCK_MONOTONIC);
        const double processor = peer_clock(CLOCK_PROCESS_CPUTIME_ID);
        simulated = 0;
        for (int i = 0; i < r->cases; i++)
            simulated += peer_case(e, r, i, step, r->labels && n == 0);
        /* As analysis/bench/measure.c does. */
        time[n] = peer_clock(CLOCK_PROCESS_CPUTIME_ID) - processor;
        if (time[n] < 0.1)
            time[n] = peer_clock(CLOCK_MONOTONIC) - clock;
        spent += time[n++];
    }
    for (int i = 0; i < r->cases && !r->labels; i++)
        peer_case(e, r, i, step, true);
    qsort(time, (size_t)n, sizeof *time, peer_ascending);
    printf("time %.17g %.17g %.17g %d\n", 1e6 * time[n / 2] / simulated, 1e6 * time[0] / simulated,
           1e6 * time[n - 1] / simulated, n);
    return time[0];
}

static inline void peer_accelerations(const struct peer_engine *e, const struct peer_request *r)
{
    for (int i = 0; i < r->checks; i++) {
        const double *const state = r->check + (size_t)PEER_STATE * (size_t)i;
        double torque[2], a[5];
        peer_torque(r, state, state + 5, torque);
        e->acceleration(state, torque, a);
        printf("acceleration %d %.17g %.17g %.17g %.17g %.17g\n", i, a[0], a[1], a[2], a[3], a[4]);
    }
}

static inline int peer_main(const struct peer_engine *e)
{
    struct peer_request r;
    peer_read(&r);
    printf("peer %s\n", e->name);
    const char *const cannot = strcmp(r.scene, "biped") != 0 ? "no model of this scene"
                               : r.restitution > 0           ? "no model of restitution"
                               : e->cannot                   ? e->cannot(&r)
                                                             : NULL;
    if (cannot)
        printf("cannot %s\n", cannot);
    double took = 0, before = 0; /* s, by the step of the setting before, of the same name */
    const char *last = "";
    for (int s = 0; s < e->settings && !cannot; s++) {
        double step;
        bool usual;
        const char *const name = e->setting(&r, s, &step, &usual);
        if (!name)
            continue;
        const double chunk = r.every / step, hold = r.sample / step;
        if (strcmp(name, last) == 0 && took * before / step > r.effort)
            continue;
        if (fabs(chunk - round(chunk)) > 1e-6 || fabs(hold - round(hold)) > 1e-6)
            continue; /* instants are not ends of steps */
        if (!e->begin(&r, s))
            return 1;
        printf("setting %.17g %d %s\n", step, usual, name);
        peer_accelerations(e, &r);
        took = peer_setting(e, &r, step);
        e->end();
        before = step, last = name;
        fflush(stdout);
    }
    puts("end");
    free(r.robot);
    free(r.check);
    free(r.start);
    return fflush(stdout) == 0 ? 0 : 1;
}

#endif
