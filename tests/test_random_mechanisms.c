/* test_random_mechanisms - random trees of 1 to 7 joints, hinges and slides, with up to 6 contact
 * elements, springs, dampers, rotors, stops, motors and pushes, thrown at random near the ground,
 * steps of 0.1 to 20 ms, friction 0 to 2: nothing is not finite, nothing is below the ground or
 * moves into it, no friction is outside its cone, no impact adds energy; and what fails says so. A
 * root that is held may jam, where no contact impulse fits; a free one may not, and must not fail.
 *
 * Contacts that all have the friction factor k on a ground of friction mu do what those without one
 * do on a ground of k mu, but for where iterations stop.
 *
 * The same holds on random plates; and on one plate that is raised a robot does what it does below.
 */
#include "long.h"
#include "random_mechanism.h"
#include "tests.h"

enum { CASES = 100 };

struct tally {
    double penetration, cone, signorini, impact;
    long cases, failed[STANCE_FAILURE_COUNT], ambiguous, unranked, subdivided, iterations, steps;
};

/* What one case came to; false: to what it must not. */
static bool take_down(const stance_case *c, const stance_result *r, struct tally *t)
{
    t->cases++;
    t->failed[r->failure]++;
    t->steps += r->steps, t->iterations += r->iterations;
    if (r->status != STANCE_DONE)
        return r->status == STANCE_FAILED && r->failure != STANCE_FAILURE_NONE &&
               c->scene->mechanism->body[0].joint != STANCE_FREE;
    const double energy = c->scene->energy(c->scene, c->robot, c->position, c->velocity);
    bool finite = true;
    for (int i = 0; i < c->scene->coordinates; i++)
        finite &= isfinite(r->position[i]) && isfinite(r->velocity[i]);
    const double impact = r->impact_energy / (1 + fabs(energy));
    t->penetration = fmax(t->penetration, r->max_penetration);
    t->cone = fmax(t->cone, r->coulomb_residual);
    t->signorini = fmax(t->signorini, r->signorini_residual);
    t->impact = fmax(t->impact, impact);
    t->ambiguous += r->ambiguous_steps > 0;
    t->unranked += r->unranked_steps > 0;
    t->subdivided += r->subdivided_steps > 0;
    return finite && r->signorini_residual <= 1e-8 && r->max_penetration <= 1e-9 &&
           r->coulomb_residual <= 1e-9 && impact <= 1e-9 &&
           r->friction_used <= c->friction * (1 + 1e-9) + 1e-9;
}

static void tell(const char *method, int tree, int k, const stance_case *c, const stance_result *r)
{
    print_message(
        "# %s, tree %d, case %d: h %g, friction %g; %s, penetration %.2g, cone %.2g, friction "
        "used %.2g, impact %.2g, signorini %.2g\n",
        method, tree, k, c->step, c->friction, stance_failure_name[r->failure], r->max_penetration,
        r->coulomb_residual, r->friction_used, r->impact_energy, r->signorini_residual);
}

/* The scene on other ground. */
static stance_scene *on_plates(stance_scene *flat, void (*lay)(stance_mechanism *m))
{
    static stance_mechanism m;
    stance_scene *scene = NULL;
    m = *flat->mechanism;
    lay(&m);
    OK(stance_mechanism_scene(&m, &scene, NULL));
    stance_scene_free(flat);
    return scene;
}
static void move_to(const stance_scene *scene, stance_case *c)
{
    c->scene = scene, c->tree = scene->tree;
    stance_tree_numbers_make(scene->tree, scene->mechanism, c->robot, &c->body);
}

/* Steps, stairs and rough ground, some with a friction of their own, some before a footfall. */
static void lay_any(stance_mechanism *m)
{
    double from = between(-1, 0.2);
    m->plates = whole(1, STANCE_MAX_PLATES);
    for (int p = 0; p < m->plates; p++, from += between(0, 0.5)) {
        m->plate[p].kind = (stance_ground_kind)whole(0, 2);
        m->plate[p].by_footfall = sometimes(0.1);
        m->plate[p].rough = sometimes(0.2);
        m->value.plate[p] =
            (stance_plate_numbers){.from = from,
                                   .footfall = m->plate[p].by_footfall ? whole(1, 3) : 0,
                                   .height = sometimes(0.1) ? 0 : between(-0.2, 0.2),
                                   .width = between(0.01, 0.4),
                                   .count = sometimes(0.5) ? whole(1, 5) : INFINITY,
                                   .seed = sometimes(0.5) ? whole(0, 100) : -1,
                                   .friction_factor = m->plate[p].rough ? between(0.2, 2) : 1};
    }
}

/* One plate, so far up. */
#define RAISED 0.37
static void lay_raised(stance_mechanism *m)
{
    m->plates = 1;
    m->value.plate[0] =
        (stance_plate_numbers){.from = -1e3, .height = RAISED, .count = 1, .friction_factor = 1};
}

static int trees_of(void)
{
    return long_tests() ? 200 : 15;
}

/* Trees of hinges alone, then those that slide. */
static void hunt(const stance_method *method, int hinged, int sliding,
                 void (*lay)(stance_mechanism *m))
{
    static stance_case cases[CASES];
    static stance_result results[CASES];
    struct tally t = {0};
    long bad = 0;
    for (int tree = 0; tree < hinged + sliding; tree++) {
        SCENE *scene = tree < hinged ? random_scene(tree, 0) : random_scene(tree - hinged, 0.4);
        if (lay)
            scene = on_plates(scene, lay);
        for (int k = 0; k < CASES; k++) {
            random_scene_case(scene, &cases[k]);
            cases[k].tolerance = method->tolerance;
            cases[k].grid_index = (uint64_t)k;
        }
        stance_kernel_find(scene, method, NULL)->run(cases, results, CASES);
        for (int k = 0; k < CASES; k++)
            if (!take_down(&cases[k], &results[k], &t)) {
                bad++;
                tell(method->name, tree, k, &cases[k], &results[k]);
            }
    }
    print_message(
        "## %s: penetration %.1e, cone %.1e, impacts add %.1e of the energy, Signorini %.1e "
        "m/s; of %ld cases %ld ambiguous, %ld unranked, %ld subdivided; %.2f iterations\n",
        method->name, t.penetration, t.cone, t.impact, t.signorini, t.cases, t.ambiguous,
        t.unranked, t.subdivided, (double)t.iterations / (double)t.steps);
    long failed = 0;
    for (int f = 1; f < STANCE_FAILURE_COUNT; f++) {
        failed += t.failed[f];
        if (t.failed[f])
            print_message("## %s: %ld failed: %s\n", method->name, t.failed[f],
                          stance_failure_text[f]);
    }
    assert_int_equal(bad, 0);
    assert_true(failed <= 1 + t.cases / 2000);
}

TEST(implicit)
{
    hunt(stance_method_find("implicit"), trees_of(), trees_of(), NULL);
}
TEST(midpoint)
{
    hunt(stance_method_find("midpoint"), trees_of(), trees_of(), NULL);
}
TEST(capturing)
{
    hunt(stance_method_find("capturing"), trees_of() / 4, trees_of() / 4, NULL);
}

/* One mechanism on its ground and on one of a half of the friction, with factors of 2. */
static void factors_of(int tree, const char *method, long *same, long *cases)
{
    stance_scene *scene = random_scene(4 * tree, 0.2), *rough = NULL;
    static stance_mechanism m;
    stance_case c[2];
    stance_result r[2];
    m = *scene->mechanism;
    for (int e = 0; e < m.elements; e++)
        m.element[e].rough = true, m.value.element[e].friction_factor = 2;
    OK(stance_mechanism_scene(&m, &rough, NULL));
    for (int k = 0; k < 20; k++, ++*cases) {
        random_scene_case(scene, &c[0]);
        c[0].step = 0.002;
        c[0].steps = 200;
        c[1] = c[0];
        c[1].friction /= 2;
        c[1].scene = rough, c[1].tree = rough->tree;
        stance_tree_numbers_make(rough->tree, rough->mechanism, c[1].robot, &c[1].body);
        for (int i = 0; i < 2; i++)
            stance_kernel_find(c[i].scene, stance_method_find(method), NULL)->run(&c[i], &r[i], 1);
        double off = fabs(r[0].slip_distance - r[1].slip_distance);
        for (int i = 0; i < scene->coordinates; i++)
            off = fmax(off, fabs(r[0].position[i] - r[1].position[i]));
        *same += r[0].status == r[1].status && off <= 1e-3;
        assert_true(r[1].friction_used <= c[1].friction * (1 + 1e-9) + 1e-9);
    }
    stance_scene_free(scene);
    stance_scene_free(rough);
}

TEST(factors)
{
    static const char *const method[] = {"implicit", "midpoint", "capturing", "lagrange"};
    for (size_t i = 0; i < COUNT(method); i++) {
        long same = 0, cases = 0;
        for (int tree = 0; tree < trees_of() / 10; tree++)
            factors_of(tree, method[i], &same, &cases);
        print_message("# friction factors, %s: %ld of %ld the same\n", method[i], same, cases);
        assert_true(cases - same <= 1 + cases / 100);
    }
}

TEST(plates)
{
    static const char *const method[] = {"implicit", "midpoint", "capturing"};
    for (size_t i = 0; i < COUNT(method); i++)
        hunt(stance_method_find(method[i]), trees_of() / 3, trees_of() / 5, lay_any);
}

static void raised_by(const char *name, long *same, long *cases)
{
    static stance_case c[CASES], up[CASES];
    static stance_result r[CASES], above[CASES];
    for (int tree = 0; tree < trees_of() / 2; tree++) {
        SCENE *flat = random_scene(tree, 0.2);
        if (flat->mechanism->body[0].joint != STANCE_FREE)
            continue;
        SCENE *raised = on_plates(random_scene(tree, 0.2), lay_raised);
        for (int k = 0; k < CASES; k++) {
            random_scene_case(flat, &c[k]);
            c[k].tolerance = stance_method_find(name)->tolerance;
            c[k].steps /= 4;
            up[k] = c[k];
            up[k].position[0] += RAISED * c[k].body.slope[1];
            up[k].position[1] += RAISED * c[k].body.slope[2];
            move_to(raised, &up[k]);
        }
        stance_kernel_find(flat, stance_method_find(name), NULL)->run(c, r, CASES);
        stance_kernel_find(raised, stance_method_find(name), NULL)->run(up, above, CASES);
        for (int k = 0; k < CASES; k++, ++*cases) {
            double off =
                fmax(fabs(r[k].position[0] - above[k].position[0] + RAISED * c[k].body.slope[1]),
                     fabs(r[k].position[1] - above[k].position[1] + RAISED * c[k].body.slope[2]));
            for (int i = 2; i < flat->coordinates; i++)
                off = fmax(off, fabs(r[k].position[i] - above[k].position[i]));
            *same += r[k].status == above[k].status && off <= 1e-5;
        }
    }
}

TEST(raised)
{
    static const char *const method[] = {"implicit", "midpoint", "capturing", "lagrange"};
    for (size_t i = 0; i < COUNT(method); i++) {
        long same = 0, cases = 0;
        raised_by(method[i], &same, &cases);
        print_message("# on a raised plate, %s: %ld of %ld the same\n", method[i], same, cases);
        assert_true(cases - same <= 1 + cases / 50);
    }
}

/* Capturing and the reference make the same of cases on plates. */
TEST(reference)
{
    static const char *const method[] = {"event-driven", "capturing"};
    static stance_case c[CASES];
    static stance_result r[2][CASES];
    long same = 0, cases = 0;
    for (int tree = 0; tree < trees_of(); tree++) {
        SCENE *scene = on_plates(random_scene(tree, 0.1), lay_any);
        for (int k = 0; k < 20; k++)
            random_scene_case(scene, &c[k]);
        for (int i = 0; i < 2; i++) {
            for (int k = 0; k < 20; k++)
                c[k].tolerance = i ? 1e-10 : 1e-12;
            stance_kernel_find(scene, stance_method_find(method[i]), NULL)->run(c, r[i], 20);
        }
        for (int k = 0; k < 20; k++) {
            double off = 0;
            if (r[0][k].status != STANCE_DONE)
                continue;
            for (int i = 0; i < scene->coordinates; i++)
                off = fmax(off, fabs(r[0][k].position[i] - r[1][k].position[i]));
            cases++;
            same += off <= 1e-5;
        }
    }
    print_message("# on plates, capturing and event-driven: %ld of %ld the same\n", same, cases);
    assert_true(cases - same <= 1 + cases / 100);
}
