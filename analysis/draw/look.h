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

enum { LOOK_MOST_NAMES = 32, LOOK_MOST_FRAMES = 400 };
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
    bool formatted, lettered; /* --format, --font were given */
    struct look_pair label[LOOK_MOST_NAMES], colour[LOOK_MOST_NAMES];
    size_t labels, colours;
    size_t drawn;     /* pictures so far */
    char first[64];   /* name of the first of them */
    char others[256]; /* names of those that were left out, "map, curve" */
};

/* As SVG and PNG, as large as each picture needs. */
void look_begin(struct look *look);

/* The options of pictures, and those without -o; all of a struct look that was begun. */
extern const struct option look_options[], look_drawn[];
/* Row of a command whose -o says something of its own: {LOOK_PLACE, .text = "..."} */
#define LOOK_PLACE                                                                                 \
    .read = look_place, .takes = "a directory or, without --format, a file that ends in svg, png " \
                                 "or pdf, of replay in gif, too"
bool look_place(const char *text, void *look);

/* Whether any was given. */
bool look_given(const struct look *look);
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
