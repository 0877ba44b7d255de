/* design.h - what control theory says about a scenario's base values: computed, then printed for
 * people or as JSON. */
#ifndef STANCE_PLAN_DESIGN_H
#define STANCE_PLAN_DESIGN_H

#include "resolve.h"

#include <jansson.h>

enum {
    DESIGN_STATES = 2 * STANCE_MAX_POSTURE,
    DESIGN_INPUTS = STANCE_MAX_ACTUATORS,
    /* Each torque up and down, the cone twice, lift-off, the plane of a bimodal law. */
    DESIGN_BOUNDS = 2 * DESIGN_INPUTS + 4,
    DESIGN_PLANT = DESIGN_STATES + DESIGN_INPUTS,                  /* with torques that lag */
    DESIGN_LOOP = DESIGN_PLANT + STANCE_MAX_DELAY * DESIGN_INPUTS, /* and those under way */
};

#define DESIGN_LONGEST 10.0 /* s: up to where the critical sample time is searched */

/* The Lyapunov function of the loop and the largest sublevel set in which, to first order, no bound
 * is met: V = X' P X falls by sum (X_i / tolerance_i)^2 a second (a sample), the tolerances those
 * of stop.settle: the loop pays for a departure as the outcome rules see it. */
struct design_set {
    bool exists;
    const char *absent; /* why not */
    double P[DESIGN_STATES * DESIGN_STATES];
    stance_sublevel_set of;
};

/* The states from which linear theory allows any controller to recover, while the contacts stand:
 * null_controllable.c. */
struct design_allowed {
    bool exists;
    stance_message absent; /* why not */
    int modes;             /* that are unstable, with their eigenvalues */
    double re[STANCE_NULL_MODES], im[STANCE_NULL_MODES];
    int unreached; /* that no torque moves and that do not decay */
    double unreached_re[DESIGN_STATES], unreached_im[DESIGN_STATES];
    double reach[2][DESIGN_STATES]; /* of each state alone, down and up; INFINITY */
};

/* "foot1", "foot1, foot2": what an equilibrium stands on. Returns buffer. */
const char *design_supports(const stance_scene *scene, const stance_equilibrium *equilibrium,
                            char *buffer, size_t size);

/* Matrices are row-major with `states` and `inputs` as their sizes. */
struct design_report {
    const struct scenario *scenario;
    int states, inputs;
    double model[STANCE_MAX_ROBOT];
    stance_equilibrium equilibrium;
    stance_message remark; /* on it; empty: none */
    double normal;         /* N: the supports' normal forces together */
    double A[DESIGN_STATES * DESIGN_STATES], B[DESIGN_STATES * DESIGN_INPUTS];
    double open_re[DESIGN_STATES], open_im[DESIGN_STATES];
    double singular[DESIGN_STATES];
    int rank;
    struct design_allowed allowed;
    bool closed; /* there is a law: the rest is valid */
    double K[DESIGN_INPUTS * DESIGN_STATES];
    double closed_re[DESIGN_STATES], closed_im[DESIGN_STATES];
    stance_robustness how;
    /* Of a bimodal law: the plane, and the loop that it makes beyond. */
    bool bends;
    double plane[DESIGN_STATES], push[DESIGN_INPUTS];
    double beyond_re[DESIGN_STATES], beyond_im[DESIGN_STATES];
    int delay, sampled; /* delay of the scenario; number of sampled eigenvalues, 0: continuous */
    double lag;         /* s, of the scenario's actuators */
    double sampled_re[DESIGN_LOOP], sampled_im[DESIGN_LOOP];
    double radius; /* largest of their moduli */
    bool stable;   /* as the controller acts: sampled, late and with a lag, or continuously */
    /* s, with that lag, without a delay and with the scenario's, or of one sample; 0: the
     * continuous loop is unstable, INFINITY: none found. */
    double critical[2];
    /* Of a loop that is sampled and stable: up to how many samples late it is, of at most
     * STANCE_MAX_DELAY; from which lag on it is not, INFINITY: none found; by how much the noise of
     * the scenario makes states wander, rms at samples, and, N m or N, commands at least. */
    int delay_margin;
    double lag_margin;
    bool noisy;
    double wander[DESIGN_STATES], command_noise[DESIGN_INPUTS];
    struct design_set set;
};

/* What is known of the selections of coordinates that a decoupling law may control, in
 * stance_selection's order: facts (runner/base/say.h) and their text. `singular` says so where the
 * scenario's is, at the start. NULL: `message` says what does not exist. */
json_t *design_selections(const struct scenario *s, stance_message *singular,
                          stance_message *message);
extern const char design_selections_text[];

/* false: `message` says what does not exist. design_plant: up to `rank`, whatever the law;
 * design_loop: without `allowed`, `critical` and `set`, which take longer, and with the
 * gains of a design that is known (NULL: none is), which took long perhaps. */
bool design_plant(struct design_report *r, const struct scenario *s, stance_message *message);
bool design_loop(struct design_report *r, const struct scenario *s,
                 const struct resolved_design *known, stance_message *message);
bool design_compute(struct design_report *r, const struct scenario *s, stance_message *message);

/* The set itself, of the report's linearisation and limits; NULL: `message` says why not. */
stance_null_set *design_null_set(const struct design_report *r, stance_message *message);

/* K[inputs][states] beyond the plane of a bimodal law. */
void design_beyond(const struct design_report *r, double *K);

/* Name of state i: a coordinate, or its rate with a "v" before it. */
const char *design_state_name(const struct design_report *r, int i, char name[SCENARIO_NAME]);

/* The spectral radius, in so many digits, or as many as tell it from 1. */
const char *design_radius(const struct design_report *r, int digits, char text[32]);

/* Its weight in a quadratic cost. */
static inline double design_weight(const struct design_report *r, int i)
{
    return r->scenario->base.state_weights[resolve_state(r->scenario->scene, &r->equilibrium, i)];
}

/* ", `verb`2 samples late", or nothing. Returns buffer. */
const char *design_late(int delay, const char *verb, char buffer[64]);

/* What a bound of the set is. */
const char *design_bound_name(const struct design_report *r, int bound, char name[64]);

/* Puts complex numbers among facts, [[re, im], ...]; with a dot before the key, which it has, for
 * people. */
void design_put_complex(json_t *facts, const char *key, int n, const double *re, const double *im);
/* What `stance design` says (runner/base/say.h): a new reference, and for people its text. */
json_t *design_facts(const struct design_report *r);
extern const char design_text[];

#endif
