/* search_json.c - a search for programs; the keys are listed in `stance summary -h`. */
#include "search_summary.h"

#include <stdlib.h>

static json_t *table_of(const struct search_study *study,
                        void (*make)(struct table *, const struct search_study *))
{
    struct table t = {0};
    make(&t, study);
    json_t *const json = table_json(&t, false);
    table_free(&t);
    return json;
}

static json_t *gains(const struct search_study *study)
{
    const stance_scene *const scene = study->best->scene;
    const int columns = 2 * scene->postures;
    json_t *const rows = json_array();
    for (int i = 0; i < scene->actuators; i++) {
        json_t *const row = json_array();
        for (int j = 0; j < columns; j++)
            table_append(row, as_number(study->best->base.gains[i * columns + j]));
        json_array_append_new(rows, row);
    }
    return rows;
}

static json_t *values(const struct search_study *study)
{
    const struct search_file *const f = &study->f;
    const size_t n = f->length[SEARCH_PARAMETER];
    json_t *const object = json_object();
    for (size_t k = 0; k < n; k++)
        table_put(object, f->parameter[k],
                  as_number(f->confirmed_value[(size_t)f->chosen * n + k]));
    return object;
}

static json_t *poles(const struct search_study *study)
{
    struct design_report *const loop = search_loop(study);
    json_t *const list = loop ? json_array() : NULL;
    for (int i = 0; loop && i < loop->states; i++) {
        json_t *const pole = json_array();
        table_append(pole, as_number(loop->closed_re[i]));
        table_append(pole, as_number(loop->closed_im[i]));
        json_array_append_new(list, pole);
    }
    free(loop);
    return list;
}

static json_t *chosen(const struct search_study *study)
{
    char name[80];
    json_t *const counts = json_object();
    for (int label = 0; label < TRIAL_LABELS; label++)
        table_put(counts, study->f.kind[label],
                  as_whole((uint64_t)search_count(study, (size_t)study->f.chosen, label)));
    search_name(study, (size_t)study->f.chosen, name, sizeof name);
    const struct search_gain gain = search_gain(study, SEARCH_OVERALL);
    return TABLE_OBJECT({"which", as_text(name)}, {"starts", as_tree(counts)},
                        {"gain", as_number(gain.share)}, {"gain_low", as_number(gain.interval.low)},
                        {"gain_high", as_number(gain.interval.high)}, {"won", as_whole(gain.won)},
                        {"lost", as_whole(gain.lost)}, {"values", as_tree(values(study))},
                        {"gains", as_tree(search_has_gains(study) ? gains(study) : NULL)},
                        {"poles", as_tree(poles(study))});
}

bool search_print_json(const struct search_study *study)
{
    const struct search_file *const f = &study->f;
    const int64_t best = search_best(study);
    char aim[600];
    const char *where = NULL;
    const double limit = study->done ? search_limit(study, (size_t)f->chosen, &where) : NAN;
    search_aim(study, aim, sizeof aim);
    json_t *const root = TABLE_OBJECT(
        {"file", as_text(study->file)}, {"title", as_text(f->title)},
        {"revision", as_text(f->revision)}, {"date", as_text(f->date)},
        {"seconds", as_number(f->seconds)}, {"finished", as_truth(f->finished)},
        {"note", as_text(f->finished ? f->note : NULL)},
        {"generations", as_whole(f->length[SEARCH_GENERATION])},
        {"most_generations", as_whole((uint64_t)f->most_generations)},
        {"candidates", as_whole(f->length[SEARCH_CANDIDATE])}, {"best", as_whole((uint64_t)best)},
        {"best_objective", as_number(f->objective[best])}, {"maximised", as_text(aim)},
        {"varied",
         as_tree(table_list((const char *const *)f->parameter, f->length[SEARCH_PARAMETER]))},
        {"starts_over",
         as_tree(table_list((const char *const *)f->varied, f->length[SEARCH_VARIED]))},
        {"stages", as_tree(table_of(study, search_table_stages))},
        {"fresh_starts", as_whole(f->length[SEARCH_START])},
        {"confirmed", as_tree(table_of(study, search_table_confirmed))},
        {"linear_limit", as_number(limit)}, {"linear_limit_in", as_text(where)},
        {"linear_limit_glued", as_truth(study->glued)},
        {"circumstances", as_tree(table_of(study, search_table_circumstances))},
        {"elsewhere", as_tree(table_of(study, search_table_elsewhere))},
        {"chosen", as_tree(study->done ? chosen(study) : NULL)});
    return table_write_json(root, stdout);
}
