/* stance_law.h - what a control law of one's own is written with: one C function, called at each
 * sample, and what it is told, asks for and gives.
 *
 *     #define PARAMETERS(X) \
 *         X(stiffness, 50, "N m/rad", 0, 1e4, "of the hip, towards where it began") \
 *         X(weight[4], 0, "1", -10, 10, "of what follows")
 *     #define MEMORY(X) X(begun) X(hip)
 *     #include "stance_law.h"
 *
 *     void law(const struct sample *now, const struct parameters *is, struct memory *mine, struct
 * torques *out)
 *     {
 *         if (!mine->begun)
 *             mine->begun = 1, mine->hip = now->q.hip;
 *         out->hip = -is->stiffness * (now->q.hip - mine->hip) - 2 * now->v.hip;
 *     }
 *
 * A parameter is a name, how many numbers it is where it is not one, its default, unit, range, and
 * what it is: a key of the scenario, controller.stiffness. MEMORY are numbers that are the case's
 * own: 0 at its beginning, kept from sample to sample. Both may be left out; variables that outlive
 * a call are refused: cases run side by side, in any order. Lists of the scenario's
 * controller.data are the array data[DATA].
 *
 * Names are those of the scenario, with _ for what C does not allow, and _ behind C's own words;
 * all[] has the same numbers in the order of the scenario, in which the last POSTURES coordinates
 * are what moves the robot in itself: all but the place of a free root. Angles rad, places m,
 * torques N m, forces of what slides N.
 *
 * sin, cos, tan, asin, acos, atan, atan2, exp, tanh, sqrt, fabs, fma, fmin, fmax, floor and
 * copysign compute the same bits on every machine, and there are no others.
 */
#ifndef STANCE_LAW_H
#define STANCE_LAW_H

#include "law_math.h"

#include <math.h>

#if __has_include(<names.h>)
#include <names.h> /* LAW_COORDINATES(X) and so on, data[DATA]: made of the scenario */
#else              /* for an editor */
#define LAW_COORDINATES(X) X(x)
#define LAW_CONTACTS(X) X(foot)
#define LAW_ACTUATORS(X) X(hip)
enum { COORDINATES = 1, CONTACTS = 1, ACTUATORS = 1, POSTURES = 1, DATA = 1 };
static const double data[DATA];
#endif

#define LAW_FIELD(name) double name;
struct coordinates {
    union {
        struct {
            LAW_COORDINATES(LAW_FIELD)
        };
        double all[COORDINATES];
    };
};
struct contacts {
    union {
        struct {
            LAW_CONTACTS(LAW_FIELD)
        };
        double all[CONTACTS];
    };
};
struct torques {
    union {
        struct {
            LAW_ACTUATORS(LAW_FIELD)
        };
        double all[ACTUATORS];
    };
};

struct sample {
    double time;               /* s */
    double period;             /* s, to the next sample */
    double since;              /* s, since another foot landed, or since the beginning */
    double footfalls;          /* how often one has */
    double foot;               /* which contact landed last, in their order; -1: none has */
    struct coordinates q, v;   /* and rates, as they are measured */
    struct contacts stands;    /* 1: is on the ground, 0: is not */
    struct coordinates target; /* the equilibrium that the scenario names; NAN: it names none ... */
    struct torques rest;       /* ... and the torques there */
};

#ifndef PARAMETERS
#define PARAMETERS(X)
#endif
#ifndef MEMORY
#define MEMORY(X)
#endif
#define LAW_PARAMETER(name, ...) double name;
#define LAW_NAME(name, ...) #name ";"
struct parameters {
    PARAMETERS(LAW_PARAMETER)
};
struct memory {
    MEMORY(LAW_FIELD)
};

/* The law: out is 0 before. */
void law(const struct sample *now, const struct parameters *is, struct memory *mine,
         struct torques *out);

#define sin law_sin
#define cos law_cos
#define tan law_tan
#define asin law_asin
#define acos law_acos
#define atan law_atan
#define atan2 law_atan2
#define exp law_exp
#define tanh law_tanh
#define fma law_fma
#define fmin law_fmin
#define fmax law_fmax
#define floor law_floor
#if defined(__FMA__) || defined(__aarch64__)
static inline double law_fma(double a, double b, double c)
{
    return __builtin_fma(a, b, c);
}
#else
double law_fma(double a, double b, double c);
#endif
static inline double law_fmin(double a, double b)
{
    return a < b || b != b ? a : b;
}
static inline double law_fmax(double a, double b)
{
    return a > b || b != b ? a : b;
}

#ifdef __wasm__ /* in a page: numbers are copied to and from one room (page_law.c) */
enum {
    LAW_SAMPLE = sizeof(struct sample) / sizeof(double),
    LAW_PARAMETERS = sizeof(struct parameters) / sizeof(double),
    LAW_MEMORY = sizeof(struct memory) / sizeof(double)
};
static struct {
    double number[LAW_SAMPLE + LAW_PARAMETERS + LAW_MEMORY + ACTUATORS];
} law_copy;
__attribute__((export_name("room"))) double *law_room(void);
double *law_room(void)
{
    return law_copy.number;
}
__attribute__((export_name("memory_size"))) int law_memory_size(void);
int law_memory_size(void)
{
    return LAW_MEMORY;
}
__attribute__((export_name("call"))) void law_call(void);
void law_call(void)
{
    double *const at = law_copy.number;
    law((const struct sample *)at, (const struct parameters *)(at + LAW_SAMPLE),
        (struct memory *)(at + LAW_SAMPLE + LAW_PARAMETERS),
        (struct torques *)(at + LAW_SAMPLE + LAW_PARAMETERS + LAW_MEMORY));
}
#endif

/* What the program looks for. */
struct law_object {
    unsigned long sample, parameters, memory, torques; /* bytes */
    const char *names;
    void (*law)(const struct sample *now, const struct parameters *is, struct memory *mine,
                struct torques *out);
};
extern __attribute__((visibility("default"))) const struct law_object stance_law_object;
const struct law_object stance_law_object = {sizeof(struct sample),   sizeof(struct parameters),
                                             sizeof(struct memory),   sizeof(struct torques),
                                             PARAMETERS(LAW_NAME) "", law};

#endif
