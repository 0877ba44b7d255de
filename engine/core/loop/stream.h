/* stream.h - the time loop: draws cases from a feed, one for each lane that is free, and steps the
 * bundles until there are no more.
 *
 * Included by each method after the header that says how it gets from the end of one step to the
 * end of the next; gives `bundle_stream` and `bundle_run`. That header defines
 *
 *   struct advance                        what it remembers of its lanes between steps,
 *   void advance_load(a, lane, case)      at the start of a case,
 *   mask advance(a, step, live, now, report, failed)
 *                                         moves *now, where the step begins, towards its end;
 *                                         returns the lanes that are there, with *report about the
 *                                         whole step; the others go on at the next call, but for
 *                                         *failed,
 *
 * and may define ADVANCE_FREES with advance_free(a), at the end of all, ADVANCE_ORDINARY (see
 * stream_ordinary) with advance_was_ordinary, ADVANCE_MOVES where struct advance consists of lanes,
 * so that cases may change lanes between steps, ADVANCE_WATCHES with advance_watch(a, m, near),
 * which is told of the lanes m from which state a step may come to a fall or a larger answer
 * between its ends, and ADVANCE_PIECES where a step may be of any length: then pushes begin and
 * end, and blows fall, at their instants, and contacts cross edges of plates at the end of a piece.
 * If it is not of lanes that has advance_done(a, lane), how far into its step a lane is, and
 * advance_back(a, before, m), which puts the lanes m back.
 */
#ifndef STANCE_CORE_LOOP_STREAM_H
#define STANCE_CORE_LOOP_STREAM_H

#include "feet.h"
#include "record.h"
#include "sample.h"

/* Bundles of one kind that take turns, for how many steps at most, and for how many of them a step
 * counts that is not ordinary: the caller is to be asked soon again. */
#ifdef ADVANCE_MOVES
#ifdef CONTACT_LISTS /* the more cases, the less that lanes side by side have not in common */
enum { STREAM_BUNDLES = 16, STREAM_RARE = 16 };
#else
enum { STREAM_BUNDLES = 4, STREAM_RARE = 8 };
#endif
#ifdef ADVANCE_ORDINARY
enum { STREAM_STEPS = 250, STREAM_SLOW = STREAM_RARE };
#else
enum { STREAM_STEPS = 250, STREAM_SLOW = 1 };
#endif
#else
enum { STREAM_BUNDLES = 1, STREAM_STEPS = 1000, STREAM_SLOW = 200 };
#endif

#include "regroup.h"

/* Are there steps of several pieces? */
#define STREAM_PIECES (SCENE_PUSHES > 0 || SCENE_PLATES)

/* Judges and records the initial state of fresh lanes. */
COLD void bundle_start(struct bundle *b, mask fresh, bool coupled)
{
    bundle_begin(b, fresh);
#if SCENE_PLATES
    if (tree_plates > 0)
        plates_begin(b, fresh);
#endif
    feet_begin(b, fresh);
    for (int i = 0; i < SCENE_ACTUATORS; i++) /* where they begin */
        b->moved[i] = choose(fresh, scene_actuated(b->now.s, i), b->moved[i]);
    feet_choose(b, fresh);
    mask loaded[CONTACTS];
    EACH_CONTACT (c, 0)
        loaded[c] = motion_closed(&b->set, b->now.gap, c);
    const struct verdict v = bundle_judge(b, fresh, CONTACT_ALL, loaded, MASK_NONE);
    /* A law with a model feels what pushes it from the beginning on. */
    if (SCENE_PUSHES > 0) {
#ifdef ADVANCE_PIECES
        const lanes begins = b->n * b->h + b->piece_from, length = b->piece_to - b->piece_from;
#else
        const lanes begins = b->n * b->h, length = b->h;
#endif
        scene_push(&b->set.body, begins, length);
    }
    const mask useless = bundle_sample(b, fresh);
    if (!coupled) { /* a law that acts all the time, without gains: its torque is constant */
        lanes torque[ACTUATORS];
        const mask constant = fresh & mask_less_equal(lanes_of(INFINITY), b->next_sample);
        law_torque(&b->set.law, b->now.s, b->now.w, torque);
        law_clip(&b->set.law, torque);
        for (int i = 0; i < SCENE_ACTUATORS; i++)
            b->torque[i] = choose(constant, torque[i], b->torque[i]);
    } else {
        struct dynamics e;
        const struct drive drive = {b->torque, true, NULL};
        const struct state at = state_of(&b->now);
        between_evaluate(&b->set, &at, &drive, step_touching(&b->set, b->now.gap, LANES_ALL), &e);
        for (int i = 0; i < SCENE_ACTUATORS; i++)
            b->torque[i] = choose(fresh, e.torque[i], b->torque[i]);
        for (int i = 0; i < SCENE_ACTUATORS; i++)
            account_largest(false, fresh, lanes_abs(b->torque[i]), &b->answer.peak_torque);
    }
    bundle_record_due(b, fresh);
    bundle_end(b, fresh, useless, &v, mask_less_equal(b->steps, lanes_of(0)));
}

/* What follows from a step of the lanes in `ok`. */
HOT void stream_follow(struct bundle *b, bool all, mask ok, mask failed, bool ordinary,
                       contact_set touching, const struct step_report *report)
{
    bundle_account(b, all, ok, ordinary, touching, report);
    feet_choose(b, ok);
    mask loaded[CONTACTS];
    EACH_CONTACT (c, 0) {
        loaded[c] = MASK_NONE;
        if (touching >> c & 1)
            loaded[c] = mask_less(lanes_of(0), report->impulse[c][0]);
    }
    const mask last = ok & mask_less_equal(b->steps, b->n);
    const struct verdict v = bundle_judge(b, ok, touching, loaded, last);
    bundle_record_due(b, ok);
    bundle_end(b, b->live, failed, &v, last);
}

/* The step of length h that begins at the present state. */
HOT struct step stream_asks(const struct bundle *b, bool coupled, lanes h)
{
    return (struct step){&b->set, &b->now, b->torque, coupled, h, STEP_MAX_ITERATIONS, NULL};
}

#ifdef ADVANCE_ORDINARY
/* One step of all lanes, if it is ordinary in all; false: nothing has happened. */
PER_SET bool stream_ordinary(struct bundle *b, bool coupled, contact_set touching)
{
    struct step_report report;
    const struct step step = stream_asks(b, coupled, b->h);
    if (!advance_ordinary(&b->advance, &step, b->live, touching, &b->now, &report))
        return false;
    walk_effort(b, b->live, coupled ? report.torque : b->torque, false);
    for (int i = 0; i < SCENE_ACTUATORS && coupled; i++)
        b->torque[i] = report.torque[i];
#if SCENE_PLATES
    if (tree_plates > 0)
        plates_follow(b, b->live);
#endif
    stream_follow(b, true, b->live, MASK_NONE, true, touching, &report);
    return true;
}

/* The same compiled for sets of contacts, and for laws that are sampled or act inside the step.
 * Each a function of its own: in one the compiler takes twice as long. */
#define STREAM_ORDINARY(name, there, touching)                                                     \
    COLD bool stream_##name(struct bundle *b)                                                      \
    {                                                                                              \
        return (there) && stream_ordinary(b, false, touching);                                     \
    }                                                                                              \
    COLD bool stream_##name##_inside(struct bundle *b)                                             \
    {                                                                                              \
        return (there) && SCENE_ACTUATORS > 0 && stream_ordinary(b, true, touching);               \
    }
CONTACT_SETS(STREAM_ORDINARY)

HOT bool stream_try_ordinary(struct bundle *b, bool coupled)
{
    const contact_set now = step_touching(&b->set, b->now.gap, b->live);
#if SCENE_PLATES
    if (tree_plates > 0 && mask_any(plates_near(b)))
        return false;
#endif
#ifdef ADVANCE_PIECES
    if (STREAM_PIECES &&
        mask_any(b->live & (mask_less(lanes_of(0), b->piece_from) | mask_less(b->piece_to, b->h))))
        return false;
#endif
#define TRY(name, there, touching)                                                                 \
    if ((there) && now == (touching))                                                              \
        return coupled ? stream_##name##_inside(b) : stream_##name(b);
    CONTACT_SETS(TRY)
#undef TRY
    return false;
}
#endif

#ifdef ADVANCE_PIECES
/* Lanes of `ok`, each at the end of a piece, where it was the step's last; *report becomes that of
 * the step. */
COLD mask stream_join(struct bundle *b, mask ok, struct step_report *report)
{
    const mask last = ok & mask_less_equal(b->h, b->piece_to);
    report_add_where(ok, &b->pieces, report);
    choose_all(last, &b->pieces, report, sizeof *report);
    report_clear_where(last, &b->pieces);
    b->piece_from = choose(ok, choose(last, lanes_of(0), b->piece_to), b->piece_from);
#if SCENE_PLATES
    b->plates.cut = choose(ok, lanes_of(INFINITY), b->plates.cut);
#endif
    return last;
}
#endif

/* Ends the cases that a footfall ends, wherever in their steps they are. */
COLD void stream_footfalls(struct bundle *b)
{
    const mask ended = b->live & mask_less_equal(lanes_of(0), b->ended);
    const struct verdict none = {0};
    if (mask_any(ended))
        bundle_end_lanes(b, ended, MASK_NONE, &none);
}

/* One step of all lanes, whatever happens in it. */
COLD void stream_any(struct bundle *b, bool coupled)
{
    struct step_report report;
    mask failed, down[CONTACTS];
    EACH_CONTACT (c, 0)
        down[c] = feet_landed(b, c);
    lanes h = b->h;
#ifdef ADVANCE_PIECES
    if (STREAM_PIECES)
        h = b->piece_to - b->piece_from;
#endif
#if SCENE_PLATES
    struct motion from;
    struct advance before;
    mask near = MASK_NONE; /* of its own: what is beside a lane must not matter */
    if (tree_plates > 0) {
        near = plates_near(b);
        memcpy(&from, &b->now, sizeof from);
        memcpy(&before, &b->advance, sizeof before);
    }
#endif
    const struct step step = stream_asks(b, coupled, h);
    mask ok = advance(&b->advance, &step, b->live, &b->now, &report, &failed);
#if SCENE_PLATES
    if (tree_plates > 0) {
        const mask back = plates_back(b, &from, &before, h, ok, failed | LANES_NOT(near));
        plates_follow(b, b->live & LANES_NOT(back | failed));
        ok &= LANES_NOT(back);
    }
#endif
#ifdef ADVANCE_PIECES
    if (STREAM_PIECES)
        ok = stream_join(b, ok, &report);
#endif
    walk_effort(b, b->live & LANES_NOT(ok), b->torque, true);
    walk_effort(b, ok, coupled ? report.torque : b->torque, false);
    feet_count(b, b->live, down);
    b->failure = choose(failed, report.failure, b->failure);
    const mask tired = ok & mask_less(b->most_work, b->answer.evaluations + report.evaluations);
    b->failure = choose(tired, lanes_of(STANCE_FAILURE_WORK), b->failure);
    failed |= tired;
    if (!mask_any(ok | failed)) {
        stream_footfalls(b);
        return;
    }
    if (coupled)
        for (int i = 0; i < SCENE_ACTUATORS; i++)
            b->torque[i] = choose(ok, report.torque[i], b->torque[i]);
    stream_follow(b, false, ok, failed, false, CONTACT_ALL, &report);
    stream_footfalls(b);
}

/* Ends the cases that have failed before their next step. */
HOT void stream_fails(struct bundle *b, mask failed)
{
    const struct verdict none = {0};
    if (mask_any(failed))
        bundle_end(b, b->live, failed, &none, MASK_NONE);
}

/* Instants of pushes nearer to a lane's own than this part of a step are there already. */
#define STREAM_INSTANT 0x1p-30

/* Impulses of the world that are due where the lanes are, `from` into their steps: the contact laws
 * see the velocity that they leave. In a step that is not taken in pieces they fall at its nearer
 * end. */
COLD void stream_strike(struct bundle *b, lanes from)
{
#ifdef ADVANCE_PIECES
    const lanes within = STREAM_INSTANT * b->h;
#else
    const lanes within = 0.5 * b->h;
#endif
    const lanes steps = b->n + from / b->h;
    struct motion next = b->now;
    struct step_report report;
    const mask fresh = b->live & mask_less(b->struck, steps);
    const mask hit =
        fresh & scene_strike(&b->set.body, &next.trig, b->n * b->h + from, within, next.w);
    b->struck = choose(fresh, steps, b->struck);
    if (!mask_any(hit))
        return;
    report_clear(&report);
    const lanes struck = scene_kinetic(&b->set.body, &next.trig, next.w);
    const lanes given = struck - scene_kinetic(&b->set.body, &next.trig, b->now.w);
    const mask solved = between_impact(&b->set, hit, &next, &report);
    motion_energy(&b->set, &next);
    b->excess = choose(hit, b->excess + (next.kinetic - struck), b->excess);
    choose_all(hit, &next, &b->now, sizeof next);
    b->energy_bound = choose(hit, b->energy_bound + given, b->energy_bound);
    for (int c = 0; c < OWN_CONTACTS; c++)
        for (int a = 0; a < 2; a++) {
            b->now.impulse[c][a] = choose(hit, lanes_of(0), b->now.impulse[c][a]);
            b->impulse[c][a] =
                choose(hit, b->impulse[c][a] + report.impulse[c][a], b->impulse[c][a]);
        }
    b->answer.impact_energy = choose(hit, lanes_max(report.impact_energy, b->answer.impact_energy),
                                     b->answer.impact_energy);
    b->answer.limited_impacts += choose(hit, report.limited_impacts, lanes_of(0));
    account_largest(false, hit, report.impact_friction, &b->answer.impact_friction);
    advance_forget(&b->advance, hit);
#if SCENE_PLATES
    plates_jump(b, hit);
#endif
    const mask failed = hit & LANES_NOT(solved);
    b->failure = choose(failed, lanes_of(STANCE_FAILURE_CONTACT), b->failure);
    stream_fails(b, failed);
}

/* What the world does in the steps that begin, or in their next pieces: up to the next instant at
 * which a push begins or ends or a blow falls. */
HOT void stream_push(struct bundle *b)
{
    const lanes begins = b->n * b->h;
#if SCENE_PLATES && defined ADVANCE_PIECES
    if (tree_plates > 0)
        b->piece_to = lanes_min(b->h, b->plates.cut);
#endif
    if (SCENE_PUSHES == 0 || !mask_any(b->live & mask_less_equal(begins, b->pushed_until + b->h)))
        return;
#ifdef ADVANCE_PIECES
    stream_strike(b, b->piece_from);
    const lanes t = begins + b->piece_from, left = b->h - b->piece_from;
    const lanes edge = scene_push_edge(&b->set.body, t, left, STREAM_INSTANT * b->h);
    b->piece_to = choose(mask_less(edge, left), b->piece_from + edge, b->h);
#if SCENE_PLATES
    if (tree_plates > 0)
        b->piece_to = lanes_min(b->piece_to, b->plates.cut);
#endif
    scene_push(&b->set.body, t, b->piece_to - b->piece_from);
#else
    stream_strike(b, lanes_of(0));
    scene_push(&b->set.body, begins, b->h);
#endif
}

/* One step of all lanes, with everything that follows from it. Returns for how many it counts. */
HOT int stream_step(struct bundle *b, bool coupled)
{
    stream_push(b);
    const mask useless = bundle_sample(b, b->live);
    stream_fails(b, useless);
#ifdef ADVANCE_ORDINARY
    if (stream_try_ordinary(b, coupled))
        return 1;
#endif
    stream_any(b, coupled);
    return STREAM_SLOW;
}

/* A stream's bundles: for the cases whose law acts inside the step [1], and the others [0]. */
struct stream {
    struct bundle bundle[2][STREAM_BUNDLES];
    const stance_feed *feed;
    const stance_case *ahead; /* drawn, but no lane of its bundle is free */
    stance_result *result;
    bool drained; /* the feed has no more */
};

/* Fills the free lanes of a bundle; those that were filled. */
static mask stream_fill(struct stream *stream, struct bundle *b, bool coupled)
{
    const stance_feed *const feed = stream->feed;
    mask fresh = MASK_NONE;
    for (int lane = 0; lane < LANES; lane++) {
        if (b->which[lane])
            continue;
        if (!stream->ahead && !stream->drained)
            stream->drained = !feed->next(feed->context, &stream->ahead, &stream->result);
        if (stream->ahead)
            SCENE_BEGIN(stream->ahead);
        if (!stream->ahead || case_is_coupled(stream->ahead) != coupled)
            break;
        bundle_load(b, lane, stream->ahead, stream->result);
        stream->ahead = NULL;
        fresh |= mask_of_lane(lane);
    }
    return fresh;
}

/* Steps a bundle for a while and refills lanes as they end. */
HOT void stream_advance(struct stream *stream, struct bundle *b, bool coupled)
{
    for (int k = 0; k < STREAM_STEPS;) {
        while (b->filled < LANES) { /* a case may end at its start */
            const mask fresh = stream_fill(stream, b, coupled);
            if (!mask_any(fresh))
                break;
            bundle_start(b, fresh, coupled);
        }
        if (b->filled == 0)
            return;
        k += stream_step(b, coupled);
    }
}

/* Until there are no more cases, or (false) it is told to leave. Apart from bundle_stream, so that
 * the bundles are reached by a pointer and only what is spilled lies on the stack. */
COLD bool stream_go(struct stream *stream)
{
    const stance_feed *const feed = stream->feed;
    bool leave = false, running = true;
    while (running && !leave) {
        running = false;
        for (int coupled = 0; coupled < (SCENE_ACTUATORS > 0 ? 2 : 1); coupled++) {
            struct bundle *const b = stream->bundle[coupled];
            for (int k = 0; k < STREAM_BUNDLES; k++) {
                stream_advance(stream, &b[k], coupled);
                running |= b[k].filled > 0;
            }
            if (STREAM_BUNDLES > 1)
                regroup(b, STREAM_BUNDLES);
        }
        running |= stream->ahead || !stream->drained;
        leave = feed->leave && feed->leave(feed->context);
    }
    return !leave;
}

static bool bundle_stream(const stance_feed *feed)
{
    struct stream stream;
    struct bundle *const all = &stream.bundle[0][0];
    memset(&stream, 0, sizeof stream);
    stream.feed = feed;
    for (int k = 0; k < 2 * STREAM_BUNDLES; k++)
        all[k].feed = feed;
    const bool done = stream_go(&stream);
    for (int k = 0; k < 2 * STREAM_BUNDLES; k++) {
#ifdef ADVANCE_FREES
        advance_free(&all[k].advance);
#endif
        for (int lane = 0; lane < LANES; lane++) /* given up: told to leave */
            if (all[k].which[lane] && all[k].which[lane]->program)
                all[k].which[lane]->program->end(all[k].which[lane]->program,
                                                 (double *)(uintptr_t)all[k].program[lane]);
    }
    return done;
}

/* An array as a feed. */
struct array {
    const stance_case *cases;
    stance_result *results;
    size_t next, n;
};
static bool array_next(void *context, const stance_case **c, stance_result **result)
{
    struct array *const a = context;
    if (a->next == a->n)
        return false;
    *c = &a->cases[a->next];
    *result = &a->results[a->next++];
    return true;
}
static void array_done(void *context, const stance_case *c, stance_result *result)
{
    (void)context, (void)c, (void)result;
}
static void bundle_run(const stance_case *cases, stance_result *results, size_t n)
{
    struct array array = {cases, results, 0, n};
    const stance_feed feed = {&array, array_next, array_done, NULL};
    bundle_stream(&feed);
}

#endif
