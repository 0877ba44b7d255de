/* scenario_check.c - what the keys of a scenario mean for each other: keys that are missing, that
 * have no meaning beside others, or that contradict each other.
 */
#include "mechanism.h"
#include "reader.h"

#include <math.h>
#include <string.h>

#define MOST_STEPS 1e15 /* of one case; resolve.c has the same limit */

/* ---- what the scenario is -------------------------------------------------------------------- */

struct situation {
    bool law_known, design_known;
    const stance_law *law, *far;
    bool places, regulates, gives_gains; /* controller.design, base or swept */
    bool places_robustly, models;
    bool from_equilibrium, from_state; /* at most one, or the start is in doubt */
    bool start_known;
    bool settles;
};

static bool any_below(struct reader *r, const char *prefix, bool (*test)(const struct seen *))
{
    size_t length = strlen(prefix);
    for (size_t i = 0; i < r->schema->count; i++) {
        const char *path = r->schema->field[i].path;
        if (strncmp(path, prefix, length) == 0 && (path[length] == '.' || !path[length]) &&
            test(&r->seen[i]))
            return true;
    }
    return false;
}

static bool is_swept(const struct seen *seen)
{
    return seen->swept;
}

static bool is_excused(const struct seen *seen)
{
    return seen->excused;
}

static bool takes_word(const struct reader *r, size_t offset, int word)
{
    const struct scenario *s = r->s;
    int base, k;
    const struct scenario_axis *axis = scenario_axis_of(s, offset, &k);

    for (size_t i = 0; axis && axis->value && i < axis->count; i++)
        if ((int)scenario_axis_value(axis, i, k) == word)
            return true;
    memcpy(&base, (const char *)&s->base + offset, sizeof base);
    return !(axis && axis->value) && base == word;
}

static struct situation find_situation(struct reader *r)
{
    const size_t design = offsetof(struct scenario_values, design);
    const struct seen *controller = reader_seen(r, "controller"),
                      *initial = reader_seen(r, "initial");
    struct situation is = {.law = scenario_law(&r->s->base), .far = scenario_far(&r->s->base)};

    is.law_known = !controller->bad && !controller->excused &&
                   !reader_seen(r, "controller.kind")->bad &&
                   !reader_seen(r, "controller.kind")->excused;
    is.design_known = !reader_seen(r, "controller.design")->bad &&
                      !reader_seen(r, "controller.design")->excused &&
                      !(reader_seen(r, "controller.design")->swept && r->axes_bad);
    is.places_robustly = takes_word(r, design, DESIGN_PLACE);
    is.places = is.places_robustly || takes_word(r, design, DESIGN_PLACE_SCHUR);
    is.regulates = takes_word(r, design, DESIGN_LQR);
    is.models = is.places || is.regulates;
    is.gives_gains = takes_word(r, design, DESIGN_GAINS);
    is.from_equilibrium = reader_seen(r, "initial.equilibrium")->node != NULL;
    is.from_state = reader_seen(r, "initial.state")->node != NULL;
    if (!is.from_equilibrium && !is.from_state) {
        is.from_equilibrium = any_below(r, "initial.equilibrium", is_swept);
        is.from_state = !is.from_equilibrium && any_below(r, "initial.state", is_swept);
    }
    is.start_known = !initial->bad && !initial->excused && !any_below(r, "initial", is_excused) &&
                     is.from_equilibrium != is.from_state;
    is.settles = r->s->base.settle != 0;
    return is;
}

/* Whether no controller.design is of the use; then *instead is one that there is. */
static bool design_misfits(const struct reader *r, const struct situation *is, enum field_use use,
                           const char **instead)
{
    const struct scenario_field *design = schema_find(r->schema, "controller.design");
    const bool fits = use == USE_PLACE   ? is->places
                      : use == USE_LQR   ? is->regulates
                      : use == USE_MODEL ? is->models
                                         : is->gives_gains;
    if (!is->design_known || fits)
        return false;
    *instead = "others";
    for (size_t i = design ? design->word_count : 0; i-- > 0;)
        if (takes_word(r, offsetof(struct scenario_values, design), (int)i))
            *instead = design->words[i];
    return true;
}

/* Why a field must not be given or swept, as what would be needed and what there is instead; NULL:
 * it may be. */
static const char *obstacle(const struct reader *r, const struct situation *is,
                            const struct scenario_field *field, const char **instead)
{
    const stance_law *const none = stance_laws()[0], *const own = stance_laws()[field->law];
    const bool other = is->law_known && !is->law->designed;
    bool misfits = false;
    *instead = schema_find(r->schema, "controller.kind")->words[r->s->base.law];
    switch (field->use) {
    case USE_CONTROL:
        misfits = is->law_known && is->law == none;
        break;
    case USE_LAW:
        return is->law_known && is->law != own && is->far != own ? r->schema->kind_of[field->law]
                                                                 : NULL;
    case USE_FAR:
        misfits = is->law_known && is->far == none;
        break;
    case USE_FEEDBACK:
        misfits = other;
        break;
    case USE_PLACE:
    case USE_LQR:
    case USE_MODEL:
    case USE_GAINS:
        if (other)
            return schema_use_text[USE_FEEDBACK];
        misfits = design_misfits(r, is, field->use, instead);
        break;
    case USE_EQUILIBRIUM:
    case USE_STATE:
        *instead = schema_use_text[field->use == USE_STATE ? USE_EQUILIBRIUM : USE_STATE];
        misfits =
            is->start_known && !(field->use == USE_STATE ? is->from_state : is->from_equilibrium);
        break;
    case USE_SETTLE:
        *instead = "off";
        misfits = !is->settles;
        break;
    default:
        break;
    }
    return misfits ? schema_use_text[field->use] : NULL;
}

/* ---- keys that have no meaning here ---------------------------------------------------------- */

/* Whether the mapping that a field stands in is subject to the same condition. */
static bool parent_has_use(const struct reader *r, const struct scenario_field *field)
{
    char path[sizeof field->path];
    snprintf(path, sizeof path, "%s", field->path);
    char *dot = strrchr(path, '.');
    if (!dot)
        return false;
    *dot = '\0';
    const struct scenario_field *parent = schema_find(r->schema, path);
    return parent && parent->use == field->use && parent->law == field->law;
}

static void check_uses(struct reader *r, const struct situation *is)
{
    const char *needed, *instead;
    for (size_t i = 0; i < r->schema->count; i++) {
        const struct scenario_field *field = &r->schema->field[i];
        if (!r->seen[i].node || parent_has_use(r, field))
            continue;
        needed = obstacle(r, is, field, &instead);
        if (needed) {
            problem_add(&r->problems, r->seen[i].key, "%s is used only with %s (here: %s)",
                        field->path, needed, instead);
        }
    }
    for (int a = 0; a <= r->s->axes; a++) {
        const bool sought = a == r->s->axes;
        const struct scenario_axis *const axis = sought ? &r->s->search.axis : &r->s->axis[a];
        for (int k = 0; k < axis->paths; k++) {
            const struct swept_field *swept = sought ? &r->sought[k] : &r->swept[a][k];
            needed = obstacle(r, is, swept->field, &instead);
            if (needed) {
                char name[AXIS_NAME];
                problem_add(&r->problems, swept->mark, "%s: %s is used only with %s (here: %s)",
                            sought ? "optimise.vary" : axis_key(r->s, a, name), axis->path[k],
                            needed, instead);
            }
        }
    }
}

/* ---- keys that are missing ------------------------------------------------------------------- */

/* Where to report that a field is missing: the nearest mapping around it. False: that one is bad,
 * so that nothing is known of the field. */
static bool surrounding(struct reader *r, const struct scenario_field *field, struct mark *mark)
{
    char path[sizeof field->path];
    snprintf(path, sizeof path, "%s", field->path);
    for (char *dot; (dot = strrchr(path, '.')) != NULL;) {
        *dot = '\0';
        const struct seen *seen = reader_seen(r, path);
        if (seen->bad || seen->excused)
            return false;
        if (seen->node) {
            *mark = seen->key;
            return true;
        }
    }
    *mark = r->tree.root->mark;
    return true;
}

static void check_required(struct reader *r, const struct situation *is)
{
    static const char *const reason[] = {
        [USE_ALWAYS] = "",
        [USE_FAR] = " (controller.far needs it)",
        [USE_PLACE] = " (controller.design place and place-schur need it)",
        [USE_GAINS] = " (controller.design gains needs it)",
    };
    for (size_t i = 0; i < r->schema->count; i++) {
        const struct scenario_field *field = &r->schema->field[i];
        const char *instead;
        struct mark mark;
        bool known = field->use == USE_ALWAYS || is->law_known;
        if (field->use == USE_PLACE || field->use == USE_GAINS)
            known = known && is->design_known;
        if (!field->required || field->type == FIELD_MAP || !known || r->seen[i].excused ||
            r->seen[i].node || r->seen[i].swept || obstacle(r, is, field, &instead) ||
            !surrounding(r, field, &mark))
            continue;
        if (field->use == USE_LAW)
            problem_add(&r->problems, mark, "%s is missing (%s needs it)", field->path,
                        stance_laws()[field->law]->name);
        else
            problem_add(&r->problems, mark, "%s is missing%s", field->path, reason[field->use]);
    }
}

/* ---- equilibria ------------------------------------------------------------------------------ */

/* Of a scene whose closed forms ask for it all angles but one must be given; `path` is
 * initial.equilibrium or controller.equilibrium. True: the equilibrium is there. */
static bool check_equilibrium(struct reader *r, const char *path)
{
    const struct seen *map = reader_seen(r, path);
    const stance_scene *scene = r->s->scene;
    int given = 0, wanted = scene->postures - 1;
    bool doubtful = map->bad || map->excused;
    struct mark mark = map->key;
    char name[96], list[128];
    const char *names[STANCE_MAX_POSTURE];

    for (int i = 0; i < scene->postures; i++) {
        names[i] = scene->coordinate[scene->posture[i]].name;
        snprintf(name, sizeof name, "%s.%s", path, names[i]);
        const struct seen *angle = reader_seen(r, name);
        given += reader_given(angle);
        doubtful = doubtful || angle->excused;
        if (angle->swept && !map->node)
            mark = angle->sweep;
    }
    snprintf(name, sizeof name, "%s.branch", path);
    if (!map->node && given == 0 && !reader_seen(r, name)->swept)
        return doubtful;
    if (!map->node && given == 0)
        mark = reader_seen(r, name)->sweep;
    if (given != wanted && !doubtful && !scene->mechanism) {
        problem_add(&r->problems, mark, "%s: give %d of %s; %d given", path, wanted,
                    word_list(list, sizeof list, names, (size_t)scene->postures), given);
    }
    return true;
}

/* What a mechanism stands on: a state in which it stands has no translation of its own. */
static void check_standing(struct reader *r, const struct situation *is)
{
    static const char *const translation[] = {"initial.state.x", "initial.state.z",
                                              "initial.state.vx", "initial.state.vz"};
    const stance_scene *const scene = r->s->scene;
    const struct seen *const support = reader_seen(r, "initial.support");
    if (!scene->mechanism)
        return;
    r->s->base.support_foot = 0;
    if (support->node && scene->mechanism->body[0].joint != STANCE_FREE) {
        problem_add(&r->problems, support->key,
                    "initial.support: the root %s is not free: nothing has to carry it",
                    scene->mechanism->body[0].name);
    } else if (!support->node && is->from_equilibrium && scene->mechanism->elements > 0 &&
               scene->mechanism->body[0].joint == STANCE_FREE) {
        r->s->base.support = (int)mechanism_contacts(scene, 1);
    }
    for (int i = 0; support->node && is->from_state && i < 4; i++) {
        const struct seen *const given = reader_seen(r, translation[i]);
        if (reader_given(given))
            problem_add(&r->problems, given->node ? given->key : given->sweep,
                        "%s: with initial.support it follows from what the robot stands on",
                        translation[i]);
    }
}

static void check_start(struct reader *r, const struct situation *is)
{
    const struct seen *state = reader_seen(r, "initial.state"),
                      *equilibrium = reader_seen(r, "initial.equilibrium"),
                      *initial = reader_seen(r, "initial");
    struct scenario_values *base = &r->s->base;

    if (state->node && equilibrium->node) {
        bool later = state->key.set > equilibrium->key.set ||
                     (state->key.set == equilibrium->key.set &&
                      (state->key.line > equilibrium->key.line ||
                       (state->key.line == equilibrium->key.line &&
                        state->key.column > equilibrium->key.column)));
        problem_add(&r->problems, later ? state->key : equilibrium->key,
                    "initial.state and initial.equilibrium exclude each other");
        return;
    }
    if (initial->bad || initial->excused || any_below(r, "initial", is_excused))
        return;
    if (!is->from_state && !is->from_equilibrium) {
        problem_add(&r->problems, initial->node ? initial->key : r->tree.root->mark,
                    schema_find(r->schema, "initial.equilibrium")
                        ? "initial: give an equilibrium or a state"
                        : "initial: give a state");
        return;
    }
    base->state_given = is->from_state;
    base->equilibrium.given = is->from_equilibrium;
    if (is->from_equilibrium) {
        check_equilibrium(r, "initial.equilibrium");
        if (!reader_seen(r, "initial.support_foot")->node)
            base->support_foot = 1;
    }
    check_standing(r, is);
}

static void check_controller(struct reader *r, const struct situation *is)
{
    struct scenario_values *base = &r->s->base;
    const struct seen *kind = reader_seen(r, "controller.kind");

    if (!is->law_known)
        return;
    if (is->law != stance_laws()[0] && r->s->scene->actuators == 0) {
        problem_add(&r->problems, kind->node->mark,
                    "controller.kind: the scene %s has no actuators", r->s->scene->name);
    }
    if (!is->law->designed)
        return;
    base->design_point.given = check_equilibrium(r, "controller.equilibrium");
    if (!base->design_point.given && is->start_known && !is->from_equilibrium) {
        problem_add(
            &r->problems, reader_seen(r, "controller")->key,
            "controller.equilibrium is missing: %s needs one where the run does not begin at "
            "one",
            is->law->name);
    }
    for (int a = 0; a < r->s->axes; a++) {
        for (int k = 0; k < r->s->axis[a].paths; k++) {
            const struct swept_field *swept = &r->swept[a][k];
            const size_t pole =
                (r->s->axis[a].offset[k] - offsetof(struct scenario_values, pole_re)) /
                sizeof(double);
            if (pole < SCENARIO_MAX_POLES && base->pole_im[pole] != 0) {
                char name[AXIS_NAME];
                problem_add(&r->problems, swept->mark,
                            "%s: %s is complex; only a real pole can be swept",
                            axis_key(r->s, a, name), r->s->axis[a].path[k]);
            }
        }
    }
}

/* ---- numbers that must fit each other -------------------------------------------------------- */

static bool samples_in_design(const struct reader *r, const struct situation *is)
{
    return is->law_known && is->law->designed && is->models &&
           takes_word(r, offsetof(struct scenario_values, design_time), DESIGN_SAMPLED);
}

static struct mark where(struct reader *r, const char *path)
{
    const struct seen *seen = reader_seen(r, path);
    return seen->swept ? seen->sweep : seen->node ? seen->key : r->tree.root->mark;
}

/* Is a number of the controller other than without an effect (zero, or no limit) in some case? */
static bool is_on(struct reader *r, const char *path)
{
    const struct scenario_field *const field = schema_find(r->schema, path);
    double least, largest;
    int whole, k;
    if (!field) /* a scene without actuators */
        return false;
    scenario_extent(r->s, field->offset, &least, &largest);
    if (field->type == FIELD_INTEGER && !scenario_axis_of(r->s, field->offset, &k)) {
        memcpy(&whole, (const char *)&r->s->base + field->offset, sizeof whole);
        least = largest = whole;
    }
    return isfinite(field->fallback) ? largest > field->fallback : least < field->fallback;
}

/* What has a meaning only where the controller samples. */
static void check_sampling(struct reader *r, const struct situation *is)
{
    double shortest, longest;
    const struct seen *time = reader_seen(r, "controller.sample_time");
    static const char every[] = "it is new at each sample", acts[] = "it acts on what is sampled";
    static const struct {
        const char *path, *because;
    } sampled[] = {
        {"controller.noise", every},      {"controller.angle_noise", every},
        {"controller.rate_noise", every}, {"controller.delay", "it counts samples"},
        {"controller.lag", acts},         {"controller.torque_rate", acts},
    };

    if (!is->law_known || is->law == stance_laws()[0] || r->axes_bad || time->bad || time->excused)
        return;
    scenario_extent(r->s, offsetof(struct scenario_values, sample_time), &shortest, &longest);
    if (shortest > 0)
        return;
    if (is->law->samples)
        problem_add(&r->problems, reader_seen(r, "controller.kind")->node->mark,
                    "controller.kind %s needs controller.sample_time > 0: %s", is->law->name, acts);
    for (size_t k = 0; k < sizeof sampled / sizeof *sampled; k++)
        if (is_on(r, sampled[k].path) && !reader_seen(r, sampled[k].path)->bad)
            problem_add(&r->problems, where(r, sampled[k].path),
                        "%s needs controller.sample_time > 0: %s", sampled[k].path,
                        sampled[k].because);
    if (samples_in_design(r, is) && !reader_seen(r, "controller.design_time")->bad) {
        problem_add(&r->problems, where(r, "controller.design_time"),
                    "controller.design_time sampled needs controller.sample_time > 0");
    }
}

/* Gains designed for the sampled model differ with the sample time. */
static void mark_sampled_designs(struct reader *r, const struct situation *is)
{
    for (int a = 0; a < r->s->axes; a++) {
        struct scenario_axis *axis = &r->s->axis[a];
        for (int k = 0; k < axis->paths; k++)
            if (axis->offset[k] == offsetof(struct scenario_values, sample_time))
                axis->design = axis->design || samples_in_design(r, is);
    }
}

/* Robust placement gives every pole an eigenvector of its own, from as many directions as there
 * are inputs. Axes may still make poles coincide: then the design of that point fails. */
static void check_multiplicity(struct reader *r, const struct situation *is)
{
    const struct seen *poles = reader_seen(r, "controller.poles");
    const struct scenario_values *base = &r->s->base;
    const size_t most = (size_t)r->s->scene->actuators;

    if (!is->law->designed || !is->design_known || !is->places_robustly || !poles->node ||
        poles->bad)
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

/* What acts far from the target is decided at samples. */
static void check_far(struct reader *r, const struct situation *is)
{
    double shortest, longest;

    if (!is->law_known || is->far == stance_laws()[0] || r->axes_bad ||
        reader_seen(r, "controller.far")->bad || reader_seen(r, "controller.sample_time")->bad ||
        reader_seen(r, "controller.sample_time")->excused)
        return;
    scenario_extent(r->s, offsetof(struct scenario_values, sample_time), &shortest, &longest);
    if (shortest <= 0) {
        problem_add(&r->problems, where(r, "controller.far"),
                    "controller.far needs controller.sample_time > 0: which law acts is decided at "
                    "each sample");
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
    if (time / step > MOST_STEPS) {
        problem_add(&r->problems, where(r, "stop.time"),
                    "stop.time: more than %.0e steps of method.step", MOST_STEPS);
    }
}

/* The foot that the robot starts on must be able to carry it. */
static void check_support(struct reader *r, const struct situation *is)
{
    const struct scenario *s = r->s;
    if (!is->from_equilibrium || s->own_scene || r->axes_bad ||
        reader_seen(r, "ground.contacts")->bad || reader_seen(r, "initial.support_foot")->bad)
        return;
    for (int foot = 1; foot <= s->scene->contacts; foot++) {
        if (!(s->base.contacts >> (foot - 1) & 1) &&
            takes_word(r, offsetof(struct scenario_values, support_foot), foot)) {
            problem_add(&r->problems, where(r, "ground.contacts"),
                        "ground.contacts: %s, the support foot, is not among them",
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
            problem_add(&r->problems, where(r, "ground.contacts"),
                        "ground.contacts: %s, which is to carry the robot, is not among them",
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
        !takes_word(r, offsetof(struct scenario_values, lands), 1))
        return;
    for (int c = 0; c < scene->contacts; c++)
        feet += (!scene->grip || scene->grip[c] == c) && (r->s->base.contacts >> c & 1);
    if (feet < 2)
        problem_add(&r->problems, where(r, "ground.lands"),
                    "ground.lands: ahead needs two contacts that may touch the ground, there %s %d",
                    feet == 1 ? "is" : "are", feet);
}

/* Scenes that are not described have the world that their equations were written for. */
static void check_world(struct reader *r)
{
    static const struct {
        const char *path, *wanted;
    } fixed[] = {
        {"ground.slope", "level ground, 0"},
        {"ground.gravity", "9.81"},
        {"controller.model.slope", "level ground, 0"},
        {"controller.model.gravity", "9.81"},
    };
    for (size_t i = 0; i < sizeof fixed / sizeof fixed[0]; i++) {
        const struct scenario_field *const field = schema_find(r->schema, fixed[i].path);
        const double usual = i % 2 ? STANCE_GRAVITY : 0;
        double least, largest;
        if (!field || !reader_given(reader_seen(r, fixed[i].path)) || r->axes_bad ||
            reader_seen(r, fixed[i].path)->bad)
            continue;
        scenario_extent(r->s, field->offset, &least, &largest);
        if (least != usual || largest != usual)
            problem_add(
                &r->problems, where(r, fixed[i].path),
                "%s: the scene %s knows %s alone; a mechanism has any (scene: mechanism, see "
                "scenarios/mechanisms)",
                fixed[i].path, r->s->scene->name, fixed[i].wanted);
    }
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
    mark_sampled_designs(r, &is);
    check_far(r, &is);
    check_support(r, &is);
    if (r->s->own_scene) {
        check_contacts(r);
        mechanism_check(r);
    } else {
        check_world(r);
    }
    check_lands(r);
    for (size_t i = 0; i < r->misfits; i++)
        named_misfit(r, &r->misfit[i]);
    search_check(r);
}
