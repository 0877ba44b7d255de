/* gnuplot.c - writes gnuplot scripts and data, runs gnuplot, fetches the pictures. */
#include "gnuplot.h"

#include "runner/store/results.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

static const double png_scale = 1.6; /* pixels of the PNG per pixel of the SVG */
enum { TITLE_SIZE = 15, TEXT_SIZE = 12, MARGIN = 18 };

/* ---- directories --------------------------------------------------------------------------- */

bool gnuplot_directory(const char *directory)
{
    struct stat information;
    bool good =
        (mkdir(directory, 0777) == 0 || errno == EEXIST) && stat(directory, &information) == 0;
    if (good && !S_ISDIR(information.st_mode)) {
        errno = ENOTDIR;
        good = false;
    }
    good = good && access(directory, W_OK | X_OK) == 0;
    if (!good)
        fprintf(stderr, "%s: pictures cannot be written there: %s\n", directory, strerror(errno));
    return good;
}

/* ---- the scratch directory ---------------------------------------------------------------- */

static void scratch_path(const struct gnuplot *g, const char *name, char path[320])
{
    snprintf(path, 320, "%s/%s", g->scratch, name);
}

/* The picture is over: its files go. */
static void remove_scratch(const struct gnuplot *g)
{
    fclose(g->sink);
    static const char *const names[] = {"script", "errors", "picture.svg", "picture.png"};
    char path[320], name[32];
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        scratch_path(g, names[i], path);
        unlink(path);
    }
    for (int i = 0; i < g->files; i++) {
        snprintf(name, sizeof name, "data%d", i);
        scratch_path(g, name, path);
        unlink(path);
    }
    rmdir(g->scratch);
}

static void note_failure(struct gnuplot *g)
{
    if (!g->failed)
        g->error = errno;
    g->failed = true;
}

bool gnuplot_begin(struct gnuplot *g, int width, int height, stance_message *message)
{
    const char *base = getenv("TMPDIR");
    char path[320];

    *g = (struct gnuplot){.width = width, .height = height};
    snprintf(g->scratch, sizeof g->scratch, "%s/stance-plot-XXXXXX",
             base && base[0] && strlen(base) < 200 ? base : "/tmp");
    if (!mkdtemp(g->scratch)) {
        snprintf(message->text, sizeof message->text, "%.150s: cannot make a directory: %s",
                 g->scratch, strerror(errno));
        return false;
    }
    scratch_path(g, "script", path);
    g->sink = fopen("/dev/null", "wb");
    g->script = g->sink ? fopen(path, "w") : NULL;
    if (!g->script) {
        snprintf(message->text, sizeof message->text, "%.150s: %s", path, strerror(errno));
        if (g->sink)
            fclose(g->sink);
        rmdir(g->scratch);
        return false;
    }
    fprintf(g->script,
            "set encoding utf8\n"
            "set terminal svg size %d,%d font 'DejaVu Sans,12' background '#ffffff' noenhanced\n"
            "set output 'picture.svg'\n"
            "load 'data0'\n"
            "unset output\n"
            "reset\n"
            "set terminal pngcairo size %d,%d font 'DejaVu Sans,12' fontscale %g linewidth %g"
            " pointscale %g background '#ffffff' noenhanced\n"
            "set output 'picture.png'\n"
            "load 'data0'\n"
            "unset output\n",
            width, height, (int)(width * png_scale), (int)(height * png_scale), png_scale,
            png_scale, png_scale);
    if (fclose(g->script) != 0)
        note_failure(g);
    /* What follows is the picture itself, drawn once for each kind of file. */
    char name[32];
    g->script = gnuplot_data(g, name);
    fputs("set multiplot\n"
          "set datafile missing 'NaN'\n"
          "set border lw 0.8 lc '#404040'\n"
          "set tics nomirror out scale 0.6 textcolor '#202020'\n"
          "unset key\n",
          g->script);
    return true;
}

FILE *gnuplot_data(struct gnuplot *g, char name[32])
{
    char path[320];
    snprintf(name, 32, "data%d", g->files);
    scratch_path(g, name, path);
    FILE *file = fopen(path, "wb");
    if (!file) {
        note_failure(g);
        file = g->sink;
    }
    g->files++;
    return file;
}

void gnuplot_close_data(struct gnuplot *g, FILE *file)
{
    if (file == g->sink)
        return;
    bool bad = ferror(file) != 0;
    if (fclose(file) != 0 || bad)
        note_failure(g);
}

void gnuplot_abandon(struct gnuplot *g)
{
    gnuplot_close_data(g, g->script);
    remove_scratch(g);
}

/* ---- texts and numbers -------------------------------------------------------------------- */

void gnuplot_number(FILE *out, double value)
{
    if (isfinite(value))
        fprintf(out, "%.10g", value);
    else
        fputs("NaN", out);
}

/* Columns up to the next blank. */
static int word_columns(const char *text)
{
    int columns = 0;
    for (; *text && *text != ' '; text++)
        columns += ((unsigned char)*text & 0xc0) != 0x80;
    return columns;
}

static void put(FILE *out, const char *text, size_t length)
{
    if (out)
        fwrite(text, 1, length, out);
}

/* In single quotes gnuplot expands nothing; a quote itself is doubled. */
int gnuplot_text(FILE *out, const char *text, int columns)
{
    int lines = 1, column = 0;
    put(out, "'", 1);
    while (*text) {
        int length = results_letter(text);
        bool blank = (unsigned char)*text <= ' ' || *text == 0x7f;
        if (blank && columns > 0 && column > 0 && column + 1 + word_columns(text + 1) > columns) {
            put(out, "'.\"\\n\".'", 8);
            lines++;
            column = 0;
            text++;
            continue;
        }
        if (blank)
            put(out, " ", 1);
        else if (length == 0)
            put(out, "?", 1);
        else if (*text == '\'')
            put(out, "''", 2);
        else
            put(out, text, (size_t)length);
        text += length > 0 ? length : 1;
        column++;
    }
    put(out, "'", 1);
    return lines;
}

/* ---- the canvas --------------------------------------------------------------------------- */

static double screen_x(const struct gnuplot *g, double x)
{
    return x / g->width;
}

static double screen_y(const struct gnuplot *g, double y)
{
    return 1 - y / g->height;
}

void gnuplot_label(struct gnuplot *g, double x, double y, const char *text, const char *align,
                   int size, bool turned)
{
    if (text[0]) {
        fputs("set label ", g->script);
        gnuplot_text(g->script, text, 0);
        fprintf(g->script, " at screen %.6f,%.6f %s font ',%d' textcolor '#202020' %s front\n",
                screen_x(g, x), screen_y(g, y), align, size, turned ? "rotate by 90" : "norotate");
    }
}

/* Letters per line: DejaVu Sans takes 0.69 of its size per letter on the average. */
static int columns_of(int width, int size)
{
    return (int)((width - 2 * MARGIN) / (0.69 * size));
}

static int height_of(int lines, int size)
{
    return lines * (size * 5 / 4 + 3);
}

int gnuplot_title_height(int width, const char *title, const char *subtitle)
{
    int first = gnuplot_text(NULL, title, columns_of(width, TITLE_SIZE));
    int second = gnuplot_text(NULL, subtitle, columns_of(width, TEXT_SIZE));
    return MARGIN + height_of(first, TITLE_SIZE) + height_of(second, TEXT_SIZE) + 10;
}

static int put_lines(struct gnuplot *g, const char *text, int size, int y, const char *colour)
{
    fputs("set label ", g->script);
    int lines = gnuplot_text(g->script, text, columns_of(g->width, size));
    fprintf(g->script, " at screen %.6f,%.6f left font ',%d' textcolor '%s' front\n",
            screen_x(g, MARGIN), screen_y(g, y + 0.6 * size), size, colour);
    return y + height_of(lines, size);
}

void gnuplot_title(struct gnuplot *g, const char *title, const char *subtitle)
{
    int y = put_lines(g, title, TITLE_SIZE, MARGIN, "#101010");
    put_lines(g, subtitle, TEXT_SIZE, y + 2, "#505050");
}

void gnuplot_legend(struct gnuplot *g, double x, double y, const char *colour, const char *text)
{
    fprintf(g->script,
            "set object rectangle from screen %.6f,%.6f to screen %.6f,%.6f fillcolor rgb '%s'"
            " fillstyle solid border lc '#606060' lw 0.5 front\n",
            screen_x(g, x), screen_y(g, y + 7), screen_x(g, x + 14), screen_y(g, y - 7), colour);
    gnuplot_label(g, x + 22, y, text, "left", TEXT_SIZE, false);
}

void gnuplot_decorate(struct gnuplot *g)
{
    fputs("set lmargin at screen 0; set rmargin at screen 1; set bmargin at screen 0;"
          " set tmargin at screen 1\n"
          "unset border; unset tics; unset xlabel; unset ylabel\n"
          "plot [0:1][0:1] 2 notitle\n" /* nothing of it is seen but what was set before */
          "unset label; unset object\n"
          "set border 31 lw 0.8 lc '#404040'\n"
          "set xtics nomirror out scale 0.6; set ytics nomirror out scale 0.6\n",
          g->script);
}

void gnuplot_panel(struct gnuplot *g, double left, double top, double width, double height)
{
    fprintf(g->script,
            "set lmargin at screen %.6f; set rmargin at screen %.6f;"
            " set tmargin at screen %.6f; set bmargin at screen %.6f\n",
            screen_x(g, left), screen_x(g, left + width), screen_y(g, top),
            screen_y(g, top + height));
}

/* ---- running ------------------------------------------------------------------------------ */

/* Runs gnuplot in the scratch directory; its exit status, or -1 with errno set. */
static int run_gnuplot(const struct gnuplot *g)
{
    char *arguments[] = {"gnuplot", "-d", "script", NULL};
    posix_spawn_file_actions_t actions;
    pid_t child;
    int status;

    int error = posix_spawn_file_actions_init(&actions);
    if (error == 0) {
        error = posix_spawn_file_actions_addchdir_np(&actions, g->scratch);
        error = error ? error : posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", 0, 0);
        error = error ? error
                      : posix_spawn_file_actions_addopen(&actions, 1, "errors",
                                                         O_WRONLY | O_CREAT | O_TRUNC, 0600);
        error = error ? error : posix_spawn_file_actions_adddup2(&actions, 1, 2);
        error = error ? error : posix_spawnp(&child, "gnuplot", &actions, NULL, arguments, environ);
        posix_spawn_file_actions_destroy(&actions);
    }
    if (error != 0) {
        errno = error;
        return -1;
    }
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

/* The last line that gnuplot said. */
static void read_complaint(const struct gnuplot *g, char text[120])
{
    char path[320], line[300];
    scratch_path(g, "errors", path);
    FILE *errors = fopen(path, "r");
    snprintf(text, 120, "no reason given");
    while (errors && fgets(line, sizeof line, errors)) {
        line[strcspn(line, "\n")] = '\0';
        char *start = line;
        while (isspace((unsigned char)*start))
            start++;
        if (*start)
            snprintf(text, 120, "%.119s", start);
    }
    if (errors)
        fclose(errors);
}

/* ---- fetching ----------------------------------------------------------------------------- */

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

/* Viewers smooth enlarged images unless told not to: a cell is to stay a cell. */
static bool write_svg(FILE *out, const char *text, size_t size)
{
    static const char tag[] = "<image ", instead[] = "<image style='image-rendering:pixelated' ";
    const char *end = text + size;
    const char *found;
    while ((found = memmem(text, (size_t)(end - text), tag, sizeof tag - 1))) {
        fwrite(text, 1, (size_t)(found - text), out);
        fwrite(instead, 1, sizeof instead - 1, out);
        text = found + sizeof tag - 1;
    }
    return fwrite(text, 1, (size_t)(end - text), out) == (size_t)(end - text) && !ferror(out);
}

static void join_path(const char *directory, const char *name, char *path, size_t size)
{
    snprintf(path, size, "%s%s%s", directory, directory[strlen(directory) - 1] == '/' ? "" : "/",
             name);
}

static bool not_written(const char *path, stance_message *message)
{
    snprintf(message->text, sizeof message->text, "%.150s: cannot be written: %s", path,
             strerror(errno));
    return false;
}

/* One file of a picture: drawn at `from`, belongs to `to`; complete at `part`, beside it, it takes
 * that place at once. No reader ever sees half a picture, and none is left by a full disk. */
struct product {
    const char *scratch; /* directory in which it was drawn */
    char from[320], part[2048], to[2048];
    bool parted; /* there is something at `part` */
};

static void name_product(struct product *product, const struct gnuplot *g, const char *extension,
                         const char *directory, const char *stem)
{
    char drawn[32], name[600];
    snprintf(drawn, sizeof drawn, "picture.%s", extension);
    scratch_path(g, drawn, product->from);
    snprintf(name, sizeof name, "%s.%s", stem, extension);
    join_path(directory, name, product->to, sizeof product->to);
    snprintf(name, sizeof name, ".stance-%ld.%s", (long)getpid(), extension);
    join_path(directory, name, product->part, sizeof product->part);
    product->scratch = g->scratch;
    product->parted = false;
}

/* gnuplot does not tell when the disk that it draws on is full: the last words of a file do. */
static bool is_complete(const char *text, size_t size, bool svg)
{
    static const char last_tag[] = "</svg>", last_chunk[] = "IEND";
    if (!svg) /* before the four bytes of its checksum */
        return size >= 8 && memcmp(text + size - 8, last_chunk, sizeof last_chunk - 1) == 0;
    while (size > 0 && isspace((unsigned char)text[size - 1]))
        size--;
    size_t length = sizeof last_tag - 1;
    return size >= length && memcmp(text + size - length, last_tag, length) == 0;
}

static bool copy_product(struct product *product, bool svg, stance_message *message)
{
    size_t size = 0;
    char *text = read_file(product->from, &size);
    if (!text || !is_complete(text, size, svg)) {
        snprintf(message->text, sizeof message->text,
                 "gnuplot drew %s for %.100s; is there room in %.60s?",
                 text ? "half a picture" : "nothing", product->to, product->scratch);
        free(text);
        return false;
    }
    unlink(product->part); /* of a process of that number that was killed */
    FILE *out = fopen(product->part, "wbx");
    product->parted = out != NULL;
    bool good = out && (svg ? write_svg(out, text, size) : fwrite(text, 1, size, out) == size);
    int error = errno;
    if (out && fclose(out) != 0 && good) {
        error = errno;
        good = false;
    }
    free(text);
    errno = error;
    return good || not_written(product->to, message);
}

static bool place_product(struct product *product, stance_message *message)
{
    if (rename(product->part, product->to) != 0)
        return not_written(product->to, message);
    product->parted = false;
    puts(strncmp(product->to, "./", 2) == 0 ? product->to + 2 : product->to);
    return true;
}

/* Brings the pictures to where they belong: both, or where one cannot be written neither. */
static bool fetch(const struct gnuplot *g, const char *directory, const char *stem,
                  stance_message *message)
{
    struct product product[2];
    name_product(&product[0], g, "svg", directory, stem);
    name_product(&product[1], g, "png", directory, stem);
    bool good = copy_product(&product[0], true, message) &&
                copy_product(&product[1], false, message) && place_product(&product[0], message) &&
                place_product(&product[1], message);
    for (int k = 0; k < 2; k++)
        if (product[k].parted)
            unlink(product[k].part);
    return good;
}

bool gnuplot_end(struct gnuplot *g, const char *directory, const char *stem,
                 stance_message *message)
{
    char complaint[120];
    bool good = false;

    fputs("unset multiplot\n", g->script);
    gnuplot_close_data(g, g->script);
    if (g->failed) {
        snprintf(message->text, sizeof message->text, "%.100s: cannot be written: %s", g->scratch,
                 strerror(g->error));
    } else {
        int status = run_gnuplot(g);
        if (status < 0 && errno == ENOENT) {
            snprintf(message->text, sizeof message->text,
                     "gnuplot, which draws the pictures, is not installed; on Debian: "
                     "apt-get install gnuplot-nox");
        } else if (status < 0) {
            snprintf(message->text, sizeof message->text, "gnuplot cannot be run: %s",
                     strerror(errno));
        } else if (status != 0) {
            read_complaint(g, complaint);
            snprintf(message->text, sizeof message->text, "gnuplot failed: %s", complaint);
        } else {
            good = fetch(g, directory, stem, message);
        }
    }
    remove_scratch(g);
    return good;
}
