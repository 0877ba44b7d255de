/* spatial.c - the lists of a spatial model, and its notes. */
#include "spatial.h"

#include "runner/base/command.h"

#include <stdarg.h>
#include <stdlib.h>

static void *or_end(void *room)
{
    if (room)
        return room;
    fputs("stance import: not enough memory\n", stderr);
    exit(EXIT_USAGE);
}

void *spatial_room(size_t count, size_t size)
{
    return or_end(calloc(count + 1, size));
}

/* One of `count` things has room for the next power of two. */
void *spatial_more(void *list, int *count, size_t size)
{
    char *at;
    memcpy(&at, list, sizeof at);
    if ((*count & (*count - 1)) == 0)
        at = or_end(realloc(at, (size_t)(*count ? 2 * *count : 1) * size));
    memcpy(list, &at, sizeof at);
    return memset(at + (size_t)(*count)++ * size, 0, size);
}

void spatial_name(char name[SPATIAL_NAME], const char *text)
{
    snprintf(name, SPATIAL_NAME, "%s", text ? text : "");
}

void spatial_say(const struct spatial_model *model, spatial_message *message, int line,
                 const char *format, ...)
{
    char *const text = message->text;
    va_list arguments;
    snprintf(text, sizeof message->text, line > 0 ? "%.300s:%d: " : "%.300s: ", model->path, line);
    const size_t length = strlen(text);
    va_start(arguments, format);
    vsnprintf(text + length, sizeof message->text - length, format, arguments);
    va_end(arguments);
}

void spatial_begin(struct spatial_model *model, const char *path, const char *format)
{
    *model = (struct spatial_model){.format = format, .path = path};
    spatial_name(model->file, basename(path));
}

void spatial_add_alien(struct spatial_model *model, const char *what, const char *name, int line,
                       bool harmless)
{
    struct spatial_alien *const alien = spatial_add(model, alien, aliens);
    alien->what = what;
    alien->line = line;
    alien->harmless = harmless;
    spatial_name(alien->name, name);
}

void spatial_note(struct spatial_model *model, const char *format, ...)
{
    struct spatial_note note = {.length = 0};
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(note.text, sizeof note.text, format, arguments);
    va_end(arguments);
    for (int i = 0; i < model->notes; i++)
        if (strcmp(model->note[i].text, note.text) == 0)
            return;
    *spatial_add(model, note, notes) = note;
}

void spatial_list(struct spatial_note *list, const char *name)
{
    char *const end = list->text + list->length;
    const size_t room = sizeof list->text - list->length,
                 taken = strlen(name) + sizeof ", and 1000 more";
    if (list->more == 0 && taken < room)
        list->length += (size_t)snprintf(end, room, "%s%s",
                                         list->length > 0 && end[-1] != ' ' ? ", " : "", name);
    else
        snprintf(end, room, " and %d more", ++list->more);
}

void spatial_note_of(struct spatial_model *model, const char *what, const char *name)
{
    char begin[300];
    const int length = snprintf(begin, sizeof begin, "%.280s: ", what);
    int n = 0;
    while (n < model->notes && strncmp(model->note[n].text, begin, (size_t)length) != 0)
        n++;
    if (n == model->notes)
        spatial_note(model, "%s", begin);
    struct spatial_note *const note = &model->note[n];
    note->length = note->length > 0 ? note->length : (size_t)length;
    name = name[0] ? name : "one without a name";
    for (const char *at = note->text; (at = strstr(at, name)) != NULL; at++)
        if (at > note->text && at[-1] == ' ' && strchr(",", at[strlen(name)]))
            return;
    spatial_list(note, name);
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
