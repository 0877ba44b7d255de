/* store_layout.c - creates the results file: dimensions, variables, attributes, reserved space.
 *
 * netCDF-4 conventions: every dimension is an HDF5 dimension scale with its own `_Netcdf4Dimid`,
 * attached to the variables over it, so that dimensions of equal length are not confused.
 * Done by rank 0 alone with the serial driver, closed and reserved before any case is computed.
 */
#include "build_info.h"
#include "file_checksums.h"
#include "store_make.h"

#include "runner/base/checksum.h"
#include "runner/base/command.h"
#include "runner/base/problem.h"
#include "runner/base/words.h"
#include "runner/plan/kernels.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { FORMAT_VERSION = 1, METADATA_SIZE = 96 * 1024, DATASET_SIZE = 1024, DISK_BLOCK = 4096 };

struct layout {
    const struct plan *plan;
    hid_t file;
    int dimensions; /* made so far: the next `_Netcdf4Dimid` */
    int rank;       /* of the cases */
    struct dimension axis[SCENARIO_MAX_AXES];
    int ranks;
    const char *hosts;
};

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

/* Point of axis a that a case has. */
static size_t axis_point(const struct scenario *s, int a, uint64_t index)
{
    for (int b = s->axes - 1; b > a; b--)
        index /= s->axis[b].count;
    return (size_t)(index % s->axis[a].count);
}

/* The other paths of an axis of words may hold numbers. */
static bool has_words(const struct scenario_axis *axis, int path)
{
    return axis->words && axis->enumeration[path];
}

/* A variable of the values of one path; open, or -1. */
static hid_t put_axis_values(hid_t file, const char *name, const struct axis_values *values,
                             hsize_t n)
{
    const struct scenario_axis *axis = values->axis;
    if (has_words(axis, values->path)) {
        const char **words = malloc(n * sizeof *words);
        for (hsize_t i = 0; words && i < n; i++) {
            size_t point = values->single ? values->point : (size_t)i;
            words[i] = axis->word[point * (size_t)axis->paths + (size_t)values->path];
        }
        const hid_t dataset = words ? put_words(file, name, words, n) : -1;
        free(words);
        return dataset;
    }
    const enum store_kind kind = axis->integer[values->path] ? KIND_int32_t : KIND_double;
    const hid_t dataset = make_dataset(file, name, hdf_type(kind), 1, &n);
    if (dataset >= 0 && write_values(dataset, n, axis_value, values))
        return dataset;
    hdf_close(dataset);
    return -1;
}

/* The values of one path of an axis, as the axis's own dimension or as a variable `over` one. */
static bool put_path(struct layout *layout, const struct axis_values *values,
                     const struct dimension *over, struct dimension *dimension)
{
    const struct scenario_axis *axis = values->axis;
    hsize_t n = over ? over->length : axis->count;
    const char *name = values->path == 0 ? axis->name : axis->path[values->path];
    hid_t dataset = put_axis_values(layout->file, name, values, n);
    bool good =
        dataset >= 0 && (values->path > 0 ||
                         put_meaning(dataset, has_words(axis, 0) ? NULL : axis->unit, axis->text));
    if (over) {
        good = good && attach(dataset, &over, 1);
        hdf_close(dataset);
    } else {
        good = good && make_scale(&layout->dimensions, dataset, name, n, dimension);
    }
    return good;
}

/* ---- the sample --------------------------------------------------------------------------- */

/* Names of the paths that a sample varies, with such signs between those of a factor and between
 * factors; freed by the caller, NULL: no memory. */
static char *sampled_paths(const struct scenario *s, char within, char between)
{
    const struct scenario_axis *axis = &s->axis[s->axes - 1];
    char *text = calloc((size_t)axis->paths, sizeof axis->path[0] + 1), *end = text;
    for (size_t j = 0; text && j < s->sample.design.factors; j++) {
        const struct scenario_factor *f = &s->sample.factor[j];
        for (int k = 0; k < f->paths; k++) {
            end += sprintf(end, "%.*s%s", j > 0 || k > 0, k > 0 ? &within : &between,
                           axis->path[f->first + k]);
        }
    }
    return text;
}

/* The dimension: numbers of the points, and what design they are of. */
static bool make_sample(struct layout *layout, const struct scenario_axis *axis,
                        struct dimension *dimension)
{
    const struct doe *design = &layout->plan->scenario->sample.design;
    const char *generator = doe_generator(design->method);
    char *paths = sampled_paths(layout->plan->scenario, ',', ';');
    bool good =
        paths &&
        make_numbers(
            &layout->dimensions, layout->file,
            &(struct variable){axis->name, KIND_int64_t, axis->unit, axis->text, .flags = NULL},
            axis->count, NULL, NULL, dimension) &&
        put_text(dimension->id, "method", doe_words[design->method]) &&
        (!generator[0] || put_text(dimension->id, "generator", generator)) &&
        put_number(dimension->id, "count", KIND_uint64_t, &design->count) &&
        put_int(dimension->id, "factors", (int)design->factors) &&
        put_int(dimension->id, "block", (int)doe_block(design)) &&
        (design->method != DOE_MORRIS || put_int(dimension->id, "levels", design->levels)) &&
        (design->method != DOE_SALTELLI ||
         put_int(dimension->id, "second_order", design->second_order)) &&
        put_text(dimension->id, "paths", paths);
    free(paths);
    return good;
}

/* The values of one path of a sample, over the sample or the one case of a file. */
static bool put_sampled(struct layout *layout, const struct axis_values *values,
                        const struct dimension *over)
{
    const struct scenario_axis *axis = values->axis;
    const struct scenario_meaning *meaning = &axis->meaning[values->path];
    const enum store_kind kind = meaning->words                ? KIND_uint8_t
                                 : axis->integer[values->path] ? KIND_int32_t
                                                               : KIND_double;
    const struct variable variable = {axis->path[values->path], kind, meaning->unit, meaning->text,
                                      .flags = meaning->words};
    hid_t dataset = make_variable(layout->file, &variable, &over, 1);
    bool good = dataset >= 0 && write_values(dataset, over->length, axis_value, values);
    hdf_close(dataset);
    return good;
}

/* CF's `coordinates`: the sampled values are those of the sample's points. */
static bool put_coordinates(const struct layout *layout, hid_t dataset)
{
    const struct scenario *s = layout->plan->scenario;
    if (!s->sample.given || layout->plan->single)
        return true;
    char *paths = sampled_paths(s, ' ', ' ');
    bool good = paths && put_text(dataset, "coordinates", paths);
    free(paths);
    return good;
}

/* ---- all axes ----------------------------------------------------------------------------- */

static const struct variable case_variable = {
    "case", KIND_int64_t, "1", "flat index of the case, row-major over the axes", .flags = NULL};

static double case_value(const void *context, uint64_t i)
{
    return (double)plan_case(context, i);
}

static bool put_axes(struct layout *layout)
{
    const struct plan *plan = layout->plan;
    const struct scenario *s = plan->scenario;
    struct dimension *one = NULL;

    if (plan->single || s->axes == 0) {
        one = &layout->axis[0];
        if (!make_numbers(&layout->dimensions, layout->file, &case_variable, 1, case_value, plan,
                          one))
            return false;
    }
    for (int a = 0; a < s->axes; a++) {
        struct axis_values values = {&s->axis[a], 0, plan->single, 0};
        if (plan->single)
            values.point = axis_point(s, a, plan->single_case);
        const bool sample = s->axis[a].sample;
        if (sample && !one && !make_sample(layout, &s->axis[a], &layout->axis[a]))
            return false;
        for (; values.path < s->axis[a].paths; values.path++) {
            const struct dimension *over = one                         ? one
                                           : sample || values.path > 0 ? &layout->axis[a]
                                                                       : NULL;
            if (sample ? !put_sampled(layout, &values, over)
                       : !put_path(layout, &values, over, &layout->axis[a]))
                return false;
        }
    }
    layout->rank = one ? 1 : s->axes;
    return true;
}

/* ---- the answers -------------------------------------------------------------------------- */

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

/* Names of the state: the coordinates, then "v" and the coordinates, of the body or the posture. */
static bool make_state_names(struct layout *layout, hid_t parent, const char *name, bool posture,
                             struct dimension *dimension)
{
    const stance_scene *scene = layout->plan->scenario->scene;
    char text[SCENARIO_MAX_STATES][SCENARIO_NAME];
    const char *words[SCENARIO_MAX_STATES];
    int n = posture ? scene->postures : scene->coordinates;

    for (int i = 0; i < n; i++) {
        const char *coordinate = scene->coordinate[posture ? scene->posture[i] : i].name;
        snprintf(text[i], sizeof text[i], "%s", coordinate);
        snprintf(text[n + i], sizeof text[n + i], "v%s", coordinate);
    }
    for (int i = 0; i < 2 * n; i++)
        words[i] = text[i];
    return make_words(&layout->dimensions, parent, name, words, 2 * (hsize_t)n, dimension);
}

static bool put_answers(struct layout *layout)
{
    const struct scenario *s = layout->plan->scenario;
    struct dimension state = {-1, 0};
    const struct dimension *over[SCENARIO_MAX_AXES + 1] = {NULL};
    for (int d = 0; d < layout->rank; d++)
        over[d] = &layout->axis[d];
    over[layout->rank] = &state;
    if (store_has_column(s, COLUMN_FINAL_STATE) &&
        !make_state_names(layout, layout->file, "state", false, &state))
        return false;
    for (int c = 0; c < COLUMNS; c++) {
        char flags[FLAGS];
        struct variable variable = store_columns[c];
        if (!store_has_column(s, c))
            continue;
        variable.flags = flags_of(s->scene, c, flags);
        hid_t dataset =
            make_variable(layout->file, &variable, over, layout->rank + (c == COLUMN_FINAL_STATE));
        bool good = dataset >= 0 && put_coordinates(layout, dataset);
        hdf_close(dataset);
        if (!good)
            return false;
    }
    return true;
}

/* ---- names of coordinates, actuators, contacts -------------------------------------------- */

static bool make_coordinates(struct layout *layout, hid_t parent, struct dimension *dimension)
{
    const stance_scene *scene = layout->plan->scenario->scene;
    const char *words[STANCE_MAX_COORDINATES];
    for (int i = 0; i < scene->coordinates; i++)
        words[i] = scene->coordinate[i].name;
    return make_words(&layout->dimensions, parent, "coordinate", words, (hsize_t)scene->coordinates,
                      dimension);
}

static bool make_actuators(struct layout *layout, hid_t parent, struct dimension *dimension)
{
    const stance_scene *scene = layout->plan->scenario->scene;
    return scene->actuators == 0 ||
           make_words(&layout->dimensions, parent, "actuator", scene->actuator_name,
                      (hsize_t)scene->actuators, dimension);
}

/* ---- the designs -------------------------------------------------------------------------- */

static bool put_design_columns(struct layout *layout, hid_t group, const struct dimension **over,
                               int rank, const struct dimension inner[DESIGN_DIMENSIONS])
{
    struct store_design_column columns[DESIGN_COLUMNS];
    store_design_columns(layout->plan->scenario->scene, columns);
    for (int k = 0; k < DESIGN_COLUMNS; k++) {
        if (columns[k].rows * columns[k].columns == 0)
            continue;
        for (int i = 0; i < columns[k].dimensions; i++)
            over[rank + i] = &inner[columns[k].over[i]];
        const struct variable variable = {
            columns[k].name, KIND_double, columns[k].unit, columns[k].text, true, NAN, NULL, 0};
        hid_t dataset = make_variable(group, &variable, over, rank + columns[k].dimensions);
        bool good = dataset >= 0 && store_move_design(layout->plan, NULL, &columns[k], dataset);
        hdf_close(dataset);
        if (!good)
            return false;
    }
    return true;
}

static bool put_designs(struct layout *layout)
{
    const struct plan *plan = layout->plan;
    const struct scenario *s = plan->scenario;
    struct dimension inner[DESIGN_DIMENSIONS] = {{-1, 0}, {-1, 0}, {-1, 0}};
    const struct dimension *over[SCENARIO_MAX_AXES + 2] = {NULL};
    const bool postures = s->scene->actuators > 0 && s->scene->postures > 0;
    int rank = 0;
    hid_t group = make_group(layout->file, "design");

    for (int a = 0; !plan->single && a < s->axes; a++)
        if (s->axis[a].design)
            over[rank++] = &layout->axis[a];
    bool good = group >= 0 && make_coordinates(layout, group, &inner[DESIGN_COORDINATE]) &&
                make_actuators(layout, group, &inner[DESIGN_ACTUATOR]) &&
                (!postures ||
                 make_state_names(layout, group, "posture_state", true, &inner[DESIGN_POSTURE])) &&
                put_design_columns(layout, group, over, rank, inner);
    if (good) {
        char flags[FLAGS];
        const struct variable variable = {"status", KIND_uint8_t, NULL, "whether the design exists",
                                          .flags = flags_of(s->scene, COLUMN_STATUS, flags)};
        good = put_variable(group, &variable, over, rank, plan->design_status);
    }
    hdf_close(group);
    return good;
}

/* ---- the trajectories --------------------------------------------------------------------- */

static double recorded_case(const void *context, uint64_t i)
{
    return (double)plan_recorded_case(context, i);
}

static double recorded_time(const void *context, uint64_t i)
{
    const struct plan *plan = context;
    return (double)i * plan->record_interval;
}

static bool put_trajectories(struct layout *layout)
{
    const struct plan *plan = layout->plan;
    const stance_scene *scene = plan->scenario->scene;
    static const char *const components[] = {"normal", "tangential"};
    static const struct variable instant = {"time", KIND_double, "s",
                                            "instant; the step that ends nearest to it is stored",
                                            .flags = NULL};
    struct dimension number, time, coordinate, actuator, contact, component;

    if (plan->record_rows == 0)
        return true;
    hid_t group = make_group(layout->file, "trajectory");
    bool good = group >= 0 &&
                make_numbers(&layout->dimensions, group, &case_variable, plan->record_cases,
                             recorded_case, plan, &number) &&
                make_numbers(&layout->dimensions, group, &instant, (hsize_t)plan->record_rows,
                             recorded_time, plan, &time) &&
                make_coordinates(layout, group, &coordinate) &&
                make_actuators(layout, group, &actuator) &&
                (scene->contacts == 0 ||
                 (make_words(&layout->dimensions, group, "contact", scene->contact_name,
                             (hsize_t)scene->contacts, &contact) &&
                  make_words(&layout->dimensions, group, "component", components, 2, &component)));
    const struct dimension *const last[] = {&coordinate, &actuator, &contact};
    for (int v = 0; good && v < TRAJECTORIES; v++) {
        const struct store_trajectory *t = &store_trajectories[v];
        const struct dimension *over[] = {&number, &time, last[t->over], &component};
        const struct variable variable = {t->name, KIND_double, t->unit, t->text,
                                          true,    NAN,         NULL,    0};
        good = store_trajectory_width(scene, v) == 0 ||
               put_variable(group, &variable, over, t->parts > 1 ? 4 : 3, NULL);
    }
    if (good) {
        const struct dimension *over[] = {&number};
        struct variable checksum = store_columns[COLUMN_CHECKSUM];
        checksum.text = "CRC-32C over the trajectory of the case";
        good = put_variable(group, &checksum, over, 1, NULL);
    }
    hdf_close(group);
    return good;
}

/* ---- timing and provenance ---------------------------------------------------------------- */

static bool put_timing(struct layout *layout)
{
    struct dimension rank;
    const struct dimension *over[] = {&rank};
    char label[80];
    hsize_t n = (hsize_t)layout->ranks;
    hid_t group = make_group(layout->file, "timing");
    snprintf(label, sizeof label, "This is a netCDF dimension but not a netCDF variable.%10d",
             layout->ranks);
    /* Such dimensions are known by their label; the type is what netCDF gives them. */
    if (group < 0 ||
        !make_scale(&layout->dimensions, make_dataset(group, "rank", H5T_IEEE_F32BE, 1, &n), label,
                    n, &rank))
        return false;
    static const struct variable wall_time = {"wall_time", KIND_double, "s",
                                              "wall time of computing", .flags = NULL},
                                 computed = {"cases", KIND_int64_t, "1", "cases computed",
                                             .flags = NULL};
    void *const none = calloc(n, sizeof(double)); /* zeros, of numbers of either type */
    const bool good = none && put_variable(group, &wall_time, over, 1, none) &&
                      put_variable(group, &computed, over, 1, none);
    free(none);
    hdf_close(group);
    return good;
}

static bool put_provenance(struct layout *layout)
{
    const struct plan *plan = layout->plan;
    const struct scenario *s = plan->scenario;
    char axes[SCENARIO_MAX_AXES * 98 + 8] = "case", compiler[1024], date[40], hash[80];
    char libraries[BUILD_LIBRARIES_SIZE], shard[SHARD_TEXT], isas[INSTRUCTION_SETS_SIZE];
    time_t now = time(NULL);
    struct tm utc;

    if (!plan->single && s->axes > 0)
        axes[0] = '\0';
    for (int a = 0; !plan->single && a < s->axes; a++)
        words_add(axes, sizeof axes, "%s%s", a ? "," : "", s->axis[a].name);
    snprintf(compiler, sizeof compiler, "%s; %s", build_compiler(), build_flags());
    strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &utc));
    build_libraries(libraries);
    kernels_instruction_sets(plan, isas);
    shard_text(&plan->shard, shard);
    checksum_sha256(s->text, strlen(s->text), hash);
    return put_text(layout->file, "Conventions", "CF-1.8") &&
           put_text(layout->file, "title", s->title) &&
           put_int(layout->file, "format_version", FORMAT_VERSION) &&
           put_text(layout->file, "program_version", STANCE_VERSION) &&
           put_text(layout->file, "git_revision", build_revision()) &&
           put_text(layout->file, "compiler", compiler) &&
           put_text(layout->file, "library_versions", libraries) &&
           put_text(layout->file, "instruction_set", isas) &&
           put_int(layout->file, "ranks", layout->ranks) &&
           put_text(layout->file, "hosts", layout->hosts) && put_text(layout->file, "date", date) &&
           put_number(layout->file, "seed", KIND_uint64_t, &s->seed) &&
           put_text(layout->file, "axes", axes) &&
           (plan->shard.count == 0 || put_text(layout->file, "shard", shard)) &&
           put_text(layout->file, "scenario", s->text) &&
           put_text(layout->file, "scenario_sha256", hash);
}

/* ---- creation ----------------------------------------------------------------------------- */

/* Without holes. */
static uint64_t whole_size(const struct plan *plan, int ranks)
{
    const struct scenario *s = plan->scenario;
    uint64_t size = METADATA_SIZE + 16 * (uint64_t)ranks + 2 * strlen(s->text);
    uint64_t datasets = COLUMNS + 20, per_row = 0, per_instant = 0;

    for (int c = 0; c < COLUMNS; c++)
        if (store_has_column(s, c))
            per_row += store_column_width(s, c) * store_columns[c].size;
    for (int v = 0; v < TRAJECTORIES; v++)
        per_instant += sizeof(double) * store_trajectory_width(s->scene, v);
    for (int a = 0; a < s->axes; a++) {
        datasets += (uint64_t)s->axis[a].paths;
        const uint64_t point = s->axis[a].sample ? sizeof(double) : 32; /* words take more */
        size += plan->single ? 0 : point * s->axis[a].count * (1 + (uint64_t)s->axis[a].paths);
        size += s->axis[a].sample ? COLUMNS * sizeof s->axis[a].path[0] : 0;
    }
    size += sizeof(double) * (uint64_t)plan->record_rows;
    size += plan->record_cases * (12 + (uint64_t)plan->record_rows * per_instant);
    return size + plan->rows * per_row + datasets * DATASET_SIZE +
           plan->designs * sizeof(struct resolved_design);
}

/* What rows of a plan take that a shard leaves out, but for the ends of its stripes. */
static uint64_t holes(const struct plan *plan)
{
    const struct scenario *s = plan->scenario;
    const struct shard *shard = &plan->shard;
    uint64_t size = 0;
    if (shard->count == 0)
        return 0;
    const uint64_t rows = shard_rows(shard), stripes = rows / shard->stripe + 1;
    for (int c = 0; c < COLUMNS; c++) {
        const uint64_t width =
            store_has_column(s, c) ? store_column_width(s, c) * store_columns[c].size : 0;
        const uint64_t taken = rows * width + stripes * DISK_BLOCK;
        size += plan->rows * width > taken ? plan->rows * width - taken : 0;
    }
    for (int v = 0; v < TRAJECTORIES; v++) {
        const uint64_t width = sizeof(double) * store_trajectory_width(s->scene, v);
        const uint64_t left_out = plan->record_cases - plan->record_cases / shard->count;
        size += left_out * (uint64_t)plan->record_rows * width;
    }
    return size;
}

uint64_t store_size(const struct plan *plan, int ranks)
{
    return whole_size(plan, ranks) - holes(plan);
}

/* Under another name until it is whole, so that a killed creation leaves no file to be resumed. */
bool store_create(const char *file, const struct plan *plan, int ranks, const char *hosts,
                  stance_message *message)
{
    struct layout layout = {.plan = plan, .ranks = ranks, .hosts = hosts};
    char part[PATH_MAX];

    if (access(file, F_OK) == 0)
        return store_system_failed(message, file, "create", EEXIST);
    snprintf(part, sizeof part, "%s.part", file);
    unlink(part); /* of a creation that was killed */
    if (!store_fits(file, store_size(plan, ranks), whole_size(plan, ranks), message))
        return false;
    layout.file = store_create_hdf(part);
    if (layout.file < 0)
        return store_failed(message, file, "create");
    bool good = put_axes(&layout) && put_answers(&layout) && put_designs(&layout) &&
                put_trajectories(&layout) && put_timing(&layout) &&
                file_checksums_put(layout.file) && put_provenance(&layout);
    good = good || store_failed(message, file, "lay out");
    if (H5Fclose(layout.file) < 0 && good)
        good = store_failed(message, file, "write the layout");
    good = good && (plan->shard.count > 0 || store_reserve(part, message)) &&
           (rename(part, file) == 0 || store_system_failed(message, file, "create", errno));
    if (!good)
        unlink(part);
    return good;
}
