/* tree_text.c - the tables of a tree as C: see tree.h. */
#include "tree.h"

#include <stdarg.h>
#include <stdio.h>

static void write(char **end, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void write(char **end, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    *end += vsprintf(*end, format, arguments); // NOLINT: room is counted, see STANCE_TREE_TEXT
    va_end(arguments);
}

static void write_row(char **end, const int *row, int n)
{
    for (int i = 0; i < n; i++)
        write(end, "%s%d", i ? ", " : "{", row[i]);
    write(end, n ? "}" : "{0}");
}

static void write_list(char **end, const char *name, const int *list, int n)
{
    write(end, "static const int %s[] = ", name);
    write_row(end, list, n);
    write(end, ";\n");
}

static void write_table(char **end, const char *name, int rows, int columns,
                        const int table[][STANCE_MAX_ANGLES])
{
    write(end, "static const int %s[][%d] = {", name, TREE_SLOTS(columns));
    for (int i = 0; i < TREE_SLOTS(rows); i++) {
        write(end, i ? ", " : "");
        write_row(end, table[i], columns);
    }
    write(end, "};\n");
}

void stance_tree_text(const stance_tree *t, bool servos, char text[STANCE_TREE_TEXT])
{
    char *end = text;
    const struct {
        const char *name;
        int value;
    } count[] = {{"BASE", t->base},         {"ANGLES", t->angles},
                 {"CONTACTS", t->contacts}, {"ACTUATORS", t->actuators},
                 {"SPRINGS", t->springs},   {"ROTORS", t->rotors},
                 {"POINTS", t->points},     {"TURNS", t->turns},
                 {"PUSHES", t->pushes},     {"SERVOS", servos && t->actuators > 0},
                 {"SLIDES", t->slides},     {"PLATES", t->plates > 0}};
    for (size_t i = 0; i < sizeof count / sizeof *count; i++)
        write(&end, "#define TREE_%s %d\n", count[i].name, count[i].value);
    write_list(&end, "tree_above", t->above, t->angles);
    write_list(&end, "tree_slide", t->slide, t->angles);
    write_list(&end, "tree_sliding", t->sliding, t->slides);
    write_list(&end, "tree_straight", t->straight, t->angles);
    write_list(&end, "tree_straight_joint", t->straight_joint, t->angles);
    write_list(&end, "tree_straight_end", t->straight_end, t->contacts);
    write_list(&end, "tree_alone", t->alone, t->angles);
    write_list(&end, "tree_carries", t->carries, t->angles);
    write_list(&end, "tree_kind", t->kind, t->contacts);
    write_list(&end, "tree_body", t->body, t->contacts);
    write_list(&end, "scene_other", t->other, t->contacts);
    write_list(&end, "scene_grip", t->grip, t->contacts);
    write_list(&end, "tree_rough", t->rough, t->contacts);
    write_list(&end, "tree_top", t->top, t->contacts);
    write_list(&end, "tree_point_top", t->point_top, t->points);
    write_list(&end, "tree_actuator", t->actuator, t->actuators);
    write_list(&end, "tree_spring", t->spring, t->springs);
    write_list(&end, "tree_rotor", t->rotor, t->rotors);
    write_list(&end, "tree_push_impulse", t->push_impulse, t->pushes);
    write_list(&end, "tree_push_swings", t->push_swings, t->pushes);
    write_list(&end, "tree_turning", t->turning, t->turns);
    write_table(&end, "tree_coupled", t->angles, t->angles, t->coupled);
    write_table(&end, "tree_near", t->angles, t->angles, t->near);
    write_table(&end, "tree_through", t->angles, t->angles, t->through);
    write_table(&end, "tree_path", t->contacts, t->angles, t->path);
    write_table(&end, "tree_loads", t->contacts, t->angles, t->loads);
    write_table(&end, "tree_push_path", t->pushes, t->angles, t->push_path);
    write_table(&end, "tree_point_path", t->points, t->angles, t->point_path);
    write(&end, "#include \"engine/scenes/tree_lanes.h\"\n");
}
