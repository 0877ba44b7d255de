/* peer_talk.h - another simulator computes our cases: the talk with the program that drives it.
 *
 * An adapter is a program beside the tests (tests/peer.h has what adapters share). It is started
 * without arguments, reads one request from standard input and answers on standard output, in lines
 * of words and numbers. The request, in any order, `end` last:
 *
 *   stance-peer 1                          version of this talk
 *   scene NAME, robot N x..., gravity G, friction MU, restitution E
 *   contacts B B ...                       1: this contact may touch the ground
 *   feedforward u..., gain K..., target p..., limit u..., sample T
 *                                          torque = feedforward - gain (posture - target, rates),
 *                                          within +-limit, held for T seconds; 0: always acting
 *   time T, every D                        length of a case; instants are D apart
 *   labels B                               1: outcomes are asked for; 0: states at the instants
 *   settle ANGLE RATE HOLD, place P, fall_height H, supports B B ...    the outcome rule
 *   budget S, effort S                     repeat a setting for so long; leave out longer ones
 *   checks N (position velocity)...        states in flight
 *   cases N (position velocity)...         where the cases start
 *   end
 *
 * The answer:
 *
 *   peer NAME
 *   cannot WHY                             then `end`: it has no model of this
 *   setting STEP USUAL NAME                of each integrator, solver, step; USUAL 1: its defaults
 *   acceleration I a...                    at check I, under the law's torques: all, at once
 *   state I K position... velocity...      of case I at instant K, from 0 on
 *   case I KIND TIME                       how it ended (`done` where states are asked for,
 *                                          `failed`), and when
 *   time MEDIAN LOW HIGH N                 microseconds of the processor per simulated second
 *   end
 *
 * What is said is not believed: accelerations are compared with ours, and every case must be there.
 * What is wrong ends this program, with one line.
 */
#ifndef STANCE_TESTS_PEER_TALK_H
#define STANCE_TESTS_PEER_TALK_H

#include "accelerations.h"

#include "analysis/bench/measure.h"
#include "runner/base/command.h"
#include "runner/store/results.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

enum { PEER_NAME = 64, PEER_REASON = 160, PEER_CHECKS = 64 };

struct peer_task {
    const char *name; /* of the study, for what is said */
    const stance_scene *scene;
    const stance_case *cases; /* [count] that differ in their states alone */
    size_t count, instants;
    double time, every; /* s */
    bool labels;
    double budget, effort; /* s */
};

/* One setting's answers. */
struct peer_setting {
    char name[PEER_NAME];
    bool usual;
    double step;   /* s */
    uint8_t *kind; /* [count] as of a results file */
    size_t *rows;  /* [count] instants told */
    double *state; /* [count][instants][2 coordinates] */
    struct bench_spread cost;
};

struct peer {
    char name[PEER_NAME], cannot[PEER_REASON]; /* "": it can */
    double off; /* largest difference of accelerations, of the largest of each state */
    size_t settings;
    struct peer_setting *setting;
};

/* The talk that goes on. */
static struct {
    const struct peer_task *task;
    const char *program;
    struct peer *peer;
    pid_t child;
    unsigned long lines;
    double truth[PEER_CHECKS][STANCE_MAX_COORDINATES]; /* accelerations of ours */
    int checked;
    bool timed, ended;
} talk;

static _Noreturn void peer_die(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fprintf(stderr, "bench_peers: %s: %s", talk.task ? talk.task->name : "",
            talk.task ? talk.program : "");
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    putc('\n', stderr);
    if (talk.child > 0)
        kill(-talk.child, SIGKILL);
    exit(EXIT_IO);
}

static void *peer_room(size_t count, size_t size)
{
    void *const room = calloc(count + 1, size);
    if (!room)
        peer_die(": out of memory");
    return room;
}

/* ---- accelerations of ours ---------------------------------------------------------------- */

static double peer_random(uint64_t *state, double to)
{
    *state = *state * 6364136223846793005U + 1442695040888963407U;
    return to * (2 * (double)(*state >> 11) * 0x1p-53 - 1);
}

/* A state in flight, near the start or anywhere; the law's torques at its beginning are held. */
static stance_case peer_check(int k)
{
    stance_case c = talk.task->cases[0];
    uint64_t state = (uint64_t)k + 1;
    for (int i = 0; i < talk.task->scene->coordinates; i++) {
        c.position[i] += peer_random(&state, k % 2 ? 3 : 0.02);
        c.velocity[i] = peer_random(&state, k % 2 ? 2 : 0.05);
    }
    c.position[1] = 100;
    return c;
}

/* ---- the request -------------------------------------------------------------------------- */

static void peer_put(FILE *out, const char *word, const double *x, int n)
{
    fprintf(out, "%s", word);
    for (int i = 0; i < n; i++)
        fprintf(out, " %.17g", x[i]);
    fputc('\n', out);
}

static void peer_put_bits(FILE *out, const char *word, uint32_t bits, int n)
{
    fprintf(out, "%s", word);
    for (int c = 0; c < n; c++)
        fprintf(out, " %u", bits >> c & 1);
    fputc('\n', out);
}

static void peer_put_state(FILE *out, const stance_case *c)
{
    peer_put(out, "", c->position, talk.task->scene->coordinates);
    peer_put(out, "", c->velocity, talk.task->scene->coordinates);
}

static void peer_request(FILE *out)
{
    const struct peer_task *const task = talk.task;
    const stance_scene *const scene = task->scene;
    const stance_case *const c = task->cases;
    double limit[STANCE_MAX_ACTUATORS], own[STANCE_MAX_ACTUATORS];
    for (int i = 0; i < scene->actuators; i++)
        own[i] = c->torque_limits[i] > 0 ? c->torque_limits[i] : INFINITY;
    stance_torque_limits(scene, c->robot, c->torque_limit, own, limit);
    fprintf(out, "stance-peer 1\nscene %s\nrobot %d", scene->name, scene->robot_count);
    peer_put(out, "", c->robot, scene->robot_count);
    peer_put(out, "gravity", &c->robot[STANCE_ROBOT_GRAVITY], 1);
    peer_put(out, "friction", &c->friction, 1);
    peer_put(out, "restitution", &c->restitution, 1);
    peer_put_bits(out, "contacts", c->contacts, scene->contacts);
    peer_put(out, "feedforward", c->near.feedforward, scene->actuators);
    fputs("gain", out);
    for (int i = 0; i < scene->actuators; i++)
        peer_put(out, "", c->near.gain[i], 2 * scene->postures);
    peer_put(out, "\ntarget", c->near.target, scene->postures);
    peer_put(out, "limit", limit, scene->actuators);
    fprintf(out, "sample %.17g\ntime %.17g\nevery %.17g\nlabels %d\n",
            (double)c->sample_every * c->step, task->time, task->every, task->labels);
    fprintf(out, "settle %.17g %.17g %.17g\nplace %.17g\nfall_height %.17g\n", c->settle_angle,
            c->settle_rate, c->settle_hold, c->settle_place > 0 ? c->settle_place : INFINITY,
            c->robot[STANCE_ROBOT_FALL_HEIGHT]);
    peer_put_bits(out, "supports", c->supports, scene->contacts);
    fprintf(out, "budget %.17g\neffort %.17g\nchecks %d\n", task->budget, task->effort,
            PEER_CHECKS);
    for (int k = 0; k < PEER_CHECKS; k++) {
        const stance_case check = peer_check(k);
        peer_put_state(out, &check);
    }
    fprintf(out, "cases %zu\n", task->count);
    for (size_t i = 0; i < task->count; i++)
        peer_put_state(out, &task->cases[i]);
    fputs("end\n", out);
}

/* Starts the program; what it says. */
static FILE *peer_begin(void)
{
    FILE *const request = tmpfile(); /* no pipe: it may die before it has read it */
    int pipes[2];
    if (!request || pipe(pipes) != 0)
        peer_die(": cannot be asked: %s", strerror(errno));
    peer_request(request);
    if (fflush(request) != 0 || ferror(request))
        peer_die(": cannot be asked: %s", strerror(errno));
    talk.child = fork();
    if (talk.child == 0) {
        setpgid(0, 0);
        dup2(fileno(request), STDIN_FILENO);
        lseek(STDIN_FILENO, 0, SEEK_SET);
        dup2(pipes[1], STDOUT_FILENO);
        close(pipes[0]);
        execlp(talk.program, talk.program, (char *)NULL);
        fprintf(stderr, "%s: %s\n", talk.program, strerror(errno));
        _exit(127);
    }
    fclose(request);
    close(pipes[1]);
    return fdopen(pipes[0], "r");
}

/* ---- what it says ------------------------------------------------------------------------- */

static _Noreturn void peer_damaged(const char *line)
{
    peer_die(": line %lu is not understood: %.60s", talk.lines, line);
}

static struct peer_setting *peer_present(void)
{
    return &talk.peer->setting[talk.peer->settings - 1];
}

/* Is all there that a setting must say? */
static void peer_whole(void)
{
    const struct peer_setting *const s = talk.peer->settings > 0 ? peer_present() : NULL;
    size_t missing = 0;
    for (size_t i = 0; s && i < talk.task->count; i++)
        missing += s->kind[i] == RESULTS_PENDING;
    if (missing > 0)
        peer_die(": `%s`: %zu of %zu cases are missing", s->name, missing, talk.task->count);
    if (s && !talk.timed)
        peer_die(": `%s`: no time", s->name);
}

static void peer_take_setting(const char *line)
{
    const size_t n = talk.task->count,
                 size = talk.task->labels ? 0 : talk.task->instants * 2 * STANCE_MAX_COORDINATES;
    struct peer_setting s = {.kind = NULL};
    int usual, at = 0;
    peer_whole();
    if (sscanf(line, "setting %lf %d %n", &s.step, &usual, &at) != 2 || at == 0 || !(s.step > 0))
        peer_damaged(line);
    snprintf(s.name, sizeof s.name, "%s", line + at);
    s.usual = usual == 1;
    s.kind = peer_room(n, sizeof *s.kind);
    s.rows = peer_room(n, sizeof *s.rows);
    s.state = peer_room(n * size, sizeof *s.state);
    memset(s.kind, RESULTS_PENDING, n);
    talk.peer->setting =
        realloc(talk.peer->setting, (talk.peer->settings + 1) * sizeof *talk.peer->setting);
    talk.peer->setting[talk.peer->settings++] = s;
    talk.checked = 0;
    talk.timed = false;
}

/* `count` numbers at the end of a line. */
static bool peer_numbers(const char *text, double *x, int count)
{
    for (int i = 0; i < count; i++) {
        char *end;
        x[i] = strtod(text, &end);
        if (end == text)
            return false;
        text = end;
    }
    return *text == '\0';
}

static void peer_take_acceleration(const char *line)
{
    static const double same = 1e-9; /* those that differ by more are of another model */
    const int n = talk.task->scene->coordinates;
    double a[STANCE_MAX_COORDINATES], size = 0, off = 0;
    int k, at = 0;
    if (sscanf(line, "acceleration %d %n", &k, &at) != 1 || at == 0 || k != talk.checked ||
        k >= PEER_CHECKS || !peer_numbers(line + at, a, n))
        peer_damaged(line);
    if (talk.peer->settings == 1) {
        const stance_case check = peer_check(k);
        accelerations(talk.task->scene, &check, talk.truth[k]);
    }
    for (int i = 0; i < n; i++) {
        size = fmax(size, fabs(talk.truth[k][i]));
        off = fmax(off, isfinite(a[i]) ? fabs(a[i] - talk.truth[k][i]) : INFINITY);
    }
    talk.checked++;
    talk.peer->off = fmax(talk.peer->off, off / size);
    if (!(off <= same * size))
        peer_die(": `%s` is another robot: accelerations differ by %.1e of their size",
                 peer_present()->name, off / size);
}

static void peer_take_state(const char *line)
{
    struct peer_setting *const s = peer_present();
    const size_t each = 2 * (size_t)talk.task->scene->coordinates;
    unsigned i, k;
    int at = 0;
    if (talk.task->labels || sscanf(line, "state %u %u %n", &i, &k, &at) != 2 || at == 0 ||
        i >= talk.task->count || k >= talk.task->instants || k != s->rows[i] ||
        !peer_numbers(line + at, s->state + (i * talk.task->instants + k) * each, (int)each))
        peer_damaged(line);
    s->rows[i]++;
}

static void peer_take_case(const char *line)
{
    struct peer_setting *const s = peer_present();
    char word[32];
    double end;
    unsigned i;
    uint8_t kind = 0;
    if (sscanf(line, "case %u %31s %lf", &i, word, &end) != 3 || i >= talk.task->count ||
        s->kind[i] != RESULTS_PENDING)
        peer_damaged(line);
    while (kind < RESULTS_KIND_COUNT && strcmp(word, results_kind_names[kind]) != 0)
        kind++;
    if (kind == RESULTS_KIND_COUNT || kind == RESULTS_PENDING ||
        (kind != RESULTS_FAILED && (kind == RESULTS_DONE) == talk.task->labels))
        peer_damaged(line);
    if (kind == RESULTS_DONE && s->rows[i] != talk.task->instants)
        peer_die(": `%s`: case %u has %zu of %zu states", s->name, i, s->rows[i],
                 talk.task->instants);
    s->kind[i] = kind;
}

static void peer_take_time(const char *line)
{
    struct bench_spread *const cost = &peer_present()->cost;
    int repetitions;
    if (sscanf(line, "time %lf %lf %lf %d", &cost->median, &cost->lowest, &cost->highest,
               &repetitions) != 4 ||
        !(cost->median > 0) || !isfinite(cost->median))
        peer_damaged(line);
    talk.timed = true;
}

static void peer_take(const char *line)
{
    struct peer *const p = talk.peer;
    static const struct {
        const char *word;
        void (*take)(const char *line);
    } known[] = {{"acceleration ", peer_take_acceleration},
                 {"state ", peer_take_state},
                 {"case ", peer_take_case},
                 {"time ", peer_take_time}};
    talk.lines++;
    if (!talk.ended && !p->name[0] && strncmp(line, "peer ", 5) == 0) {
        snprintf(p->name, sizeof p->name, "%s", line + 5);
        return;
    }
    if (talk.ended || !p->name[0])
        peer_damaged(line);
    if (p->settings == 0 && strncmp(line, "cannot ", 7) == 0) {
        snprintf(p->cannot, sizeof p->cannot, "%s", line + 7);
    } else if (strcmp(line, "end") == 0) {
        peer_whole();
        talk.ended = true;
    } else if (!p->cannot[0] && strncmp(line, "setting ", 8) == 0) {
        peer_take_setting(line);
    } else {
        size_t k = 0;
        while (k < 4 && strncmp(line, known[k].word, strlen(known[k].word)) != 0)
            k++;
        if (k == 4 || p->settings == 0)
            peer_damaged(line);
        if (k > 0 && talk.checked < PEER_CHECKS)
            peer_die(": `%s`: accelerations were not told first", peer_present()->name);
        known[k].take(line);
    }
}

/* ---- all of it ---------------------------------------------------------------------------- */

static void peer_too_silent(int number)
{
    (void)number; /* the reading has ended */
}

/* Runs the program, which may be silent for ten times its effort. */
static void peer_ask(const char *program, const struct peer_task *task, struct peer *peer)
{
    const double patience = 10 * task->effort;
    const struct sigaction silent = {.sa_handler = peer_too_silent};
    const struct itimerval wait = {.it_value = {(time_t)patience,
                                                (suseconds_t)(1e6 * fmod(patience, 1))}},
                           off = {.it_value = {0}};
    char *line = NULL;
    size_t size = 0;
    ssize_t n;
    int status = 0;
    memset(&talk, 0, sizeof talk);
    talk.task = task, talk.program = program, talk.peer = peer;
    FILE *const from = peer_begin();
    sigaction(SIGALRM, &silent, NULL);
    while (setitimer(ITIMER_REAL, &wait, NULL), errno = 0, (n = getline(&line, &size, from)) > 0) {
        line[n - (line[n - 1] == '\n')] = '\0';
        peer_take(line);
    }
    if (errno == EINTR)
        peer_die(" has said nothing for %g s", patience);
    setitimer(ITIMER_REAL, &off, NULL);
    fclose(from);
    free(line);
    while (waitpid(talk.child, &status, 0) < 0 && errno == EINTR)
        continue;
    talk.child = 0;
    if (WIFSIGNALED(status))
        peer_die(" died of signal %d", WTERMSIG(status));
    if (WEXITSTATUS(status) != 0)
        peer_die(" ended with exit code %d", WEXITSTATUS(status));
    if (!talk.ended)
        peer_die(" stopped in the middle of its answer");
}

static void peer_forget(struct peer *peer)
{
    for (size_t s = 0; s < peer->settings; s++) {
        free(peer->setting[s].kind);
        free(peer->setting[s].rows);
        free(peer->setting[s].state);
    }
    free(peer->setting);
    peer->setting = NULL;
}

#endif
