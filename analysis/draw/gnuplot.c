/* gnuplot.c - hands data to gnuplot's scripts, runs gnuplot, fetches the pictures. */
#include "gnuplot.h"

#include "fonts.h"

#include "runner/base/message.h"
#include "runner/base/words.h"
#include "runner/store/results.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* Exit statuses: of chart.gp where the asked size has no room, of sh. */
enum { TOO_SMALL = 3, NOT_FOUND = 127 };

/* Embeds a script as a constant string; the Makefile has the object made anew when it changes. */
#define SCRIPT(symbol, path)                                                                       \
    __asm__(".pushsection .rodata\n" #symbol ":\n.incbin \"" path "\"\n.byte 0\n.popsection\n");   \
    extern const char symbol[] __attribute__((visibility("hidden")))
SCRIPT(style_gp, "analysis/draw/style.gp");
SCRIPT(chart_gp, "analysis/draw/chart.gp");

/* What can be in a picture's directory beside cells. */
static const char *const files[] = {"style.gp",    "chart.gp",   "script",      "data.gp",
                                    "drawn.gp",    "errors",     "picture.svg", "picture.png",
                                    "picture.pdf", "picture.gif"};

/* ---- directories --------------------------------------------------------------------------- */

bool gnuplot_directory(const char *directory)
{
    char inside[4200];
    snprintf(inside, sizeof inside, "%s/.", directory);
    const bool good =
        (mkdir(directory, 0777) == 0 || errno == EEXIST) && access(inside, W_OK | X_OK) == 0;
    if (!good)
        fprintf(stderr, "%s: pictures cannot be written there: %s\n", directory, strerror(errno));
    return good;
}

/* ---- the scratch directory ---------------------------------------------------------------- */

/* Removes the directory of a picture that is over, with what can be in it. */
static void remove_picture(const char *directory)
{
    char path[1100];
    int cells = 0;
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        snprintf(path, sizeof path, "%s/%s", directory, files[i]);
        unlink(path);
    }
    do
        snprintf(path, sizeof path, "%s/cells%d", directory, ++cells);
    while (unlink(path) == 0);
    rmdir(directory);
}

static void note_failure(struct gnuplot *g)
{
    g->error = g->error ? g->error : errno;
}

static void put_file(struct gnuplot *g, const char *name, const void *bytes, size_t size)
{
    char path[320];
    snprintf(path, sizeof path, "%s/%s", g->scratch, name);
    FILE *const file = fopen(path, "wb");
    if (!file || fwrite(bytes, 1, size, file) != size)
        note_failure(g);
    if (file && fclose(file) != 0)
        note_failure(g);
}

void gnuplot_cells(struct gnuplot *g, const void *cells, size_t size)
{
    char name[32];
    snprintf(name, sizeof name, "cells%d", ++g->files);
    put_file(g, name, cells, size);
}

/* Where scratch directories are made, and stay: see gnuplot.h. */
static const char *kept_in(void)
{
    const char *directory = getenv("STANCE_SCRIPTS");
    return directory && directory[0] ? directory : NULL;
}

/* Letters that are as wide as high: a line may end between any two (Unicode TR 11 and 14). */
static bool is_wide(uint32_t letter)
{
    return (letter >= 0x2e80 && letter <= 0xa4cf) || (letter >= 0xac00 && letter <= 0xd7a3) ||
           (letter >= 0xf900 && letter <= 0xfaff) || (letter >= 0xff00 && letter <= 0xff60) ||
           (letter >= 0x20000 && letter <= 0x3fffd);
}

/* A text with a mark (style.gp's `seam`) after each wide letter, which so counts as two. */
static void put_prose(struct gnuplot *g, const char *text, const char *name)
{
    char *marked = malloc(4 * strlen(text) + 1), *out = marked;
    for (size_t n; marked && *text; text += n) {
        uint32_t letter = 0;
        const size_t bytes = utf8_letter(text, strlen(text), &letter);
        n = bytes ? bytes : 1;
        out = (char *)memcpy(out, text, n) + n;
        if (bytes && is_wide(letter))
            out = stpcpy(out, "\u200b");
    }
    if (marked)
        *out = '\0';
    gnuplot_text(g, marked ? marked : "", "%s", name);
    free(marked);
}

/* What the scripts must know of the look. A text of 12 pt in gnuplot's sense is 16 px high, so that
 * a px is 1/16 of the size of the text. */
static void put_look(struct gnuplot *g)
{
    const struct look *look = g->plot->look;
    const double points = look->points / 16, px = 72 / 25.4 / points; /* pt a px, px a mm */
    gnuplot_text(g, look->font, "font_name");
    gnuplot_set(g, "px_points = %.10g; asked_width = %.10g; asked_height = %.10g", points,
                look->width * px, look->height * px);
    gnuplot_set(g, "px_dots = %.10g", look->width > 0 ? 600 * points / 72 : 1.6 * look->points / 9);
    if (look->grey)
        gnuplot_set(g, "eval in_grey");
}

/* A piece of memory of a picture, and what there was before it. */
struct gnuplot_room {
    struct gnuplot_room *before;
    void *piece;
};

/* Ends what is not the scratch directory. */
static void leave(struct gnuplot *g)
{
    while (g->room) {
        struct gnuplot_room *const room = g->room;
        g->room = room->before;
        free(room->piece);
        free(room);
    }
    if (g->data)
        fclose(g->data);
    free(g->text);
}

bool gnuplot_begin(struct gnuplot *g, const struct plot *plot, const char *name)
{
    const char *base = kept_in() ? kept_in() : getenv("TMPDIR");
    *g = (struct gnuplot){.plot = plot, .rows = -1};
    snprintf(g->stem, sizeof g->stem, "%.400s%s%.100s", plot->stem, name[0] ? "-" : "", name);
    snprintf(g->scratch, sizeof g->scratch, "%s/stance-plot-XXXXXX",
             base && base[0] && strlen(base) < 200 ? base : "/tmp");
    g->data = open_memstream(&g->text, &g->size);
    if (!g->data || !mkdtemp(g->scratch)) {
        complain(plot->message, "%.150s: cannot make a directory%s: %s", g->scratch,
                 kept_in() ? " (STANCE_SCRIPTS)" : "", strerror(errno));
        leave(g);
        return false;
    }
    put_file(g, "style.gp", style_gp, strlen(style_gp));
    put_file(g, "chart.gp", chart_gp, strlen(chart_gp));
    put_look(g);
    return true;
}

void *gnuplot_keep(struct gnuplot *g, void *piece)
{
    struct gnuplot_room *const room = piece ? malloc(sizeof *room) : NULL;
    if (!room) {
        errno = ENOMEM;
        note_failure(g);
        free(piece);
        return NULL;
    }
    *room = (struct gnuplot_room){g->room, piece};
    g->room = room;
    return piece;
}

void *gnuplot_room(struct gnuplot *g, size_t count, size_t size)
{
    return gnuplot_keep(g, calloc(count ? count : 1, size));
}

bool gnuplot_needs(struct gnuplot *g, bool had)
{
    g->missing = g->missing || !had;
    return had;
}

void gnuplot_kind_colour(const char *kind, char colour[8])
{
    char name[80];
    snprintf(name, sizeof name, "\ncolour_%s = 0x", kind);
    const char *const at = strstr(style_gp, name);
    colour[0] = '\0';
    if (at)
        snprintf(colour, 8, "#%.6s", at + strlen(name));
}

/* ---- formats ------------------------------------------------------------------------------ */

static char *read_file(const char *path, size_t *size)
{
    struct stat information;
    FILE *file = fopen(path, "rb");
    char *text = NULL;
    if (file && fstat(fileno(file), &information) == 0 && information.st_size > 0) {
        *size = (size_t)information.st_size;
        text = malloc(*size + 1);
        if (text && fread(text, 1, *size, file) != *size) {
            free(text);
            text = NULL;
        }
    }
    if (file)
        fclose(file);
    if (text)
        text[*size] = '\0';
    return text;
}

/* The picture is drawn from the same data in each format; without letters that cannot be drawn,
 * where there is need of them: SVG is drawn by its readers, with fonts of their own. */
static void put_formats(struct gnuplot *g)
{
    const char *const font = g->plot->look->font;
    char script[800] = "", *drawn = NULL;
    bool plain = strcmp(font, LOOK_FONT) == 0;
    if (fflush(g->data) != 0)
        note_failure(g);
    put_file(g, "data.gp", g->text, g->size);
    for (size_t i = 0; i < g->size; i++)
        plain = plain && (unsigned char)g->text[i] < 0x80;
    if (!plain)
        drawn = fonts_replace(font, g->text, g->size);
    if (drawn)
        put_file(g, "drawn.gp", drawn, strlen(drawn));
    for (int f = 0; f < LOOK_FORMAT_COUNT; f++)
        if (g->plot->look->format[f])
            add_text(script, sizeof script,
                     "drawing = '%s'\nload 'style.gp'\nload '%s'\nload 'chart.gp'\n"
                     "unset multiplot; unset output; reset\n",
                     look_endings[f], drawn && f != LOOK_SVG ? "drawn.gp" : "data.gp");
    put_file(g, "script", script, strlen(script));
    free(drawn);
}

/* ---- fetching ----------------------------------------------------------------------------- */

/* Copies up to `tag`, or to `end` where there is none; returns what comes after it. */
static const char *copy_to(FILE *out, const char *text, const char *end, const char *tag)
{
    const char *found = memmem(text, (size_t)(end - text), tag, strlen(tag));
    fwrite(text, 1, (size_t)((found ? found : end) - text), out);
    return found ? found + strlen(tag) : end;
}

/* Groups the frames of a picture that moves, each from its first curve to that of the next one, but
 * for the first plot, which stays, and shows one after the other (SMIL); where nothing moves the
 * first is seen. */
static void write_frames(FILE *out, const struct look *look, const char *text, const char *end)
{
    static const char curve[] = "<g id=\"gnuplot_plot_1", last[] = "</g>\n</svg>";
    const char *const tail = memmem(text, (size_t)(end - text), last, sizeof last - 1);
    const char *at[LOOK_MOST_FRAMES + 1] = {0}, *from = text;
    int frames = -1;
    for (const char *found; tail && frames < LOOK_MOST_FRAMES; from = found + 1) {
        found = memmem(from, (size_t)(tail - from), curve, sizeof curve - 1);
        if (!found)
            break;
        if (++frames > 0)
            at[frames - 1] = found;
    }
    frames = frames < 0 ? 0 : frames;
    fwrite(text, 1, (size_t)((frames ? at[0] : end) - text), out);
    at[frames] = tail;
    for (int f = 0; f < frames; f++) {
        fprintf(out,
                "<g visibility=\"%s\"><animate attributeName=\"visibility\" calcMode=\"discrete\" "
                "values=\"hidden;visible;hidden\" keyTimes=\"0;%.6f;%.6f\" dur=\"%.4gs\" "
                "repeatCount=\"indefinite\"/>\n",
                f ? "hidden" : "visible", (double)f / frames, (f + 1.0) / frames,
                look->animated * frames);
        fwrite(at[f], 1, (size_t)(at[f + 1] - at[f]), out);
        fputs("</g>\n", out);
    }
    if (frames)
        fwrite(tail, 1, (size_t)(end - tail), out);
}

/* Viewers smooth enlarged images unless told not to: a cell is to stay a cell. A page of an asked
 * size has it in mm. */
static bool write_svg(FILE *out, const struct look *look, const char *text, size_t size)
{
    static const char image[] = "<image ", width[] = " width=\"", height[] = " height=\"";
    const char *const end = text + size;
    double px[2];
    char *rest;
    if (look->width > 0) {
        text = copy_to(out, text, end, width);
        px[0] = strtod(text, &rest);
        text = strstr(rest, height);
        px[1] = text ? strtod(text + sizeof height - 1, &rest) : px[0];
        fprintf(out, "%s%.2fmm\"%s%.2fmm", width, look->width, height, look->width / px[0] * px[1]);
        text = rest;
    }
    if (look->animated > 0)
        write_frames(out, look, text, end);
    else
        while ((text = copy_to(out, text, end, image)) < end)
            fputs("<image style='image-rendering:pixelated' ", out);
    return !ferror(out);
}

static bool not_written(const char *path, stance_message *message)
{
    return complain(message, "%.150s: cannot be written: %s", path, strerror(errno));
}

/* A file of a picture is drawn in the scratch directory, and belongs into the plot's; whole as a
 * part beside its place, it takes that place at once. No reader ever sees half a picture, and none
 * is left by a full disk. */
enum place { DRAWN, PART, PLACE };
enum { PATH = 2048 };

static const char *path_of(const struct gnuplot *g, enum place place, int format, char path[PATH])
{
    const char *const directory = place == DRAWN ? g->scratch : g->plot->directory;
    const char *const slash = directory[strlen(directory) - 1] == '/' ? "" : "/";
    if (place == PLACE && g->plot->look->file)
        return g->plot->look->file;
    if (place == PART)
        snprintf(path, PATH, "%s%s.stance-%ld.%s", directory, slash, (long)getpid(),
                 look_endings[format]);
    else
        snprintf(path, PATH, "%s%s%s.%s", directory, slash, place == DRAWN ? "picture" : g->stem,
                 look_endings[format]);
    return path;
}

/* gnuplot does not tell when the disk that it draws on is full: the last words of a file do. */
static bool is_complete(const char *text, size_t size, int format)
{
    static const struct {
        const char *words;
        size_t after; /* bytes: of a checksum */
    } last[LOOK_FORMAT_COUNT] = {[LOOK_SVG] = {"</svg>", 0},
                                 [LOOK_PNG] = {"IEND", 4},
                                 [LOOK_PDF] = {"%%EOF", 0},
                                 [LOOK_GIF] = {";", 0}};
    const size_t length = strlen(last[format].words), whole = length + last[format].after;
    while (format != LOOK_PNG && size > 0 && isspace((unsigned char)text[size - 1]))
        size--;
    return size >= whole && memcmp(text + size - whole, last[format].words, length) == 0;
}

static bool copy_part(const struct gnuplot *g, int format)
{
    size_t size = 0;
    char path[PATH], *text = read_file(path_of(g, DRAWN, format, path), &size);
    if (!text || !is_complete(text, size, format)) {
        complain(g->plot->message, "gnuplot drew %s for %.100s; is there room in %.60s?",
                 text ? "half a picture" : "nothing", path_of(g, PLACE, format, path), g->scratch);
        free(text);
        return false;
    }
    unlink(path_of(g, PART, format, path)); /* of a process of that number that was killed */
    FILE *out = fopen(path, "wbx");
    bool good = out && (format == LOOK_SVG ? write_svg(out, g->plot->look, text, size)
                                           : fwrite(text, 1, size, out) == size);
    int error = errno;
    if (out && fclose(out) != 0 && good) {
        error = errno;
        good = false;
    }
    free(text);
    errno = error;
    return good || not_written(path_of(g, PLACE, format, path), g->plot->message);
}

/* Brings the pictures to where they belong: all, or where one cannot be written none. */
static bool fetch(const struct gnuplot *g)
{
    const bool *const wanted = g->plot->look->format;
    char part[PATH], path[PATH];
    bool good = true;
    for (int f = 0; f < LOOK_FORMAT_COUNT; f++)
        good = good && (!wanted[f] || copy_part(g, f));
    for (int f = 0; f < LOOK_FORMAT_COUNT; f++) {
        const char *const from = path_of(g, PART, f, part), *const to = path_of(g, PLACE, f, path);
        if (!wanted[f])
            continue;
        good = good && (rename(from, to) == 0 || not_written(to, g->plot->message));
        if (good)
            puts(strncmp(to, "./", 2) == 0 ? to + 2 : to);
        else
            unlink(from);
    }
    return good;
}

/* Runs gnuplot in the scratch directory and fetches what it drew; or says the last line that it
 * said. */
static bool draw(const struct gnuplot *g)
{
    stance_message *const message = g->plot->message;
    char path[320], line[300], complaint[120] = "no reason given";
    if (g->error == ENOMEM)
        return no_memory(message);
    if (g->error)
        return complain(message, "%.100s: cannot be written: %s", g->scratch, strerror(g->error));
    setenv("STANCE_SCRATCH", g->scratch, 1);
    const int ended =
        system("cd \"$STANCE_SCRATCH\" && exec gnuplot -d script </dev/null >errors 2>&1");
    const int status = WIFEXITED(ended) ? WEXITSTATUS(ended) : 128;
    if (ended < 0)
        return complain(message, "gnuplot cannot be run: %s", strerror(errno));
    if (status == NOT_FOUND)
        return complain(message, "gnuplot, which draws the pictures, is not installed; on Debian: "
                                 "apt-get install gnuplot-nox");
    if (status == 0)
        return fetch(g);
    snprintf(path, sizeof path, "%s/errors", g->scratch);
    FILE *const errors = fopen(path, "r");
    while (errors && fgets(line, sizeof line, errors)) {
        const char *const start = line + strspn(line, " \t\r\v\f");
        line[strcspn(line, "\n")] = '\0';
        if (*start)
            snprintf(complaint, sizeof complaint, "%.119s", start);
    }
    if (errors)
        fclose(errors);
    return complain(message,
                    status == TOO_SMALL ? "%.190s: a larger --size, or shorter --labels"
                                        : "gnuplot failed: %.190s",
                    complaint);
}

void gnuplot_abandon(struct gnuplot *g)
{
    leave(g);
    remove_picture(g->scratch);
}

bool gnuplot_end(struct gnuplot *g)
{
    const char *const dash = strrchr(g->stem, '-');
    char path[1024];
    const bool missing = g->missing;
    const struct look *const look = g->plot->look;
    const struct results *const r = g->plot->r;
    const char *const title = g->plot->title ? g->plot->title : r->title[0] ? r->title : r->name;
    if (missing && g->error == ENOMEM)
        no_memory(g->plot->message);
    if (missing || !look_wants(g->plot->look, dash ? dash + 1 : g->stem)) {
        gnuplot_abandon(g);
        return !missing;
    }
    put_prose(g, look->title ? look->title : look->bare ? "" : title, "title");
    put_prose(g, look->bare ? "" : g->subtitle, "subtitle");
    put_formats(g);
    const bool good = draw(g);
    leave(g);
    if (!good || !kept_in()) {
        remove_picture(g->scratch);
        return good;
    }
    /* The scratch directory stays where it is, under the picture's name; a former one goes. */
    snprintf(path, sizeof path, "%s/%s", kept_in(), g->stem);
    remove_picture(path);
    return rename(g->scratch, path) == 0 || not_written(path, g->plot->message);
}
