/* command_compare.c - `stance compare FILE FILE`: what differs, as text or JSON. */
#include "compare_labels.h"
#include "runner/store/compare.h"

#include "analysis/table/csv.h"
#include "analysis/table/json.h"
#include "runner/base/command.h"
#include "runner/base/sandbox.h"
#include "runner/store/results_rows.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern const struct command command_compare; /* below */

/* Where a place is: "case 17 (initial.offset.theta = -0.1 rad, ...), component 2". */
static void place_text(const struct results *r, const struct compare_difference *difference,
                       const struct compare_place *place, char *text, size_t size)
{
    char where[600] = "";
    if (difference->cases && !r->single && place->index < r->cases)
        results_case_text(r, place->index, where, sizeof where);
    size_t used = (size_t)snprintf(
        text, size, "%s %llu%s%s%s", difference->cases ? "case" : "element",
        (unsigned long long)place->index, where[0] ? " (" : "", where, where[0] ? ")" : "");
    if (difference->several && used < size)
        snprintf(text + used, size - used, ", component %zu", place->component);
}

/* The largest of the differences that a tolerance allows or not. */
static void print_largest(const struct results *r, const struct compare_difference *difference)
{
    const struct compare_place *place = &difference->largest_place;
    char where[800];
    place_text(r, difference, place, where, sizeof where);
    printf("  largest difference %.3g in %s: %s | %s\n", difference->largest, where,
           place->value[0], place->value[1]);
}

static void print_difference(const struct results *r, const struct compare_difference *difference)
{
    char where[800];
    const char *what = difference->cases ? "case" : "element";
    if (strcmp(difference->reason, "values") != 0) {
        bool missing = strncmp(difference->reason, "only", 4) == 0;
        printf("%s: %s%s\n", difference->name, missing ? "" : "different ", difference->reason);
        return;
    }
    if (difference->differing == 0) {
        printf("%s: equal within the tolerance\n", difference->name);
        print_largest(r, difference);
        return;
    }
    if (difference->of == 1 && !difference->several) {
        printf("%s: %s | %s\n", difference->name, difference->place[0].value[0],
               difference->place[0].value[1]);
        return;
    }
    printf("%s: %llu of %llu %s%s differ\n", difference->name,
           (unsigned long long)difference->differing, (unsigned long long)difference->of, what,
           difference->of == 1 ? "" : "s");
    for (int k = 0; k < difference->shown; k++) {
        const struct compare_place *place = &difference->place[k];
        place_text(r, difference, place, where, sizeof where);
        printf("  %s: %s | %s\n", where, place->value[0], place->value[1]);
    }
    if (difference->largest > 0)
        print_largest(r, difference);
}

/* Of a name that may not be UTF-8, which JSON asks for. */
static json_t *json_name(const char *name)
{
    char *clean = strdup(name);
    if (clean)
        results_clean(clean);
    json_t *text = clean ? json_string(clean) : NULL;
    free(clean);
    return text ? text : json_null();
}

/* Coordinates of a case as {path: value}. */
static json_t *json_point(const struct results *r, uint64_t index)
{
    json_t *at = json_object();
    size_t point[SCENARIO_MAX_AXES];
    results_point(r, index, point);
    for (int a = 0; a < r->axes; a++)
        json_object_set_new(at, r->axis[a].name, results_json_value(&r->axis[a], point[a]));
    return at;
}

static json_t *json_place(const struct results *r, const struct compare_difference *difference,
                          const struct compare_place *place)
{
    json_t *entry = json_object(), *values = json_array();
    const bool known = difference->cases && !r->single && place->index < r->cases;
    json_object_set_new(entry, "index", json_integer((json_int_t)place->index));
    json_object_set_new(entry, "component", json_integer((json_int_t)place->component));
    json_object_set_new(entry, "at", known ? json_point(r, place->index) : json_object());
    for (int f = 0; f < 2; f++)
        json_array_append_new(values, json_string(place->value[f]));
    json_object_set_new(entry, "values", values);
    return entry;
}

static json_t *json_places(const struct results *r, const struct compare_difference *difference)
{
    json_t *list = json_array();
    for (int k = 0; k < difference->shown; k++)
        json_array_append_new(list, json_place(r, difference, &difference->place[k]));
    return list;
}

static json_t *json_files(const struct results r[2])
{
    json_t *files = json_array();
    json_array_append_new(files, json_name(r[0].file));
    json_array_append_new(files, json_name(r[1].file));
    return files;
}

static bool print_json(const struct results r[2], const struct comparison *comparison)
{
    json_t *differences = json_array();
    for (size_t i = 0; i < comparison->count; i++) {
        const struct compare_difference *difference = &comparison->difference[i];
        json_t *entry = json_object();
        json_object_set_new(entry, "name", json_string(difference->name));
        json_object_set_new(entry, "reason", json_string(difference->reason));
        json_object_set_new(entry, "of_cases", json_boolean(difference->cases));
        json_object_set_new(entry, "differing", json_integer((json_int_t)difference->differing));
        json_object_set_new(entry, "of", json_integer((json_int_t)difference->of));
        json_object_set_new(entry, "first", json_places(&r[0], difference));
        json_object_set_new(entry, "largest",
                            difference->largest > 0 && isfinite(difference->largest)
                                ? json_real(difference->largest)
                                : json_null());
        json_object_set_new(entry, "largest_at",
                            difference->largest > 0
                                ? json_place(&r[0], difference, &difference->largest_place)
                                : json_null());
        json_array_append_new(differences, entry);
    }
    json_t *root = json_object();
    json_object_set_new(root, "files", json_files(r));
    json_object_set_new(root, "identical",
                        json_boolean(comparison->count == 0 && !comparison->tolerances));
    json_object_set_new(root, "equal", json_boolean(comparison->beyond == 0));
    json_object_set_new(root, "differences", differences);
    bool good = root && json_dumpf(root, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) == 0;
    json_decref(root);
    putchar('\n');
    return good;
}

static void print_csv(const struct results r[2], const struct comparison *comparison)
{
    static const char *const head[] = {"name",    "reason",       "differing", "of",
                                       "largest", "largest_case", "first",     "second"};
    struct csv csv = {.file = stdout};
    csv_row(&csv, head, sizeof head / sizeof head[0]);
    for (size_t i = 0; i < comparison->count; i++) {
        const struct compare_difference *difference = &comparison->difference[i];
        const bool measured = difference->largest > 0;
        const struct compare_place *place =
            measured ? &difference->largest_place : &difference->place[0];
        char where[800] = "";
        if (measured || difference->shown > 0)
            place_text(&r[0], difference, place, where, sizeof where);
        csv_text(&csv, difference->name);
        csv_text(&csv, difference->reason);
        csv_number(&csv, (double)difference->differing);
        csv_number(&csv, (double)difference->of);
        csv_number(&csv, measured ? difference->largest : NAN);
        csv_text(&csv, where);
        csv_text(&csv, place->value[0]);
        csv_text(&csv, place->value[1]);
        csv_end_row(&csv);
    }
}

static void print_text(const struct results r[2], const struct comparison *comparison)
{
    if (comparison->count == 0) {
        puts(comparison->tolerances ? "equal within the tolerance: no number differs"
                                    : "identical");
        return;
    }
    if (comparison->beyond == 0) {
        printf("equal within the tolerance: %zu variable%s in which numbers differ\n",
               comparison->count, comparison->count == 1 ? "" : "s");
    }
    printf("%s | %s\n", r[0].file, r[1].file);
    for (size_t i = 0; i < comparison->count; i++)
        print_difference(&r[0], &comparison->difference[i]);
}

/* ---- labels alone ------------------------------------------------------------------------- */

static const char *label_at(const struct results *r, uint64_t index)
{
    return results_kind_names[r->kind[index]];
}

static double equal_share(const struct label_comparison *c)
{
    return c->compared ? (double)c->equal / (double)c->compared : 1;
}

static bool print_labels_json(const struct results r[2], const struct label_comparison *c)
{
    json_t *first = json_array();
    for (int k = 0; k < c->shown; k++) {
        const uint64_t i = c->place[k];
        json_array_append_new(first, json_pack("{s:I, s:o, s:[s,s]}", "index", (json_int_t)i, "at",
                                               r[0].single ? json_object() : json_point(&r[0], i),
                                               "values", label_at(&r[0], i), label_at(&r[1], i)));
    }
    json_t *root = json_pack("{s:o, s:I, s:I, s:f, s:o, s:o}", "files", json_files(r), "compared",
                             (json_int_t)c->compared, "equal", (json_int_t)c->equal, "equal_share",
                             equal_share(c), "farthest",
                             c->farthest ? json_integer((json_int_t)c->farthest) : json_null(),
                             "first", first);
    bool good = root && json_dumpf(root, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) == 0;
    json_decref(root);
    putchar('\n');
    return good;
}

static void print_labels(const struct results r[2], const struct label_comparison *c)
{
    const uint64_t unequal = c->compared - c->equal;
    char where[600];

    printf("labels: %llu of %llu equal (%.5g %%)\n", (unsigned long long)c->equal,
           (unsigned long long)c->compared, 100 * equal_share(c));
    if (c->farthest > 0) {
        printf("unequal: %llu, at most %llu cell%s from another label in %s\n",
               (unsigned long long)unequal, (unsigned long long)c->farthest,
               c->farthest == 1 ? "" : "s", r[0].file);
    } else if (unequal > 0) {
        printf("unequal: %llu, and %s has no boundary\n", (unsigned long long)unequal, r[0].file);
    }
    for (int k = 0; k < c->shown; k++) {
        results_case_text(&r[0], c->place[k], where, sizeof where);
        printf("  case %llu%s%s%s: %s | %s\n", (unsigned long long)c->place[k],
               where[0] ? " (" : "", where, where[0] ? ")" : "", label_at(&r[0], c->place[k]),
               label_at(&r[1], c->place[k]));
    }
}

/* ---- the command -------------------------------------------------------------------------- */

struct request {
    const char *file[2];
    bool json, csv, labels;
    const char **tolerance; /* as given */
    size_t tolerance_count;
};

/* "RELATIVE[,ABSOLUTE]" or "NAME=RELATIVE[,ABSOLUTE]"; `name` holds the NAME. */
static bool read_tolerance(const char *text, char name[96], struct compare_tolerance *tolerance)
{
    const char *equals = strchr(text, '='), *numbers = equals ? equals + 1 : text;
    char *end;
    *tolerance = (struct compare_tolerance){equals ? name : NULL, 0, 0};
    snprintf(name, 96, "%.*s", equals ? (int)(equals - text) : 0, text);
    tolerance->relative = strtod(numbers, &end);
    bool good = end != numbers;
    if (good && *end == ',') {
        const char *second = end + 1;
        tolerance->absolute = strtod(second, &end);
        good = end != second;
    }
    if (good && *end == '\0' && tolerance->relative >= 0 && tolerance->absolute >= 0 &&
        isfinite(tolerance->relative) && isfinite(tolerance->absolute))
        return true;
    fprintf(stderr,
            "stance compare: --tolerance takes RELATIVE[,ABSOLUTE] or ANSWER=RELATIVE[,ABSOLUTE], "
            "not '%.60s'\n",
            text);
    return false;
}

/* Whether an answer stands for words (outcome, status ...), which have no tolerance. */
static bool is_flag(const struct results *r, const char *name)
{
    struct results_column column = {.id = -1};
    stance_message ignored = {""};
    const bool flag =
        results_column_open(r, name, &column, &ignored) && column.id >= 0 && column.words != NULL;
    results_column_close(&column);
    return flag;
}

static int compare_all(const struct results r[2], const struct request *request)
{
    struct compare_tolerances tolerances = {.count = request->tolerance_count};
    char names[COMPARE_TOLERANCES][96];
    struct comparison comparison;
    stance_message message = {""};

    for (size_t i = 0; i < tolerances.count; i++) {
        if (!read_tolerance(request->tolerance[i], names[i], &tolerances.tolerance[i]))
            return EXIT_USAGE;
        const char *name = tolerances.tolerance[i].name;
        if (name && !compare_has(&r[0], name) && !compare_has(&r[1], name)) {
            fprintf(stderr, "stance compare: --tolerance: neither file has a variable '%.60s'\n",
                    name);
            return EXIT_USAGE;
        }
        if (name && is_flag(&r[0], name)) {
            fprintf(stderr, "stance compare: --tolerance: '%.60s' is no number\n", name);
            return EXIT_USAGE;
        }
    }
    if (!compare_results(&comparison, &r[0], &r[1], tolerances.count > 0 ? &tolerances : NULL,
                         &message)) {
        fprintf(stderr, "%s\n", message.text);
        return EXIT_IO;
    }
    int code = comparison.beyond == 0 ? EXIT_DONE : EXIT_CASES_FAILED;
    if (request->csv) {
        print_csv(r, &comparison);
    } else if (!request->json) {
        print_text(r, &comparison);
    } else if (!print_json(r, &comparison)) {
        fputs("stance compare: the comparison could not be written\n", stderr);
        code = EXIT_IO;
    }
    compare_free(&comparison);
    return code;
}

static int compare_only_labels(const struct results r[2], bool json)
{
    struct label_comparison comparison;
    stance_message message = {""};

    if (!compare_labels(&comparison, &r[0], &r[1], &message)) {
        fprintf(stderr, "%s\n", message.text);
        return EXIT_USAGE;
    }
    if (!json) {
        print_labels(r, &comparison);
    } else if (!print_labels_json(r, &comparison)) {
        fputs("stance compare: the comparison could not be written\n", stderr);
        return EXIT_IO;
    }
    return comparison.equal == comparison.compared ? EXIT_DONE : EXIT_CASES_FAILED;
}

/* Cases that do not verify would be left out as pending ones are. */
static bool refuse_damage(const struct results *r)
{
    if (r->damage.cases > 0)
        fprintf(stderr, "stance compare: %.200s is damaged and not compared\n", r->file);
    return r->damage.cases > 0;
}

static int compare(void *context)
{
    const struct request *request = context;
    struct results r[2];
    stance_message message = {""};

    for (int f = 0; f < 2; f++) {
        if (!results_open(&r[f], request->file[f], &message)) {
            fprintf(stderr, "%s\n", message.text);
            if (f == 1)
                results_close(&r[0]);
            return EXIT_IO;
        }
    }
    int code = EXIT_IO;
    if (!refuse_damage(&r[0]) && !refuse_damage(&r[1]))
        code = request->labels ? compare_only_labels(r, request->json) : compare_all(r, request);
    results_close(&r[0]);
    results_close(&r[1]);
    return code;
}

static int run(int argc, char **argv)
{
    const char *files[2], *tolerance[COMPARE_TOLERANCES];
    size_t json = 0, csv = 0, labels = 0, tolerances = 0, operands = 0;
    bool help = false;
    const struct option_spec specs[] = {
        {"--json", false, NULL, 0, &json},
        {"--csv", false, NULL, 0, &csv},
        {"--labels", false, NULL, 0, &labels},
        {"--tolerance", true, tolerance, COMPARE_TOLERANCES, &tolerances}};

    if (!command_options(&command_compare, argc, argv, specs, 4, files, 2, &operands, &help))
        return EXIT_USAGE;
    if (help)
        return EXIT_DONE;
    if (operands < 2) {
        fputs("stance compare: two results files are needed (stance compare -h explains)\n",
              stderr);
        return EXIT_USAGE;
    }
    if ((json && csv) || (labels && (csv || tolerances))) {
        fprintf(stderr, "stance compare: %s\n",
                json && csv ? "--json or --csv, not both"
                            : "--labels goes with neither --tolerance nor --csv");
        return EXIT_USAGE;
    }
    struct request request = {{files[0], files[1]}, json > 0,  csv > 0,
                              labels > 0,           tolerance, tolerances};
    char names[2100];
    snprintf(names, sizeof names, "%s or %s", files[0], files[1]);
    return sandbox(compare, &request, names);
}

const struct command command_compare = {
    "compare",
    "compare FILE FILE [--tolerance [ANSWER=]RELATIVE[,ABSOLUTE]]... [--labels] [--json | --csv]",
    "what differs between two results files, bit for bit, beyond a tolerance, or in their labels",
    run,
    "Prints `identical` (exit code 0), or every variable and attribute that differs with the "
    "first\n"
    "few cases and both values (exit code 1). Left out are group `timing`, the attributes that "
    "say\n"
    "where a file comes from (program_version, git_revision, compiler, library_versions,\n"
    "instruction_set, ranks, hosts, date, merged_from, merge_note) and the rows of cases that are "
    "pending in either file:\n"
    "`status` differs there when one has them. A NAN equals a NAN; 0 and -0 differ.\n"
    "\n"
    "  --tolerance RELATIVE[,ABSOLUTE]\n"
    "           numbers a, b are equal when |a - b| <= ABSOLUTE + RELATIVE max(|a|, |b|); with\n"
    "           ANSWER= (a variable's name) of that answer alone, before the general one. Only\n"
    "           variables are compared then, not attributes: files of two scenarios over the same\n"
    "           axes may be equal. Outcomes and other flags have no tolerance. Prints how many\n"
    "           cases differ by more, and the largest difference; exit code 0 when there are none\n"
    "  --labels compare outcomes alone (and which cases failed): the share that is equal, and how\n"
    "           many cells, along refined axes, an unequal one is at most away from a case of\n"
    "           another label than its own in the first file (1: beside it). For a refined map "
    "and\n"
    "           a full one, or maps of two methods; exit code 2 when the axes differ\n"
    "  --csv    a row for each variable or attribute that differs: name, reason, differing, of,\n"
    "           largest, largest_case (without a tolerance the first case that differs), and both\n"
    "           values there as first and second\n"
    "  --json   the same as JSON, with the keys\n"
    "    files         both paths\n"
    "    identical     true or false (false with a tolerance, as not all is compared)\n"
    "    equal         true when nothing differs, or nothing by more than the tolerance\n"
    "    differences   [{name, reason, of_cases, differing, of, first, largest, largest_at}];\n"
    "                  `differing` is 0 within a tolerance; `largest` is null without one, or\n"
    "                  where one of the two is no number; `reason` is values,\n"
    "                  shapes, types or `only in the first file`, `only in the second file`;\n"
    "                  `first` is [{index, component, at: {path: value}, values: [text, text]}]\n"
    "           and of --labels with the keys files and\n"
    "    compared, equal, equal_share   cases pending in neither file, those equal, their share\n"
    "    farthest      cells, as above; null where there is nothing to measure\n"
    "    first         [{index, at: {path: value}, values: [label, label]}]\n",
};
