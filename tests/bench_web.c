/* bench_web.c - nanoseconds per step of the biped's kernels in the regimes of `stance bench`, by a
 * program of the engine alone: compiled for this machine and for WebAssembly it does the same work
 * (tests/bench_web.mjs). Prints "regime,method,isa,ns", a line for each kernel.
 * Usage: bench_web ISA    or, for other engines: bench_web cases, a line of JSON for each regime */
#include "cases.h"

#include <stdio.h>
#include <time.h>

enum { CASES = 32, STEPS = 1000 };
#define WARM 0.3 /* s */

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Cases of a second; where the regime wants a balance it is that of the golden cases. */
static void make_cases(const stance_workload *regime, stance_case *cases)
{
    uint64_t seed = 99, dice = 1;
    stance_case balanced;
    golden_case(&seed, 0, &balanced);
    for (int i = 0; i < CASES; i++) {
        stance_case *const c = &cases[i];
        *c = plain_case();
        if (regime->balance) {
            c->near = balanced.near;
            for (int k = 0; k < 3; k++)
                c->position[2 + k] = c->near.target[k];
            biped()->stand(biped(), c->robot, 1, c->position, c->velocity);
        }
        c->sample_every = 1;
        c->steps = STEPS;
        c->robot[STANCE_ROBOT_FALL_HEIGHT] = -1e9;
        regime->begin((double[2]){uniform(&dice, 0, 1), uniform(&dice, 0, 1)}, c);
    }
}

static void print_numbers(const char *name, const double *x, int n)
{
    for (int i = 0; i < n; i++)
        printf("%s%.17g", i ? "," : name, x[i]);
    printf("]");
}

static void print_cases(const char *regime, const stance_case *cases)
{
    const stance_case *const c = cases;
    printf("{\"regime\":\"%s\",\"contacts\":%u,\"limit\":%g", regime, c->contacts, c->torque_limit);
    print_numbers(",\"robot\":[", c->robot, 5);
    print_numbers(",\"friction\":[", &c->friction, 1);
    print_numbers(",\"target\":[", c->near.target, 3);
    print_numbers(",\"feedforward\":[", c->near.feedforward, 2);
    for (int i = 0; i < 2; i++)
        print_numbers(i ? ",[" : ",\"gain\":[[", c->near.gain[i], 6);
    for (int i = 0; i < CASES; i++) {
        print_numbers(i ? ",[[" : "],\"cases\":[[[", c[i].position, 5);
        print_numbers(",[", c[i].velocity, 5);
        printf("]");
    }
    printf("]}\n");
}

static double time_per_step(const stance_kernel *k, const stance_case *cases)
{
    static stance_result results[CASES];
    double steps = 0;
    const double begin = now();
    run_cases(k, cases, results, CASES);
    const double time = now() - begin;
    for (int i = 0; i < CASES; i++)
        steps += (double)results[i].steps;
    return time / steps;
}

int main(int argc, char **argv)
{
    static stance_case cases[CASES];
    if (argc != 2)
        return 2;
    for (const stance_workload *regime = biped()->workload; regime->name; regime++) {
        make_cases(regime, cases);
        if (strcmp(argv[1], "cases") == 0) {
            print_cases(regime->name, cases);
            continue;
        }
        for (const stance_method *const *method = stance_methods(); *method; method++) {
            const stance_kernel *const k = stance_kernel_find(biped(), *method, argv[1]);
            if (!k || strcmp(k->isa, argv[1]) != 0 || strcmp((*method)->name, "event-driven") == 0)
                continue;
            for (int i = 0; i < CASES; i++)
                cases[i].tolerance = (*method)->tolerance;
            for (const double begin = now(); now() - begin < WARM;) /* until it is compiled */
                time_per_step(k, cases);
            printf("%s,%s,%s,%.1f\n", regime->name, (*method)->name, k->isa,
                   1e9 * time_per_step(k, cases));
        }
    }
    return 0;
}
