/* scenario_check.c - what the keys of a scenario mean for each other: keys that are missing, that
 * have no meaning beside others, or that contradict each other.
 */
#include "mechanism.h"
#include "reader.h"

#include <math.h>
#include <string.h>

#define MOST_STEPS 1e15 /* of one case; resolve.c has the same limit */

/* ---- what the scenario is -------------------------------------------------------------------- */

enum { USE_TEXT = 200 };

struct situation {
    bool law_known, start_known;
    const stance_law *law, *far;
    unsigned designs;                  /* that controller.design takes, base or swept, a bit each */
    bool from_equilibrium, from_state; /* at most one, or the start is in doubt */
};

/* Whether a path or one below it is swept; or perhaps misspelt. */
static bool any_below(struct reader *r, const char *prefix, bool misspelt)
{
    size_t length = strlen(prefix);
    bool any = false;
    for (size_t i = 0; i < r->schema->count; i++) {
        const char *path = r->schema->field[i].path;
        if (strncmp(path, prefix, length) == 0 && (path[length] == '.' || !path[length]))
            any |= misspelt ? r->seen[i].excused : r->seen[i].swept;
    }
    return any;
}

/* Whether neither a key nor a mapping around it is bad, or perhaps misspelt. */
static bool is_sound(struct reader *r, const char *key)
{
    char path[96];
    snprintf(path, sizeof path, "%s", key);
    for (char *end = path; end; end = strrchr(path, '.')) {
        *end = end == path ? *end : '\0';
        const struct seen *const seen = reader_seen(r, path);
        if (seen->bad || seen->excused || (seen->swept && r->axes_bad))
            return false;
    }
    return true;
}

static struct situation find_situation(struct reader *r)
{
    struct scenario_values *const base = &r->s->base;
    struct situation is = {.law = scenario_law(base), .far = scenario_far(base)};

    is.law_known = is_sound(r, "controller.kind");
    for (int d = 0; d <= DESIGN_GAINS; d++)
        is.designs |=
            scenario_takes(r->s, offsetof(struct scenario_values, design), d) ? 1u << d : 0;
    is.from_equilibrium = reader_seen(r, "initial.equilibrium")->node != NULL;
    is.from_state = reader_seen(r, "initial.state")->node != NULL;
    if (!is.from_equilibrium && !is.from_state) {
        is.from_equilibrium = any_below(r, "initial.equilibrium", false);
        is.from_state = !is.from_equilibrium && any_below(r, "initial.state", false);
    }
    is.start_known = is_sound(r, "initial") && !any_below(r, "initial", true) &&
                     is.from_equilibrium != is.from_state;
    base->state_given = is.from_state;
    base->equilibrium.given = is.from_equilibrium;
    return is;
}

/* ---- what keys are used with ----------------------------------------------------------------- */

/* Whether what decides about a use is known. */
static bool is_known(struct reader *r, const struct situation *is, enum field_use use)
{
    const bool start = use == USE_EQUILIBRIUM || use == USE_STATE;
    return use == USE_ALWAYS || ((start ? is->start_known : is_sound(r, schema_uses[use].key)) &&
                                 (use != USE_LAW || is_sound(r, "controller.far")) &&
                                 is_known(r, is, schema_uses[use].within));
}

/* Whether some case allows a use. */
static bool is_allowed(struct reader *r, const struct situation *is, enum field_use use, int law)
{
    const enum doe_method method = r->s->sample.design.method;
    int *const design = &r->s->base.design, kept = *design;
    bool allowed = false;
    if (use == USE_SALTELLI || use == USE_MORRIS)
        return !r->s->sample.given || method == DOE_METHODS ||
               method == (use == USE_MORRIS ? DOE_MORRIS : DOE_SALTELLI);
    if (use == USE_SHARES || use == USE_UNSOUGHT)
        return use == USE_SHARES ? r->s->search.aim != AIM_NEAREST : !r->s->search.given;
    for (*design = 0; *design <= DESIGN_GAINS; ++*design)
        allowed |= (is->designs >> *design & 1) && schema_allows(use, law, &r->s->base);
    *design = kept;
    return allowed;
}

/* What the key that decides about a use is here. */
static const char *word_here(struct reader *r, const char *key)
{
    const struct scenario_field *const field = schema_find(r->schema, key);
    const struct tree_node *const node = reader_seen(r, key)->node;
    for (int i = 0; field && field->offset != NO_OFFSET && i < (int)field->word_count; i++)
        if (scenario_takes(r->s, field->offset, i))
            return field->words[i];
    return node && node->kind == TREE_SCALAR ? node->text : key;
}

/* Whether a use is not allowed; then `text` says so. */
static bool is_misused(struct reader *r, const struct situation *is, enum field_use use, int law,
                       char text[USE_TEXT])
{
    const struct schema_use *const u = &schema_uses[use];
    if (u->within && is_misused(r, is, u->within, law, text))
        return true;
    if (!is_known(r, is, use) || is_allowed(r, is, use, law))
        return false;
    snprintf(text, USE_TEXT, "is used only %s%s (here: %.96s)",
             u->needs ? u->needs : "with controller.kind ",
             u->needs ? "" : stance_laws()[law]->name, word_here(r, u->key));
    return true;
}

static void check_uses(struct reader *r, const struct situation *is)
{
    char text[USE_TEXT], name[AXIS_NAME];
    for (size_t i = 0; i < r->schema->count; i++) {
        const struct scenario_field *field = &r->schema->field[i],
                                    *in = schema_parent(r->schema, field);
        if (r->seen[i].node && !(in && in->use == field->use && in->law == field->law) &&
            is_misused(r, is, field->use, field->law, text))
            problem_add(&r->problems, r->seen[i].key, "%s %s", field->path, text);
    }
    for (int a = 0; a <= r->s->axes; a++) {
        const bool sought = a == r->s->axes;
        const struct scenario_axis *const axis = sought ? &r->s->search.axis : &r->s->axis[a];
        for (int k = 0; k < axis->paths; k++) {
            const struct swept_field *swept = sought ? &r->sought[k] : &r->swept[a][k];
            if (is_misused(r, is, swept->field->use, swept->field->law, text))
                problem_add(&r->problems, swept->mark, "%s: %s %s",
                            sought ? "optimise.vary" : axis_key(r->s, a, name), axis->path[k],
                            text);
        }
    }
}

/* ---- keys that are missing ------------------------------------------------------------------- */

static void check_required(struct reader *r, const struct situation *is)
{
    for (size_t i = 0; i < r->schema->count; i++) {
        const struct scenario_field *field = &r->schema->field[i],
                                    *in = schema_parent(r->schema, field);
        char text[USE_TEXT];
        if (!field->required || field->type == FIELD_MAP || !is_known(r, is, field->use) ||
            reader_given(&r->seen[i]) ||
            (in && !in->required && !field->use && !reader_seen(r, in->path)->node) ||
            is_misused(r, is, field->use, field->law, text) || !is_sound(r, field->path))
            continue;
        const char *const needs = field->use == USE_LAW ? stance_laws()[field->law]->name
                                  : field->use ? schema_uses[field->use].needs + strlen("with ")
                                               : "";
        reader_refuse(r, field->path, needs[0] ? " is missing (%s needs it)" : " is missing",
                      needs);
    }
}

/* ---- equilibria ------------------------------------------------------------------------------ */

/* What a mechanism stands on: a state in which it stands has no translation of its own. */
static void check_standing(struct reader *r, const struct situation *is)
{
    static const char *const translation[] = {"initial.state.x", "initial.state.z",
                                              "initial.state.vx", "initial.state.vz"};
    const stance_scene *const scene = r->s->scene;
    const struct seen *const support = reader_seen(r, "initial.support");
    if (scenario_numbers_feet(scene))
        return;
    r->s->base.support_foot = 0;
    if (support->node && scene->mechanism->body[0].joint != STANCE_FREE) {
        reader_refuse(r, "initial.support", ": the root %s is not free: nothing has to carry it",
                      scene->mechanism->body[0].name);
    } else if (!support->node && is->from_equilibrium && scene->mechanism->elements > 0 &&
               scene->mechanism->body[0].joint == STANCE_FREE) {
        r->s->base.support = (int)mechanism_contacts(scene, 1);
    }
    for (int i = 0; support->node && is->from_state && i < 4; i++)
        if (reader_given(reader_seen(r, translation[i])))
            reader_refuse(r, translation[i],
                          ": with initial.support it follows from what the robot stands on");
}

static void check_start(struct reader *r, const struct situation *is)
{
    const struct seen *state = reader_seen(r, "initial.state"),
                      *equilibrium = reader_seen(r, "initial.equilibrium");

    if (state->node && equilibrium->node) {
        problem_add(&r->problems,
                    mark_compare(state->key, equilibrium->key) > 0 ? state->key : equilibrium->key,
                    "initial.state and initial.equilibrium exclude each other");
        return;
    }
    if (!is_sound(r, "initial") || any_below(r, "initial", true))
        return;
    if (!is->from_state && !is->from_equilibrium) {
        reader_refuse(r, "initial",
                      schema_find(r->schema, "initial.equilibrium")
                          ? ": give an equilibrium or a state"
                          : ": give a state");
        return;
    }
    if (is->from_equilibrium && !reader_seen(r, "initial.support_foot")->node)
        r->s->base.support_foot = 1;
    check_standing(r, is);
}

static void check_controller(struct reader *r, const struct situation *is)
{
    struct scenario_values *base = &r->s->base;

    if (!is->law_known)
        return;
    if (is->law != stance_laws()[0] && r->s->scene->actuators == 0)
        reader_refuse(r, "controller.kind", ": the scene %s has no actuators", r->s->scene->name);
    if (!is->law->designed)
        return;
    const struct seen *const target = reader_seen(r, "controller.equilibrium");
    base->design_point.given = target->node || target->bad || /* or may be there */
                               any_below(r, "controller.equilibrium", false) ||
                               any_below(r, "controller.equilibrium", true);
    if (!base->design_point.given && is->start_known && !is->from_equilibrium) {
        reader_refuse(r, "controller.equilibrium",
                      " is missing: %s needs one where the run does not begin at one",
                      is->law->name);
    }
    for (int a = 0; a < r->s->axes; a++) {
        for (int k = 0; k < r->s->axis[a].paths; k++) {
            const size_t pole =
                (r->s->axis[a].offset[k] - offsetof(struct scenario_values, pole_re)) /
                sizeof(double);
            char name[AXIS_NAME];
            if (pole < SCENARIO_MAX_POLES && base->pole_im[pole] != 0)
                problem_add(&r->problems, r->swept[a][k].mark,
                            "%s: %s is complex; only a real pole can be swept",
                            axis_key(r->s, a, name), r->s->axis[a].path[k]);
        }
    }
}

/* ---- numbers that must fit each other -------------------------------------------------------- */

/* Whether some case asks for a sample time by a field. */
static bool asks_samples(const struct reader *r, const struct scenario_field *field)
{
    double least, largest;
    int k;
    if (!scenario_axis_of(r->s, field->offset, &k))
        return schema_samples(field, &r->s->base);
    scenario_extent(r->s, field->offset, &least, &largest);
    return least != field->fallback || largest != field->fallback;
}

/* What has a meaning only where the controller samples. Gains designed for the sampled model
 * differ with the sample time. */
static void check_sampling(struct reader *r, const struct situation *is)
{
    const size_t time = offsetof(struct scenario_values, sample_time);
    double shortest, longest;
    char text[USE_TEXT];
    int k;

    if (!is->law_known || r->axes_bad || !is_sound(r, "controller.sample_time"))
        return;
    scenario_extent(r->s, time, &shortest, &longest);
    const struct scenario_axis *const axis = scenario_axis_of(r->s, time, &k);
    for (size_t i = 0; i < r->schema->count; i++) {
        const struct scenario_field *const field = &r->schema->field[i];
        if (!field->samples || r->seen[i].bad || !asks_samples(r, field) ||
            is_misused(r, is, field->use, field->law, text))
            continue;
        if (axis && field->offset == offsetof(struct scenario_values, design_time))
            r->s->axis[axis - r->s->axis].design = true;
        if (shortest <= 0)
            reader_refuse(r, field->path, " needs controller.sample_time > 0: %s", field->samples);
    }
}

/* Robust placement gives every pole an eigenvector of its own, from as many directions as there
 * are inputs. Axes may still make poles coincide: then the design of that point fails. */
static void check_multiplicity(struct reader *r, const struct situation *is)
{
    const struct seen *poles = reader_seen(r, "controller.poles");
    const struct scenario_values *base = &r->s->base;
    const size_t most = (size_t)r->s->scene->actuators;

    if (!is->law->designed || !is_sound(r, "controller.design") ||
        !(is->designs >> DESIGN_PLACE & 1) || !poles->node || poles->bad)
        return;
    for (size_t n = 0; n < poles->node->count; n++) {
        char path[96], before[96];
        const size_t i = reader_pole(r, poles->node, n, path);
        size_t times = 1;
        for (size_t m = 0; m < n; m++) {
            const size_t k = reader_pole(r, poles->node, m, before);
            times += base->pole_re[k] == base->pole_re[i] && base->pole_im[k] == base->pole_im[i];
        }
        if (times > most) {
            char word[SHOWN_SIZE];
            problem_add(&r->problems, poles->node->item[n]->mark,
                        "%s: %s stands here %zu times; controller.design place "
                        "can repeat a pole as often as there are actuators, %zu times",
                        path, shown(word, poles->node->item[n]->text), times, most);
            return;
        }
    }
}

static void check_steps(struct reader *r)
{
    double least_time, time, step, largest_step;

    if (r->axes_bad || !reader_given(reader_seen(r, "stop.time")) ||
        reader_seen(r, "stop.time")->bad || reader_seen(r, "method.step")->bad)
        return;
    scenario_extent(r->s, offsetof(struct scenario_values, stop_time), &least_time, &time);
    scenario_extent(r->s, offsetof(struct scenario_values, step), &step, &largest_step);
    if (time / step > MOST_STEPS)
        reader_refuse(r, "stop.time", ": more than %.0e steps of method.step", MOST_STEPS);
}

/* The foot that the robot starts on must be able to carry it. */
static void check_support(struct reader *r, const struct situation *is)
{
    const struct scenario *s = r->s;
    if (!is->from_equilibrium || !scenario_numbers_feet(s->scene) || r->axes_bad ||
        reader_seen(r, "ground.contacts")->bad || reader_seen(r, "initial.support_foot")->bad)
        return;
    for (int foot = 1; foot <= s->scene->contacts; foot++) {
        if (!(s->base.contacts >> (foot - 1) & 1) &&
            scenario_takes(r->s, offsetof(struct scenario_values, support_foot), foot)) {
            reader_refuse(r, "ground.contacts", ": %s, the support foot, is not among them",
                          s->scene->contact_name[foot - 1]);
        }
    }
}

/* The contacts of a mechanism: those that it stands on must be able to carry it, and the stops of
 * its joints are none of the ground's. */
static void check_contacts(struct reader *r)
{
    const stance_scene *const scene = r->s->scene;
    const stance_mechanism *const m = scene->mechanism;
    struct scenario_values *const base = &r->s->base;
    for (int e = 0; e < m->elements && !reader_seen(r, "ground.contacts")->bad; e++) {
        const int contacts = (int)mechanism_contacts(scene, UINT32_C(1) << e);
        if ((base->support & contacts) && !(base->contacts & contacts))
            reader_refuse(r, "ground.contacts",
                          ": %s, which is to carry the robot, is not among them",
                          m->element[e].name);
    }
    base->contacts |= ((1 << scene->contacts) - 1) & ~(int)mechanism_contacts(scene, UINT32_MAX);
}

/* To be ahead takes two feet. */
static void check_lands(struct reader *r)
{
    const stance_scene *const scene = r->s->scene;
    int feet = 0;
    if (r->axes_bad || reader_seen(r, "ground.contacts")->bad ||
        !scenario_takes(r->s, offsetof(struct scenario_values, lands_ahead), 1))
        return;
    for (int c = 0; c < scene->contacts; c++)
        feet += scene->grip[c] == c && (r->s->base.contacts >> c & 1);
    if (feet < 2)
        reader_refuse(r, "ground.lands",
                      ": ahead needs two contacts that may touch the ground, there %s %d",
                      feet == 1 ? "is" : "are", feet);
}

void scenario_cross_check(struct reader *r)
{
    struct situation is = find_situation(r);

    check_required(r, &is);
    check_uses(r, &is);
    check_steps(r);
    if (!r->s->scene)
        return;
    check_start(r, &is);
    check_controller(r, &is);
    check_multiplicity(r, &is);
    check_sampling(r, &is);
    check_support(r, &is);
    check_contacts(r);
    if (r->s->own_scene)
        mechanism_check(r);
    check_lands(r);
    /* Where nothing acts and a run begins at a state no design depends on anything. Of described
     * robots files have had one for each point that makes another robot. */
    const bool none = is.start_known && is.from_state && r->s->scene->actuators == 0 &&
                      r->s->scene->mechanism->carried;
    for (int a = 0; a < r->s->axes && none; a++)
        r->s->axis[a].design = false;
    for (size_t i = 0; i < r->misfits; i++)
        named_misfit(r, &r->misfit[i]);
    search_check(r);
}
