/* say.h - what there is to say as facts, from which programs get JSON and people get a text.
 *
 * Facts are a tree of JSON. Programs get it without the members whose names begin with '.', which
 * are shown to people alone. People get a text in which stand:
 *
 *   {PATH}         the value there; {PATH%8.3f} as printf has it, without "%s" or, of numbers that
 *                  are not whole, "%.6g"; {PATH*%.1f} a hundredfold. A '*' in a format is the fact
 *                  `.width`. Of null it is nothing.
 *   {PATH#s}       "s", unless the value is 1
 *   [PATH:TEXT|OTHERWISE]   TEXT where the value there is neither null, false, 0 nor empty, else
 *                  OTHERWISE, which may be left out. Of an object, its members are facts in TEXT.
 *   [!PATH:...]    the contrary; [PATH=...:...], [PATH<...:...], [PATH>...:...] where it is, is
 *                  less or more than a number, or is a word
 *   [PATH*BETWEEN:TEXT]   TEXT for each item of a list or member of an object, BETWEEN after all
 *                  but the last: {value}, {i} from 0, of a member {key}, of an object its members
 *
 * PATH is names with '/' between them, and numbers of items; the first name is looked for in the
 * facts nearest by. After a backslash each letter stands for itself, as "|" has to in brackets.
 */
#ifndef STANCE_BASE_SAY_H
#define STANCE_BASE_SAY_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

/* A key of what programs get, for -h, which lists these where `struct command` names them. */
struct say_key {
    const char *name;         /* NULL in a whole list: `text` says in a line of its own what has
                               * the keys `of` */
    const char *text;         /* "what it is", "[low, high]" of what it consists; "": its name says
                               * it; NULL: it is not told, as columns of CSV alone */
    const struct say_key *of; /* it is a list of objects with these keys, within such a list one
                               * object; `text` goes behind */
};
/* Up to one without both: "a, b (what it is), c: [low, high]", lists in lines of their own. */
void say_keys(const struct say_key *key, FILE *out);

/* Adds to the end of a text among the facts, which is there or becomes so. */
__attribute__((format(printf, 3, 4))) void say_add(json_t *facts, const char *key,
                                                   const char *format, ...);

/* As JSON, or the text; releases the facts. False without them (no memory), or when the output
 * fails. */
bool say_facts(json_t *facts, bool json, const char *text, FILE *out);

#endif
