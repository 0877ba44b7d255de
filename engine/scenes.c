/* scenes.c - the scenes there are, and the texts of errors. */
#include "tree.h"

#include <string.h>

void stance_robot_fallback(const stance_scene *scene, double *robot)
{
    memset(robot, 0, sizeof(double[STANCE_MAX_ROBOT]));
    for (int i = 0; i < scene->robot_count; i++)
        robot[i] = scene->robot[i].fallback;
    robot[STANCE_ROBOT_GRAVITY] = STANCE_GRAVITY;
    robot[STANCE_ROBOT_FALL_HEIGHT] = STANCE_FALL_HEIGHT;
}

void stance_case_robot(const stance_scene *scene, stance_case *c)
{
    stance_tree_numbers_make(scene->tree, scene->mechanism, c->robot, &c->body);
    c->tree = scene->tree;
    c->scene = scene;
    for (int k = 0; k < scene->contacts; k++) /* stops are no ground */
        c->contacts |= scene->grip[k] < 0 ? 1u << k : 0;
}

const stance_scene *stance_scene_find(const char *name)
{
    for (const stance_scene *const *scene = stance_scenes(); *scene; scene++)
        if (strcmp((*scene)->name, name) == 0)
            return *scene;
    return NULL;
}

/* Binomial coefficient. */
static int choices(int n, int k)
{
    int count = 1;
    for (int i = 0; i < k; i++)
        count = count * (n - i) / (i + 1);
    return k > n ? 0 : count;
}

bool stance_selection(const stance_scene *scene, int index, int *coordinate)
{
    const int n = scene->coordinates, m = scene->actuators;
    if (m == 0 || index < 0 || index >= choices(n, m))
        return false;
    for (int i = 0, k = 0; k < m; i++) { /* those that begin with i, or go on without it */
        const int with = choices(n - i - 1, m - k - 1);
        if (index < with)
            coordinate[k++] = i;
        else
            index -= with;
    }
    return true;
}

const char *stance_error_text(stance_error error)
{
    static const char *const texts[] = {
#define ERROR_TEXT(name, text) [STANCE_##name] = text,
        STANCE_ERRORS(ERROR_TEXT)
#undef ERROR_TEXT
    };
    const size_t count = sizeof texts / sizeof texts[0];
    return (size_t)error < count ? texts[error] : "unknown error";
}
