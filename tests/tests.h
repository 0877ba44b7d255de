/* tests.h - the tests of one program, and its main: a test registers itself where it stands, so
 * that none can be written and forgotten. They run in the order in which they stand.
 *
 *   TEST(falls)
 *   {
 *       ... of cmocka's
 *   }
 */
#ifndef STANCE_TESTS_TESTS_H
#define STANCE_TESTS_TESTS_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* cmocka passes over those behind the last. */
static struct CMUnitTest registered[64];

static inline void register_test(const char *name, CMUnitTestFunction test)
{
    size_t k = 0;
    while (registered[k].name)
        if (++k == sizeof registered / sizeof *registered)
            abort();
    registered[k] = (struct CMUnitTest){.name = name, .test_func = test};
}

/* What a variable owns is given back when its block ends, by a function of its address; OWN: what
 * malloc gave. */
#define FREED(by) __attribute__((cleanup(by)))
#define OWN FREED(freed)
static inline void freed(const void *pointer)
{
    free(*(void *const *)pointer);
}

/* So many bytes, of zeros. */
static inline void *room(size_t bytes)
{
    void *const memory = calloc(1, bytes > 0 ? bytes : 1); /* not one more: sanitizers see it */
    assert_non_null(memory);
    return memory;
}

#define COUNT(list) (sizeof(list) / sizeof *(list))
/* A call of the engine's that must succeed. */
#define OK(call) assert_int_equal(call, STANCE_OK)

#define TEST(name)                                                                                 \
    static void name(void **state);                                                                \
    __attribute__((constructor)) static void register_##name(void)                                 \
    {                                                                                              \
        register_test(#name, name);                                                                \
    }                                                                                              \
    static void name(void **state __attribute__((unused)))

/* What is done before all tests and after them, and before and after each: a program that needs it
 * gives them a value. Where `instead` is there and returns 0 or more that is the exit code: its
 * arguments asked for something else. */
static CMFixtureFunction before_tests, after_tests, before_each, after_each;
static int (*instead)(int argc, char **argv);

int main(int argc, char **argv)
{
    const int code = instead ? instead(argc, argv) : -1;
    for (struct CMUnitTest *test = registered; test->name; test++)
        test->setup_func = before_each, test->teardown_func = after_each;
    return code >= 0
               ? code
               : cmocka_run_group_tests_name(__BASE_FILE__, registered, before_tests, after_tests);
}

#endif
