/* command_compare.c - `stance compare FILE FILE`: what differs, as text or JSON. */
#include "compare.h"

#include "../runner/command.h"
#include "../runner/supervise.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Where a place is: "case 17 (initial.offset.theta = -0.1 rad, ...), component 2". */
static void place_text(const struct results *r, const struct compare_difference *difference,
                       const struct compare_place *place, char *text, size_t size)
{
    char where[600] = "";
    if (difference->cases && !r->single && place->index < r->cases) {
        results_case_text(r, place->index, where, sizeof where);
    }
    size_t used = (size_t)snprintf(
        text, size, "%s %llu%s%s%s", difference->cases ? "case" : "element",
        (unsigned long long)place->index, where[0] ? " (" : "", where, where[0] ? ")" : "");
    if (difference->several && used < size) {
        snprintf(text + used, size - used, ", component %zu", place->component);
    }
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
}

/* Of a name that may not be UTF-8, which JSON asks for. */
static json_t *json_name(const char *name)
{
    char *clean = strdup(name);
    if (clean) {
        results_clean(clean);
    }
    json_t *text = clean ? json_string(clean) : NULL;
    free(clean);
    return text ? text : json_null();
}

static json_t *json_places(const struct results *r, const struct compare_difference *difference)
{
    json_t *list = json_array();
    for (int k = 0; k < difference->shown; k++) {
        const struct compare_place *place = &difference->place[k];
        json_t *entry = json_object(), *at = json_object(), *values = json_array();
        size_t point[SCENARIO_MAX_AXES];
        char text[128];
        json_object_set_new(entry, "index", json_integer((json_int_t)place->index));
        json_object_set_new(entry, "component", json_integer((json_int_t)place->component));
        if (difference->cases && !r->single && place->index < r->cases) {
            results_point(r, place->index, point);
            for (int a = 0; a < r->axes; a++) {
                const struct results_axis *axis = &r->axis[a];
                results_value_text(axis, point[a], false, text, sizeof text);
                json_object_set_new(at, axis->name,
                                    axis->word ? json_string(text)
                                               : json_real(axis->value[point[a]]));
            }
        }
        json_object_set_new(entry, "at", at);
        for (int f = 0; f < 2; f++) {
            json_array_append_new(values, json_string(place->value[f]));
        }
        json_object_set_new(entry, "values", values);
        json_array_append_new(list, entry);
    }
    return list;
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
        json_array_append_new(differences, entry);
    }
    json_t *files = json_array();
    json_array_append_new(files, json_name(r[0].file));
    json_array_append_new(files, json_name(r[1].file));
    json_t *root = json_object();
    json_object_set_new(root, "files", files);
    json_object_set_new(root, "identical", json_boolean(comparison->count == 0));
    json_object_set_new(root, "differences", differences);
    bool good = root && json_dumpf(root, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) == 0;
    json_decref(root);
    putchar('\n');
    return good;
}

static void print_text(const struct results r[2], const struct comparison *comparison)
{
    if (comparison->count == 0) {
        puts("identical");
        return;
    }
    printf("%s | %s\n", r[0].file, r[1].file);
    for (size_t i = 0; i < comparison->count; i++) {
        print_difference(&r[0], &comparison->difference[i]);
    }
}

struct request {
    const char *file[2];
    bool json;
};

static int compare(void *context)
{
    const struct request *request = context;
    struct results r[2];
    struct comparison comparison;
    stance_message message = {""};
    int code = EXIT_IO;

    for (int f = 0; f < 2; f++) {
        if (!results_open(&r[f], request->file[f], &message)) {
            fprintf(stderr, "%s\n", message.text);
            if (f == 1) {
                results_close(&r[0]);
            }
            return EXIT_IO;
        }
    }
    if (!compare_results(&comparison, &r[0], &r[1], &message)) {
        fprintf(stderr, "%s\n", message.text);
    } else {
        code = comparison.count == 0 ? EXIT_DONE : EXIT_CASES_FAILED;
        if (!request->json) {
            print_text(r, &comparison);
        } else if (!print_json(r, &comparison)) {
            fputs("stance compare: the comparison could not be written\n", stderr);
            code = EXIT_IO;
        }
        compare_free(&comparison);
    }
    results_close(&r[0]);
    results_close(&r[1]);
    return code;
}

static int run(int argc, char **argv)
{
    const char *files[2];
    size_t json = 0, operands = 0;
    bool help = false;
    const struct option_spec specs[] = {{"--json", false, NULL, 0, &json}};

    if (!command_options(&command_compare, argc, argv, specs, 1, files, 2, &operands, &help)) {
        return EXIT_USAGE;
    }
    if (help) {
        return EXIT_DONE;
    }
    if (operands < 2) {
        fputs("stance compare: two results files are needed (stance compare -h explains)\n",
              stderr);
        return EXIT_USAGE;
    }
    struct request request = {{files[0], files[1]}, json > 0};
    char names[2100];
    snprintf(names, sizeof names, "%s or %s", files[0], files[1]);
    return supervise(compare, &request, names);
}

const struct command command_compare = {
    "compare",
    "compare FILE FILE [--json]",
    "what differs between two results files, bit for bit",
    run,
    "Prints `identical` (exit code 0), or every variable and attribute that differs with the "
    "first\n"
    "few cases and both values (exit code 1). Left out are group `timing`, the attributes that "
    "say\n"
    "where a file comes from (program_version, git_revision, compiler, library_versions,\n"
    "instruction_set, ranks, hosts, date) and the rows of cases that are pending in either file:\n"
    "`status` differs there when one has them. A NAN equals a NAN; 0 and -0 differ.\n"
    "\n"
    "  --json   the same as JSON, with the keys\n"
    "    files         both paths\n"
    "    identical     true or false\n"
    "    differences   [{name, reason, of_cases, differing, of, first}]; `reason` is values,\n"
    "                  shapes, types or `only in the first file`, `only in the second file`;\n"
    "                  `first` is [{index, component, at: {path: value}, values: [text, text]}]\n",
};
