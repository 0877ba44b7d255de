/* faces.c - see faces.h. */
#include "faces.h"

#include "runner/base/message.h"

#include <math.h>
#include <string.h>

static bool is_scale(const char *path)
{
    return strcmp(path, "initial.offset.scale") == 0;
}

static void add(struct faces *faces, const struct results_axis *of, int axis, bool sampled)
{
    struct faces_start start = {of, axis, sampled, {INFINITY, -INFINITY}};
    for (size_t i = 0; i < of->count; i++) {
        if (isfinite(of->value[i])) {
            start.end[0] = fmin(start.end[0], of->value[i]);
            start.end[1] = fmax(start.end[1], of->value[i]);
        }
    }
    if (start.end[0] < start.end[1] && faces->starts < FACES_STARTS)
        faces->start[faces->starts++] = start;
}

void faces_make(struct faces *faces, const struct results *r, const int *without, int count)
{
    bool scaled = false;
    *faces = (struct faces){.r = r};
    for (int a = 0; !r->single && a < r->axes; a++) {
        bool wanted = scenario_is_start(r->axis[a].name) || is_scale(r->axis[a].name);
        for (int k = 0; k < count; k++)
            wanted = wanted && without[k] != a;
        if (wanted && !r->axis[a].word)
            add(faces, &r->axis[a], a, false);
        scaled = scaled || (is_scale(r->axis[a].name) && r->axis[a].count > 1);
    }
    for (int k = 0; k < r->varied && !scaled && strcmp(r->method, "sphere") != 0; k++)
        if (scenario_is_start(r->vary[k].of.name) && !r->vary[k].word)
            add(faces, &r->vary[k].of, r->sample, true);
}

face_set faces_at(const struct faces *faces, const size_t *point)
{
    face_set set = 0;
    for (int k = 0; k < faces->starts; k++) {
        const struct faces_start *start = &faces->start[k];
        const double value = start->of->value[point[start->axis]];
        const double margin = start->sampled ? FACES_MARGIN * (start->end[1] - start->end[0]) : 0;
        if (value <= start->end[0] + margin && !is_scale(start->of->name))
            set |= (face_set)1 << 2 * k;
        if (value >= start->end[1] - margin)
            set |= (face_set)2 << 2 * k;
    }
    return set;
}

face_set faces_cut(const struct faces *faces, enum results_kind kind)
{
    face_set set = 0;
    for (uint64_t i = 0; faces->starts > 0 && i < faces->r->cases; i++) {
        if (faces->r->kind[i] == kind) {
            size_t point[SCENARIO_MAX_AXES];
            results_point(faces->r, i, point);
            set |= faces_at(faces, point);
        }
    }
    return set;
}

/* " = -0.12 rad", or nothing of a sample. */
static void end_text(const struct faces_start *start, int upper, char *text, size_t size)
{
    const bool unit = start->of->unit[0] && strcmp(start->of->unit, "1") != 0;
    char number[64];
    results_number_text(start->end[upper], 0, number, sizeof number);
    snprintf(text, size, " = %s%s%s", number, unit ? " " : "", unit ? start->of->unit : "");
    text[0] = start->sampled ? '\0' : text[0];
}

void faces_text(const struct faces *faces, face_set set, char *text, size_t size)
{
    static const char *const words[] = {"", "lower end", "upper end", "both ends"};
    text[0] = '\0';
    for (int k = 0; k < faces->starts; k++) {
        const struct faces_start *start = &faces->start[k];
        const int ends = (int)(set >> 2 * k & 3);
        char low[96] = "", high[96] = "";
        if (ends == 0)
            continue;
        if (ends & 1)
            end_text(start, 0, low, sizeof low);
        if (ends & 2)
            end_text(start, 1, high, sizeof high);
        add_text(text, size, "%s%s%s%s%s (%s)", text[0] ? ", " : "", start->of->name, low,
                 low[0] && high[0] ? " and" : "", high + (low[0] && high[0] ? 2 : 0), words[ends]);
    }
}

void faces_marks(const struct faces *faces, face_set set, char *text, size_t size)
{
    text[0] = '\0';
    for (int k = 0; k < faces->starts; k++) {
        const int ends = (int)(set >> 2 * k & 3);
        const char *name = faces->start[k].of->name, *dot = strrchr(name, '.');
        if (ends)
            add_text(text, size, "%s%s%s%s", text[0] ? ", " : "", dot ? dot + 1 : name,
                     ends & 1 ? "-" : "", ends & 2 ? "+" : "");
    }
}

json_t *faces_json(const struct faces *faces, face_set set)
{
    json_t *list = json_array();
    for (int bit = 0; bit < 2 * faces->starts; bit++) {
        const struct faces_start *start = &faces->start[bit / 2];
        if (set >> bit & 1)
            json_array_append_new(list, json_pack("{s:s, s:s, s:f}", "path", start->of->name, "end",
                                                  bit % 2 ? "upper" : "lower", "at",
                                                  start->end[bit % 2]));
    }
    return list;
}
