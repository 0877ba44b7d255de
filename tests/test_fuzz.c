/* test_fuzz.c - inputs that fuzzing found, and every scenario there is, through the function that
 * fuzzing calls (fuzz_scenario.c). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>

#include "fuzz_scenario.h"

static void run_file(const char *name)
{
    FILE *in = fopen(name, "rb");
    assert_non_null(in);
    fseek(in, 0, SEEK_END);
    size_t size = (size_t)ftell(in);
    uint8_t *data = malloc(size + 1);
    assert_non_null(data);
    rewind(in);
    assert_int_equal(fread(data, 1, size, in), size);
    fclose(in);
    LLVMFuzzerTestOneInput(data, size);
    free(data);
}

static void run_files(const char *pattern)
{
    glob_t files;
    assert_int_equal(glob(pattern, 0, NULL, &files), 0);
    assert_true(files.gl_pathc > 0);
    for (size_t i = 0; i < files.gl_pathc; i++)
        run_file(files.gl_pathv[i]);
    globfree(&files);
}

static void test_found(void **state)
{
    (void)state;
    run_files("tests/fuzz/found/*");
}

static void test_corpus(void **state)
{
    (void)state;
    run_files("tests/fuzz/scenario/*");
}

static void test_bad(void **state)
{
    (void)state;
    run_files("tests/bad/*.yaml");
}

static void test_shipped(void **state)
{
    (void)state;
    run_files("scenarios/*.yaml");
    run_files("scenarios/*/*.yaml");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_found),
        cmocka_unit_test(test_corpus),
        cmocka_unit_test(test_bad),
        cmocka_unit_test(test_shipped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
