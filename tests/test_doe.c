/* Experimental designs: what defines each method, checked on the points alone; Sobol' points
 * against the recurrence of their direction numbers, integrals against exact ones. */
#include "tests.h"

#include "runner/scenario/doe.h"

#define DOE FREED(doe_end) struct doe

static struct doe design(enum doe_method method, uint64_t count, size_t factors, uint64_t seed)
{
    struct doe s = {.method = method,
                    .count = count,
                    .factors = factors,
                    .levels = method == DOE_MORRIS ? 4 : 0,
                    .seed = seed};
    assert_true(doe_begin(&s));
    return s;
}

/* All points, [points][factors]. */
static double *all_points(const struct doe *s)
{
    const uint64_t n = doe_points(s);
    double *u = room(n * s->factors * sizeof *u);
    for (uint64_t i = 0; i < n; i++)
        doe_unit(s, i, u + i * s->factors);
    return u;
}

static double *points_of(enum doe_method method, uint64_t count, size_t factors, uint64_t seed)
{
    DOE s = design(method, count, factors, seed);
    double *u = all_points(&s);
    return u;
}

/* ---- what all have in common ----------------------------------------------------------------- */

TEST(test_range_and_seeds)
{
    for (int method = 0; method < DOE_METHODS; method++) {
        for (size_t k = 1; k <= 7; k += 3) {
            DOE s = design(method, 300, k, 5);
            const size_t n = doe_points(&s) * k;
            double *u = all_points(&s), *other = points_of(method, 300, k, 6);
            for (size_t i = 0; i < n; i++) {
                assert_true(u[i] >= 0 && u[i] <= 1);
                assert_true(u[i] < 1 || method == DOE_MORRIS || method == DOE_SPHERE);
            }
            if (method != DOE_SPHERE || k > 1) /* on a line there are but two directions */
                assert_memory_not_equal(u, other, n * sizeof *u);
            free(u);
            free(other);
        }
    }
}

/* Point i is the same whatever the count, and in whatever order points are asked for. */
TEST(test_prefix)
{
    static const uint64_t counts[] = {1, 2, 3, 64, 100, 129};
    for (int method = 0; method < DOE_METHODS; method++) {
        OWN double *whole = points_of(method, 500, 5, 9);
        for (size_t c = 0; c < COUNT(counts); c++) {
            DOE s = design(method, counts[c], 5, 9);
            bool same = true;
            for (uint64_t i = doe_points(&s); i-- > 0;) {
                double u[5];
                doe_unit(&s, i, u);
                same = same && memcmp(u, whole + i * 5, sizeof u) == 0;
            }
            assert_int_equal(same, method != DOE_LHS);
        }
    }
}

/* Factors are as good as independent: correlations of random points stay within 5 deviations. */
TEST(test_uncorrelated)
{
    enum { N = 4096, K = 6 };
    for (int method = DOE_RANDOM; method <= DOE_SOBOL; method++) {
        OWN double *u = points_of(method, N, K, 3);
        for (int a = 0; a < K; a++) {
            double mean = 0;
            for (int i = 0; i < N; i++)
                mean += u[i * K + a] / N;
            assert_float_equal(mean, 0.5, 5 / sqrt(12 * N));
            for (int b = 0; b < a; b++) {
                double correlation = 0;
                for (int i = 0; i < N; i++)
                    correlation += 12 * (u[i * K + a] - 0.5) * (u[i * K + b] - 0.5) / N;
                assert_float_equal(correlation, 0, 5 / sqrt(N));
            }
        }
    }
}

/* ---- Latin hypercubes ------------------------------------------------------------------------ */

TEST(test_strata)
{
    static const uint64_t counts[] = {1, 2, 3, 7, 64, 1000, 4099};
    for (size_t c = 0; c < COUNT(counts); c++) {
        const uint64_t n = counts[c];
        OWN double *u = points_of(DOE_LHS, n, 4, 11);
        for (size_t j = 0; j < 4; j++) {
            OWN char *taken = room(n * 1);
            for (uint64_t i = 0; i < n; i++) {
                const size_t stratum = (size_t)(u[i * 4 + j] * (double)n);
                assert_true(stratum < n && !taken[stratum]);
                taken[stratum] = 1;
            }
        }
    }
}

/* Over many seeds every order of four strata comes equally often: chi-square on 23 degrees of
 * freedom is above 60 with probability 4e-5. */
TEST(test_orders)
{
    enum { SEEDS = 4800 };
    int seen[256] = {0}, orders = 0;
    double chi_square = 0;
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        OWN double *u = points_of(DOE_LHS, 4, 1, seed);
        int code = 0;
        for (int i = 0; i < 4; i++)
            code = code * 4 + (int)(u[i] * 4);
        seen[code]++;
    }
    for (int code = 0; code < 256; code++) {
        orders += seen[code] > 0;
        chi_square += seen[code] > 0 ? pow(seen[code] - SEEDS / 24.0, 2) / (SEEDS / 24.0) : 0;
    }
    assert_int_equal(orders, 24);
    assert_true(chi_square < 60);
}

/* ---- Sobol' sequences ------------------------------------------------------------------------ */

/* Against the recurrence m_k = 2 a_1 m_k-1 ^ ... ^ 2^d m_k-d ^ m_k-d of Bratley and Fox for the
 * primitive polynomials x + 1, x^2 + x + 1, x^3 + x + 1 and the first numbers 1; 1 3; 1 3 1 of Joe
 * and Kuo; all 40 coordinates by a checksum of what SciPy's scipy.stats.qmc.Sobol(40, bits=30) has
 * (version 1.10, its array _sv[:, :25] row by row). */
TEST(test_directions)
{
    enum { K = 4 };
    uint64_t m[K][SOBOL_BITS] = {{0}, {1}, {1, 3}, {1, 3, 1}}, direction[SOBOL_BITS];
    for (int k = 0; k < SOBOL_BITS; k++) {
        m[0][k] = 1;
        m[1][k] = k < 1 ? m[1][k] : 2 * m[1][k - 1] ^ m[1][k - 1];
        m[2][k] = k < 2 ? m[2][k] : 2 * m[2][k - 1] ^ 4 * m[2][k - 2] ^ m[2][k - 2];
        m[3][k] = k < 3 ? m[3][k] : 4 * m[3][k - 2] ^ 8 * m[3][k - 3] ^ m[3][k - 3];
    }
    for (size_t d = 0; d < K; d++) {
        for (int width = SOBOL_BITS; width <= 64; width += 13) {
            sobol_directions(d, width, direction);
            for (int k = 0; k < SOBOL_BITS; k++)
                assert_int_equal(direction[k], m[d][k] << (width - 1 - k));
        }
    }
    uint64_t sum = 0;
    for (size_t d = 0; d < SOBOL_DIMENSIONS; d++) {
        sobol_directions(d, 30, direction);
        for (int k = 0; k < SOBOL_BITS; k++)
            sum = sum * 1000003 + direction[k];
    }
    assert_int_equal(sum, UINT64_C(13069965568171837952));
    /* Numbers are odd and below 2^k: bit k is the last one of direction k. */
    for (size_t d = 0; d < SOBOL_DIMENSIONS; d++) {
        sobol_directions(d, 53, direction);
        for (int k = 0; k < SOBOL_BITS; k++) {
            assert_int_equal(direction[k] & ((UINT64_C(1) << (53 - k)) - 1), UINT64_C(1)
                                                                                 << (52 - k));
            assert_int_equal(direction[k] >> 53, 0);
        }
    }
}

/* A matrix scramble takes equal parts of a coordinate to equal parts: two points share their first
 * m bits if and only if those of the sequence do, and nothing else of the sequence is left. */
TEST(test_scramble)
{
    enum { BITS = 9, N = 1 << BITS, K = 40, SEEDS = 400 };
    uint64_t direction[SOBOL_BITS];
    double *u = points_of(DOE_SOBOL, N, K, 1);
    for (size_t d = 0; d < K; d++) {
        sobol_directions(d, SOBOL_BITS, direction);
        for (int m = 1; m <= BITS; m++) {
            int image[N];
            memset(image, -1, sizeof image);
            for (size_t i = 0; i < N; i++) {
                uint64_t plain = 0;
                for (int bit = 0; bit < BITS; bit++)
                    plain ^= (i ^ i >> 1) >> bit & 1 ? direction[bit] : 0;
                const int from = (int)(plain >> (SOBOL_BITS - m)), to = (int)ldexp(u[i * K + d], m);
                assert_true(image[from] == -1 || image[from] == to);
                image[from] = to;
            }
            for (int part = 0, seen[N] = {0}; part < 1 << m; part++)
                assert_int_equal(seen[image[part]]++, 0);
        }
    }
    free(u);
    /* Over seeds the distance of two points is random but for its leading bit: without the matrix
     * it would be the same for all. */
    int high = 0;
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        u = points_of(DOE_SOBOL, 2, 1, seed);
        high += (((uint64_t)ldexp(u[0], 53) ^ (uint64_t)ldexp(u[1], 53)) >> 51 & 1) != 0;
        free(u);
    }
    assert_in_range(high, SEEDS / 2 - 50, SEEDS / 2 + 50); /* 5 deviations */
}

/* Two coordinates: of every 2^m points from a multiple of 2^m on each box of area 2^-m, of whatever
 * shape, holds one. So point 0 is no point too many. */
TEST(test_net)
{
    OWN double *u = points_of(DOE_SOBOL, 1024, 2, 77);
    for (int m = 1; m <= 8; m++) {
        for (int start = 0; start < 1024; start += 1 << m) {
            for (int split = 0; split <= m; split++) {
                char taken[256] = {0};
                for (int i = start; i < start + (1 << m); i++) {
                    const int x = (int)ldexp(u[2 * i], split);
                    const int y = (int)ldexp(u[2 * i + 1], m - split);
                    const int box = x << (m - split) | y;
                    assert_false(taken[box]);
                    taken[box] = 1;
                }
            }
        }
    }
}

/* Error of the mean of prod 1 + (x_j - 1/2) c_j, whose integral is 1: root mean square over seeds.
 */
static double integration_error(enum doe_method method, uint64_t count)
{
    enum { K = 5, SEEDS = 24 };
    double square = 0;
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        double *u = points_of(method, count, K, seed), mean = 0;
        for (uint64_t i = 0; i < count; i++) {
            double f = 1;
            for (int j = 0; j < K; j++)
                f *= 1 + (u[i * K + (size_t)j] - 0.5) * 2 / (1 + j);
            mean += f / (double)count;
        }
        square += (mean - 1) * (mean - 1) / SEEDS;
        free(u);
    }
    return sqrt(square);
}

/* Sixty-four times the points: random points are about 8 times as good, Sobol' points above 30
 * times. Strata take away what is additive. */
TEST(test_integration_order)
{
    const double random = integration_error(DOE_RANDOM, 128);
    const double random_gain = random / integration_error(DOE_RANDOM, 8192);
    const double sobol = integration_error(DOE_SOBOL, 128);
    const double sobol_gain = sobol / integration_error(DOE_SOBOL, 8192);
    assert_true(random_gain > 4 && random_gain < 16);
    assert_true(sobol_gain > 30);
    assert_true(sobol < random / 5);
    assert_true(integration_error(DOE_LHS, 128) < random / 2);
}

/* ---- designs for sensitivities --------------------------------------------------------------- */

TEST(test_saltelli)
{
    enum { K = 3, N = 64 * DOE_REPLICATES };
    for (int second = 0; second < 2; second++) {
        DOE s = {
            .method = DOE_SALTELLI, .count = N, .factors = K, .second_order = second, .seed = 4};
        assert_true(doe_begin(&s));
        const size_t block = second ? 2 * K + 2 : K + 2;
        assert_int_equal(doe_block(&s), block);
        assert_int_equal(doe_points(&s), N * block);
        OWN double *u = all_points(&s);
        bool taken[DOE_REPLICATES][2 * K][64] = {{{0}}};
        for (size_t i = 0; i < N; i++) {
            const double *A = u + i * block * K, *B = A + (block - 1) * K;
            for (size_t j = 0; j < K; j++) {
                /* Each of the sequences, dealt in turn, fills 64 equal parts once. */
                bool *of_a = taken[i % DOE_REPLICATES][j], *of_b = taken[i % DOE_REPLICATES][K + j];
                assert_false(of_a[(int)(64 * A[j])] || of_b[(int)(64 * B[j])]);
                of_a[(int)(64 * A[j])] = of_b[(int)(64 * B[j])] = true;
                assert_true(A[j] != B[j]);
                for (size_t l = 0; l < K; l++) {
                    assert_true(A[(1 + j) * K + l] == (l == j ? B[l] : A[l]));
                    assert_true(!second || A[(1 + K + j) * K + l] == (l == j ? A[l] : B[l]));
                }
            }
        }
    }
    assert_int_equal(doe_most_factors(DOE_SALTELLI), 20);
}

TEST(test_morris)
{
    enum { K = 5, N = 2000 };
    for (int levels = 2; levels <= 8; levels += 2) {
        DOE s = {.method = DOE_MORRIS, .count = N, .factors = K, .levels = levels, .seed = 8};
        assert_true(doe_begin(&s));
        assert_int_equal(doe_block(&s), K + 1);
        OWN double *u = all_points(&s);
        const double delta = levels / (2.0 * (levels - 1));
        int up = 0, first[K] = {0}, level_seen[8] = {0};
        for (size_t t = 0; t < N; t++) {
            unsigned changed = 0;
            for (size_t i = 0; i < K; i++) {
                const double *now = u + (t * (K + 1) + i) * K, *next = now + K;
                size_t different = 0, which = 0;
                for (size_t j = 0; j < K; j++) {
                    const double level = next[j] * (levels - 1);
                    assert_float_equal(level, round(level), 1e-12);
                    if (now[j] != next[j]) {
                        different++;
                        which = j;
                    }
                }
                assert_int_equal(different, 1);
                assert_float_equal(fabs(next[which] - now[which]), delta, 1e-15);
                assert_false(changed >> which & 1);
                changed |= 1u << which;
                up += next[which] > now[which];
                first[which] += i == 0;
            }
            level_seen[(int)round(u[t * (K + 1) * K] * (levels - 1))]++;
        }
        /* Directions, orders and starts are equally likely (within 5 deviations). */
        assert_true(abs(up - N * K / 2) < 5 * sqrt(N * K) / 2);
        for (int j = 0; j < K; j++)
            assert_true(abs(first[j] - N / K) < 5 * sqrt(N * (1.0 / K) * (1 - 1.0 / K)));
        for (int l = 0; l < levels; l++)
            assert_true(abs(level_seen[l] - N / levels) < 5 * sqrt(N / levels));
    }
}

/* Directions: on the sphere; moments of the uniform distribution there: E d_i = 0, E d_i d_j = 1/k
 * for i = j else 0, E d_i^4 = 3 / (k (k + 2)). */
TEST(test_sphere)
{
    enum { N = 4096 };
    for (size_t k = 1; k <= 10; k++) {
        OWN double *u = points_of(DOE_SPHERE, N, k, 2);
        double first[10] = {0}, second[10][10] = {{0}}, fourth[10] = {0};
        for (size_t p = 0; p < N; p++) {
            double d[10], square = 0;
            for (size_t i = 0; i < k; i++) {
                d[i] = 2 * u[p * k + i] - 1;
                square += d[i] * d[i];
            }
            assert_float_equal(square, 1, 1e-14);
            for (size_t i = 0; i < k; i++) {
                first[i] += d[i] / N;
                fourth[i] += pow(d[i], 4) / N;
                for (size_t j = 0; j < k; j++)
                    second[i][j] += d[i] * d[j] / N;
            }
        }
        const double n = (double)k;
        for (size_t i = 0; i < k; i++) {
            assert_float_equal(first[i], 0, 0.005);
            assert_float_equal(fourth[i], 3 / (n * (n + 2)), 0.01);
            for (size_t j = 0; j < k; j++)
                assert_float_equal(second[i][j], i == j ? 1 / n : 0, 0.01);
        }
    }
}

/* Two factors: 2^m angles fall one into each of 2^m equal sectors. */
TEST(test_circle)
{
    OWN double *u = points_of(DOE_SPHERE, 64, 2, 21);
    char taken[64] = {0};
    for (int i = 0; i < 64; i++) {
        const double angle = atan2(u[2 * i + 1] - 0.5, u[2 * i] - 0.5) / (2 * M_PI);
        const int sector = (int)floor((angle < 0 ? angle + 1 : angle) * 64) % 64;
        assert_false(taken[sector]);
        taken[sector] = 1;
    }
}
