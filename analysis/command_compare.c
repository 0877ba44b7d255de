/* command_compare.c - `stance compare FILE FILE`: are two results files the same, bit for bit?
 *
 * Everything counts but the group `timing` and the attributes that say where and when a file was
 * made. Every dataset of either file is read in slices and compared as bytes; two NANs are equal.
 */
#include "results.h"

#include "../runner/command.h"

#include <hdf5.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SLICE = 1 << 16, SHOWN = 5, MAX_NAMES = 512, MAX_RANK = 32 };

static const char *const provenance[] = {
    "program_version", "git_revision", "compiler", "library_versions", "ranks", "hosts", "date"};

/* Names of datasets and of root attributes, in alphabetical order. */
struct names {
    size_t count;
    char *name[MAX_NAMES];
    bool overflow;
};

struct comparison {
    struct results *a, *b;
    json_t *rows; /* one object per difference */
    bool failed;  /* something could not be read */
};

/* ---- collecting names --------------------------------------------------------------------- */

static void names_add(struct names *names, const char *name)
{
    for (size_t i = 0; i < names->count; i++)
        if (strcmp(names->name[i], name) == 0)
            return;
    char *copy = names->count < MAX_NAMES ? strdup(name) : NULL;
    if (copy)
        names->name[names->count++] = copy;
    else
        names->overflow = true;
}

static herr_t visit_object(hid_t object, const char *name, const H5O_info_t *information,
                           void *data)
{
    (void)object;
    if (information->type == H5O_TYPE_DATASET && strncmp(name, "timing/", 7) != 0)
        names_add(data, name);
    return 0;
}

static herr_t visit_attribute(hid_t object, const char *name, const H5A_info_t *information,
                              void *data)
{
    (void)object, (void)information;
    for (size_t i = 0; i < sizeof provenance / sizeof provenance[0]; i++)
        if (strcmp(name, provenance[i]) == 0)
            return 0;
    if (name[0] != '_') /* netCDF's bookkeeping */
        names_add(data, name);
    return 0;
}

static int by_name(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* ---- differences -------------------------------------------------------------------------- */

static void differs(struct comparison *c, const char *kind, const char *name, const char *what)
{
    json_array_append_new(c->rows, json_pack("{s:s, s:s}", kind, name, "difference", what));
}

/* Value of an element as text. */
static void value_text(hid_t type, const void *element, char *text, size_t size)
{
    double number = 0;
    if (H5Tget_class(type) == H5T_FLOAT && H5Tget_size(type) == sizeof number) {
        memcpy(&number, element, sizeof number);
        snprintf(text, size, "%.17g", number);
        return;
    }
    if (H5Tget_class(type) == H5T_INTEGER && H5Tget_size(type) <= 8) {
        unsigned char bytes[8] = {0};
        memcpy(bytes, element, H5Tget_size(type));
        hid_t memory = H5Tcopy(type);
        if (H5Tconvert(memory, H5T_NATIVE_DOUBLE, 1, bytes, NULL, H5P_DEFAULT) >= 0)
            memcpy(&number, bytes, sizeof number);
        H5Tclose(memory);
        snprintf(text, size, "%.17g", number);
        return;
    }
    if (H5Tget_class(type) == H5T_STRING) {
        const char *string = NULL;
        if (H5Tis_variable_str(type) > 0)
            memcpy(&string, element, sizeof string);
        snprintf(text, size, "%s", string ? string : "");
        return;
    }
    snprintf(text, size, "?");
}

static bool same_element(hid_t type, const void *a, const void *b, size_t size)
{
    if (H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) > 0) {
        const char *x, *y;
        memcpy(&x, a, sizeof x);
        memcpy(&y, b, sizeof y);
        return x == y || (x && y && strcmp(x, y) == 0);
    }
    if (memcmp(a, b, size) == 0)
        return true;
    if (H5Tget_class(type) == H5T_FLOAT && size == sizeof(double)) {
        double x, y;
        memcpy(&x, a, size);
        memcpy(&y, b, size);
        return isnan(x) && isnan(y);
    }
    return false;
}

/* ---- datasets ----------------------------------------------------------------------------- */

/* One dataset in both files. */
struct pair {
    hid_t set[2], space[2], type;
    int rank;
    hsize_t extent[MAX_RANK], elements, per_row; /* per_row: elements per index of dimension 0 */
};

static void pair_close(struct pair *p)
{
    for (int i = 0; i < 2; i++) {
        if (p->space[i] >= 0)
            H5Sclose(p->space[i]);
        if (p->set[i] >= 0)
            H5Dclose(p->set[i]);
    }
    if (p->type >= 0)
        H5Tclose(p->type);
}

/* Opens both; false when they cannot be compared, `what` says why (or is empty: unreadable). */
static bool pair_open(const struct comparison *c, const char *name, struct pair *p,
                      const char **what)
{
    hsize_t other[MAX_RANK];
    hid_t type = -1;
    *what = NULL;
    *p = (struct pair){.set = {-1, -1}, .space = {-1, -1}, .type = -1};
    for (int i = 0; i < 2; i++) {
        const hid_t file = i ? c->b->id : c->a->id;
        p->set[i] = H5Dopen2(file, name, H5P_DEFAULT);
        if (p->set[i] < 0) {
            *what = i ? "only in the first file" : "only in the second file";
            return false;
        }
        p->space[i] = H5Dget_space(p->set[i]);
    }
    p->rank = H5Sget_simple_extent_ndims(p->space[0]);
    if (p->rank < 0 || p->rank > MAX_RANK)
        return false;
    if (H5Sget_simple_extent_ndims(p->space[1]) != p->rank) {
        *what = "different numbers of dimensions";
        return false;
    }
    H5Sget_simple_extent_dims(p->space[0], p->extent, NULL);
    H5Sget_simple_extent_dims(p->space[1], other, NULL);
    p->elements = 1;
    for (int d = 0; d < p->rank; d++) {
        if (p->extent[d] != other[d]) {
            *what = "different lengths";
            return false;
        }
        p->elements *= p->extent[d];
    }
    p->per_row = p->rank && p->extent[0] ? p->elements / p->extent[0] : 1;
    p->type = H5Dget_type(p->set[0]);
    type = H5Dget_type(p->set[1]);
    const bool same = p->type >= 0 && type >= 0 && H5Tequal(p->type, type) > 0;
    if (type >= 0)
        H5Tclose(type);
    if (!same)
        *what = "different types";
    return same;
}

/* Reads rows [first, first + count) of dimension 0 (all of a scalar). */
static bool pair_read(const struct pair *p, int which, hsize_t first, hsize_t count, void *buffer)
{
    if (p->rank == 0)
        return H5Dread(p->set[which], p->type, H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer) >= 0;
    hsize_t start[MAX_RANK] = {first}, extent[MAX_RANK];
    for (int d = 0; d < p->rank; d++)
        extent[d] = d ? p->extent[d] : count;
    const hid_t memory = H5Screate_simple(p->rank, extent, NULL);
    const bool good =
        memory >= 0 &&
        H5Sselect_hyperslab(p->space[which], H5S_SELECT_SET, start, NULL, extent, NULL) >= 0 &&
        H5Dread(p->set[which], p->type, memory, p->space[which], H5P_DEFAULT, buffer) >= 0;
    if (memory >= 0)
        H5Sclose(memory);
    return good;
}

/* Is the leading part of the dimensions that of the cases? Then `inner` elements make a case. */
static bool over_cases(const struct results *r, const struct pair *p, hsize_t *inner)
{
    if (r->single || p->rank < r->axes)
        return false;
    for (int d = 0; d < r->axes; d++)
        if (p->extent[d] != r->axis[d].count)
            return false;
    *inner = r->cases ? p->elements / r->cases : 1;
    return *inner > 0;
}

/* One example of a difference: where, and both values. */
static json_t *example(const struct comparison *c, const struct pair *p, bool cases, hsize_t inner,
                       hsize_t element, const void *a, const void *b)
{
    char first[80], second[80], where[256] = "";
    value_text(p->type, a, first, sizeof first);
    value_text(p->type, b, second, sizeof second);
    const hsize_t index = cases ? element / inner : element;
    if (cases)
        results_case_text(c->a, index, where, sizeof where);
    return json_pack("{s:I, s:s, s:s, s:s}", cases ? "case" : "element", (json_int_t)index, "at",
                     where, "first", first, "second", second);
}

static bool compare_values(struct comparison *c, const char *name, const struct pair *p)
{
    const size_t size = H5Tget_size(p->type);
    const hsize_t rows = p->rank ? p->extent[0] : 1;
    hsize_t step = SLICE / (p->per_row ? p->per_row : 1), inner = 1, differing = 0, last_case = 0;
    const bool cases = over_cases(c->a, p, &inner);
    step = step ? step : 1;
    char *buffer[2] = {malloc(step * p->per_row * size + 1), malloc(step * p->per_row * size + 1)};
    json_t *examples = json_array();
    bool good = buffer[0] && buffer[1] && size > 0;
    for (hsize_t row = 0; good && row < rows && p->elements; row += step) {
        const hsize_t count = row + step < rows ? step : rows - row;
        good = pair_read(p, 0, row, count, buffer[0]) && pair_read(p, 1, row, count, buffer[1]);
        for (hsize_t i = 0; good && i < count * p->per_row; i++) {
            const char *const a = buffer[0] + i * size, *const b = buffer[1] + i * size;
            const hsize_t element = row * p->per_row + i;
            if (same_element(p->type, a, b, size))
                continue;
            if (cases && differing && element / inner == last_case)
                continue; /* one more number of the same case */
            last_case = element / inner;
            if (differing++ < SHOWN)
                json_array_append_new(examples, example(c, p, cases, inner, element, a, b));
        }
    }
    free(buffer[0]);
    free(buffer[1]);
    if (differing)
        json_array_append_new(c->rows,
                              json_pack("{s:s, s:s, s:I, s:O}", "variable", name, "difference",
                                        cases ? "values of cases" : "values", "count",
                                        (json_int_t)differing, "examples", examples));
    json_decref(examples);
    return good;
}

static void compare_dataset(struct comparison *c, const char *name)
{
    struct pair p;
    const char *what;
    if (!pair_open(c, name, &p, &what)) {
        if (what)
            differs(c, "variable", name, what);
        else
            c->failed = true;
    } else if (!compare_values(c, name, &p)) {
        fprintf(stderr, "stance compare: cannot read %s\n", name);
        c->failed = true;
    }
    pair_close(&p);
}

/* ---- root attributes ---------------------------------------------------------------------- */

/* Bytes of a root attribute as they stand, or the text of a string; NULL when there is none. */
static char *attribute_bytes(hid_t file, const char *name, size_t *size)
{
    if (H5Aexists(file, name) <= 0)
        return NULL;
    const hid_t attribute = H5Aopen(file, name, H5P_DEFAULT);
    const hid_t type = H5Aget_type(attribute), space = H5Aget_space(attribute);
    char *bytes = NULL;
    if (H5Tis_variable_str(type) > 0) {
        char *text = NULL;
        if (H5Sget_simple_extent_npoints(space) == 1 && H5Aread(attribute, type, &text) >= 0 &&
            text) {
            bytes = strdup(text);
            H5free_memory(text);
        }
        *size = bytes ? strlen(bytes) : 0;
    } else {
        *size = H5Tget_size(type) * (size_t)H5Sget_simple_extent_npoints(space);
        bytes = calloc(1, *size + 1);
        if (bytes && H5Aread(attribute, type, bytes) < 0) {
            free(bytes);
            bytes = NULL;
        }
    }
    H5Sclose(space);
    H5Tclose(type);
    H5Aclose(attribute);
    return bytes;
}

static void compare_attribute(struct comparison *c, const char *name)
{
    size_t size[2] = {0, 0};
    char *const a = attribute_bytes(c->a->id, name, &size[0]);
    char *const b = attribute_bytes(c->b->id, name, &size[1]);
    if (!a || !b) {
        if (a || b)
            differs(c, "attribute", name, a ? "only in the first file" : "only in the second file");
    } else if (size[0] != size[1] || memcmp(a, b, size[0]) != 0) {
        differs(c, "attribute", name, "different values");
    }
    free(a);
    free(b);
}

/* ---- the command -------------------------------------------------------------------------- */

static void compare_files(struct comparison *c)
{
    struct names sets = {0}, attributes = {0};
    hsize_t position = 0;
    H5Ovisit2(c->a->id, H5_INDEX_NAME, H5_ITER_INC, visit_object, &sets, H5O_INFO_BASIC);
    H5Ovisit2(c->b->id, H5_INDEX_NAME, H5_ITER_INC, visit_object, &sets, H5O_INFO_BASIC);
    H5Aiterate2(c->a->id, H5_INDEX_NAME, H5_ITER_INC, &position, visit_attribute, &attributes);
    position = 0;
    H5Aiterate2(c->b->id, H5_INDEX_NAME, H5_ITER_INC, &position, visit_attribute, &attributes);
    qsort(sets.name, sets.count, sizeof sets.name[0], by_name);
    qsort(attributes.name, attributes.count, sizeof attributes.name[0], by_name);
    for (size_t i = 0; i < attributes.count; i++) {
        compare_attribute(c, attributes.name[i]);
        free(attributes.name[i]);
    }
    for (size_t i = 0; i < sets.count; i++) {
        compare_dataset(c, sets.name[i]);
        free(sets.name[i]);
    }
    if (sets.overflow || attributes.overflow) {
        fprintf(stderr, "stance compare: too many variables, or out of memory\n");
        c->failed = true;
    }
}

static void print_rows(const struct comparison *c)
{
    size_t i, k;
    json_t *row, *e;
    if (json_array_size(c->rows) == 0) {
        printf("identical: %s and %s\n", c->a->file, c->b->file);
        return;
    }
    printf("%s and %s differ\n", c->a->file, c->b->file);
    json_array_foreach(c->rows, i, row)
    {
        const char *const variable = json_string_value(json_object_get(row, "variable"));
        const char *const attribute = json_string_value(json_object_get(row, "attribute"));
        printf("  %s %s: ", variable ? "variable" : "attribute", variable ? variable : attribute);
        json_t *const count = json_object_get(row, "count");
        if (count)
            printf("%" JSON_INTEGER_FORMAT " ", json_integer_value(count));
        printf("%s\n", json_string_value(json_object_get(row, "difference")));
        json_array_foreach(json_object_get(row, "examples"), k, e)
        {
            const char *const at = json_string_value(json_object_get(e, "at"));
            json_t *const index = json_object_get(e, "case");
            printf("    %s %" JSON_INTEGER_FORMAT "%s%s%s: %s, %s\n", index ? "case" : "element",
                   json_integer_value(index ? index : json_object_get(e, "element")),
                   *at ? " (" : "", at, *at ? ")" : "",
                   json_string_value(json_object_get(e, "first")),
                   json_string_value(json_object_get(e, "second")));
        }
    }
}

static int run(int argc, char **argv)
{
    bool help;
    const char *operand[2];
    size_t operands, json_count = 0;
    const struct option_spec specs[] = {{"--json", false, NULL, 0, &json_count}};
    if (!command_options(&command_compare, argc, argv, specs, 1, operand, 2, &operands, &help))
        return EXIT_USAGE;
    if (help)
        return EXIT_DONE;
    if (operands != 2) {
        fprintf(stderr, "stance compare: two results files are needed; see stance compare -h\n");
        return EXIT_USAGE;
    }
    static struct results a, b; /* large; the program runs one command */
    stance_message message;
    if (!results_open(&a, operand[0], &message)) {
        fprintf(stderr, "%s\n", message.text);
        return EXIT_IO;
    }
    if (!results_open(&b, operand[1], &message)) {
        fprintf(stderr, "%s\n", message.text);
        results_close(&a);
        return EXIT_IO;
    }
    struct comparison c = {&a, &b, json_array(), false};
    compare_files(&c);
    const bool same = json_array_size(c.rows) == 0 && !c.failed;
    if (json_count) {
        json_t *root = json_pack("{s:s, s:s, s:b, s:O}", "first", a.file, "second", b.file,
                                 "identical", (int)same, "differences", c.rows);
        json_dumpf(root, stdout, JSON_INDENT(1));
        putchar('\n');
        json_decref(root);
    } else if (!c.failed || json_array_size(c.rows) > 0) {
        print_rows(&c);
    }
    json_decref(c.rows);
    results_close(&a);
    results_close(&b);
    if (c.failed)
        return EXIT_IO;
    return same ? EXIT_DONE : EXIT_CASES_FAILED;
}

const struct command command_compare = {
    "compare", "compare FILE FILE [--json]", "what differs between two results files, bit for bit",
    run,
    "Everything counts but the group `timing` and the attributes program_version, git_revision,\n"
    "compiler, library_versions, ranks, hosts and date. Exit 0: identical; 1: different, with the\n"
    "number of differing cases of each variable and the first few; 3: a file cannot be read.\n"
    "\n"
    "--json: an object with keys first, second, identical and differences, a list of objects with\n"
    "variable or attribute, difference and, for values, count and examples (case or element, at,\n"
    "first, second).\n"};
