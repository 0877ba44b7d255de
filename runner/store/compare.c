/* compare.c - walks through two results files and compares variables and attributes. */
#include "compare.h"

#include "file_checksums.h"
#include "results_private.h"
#include "store_private.h"

#include "runner/base/message.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK = 1 << 18 }; /* elements read at a time */

/* What is compared with what, and where differences go. */
struct comparing {
    struct comparison *out;
    const struct results *r[2];
    stance_message *message;
    uint64_t *list; /* cases of trajectories */
    size_t list_count;
};

/* ---- differences -------------------------------------------------------------------------- */

/* A new entry, or NULL without memory; valid until the next. */
static struct compare_difference *add_difference(const struct comparing *c, const char *name,
                                                 const char *reason)
{
    struct comparison *const out = c->out;
    struct compare_difference *difference =
        realloc(out->difference, (out->count + 1) * sizeof *difference);
    if (!difference) {
        no_memory(c->message);
        return NULL;
    }
    out->difference = difference;
    difference += out->count++;
    *difference = (struct compare_difference){.differing = 0};
    snprintf(difference->name, sizeof difference->name, "%s", name);
    results_clean(difference->name);
    snprintf(difference->reason, sizeof difference->reason, "%s", reason);
    out->beyond += strcmp(reason, "values") != 0;
    return difference;
}

static bool unreadable(const struct comparing *c, int file, const char *name)
{
    return complain(c->message, "%.100s: damaged: cannot read %.80s", c->r[file]->file, name);
}

void compare_free(struct comparison *comparison)
{
    free(comparison->difference);
    *comparison = (struct comparison){0};
}

/* ---- elements in memory, in the widest type of their kind ---------------------------------- */

/* What is neither a number that fits nor a text. */
enum { KIND_OTHER = KIND_text + 1 };

union value {
    double real;
    int64_t integer;
    uint64_t natural;
    char *text;
};

/* Elements of a variable or an attribute in memory. */
struct values {
    int kind; /* KIND_double, KIND_int64_t, KIND_uint64_t, KIND_text or KIND_OTHER */
    size_t count;
    union value *of;
};

static int value_kind_of(hid_t type)
{
    const size_t size = H5Tget_size(type);
    const H5T_class_t class = H5Tget_class(type);
    return class == H5T_STRING                 ? KIND_text
           : size > sizeof(union value)        ? KIND_OTHER
           : class == H5T_FLOAT                ? KIND_double
           : class != H5T_INTEGER              ? KIND_OTHER
           : H5Tget_sign(type) == H5T_SGN_NONE ? KIND_uint64_t
                                               : KIND_int64_t;
}

static void values_free(struct values *values)
{
    if (values->kind == KIND_text)
        hdf_free_words((char **)(void *)values->of, values->count);
    else
        free(values->of);
    values->of = NULL;
}

/* Reads elements [at, at + count) of a dataset, or the `count` ones of an attribute. Those of
 * KIND_OTHER are left. False: nothing is left allocated. */
static bool values_read(hid_t object, hsize_t at, hid_t type, size_t count, struct values *values)
{
    *values = (struct values){.kind = value_kind_of(type), .count = count};
    if (values->kind == KIND_OTHER)
        return true;
    if (values->kind == KIND_text) {
        values->of = (union value *)(void *)hdf_words(object, at, count);
        return values->of != NULL;
    }
    const hid_t native = hdf_type((enum store_kind)values->kind);
    values->of = malloc(count * sizeof *values->of + 1);
    const bool good = values->of && hdf_move(object, native, at, count, HDF_READ, values->of);
    if (!good)
        values_free(values);
    return good;
}

/* NAN: it is none that has a distance from others. */
static double number_of(const struct values *values, size_t i)
{
    return values->kind == KIND_double    ? values->of[i].real
           : values->kind == KIND_int64_t ? (double)values->of[i].integer
                                          : NAN;
}

/* To the bit, so that 0 and -0 differ; of NANs alone the bits do not matter. Both are of the same
 * kind. */
static bool values_same(const struct values *a, const struct values *b, size_t i)
{
    return a->kind == KIND_OTHER ||
           (a->kind == KIND_text ? strcmp(a->of[i].text, b->of[i].text) == 0
                                 : a->of[i].natural == b->of[i].natural) ||
           (a->kind == KIND_double && isnan(a->of[i].real) && isnan(b->of[i].real));
}

/* The beginning of a text in quotation marks, in whole letters; damaged bytes are no letters. */
static void values_quote(const char *before, const char *letters, char text[COMPARE_TEXT])
{
    enum { SHOWN = 60 };
    int shown = 0;
    while (letters[shown]) {
        int length = results_letter(letters + shown);
        length = length > 0 ? length : 1;
        if (shown + length > SHOWN)
            break;
        shown += length;
    }
    snprintf(text, COMPARE_TEXT, "%s'%.*s'", before, shown, letters);
    results_clean(text);
}

/* Two elements for people; of texts from a little before the first letter that differs. */
static void show_values(const struct values values[2], size_t i, struct compare_place *place)
{
    size_t from = 0;
    if (values[0].kind == KIND_text) {
        const char *const a = values[0].of[i].text, *const b = values[1].of[i].text;
        while (a[from] && a[from] == b[from])
            from++;
        from = from > 20 ? from - 20 : 0;
        while (from > 0 && ((unsigned char)a[from] & 0xc0) == 0x80) /* within a letter */
            from--;
    }
    for (int f = 0; f < 2; f++) {
        char *const text = place->value[f];
        const union value value = values[f].of[i];
        if (values[f].kind == KIND_double)
            snprintf(text, COMPARE_TEXT, "%.17g", value.real);
        else if (values[f].kind == KIND_int64_t)
            snprintf(text, COMPARE_TEXT, "%lld", (long long)value.integer);
        else if (values[f].kind == KIND_uint64_t)
            snprintf(text, COMPARE_TEXT, "%llu", (unsigned long long)value.natural);
        else
            values_quote(from ? "..." : "", value.text + from, text);
    }
}

/* ---- variables ---------------------------------------------------------------------------- */

/* A variable, or an attribute, that both files have. */
struct compared {
    const struct comparing *in;
    const char *name;
    const hid_t *object; /* [2] */
    hid_t type[2];
    size_t elements;
    size_t width;                              /* elements per case; 0: it is not over the cases */
    const struct compare_tolerance *tolerance; /* NULL: bit for bit */
    const uint64_t *list;                      /* cases of a trajectory; NULL: rows are the cases */
    struct compare_difference *difference;     /* NULL: none yet */
    size_t last;                               /* the row noted last */
};

static bool is_pending(const struct results *r, uint64_t index)
{
    uint64_t row = r->single ? 0 : index;
    return row < r->cases && r->kind[row] == RESULTS_PENDING;
}

/* Whether element i counts: rows of cases that either file lacks do not, `status` tells of them. */
static bool counts(const struct compared *v, size_t i)
{
    if (v->width == 0 || strcmp(v->name, "status") == 0)
        return true;
    uint64_t index = v->list ? v->list[i / v->width] : i / v->width;
    return !is_pending(v->in->r[0], index) && !is_pending(v->in->r[1], index);
}

static struct compare_place place_of(const struct compared *v, size_t i, size_t within,
                                     const struct values values[2])
{
    const struct results *const first = v->in->r[0];
    struct compare_place place = {.component = v->width ? i % v->width : 0};
    const uint64_t row = v->width ? i / v->width : i;
    place.index = v->list ? v->list[row] : v->width && first->single ? first->index : row;
    show_values(values, within, &place);
    return place;
}

/* Compares elements [first, first + n) that have been read. */
static bool compare_block(struct compared *v, size_t first, const struct values values[2])
{
    for (size_t k = 0; k < values[0].count; k++) {
        const size_t i = first + k, row = v->width ? i / v->width : i;
        const bool noted = v->difference && v->difference->differing > 0 && v->last == row;
        if (values_same(&values[0], &values[1], k) || !counts(v, i) || (noted && !v->tolerance))
            continue;
        if (!v->difference) { /* the first difference */
            if (!(v->difference = add_difference(v->in, v->name, "values")))
                return false;
            v->difference->cases = v->width > 0;
            v->difference->several = v->width > 1;
            v->difference->of = v->width ? v->elements / v->width : v->elements;
        }
        if (v->tolerance) {
            const double a = number_of(&values[0], k), b = number_of(&values[1], k);
            const double distance = isnan(a - b) ? INFINITY : fabs(a - b);
            if (distance > v->difference->largest) {
                v->difference->largest = distance;
                v->difference->largest_place = place_of(v, i, k, values);
            }
            if (noted || (isfinite(distance) &&
                          distance <= v->tolerance->absolute +
                                          v->tolerance->relative * fmax(fabs(a), fabs(b))))
                continue;
        }
        v->last = row;
        v->in->out->beyond += v->difference->differing++ == 0;
        if (v->difference->shown < COMPARE_SHOWN)
            v->difference->place[v->difference->shown++] = place_of(v, i, k, values);
    }
    return true;
}

static bool compare_values(struct compared *v)
{
    bool good = true;
    for (size_t at = 0; at < v->elements && good; at += BLOCK) {
        const size_t n = v->elements - at < BLOCK ? v->elements - at : BLOCK;
        struct values values[2] = {{.kind = KIND_OTHER}, {.kind = KIND_OTHER}};
        for (int f = 0; f < 2 && good; f++)
            good = values_read(v->object[f], at, v->type[f], n, &values[f]) ||
                   unreadable(v->in, f, v->name);
        good = good && compare_block(v, at, values);
        values_free(&values[0]);
        values_free(&values[1]);
    }
    return good;
}

/* What holds for a variable: its own tolerance, or that of all; NULL: none. */
static const struct compare_tolerance *tolerance_of(const struct compared *v)
{
    const struct compare_tolerances *all = v->in->out->tolerances;
    const int kind = value_kind_of(v->type[0]);
    const struct compare_tolerance *found = NULL;
    if (!all || !(kind == KIND_double || (kind == KIND_int64_t && store_is_column(v->name))))
        return NULL;
    for (size_t i = 0; i < all->count; i++) {
        const struct compare_tolerance *tolerance = &all->tolerance[i];
        if (tolerance->name && strcmp(tolerance->name, v->name) == 0)
            return tolerance;
        found = tolerance->name ? found : tolerance;
    }
    return found;
}

/* How it is, and how its elements belong to cases; *differs: how the two are that cannot be
 * compared. */
static bool open_variable(struct compared *v, const char **differs)
{
    const struct comparing *const c = v->in;
    hsize_t length[2][H5S_MAX_RANK];
    int rank[2];
    for (int f = 0; f < 2; f++) {
        v->type[f] = hdf_type_of(v->object[f]);
        rank[f] = hdf_shape(v->object[f], length[f]);
        if (v->type[f] < 0 || rank[f] < 0)
            return false;
    }
    v->elements = results_elements(c->r[0], rank[0], length[0]);
    const bool attribute = H5Iget_type(v->object[0]) == H5I_ATTR;
    const int kind = value_kind_of(v->type[0]), other = value_kind_of(v->type[1]);
    const bool texts = kind == KIND_text && other == KIND_text;
    if (attribute && kind == other && v->elements == results_elements(c->r[1], rank[1], length[1]))
        return v->elements < BLOCK; /* they are read at once */
    if (!attribute && (rank[0] != rank[1] ||
                       memcmp(length[0], length[1], (size_t)rank[0] * sizeof length[0][0]) != 0))
        *differs = "shapes";
    else if (!attribute && kind == KIND_OTHER)
        *differs = "types that stance does not write";
    else if (attribute || (!texts && H5Tequal(v->type[0], v->type[1]) <= 0))
        *differs = "types";
    const bool track = store_is_track(v->name) && rank[0] > 0 && length[0][0] == c->list_count;
    const uint64_t rows = store_is_column(v->name) ? c->r[0]->cases : track ? c->list_count : 0;
    v->width = rows && v->elements % rows == 0 ? (size_t)(v->elements / rows) : 0;
    v->list = v->width && track ? c->list : NULL;
    return true;
}

static bool compare_variable(const struct comparing *c, const hid_t object[2], const char *name)
{
    struct compared v = {.in = c, .name = name, .object = object, .type = {-1, -1}};
    const char *differs = NULL;
    bool good = open_variable(&v, &differs) || unreadable(c, 0, name);
    if (good && differs) {
        good = add_difference(c, name, differs) != NULL;
    } else if (good) {
        v.tolerance = tolerance_of(&v);
        good = v.elements > 0 ? compare_values(&v) : unreadable(c, 0, name);
    }
    hdf_close(v.type[0], v.type[1]);
    return good;
}

/* ---- walking through both files ----------------------------------------------------------- */

struct names {
    char **name;
    size_t count;
    bool failed;
};

static herr_t add_name(struct names *names, const char *name)
{
    char *const own = strdup(name);
    char **const larger = own ? realloc(names->name, (names->count + 1) * sizeof *larger) : NULL;
    if (larger) {
        names->name = larger;
        names->name[names->count++] = own;
    } else {
        free(own);
        names->failed = true;
    }
    return 0;
}

static herr_t add_link(hid_t group, const char *name, const H5L_info_t *info, void *names)
{
    (void)group, (void)info;
    return strcmp(name, "timing") != 0 && strncmp(name, "timing/", 7) != 0 ? add_name(names, name)
                                                                           : 0;
}

static herr_t add_attribute(hid_t object, const char *name, const H5A_info_t *info, void *names)
{
    (void)object, (void)info;
    return add_name(names, name);
}

static int by_name(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static bool is_listed(const char *name, const char *const *list)
{
    for (; *list; list++)
        if (strcmp(name, *list) == 0)
            return true;
    return false;
}

/* Each link below two groups (`owner` NULL), or each attribute of two objects, that either has. */
static bool for_each(const struct comparing *c, const hid_t object[2], const char *owner,
                     bool (*look)(const struct comparing *c, const hid_t object[2],
                                  const char *owner, const char *name))
{
    struct names names = {0};
    bool good = true;
    for (int f = 0; f < 2 && good; f++)
        good =
            (owner ? H5Aiterate2(object[f], H5_INDEX_NAME, H5_ITER_INC, NULL, add_attribute, &names)
                   : H5Lvisit(object[f], H5_INDEX_NAME, H5_ITER_INC, add_link, &names)) >= 0 ||
            unreadable(c, f, owner ? "attributes" : "its variables");
    good = good && (!names.failed || no_memory(c->message));
    if (names.count > 0)
        qsort(names.name, names.count, sizeof *names.name, by_name);
    for (size_t i = 0; good && i < names.count; i++)
        if (i == 0 || strcmp(names.name[i], names.name[i - 1]) != 0)
            good = look(c, object, owner, names.name[i]);
    hdf_free_words(names.name, names.count);
    return good;
}

/* What both have of that name; *both: they do, and it is to be compared. */
static bool in_both(const struct comparing *c, const char *name, bool first, bool second,
                    bool *both)
{
    *both = first && second;
    return *both ||
           add_difference(c, name, first ? "only in the first file" : "only in the second file");
}

/* `owner` "" is the file itself. */
static bool compare_attribute(const struct comparing *c, const hid_t object[2], const char *owner,
                              const char *name)
{
    /* What ties dimensions together holds addresses within the file; checksums say what the values
     * say. */
    static const char *const structure[] = {"DIMENSION_LIST", "REFERENCE_LIST", CHECKSUM_ATTRIBUTE,
                                            NULL};
    static const char *const provenance[] = {
        "program_version", "git_revision", "compiler", "library_versions",
        "instruction_set", "ranks",        "hosts",    "date",
        "merged_from",     "merge_note",   "shard",    NULL};
    char title[192];
    bool both;
    if (is_listed(name, structure) || (!owner[0] && is_listed(name, provenance)))
        return true;
    snprintf(title, sizeof title, "attribute %.80s%s%.80s", owner, owner[0] ? ":" : "", name);
    if (!in_both(c, title, H5Aexists(object[0], name) > 0, H5Aexists(object[1], name) > 0, &both))
        return false;
    const hid_t attribute[2] = {both ? H5Aopen(object[0], name, H5P_DEFAULT) : -1,
                                both ? H5Aopen(object[1], name, H5P_DEFAULT) : -1};
    const bool good = !both || compare_variable(c, attribute, title);
    hdf_close(attribute[0], attribute[1]);
    return good;
}

/* The group that an object is in is missing in one of the files, which is said once. */
static bool lacks_group(const hid_t file[2], const char *name)
{
    const char *slash = strrchr(name, '/');
    char group[192];
    snprintf(group, sizeof group, "%.*s", slash ? (int)(slash - name) : 0, name);
    return slash && !(hdf_exists(file[0], group) && hdf_exists(file[1], group));
}

static bool compare_link(const struct comparing *c, const hid_t file[2], const char *unused,
                         const char *name)
{
    static const char *const checksums[] = {"checksum", "trajectory/checksum", NULL};
    hid_t object[2] = {-1, -1};
    bool both, good = true;
    (void)unused;
    if (lacks_group(file, name) || (c->out->tolerances && is_listed(name, checksums)))
        return true;
    if (!in_both(c, name, H5Lexists(file[0], name, H5P_DEFAULT) > 0,
                 H5Lexists(file[1], name, H5P_DEFAULT) > 0, &both))
        return false;
    for (int f = 0; f < 2 && good && both; f++) {
        object[f] = H5Oopen(file[f], name, H5P_DEFAULT);
        good = object[f] >= 0 || unreadable(c, f, name);
    }
    if (good && both) {
        const H5I_type_t type = H5Iget_type(object[0]);
        good = type != H5Iget_type(object[1])
                   ? add_difference(c, name, "types") != NULL
                   : (c->out->tolerances || for_each(c, object, name, compare_attribute)) &&
                         (type != H5I_DATASET || compare_variable(c, object, name));
    }
    hdf_close(object[0], object[1]);
    return good;
}

bool compare_has(const struct results *r, const char *name)
{
    return name[0] && hdf_exists((hid_t)r->id, name);
}

bool compare_results(struct comparison *comparison, const struct results *first,
                     const struct results *second, const struct compare_tolerances *tolerances,
                     stance_message *message)
{
    struct comparing c = {.out = comparison, .r = {first, second}, .message = message};
    const hid_t file[] = {(hid_t)first->id, (hid_t)second->id};

    *comparison = (struct comparison){.tolerances = tolerances};
    const bool good = results_recorded(first, &c.list, &c.list_count, message) &&
                      (tolerances || for_each(&c, file, "", compare_attribute)) &&
                      for_each(&c, file, NULL, compare_link);
    free(c.list);
    if (!good)
        compare_free(comparison);
    return good;
}
