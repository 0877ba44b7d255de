/* look.c - options of pictures. */
#include "look.h"

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

/* ---- files -------------------------------------------------------------------------------- */

/* Format of a file's name; LOOK_FORMAT_COUNT: it has none of the endings. */
static enum look_format format_of(const char *name)
{
    int f = 0;
    while (f < LOOK_FORMAT_COUNT && strcmp(name, look_endings[f]) != 0)
        f++;
    return (enum look_format)f;
}

static const char *format_word(size_t k)
{
    return k < LOOK_GIF ? look_endings[k] : NULL;
}

static bool read_format(const char *text, void *look)
{
    struct look *const l = look;
    if (!l->formatted)
        memset(l->format, 0, sizeof l->format);
    l->formatted = l->format[format_of(text)] = true;
    return !l->file;
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
bool look_place(const char *text, void *look)
{
    struct look *const l = look;
    struct stat information;
    const char *slash = strrchr(text, '/'), *name = slash ? slash + 1 : text;
    const char *dot = strrchr(name, '.');
    const enum look_format format = dot && dot > name ? format_of(dot + 1) : LOOK_FORMAT_COUNT;
    if (stat(text, &information) == 0 && S_ISDIR(information.st_mode)) {
        l->directory = text;
        return true;
    }
    if (format == LOOK_FORMAT_COUNT) {
        l->directory = text;
        return text[0] && !(dot && dot > name && is_other_format(dot + 1));
    }
    memset(l->format, 0, sizeof l->format);
    l->format[format] = true;
    l->file = text;
    return true;
}

static bool read_journal(const char *text, void *look)
{
    struct look *const l = look;
    l->width = strcmp(text, "page") == 0 ? 180 : 88;
    l->points = 8;
    l->bare = true;
    if (!l->file) {
        l->format[LOOK_SVG] = l->format[LOOK_PNG] = false;
        l->format[LOOK_PDF] = true;
    }
    return true;
}

/* ---- sizes -------------------------------------------------------------------------------- */

static bool read_size(const char *text, void *look)
{
    struct look *const l = look;
    char *end;
    l->width = strtod(text, &end);
    l->height = *end == 'x' ? strtod(end + 1, &end) : 0;
    if (strcmp(end, "mm") == 0)
        end += 2;
    return *end == '\0' && l->width >= 30 && l->width <= 1000 &&
           (!strchr(text, 'x') || (l->height >= 30 && l->height <= 1000));
}

/* "Times", "Times,8", "8" */
static bool read_font(const char *text, void *look)
{
    static char name[64]; /* of the one command that a process runs */
    struct look *const l = look;
    const char *comma = strrchr(text, ','), *size = comma ? comma + 1 : text;
    char *end;
    const double points = strtod(size, &end);
    const bool sized = end != size && *end == '\0';
    const size_t length = comma ? (size_t)(comma - text) : sized ? 0 : strlen(text);
    l->lettered = true;
    if ((comma && !sized) || length >= sizeof name || strpbrk(text, "'\"\\") ||
        (sized && !(points >= 4 && points <= 40)))
        return false;
    l->points = sized ? points : l->points;
    if (length > 0) {
        snprintf(name, sizeof name, "%.*s", (int)length, text);
        l->font = name;
    }
    return true;
}

/* ---- names -------------------------------------------------------------------------------- */

static bool read_title(const char *text, void *look)
{
    struct look *const l = look;
    l->title = text;
    l->bare = !text[0];
    return true;
}

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

static bool read_label(const char *text, void *look)
{
    struct look *const l = look;
    return read_pair(text, &l->label[l->labels++]);
}

static bool read_colour(const char *text, void *look)
{
    struct look *const l = look;
    struct look_pair *const pair = &l->colour[l->colours];
    if (strcmp(text, "grey") == 0)
        return l->grey = true;
    l->colours++;
    return read_pair(text, pair) && strlen(pair->value) == 7 && pair->value[0] == '#' &&
           strspn(pair->value + 1, "0123456789abcdefABCDEF") == 6;
}

bool look_given(const struct look *look)
{
    return look->file || look->directory || look->formatted || look->picture || look->width > 0 ||
           look->lettered || look->title || look->grey || look->labels + look->colours > 0;
}

static const char *journal_word(size_t k)
{
    return k == 0 ? "column" : k == 1 ? "page" : NULL;
}

/* -o first, whose ending --for and --format heed; what --for chooses others may change. */
const struct option look_drawn[] = {
    {"--for", .word = journal_word, .read = read_journal,
     .text = "column: 88 mm wide, page: 180 mm; text of 8 pt, no title (the caption has it), PDF "
             "unless another format is asked for"},
    {"--format", "F,...", .word = format_word, .listed = true, .read = read_format,
     .takes = "formats of files in a directory, -o DIR",
     .text = "files of each picture: svg, png, pdf; default svg,png"},
    {"--picture", "P", OPTION_TO(struct look, picture), .text = "of all pictures only NAME-P"},
    {"--size", "W[xH]", .read = read_size, .takes = "WIDTH or WIDTHxHEIGHT, 30 to 1000 mm",
     .text = "mm; W alone: as high as it needs"},
    {"--font", "NAME[,PT]", .read = read_font, .takes = "NAME, NAME,PT or PT (4 to 40)",
     .text = "or PT alone; default DejaVu Sans, 9 pt (without --for or --size the page grows with "
             "it)"},
    {"--title", "TEXT", .read = read_title, .text = "instead of the file's; '' leaves it out"},
    {"--labels", "NAME=TEXT", .read = read_label, .takes = "NAME=TEXT", .most = LOOK_MOST_NAMES,
     .text = "TEXT where the picture says NAME: the path of an axis, an outcome, a value or a "
             "file in the legend or over a panel; repeatable"},
    {"--colours", "NAME=#rrggbb|grey", .read = read_colour, .takes = "NAME=#rrggbb, or grey",
     .most = LOOK_MOST_NAMES,
     .text = "of an outcome or an entry of a legend; repeatable. grey: all in grey"},
    {.text =
         "  STANCE_SCRIPTS=DIR in the environment keeps each picture's gnuplot script and data"},
    {0},
};

const struct option look_options[] = {
    {"-o", "PLACE", LOOK_PLACE,
     .text = "where the pictures go: a directory (made when missing), or a file whose ending says "
             "what it is: fig.pdf, fig.svg, fig.png"},
    {.rows = look_drawn},
    {0},
};

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
