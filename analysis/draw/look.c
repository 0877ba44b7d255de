/* look.c - options of pictures. */
#include "look.h"

#include "runner/base/words.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

const char *const look_endings[LOOK_FORMAT_COUNT] = {
#define ENDING(NAME, ending) ending,
    LOOK_FORMATS(ENDING)
#undef ENDING
};

void look_begin(struct look *look)
{
    *look = (struct look){
        .format = {[LOOK_SVG] = true, [LOOK_PNG] = true}, .font = LOOK_FONT, .points = 9};
}

static bool wrong(const struct command *command, const char *option, const char *what,
                  const char *text)
{
    fprintf(stderr, "stance %s: %s %s, not '%.80s' (stance %s -h explains)\n", command->name,
            option, what, text, command->name);
    return false;
}

/* ---- files -------------------------------------------------------------------------------- */

/* Format of a file's name; LOOK_FORMAT_COUNT: it has none of the endings. */
static enum look_format format_of(const char *name, size_t length)
{
    for (int f = 0; f < LOOK_FORMAT_COUNT; f++)
        if (strlen(look_endings[f]) == length && strncmp(name, look_endings[f], length) == 0)
            return (enum look_format)f;
    return LOOK_FORMAT_COUNT;
}

static bool read_formats(const struct command *command, const char *text, struct look *look)
{
    memset(look->format, 0, sizeof look->format);
    for (const char *word = text; word;) {
        const size_t length = strcspn(word, ",");
        const enum look_format format = format_of(word, length);
        if (format >= LOOK_GIF)
            return wrong(command, "--format", "takes svg, png or pdf, or several with commas",
                         text);
        look->format[format] = true;
        word = word[length] ? word + length + 1 : NULL;
    }
    return true;
}

/* Whether an ending is that of a file of another program's format. */
static bool is_other_format(const char *ending)
{
    static const char *const other[] = {"eps",  "ps",  "jpg", "jpeg", "tif", "tiff", "bmp",
                                        "webp", "mp4", "mov", "avi",  "mkv", "webm", "emf"};
    for (size_t k = 0; k < sizeof other / sizeof other[0]; k++)
        if (strcasecmp(ending, other[k]) == 0)
            return true;
    return false;
}

/* A place that ends like a picture is a file, unless there is a directory of that name. */
static bool read_place(const struct command *command, const char *place, bool formatted,
                       struct look *look)
{
    struct stat information;
    const char *slash = strrchr(place, '/'), *name = slash ? slash + 1 : place;
    const char *dot = strrchr(name, '.');
    const enum look_format format =
        dot && dot > name ? format_of(dot + 1, strlen(dot + 1)) : LOOK_FORMAT_COUNT;
    const bool exists = stat(place, &information) == 0 && S_ISDIR(information.st_mode);
    if (!exists && format == LOOK_FORMAT_COUNT && dot && dot > name && is_other_format(dot + 1))
        return wrong(command, "-o", "draws svg, png and pdf, replay animations as gif, too", place);
    if (format == LOOK_FORMAT_COUNT || exists) {
        look->directory = place;
        return place[0] || wrong(command, "-o", "takes a directory or a file", place);
    }
    if (formatted)
        return wrong(command, "-o", "with --format takes a directory", place);
    memset(look->format, 0, sizeof look->format);
    look->format[format] = true;
    look->file = place;
    return true;
}

/* ---- sizes -------------------------------------------------------------------------------- */

static bool read_size(const struct command *command, const char *text, struct look *look)
{
    char *end;
    look->width = strtod(text, &end);
    look->height = *end == 'x' ? strtod(end + 1, &end) : 0;
    if (strcmp(end, "mm") == 0)
        end += 2;
    const bool good = *end == '\0' && look->width >= 30 && look->width <= 1000 &&
                      (!strchr(text, 'x') || (look->height >= 30 && look->height <= 1000));
    return good || wrong(command, "--size", "takes WIDTH or WIDTHxHEIGHT, 30 to 1000 mm", text);
}

/* "Times", "Times,8", "8" */
static bool read_font(const struct command *command, const char *text, struct look *look)
{
    static char name[64]; /* of the one command that a process runs */
    const char *comma = strrchr(text, ','), *size = comma ? comma + 1 : text;
    char *end;
    const double points = strtod(size, &end);
    const bool sized = end != size && *end == '\0';
    const size_t length = comma ? (size_t)(comma - text) : sized ? 0 : strlen(text);
    if ((comma && !sized) || length >= sizeof name || strpbrk(text, "'\"\\") ||
        (sized && !(points >= 4 && points <= 40)))
        return wrong(command, "--font", "takes NAME, NAME,PT or PT (4 to 40)", text);
    look->points = sized ? points : look->points;
    if (length > 0) {
        snprintf(name, sizeof name, "%.*s", (int)length, text);
        look->font = name;
    }
    return true;
}

/* ---- names -------------------------------------------------------------------------------- */

static bool read_pair(const char *text, struct look_pair *pair)
{
    const char *equals = strchr(text, '=');
    if (!equals || equals == text || (size_t)(equals - text) >= sizeof pair->name ||
        strlen(equals + 1) >= sizeof pair->value)
        return false;
    snprintf(pair->name, sizeof pair->name, "%.*s", (int)(equals - text), text);
    snprintf(pair->value, sizeof pair->value, "%s", equals + 1);
    pair->met = false;
    return true;
}

static bool read_names(const struct command *command, const struct look_options *o,
                       struct look *look)
{
    for (size_t k = 0; k < o->label_count; k++)
        if (!read_pair(o->labels[k], &look->label[look->labels++]))
            return wrong(command, "--labels", "takes NAME=TEXT", o->labels[k]);
    for (size_t k = 0; k < o->colour_count; k++) {
        struct look_pair *const pair = &look->colour[look->colours];
        if (strcmp(o->colours[k], "grey") == 0) {
            look->grey = true;
            continue;
        }
        if (!read_pair(o->colours[k], pair) || strlen(pair->value) != 7 || pair->value[0] != '#' ||
            strspn(pair->value + 1, "0123456789abcdefABCDEF") != 6)
            return wrong(command, "--colours", "takes NAME=#rrggbb, or grey", o->colours[k]);
        look->colours++;
    }
    return true;
}

bool look_given(const struct look_options *o)
{
    size_t given = o->label_count + o->colour_count;
    for (int k = 0; k < LOOK_WORDS; k++)
        given += o->given[k];
    return given > 0;
}

bool look_read(const struct command *command, const struct look_options *o, struct look *look)
{
    look_begin(look);
    if (o->journal) {
        const bool page = strcmp(o->journal, "page") == 0;
        if (!page && strcmp(o->journal, "column") != 0)
            return wrong(command, "--for", "takes column or page", o->journal);
        look->width = page ? 180 : 88;
        look->points = 8;
        look->bare = true;
        look->format[LOOK_SVG] = look->format[LOOK_PNG] = false;
        look->format[LOOK_PDF] = true;
    }
    look->picture = o->picture;
    look->title = o->title;
    look->bare = o->title ? !o->title[0] : look->bare;
    return (!o->format || read_formats(command, o->format, look)) &&
           (!o->place || read_place(command, o->place, o->format != NULL, look)) &&
           (!o->size || read_size(command, o->size, look)) &&
           (!o->font || read_font(command, o->font, look)) && read_names(command, o, look);
}

const char *look_directory(const struct look *look, const char *file, char *own, size_t size)
{
    const char *const path = look->file ? look->file : file, *const slash = strrchr(path, '/');
    if (look->directory)
        return look->directory;
    if (slash)
        snprintf(own, size, "%.*s", slash == path ? 1 : (int)(slash - path), path);
    else
        snprintf(own, size, ".");
    return own;
}

/* ---- while pictures are drawn ------------------------------------------------------------- */

static const char *find(struct look_pair *pairs, size_t count, const char *name)
{
    const char *value = NULL;
    for (size_t k = 0; k < count; k++) {
        if (strcmp(pairs[k].name, name) == 0) {
            pairs[k].met = true;
            value = pairs[k].value;
        }
    }
    return value;
}

const char *look_label(struct look *look, const char *name)
{
    const char *text = find(look->label, look->labels, name);
    return text ? text : name;
}

const char *look_colour(struct look *look, const char *name)
{
    return find(look->colour, look->colours, name);
}

bool look_wants(struct look *look, const char *picture)
{
    const bool wanted =
        look->picture ? strcmp(look->picture, picture) == 0 : !look->file || look->drawn == 0;
    const size_t used = strlen(look->others);
    if (wanted && look->drawn++ == 0)
        snprintf(look->first, sizeof look->first, "%s", picture);
    if (!wanted)
        snprintf(look->others + used, sizeof look->others - used, "%s%s", used ? ", " : "",
                 picture);
    return wanted;
}

static void say_unmet(const struct command *command, const char *option,
                      const struct look_pair *pairs, size_t count)
{
    for (size_t k = 0; k < count; k++)
        if (!pairs[k].met)
            fprintf(stderr, "stance %s: %s: nothing is called '%s' there\n", command->name, option,
                    pairs[k].name);
}

bool look_end(const struct look *look, const struct command *command, const char *file)
{
    if (look->picture && look->drawn == 0) {
        fprintf(stderr, "%s: has no picture '%.60s'%s%s\n", file, look->picture,
                look->others[0] ? "; there are " : "", look->others);
        return false;
    }
    if (!look->picture && look->others[0])
        fprintf(stderr, "%s: the picture %s; others by --picture: %s\n", look->file, look->first,
                look->others);
    say_unmet(command, "--labels", look->label, look->labels);
    say_unmet(command, "--colours", look->colour, look->colours);
    return true;
}
