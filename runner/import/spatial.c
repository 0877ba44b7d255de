/* spatial.c - the lists of a spatial model, and its notes. */
#include "spatial.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Lists grow by doubling: one of `count` things has room for the next power of two. */
static void *add(void **list, int *count, size_t size)
{
    if ((*count & (*count - 1)) == 0) {
        void *const more = realloc(*list, (size_t)(*count ? 2 * *count : 1) * size);
        if (!more)
            return NULL;
        *list = more;
    }
    char *const at = (char *)*list + (size_t)(*count)++ * size;
    memset(at, 0, size);
    return at;
}

#define ADD(one, many)                                                                             \
    struct spatial_##one *spatial_add_##one(struct spatial_model *model)                           \
    {                                                                                              \
        void *list = model->one;                                                                   \
        struct spatial_##one *const at = add(&list, &model->many, sizeof *at);                     \
        model->one = list;                                                                         \
        return at;                                                                                 \
    }
ADD(body, bodies)
ADD(joint, joints)
ADD(geom, geoms)
ADD(actuator, actuators)
ADD(alien, aliens)

void spatial_note(struct spatial_model *model, const char *format, ...)
{
    void *list = model->note;
    struct spatial_note *const note = add(&list, &model->notes, sizeof *note);
    va_list arguments;
    model->note = list;
    if (!note)
        return;
    va_start(arguments, format);
    vsnprintf(note->text, sizeof note->text, format, arguments);
    va_end(arguments);
    for (int i = 0; i + 1 < model->notes; i++)
        if (strcmp(model->note[i].text, note->text) == 0) {
            model->notes--;
            break;
        }
}

void spatial_free(struct spatial_model *model)
{
    free(model->body);
    free(model->joint);
    free(model->geom);
    free(model->actuator);
    free(model->alien);
    free(model->note);
    *model = (struct spatial_model){.format = model->format};
}
