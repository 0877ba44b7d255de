/* look.h - how pictures are to come out: the options that commands which draw have in common, as
 * the user gave them and as they were understood. */
#ifndef STANCE_DRAW_LOOK_H
#define STANCE_DRAW_LOOK_H

#include "runner/base/command.h"

#include <stdio.h>

/* X(NAME, ending): the files that a picture can become. */
#define LOOK_FORMATS(X) X(SVG, "svg") X(PNG, "png") X(PDF, "pdf") X(GIF, "gif")
enum look_format {
#define LOOK_FORMAT(NAME, ending) LOOK_##NAME,
    LOOK_FORMATS(LOOK_FORMAT)
#undef LOOK_FORMAT
        LOOK_FORMAT_COUNT
};
extern const char *const look_endings[LOOK_FORMAT_COUNT];

enum { LOOK_MOST_NAMES = 32, LOOK_WORDS = 7, LOOK_MOST_FRAMES = 400 };
#define LOOK_FONT "DejaVu Sans"

/* NAME=VALUE, and whether a picture has had that name. */
struct look_pair {
    char name[96], value[160];
    bool met;
};

struct look {
    bool format[LOOK_FORMAT_COUNT];
    const char *directory;    /* NULL: where the results file is */
    const char *file;         /* the one file to be drawn; NULL: DIRECTORY/STEM-PICTURE.FORMAT */
    const char *picture;      /* the only one to be drawn; NULL: all, of `file` the first */
    double width, height;     /* mm; 0: what the picture needs */
    double points;            /* size of its text, pt */
    const char *font, *title; /* title NULL: that of the file */
    double animated;          /* s a frame of a picture that moves; 0: it stands still */
    bool bare;                /* neither title nor the line under it */
    bool grey;
    struct look_pair label[LOOK_MOST_NAMES], colour[LOOK_MOST_NAMES];
    size_t labels, colours;
    size_t drawn;     /* pictures so far */
    char first[64];   /* name of the first of them */
    char others[256]; /* names of those that were left out, "map, curve" */
};

/* As SVG and PNG, as large as each picture needs. */
void look_begin(struct look *look);

/* What was given on the command line. */
struct look_options {
    const char *place, *format, *picture, *size, *font, *title, *journal;
    const char *labels[LOOK_MOST_NAMES], *colours[LOOK_MOST_NAMES];
    size_t given[LOOK_WORDS], label_count, colour_count;
};
/* Rows of the command's `struct option_spec specs[]`. */
#define LOOK_SPECS(o)                                                                              \
    {"-o", true, &(o).place, 1, &(o).given[0]}, {"--format", true, &(o).format, 1, &(o).given[1]}, \
        {"--picture", true, &(o).picture, 1, &(o).given[2]},                                       \
        {"--size", true, &(o).size, 1, &(o).given[3]},                                             \
        {"--font", true, &(o).font, 1, &(o).given[4]},                                             \
        {"--title", true, &(o).title, 1, &(o).given[5]},                                           \
        {"--for", true, &(o).journal, 1, &(o).given[6]},                                           \
        {"--labels", true, (o).labels, LOOK_MOST_NAMES, &(o).label_count},                         \
    {                                                                                              \
        "--colours", true, (o).colours, LOOK_MOST_NAMES, &(o).colour_count                         \
    }
/* The options' lines of a command's help, and those without -o. */
#define LOOK_HELP                                                                                  \
    "  -o PLACE       where the pictures go: a directory (made when missing), or a file whose\n"   \
    "                 ending says what it is: fig.pdf, fig.svg, fig.png\n" LOOK_HELP_DRAWN
#define LOOK_HELP_DRAWN                                                                            \
    "  --format F,... files of each picture: svg, png, pdf; default svg,png\n"                     \
    "  --picture P    of all pictures only NAME-P\n"                                               \
    "  --for JOURNAL  column: 88 mm wide, page: 180 mm; text of 8 pt, no title (the caption has\n" \
    "                 it), PDF unless another format is asked for\n"                               \
    "  --size W[xH]   mm; W alone: as high as it needs\n"                                          \
    "  --font NAME[,PT] or PT alone; default DejaVu Sans, 9 pt (without --for or --size the\n"     \
    "                 page grows with it)\n"                                                       \
    "  --title TEXT   instead of the file's; '' leaves it out\n"                                   \
    "  --labels NAME=TEXT   TEXT where the picture says NAME: the path of an axis, an outcome, "   \
    "a\n"                                                                                          \
    "                 value or a file in the legend or over a panel; repeatable\n"                 \
    "  --colours NAME=#rrggbb   of an outcome or an entry of a legend; repeatable\n"               \
    "  --colours grey  all in grey\n"                                                              \
    "  STANCE_SCRIPTS=DIR in the environment keeps each picture's gnuplot script and data\n"

/* Whether any was. */
bool look_given(const struct look_options *options);
/* False with a line on standard error: bad use. `options` must outlive the look. */
bool look_read(const struct command *command, const struct look_options *options,
               struct look *look);
/* The directory that pictures of a file go to, in own[size] where it is not the look's. */
const char *look_directory(const struct look *look, const char *file, char *own, size_t size);
/* The text to be drawn instead of a name, or the name. */
const char *look_label(struct look *look, const char *name);
/* "#rrggbb" of a name, or NULL. */
const char *look_colour(struct look *look, const char *name);
/* Whether a picture is to be drawn; what is left out is remembered. */
bool look_wants(struct look *look, const char *picture);
/* After the last picture: says which name was in none of them and, of one file, which pictures
 * there are besides. False: the picture asked for is not among them. */
bool look_end(const struct look *look, const struct command *command, const char *file);

#endif
