/* store_layout.c - creates the results file: dimensions, variables, attributes, reserved space.
 *
 * netCDF-4 conventions: every dimension is an HDF5 dimension scale with its own `_Netcdf4Dimid`,
 * attached to the variables over it, so that dimensions of equal length are not confused.
 * Done by rank 0 alone with the serial driver, closed and reserved before any case is computed.
 */
#include "build_info.h"
#include "file_checksums.h"
#include "store_private.h"

#include "runner/base/checksum.h"
#include "runner/base/command.h"
#include "runner/base/problem.h"
#include "runner/base/words.h"
#include "runner/plan/kernels.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { FORMAT_VERSION = 1, METADATA_SIZE = 96 * 1024, DATASET_SIZE = 1024, DISK_BLOCK = 4096 };

struct layout {
    const struct plan *plan;
    const struct store_origin *before; /* of a file that goes on with another scenario, or NULL */
    struct maker make;
    struct dimension axis[SCENARIO_MAX_AXES], inner[OVERS];
    const struct dimension *over[SCENARIO_MAX_AXES + 1]; /* of the cases; NULL after the last */
    int ranks;
    const char *hosts;
};

static struct dataset dataset(const char *name, enum store_kind kind, const char *unit,
                              const char *text)
{
    return (struct dataset){.name = name, .kind = kind, .unit = unit, .text = text};
}

/* A dimension whose points are words; none where there are none. */
static void make_words(struct layout *l, const char *name, const char *const *words, int n,
                       struct dimension *dimension)
{
    const struct dataset d = {name, KIND_text, .values = words, .length = (hsize_t)n};
    if (n > 0)
        make(&l->make, &d, dimension);
}

/* ---- the axes ----------------------------------------------------------------------------- */

struct axis_values {
    const struct scenario_axis *axis;
    int path;
    bool single;
    size_t point; /* single: the only one */
};

static double axis_value(const void *context, uint64_t i)
{
    const struct axis_values *values = context;
    return scenario_axis_value(values->axis, values->single ? values->point : i, values->path);
}

/* The values of one path of an axis, as the axis's own dimension or as a variable `over` one. Of an
 * axis of words the other paths may hold numbers; a sample has words as codes. */
static void put_path(struct layout *l, const struct axis_values *values,
                     const struct dimension *over, struct dimension *dimension)
{
    const struct scenario_axis *axis = values->axis;
    const int k = values->path;
    const struct scenario_meaning *meaning = axis->sample ? &axis->meaning[k] : NULL;
    const bool first = k == 0 && !meaning, text = axis->words && axis->enumeration[k];
    const size_t n = over ? over->length : axis->count;
    const char **words = text ? malloc(n * sizeof *words) : NULL;
    struct dataset d = dataset(axis->path[k], axis->integer[k] ? KIND_int32_t : KIND_double, NULL,
                               first ? axis->text : NULL);
    if (first) {
        d.name = axis->name;
        d.unit = text ? NULL : axis->unit;
    }
    if (meaning) {
        d.unit = meaning->unit;
        d.text = meaning->text;
        d.flags = meaning->words;
    }
    d.kind = text ? KIND_text : d.flags ? KIND_uint8_t : d.kind;
    for (size_t i = 0; words && i < n; i++) {
        const size_t point = values->single ? values->point : i;
        words[i] = axis->word[point * (size_t)axis->paths + (size_t)k];
    }
    d.values = words;
    d.value = axis_value;
    d.context = values;
    d.length = n;
    d.over[0] = over;
    l->make.failed = l->make.failed || (text && !words);
    make(&l->make, &d, dimension);
    free(words);
}

/* Names of the paths that a sample varies, with such signs between those of a factor and between
 * factors; freed by the caller. */
static char *sampled_paths(struct layout *l, char within, char between)
{
    const struct scenario *s = l->plan->scenario;
    const struct scenario_axis *axis = &s->axis[s->axes - 1];
    char *text = calloc((size_t)axis->paths, sizeof axis->path[0] + 1), *end = text;
    for (size_t j = 0; text && j < s->sample.design.factors; j++) {
        const struct scenario_factor *f = &s->sample.factor[j];
        for (int k = 0; k < f->paths; k++) {
            end += sprintf(end, "%.*s%s", j > 0 || k > 0, k > 0 ? &within : &between,
                           axis->path[f->first + k]);
        }
    }
    l->make.failed = l->make.failed || !text;
    return text;
}

/* The dimension of a sample: numbers of the points, and what design they are of. */
static void make_sample(struct layout *l, const struct scenario_axis *axis,
                        struct dimension *dimension)
{
    const struct doe *design = &l->plan->scenario->sample.design;
    const char *generator = doe_generator(design->method);
    char *paths = sampled_paths(l, ',', ';');
    const int32_t factors = (int32_t)design->factors, block = (int32_t)doe_block(design),
                  levels = design->levels, second_order = design->second_order;
    struct dataset d = dataset(axis->name, KIND_int64_t, axis->unit, axis->text);
    d.value = make_place;
    d.length = axis->count;
    const struct attribute attributes[] = {
        {"method", KIND_text, doe_words[design->method]},
        {"generator", KIND_text, generator[0] ? generator : NULL},
        {"count", KIND_uint64_t, &design->count},
        {"factors", KIND_int32_t, &factors},
        {"block", KIND_int32_t, &block},
        {"levels", KIND_int32_t, design->method == DOE_MORRIS ? &levels : NULL},
        {"second_order", KIND_int32_t, design->method == DOE_SALTELLI ? &second_order : NULL},
        {"paths", KIND_text, paths},
    };
    make(&l->make, &d, dimension);
    put_attributes(&l->make, dimension->id, attributes, sizeof attributes / sizeof attributes[0]);
    free(paths);
}

static double case_value(const void *context, uint64_t i)
{
    return (double)plan_case(context, i);
}

/* The dimension `case`: numbers of cases. */
static void make_cases(struct layout *l, uint64_t n,
                       double (*value)(const void *context, uint64_t i),
                       struct dimension *dimension)
{
    struct dataset d =
        dataset("case", KIND_int64_t, "1", "flat index of the case, row-major over the axes");
    d.value = value;
    d.context = l->plan;
    d.length = n;
    make(&l->make, &d, dimension);
}

static void put_axes(struct layout *l)
{
    const struct plan *plan = l->plan;
    const struct scenario *s = plan->scenario;
    const bool one = plan->single || s->axes == 0;
    uint64_t inner = s->cases; /* cases in one point of an axis */

    if (one)
        make_cases(l, 1, case_value, &l->axis[0]);
    for (int a = 0; a < s->axes; a++) {
        const struct scenario_axis *const axis = &s->axis[a];
        struct dimension *const own = &l->axis[one ? 0 : a];
        inner /= axis->count;
        struct axis_values values = {axis, 0, plan->single,
                                     (size_t)(plan->single_case / inner % axis->count)};
        if (axis->sample && !one)
            make_sample(l, axis, own);
        for (; values.path < axis->paths; values.path++) {
            const bool first = !one && !axis->sample && values.path == 0;
            put_path(l, &values, first ? NULL : own, first ? own : NULL);
        }
    }
    for (int d = 0; d < (one ? 1 : s->axes); d++)
        l->over[d] = &l->axis[d];
}

/* ---- answers, designs, trajectories -------------------------------------------------------- */

/* What variables are over beside `outer`: names of coordinates, actuators, contacts ... Made in the
 * group that they are in. Names of the state are the coordinates, then "v" and the coordinates, of
 * the body or the posture. */
static void make_inner(struct layout *l, enum store_over over)
{
    static const char *const components[] = {"normal", "tangential"};
    const stance_scene *scene = l->plan->scenario->scene;
    const bool posture = over == OVER_POSTURE;
    const int n = posture ? scene->postures : scene->coordinates;
    char text[SCENARIO_MAX_STATES][SCENARIO_NAME];
    const char *state[SCENARIO_MAX_STATES], *coordinate[STANCE_MAX_COORDINATES];
    for (int i = 0; i < 2 * n; i++) {
        const char *name = scene->coordinate[posture ? scene->posture[i % n] : i % n].name;
        snprintf(text[i], sizeof text[i], "%s%s", i < n ? "" : "v", name);
        state[i] = text[i];
        coordinate[i % n] = name;
    }
    const struct {
        const char *name, *const *words;
        int count;
    } names[OVERS] = {
        [OVER_STATE] = {"state", state, 2 * n},
        [OVER_POSTURE] = {"posture_state", state, scene->actuators > 0 ? 2 * n : 0},
        [OVER_COORDINATE] = {"coordinate", coordinate, n},
        [OVER_ACTUATOR] = {"actuator", scene->actuator_name, scene->actuators},
        [OVER_CONTACT] = {"contact", scene->contact_name, scene->contacts},
        [OVER_COMPONENT] = {"component", components, scene->contacts > 0 ? 2 : 0},
    };
    make_words(l, names[over].name, names[over].words, names[over].count, &l->inner[over]);
}

/* A variable over some dimensions (NULL after the last) and its inner ones. `more`: what the table
 * does not say of it. */
static void put(struct layout *l, const struct store_variable *v,
                const struct dimension *const *outer, struct dataset more)
{
    int rank = 0;
    if (store_width(l->plan->scenario->scene, v) == 0)
        return;
    more.name = strrchr(v->name, '/') ? strrchr(v->name, '/') + 1 : v->name;
    more.kind = v->kind;
    more.filled = v->filled;
    more.unit = v->unit;
    more.text = v->text;
    for (; outer[rank]; rank++)
        more.over[rank] = outer[rank];
    for (int i = 0; i < 2; i++)
        if (v->over[i] != OVER_NONE)
            more.over[rank++] = &l->inner[v->over[i]];
    make(&l->make, &more, NULL);
}

/* The words of a variable that is a code, in one text; NULL: it is none. */
enum { FLAGS = 1024 }; /* bytes of them */
static const char *flags_of(const stance_scene *scene, int column, char text[FLAGS])
{
    static const char *const status[] = {"pending", "done", "failed"};
    if (column == COLUMN_STATUS)
        return words_join(text, FLAGS, " ", status, 3);
    const char *word[STANCE_MAX_WORDS];
    const int words = column < STANCE_ANSWER_COUNT ? stance_answer_words(scene, column, word) : 0;
    return words > 0 ? words_join(text, FLAGS, " ", word, (size_t)words) : NULL;
}

/* Of a sweep with a sample the sampled values are CF's coordinates. */
static void put_answers(struct layout *l)
{
    const struct scenario *s = l->plan->scenario;
    char *paths = s->sample.given && !l->plan->single ? sampled_paths(l, ' ', ' ') : NULL;
    if (store_has_column(s, COLUMN_FINAL_STATE))
        make_inner(l, OVER_STATE);
    for (int c = 0; c < COLUMNS; c++) {
        const bool number = c == COLUMN_SCENARIO_NUMBER;
        char flags[FLAGS];
        if (store_has_column(s, c) || (number && l->before))
            put(l, &store_columns[c], l->over,
                (struct dataset){.flags = flags_of(s->scene, c, flags),
                                 .coordinates = number ? NULL : paths});
    }
    free(paths);
}

static void put_designs(struct layout *l)
{
    const struct plan *plan = l->plan;
    const struct scenario *s = plan->scenario;
    const struct dimension *over[SCENARIO_MAX_AXES + 1] = {NULL};
    int rank = 0;
    char flags[FLAGS];

    make_group(&l->make, "design");
    for (int a = 0; !plan->single && a < s->axes; a++)
        if (s->axis[a].design)
            over[rank++] = &l->axis[a];
    make_inner(l, OVER_COORDINATE);
    make_inner(l, OVER_ACTUATOR);
    make_inner(l, OVER_POSTURE);
    for (int k = 0; k < RESOLVED_PARTS; k++) {
        double *const values = store_design_values(plan, k);
        l->make.failed = l->make.failed || !values;
        put(l, &store_designs[k], over, (struct dataset){.values = values});
        free(values);
    }
    put(l, &store_design_status, over,
        (struct dataset){.flags = flags_of(s->scene, COLUMN_STATUS, flags),
                         .values = plan->design_status});
}

static double recorded_case(const void *context, uint64_t i)
{
    return (double)plan_recorded_case(context, i);
}

static double recorded_time(const void *context, uint64_t i)
{
    const struct plan *plan = context;
    return (double)i * plan->record_interval;
}

static void put_trajectories(struct layout *l)
{
    const struct plan *plan = l->plan;
    struct dataset instant =
        dataset("time", KIND_double, "s", "instant; the step that ends nearest to it is stored");
    struct dimension number, time;

    if (plan->record_rows == 0)
        return;
    instant.value = recorded_time;
    instant.context = plan;
    instant.length = (hsize_t)plan->record_rows;
    make_group(&l->make, "trajectory");
    make_cases(l, plan->record_cases, recorded_case, &number);
    make(&l->make, &instant, &time);
    for (enum store_over over = OVER_COORDINATE; over <= OVER_COMPONENT; over++)
        make_inner(l, over);
    for (int v = 0; v < TRACKS; v++)
        put(l, &store_tracks[v], (const struct dimension *const[]){&number, &time, NULL},
            (struct dataset){0});
    put(l, &store_tracks[TRACK_CHECKSUM], (const struct dimension *const[]){&number, NULL},
        (struct dataset){0});
}

/* ---- timing, earlier scenarios, provenance ------------------------------------------------ */

static void put_timing(struct layout *l)
{
    struct dimension rank;
    char label[80];
    void *const none = calloc((size_t)l->ranks, sizeof(double)); /* of numbers of either type */
    /* Such dimensions are known by their label; the type is what netCDF gives them. */
    const struct dataset rows[] = {
        {"rank", .label = label, .length = (hsize_t)l->ranks},
        {"wall_time", KIND_double, false, "s", "wall time of computing", .values = none,
         .over = {&rank}},
        {"cases", KIND_int64_t, false, "1", "cases computed", .values = none, .over = {&rank}},
    };
    snprintf(label, sizeof label, "This is a netCDF dimension but not a netCDF variable.%10d",
             l->ranks);
    make_group(&l->make, "timing");
    l->make.failed = l->make.failed || !none;
    for (int k = 0; k < 3; k++)
        make(&l->make, &rows[k], k == 0 ? &rank : NULL);
    free(none);
}

/* The earlier scenarios of the file, and the last one's. */
static void put_history(struct layout *l)
{
    const struct store_origin *const o = l->before;
    const char *text[STORE_TEXTS][STORE_MOST_ANCESTORS + 1];
    if (!o)
        return;
    make_group(&l->make, "history");
    for (int k = 0; k < STORE_TEXTS; k++) {
        for (size_t i = 0; i < o->ancestors; i++)
            text[k][i] = o->ancestor[i].text[k];
        text[k][o->ancestors] = k == 0 ? o->scenario : k == 1 ? o->revision : o->date;
        make_words(l, store_text_names[k], text[k], (int)o->ancestors + 1, NULL);
    }
}

static void put_provenance(struct layout *l)
{
    const struct plan *plan = l->plan;
    const struct scenario *s = plan->scenario;
    char axes[SCENARIO_MAX_AXES * 98 + 8] = "case", compiler[1024], date[40], hash[80], law[80];
    char libraries[BUILD_LIBRARIES_SIZE], shard[SHARD_TEXT], isas[INSTRUCTION_SETS_SIZE];
    const int32_t version = FORMAT_VERSION, ranks = l->ranks;
    time_t now = time(NULL);
    struct tm utc;

    if (!plan->single && s->axes > 0)
        axes[0] = '\0';
    for (int a = 0; !plan->single && a < s->axes; a++)
        words_add(axes, sizeof axes, "%s%s", a ? "," : "", s->axis[a].name);
    snprintf(compiler, sizeof compiler, "%s; %s", build_compiler, build_flags);
    strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &utc));
    build_libraries(libraries);
    kernels_instruction_sets(plan, isas);
    shard_text(&plan->shard, shard);
    checksum_sha256(s->text, strlen(s->text), hash);
    if (s->law.source)
        checksum_sha256(s->law.source, strlen(s->law.source), law);
    const struct attribute attributes[] = {
        {"Conventions", KIND_text, "CF-1.8"},
        {"title", KIND_text, s->title},
        {"format_version", KIND_int32_t, &version},
        {"program_version", KIND_text, STANCE_VERSION},
        {"git_revision", KIND_text, build_revision},
        {"compiler", KIND_text, compiler},
        {"library_versions", KIND_text, libraries},
        {"instruction_set", KIND_text, isas},
        {"ranks", KIND_int32_t, &ranks},
        {"hosts", KIND_text, l->hosts},
        {"date", KIND_text, date},
        {"seed", KIND_uint64_t, &s->seed},
        {"axes", KIND_text, axes},
        {"shard", KIND_text, plan->shard.count > 0 ? shard : NULL},
        {"scenario", KIND_text, s->text},
        /* What the scenario's text holds, as it was: of a law of the user's own. */
        {"law_source", KIND_text, s->law.source},
        {"law_sha256", KIND_text, s->law.source ? law : NULL},
        {"scenario_sha256", KIND_text, hash}, /* the last one: the creation came to its end */
    };
    put_attributes(&l->make, l->make.file, attributes, sizeof attributes / sizeof attributes[0]);
}

/* ---- creation ----------------------------------------------------------------------------- */

/* Bytes of a row of a column; 0: it is not stored. */
static uint64_t row_size(const struct scenario *s, int c)
{
    return store_has_column(s, c)
               ? store_width(s->scene, &store_columns[c]) * hdf_size(store_columns[c].kind)
               : 0;
}

static uint64_t instant_size(const struct scenario *s)
{
    uint64_t size = 0;
    for (int v = 0; v < TRACKS; v++)
        size += sizeof(double) * store_width(s->scene, &store_tracks[v]);
    return size;
}

/* Without holes. */
static uint64_t whole_size(const struct plan *plan, int ranks)
{
    const struct scenario *s = plan->scenario;
    uint64_t size = METADATA_SIZE + 16 * (uint64_t)ranks + 2 * strlen(s->text);
    uint64_t datasets = COLUMNS + 20;

    for (int c = 0; c < COLUMNS; c++)
        size += plan->rows * row_size(s, c);
    for (int a = 0; a < s->axes; a++) {
        datasets += (uint64_t)s->axis[a].paths;
        const uint64_t point = s->axis[a].sample ? sizeof(double) : 32; /* words take more */
        size += plan->single ? 0 : point * s->axis[a].count * (1 + (uint64_t)s->axis[a].paths);
        size += s->axis[a].sample ? COLUMNS * sizeof s->axis[a].path[0] : 0;
    }
    size += sizeof(double) * (uint64_t)plan->record_rows;
    size += plan->record_cases * (12 + (uint64_t)plan->record_rows * instant_size(s));
    return size + datasets * DATASET_SIZE + plan->designs * sizeof(struct resolved_design);
}

/* What rows of a plan take that a shard leaves out, but for the ends of its stripes. */
static uint64_t holes(const struct plan *plan)
{
    const struct scenario *s = plan->scenario;
    const struct shard *shard = &plan->shard;
    if (shard->count == 0)
        return 0;
    const uint64_t rows = shard_rows(shard), stripes = rows / shard->stripe + 1;
    const uint64_t left_out = plan->record_cases - plan->record_cases / shard->count;
    uint64_t size = left_out * (uint64_t)plan->record_rows * instant_size(s);
    for (int c = 0; c < COLUMNS; c++) {
        const uint64_t width = row_size(s, c), taken = rows * width + stripes * DISK_BLOCK;
        size += plan->rows * width > taken ? plan->rows * width - taken : 0;
    }
    return size;
}

uint64_t store_size(const struct plan *plan, int ranks)
{
    return whole_size(plan, ranks) - holes(plan);
}

/* Under another name until it is whole, so that a killed creation leaves no file to be resumed. */
bool store_create(const char *file, const struct plan *plan, const struct store_origin *before,
                  int ranks, const char *hosts, stance_message *message)
{
    static void (*const parts[])(struct layout *) = {put_axes,         put_answers, put_designs,
                                                     put_trajectories, put_timing,  put_history};
    struct layout layout = {.plan = plan, .before = before, .ranks = ranks, .hosts = hosts};
    struct maker *const m = &layout.make;
    char part[PATH_MAX];

    if (access(file, F_OK) == 0)
        return store_system_failed(message, file, "create", EEXIST);
    snprintf(part, sizeof part, "%s.part", file);
    unlink(part); /* of a creation that was killed */
    if (!store_fits(file, store_size(plan, ranks), whole_size(plan, ranks), message))
        return false;
    make_file(m, part);
    if (m->failed)
        return store_failed(message, file, "create");
    for (size_t k = 0; k < sizeof parts / sizeof parts[0]; k++)
        parts[k](&layout);
    m->failed = m->failed || !file_checksums_put(m->file);
    put_provenance(&layout);
    bool good = !m->failed || store_failed(message, file, "lay out");
    if (H5Fclose(m->file) < 0 && good)
        good = store_failed(message, file, "write the layout");
    good = good && (plan->shard.count > 0 || store_bring(part, true, message)) &&
           (rename(part, file) == 0 || store_system_failed(message, file, "create", errno));
    if (!good)
        unlink(part);
    return good;
}
