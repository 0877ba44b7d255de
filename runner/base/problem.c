/* problem.c - errors of a scenario, collected while it is read and printed in order of position. */
#include "problem.h"
#include "words.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

void problem_record(struct problems *problems, struct mark mark, const char *format, ...)
{
    if (problems_full(problems)) {
        problems->lost++;
        return;
    }
    struct problem *problem = &problems->list[problems->count];
    va_list arguments;

    va_start(arguments, format);
    vsnprintf(problem->text, sizeof problem->text, format, arguments);
    va_end(arguments);
    problem->mark = mark;
    problem->order = problems->count;
    for (size_t i = 0; i < problems->count; i++)
        if (mark_compare(problems->list[i].mark, mark) == 0 &&
            strcmp(problems->list[i].text, problem->text) == 0)
            return;
    problems->count++;
}

static int by_position(const void *left, const void *right)
{
    const struct problem *a = left, *b = right;
    const int order = mark_compare(a->mark, b->mark);
    return order ? order : a->order < b->order ? -1 : a->order > b->order;
}

/* Cut to some `limit` bytes, never inside a character; control characters become '?', others that
 * cannot be seen their number: at most ROOM bytes more, with the zero. */
enum { ROOM = 16 };
static void clean(char *to, size_t limit, const char *from)
{
    size_t n = 0, left = strlen(from);
    while (left > 0) {
        const unsigned char c = (unsigned char)*from;
        uint32_t letter = c;
        const size_t whole = utf8_letter(from, left, &letter), length = whole ? whole : 1;
        bool blank;
        if (n + length > limit)
            break;
        if (whole > 1 && hidden_letter(letter, &blank)) {
            n += (size_t)snprintf(to + n, ROOM, "<U+%04" PRIX32 ">", letter);
        } else {
            memcpy(to + n, from, length);
            to[n] = (c < 0x20 || c == 0x7f) ? '?' : (char)c;
            n += length;
        }
        from += length;
        left -= length;
    }
    memcpy(to + n, left > 0 ? "..." : "", left > 0 ? 4 : 1);
}

void problems_print(struct problems *problems, const char *file, const char *const *sets, FILE *out)
{
    size_t shown_count = problems->count < PROBLEMS_SHOWN ? problems->count : PROBLEMS_SHOWN;

    qsort(problems->list, problems->count, sizeof problems->list[0], by_position);
    for (size_t i = 0; i < shown_count; i++) {
        const struct problem *problem = &problems->list[i];
        if (problem->mark.set > 0) {
            char set[250 + ROOM];
            clean(set, sizeof set - ROOM, sets[problem->mark.set - 1]);
            fprintf(out, "--set %s: %s\n", set, problem->text);
        } else if (problem->mark.line > 0) {
            fprintf(out, "%s:%d:%d: %s\n", file, problem->mark.line, problem->mark.column,
                    problem->text);
        } else {
            fprintf(out, "%s: %s\n", file, problem->text);
        }
    }
    size_t rest = problems->count - shown_count + problems->lost;
    if (rest > 0)
        fprintf(out, "%s: %zu more error%s\n", file, rest, rest == 1 ? "" : "s");
}

const char *shown(char buffer[SHOWN_SIZE], const char *text)
{
    clean(buffer, SHOWN_SIZE - ROOM - 4, text);
    return buffer;
}

const char *words_join(char *buffer, size_t size, const char *separator, const char *const *words,
                       size_t count)
{
    enum { REST = 32 }; /* for how many more there are */
    size_t used = 0, whole = 0;
    buffer[0] = '\0';
    for (size_t i = 0; i < count; i++)
        whole += strlen(separator) + strlen(words[i]);
    for (size_t i = 0; i < count && used < size; i++) {
        const char *const before = i ? separator : "";
        const bool fits = whole < size || used + strlen(before) + strlen(words[i]) + REST < size;
        int n = fits ? snprintf(buffer + used, size - used, "%s%s", before, words[i])
                     : snprintf(buffer + used, size - used, "%s... %zu more", before, count - i);
        used += n > 0 ? (size_t)n : 0;
        if (!fits)
            break;
    }
    return buffer;
}
