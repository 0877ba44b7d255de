/* store_history.c - what files that went on with another scenario (changed_scenario.h) were made
 * from before. */
#include "file_checksums.h"
#include "store_make.h"

#include <stdlib.h>
#include <string.h>

/* ---- the group `history` ------------------------------------------------------------------ */

enum { TEXTS = 3 };
static const char *const text_names[TEXTS] = {"scenario", "git_revision", "date"};

/* Text k of a scenario. */
static char **text_of(struct store_ancestor *ancestor, int k)
{
    return k == 0 ? &ancestor->scenario : k == 1 ? &ancestor->revision : &ancestor->date;
}

/* Text k of every scenario; their number must be that of the others. */
static bool read_texts(hid_t group, int k, struct store_origin *origin)
{
    const hid_t dataset = H5Dopen2(group, text_names[k], H5P_DEFAULT);
    const size_t n = hdf_elements(dataset);
    bool good = n > 0 && n <= STORE_MOST_ANCESTORS;

    if (good && !origin->ancestor) {
        origin->ancestor = calloc(n, sizeof *origin->ancestor);
        origin->ancestors = origin->ancestor ? n : 0;
    }
    char **words = good && n == origin->ancestors ? hdf_words(dataset, 0, n) : NULL;
    for (size_t i = 0; words && i < n; i++)
        *text_of(&origin->ancestor[i], k) = words[i];
    good = words != NULL;
    free(words);
    hdf_close(dataset);
    return good;
}

bool store_read_history(hid_t file, struct store_origin *origin)
{
    bool good = true;
    if (H5Lexists(file, "history", H5P_DEFAULT) <= 0)
        return true;
    hid_t group = H5Gopen2(file, "history", H5P_DEFAULT);
    for (int k = 0; good && k < TEXTS; k++)
        good = read_texts(group, k, origin);
    hdf_close(group);
    return good;
}

/* The earlier scenarios of the origin, and its own. */
static bool put_texts(hid_t group, int k, const struct store_origin *origin)
{
    const char *word[STORE_MOST_ANCESTORS + 1];
    struct store_ancestor own = {origin->scenario, (char *)(uintptr_t)origin->revision,
                                 (char *)(uintptr_t)origin->date};
    const hsize_t n = origin->ancestors + 1;
    for (size_t i = 0; i < origin->ancestors; i++)
        word[i] = *text_of(&origin->ancestor[i], k);
    word[origin->ancestors] = *text_of(&own, k);
    const hid_t dataset = put_words(group, text_names[k], word, n);
    hdf_close(dataset);
    return dataset >= 0;
}

/* The variable over the cases. */
static bool put_numbers(hid_t file, const struct plan *plan)
{
    struct dimension axis[SCENARIO_MAX_AXES];
    const struct dimension *over[SCENARIO_MAX_AXES];
    hsize_t length[SCENARIO_MAX_AXES];
    const int rank = store_dimensions(plan, length);
    const bool one = plan->single || plan->scenario->axes == 0;
    for (int d = 0; d < rank; d++) {
        const char *name = one ? "case" : plan->scenario->axis[d].name;
        axis[d] = (struct dimension){H5Dopen2(file, name, H5P_DEFAULT), length[d]};
        over[d] = &axis[d];
    }
    const bool good = put_variable(file, &store_columns[COLUMN_SCENARIO_NUMBER], over, rank, NULL);
    for (int d = 0; d < rank; d++)
        hdf_close(axis[d].id);
    return good;
}

bool store_add_history(const char *file, const struct plan *plan, const struct store_origin *origin,
                       stance_message *message)
{
    const hid_t access = store_serial_access(), id = H5Fopen(file, H5F_ACC_RDWR, access);
    const hid_t group = make_group(id, "history");
    bool good = group >= 0;
    hdf_close(access);
    for (int k = 0; good && k < TEXTS; k++)
        good = put_texts(group, k, origin);
    hdf_close(group);
    good = good && file_checksums_put_group(id, "history") && put_numbers(id, plan);
    good = good || store_failed(message, file, "lay out its history");
    if (id >= 0 && H5Fclose(id) < 0 && good)
        good = store_failed(message, file, "write its history");
    return good && store_reserve(file, message);
}
