/* command_compare.c - `stance compare FILE FILE`: what differs, as text or JSON. */
#include "compare_labels.h"
#include "runner/store/compare.h"

#include "analysis/table/table.h"
#include "runner/base/command.h"
#include "runner/base/message.h"
#include "runner/base/sandbox.h"
#include "runner/store/results.h"

#include <inttypes.h>
#include <math.h>
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
    snprintf(text, size, "%s %" PRIu64 "%s%s%s", difference->cases ? "case" : "element",
             place->index, where[0] ? " (" : "", where, where[0] ? ")" : "");
    if (difference->several)
        add_text(text, size, ", component %zu", place->component);
}

json_t *compare_point(const struct results *r, uint64_t index)
{
    size_t point[SCENARIO_MAX_AXES];
    results_point(r, index, point);
    return r->single ? json_object() : table_at(r, NULL, point);
}

static json_t *place_facts(const struct results *r, const struct compare_difference *difference,
                           const struct compare_place *place)
{
    const bool known = difference->cases && place->index < r->cases;
    char where[800];
    place_text(r, difference, place, where, sizeof where);
    return TABLE_OBJECT({"index", as_whole(place->index)},
                        {"component", as_whole(place->component)},
                        {"at", as_tree(known ? compare_point(r, place->index) : json_object())},
                        {"values", as_tree(table_texts(place->value[0], place->value[1]))},
                        {".where", as_text(where)});
}

static void add_difference(struct table *t, const struct results *r,
                           const struct compare_difference *difference)
{
    const bool measured = difference->largest > 0;
    const struct compare_place *place =
        measured ? &difference->largest_place : &difference->place[0];
    char where[800] = "", largest[32];
    json_t *first = json_array();
    for (int k = 0; k < difference->shown; k++)
        json_array_append_new(first, place_facts(r, difference, &difference->place[k]));
    if (measured || difference->shown > 0)
        place_text(r, difference, place, where, sizeof where);
    snprintf(largest, sizeof largest, "%.3g", difference->largest);
    TABLE_FACTS(
        t, {{.name = "name"}, as_text(difference->name)},
        {{.name = "reason"}, as_text(difference->reason)},
        {{.name = "of_cases", .hidden = TABLE_NO_CSV}, as_truth(difference->cases)},
        {{.name = "differing"}, as_whole(difference->differing)},
        {{.name = "of"}, as_whole(difference->of)},
        {{.name = "first", .hidden = TABLE_NO_CSV}, as_tree(first)},
        {{.name = "largest"}, as_number(measured ? difference->largest : NAN)},
        {{.name = "largest_at", .hidden = TABLE_NO_CSV},
         as_tree(measured ? place_facts(r, difference, place) : NULL)},
        {{.name = ".largest"}, as_text(largest)},
        {{.name = ".alone"},
         as_truth(difference->differing > 0 && difference->of == 1 && !difference->several)},
        {{.name = ".missing"}, as_truth(strncmp(difference->reason, "only", 4) == 0)},
        {{.name = "largest_case", .hidden = TABLE_NO_JSON}, as_text(where)},
        {{.name = "first", .hidden = TABLE_NO_JSON}, as_text(place->value[0])},
        {{.name = "second", .hidden = TABLE_NO_JSON}, as_text(place->value[1])});
    table_end_row(t);
}

static const char differences_text[] =
    "[differences:"
    "[equal:equal within the tolerance: {.count} variable{.count#s} in which numbers differ\n]"
    "{files/0} \\| {files/1}\n"
    "[differences*:{name}: [reason=values:"
    "[!differing:equal within the tolerance\n|[.alone:{first/0/values/0} \\| {first/0/values/1}\n"
    "|{differing} of {of} [of_cases:case|element]{of#s} differ\n"
    "[first*:  {.where}: " COMPARE_VALUES "]]]"
    "[!.alone:[largest_at:  largest difference {.largest} in {.where}: " COMPARE_VALUES "]]"
    "|[.missing:|different ]{reason}\n]]"
    "|[.tolerances:equal within the tolerance: no number differs|identical]\n]";

static bool print_differences(const struct results r[2], const struct comparison *comparison,
                              enum table_form form)
{
    struct table t = {0};
    if (comparison->count == 0)
        TABLE_COLUMNS(&t, {.name = "name"}, {.name = "reason"}, {.name = "differing"},
                      {.name = "of"}, {.name = "largest"}, {.name = "largest_case"},
                      {.name = "first"}, {.name = "second"});
    for (size_t i = 0; i < comparison->count; i++)
        add_difference(&t, &r[0], &comparison->difference[i]);
    json_t *const facts = TABLE_OBJECT(
        {"files", as_tree(table_texts(r[0].file, r[1].file))},
        {"identical", as_truth(comparison->count == 0 && !comparison->tolerances)},
        {"equal", as_truth(comparison->beyond == 0)}, {".count", as_whole(comparison->count)},
        {".tolerances", as_truth(comparison->tolerances)});
    return table_say(form, table_show(facts, "differences", &t, NULL, 0), differences_text, &t);
}

/* ---- the command -------------------------------------------------------------------------- */

struct request {
    struct option_texts files;
    bool labels;
    enum table_form form;
    enum results_kind of; /* of the labels' domain; RESULTS_KIND_COUNT: what is judged by */
    struct given {
        struct compare_tolerances all;
        char names[COMPARE_TOLERANCES][96];
    } tolerances;
};

/* "RELATIVE[,ABSOLUTE]" or "NAME=RELATIVE[,ABSOLUTE]" */
static bool read_tolerance(const char *text, void *given)
{
    struct given *const g = given;
    const char *const equals = strchr(text, '='), *numbers = equals ? equals + 1 : text;
    char *const name = g->names[g->all.count], *end;
    struct compare_tolerance *const tolerance = &g->all.tolerance[g->all.count++];
    *tolerance = (struct compare_tolerance){equals ? name : NULL, 0, 0};
    snprintf(name, sizeof g->names[0], "%.*s", equals ? (int)(equals - text) : 0, text);
    tolerance->relative = strtod(numbers, &end);
    bool good = end != numbers;
    if (good && *end == ',') {
        const char *second = end + 1;
        tolerance->absolute = strtod(second, &end);
        good = end != second;
    }
    return good && *end == '\0' && tolerance->relative >= 0 && tolerance->absolute >= 0 &&
           isfinite(tolerance->relative) && isfinite(tolerance->absolute);
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

static int compare_all(const struct results r[2], const struct request *request,
                       stance_message *message)
{
    const struct compare_tolerances *const tolerances = &request->tolerances.all;
    struct comparison comparison;

    for (size_t i = 0; i < tolerances->count; i++) {
        const char *name = tolerances->tolerance[i].name;
        if (name && !compare_has(&r[0], name) && !compare_has(&r[1], name)) {
            complain(message, "stance compare: --tolerance: neither file has a variable '%.60s'",
                     name);
            return EXIT_USAGE;
        }
        if (name && is_flag(&r[0], name)) {
            complain(message, "stance compare: --tolerance: '%.60s' is no number", name);
            return EXIT_USAGE;
        }
    }
    if (!compare_results(&comparison, &r[0], &r[1], tolerances->count > 0 ? tolerances : NULL,
                         message))
        return EXIT_IO;
    const int code = comparison.beyond == 0 ? EXIT_DONE : EXIT_CASES_FAILED;
    const bool good = print_differences(r, &comparison, request->form);
    compare_free(&comparison);
    return good ? code : EXIT_IO;
}

static int compare(void *context)
{
    const struct request *request = context;
    struct results r[2];
    stance_message message = {""};
    int code = EXIT_IO, opened = 0;

    while (opened < 2 && results_open(&r[opened], request->files.text[opened], &message))
        opened++;
    /* Cases that do not verify would be left out as pending ones are. */
    for (int f = 0; opened == 2 && f < 2 && !message.text[0]; f++)
        if (r[f].damage.cases > 0)
            complain(&message, "stance compare: %.180s is damaged and not compared", r[f].file);
    if (!message.text[0])
        code = request->labels ? compare_labels(r, request->of, request->form, &message)
                               : compare_all(r, request, &message);
    if (code == EXIT_IO && !message.text[0])
        complain(&message, "stance compare: the comparison could not be written");
    if (message.text[0])
        fprintf(stderr, "%s\n", message.text);
    while (opened > 0)
        results_close(&r[--opened]);
    return code;
}

static int run(int argc, char **argv)
{
    struct request request = {.of = RESULTS_KIND_COUNT};
    const int code = command_begin(&command_compare, argc, argv, &request);
    if (code != COMMAND_GOES_ON)
        return code;
    char names[2100];
    snprintf(names, sizeof names, "%s or %s", request.files.text[0], request.files.text[1]);
    return sandbox(compare, &request, names);
}

#define TO(member) OPTION_TO(struct request, member)
static const struct option options[] = {
    {"FILE FILE", TO(files), .low = 2, .high = 2, .text = "two results files"},
    {"--tolerance", "[ANSWER=]RELATIVE[,ABSOLUTE]", TO(tolerances), .read = read_tolerance,
     .most = COMPARE_TOLERANCES, .takes = "RELATIVE[,ABSOLUTE] or ANSWER=RELATIVE[,ABSOLUTE]",
     .text = "numbers a, b are equal when |a - b| <= ABSOLUTE + RELATIVE max(|a|, |b|); with "
             "ANSWER= (a variable's name) of that answer alone, before the general one. Only "
             "variables are compared then, not attributes: files of two scenarios over the same "
             "axes may be equal. Outcomes and other flags have no tolerance. Prints how many "
             "cases differ by more, and the largest difference; exit code 0 when there are none"},
    {"--labels", TO(labels), .without = "--tolerance",
     .text = "compare outcomes alone (and which cases failed): the share that is equal, and how "
             "many cells, along refined axes, an unequal one is at most away from a case of "
             "another label than its own in the first file (1: beside it). For a refined map and "
             "a full one, or maps of two methods; exit code 2 when the axes or the starts differ. "
             "Then a table of what the labels of the first file have become in the second, and of "
             "the first one's domain the share that is lost in the second (of a sample with a 95 "
             "% interval, as in the summary), of the second one's the share that is won"},
    {"--of", "OUTCOME", TO(of), .word = results_outcome_word, .needs = "--labels",
     .text =
         "the domain: stabilised (default; or walks, where any does, or rested, where nothing else "
         "was), walks, rested, fell or undecided"},
    {TABLE_CSV(struct request, form),
     .text = "a row for each variable or attribute that differs: name, reason, differing, of, "
             "largest, largest_case (without a tolerance the first case that differs), and both "
             "values there as first and second; of --labels a row for each pair of labels: first, "
             "second, cases, share, share_of_first"},
    {TABLE_JSON(struct request, form), .text = "the same as JSON, with the keys"},
    {0},
};

const struct command command_compare = {
    "compare",
    "what differs between two results files, bit for bit, beyond a tolerance, or in their labels",
    run,
    options,
    "Prints `identical` (exit code 0), or every variable and attribute that differs with the "
    "first few cases and both values (exit code 1). Left out are group `timing`, the attributes "
    "that say where a file comes from (program_version, git_revision, compiler, library_versions, "
    "instruction_set, ranks, hosts, date, merged_from, merge_note) and the rows of cases that are "
    "pending in either file: `status` differs there when one has them. A NAN equals a NAN; 0 and "
    "-0 differ.\n",
    "    files         both paths\n"
    "    identical     true or false (false with a tolerance, as not all is compared)\n"
    "    equal         true when nothing differs, or nothing by more than the tolerance\n"
    "    differences   [{name, reason, of_cases, differing, of, first, largest, largest_at}]; "
    "`differing` is 0 within a tolerance; `largest` is null without one, or where one of the two "
    "is no number; `reason` is values, shapes, types or `only in the first file`, `only in the "
    "second file`; `first` is [{index, component, at: {path: value}, values: [text, text]}]\n"
    "           and of --labels with the keys files and\n"
    "    compared, equal, equal_share   cases pending in neither file, those equal, their share\n"
    "    farthest      cells, as above; null where there is nothing to measure\n"
    "    became        [{first, second, cases, share, share_of_first}]\n"
    "    domain        {outcome, kept, lost, won, neither, lost_share, lost_low, lost_high (null "
    "of a grid), won_share}\n"
    "    first         [{index, at: {path: value}, values: [label, label]}]\n",
};
