/* bench.c - the workloads of the speed benchmarks, and their results as CSV. */
#include "bench.h"

#include "runner/store/build_info.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <time.h>

enum { STEPS = 1000 };
static const double step = 1e-3; /* s */

/* Numbers in [0, 1) that are the same everywhere and evenly spread however many are taken. */
static double even(int i, int k)
{
    const double x = (i + 1) * (k == 0 ? 0.6180339887498949 : 0.7548776662466927);
    return x - floor(x);
}

/* ---- workloads ---------------------------------------------------------------------------- */

/* Makes *c, a copy of what all cases of the workload share, the i-th of them. */
typedef void regime_maker(const stance_scene *scene, int i, stance_case *c);
/* Gives what they share a controller. */
typedef bool regime_controller(const stance_scene *scene, stance_case *c);

static void ball_flight(const stance_scene *scene, int i, stance_case *c)
{
    (void)scene;
    c->position[1] = 1000;
    c->velocity[0] = 4 * even(i, 0) - 2;
}

/* Friction 0.05 takes 0.5 m/s in a second. */
static void ball_sliding(const stance_scene *scene, int i, stance_case *c)
{
    (void)scene;
    c->friction = 0.05;
    c->position[1] = c->robot[1];
    c->velocity[0] = 1 + even(i, 0);
}

static void block_at_rest(const stance_scene *scene, int i, stance_case *c)
{
    (void)scene;
    c->robot[1] = 0.6 * even(i, 0); /* arctan 0.8 = 0.67 */
}

static void block_sliding(const stance_scene *scene, int i, stance_case *c)
{
    (void)scene;
    c->friction = 0.3;
    c->robot[1] = 0.5 + 0.5 * even(i, 0);
}

static void rod_flight(const stance_scene *scene, int i, stance_case *c)
{
    (void)scene;
    c->position[1] = 1000;
    c->velocity[2] = 8 * even(i, 0) - 4;
}

/* Upright on an end but for a hundredth: it tilts about that end for more than a second. */
static void rod_on_one_end(const stance_scene *scene, int i, stance_case *c)
{
    double gap[STANCE_MAX_CONTACTS];
    c->position[2] = 1.5707963267948966 + 0.02 * even(i, 0) - 0.01;
    scene->gaps(c->robot, c->position, gap);
    c->position[1] -= gap[0];
}

static void rod_on_two_ends(const stance_scene *scene, int i, stance_case *c)
{
    (void)scene;
    c->friction = 0.05;
    c->position[1] = c->position[2] = 0;
    c->velocity[0] = 1 + even(i, 0);
}

/* The paper's balance controller at its equilibrium. */
static bool biped_balance(const stance_scene *scene, stance_case *c)
{
    const stance_equilibrium_choice choice = {0, {-0.41, NAN, 0.82}, false};
    static const double re[6] = {-3, -3.3, -3.6, -3.9, -4.2, -4.6}, im[6] = {0};
    stance_equilibrium equilibrium;
    double A[36], B[12];
    if (scene->equilibrium(c->robot, &choice, &equilibrium, NULL) != STANCE_OK ||
        scene->linearise(c->robot, &equilibrium, A, B) != STANCE_OK ||
        stance_place(6, 2, A, B, re, im, &c->near.gain[0][0], NULL, NULL, NULL) != STANCE_OK)
        return false;
    memcpy(c->position, equilibrium.position, sizeof c->position);
    memcpy(c->near.feedforward, equilibrium.torque, sizeof c->near.feedforward);
    for (int k = 0; k < scene->postures; k++)
        c->near.target[k] = equilibrium.position[scene->posture[k]];
    c->torque_limit = 10;
    c->has_target = true;
    return true;
}

static void biped_flight(const stance_scene *scene, int i, stance_case *c)
{
    (void)scene;
    c->position[1] += 1000;
    for (int k = 2; k < 5; k++)
        c->velocity[k] = 4 * even(i, k % 2) - 2;
}

static void biped_on_one_foot(const stance_scene *scene, int i, stance_case *c)
{
    c->contacts = 1;
    c->position[2] += -0.09 + 0.1 * even(i, 0);
    scene->stand(c->robot, 0, c->position, c->velocity);
}

/* The legs held apart. */
static bool biped_servo(const stance_scene *scene, stance_case *c)
{
    const double leg = 0.5;
    (void)scene;
    c->torque_limit = 100;
    for (int k = 0; k < 2; k++) {
        c->near.gain[k][1 + k] = 200, c->near.gain[k][4 + k] = 10;
        c->near.target[1 + k] = k ? -leg : leg;
        c->position[3 + k] = c->near.target[1 + k];
    }
    return true;
}

static void biped_on_two_feet(const stance_scene *scene, int i, stance_case *c)
{
    c->position[2] = -0.02 * even(i, 0); /* the other foot up to a centimetre high */
    scene->stand(c->robot, 0, c->position, c->velocity);
}

static const struct regime {
    const char *scene, *name;
    regime_maker *make;
    regime_controller *control; /* NULL: none */
} regimes[] = {
    {"ball", "flight", ball_flight, NULL},
    {"ball", "sliding", ball_sliding, NULL},
    {"block", "at rest", block_at_rest, NULL},
    {"block", "sliding", block_sliding, NULL},
    {"rod", "flight", rod_flight, NULL},
    {"rod", "one end", rod_on_one_end, NULL},
    {"rod", "two ends", rod_on_two_ends, NULL},
    {"biped", "flight", biped_flight, biped_balance},
    {"biped", "one foot", biped_on_one_foot, biped_balance},
    {"biped", "two feet", biped_on_two_feet, biped_servo},
};
enum { REGIMES = sizeof regimes / sizeof regimes[0] };

const char *bench_regime(const stance_scene *scene, int index)
{
    for (int r = 0; r < REGIMES; r++)
        if (strcmp(regimes[r].scene, scene->name) == 0 && index-- == 0)
            return regimes[r].name;
    return NULL;
}

bool bench_cases(const stance_scene *scene, const char *regime, stance_case *cases, int count)
{
    stance_case base = {.friction = 0.8,
                        .contacts = (1U << scene->contacts) - 1,
                        .torque_limit = INFINITY,
                        .sample_every = 1,
                        .step = step,
                        .steps = STEPS,
                        .settle_angle = 0.05,
                        .settle_rate = 0.5,
                        .settle_hold = 0.5,
                        .fall_height = -1e9 /* never */};
    for (int k = 0; k < scene->robot_count; k++)
        base.robot[k] = scene->robot[k].fallback;
    int r = 0;
    while (r < REGIMES &&
           (strcmp(regimes[r].scene, scene->name) != 0 || strcmp(regimes[r].name, regime) != 0))
        r++;
    if (r == REGIMES || (regimes[r].control && !regimes[r].control(scene, &base)))
        return false;
    for (int i = 0; i < count; i++) {
        cases[i] = base;
        regimes[r].make(scene, i, &cases[i]);
    }
    return true;
}

/* ---- measuring ---------------------------------------------------------------------------- */

double bench_clock(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

struct bench_spread bench_spread(double *values, int n)
{
    qsort(values, (size_t)n, sizeof *values, ascending);
    return (struct bench_spread){(values[(n - 1) / 2] + values[n / 2]) / 2, values[0],
                                 values[n - 1]};
}

/* ---- CSV ---------------------------------------------------------------------------------- */

void bench_csv_head(FILE *out)
{
    fputs("subject,scene,regime,method,isa,lanes,ranks,step_s,cases,repeats,quantity,unit,median,"
          "lowest,highest,revision,compiler,flags,processor,machine,date\n",
          out);
}

/* As a field of its own, whatever is in it. */
static void put_text(FILE *out, const char *text)
{
    for (; *text; text++)
        putc(*text == ',' || *text == '"' || (unsigned char)*text < ' ' ? ' ' : *text, out);
}

static void put_count(FILE *out, int count)
{
    if (count > 0)
        fprintf(out, "%d", count);
    putc(',', out);
}

/* What /proc/cpuinfo calls the processor, or else its architecture. */
static void put_processor(FILE *out, const char *architecture)
{
    FILE *list = fopen("/proc/cpuinfo", "r");
    char line[256];
    while (list && fgets(line, sizeof line, list)) {
        char *colon = strchr(line, ':');
        if (strncmp(line, "model name", 10) == 0 && colon) {
            line[strcspn(line, "\n")] = '\0';
            put_text(out, colon + 1 + (colon[1] == ' '));
            architecture = "";
            break;
        }
    }
    if (list)
        fclose(list);
    put_text(out, architecture);
}

void bench_csv_row(FILE *out, const struct bench_row *row)
{
    const char *const words[] = {row->subject, row->scene, row->regime, row->method, row->isa};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        put_text(out, words[i] ? words[i] : "");
        putc(',', out);
    }
    put_count(out, row->lanes);
    put_count(out, row->ranks);
    if (row->step > 0)
        fprintf(out, "%g", row->step);
    putc(',', out);
    put_count(out, row->cases);
    put_count(out, row->repeats);
    fprintf(out, "%s,%s,%.6g,%.6g,%.6g,", row->quantity, row->unit, row->value.median,
            row->value.lowest, row->value.highest);

    struct utsname machine = {.machine = "unknown", .nodename = "unknown"};
    uname(&machine);
    const char *const build[] = {build_revision(), build_compiler(), build_flags()};
    for (size_t i = 0; i < sizeof build / sizeof build[0]; i++) {
        put_text(out, build[i]);
        putc(',', out);
    }
    put_processor(out, machine.machine);
    putc(',', out);
    put_text(out, machine.nodename);
    const time_t now = time(NULL);
    struct tm day;
    char date[16] = "";
    if (gmtime_r(&now, &day))
        strftime(date, sizeof date, "%Y-%m-%d", &day);
    fprintf(out, ",%s\n", date);
}
