/* resolve.h - from the numbers of one case to what the engine runs.
 *
 * Split in two so that results do not depend on the processor: `resolve_design` uses LAPACK and
 * libm and may differ in the last bit between machines; it is computed once per distinct design,
 * stored in the file, and read from there. `resolve_case` uses only IEEE arithmetic and the
 * engine's own sine and cosine.
 */
#ifndef STANCE_PLAN_RESOLVE_H
#define STANCE_PLAN_RESOLVE_H

#include "engine/control/design.h"

#include "runner/scenario/scenario.h"

/* What depends on fields marked `design` in the schema only (robot.*, initial.equilibrium.*,
 * initial.support_foot, controller.kind, .design, .design_time, .model.*, .equilibrium.*, .poles,
 * .weights, .gains), and on controller.sample_time where the design is for the sampled model. */
struct resolved_design {
    double start[STANCE_MAX_COORDINATES]; /* initial equilibrium, foot at the origin; NAN if none */
    double equilibrium[STANCE_MAX_COORDINATES]; /* controller's equilibrium; NAN if none */
    double torque[STANCE_MAX_ACTUATORS];        /* feedforward, N m */
    double gain[STANCE_MAX_ACTUATORS][2 * STANCE_MAX_POSTURE];
};

/* A design is packed without the room that its scene has no use for: its parts, rows of so many
 * numbers, a row every `stride` numbers from `offset` on, and from `place` on, without gaps, where
 * it is packed. RESOLVED_PARTS: what begins there is no part; that many numbers it is. */
enum resolved_parts {
    RESOLVED_START,
    RESOLVED_EQUILIBRIUM,
    RESOLVED_TORQUE,
    RESOLVED_GAIN,
    RESOLVED_PARTS
};
struct resolved_part {
    size_t offset, place, rows, length, stride;
};
struct resolved_part resolve_part(const stance_scene *scene, enum resolved_parts k);
/* To or from number[that many]; what is left out is 0 when it is back. */
void resolve_move(const stance_scene *scene, bool pack, struct resolved_design *design,
                  double *number);

/* false: `message` says what is impossible (no such equilibrium, poles not
 * placeable, ...). */
bool resolve_design(const stance_scene *scene, const struct scenario_values *values,
                    struct resolved_design *design, stance_message *message);

/* Sets to 0 what no design of these values depends on, by the schema's rows. On
 * controller.sample_time only a design for the sampled model depends. False: no memory. */
bool resolve_keep_design_inputs(const stance_scene *scene, struct scenario_values *values,
                                bool sampled);

/* The robot that the design believes in, model[STANCE_MAX_ROBOT], and the equilibrium it is made
 * at: the controller's, or for laws without one the initial one. false: `message` says why there is
 * none. Each may be NULL. */
bool resolve_equilibrium(const stance_scene *scene, const struct scenario_values *values,
                         double *model, stance_equilibrium *equilibrium, stance_message *message);

/* Which of the posture's 2 postures angles and rates is a state of the linear model about an
 * equilibrium, whose contacts may leave it fewer. */
int resolve_state(const stance_scene *scene, const stance_equilibrium *equilibrium, int state);
/* column[2 postures]: whether it is one of them. Gains of the others are 0. */
void resolve_free(const stance_scene *scene, const stance_equilibrium *equilibrium, bool *column);

/* K[actuators][states] of a state-feedback law for the plant: designed, or as given. `how` may be
 * NULL. */
bool resolve_gains(const stance_scene *scene, const struct scenario_values *values,
                   const stance_equilibrium *equilibrium, const stance_plant *plant, double *K,
                   stance_robustness *how, stance_message *message);

/* Where a case starts, whether it may or not: position and velocity[coordinates]. */
void resolve_start(const stance_scene *scene, const struct scenario_values *values,
                   const struct resolved_design *design, double *position, double *velocity);

/* Fills *out (trajectory NULL). Checks the initial state: a gap below -1e-9 m of a contact that
 * may touch is an error, and so is a state that is not finite. `values` and `index`: of the case,
 * flat, of s. */
bool resolve_case(const struct scenario *s, const struct scenario_values *values,
                  const struct resolved_design *design, uint64_t index, stance_case *out,
                  stance_message *message);

/* Makes *out act by what a law is told, from the coordinates `begin`; `linear`: its near or far. */
bool resolve_law(const stance_scene *scene, const struct scenario_values *values,
                 const stance_law *law, const double *begin, stance_linear_law *linear,
                 stance_case *out, stance_message *message);

/* false: the selection of a decoupling law is singular where *start begins. In a sweep such a
 * case runs all the same, with a damped law. */
bool resolve_selection(const stance_scene *scene, const stance_case *start,
                       stance_message *message);

/* Which of the numbers that a search is asked to vary can differ: of the gains those of the linear
 * model. Coordinates that follow from the others while the contacts hold (of a flat foot its angle)
 * have gains of 0, see resolve_free. How many they are; and leaves the others out of
 * s->search.axis. */
int search_numbers(const struct scenario *s);
void search_numbers_keep(struct scenario *s);

#endif
