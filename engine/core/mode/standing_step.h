/* standing_step.h - a smooth step in which what touches stands and nothing else comes near: the
 * ordinary step of a method that is of high order between events.
 *
 * Steps that a controller's samples bound are short against the motion, and an order that fits them
 * is enough. With accelerations a(s, w) Nystrom's formula of order 4 (E. J. Nystrom 1925; E.
 * Hairer, S. Norsett, G. Wanner, Solving Ordinary Differential Equations I, section II.14),
 *
 *   a1 = a(s, w),                                a2 = a(s + h w / 2 + h^2 a1 / 8, w + h a1 / 2),
 *   a3 = a(the same place, w + h a2 / 2),        a4 = a(s + h w + h^2 a3 / 2, w + h a3),
 *   s + h w + h^2 (a1 + a2 + a3) / 6,            w + h (a1 + 2 a2 + 2 a3 + a4) / 6,
 *
 * has three places, and what depends on the place alone - sines, inertia, how the contacts act on
 * it - is most of an evaluation. The last is off the end by less than the error of order 3, so that
 * nothing has to be evaluated at the end: forces there, and the directions along which position and
 * velocity are put back onto the contacts, are those of the last place.
 *
 * What forces and torques come to between the ends tell parabolas through those places, at the
 * second with the mean of both (their velocities are off by h^2 a'/8 to either side). The places of
 * the last two are off by h^3 a'/48 and h^3 a'/12, little where a force peaks; the next step knows
 * its beginning exactly, so that only at the very end of a run h^3 counts.
 *
 * Error. With the second difference d2 = a1 - (a2 + a3) + a4, about h^2 a'' / 4, h d2 / 6 is the
 * error of a formula of order 2. Each order more makes errors smaller by about the ratio q of d2 to
 * the first difference d1 = a4 - a1; q h d2 / 6, that of order 3, is what the step is judged by,
 * where q is 1 at most. Its own error is about q^2 h d2 / 6.
 *
 * The mode lasts from one end to the other if normal forces and the room to both edges of the cone,
 * as parabolas through the three places, have Bernstein coefficients that are not small
 * (missed_events.h), and if no open contact could come to the ground at the speed it has at either
 * end. Where any of this does not hold, nor that the contact's operator is regular, the step is
 * left to those who look closer, whatever the neighbours do.
 */
#ifndef STANCE_CORE_MODE_STANDING_STEP_H
#define STANCE_CORE_MODE_STANDING_STEP_H

#include "decoupling.h"
#include "missed_events.h"

#define STANDING_ROOM 1e-4  /* of the largest load: forces are this far inside the cone */
#define STANDING_DRIFT 1e-7 /* m: a step that leaves the contacts by more is not of this kind */

enum { STANDING_PLACES = 3, STANDING_EVALUATIONS = 4 };

/* The operator that holds the contacts in `touching`, factored. Returns the lanes where it is
 * regular. */
HOT mask standing_factor(contact_set touching, const struct dynamics *e, struct contact_factors *f)
{
    lanes M[CONTACTS][CONTACTS][2][2];
    mask rows[CONTACTS][2];
    EACH_CONTACT (c, 0)
        rows[c][0] = rows[c][1] = LANES_ALL;
    contact_matrix(touching, e->D, rows, NULL, M);
    contact_factor(touching, CONTACT_PLAIN, M, f);
    return f->regular;
}

/* Forces that hold the contacts in `touching` where they are, and the accelerations with them. */
HOT void standing_hold(contact_set touching, const struct contact_factors *f, struct dynamics *e)
{
    contact_back(touching, f, e->free, e->force);
    EACH_IN (c, touching)
        EACH (a, 0, 2)
            if (a < contact_unknowns(c))
                EACH (i, 0, SCENE_COORDINATES)
                    e->acceleration[i] =
                        lanes_fma(e->response[c][a][i], e->force[c][a], e->acceleration[i]);
}

/* Lanes where contacts of `touching` are at rest. */
HOT mask standing_rests(contact_set touching, const lanes (*u)[2])
{
    lanes fastest = lanes_of(0);
    EACH_IN (c, touching)
        EACH (a, 0, 2)
            if (a < contact_unknowns(c))
                fastest = lanes_max(lanes_abs(u[c][a]), fastest);
    return mask_less_equal(fastest, lanes_of(BETWEEN_REST));
}

/* A quantity over a step, of which the first place tells once, the second twice, the third once:
 * the parabola through the first, the mean of the second and the last, by Bernstein coefficients.
 */
struct standing_course {
    lanes b[3];
};
HOT struct standing_course standing_course(lanes first, lanes twice, lanes last)
{
    return (struct standing_course){{first, twice - 0.5 * (first + last), last}};
}
/* Its values at 0, 1/2, 1. */
static inline void standing_values(struct standing_course f, lanes value[STANDING_PLACES])
{
    value[0] = f.b[0];
    value[1] = 0.25 * (f.b[0] + 2 * f.b[1] + f.b[2]);
    value[2] = f.b[2];
}

/* Largest |f| of the parabola through f at 0, 1/2, 1, where it is between the ends and above
 * `most`; else `most`. */
static inline lanes standing_peak(const lanes f[STANDING_PLACES], lanes most)
{
    lanes b[CUBIC], x, peak;
    cubic_parabola(f, b);
    for (int sign = 0; sign < 2; sign++) {
        const mask there = cubic_peak(b, most, &x, &peak);
        most = choose(there, peak, most);
        cubic_negate(b);
    }
    return most;
}
/* The same of f and, where that is less, of the ratio of two. */
COLD lanes standing_most(struct standing_course f, lanes most)
{
    lanes value[STANDING_PLACES];
    standing_values(f, value);
    return standing_peak(value, most);
}
COLD lanes standing_ratio(struct standing_course f, struct standing_course by, lanes most)
{
    lanes value[STANDING_PLACES], under[STANDING_PLACES];
    standing_values(f, value);
    standing_values(by, under);
    for (int k = 0; k < STANDING_PLACES; k++)
        value[k] = value[k] / under[k];
    return standing_peak(value, most);
}
/* Least of f, where that is between the ends and less than `least`. */
COLD lanes standing_least(struct standing_course f, lanes least)
{
    const struct standing_course down = {{least - f.b[0], least - f.b[1], least - f.b[2]}};
    const lanes depth = standing_most(down, lanes_of(0));
    return choose(mask_less(lanes_of(0), depth), least - depth, least);
}

/* Lanes where the forces of the contacts in `touching` at the places (at the second the sum of two)
 * are those of contacts that stand all the time; what they tell of themselves goes into *report. */
HOT mask standing_forces(contact_set touching, const struct setting *set,
                         const lanes (*force)[CONTACTS][2], struct step_report *report)
{
    const lanes none = lanes_of(0);
    mask stands = LANES_ALL;
    EACH_IN (c, touching) {
        const struct standing_course normal =
            standing_course(force[0][c][0], force[1][c][0], force[2][c][0]);
        const lanes least = lanes_min(normal.b[0], normal.b[2]);
        const mask dips = mask_less(normal.b[1], least);
        stands &=
            mask_less(none, least) & mask_less(STANDING_ROOM * lanes_max(normal.b[0], normal.b[2]),
                                               lanes_min(least, normal.b[1]));
        report->least[c] = least;
        if (mask_any(dips))
            report->least[c] = choose(dips, standing_least(normal, least), least);
        if (contact_unknowns(c) == 1)
            continue;
        const struct standing_course along =
            standing_course(force[0][c][1], force[1][c][1], force[2][c][1]);
        const struct standing_course load = standing_course(
            contact_load(c, force[0]), contact_load(c, force[1]), contact_load(c, force[2]));
        const lanes begin = lanes_abs(along.b[0]), end = lanes_abs(along.b[2]);
        const lanes bend = lanes_abs(along.b[1]);
        const mask more = mask_less(begin * load.b[2], end * load.b[0]);
        const lanes used = choose(more, end, begin) / choose(more, load.b[2], load.b[0]);
        report->friction_used = lanes_max(used, report->friction_used);
        const mask turns = mask_less(report->friction_used * load.b[1], bend);
        if (mask_any(turns)) {
            const lanes peak = standing_ratio(along, load, report->friction_used);
            report->friction_used = choose(turns, peak, report->friction_used);
        }
        const lanes room = lanes_min(lanes_min(lanes_fms(set->friction, load.b[0], begin),
                                               lanes_fms(set->friction, load.b[2], end)),
                                     lanes_fms(set->friction, load.b[1], bend));
        const lanes largest = lanes_max(load.b[0], load.b[2]);
        stands &= mask_less((STANDING_ROOM * set->friction) * largest, room);
    }
    return stands;
}

/* Puts the end back onto the contacts in `touching`, along the directions of *e, evaluated and held
 * near it. Returns the lanes where that is a little way, and where the ground is then. */
HOT mask standing_project(contact_set touching, const struct setting *set, const struct dynamics *e,
                          const struct contact_factors *f, struct motion *end,
                          struct step_report *report)
{
    const lanes none = lanes_of(0);
    lanes error[CONTACTS], multiplier[CONTACTS], u[CONTACTS][2], r[CONTACTS][2], far = none;
    lanes d[SCENE_COORDINATES];
    struct lifts along;
    mask held[CONTACTS];
    EACH_CONTACT (c, 0) {
        held[c] = LANES_ALL;
        along.lift[c] = e->response[c][0];
        error[c] = none;
        if (!(touching >> c & 1))
            continue;
        error[c] = -scene_gap(&set->body, end->s, &end->trig, c);
        far = lanes_max(lanes_abs(error[c]), far);
    }
    project_factor(set, &e->trig, touching, held, &along);
    project_multipliers(touching, &along, error, multiplier);
    EACH (i, 0, SCENE_COORDINATES) {
        d[i] = none;
        EACH_IN (c, touching)
            d[i] = lanes_fma(e->response[c][0][i], multiplier[c], d[i]);
        end->s[i] += d[i];
    }
    trig_turn(&end->trig, LANES_ALL, d);
    EACH_CONTACT (c, 0) {
        u[c][0] = u[c][1] = none;
        if (touching >> c & 1)
            scene_contact_velocity(&set->body, &end->trig, c, end->w, u[c]);
    }
    contact_back(touching, f, u, r);
    EACH_IN (c, touching)
        EACH (a, 0, 2)
            if (a < contact_unknowns(c))
                EACH (i, 0, SCENE_COORDINATES)
                    end->w[i] = lanes_fma(e->response[c][a][i], r[c][a], end->w[i]);
    mask there = mask_less(far, lanes_of(STANDING_DRIFT));
    EACH_IN (c, touching) {
        end->gap[c] = scene_gap(&set->body, end->s, &end->trig, c);
        scene_contact_velocity(&set->body, &end->trig, c, end->w, u[c]);
        end->approach[c] = u[c][0];
        report->signorini_residual = lanes_max(lanes_abs(u[c][0]), report->signorini_residual);
        if (contact_unknowns(c) == 2)
            report->dissipation_residual =
                lanes_max(lanes_abs(u[c][1]), report->dissipation_residual);
        there &= mask_less_equal(end->gap[c], lanes_of(STEP_CLOSED));
    }
    return there & standing_rests(touching, u);
}

/* Lanes where no contact outside `touching` may come to the ground on the way. */
HOT mask standing_clear(contact_set touching, const struct setting *set, lanes h,
                        const struct motion *from, const struct motion *end)
{
    mask clear = LANES_ALL;
    EACH_CONTACT (c, 0)
        if (!(touching >> c & 1))
            clear &= LANES_NOT(mask_less(lanes_of(0), set->may_touch[c])) |
                     (mask_less(h * lanes_abs(from->approach[c]), from->gap[c]) &
                      mask_less(h * lanes_abs(end->approach[c]), end->gap[c]));
    return clear;
}

/* The decoupling law in the lanes where it acts, with the contacts in `touching` standing: torques
 * and what they do go into *e, evaluated with pushes and without torques there. Returns the lanes
 * where it is what it promises. */
COLD mask standing_decouple(contact_set touching, const struct setting *set, const struct state *at,
                            struct dynamics *e)
{
    const mask decouples = mask_less(lanes_of(0), set->law.decouples);
    struct contact_state stands;
    EACH_CONTACT (c, 0) {
        stands.closed[c] = touching >> c & 1 ? LANES_ALL : MASK_NONE;
        stands.slide[c] = lanes_of(0);
    }
    dynamics_clear(touching, e);
    decouple(set, decouples, at, touching, &stands, e);
    decoupling_apply(set, decouples, touching, e);
    /* Sums of errors stop and go on at limits, which accelerations do not show: not judged here. */
    lanes sums = lanes_of(0);
    EACH (i, 0, SCENE_ACTUATORS)
        sums += lanes_abs(set->law.servo[i].ki);
    return LANES_NOT(decouples) | mask_less_equal(e->degraded + e->several + sums, lanes_of(0));
}

/* Tries a step, where exactly the contacts in `touching` are closed and all of them stood; `anew`:
 * lanes whose sines are to be computed anew. Returns the lanes where *end and *report are defined,
 * *error its estimate. */
HOT mask standing_take(contact_set touching, const struct step *step, mask run, mask anew,
                       struct motion *end, struct step_report *report, lanes *error)
{
    const struct setting *const set = step->set;
    const struct motion *const from = step->from;
    const bool coupled = step->coupled;
    const lanes h = step->h;
    lanes a[STANDING_PLACES][SCENE_COORDINATES]; /* at the second the sum of two */
    lanes force[STANDING_PLACES][CONTACTS][2];   /* likewise */
    lanes s[SCENE_COORDINATES], w[SCENE_COORDINATES];
    lanes driven[STANDING_PLACES][ACTUATORS]; /* as force, where a law acts all the time */
    lanes farthest = lanes_of(0), integral[ACTUATORS];
    const mask decouples = mask_less(lanes_of(0), set->law.decouples);
    const bool servos = SCENE_ACTUATORS > 0 && coupled && mask_any(decouples);
    struct dynamics e;
    struct contact_factors factors;
    scene_matrix A;
    mask good = run;
    report_clear_answers(report);
    report->work = report->failure = report->landed = lanes_of(0);
    EACH_CONTACT (c, 0) {
        report->impulse[c][0] = report->impulse[c][1] = report->slip[c] = lanes_of(0);
        report->least[c] = lanes_of(0);
    }
    EACH (i, 0, SCENE_COORDINATES) {
        s[i] = end->s[i] = from->s[i];
        w[i] = end->w[i] = from->w[i];
    }
    EACH (i, 0, SCENE_ACTUATORS)
        integral[i] = end->integral[i] = from->integral[i];
    e.trig = from->trig;
    EACH (k, 0, STANDING_PLACES) {
        const struct state at = {from->t + (0.5 * k) * h, s, w, integral};
        const lanes part = h * (k == 1 ? 1.0 / 3 : 1.0 / 6);
        dynamics_place(set, touching, servos, &A, &e);
        good &= standing_factor(touching, &e, &factors);
        EACH (again, 0, 2) {
            lanes moved[SCENE_COORDINATES], torque[ACTUATORS];
            if (again && k != 1)
                continue;
            law_drive(&set->law, step->torque, coupled, s, w, torque);
            dynamics_motion(set, &at, torque, touching, &A, &e);
            if (k == 0)
                good &= standing_rests(touching, e.u);
            if (servos) {
                good &= standing_decouple(touching, set, &at, &e);
                EACH (i, 0, SCENE_ACTUATORS) {
                    const lanes ahead = h * (k == 1 && again ? 1 : 0.5);
                    const lanes rate = choose(decouples, e.integral_rate[i], lanes_of(0));
                    end->integral[i] = lanes_fma(part, rate, end->integral[i]);
                    integral[i] = lanes_fma(ahead, rate, from->integral[i]);
                }
            }
            standing_hold(touching, &factors, &e);
            EACH (i, 0, SCENE_COORDINATES) {
                a[k][i] = again ? (lanes)(a[k][i] + e.acceleration[i]) : e.acceleration[i];
                moved[i] = part * w[i];
                end->s[i] += moved[i];
                end->w[i] = lanes_fma(part, e.acceleration[i], end->w[i]);
            }
            report->work += motion_work(&set->body, part, at.t, &e.trig, e.torque, w, moved);
            EACH (i, 0, SCENE_ACTUATORS)
                if (coupled)
                    driven[k][i] = again ? (lanes)(driven[k][i] + e.torque[i]) : e.torque[i];
            EACH_CONTACT (c, 0)
                EACH (b, 0, 2) {
                    if (!(touching >> c & 1) || b >= contact_unknowns(c)) {
                        force[k][c][b] = lanes_of(0);
                        continue;
                    }
                    const lanes now = e.force[c][b];
                    force[k][c][b] = again ? (lanes)(force[k][c][b] + now) : now;
                    report->impulse[c][b] = lanes_fma(part, e.force[c][b], report->impulse[c][b]);
                }
            EACH (i, 0, SCENE_COORDINATES)
                w[i] = lanes_fma(h * (k == 1 && again ? 1 : 0.5), e.acceleration[i], from->w[i]);
        }
        if (k == 2)
            break;
        lanes turn[SLOTS(SCENE_ANGLES)];
        const lanes ahead = h * (k == 0 ? 0.5 : 1);
        EACH (i, 0, SCENE_COORDINATES) { /* the last acceleration is a1 or a3 */
            const lanes move = ahead * lanes_fma(0.5 * ahead, e.acceleration[i], from->w[i]);
            s[i] = from->s[i] + move;
            if (i < FIRST_ANGLE)
                continue;
            turn[i - FIRST_ANGLE] = move;
            if (!SCENE_SLIDES(i - FIRST_ANGLE))
                farthest = lanes_max(lanes_abs(move), farthest);
        }
        trig_turned(&from->trig, turn, &e.trig);
    }
    good &= standing_forces(touching, set, force, report);
    lanes first = lanes_of(0), second = lanes_of(0), turn[SCENE_COORDINATES];
    EACH (i, 0, SCENE_COORDINATES) {
        first = lanes_max(lanes_abs(a[2][i] - a[0][i]), first);
        second = lanes_max(lanes_abs((a[0][i] - a[1][i]) + a[2][i]), second);
        turn[i] = end->s[i] - s[i];
    }
    *error = (h * second) * (1.0 / 6) * lanes_min(second / lanes_max(first, second), lanes_of(1));
    end->trig = e.trig;
    trig_turn(&end->trig, LANES_ALL, turn); /* by an error of the step */
    if (mask_any(anew)) {
        scene_trig exact;
        scene_trigonometry(end->s, &exact);
        EACH (i, 0, SCENE_ANGLES) {
            end->trig.sine[i] = choose(anew, exact.sine[i], end->trig.sine[i]);
            end->trig.cosine[i] = choose(anew, exact.cosine[i], end->trig.cosine[i]);
        }
    }
    if (touching)
        good &= standing_project(touching, set, &e, &factors, end, report);
    EACH_CONTACT (c, 0) {
        EACH (b, 0, 2)
            end->impulse[c][b] = from->impulse[c][b];
        if (touching >> c & 1)
            continue;
        lanes u[2];
        scene_contact_velocity(&set->body, &end->trig, c, end->w, u);
        end->approach[c] = u[0];
        end->gap[c] = scene_gap(&set->body, end->s, &end->trig, c);
    }
    law_drive(&set->law, step->torque, coupled, end->s, end->w, report->torque);
    EACH (i, 0, SCENE_ACTUATORS)
        if (servos) /* as forces, of the last place */
            report->torque[i] = choose(decouples, e.torque[i], report->torque[i]);
    report_torques(report, report->torque);
    EACH (i, 0, SCENE_ACTUATORS)
        if (coupled) {
            const struct standing_course course =
                standing_course(driven[0][i], driven[1][i], report->torque[i]);
            lanes most = lanes_max(lanes_abs(driven[0][i]), report->peak_torque);
            if (mask_any(mask_less(most, lanes_abs(course.b[1]))))
                most = lanes_max(lanes_min(standing_most(course, most), set->law.limit[i]), most);
            report->peak_torque = most;
        }
    end->energy = from->energy, end->kinetic = from->kinetic;
    end->t = from->t + h;
    report->evaluations = lanes_of(STANDING_EVALUATIONS);
    /* Turns of more are not what the series are for; comparisons are false for what is no number.
     */
    return good & mask_less(farthest, lanes_of(TRIG_TURNED)) & scene_angles_in_range(end->s) &
           standing_clear(touching, set, h, from, end);
}

#endif
