/* peer.c - asks a program that drives another simulator, and checks all that it says. */
#include "peer.h"

#include "runner/base/message.h"
#include "runner/store/results.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static const double same = 1e-9; /* accelerations that differ by more are of another model */

/* ---- accelerations of ours ---------------------------------------------------------------- */

static double random_in(uint64_t *state, double low, double high)
{
    *state = *state * 6364136223846793005U + 1442695040888963407U;
    return low + (high - low) * (double)(*state >> 11) * 0x1p-53;
}

static void torque_limits(const stance_scene *scene, const stance_case *c, double *limit)
{
    double own[STANCE_MAX_ACTUATORS];
    for (int i = 0; i < scene->actuators; i++)
        own[i] = c->torque_limits[i] > 0 ? c->torque_limits[i] : INFINITY;
    stance_torque_limits(scene, c->robot, c->torque_limit, own, limit);
}

/* A state in flight, near the start or anywhere; the law's torques at its beginning are held. */
static stance_case check_case(const struct peer_task *task, int k)
{
    const stance_scene *const scene = task->scene;
    stance_case c = task->cases[0];
    uint64_t state = (uint64_t)k + 1;
    const double angle = k % 2 ? 3 : 0.02, rate = k % 2 ? 2 : 0.05;
    for (int i = 0; i < scene->coordinates; i++) {
        c.position[i] += random_in(&state, -angle, angle);
        c.velocity[i] = random_in(&state, -rate, rate);
    }
    c.position[1] = 100;
    c.sample_every = 1;
    return c;
}

/* The change of velocity over a step, extrapolated from ever shorter steps to none. */
static bool acceleration(const struct peer_task *task, int k, double *result)
{
    enum { LEVELS = 6 };
    const stance_kernel *const kernel =
        stance_kernel_find(task->scene, stance_method_find("lagrange"), "scalar");
    double table[LEVELS][STANCE_MAX_COORDINATES] = {{0}};
    if (!kernel)
        return false;
    for (int l = 0; l < LEVELS; l++) {
        stance_case c = check_case(task, k);
        stance_result end;
        c.step = ldexp(4e-3, -l);
        c.steps = 1;
        c.settle = false;
        kernel->run(&c, &end, 1);
        if (end.status != STANCE_DONE)
            return false;
        for (int i = 0; i < task->scene->coordinates; i++)
            table[l][i] = (end.velocity[i] - c.velocity[i]) / c.step;
    }
    for (int order = 1; order < LEVELS; order++)
        for (int l = LEVELS - 1; l >= order; l--)
            for (int i = 0; i < task->scene->coordinates; i++)
                table[l][i] += (table[l][i] - table[l - 1][i]) / (ldexp(1, order) - 1);
    memcpy(result, table[LEVELS - 1], sizeof table[0]);
    return true;
}

/* ---- the request -------------------------------------------------------------------------- */

static void put(FILE *out, const char *word, const double *x, int n)
{
    fprintf(out, "%s", word);
    for (int i = 0; i < n; i++)
        fprintf(out, " %.17g", x[i]);
    fputc('\n', out);
}

static void put_bits(FILE *out, const char *word, uint32_t bits, int n)
{
    fprintf(out, "%s", word);
    for (int c = 0; c < n; c++)
        fprintf(out, " %u", bits >> c & 1);
    fputc('\n', out);
}

static void put_state(FILE *out, const stance_scene *scene, const stance_case *c)
{
    put(out, "", c->position, scene->coordinates);
    put(out, "", c->velocity, scene->coordinates);
}

static bool write_request(FILE *out, const struct peer_task *task)
{
    const stance_scene *const scene = task->scene;
    const stance_case *const c = task->cases;
    double limit[STANCE_MAX_ACTUATORS];
    torque_limits(scene, c, limit);
    fprintf(out, "stance-peer 1\nscene %s\nrobot %d", scene->name, scene->robot_count);
    put(out, "", c->robot, scene->robot_count);
    put(out, "gravity", &c->robot[STANCE_ROBOT_GRAVITY], 1);
    put(out, "friction", &c->friction, 1);
    put(out, "restitution", &c->restitution, 1);
    put_bits(out, "contacts", c->contacts, scene->contacts);
    put(out, "feedforward", c->near.feedforward, scene->actuators);
    fputs("gain", out);
    for (int i = 0; i < scene->actuators; i++)
        put(out, "", c->near.gain[i], 2 * scene->postures);
    put(out, "\ntarget", c->near.target, scene->postures);
    put(out, "limit", limit, scene->actuators);
    fprintf(out, "sample %.17g\ntime %.17g\nevery %.17g\nlabels %d\n",
            (double)c->sample_every * c->step, task->time, task->every, task->labels);
    fprintf(out, "settle %.17g %.17g %.17g\nplace %.17g\nfall_height %.17g\n", c->settle_angle,
            c->settle_rate, c->settle_hold, c->settle_place > 0 ? c->settle_place : INFINITY,
            c->fall_height);
    put_bits(out, "supports", c->supports, scene->contacts);
    fprintf(out, "budget %.17g\neffort %.17g\nchecks %d\n", task->budget, task->effort,
            PEER_CHECKS);
    for (int k = 0; k < PEER_CHECKS; k++) {
        const stance_case check = check_case(task, k);
        put_state(out, scene, &check);
    }
    fprintf(out, "cases %zu\n", task->count);
    for (size_t i = 0; i < task->count; i++)
        put_state(out, scene, &task->cases[i]);
    fputs("end\n", out);
    return fflush(out) == 0 && !ferror(out);
}

/* ---- the program -------------------------------------------------------------------------- */

struct talk {
    const struct peer_task *task;
    const char *program;
    struct peer_answer *answer;
    stance_message *message;
    pid_t child;
    int from;
    char *text; /* what has been read and not yet taken */
    size_t length, room;
    unsigned long lines;
    double (*truth)[STANCE_MAX_COORDINATES]; /* accelerations of ours */
    int checked;
    bool timed, ended;
};

static bool begin_program(struct talk *talk)
{
    FILE *const request = tmpfile(); /* no pipe: it may die before it has read it */
    int pipes[2];
    if (!request || !write_request(request, talk->task) || pipe(pipes) != 0) {
        if (request)
            fclose(request);
        return complain(talk->message, "cannot write what a peer is asked: %s", strerror(errno));
    }
    rewind(request);
    talk->child = fork();
    if (talk->child == 0) {
        setpgid(0, 0);
        dup2(fileno(request), STDIN_FILENO);
        lseek(STDIN_FILENO, 0, SEEK_SET);
        dup2(pipes[1], STDOUT_FILENO);
        close(pipes[0]);
        execlp(talk->program, talk->program, (char *)NULL);
        fprintf(stderr, "%s: %s\n", talk->program, strerror(errno));
        _exit(127);
    }
    fclose(request);
    close(pipes[1]);
    talk->from = pipes[0];
    return talk->child > 0 || complain(talk->message, "cannot start %.100s", talk->program);
}

static bool grow(struct talk *talk)
{
    if (talk->length + 65536 <= talk->room)
        return true;
    const size_t room = 2 * talk->room + 131072;
    char *const text = realloc(talk->text, room);
    if (!text)
        return no_memory(talk->message);
    talk->text = text, talk->room = room;
    return true;
}

/* More of what it says; *end: that was all. */
static bool hear(struct talk *talk, bool *end)
{
    struct pollfd waiting = {.fd = talk->from, .events = POLLIN};
    if (!grow(talk))
        return false;
    const int ready = poll(&waiting, 1, (int)(1000 * talk->task->patience));
    if (ready == 0)
        return complain(talk->message, "%.100s has said nothing for %g s", talk->program,
                        talk->task->patience);
    const ssize_t n =
        ready < 0 ? -1 : read(talk->from, talk->text + talk->length, talk->room - talk->length - 1);
    if (n < 0 && errno != EINTR)
        return complain(talk->message, "%.100s cannot be read: %s", talk->program, strerror(errno));
    *end = n == 0;
    talk->length += n > 0 ? (size_t)n : 0;
    return true;
}

/* ---- what it says ------------------------------------------------------------------------- */

static bool damaged(struct talk *talk, const char *line)
{
    return complain(talk->message, "%.80s: line %lu is not understood: %.60s", talk->program,
                    talk->lines, line);
}

static struct peer_setting *present(const struct talk *talk)
{
    return talk->answer->settings > 0 ? &talk->answer->setting[talk->answer->settings - 1] : NULL;
}

/* Is all there that a setting must say? */
static bool whole(struct talk *talk)
{
    const struct peer_setting *const s = present(talk);
    if (!s)
        return true;
    size_t missing = 0;
    for (size_t i = 0; i < talk->task->count; i++)
        missing += s->kind[i] == RESULTS_PENDING;
    if (missing > 0)
        return complain(talk->message, "%.80s: `%s`: %zu of %zu cases are missing", talk->program,
                        s->name, missing, talk->task->count);
    if (!talk->timed)
        return complain(talk->message, "%.80s: `%s`: no time", talk->program, s->name);
    return true;
}

static bool take_setting(struct talk *talk, const char *line)
{
    struct peer_answer *const a = talk->answer;
    const size_t n = talk->task->count, size = n * a->instants * 2 * STANCE_MAX_COORDINATES;
    struct peer_setting s = {.off = 0};
    int usual, at = 0;
    if (!whole(talk))
        return false;
    if (sscanf(line, "setting %lf %d %n", &s.step, &usual, &at) != 2 || at == 0 || !(s.step > 0))
        return damaged(talk, line);
    snprintf(s.name, sizeof s.name, "%s", line + at);
    s.usual = usual == 1;
    struct peer_setting *const more = realloc(a->setting, (a->settings + 1) * sizeof *more);
    if (!more)
        return no_memory(talk->message);
    a->setting = more;
    s.kind = malloc(n);
    s.rows = calloc(n, sizeof *s.rows);
    s.state = talk->task->labels ? NULL : malloc(size * sizeof *s.state);
    a->setting[a->settings++] = s;
    if (!s.kind || !s.rows || (!s.state && !talk->task->labels))
        return no_memory(talk->message);
    memset(s.kind, RESULTS_PENDING, n);
    talk->checked = 0;
    talk->timed = false;
    return true;
}

/* `count` numbers at the end of a line. */
static bool numbers(const char *text, double *x, int count)
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

static bool take_acceleration(struct talk *talk, const char *line)
{
    struct peer_setting *const s = present(talk);
    double a[STANCE_MAX_COORDINATES], size = 0, off = 0;
    int k, at = 0;
    if (sscanf(line, "acceleration %d %n", &k, &at) != 1 || at == 0 || k != talk->checked ||
        k >= PEER_CHECKS || !numbers(line + at, a, talk->task->scene->coordinates))
        return damaged(talk, line);
    if (talk->answer->settings == 1 && !acceleration(talk->task, k, talk->truth[k]))
        return complain(talk->message, "no accelerations of ours to compare with");
    for (int i = 0; i < talk->task->scene->coordinates; i++) {
        size = fmax(size, fabs(talk->truth[k][i]));
        off = fmax(off, isfinite(a[i]) ? fabs(a[i] - talk->truth[k][i]) : INFINITY);
    }
    s->off = fmax(s->off, off / size);
    talk->checked++;
    if (s->off > same)
        return complain(talk->message,
                        "%.80s: `%s` is another robot: accelerations differ by %.1e of their size",
                        talk->program, s->name, s->off);
    return true;
}

static bool take_state(struct talk *talk, const char *line)
{
    struct peer_setting *const s = present(talk);
    const size_t each = 2 * (size_t)talk->task->scene->coordinates;
    unsigned i, k;
    int at = 0;
    if (talk->task->labels || sscanf(line, "state %u %u %n", &i, &k, &at) != 2 || at == 0 ||
        i >= talk->task->count || k >= talk->answer->instants || k != s->rows[i] ||
        !numbers(line + at, s->state + (i * talk->answer->instants + k) * each, (int)each))
        return damaged(talk, line);
    s->rows[i]++;
    return true;
}

static bool take_case(struct talk *talk, const char *line)
{
    struct peer_setting *const s = present(talk);
    char word[32];
    double end;
    unsigned i;
    uint8_t kind = 0;
    if (sscanf(line, "case %u %31s %lf", &i, word, &end) != 3 || i >= talk->task->count ||
        s->kind[i] != RESULTS_PENDING)
        return damaged(talk, line);
    while (kind < RESULTS_KIND_COUNT && strcmp(word, results_kind_names[kind]) != 0)
        kind++;
    if (kind == RESULTS_KIND_COUNT || kind == RESULTS_PENDING ||
        (kind != RESULTS_FAILED && (kind == RESULTS_DONE) == talk->task->labels))
        return damaged(talk, line);
    if (kind == RESULTS_DONE && s->rows[i] != talk->answer->instants)
        return complain(talk->message, "%.80s: `%s`: case %u has %zu of %zu states", talk->program,
                        s->name, i, s->rows[i], talk->answer->instants);
    s->kind[i] = kind;
    return true;
}

static bool take_time(struct talk *talk, const char *line)
{
    struct measure_cost *const cost = &present(talk)->cost;
    if (sscanf(line, "time %lf %lf %lf %d", &cost->median, &cost->low, &cost->high,
               &cost->repetitions) != 4 ||
        !(cost->median > 0) || !isfinite(cost->median))
        return damaged(talk, line);
    talk->timed = true;
    return true;
}

static bool begins(const char *line, const char *word)
{
    return strncmp(line, word, strlen(word)) == 0;
}

static bool take_line(struct talk *talk, const char *line)
{
    struct peer_answer *const a = talk->answer;
    talk->lines++;
    if (talk->ended)
        return damaged(talk, line);
    if (begins(line, "peer ") && a->name[0] == '\0')
        return snprintf(a->name, sizeof a->name, "%s", line + 5) > 0;
    if (a->name[0] == '\0')
        return damaged(talk, line);
    if (begins(line, "cannot ") && a->settings == 0)
        return snprintf(a->cannot, sizeof a->cannot, "%s", line + 7) > 0;
    if (strcmp(line, "end") == 0)
        return (talk->ended = true) && whole(talk);
    if (begins(line, "setting ") && a->cannot[0] == '\0')
        return take_setting(talk, line);
    if (a->settings == 0)
        return damaged(talk, line);
    if (begins(line, "acceleration "))
        return take_acceleration(talk, line);
    if (talk->checked < PEER_CHECKS)
        return complain(talk->message, "%.80s: `%s`: accelerations were not told first",
                        talk->program, present(talk)->name);
    return begins(line, "state ")  ? take_state(talk, line)
           : begins(line, "case ") ? take_case(talk, line)
           : begins(line, "time ") ? take_time(talk, line)
                                   : damaged(talk, line);
}

/* All whole lines heard so far. */
static bool take_lines(struct talk *talk)
{
    size_t from = 0;
    bool good = true;
    for (char *end; good && (end = memchr(talk->text + from, '\n', talk->length - from));) {
        *end = '\0';
        // NOLINTNEXTLINE(clang-analyzer-unix.Malloc): peer_ask frees the text
        good = take_line(talk, talk->text + from);
        from = (size_t)(end - talk->text) + 1;
    }
    memmove(talk->text, talk->text + from, talk->length - from);
    talk->length -= from;
    return good;
}

/* ---- all of it ---------------------------------------------------------------------------- */

static bool listen_to(struct talk *talk)
{
    bool good = true, end = false;
    while (good && !end)
        good = hear(talk, &end) && take_lines(talk);
    if (!good)
        kill(-talk->child, SIGKILL);
    int status = 0;
    while (waitpid(talk->child, &status, 0) < 0 && errno == EINTR)
        continue;
    if (!good)
        return false;
    if (WIFSIGNALED(status))
        return complain(talk->message, "%.100s died of signal %d", talk->program, WTERMSIG(status));
    if (WEXITSTATUS(status) != 0)
        return complain(talk->message, "%.100s ended with exit code %d", talk->program,
                        WEXITSTATUS(status));
    return talk->ended ||
           complain(talk->message, "%.100s stopped in the middle of its answer", talk->program);
}

bool peer_ask(const char *program, const struct peer_task *task, struct peer_answer *answer,
              stance_message *message)
{
    struct talk talk = {
        .task = task, .program = program, .answer = answer, .message = message, .from = -1};
    *answer = (struct peer_answer){.instants = (size_t)(task->time / task->every + 1.5)};
    talk.truth = calloc(PEER_CHECKS, sizeof *talk.truth);
    bool good = talk.truth || no_memory(message);
    good = good && begin_program(&talk) && listen_to(&talk);
    if (talk.from >= 0)
        close(talk.from);
    free(talk.text);
    free(talk.truth);
    if (!good)
        peer_answer_free(answer);
    return good;
}

void peer_answer_free(struct peer_answer *answer)
{
    for (size_t s = 0; s < answer->settings; s++) {
        free(answer->setting[s].kind);
        free(answer->setting[s].rows);
        free(answer->setting[s].state);
    }
    free(answer->setting);
    *answer = (struct peer_answer){.settings = 0};
}
