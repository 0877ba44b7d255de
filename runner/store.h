/* store.h - the results file: HDF5 that follows netCDF-4, written by independent raw writes.
 *
 * Layout (root group):
 *   one dimension scale per grid axis, named by its path, with values, `units`, `long_name`;
 *     an axis of several paths adds a variable "<path>" over that dimension for every further
 *     path; an axis of words is a string variable. Without a sweep: one dimension `case`, length 1.
 *   every answer of STORE_ANSWERS over those dimensions, row-major in their order;
 *     `final_state` has a last dimension `state` (string names x ... vq2);
 *     `checksum`: CRC-32C over the case's answers, in the order of the table.
 *   group `design`: over those grid axes that the design depends on (scalar when none does):
 *     `gain` (..., actuator, posture_state), `equilibrium_position` (..., coordinate),
 *     `equilibrium_torque` (..., actuator), `start_position`, `start_velocity` (..., coordinate).
 *   group `trajectory`, when recorded: dimensions case (value: flat index), time, coordinate,
 *     actuator, contact, component; `position`, `velocity`, `torque`, `force`, `gap`; NAN after
 *     the end of a case.
 *   group `timing`: `wall_time` (rank), `cases` (rank): the only part that differs between runs.
 *   root attributes: Conventions "CF-1.8", title, format_version (int 1), program_version,
 *     git_revision, compiler, library_versions, ranks, hosts, date, seed, scenario (text),
 *     scenario_sha256, axes (comma-separated dimension names, in order).
 */
#ifndef STANCE_RUNNER_STORE_H
#define STANCE_RUNNER_STORE_H

#include "scenario.h"

/* The answers: name, C type of the file, field of stance_result, fill value, unit, long name.
 * `status` is written last, after everything else of a case. */
#define STORE_ANSWERS(X)                                                                           \
    X(outcome, uint8_t, outcome, 0, "1", "how the case ended")                                     \
    X(evidence, uint8_t, evidence, 0, "1", "what the outcome rests on")                            \
    X(failure, uint8_t, failure, 0, "1", "why a case has status failed")                           \
    X(end_time, double, end_time, NAN, "s", "time at which the simulation stopped")                \
    X(settle_time, double, settle_time, NAN, "s", "time from which the robot stayed settled")      \
    X(fall_time, double, fall_time, NAN, "s", "time at which the robot had fallen")                \
    X(steps, int64_t, steps, 0, "1", "time steps taken")                                           \
    X(iterations, int64_t, iterations, 0, "1", "Newton iterations over all steps")                 \
    X(ambiguous_steps, int64_t, ambiguous_steps, 0, "1",                                           \
      "steps whose contact problem had several solutions")                                        \
    X(subdivided_steps, int64_t, subdivided_steps, 0, "1",                                         \
      "steps that converged only after being subdivided")                                         \
    X(max_penetration, double, max_penetration, 0, "m", "deepest penetration at the end of a step") \
    X(slip_distance, double, slip_distance, 0, "m", "distance slipped, summed over contacts")      \
    X(peak_torque, double, peak_torque, 0, "N m", "largest torque applied")                        \
    X(friction_used, double, friction_used, 0, "1", "largest ratio |rT|/rN of a contact")          \
    X(impact_energy, double, impact_energy, 0, "J",                                                \
      "largest kinetic energy added by contact impulses in one step")                             \
    X(projection_energy, double, projection_energy, 0, "J",                                        \
      "sum of |energy| added by position projection")

#endif
