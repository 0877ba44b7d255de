/* test_mistakes.c - mistakes in scenario files: what is said of each, and that what it says mends
 * it.
 *
 * The mistakes are in tests/mistakes.txt, whose head says how.
 */
#include "reading.h"

enum { TEXT = 4096, MISTAKES = 150 };

/* Whether `line` begins a new part of a scenario, and with the key of `part`. */
static bool begins_part(const char *line)
{
    return line[0] && !strchr(" \t}\n", line[0]);
}
static size_t key_length(const char *line)
{
    return strcspn(line, ": =");
}

/* The base with `part` in the place of its own part of that key, or at the end. */
static void replace(char text[2 * TEXT], const char *base, const char *part, const char *key)
{
    const size_t length = key_length(key);
    bool own = false, done = false;
    size_t n = 0;
    for (const char *line = base; *line;) {
        const char *const end = strchr(line, '\n') + 1;
        if (begins_part(line)) {
            own = key_length(line) == length && strncmp(line, key, length) == 0;
            if (own)
                n += (size_t)snprintf(text + n, TEXT, "%s", part);
            done = done || own;
        }
        if (!own)
            n += (size_t)snprintf(text + n, TEXT, "%.*s", (int)(end - line), line);
        line = end;
    }
    snprintf(text + n, TEXT, "%s", done ? "" : part);
}

/* What the message says to write stands in what is right. */
static bool is_mended(const char *message, const char *right)
{
    const char *write = strstr(message, "; write ");
    if (!write || strstr(write, "...") || strstr(write, "grid: ") || strstr(write, "blanks"))
        return true;
    write += strlen("; write ");
    char wanted[512];
    snprintf(wanted, sizeof wanted, "%.*s", (int)strcspn(write, "\n"), write);
    return strstr(right, wanted) != NULL;
}

static int check(const char *base, const char *wrong, const char *right, const char *said)
{
    char text[2 * TEXT], wanted[TEXT] = "";
    SCENARIO s = {0};
    int failed = 0;

    for (const char *line = said; *line; line = strchr(line, '\n') + 1)
        snprintf(wanted + strlen(wanted), sizeof wanted - strlen(wanted), "bad.yaml:%.*s\n",
                 (int)strcspn(line, "\n"), line);
    replace(text, base, wrong, right);
    if (read_as(&s, "bad.yaml", text, NULL, 0)) {
        print_error("accepted:\n%s", wrong);
        failed++;
    } else if (strcmp(errors, wanted) != 0) {
        print_error("%s%snot %s", wrong, errors, wanted);
        failed++;
    }
    bool mended = false;
    for (const char *line = said; *line; line = strchr(line, '\n') + 1)
        mended = mended || is_mended(line, right);
    if (!mended) {
        print_error("%sis not mended by\n%s", said, right);
        failed++;
    }
    replace(text, base, right, right);
    if (!read_as(&s, "good.yaml", text, NULL, 0)) {
        print_error("%s%s", right, errors);
        return failed + 1;
    }
    return failed;
}

TEST(every_mistake_says_what_mends_it)
{
    static char base[TEXT], part[3][TEXT]; /* wrong, right, said */
    static const char kinds[] = "-+=";
    FILE *const in = fopen("tests/mistakes.txt", "r");
    char line[1024];
    int mistakes = 0, failed = 0;
    bool in_base = false;

    assert_non_null(in);
    for (bool more = true; more;) {
        more = fgets(line, sizeof line, in) != NULL;
        const char *const kind = more && line[0] && !in_base ? strchr(kinds, line[0]) : NULL;
        if (kind && *kind) {
            char *const to = part[kind - kinds];
            snprintf(to + strlen(to), TEXT - strlen(to), "%s", line + (line[1] == ' ' ? 2 : 1));
            continue;
        }
        if (part[0][0]) {
            failed += check(base, part[0], part[1], part[2]);
            mistakes++;
        }
        part[0][0] = part[1][0] = part[2][0] = '\0';
        if (strncmp(line, "base ", 5) == 0) {
            in_base = true;
            base[0] = '\0';
        } else if (strcmp(line, "end\n") == 0) {
            in_base = false;
        } else if (in_base) {
            snprintf(base + strlen(base), TEXT - strlen(base), "%s", line);
        }
    }
    fclose(in);
    assert_int_equal(failed, 0);
    assert_true(mistakes >= MISTAKES);
}
