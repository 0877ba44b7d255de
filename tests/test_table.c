/* The writer of tables: what people see and what programs get, of numbers that are none, of text
 * that means harm, and without memory. */
#include "support.h"

#include "analysis/table/table.h"

/* An allocation that no machine can meet fails here, too, instead of ending the program. */
const char *__asan_default_options(void);
const char *__asan_default_options(void)
{
    return "allocator_may_return_null=1";
}

/* What was written. */
static char *text;
static size_t size;

static int free_text(void **state __attribute__((unused)))
{
    free(text);
    return 0;
}
static CMFixtureFunction after_tests = free_text;

static FILE *begin(void)
{
    free(text);
    text = NULL;
    return open_memstream(&text, &size);
}

static void wrote(FILE *out, const char *wanted)
{
    fclose(out);
    assert_string_equal(text, wanted);
    free(text);
    text = NULL;
}

#define TABLE FREED(table_free) struct table

static void assert_seen(const struct table *t, const char *view, size_t most, const char *wanted)
{
    FILE *out = begin();
    assert_true(table_write_text(t, out, view, most));
    wrote(out, wanted);
}

static void assert_csv(const struct table *t, const char *wanted)
{
    FILE *out = begin();
    assert_true(table_write_csv(t, out));
    wrote(out, wanted);
}

/* Takes the tree over. */
static void assert_json(json_t *root, const char *wanted)
{
    assert_non_null(root);
    OWN char *dumped = json_dumps(root, JSON_COMPACT);
    assert_string_equal(dumped, wanted);
    json_decref(root);
}

static void add_row(struct table *t, const char *name, double share, double low, double high,
                    uint64_t count, const char *note)
{
    TABLE_FACTS(
        t, {{"name", "name", .width = 6, .left = true}, as_text(name)},
        {{"count", "n", .width = 3}, as_whole(count)},
        {{"share", "share", "%.1f %%", .width = 8, .percent = true}, as_number(share)},
        {{"low", "interval", "(%.2f", .before = "   ", .left = true, .empty = ""}, as_number(low)},
        {{"high", .format = "%.2f)", .joined = true, .before = " ... "}, as_number(high)},
        {{"note", .hidden = TABLE_VIEW_ONLY, .empty = ""}, as_nothing(note)});
    table_end_row(t);
}

static const char view[] = "name count share low high note";

TEST(test_alignment)
{
    TABLE t = {0};
    add_row(&t, "a", 0.125, 0.1, 0.2, 7, NULL);
    add_row(&t, "much longer", 1, NAN, NAN, 123456, "so");
    assert_int_equal(table_rows(&t), 2);
    assert_seen(&t, view, 0,
                "  name             n    share   interval\n"
                "  a                7   12.5 %   (0.10 ... 0.20)\n"
                "  much longer 123456  100.0 %                   so\n");
    /* Another view: other columns in another order, no wider than they need. */
    assert_seen(&t, "count name", 0, "       n name\n       7 a\n  123456 much longer\n");
    assert_seen(&t, "unknown", 0, "\n\n");
}

TEST(test_letters)
{
    TABLE t = {0};
    add_row(&t, "\xc3\xa4\xc3\xb6", 0.5, NAN, NAN, 1, NULL); /* two letters, four bytes */
    assert_seen(&t, "name count", 0, "  name     n\n  \xc3\xa4\xc3\xb6       1\n");
}

TEST(test_nothing)
{
    TABLE t = {0};
    const double numbers[] = {NAN, INFINITY, -INFINITY, 0.1, 1.0 / 3, 123456789012345678.0, 1e-300};
    for (size_t i = 0; i < COUNT(numbers); i++) {
        TABLE_FACTS(&t, {{.name = "x", .heading = "x"}, as_number(numbers[i])},
                    {{"y", "y", .empty = "none"}, i ? as_text("") : as_nothing(NULL)},
                    {{.name = "z", .heading = "z"}, as_nothing(i ? NULL : "unknown")},
                    {{"w", .hidden = TABLE_NO_CSV}, as_truth(i == 0)});
        table_end_row(&t);
    }
    assert_seen(&t, "x y z", 3,
                "       x    y       z\n"
                "       - none unknown\n"
                "     0.1            -\n"
                "  1e-300            -\n"
                "  (3 of 7 rows; --csv and --json have them all)\n");
    assert_csv(&t, "x,y,z\r\n,,\r\ninf,,\r\n-inf,,\r\n0.1,,\r\n0.3333333333333333,,\r\n"
                   "1.2345678901234568e+17,,\r\n1e-300,,\r\n");
    JSON *list = table_json(&t, false);
    assert_true(json_is_null(json_object_get(json_array_get(list, 1), "x")));
    assert_true(json_is_null(json_object_get(json_array_get(list, 0), "y")));
    assert_true(json_is_true(json_object_get(json_array_get(list, 0), "w")));
    assert_true(json_real_value(json_object_get(json_array_get(list, 4), "x")) == 1.0 / 3);
}

TEST(test_quotes)
{
    TABLE t = {0};
    TABLE_COLUMNS(&t, {.name = "plain"}, {.name = "a,b"}, {.name = "c"});
    TABLE_VALUES(&t, as_text("he said \"so\""), as_text("two\nlines"));
    TABLE_VALUES(&t, as_text("a,b"));
    TABLE_VALUES(&t, as_whole(UINT64_MAX), as_text(""), as_text("last"));
    assert_csv(&t, "plain,\"a,b\",c\r\n\"he said \"\"so\"\"\",\"two\nlines\",\"a,b\"\r\n"
                   "18446744073709551615,,last\r\n");
    table_clear(&t); /* goes on without a head */
    TABLE_VALUES(&t, as_text("x"), as_text("y"), as_text("z"));
    assert_csv(&t, "x,y,z\r\n");
}

/* Text from a file: what is no letter, what moves the cursor, what ends a string. */
TEST(test_hostile)
{
    static const char bad[] = "\xff\x1b[2J\n%s%n\"\\";
    TABLE t = {0};
    TABLE_FACTS(&t, {{.name = "x", .heading = "x"}, as_text(bad)},
                {{.name = "y", .heading = "y"}, as_number(1)});
    table_end_row(&t);
    assert_seen(&t, "x y", 0, "             x y\n  ? [2J %s%n\"\\ 1\n");
    assert_csv(&t, "x,y\r\n\"\xff\x1b[2J\n%s%n\"\"\\\",1\r\n");
    /* Where it is no UTF-8 it is cleaned, else JSON escapes it. */
    assert_json(table_json(&t, false), "[{\"x\":\"? [2J %s%n\\\"\\\\\",\"y\":1.0}]");
    assert_json(TABLE_OBJECT({"x", as_text("\x1b\n")}), "{\"x\":\"\\u001B\\n\"}");

    /* Far too long a text is cut, for people alone. */
    TABLE longer = {0};
    OWN char *letters = room(100000);
    memset(letters, 'x', 99999);
    letters[99999] = '\0';
    TABLE_FACTS(&longer, {{.name = "x", .heading = "x"}, as_text(letters)},
                {{"y", .joined = true, .before = " and "}, as_text(letters)});
    table_end_row(&longer);
    FILE *out = begin();
    assert_true(table_write_text(&longer, out, "x y", 0));
    fclose(out);
    assert_true(size < 2000);
    out = begin();
    assert_true(table_write_csv(&longer, out));
    fclose(out);
    assert_int_equal(size, 5 + 2 * 99999 + 1 + 2);
}

/* ---- JSON --------------------------------------------------------------------------------- */

TEST(test_json)
{
    double values[] = {0.25, 0.5};
    char *words[] = {"one", "two"};
    struct results r = {
        .axes = 2,
        .axis = {{.name = "ground.friction", .count = 2, .value = values},
                 {.name = "method.name", .count = 2, .value = (double[]){0, 1}, .word = words}}};
    const size_t point[SCENARIO_MAX_AXES] = {1, 1};
    struct table t = {0}, none = {0};
    table_axes(&t, &r, (const int[]){0, 1}, 2, point);
    TABLE_FACTS(&t, {{"first_low", .group = "first", .key = "low"}, as_number(0.5)},
                {{"csv", .hidden = TABLE_NO_JSON}, as_whole(1)},
                {{"tree", .hidden = TABLE_NO_CSV}, as_tree(json_pack("[i,i]", 1, 2))});
    table_end_row(&t);
    assert_json(table_json(&t, false), "[{\"at\":{\"ground.friction\":0.5,\"method.name\":\"two\"},"
                                       "\"first\":{\"low\":0.5},\"tree\":[1,2]}]");
    assert_json(table_json(&t, false), "[{\"at\":{\"ground.friction\":0.5,\"method.name\":\"two\"},"
                                       "\"first\":{\"low\":0.5},\"tree\":[1,2]}]"); /* once more */
    assert_csv(&t, "ground.friction,method.name,first_low,csv\r\n0.5,two,0.5,1\r\n");
    assert_seen(&t, "at/", 0,
                "   ground.friction      method.name\n               0.5              two\n");
    table_free(&t);

    TABLE_FACTS(&t, {{"name", .hidden = TABLE_NO_JSON}, as_text("k")},
                {{.name = "n"}, as_whole(2)});
    table_end_row(&t);
    assert_json(table_json(&t, true), "{\"k\":{\"n\":2}}");
    table_free(&t);

    table_axes(&none, &r, NULL, 0, point); /* there, even if it is empty */
    table_end_row(&none);
    assert_json(table_json(&none, false), "[{\"at\":{}}]");
    table_free(&none);
}

/* ---- failures ----------------------------------------------------------------------------- */

static void *no_room(size_t bytes)
{
    (void)bytes;
    return NULL;
}

TEST(test_no_memory)
{
    TABLE t = {0};
    JSON *tree = json_array();
    add_row(&t, "a", 1, 2, 3, 4, "note");
    t.letters = SIZE_MAX / 8; /* the next text asks for more than there can be */
    TABLE_VALUES(&t, as_text("b"));
    assert_true(t.failed);
    t.letters = 0;
    TABLE_VALUES(&t, as_tree(json_incref(tree))); /* is released */
    assert_int_equal(tree->refcount, 1);
    TABLE_COLUMNS(&t, {.name = "more"});
    FILE *out = begin();
    assert_false(table_write_text(&t, out, view, 0));
    assert_false(table_write_csv(&t, out));
    fclose(out);
    assert_null(table_json(&t, false));
    assert_null(table_json(&t, true));
    table_free(&t);

    add_row(&t, "a", 1, 2, 3, 4, "note");
    json_set_alloc_funcs(no_room, free);
    assert_null(table_json(&t, false));
    assert_null(table_json(&t, true));
    assert_null(TABLE_OBJECT({"a", as_text("b")}));
    out = begin();
    assert_false(table_write_json(TABLE_OBJECT({"a", as_whole(1)}), out));
    fclose(out);
    json_set_alloc_funcs(malloc, free);
}

TEST(test_no_output)
{
    TABLE t = {0};
    add_row(&t, "a", 1, 2, 3, 4, NULL);
    FILE *full = fopen("/dev/full", "w");
    assert_non_null(full);
    setvbuf(full, NULL, _IONBF, 0);
    assert_false(table_write_text(&t, full, view, 0));
    assert_false(table_write_csv(&t, full));
    assert_false(table_write_json(table_json(&t, false), full));
    fclose(full);
}

static void assert_said(const char *facts, const char *of, const char *wanted)
{
    FILE *out = begin();
    assert_true(say_facts(json_loads(facts, 0, NULL), false, of, out));
    wrote(out, wanted);
}

/* Texts with holes for facts, as say.h has them. */
TEST(test_say)
{
    static const char facts[] =
        "{'a': 1, 'b': 2.5, 'none': null, 'no': false, 'nil': 0, 'word': 'x', 'empty': '', "
        "'list': [3, 4], 'rows': [{'k': 'p', 'a': 7}, {'k': 'q'}], 'map': {'u': 1, 'v': 2}, "
        "'.width': 4}";
    char quoted[sizeof facts];
    for (size_t i = 0; i < sizeof facts; i++)
        quoted[i] = facts[i] == '\'' ? '"' : facts[i];
    assert_said(quoted, "{a} {b} {b%.2f} {b%6.1f}| {b*%.0f} {word%-3s}| {word%*s} {none%3s}|",
                "1 2.5 2.50    2.5| 250 x  |    x    |");
    assert_said(quoted, "{a} case{a#s}, {b} case{b#s}, {map/v} {list/1} {rows/0/a}",
                "1 case, 2.5 cases, 2 4 7");
    assert_said(quoted, "[a:A|-][none:A|-][no:A|-][nil:A|-][empty:A|-][gone:A|-][list:A]",
                "A-----A");
    assert_said(quoted,
                "[!none:A|-][a=1:A|-][b>2:A|-][b<2:A|-][word=x:A|-][word=y:A|-][none=0:A|-]",
                "AAA-A--");
    assert_said(quoted, "[list*, :{i}:{value}] [map*;:{key}={value}] [rows*:{k}{a}] [map:{u}{a}]",
                "0:3, 1:4 u=1;v=2 p7q1 11");
    assert_said(quoted, "[list*\\|:\\[{value}\\]] \\{ } [a:x\\|y[no:z|\\]]|w]", "[3]|[4] { } x|y]");
    json_t *const added = json_object();
    say_add(added, ".t", "%d", 1);
    say_add(added, ".t", "-%s", "b");
    assert_string_equal(json_string_value(json_object_get(added, ".t")), "1-b");
    json_object_set_new(added, "seen", json_pack("[{s:i,s:i}]", "p", 1, ".q", 2));
    FILE *out = begin();
    assert_true(say_facts(added, true, NULL, out)); /* what is for people alone is left out */
    wrote(out, "{\n  \"seen\": [\n    {\n      \"p\": 1\n    }\n  ]\n}\n");
    out = begin();
    assert_false(say_facts(NULL, false, "x", out));
    wrote(out, "");
}

/* Facts that are listed once: values of columns and members, keys as -h has them. */
#define FACTS(X)                                                                                   \
    X("n", "", as_whole(n), "n", .width = 3)                                                       \
    X("part", "of all, null: none", as_number(part), "part", "%.1f %%", .percent = true)           \
    X("word", NULL, as_text("w"), .hidden = TABLE_NO_JSON)                                         \
    X("at", "[low, high]", as_tree(table_pair(1, NAN)), .hidden = TABLE_NO_CSV)

TEST(test_facts)
{
    static const struct say_key inner[] = {FACTS(TABLE_KEY){0}},
                                rows[] = {TABLE_KEY_AT{"inner", "", inner}, {0}},
                                list[] = {FACTS(TABLE_KEY){"rows", "null beyond", rows}, {0}},
                                keys[] = {{NULL, "", list}, {NULL, "of --one:", inner}, {0}};
    static const char members[] = "{\"n\":7,\"part\":0.5,\"word\":\"w\",\"at\":[1.0,null]}";
    TABLE t = {0};
    const uint64_t n = 7;
    const double part = 0.5;
    TABLE_FACTS(&t, FACTS(TABLE_FACT));
    table_end_row(&t);
    assert_seen(&t, "n part", 0, "    n   part\n    7 50.0 %\n");
    assert_csv(&t, "n,part,word\r\n7,0.5,w\r\n");
    assert_json(table_json(&t, false), "[{\"n\":7,\"part\":0.5,\"at\":[1.0,null]}]");
    assert_json(TABLE_OBJECT(FACTS(TABLE_MEMBER)), members);
    FILE *const out = begin();
    say_keys(keys, out);
    wrote(out, "    n, part (of all, null: none), at: [low, high]\n"
               "    rows    [{at: {path: value}, inner: {n, part (of all, null: none), at: [low, "
               "high]}}]; null beyond\n"
               "  of --one:\n"
               "    n, part (of all, null: none), at: [low, high]\n");
}
