/* test_fuzz.c - inputs that fuzzing found, and every scenario there is, through the function that
 * fuzzing calls (fuzz_scenario.c). */
#include <glob.h>

#include "fuzz_scenario.h"
#include "tests.h"

static void run_file(const char *name)
{
    FILE *in = fopen(name, "rb");
    assert_non_null(in);
    fseek(in, 0, SEEK_END);
    size_t size = (size_t)ftell(in);
    OWN uint8_t *data = room(size + 1);
    rewind(in);
    assert_int_equal(fread(data, 1, size, in), size);
    fclose(in);
    LLVMFuzzerTestOneInput(data, size);
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

TEST(test_found)
{
    run_files("tests/fuzz/found/*");
}

TEST(test_corpus)
{
    run_files("tests/fuzz/scenario/*");
}

TEST(test_bad)
{
    run_files("tests/bad/*.yaml");
}

TEST(test_shipped)
{
    run_files("scenarios/*.yaml");
    run_files("scenarios/*/*.yaml");
}
