/* test_impacts - restitution in random impacts of one to four contacts of random systems, solved as
 * kernels do (one lane). What is judged is computed here, in extended precision, from inertia,
 * directions and impulses alone: the kinetic energy before and after, and what each law asks for.
 */
#define STANCE_LANES 1
#include "engine/core/lanes/lanes.h"

enum {
    SCENE_COORDINATES = 9,
    SCENE_CONTACTS = 4,
    SCENE_ACTUATORS = 0,
    SCENE_POSTURE = 0,
    SCENE_ANGLES = 7,
    N = SCENE_COORDINATES,
};
static const int scene_grip[SCENE_CONTACTS] = {0, 1, 2, 3};
static const int scene_other[SCENE_CONTACTS] = {-1, -1, -1, -1};
#include "engine/core/contact/impact.h"
#define DENSE_ROWS N
#include "dense.h"
#include "long.h"
#include "support.h"

struct system {
    int contacts, coordinates;
    double A[N][N], H[2 * CONTACTS][N], w[N]; /* inertia, directions, velocities before */
    double inverse[N][N];
    double friction, restitution;
    double elastic[CONTACTS]; /* 1, or 0: of a contact without restitution, as joint stops are */
    bool mixed;               /* there are such beside others */
};

/* Inertia of random masses at random places; contacts approach or, one in four, rest, or, `leaves`,
 * some leave the ground. */
static void random_system(uint64_t *seed, bool leaves, struct system *s)
{
    memset(s, 0, sizeof *s);
    s->contacts = 1 + (int)(uniform(seed, 0, 4));
    s->coordinates = 2 * s->contacts + (int)uniform(seed, 0, (double)(N - 2 * s->contacts + 1));
    const int n = s->coordinates;
    for (int k = 0; k < n + 2; k++) {
        double row[N];
        const double mass = exp(uniform(seed, -2, 2));
        for (int i = 0; i < n; i++)
            row[i] = uniform(seed, -1, 1);
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                s->A[i][j] += mass * row[i] * row[j];
    }
    for (int i = 0; i < n; i++)
        s->A[i][i] += 0.1;
    for (int c = 0; c < 2 * s->contacts; c++)
        for (int i = 0; i < n; i++)
            s->H[c][i] = uniform(seed, -1, 1);
    for (int i = 0; i < n; i++)
        s->w[i] = uniform(seed, -3, 3);
    assert_true(dense_inverse(n, N, s->A[0], s->inverse[0]));
    /* The least change of w that gives the normal velocities that are wanted. */
    double a[N][N + 1], x[N];
    for (int c = 0; c < s->contacts; c++) {
        const double wanted = c > 0 && uniform(seed, 0, 1) < 0.25 ? 0 : uniform(seed, -3, 0);
        a[c][s->contacts] = c > 0 && leaves && uniform(seed, 0, 1) < 0.3 ? 1 : wanted;
        for (int i = 0; i < n; i++)
            a[c][s->contacts] -= s->H[2 * c][i] * s->w[i];
        for (int k = 0; k < s->contacts; k++) {
            a[c][k] = 0;
            for (int i = 0; i < n; i++)
                a[c][k] += s->H[2 * c][i] * s->H[2 * k][i];
        }
    }
    assert_true(dense_solve(s->contacts, a, x));
    for (int c = 0; c < s->contacts; c++)
        for (int i = 0; i < n; i++)
            s->w[i] += s->H[2 * c][i] * x[c];
    s->friction = uniform(seed, 0, 1) < 0.1 ? 0 : uniform(seed, 0, 2);
    s->restitution = uniform(seed, 0, 1) < 0.3 ? 1 : uniform(seed, 0, 1);
    const bool stops = s->contacts > 1 && uniform(seed, 0, 1) < 0.5;
    for (int c = 0; c < s->contacts; c++) {
        s->elastic[c] = !stops || c == 0 || uniform(seed, 0, 1) < 0.5;
        s->mixed |= s->elastic[c] == 0;
    }
}

/* Velocities at the contacts of w. */
static void velocities(const struct system *s, const long double *w, long double *u)
{
    for (int c = 0; c < 2 * s->contacts; c++) {
        u[c] = 0;
        for (int i = 0; i < s->coordinates; i++)
            u[c] += (long double)s->H[c][i] * w[i];
    }
}

struct answer {
    double r[CONTACTS][2], share;
    bool limited, unsolved, gains;
};

static void solve(const struct system *s, stance_impacts law, double share, bool search,
                  struct answer *a)
{
    double D[CONTACTS][CONTACTS][2][2] = {{{{0}}}}, u[CONTACTS][2] = {{0}}, e[CONTACTS];
    bool part[CONTACTS] = {false};
    struct contact_verdict verdict;
    struct impact_tried tried;
    memset(a, 0, sizeof *a);
    for (int c = 0; c < CONTACTS; c++)
        e[c] = share * s->restitution * s->elastic[c];
    for (int c = 0; c < s->contacts; c++) {
        part[c] = true;
        for (int b = 0; b < 2; b++)
            for (int i = 0; i < s->coordinates; i++)
                u[c][b] += s->H[2 * c + b][i] * s->w[i];
        for (int k = 0; k < s->contacts; k++)
            for (int b = 0; b < 4; b++)
                for (int i = 0; i < s->coordinates; i++)
                    for (int j = 0; j < s->coordinates; j++)
                        D[c][k][b / 2][b % 2] +=
                            s->H[2 * c + b / 2][i] * s->inverse[i][j] * s->H[2 * k + b % 2][j];
    }
    for (int c = s->contacts; c < CONTACTS; c++)
        D[c][c][0][0] = D[c][c][1][1] = 1;
    struct impact_answer found;
    const struct impact_rule rule = {.D = D,
                                     .u = u,
                                     .part = part,
                                     .friction = s->friction,
                                     .prefer = 1,
                                     .restitution = e,
                                     .moreau = law == STANCE_IMPACTS_MOREAU,
                                     .limited = law != STANCE_IMPACTS_NEWTON};
    if (search)
        a->limited = impact_solve(&rule, true, &found, &verdict);
    else
        a->gains = impact_try(&rule, e, &found, &verdict, &tried);
    memcpy(a->r, found.r, sizeof a->r);
    a->unsolved = verdict.unsolved;
    a->share = share;
    for (int c = 0; c < s->contacts; c++)
        if (u[c][0] < -1e-3 && s->restitution * s->elastic[c] > 1e-3)
            a->share = found.shift[c][0] / (u[c][0] * s->restitution);
}

/* The share of the kinetic energies that an impact adds, and by how much it violates what its law
 * asks for, as a velocity. Where directions are nearly dependent impulses are huge and cancel: the
 * kernel is given their operator D in double precision, and what its last bits are worth, r.|D| r
 * of them, is no gain either. */
static double judge(const struct system *s, bool moreau, const struct answer *a, double *violation)
{
    long double w[N], u[2 * CONTACTS], before[2 * CONTACTS], gain = 0, kinetic = 0, old[N];
    long double bits = 0;
    for (int i = 0; i < s->coordinates; i++) {
        w[i] = old[i] = s->w[i];
        for (int j = 0; j < s->coordinates; j++)
            for (int c = 0; c < 2 * s->contacts; c++)
                w[i] += (long double)s->inverse[i][j] * s->H[c][j] * a->r[c / 2][c % 2];
    }
    velocities(s, w, u);
    velocities(s, old, before);
    for (int i = 0; i < s->coordinates; i++)
        for (int j = 0; j < s->coordinates; j++) {
            gain += 0.5L * s->A[i][j] * (w[i] * w[j] - old[i] * old[j]);
            kinetic += 0.5L * s->A[i][j] * (w[i] * w[j] + old[i] * old[j]);
        }
    for (int c = 0; c < 2 * s->contacts; c++) /* what is lost of this by rounding is no gain */
        kinetic += fabsl(a->r[c / 2][c % 2] * u[c]) + fabsl(a->r[c / 2][c % 2] * before[c]);
    for (int c = 0; c < 2 * s->contacts; c++)
        for (int k = 0; k < 2 * s->contacts; k++) {
            long double D = 0;
            for (int i = 0; i < s->coordinates; i++)
                for (int j = 0; j < s->coordinates; j++)
                    D += (long double)s->H[c][i] * s->inverse[i][j] * s->H[k][j];
            bits += 0x1p-52L * fabsl(a->r[c / 2][c % 2] * D * a->r[k / 2][k % 2]);
        }
    double worst = 0;
    for (int c = 0; c < s->contacts; c++) {
        const double e = a->share * s->restitution * s->elastic[c];
        const double normal = (double)(u[2 * c] + e * fminl(before[2 * c], 0));
        const double slip = (double)(u[2 * c + 1] + (moreau ? e * before[2 * c + 1] : 0));
        const double room = s->friction * a->r[c][0];
        worst = fmax(worst, fmax(-normal, -a->r[c][0]));
        worst = fmax(worst, fmin(fabs(normal), fabs(a->r[c][0])));
        worst = fmax(worst, fabs(a->r[c][1]) - room);
        const double against = slip < 0 ? room - a->r[c][1] : room + a->r[c][1];
        worst = fmax(worst, fmin(fabs(slip), fabs(against)));
    }
    *violation = worst;
    return (double)((gain - fminl(fmaxl(gain, 0), bits)) / kinetic);
}

TEST(impacts)
{
    const char *const asked = getenv("STANCE_TEST_IMPACTS");
    const long n = asked ? atol(asked) : long_tests() ? 200000 : 3000;
    uint64_t seed = asked ? 12345 : 5;
    long newton_gains = 0, gains[2] = {0}, limited[2] = {0}, unsolved = 0, same = 0, loose = 0,
         rough = 0, skipped = 0, lost = 0, hardly = 0;
    long higher = 0, looked = 0, beside = 0;
    double worst = 0, most = -1, largest = 0;
    for (long i = 0; i < n; i++) {
        struct system s;
        struct answer newton, some;
        double violation;
        const bool leaves = i % 4 == 0;
        random_system(&seed, leaves, &s);
        solve(&s, STANCE_IMPACTS_NEWTON, 1, true, &newton);
        if (newton.unsolved) {
            unsolved++, skipped++;
            continue;
        }
        const double added = judge(&s, false, &newton, &violation);
        worst = fmax(worst, violation), largest = fmax(largest, added);
        rough += violation > 1e-8;
        newton_gains += added > 1e-9;
        for (int k = 0; k < 2; k++) {
            const bool moreau = k == 1, proved = moreau && !leaves && !s.mixed;
            const stance_impacts law = moreau ? STANCE_IMPACTS_MOREAU : STANCE_IMPACTS_LIMITED;
            solve(&s, law, 1, true, &some);
            const double more = judge(&s, moreau, &some, &violation);
            most = fmax(most, more);
            if (!some.unsolved)
                worst = fmax(worst, violation), rough += violation > 1e-8;
            unsolved += some.unsolved;
            gains[k] += more > 1e-11, limited[k] += some.limited;
            beside += proved && some.limited;
            lost += !moreau && some.unsolved && !some.limited;
            if (!moreau && !some.limited && !some.unsolved) {
                /* Where Newton's law gains next to nothing, the coefficient may be less by so
                 * little that it does not count as limited. */
                const bool equal = memcmp(some.r, newton.r, sizeof some.r) == 0;
                same += equal, hardly += !equal && added > 1e-9;
            }
            /* A little more restitution would add energy; so it would all the way up. */
            if (some.limited && looked < 4000) {
                bool fits = false;
                struct answer other;
                solve(&s, law, some.share + 1e-5, false, &other);
                loose += !other.gains && !other.unsolved;
                for (int j = 1; j < 200 && !fits; j++) {
                    solve(&s, law, 1 - (1 - some.share) * j / 200, false, &other);
                    fits = !other.gains && !other.unsolved;
                }
                looked++, higher += fits;
            }
        }
    }
    print_message(
        "## %ld impacts: Newton's law adds energy in %ld, at most %.2g of it; limited: %ld "
        "(%ld limited), Moreau's: %ld (%ld limited); at most %.1e is added, laws hold to "
        "%.1e m/s, in all but %ld to 1e-8, %ld unsolved; %ld are Newton's to the bit, %ld "
        "limited by too little to count\n",
        n, newton_gains, largest, gains[0], limited[0], gains[1], limited[1], most, worst, rough,
        unsolved, same, hardly);
    print_message("## %ld limited ones: with 1e-5 more none in %ld, further up none in %ld\n",
                  looked, loose, higher);
    assert_true(newton_gains > n / 50);
    assert_int_equal(gains[0] + gains[1], 0);
    assert_int_equal(beside, 0);
    assert_true(limited[1] > n / 1000);
    assert_int_equal(same + hardly, n - skipped - lost - limited[0]);
    /* Three in a million have directions so nearly dependent that no velocity is known to 1e-8. */
    assert_true(rough <= (n > 1000000 ? n / 100000 : 0) && unsolved <= n / 1000);
    assert_true(loose <= looked / 500 && higher <= looked / 500);
}

/* Two of these systems, where less than a sixteenth of the coefficient adds nothing, far above the
 * share below which none does: any a little above what is taken adds some. */
TEST(what_is_narrow_is_found)
{
    static const uint64_t seeds[] = {12555750287834678224u, 10980256084169574173u};
    for (int k = 0; k < 2; k++) {
        uint64_t seed = seeds[k];
        struct system s;
        struct answer some, other;
        random_system(&seed, false, &s);
        solve(&s, STANCE_IMPACTS_LIMITED, 1, true, &some);
        assert_true(some.limited && !some.unsolved);
        for (int j = 1; j < 2000; j++) {
            solve(&s, STANCE_IMPACTS_NEWTON, 1 - (1 - some.share) * j / 2000, false, &other);
            assert_true(other.gains);
        }
    }
}

/* The search alone, of gains that are a quadratic with two roots in each of some parts of 0 ... 1,
 * which are told apart: the largest root is found. */
TEST(largest_root)
{
    enum { FUNCTIONS = 20000, PARTS = 4 };
    uint64_t seed = 77;
    for (int i = 0; i < FUNCTIONS; i++) {
        double edge[PARTS + 1] = {1}, low[PARTS], high[PARTS], root = 0;
        for (int k = 0; k < PARTS; k++) {
            edge[k + 1] = k == PARTS - 1 ? 0 : edge[k] * uniform(&seed, 0.5, 0.9);
            const double wide = edge[k] - edge[k + 1], middle = uniform(&seed, 0.3, 0.7);
            const double half = 0.19 * uniform(&seed, 1e-3, 1);
            const bool dips = uniform(&seed, 0, 1) < 0.3;
            low[k] = dips ? edge[k + 1] + (middle - half) * wide : -2;
            high[k] = dips ? edge[k + 1] + (middle + half) * wide : -1;
            if (k == PARTS - 1) /* without restitution nothing is gained */
                low[k] = -1, high[k] = dips ? middle * wide : 0;
            root = high[k] > root ? high[k] : root;
        }
        struct impact_share share;
        double last = 0;
        int tries = 0;
        for (double tried = 1;; tried = impact_share_next(&share), tries++) {
            int k = 0;
            while (k < PARTS - 1 && tried < edge[k + 1])
                k++;
            const struct impact_tried said = {(tried - low[k]) * (tried - high[k]), k};
            if (tries == 0)
                share = impact_share_begin(said);
            else if (impact_share_tell(&share, true, tried > 0 && said.gain > 0, &said))
                last = tried;
            if (!impact_share_open(&share, true))
                break;
        }
        assert_true(tries < 400);
        assert_true(fabs(share.low - root) < 1e-10 && last == share.low);
    }
}
