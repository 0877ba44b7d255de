/* summary_fields.c - the fields of the scenario that a sweep leaves alone, for `stance summary`. */
#include "summary.h"

#include "runner/base/problem.h"
#include "runner/scenario/schema.h"
#include "runner/store/results.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool is_varied(const struct results *r, const struct scenario *s, const char *path)
{
    for (int a = 0; a < s->axes; a++) {
        for (int k = 0; k < s->axis[a].paths; k++)
            if (strcmp(s->axis[a].path[k], path) == 0)
                return !r->single;
    }
    for (int a = 0; a < r->axes; a++)
        if (strcmp(r->axis[a].name, path) == 0)
            return true;
    return false;
}

/* Fields as they are found: {path: value}, and for people a paragraph for each group: "robot:
 * leg_length 0.535 m, ...", wrapped. */
struct paragraphs {
    json_t *fixed;
    FILE *text;
    int column;
    char group[96];
};

static void add_field(struct paragraphs *p, const char *path, const char *text, const char *unit)
{
    enum { WRAP = 100, INDENTED = 13 };
    char word[300];
    const size_t length = strcspn(path, ".");
    snprintf(word, sizeof word, "%s %s%s%s", path[length] ? path + length + 1 : path, text,
             unit[0] ? " " : "", unit);
    if (strncmp(p->group, path, length) != 0 || p->group[length]) {
        snprintf(p->group, sizeof p->group, "%.*s", (int)length, path);
        p->column = fprintf(p->text, "\n  %-11s", p->group);
    } else if (p->column + 2 + (int)strlen(word) > WRAP) {
        fprintf(p->text, ",\n  %-11s", "");
        p->column = INDENTED;
    } else {
        p->column += fprintf(p->text, ", ");
    }
    p->column += fprintf(p->text, "%s", word);
}

static void add_word(struct paragraphs *p, const char *path, const char *word)
{
    table_put(p->fixed, path, as_text(word));
    add_field(p, path, word, "");
}

static void add_number(struct paragraphs *p, const char *path, double number, const char *unit)
{
    char text[32];
    if (isinf(number)) {
        add_word(p, path, "none");
        return;
    }
    snprintf(text, sizeof text, "%.6g", number);
    table_put(p->fixed, path, as_number(number));
    add_field(p, path, text, strcmp(unit, "1") == 0 ? "" : unit);
}

/* Contacts of the ground by name; stops of joints are none. */
static void add_contacts(struct paragraphs *p, const stance_scene *scene, const char *path,
                         int contacts)
{
    const char *names[STANCE_MAX_CONTACTS];
    char text[160];
    size_t count = 0;
    for (int i = 0; i < scene->contacts; i++)
        if ((contacts >> i & 1) && scene->grip[i] >= 0)
            names[count++] = scene->contact_name[i];
    if (count > 0)
        add_word(p, path, words_join(text, sizeof text, " ", names, count));
}

/* Whether a law's number is of what it controls: of coordinates those of its selection. Where that
 * is varied the loops of all may act, and nothing is told. */
static bool is_controlled(const struct results *r, const struct scenario *s,
                          const struct scenario_field *field, const struct scenario_values *v)
{
    const stance_law *const law = stance_laws()[field->law];
    const size_t place =
        (field->offset - offsetof(struct scenario_values, law_value)) / sizeof(double) -
        (size_t)(stance_law_first(law) * STANCE_LAW_ROOM);
    int selected[STANCE_MAX_ACTUATORS], selection;
    if (field->use != USE_LAW || field->offset == NO_OFFSET ||
        strcmp(law->parameter[0].of.name, "controlled") != 0 ||
        law->parameter[place / STANCE_LAW_ROOM].per != STANCE_PER_COORDINATE)
        return true;
    memcpy(&selection, scenario_law_value(v, law->name, "controlled"), sizeof selection);
    bool found = false;
    for (int i = 0; !is_varied(r, s, "controller.controlled") && i < s->scene->actuators; i++)
        found |= stance_selection(s->scene, selection, selected) &&
                 selected[i] == (int)(place % STANCE_LAW_ROOM);
    return found;
}

/* The number that a case has where the scenario leaves it open: of the posture at which all cases
 * begin, of a method's tolerance. How far a support may have moved nothing was judged by in files
 * of before: they lack the answer that came with it. */
static double completed(const struct results *r, const struct scenario *s,
                        const struct scenario_field *field, const struct scenario_values *v,
                        double number)
{
    const size_t posture =
        (field->offset - offsetof(struct scenario_values, equilibrium.posture)) / sizeof number;
    const double tolerance = stance_methods()[v->method]->tolerance;
    double start[STANCE_MAX_COORDINATES];
    if (field->offset == offsetof(struct scenario_values, settle_place)) {
        struct results_column column = {.id = -1};
        stance_message ignored;
        const bool has =
            results_column_open(r, "through_ground", &column, &ignored) && column.id >= 0;
        if (has)
            results_column_close(&column);
        return has ? number : NAN;
    }
    if (field->offset == offsetof(struct scenario_values, tolerance))
        return !(tolerance > 0) ? NAN : isnan(number) ? tolerance : number;
    return posture < STANCE_MAX_POSTURE &&
                   results_numbers(r, "design/start_position", start, STANCE_MAX_COORDINATES) ==
                       (size_t)s->scene->coordinates
               ? start[s->scene->posture[posture]]
               : number;
}

static void add_fields(const struct summary *summary, const struct schema *schema,
                       struct paragraphs *p)
{
    const struct results *const r = summary->r;
    const struct scenario *const s = summary->r->read;
    struct scenario_values v = s->base;
    if (r->single && s->axes > 0 && r->index < s->cases)
        scenario_case_values(s, r->index, &v);
    for (size_t k = 0; k < schema->count; k++) {
        const struct scenario_field *const field = &schema->field[k];
        /* what gains are designed from or given as says `stance design` */
        if (field->offset == NO_OFFSET || field->use == USE_PLACE || field->use == USE_LQR ||
            field->use == USE_GAINS || !schema_allows(field->use, field->law, &v) ||
            !is_controlled(r, s, field, &v))
            continue;
        for (size_t i = 0; i < (strchr(field->path, '[') ? schema_items(field) : 1); i++) {
            char path[128];
            const double is = completed(r, s, field, &v, schema_number(field, &v, i)),
                         usual = isnan(field->fallback) ? 0 : field->fallback;
            schema_item_path(field, i, path);
            if (isnan(is) || (field->quiet && is == usual) || is_varied(r, s, path))
                continue;
            if (field->type == FIELD_WORDS)
                add_contacts(p, s->scene, path, (int)is);
            else if (field->type == FIELD_WORD)
                add_word(p, path,
                         is >= 0 && is < (double)field->word_count ? field->words[(size_t)is]
                                                                   : "unknown");
            else
                add_number(p, path, is, field->unit);
        }
    }
}

bool summary_fields(const struct summary *summary)
{
    const struct scenario *const s = summary->r->read;
    char *text = NULL;
    size_t size;
    struct schema *own = NULL;
    struct paragraphs p = {.fixed = json_object(), .text = open_memstream(&text, &size)};
    const struct schema *const schema = s ? schema_of(s->scene, &s->law, &own) : NULL;
    if (schema && p.text)
        add_fields(summary, schema, &p);
    free(own);
    table_put(summary->facts, "fixed", as_tree(p.fixed));
    if (p.text) {
        fclose(p.text);
        table_put(summary->facts, ".fixed", as_text(text));
    }
    free(text);
    return true;
}
