/* command_view.c - `stance view FILE`: a results file as one page that simulates its cases. */
#include "page_data.h"

#include "runner/base/command.h"
#include "runner/base/message.h"
#include "runner/base/sandbox.h"
#include "runner/store/search_file.h"

#include <errno.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;
extern const struct command command_view; /* below */

enum { MOST_FILES = 64, NAME = 1100 };

struct request {
    struct option_texts files, answers;
    const char *place;
    bool open;
    struct page_request page;
    const char *file, *out;          /* the one at hand, its page */
    char name[MOST_FILES + 1][NAME]; /* of the pages, and behind them of the index */
};

/* ---- writing ------------------------------------------------------------------------------ */

static int failed(const char *file, const char *what)
{
    fprintf(stderr, "%s: cannot %s: %s\n", file, what, strerror(errno));
    return EXIT_IO;
}

/* The whole page, or nothing; `good`: what is written is right, else message says why not. */
static int end(struct whole_file *w, bool good, const stance_message *message)
{
    if (whole_file_end(w, good))
        return EXIT_DONE;
    if (good)
        return failed(w->name, "write");
    fprintf(stderr, "%s\n", message->text);
    return EXIT_IO;
}

/* Adds all of `from`, which is closed; false: it could not be read or had not been written whole.
 */
static bool append(FILE *from, FILE *to)
{
    char piece[1 << 16];
    bool good = fflush(from) == 0 && !ferror(from);
    rewind(from);
    for (size_t n; good && (n = fread(piece, 1, sizeof piece, from)) > 0;)
        fwrite(piece, 1, n, to);
    good = good && !ferror(from);
    fclose(from);
    return good;
}

/* r NULL: of a search. */
static int write_page(const struct request *request, const struct results *r)
{
    const char *const template = page_template(), *const data = strstr(template, PAGE_DATA),
                      *const more = strstr(template, PAGE_MORE);
    stance_message message = {""};
    struct whole_file w;
    FILE *const rest = tmpfile(); /* what stands behind the script, told of in the head before it */
    if (!rest) {
        failed("a temporary file", "write");
        return EXIT_IO;
    }
    if (!whole_file_begin(&w, request->out)) {
        failed(w.name, "write");
        fclose(rest);
        return EXIT_IO;
    }
    const char *const script = data + strlen(PAGE_DATA);
    fwrite(template, 1, (size_t)(data - template), w.out);
    bool good = r ? page_data_write(w.out, rest, r, &request->page, &message)
                  : page_search_write(w.out, request->file, &message);
    fwrite(script, 1, (size_t)(more - script), w.out);
    if (!append(rest, w.out) && good)
        good = complain(&message, "%s: cannot write a temporary file: %s", w.name, strerror(errno));
    fputs(more + strlen(PAGE_MORE), w.out);
    return end(&w, good, &message);
}

static int view(void *context)
{
    struct request *const request = context;
    struct results r;
    stance_message message = {""};
    if (search_file_is(request->file))
        return write_page(request, NULL);
    if (!results_open(&r, request->file, &message)) {
        fprintf(stderr, "%s\n", message.text);
        return EXIT_IO;
    }
    int code = EXIT_USAGE;
    if (r.cases > PAGE_MOST_CASES)
        fprintf(stderr,
                "%s: has %llu cases; a page carries up to %d: draw them (stance plot), or run "
                "fewer points (--set sweep.grid[0].count=...) and look closer in the page, which "
                "computes what lies between them\n",
                request->file, (unsigned long long)r.cases, PAGE_MOST_CASES);
    else if (r.damage.cases > 0) {
        fprintf(stderr, "%s: no page is made of a damaged file\n", request->file);
        code = EXIT_IO;
    } else
        code = write_page(request, &r);
    results_close(&r);
    return code;
}

/* ---- several files ------------------------------------------------------------------------ */

static int write_index(void *context)
{
    struct request *const request = context;
    stance_message message = {""};
    struct whole_file w;
    if (!whole_file_begin(&w, request->name[request->files.count]))
        return failed(w.name, "write");
    bool good = true;
    page_index_begin(w.out);
    for (size_t i = 0; good && i < request->files.count; i++)
        good = page_index_card(w.out, request->files.text[i], strrchr(request->name[i], '/') + 1,
                               &message);
    page_index_end(w.out);
    return end(&w, good, &message);
}

/* ---- the command -------------------------------------------------------------------------- */

static bool is_directory(const char *place)
{
    struct stat status;
    return stat(place, &status) == 0 && S_ISDIR(status.st_mode);
}

/* FILE.html beside the file, PLACE, or in the directory PLACE. False: it is too long. */
static bool name_page(struct request *request, size_t i)
{
    const char *const file = request->files.text[i], *const place = request->place;
    char *const out = request->name[i];
    const char *const slash = strrchr(file, '/'), *const name = slash ? slash + 1 : file;
    const size_t length = strlen(name),
                 stem = length > 3 && strcmp(name + length - 3, ".h5") == 0 ? length - 3 : length;
    int n;
    if (place && !is_directory(place) && request->files.count == 1)
        n = snprintf(out, NAME, "%s", place);
    else if (place)
        n = snprintf(out, NAME, "%s/%.*s.html", place, (int)stem, name);
    else
        n = snprintf(out, NAME, "%.*s%.*s.html", (int)(name - file), file, (int)stem, name);
    return n > 0 && n < NAME;
}

/* The browser that the desktop has. What it says is of no interest, whether there is one is. */
static int show(const char *page)
{
    char *const arguments[] = {(char *)"xdg-open", (char *)page, NULL};
    pid_t child;
    int status;
    if (posix_spawnp(&child, "xdg-open", NULL, NULL, arguments, environ) == 0 &&
        waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0)
        return EXIT_DONE;
    fprintf(stderr, "stance view: no browser could be opened (xdg-open): open %s in one\n", page);
    return EXIT_DONE;
}

/* No page is written over a results file, another file's page, or the index. */
static bool names_differ(struct request *request)
{
    const size_t files = request->files.count;
    const char *const *const file = (const char *const *)request->files.text;
    snprintf(request->name[files], NAME, "%.1000s/index.html",
             request->place ? request->place : "");
    for (size_t i = files; i-- > 0;) {
        if (!name_page(request, i))
            return command_usage(&command_view, "the page's name is too long"), false;
        const char *const name = request->name[i];
        for (size_t k = 0; k < files; k++)
            if (same_file(name, file[k])) {
                fprintf(stderr, "stance view: %s is a results file: give its page another name\n",
                        name);
                return false;
            }
        for (size_t k = i + 1; files > 1 && k <= files; k++)
            if (strcmp(name, request->name[k]) == 0) {
                fprintf(stderr, "stance view: %s: its page would be written over %s%s, %s\n",
                        file[i], k < files ? "that of " : "the index", k < files ? file[k] : "",
                        name);
                return false;
            }
    }
    return true;
}

/* The page of each file, and of several the one that leads to them: request->out in the end. */
static int write_pages(struct request *request)
{
    const size_t files = request->files.count;
    int code = EXIT_DONE;
    for (size_t i = 0; code == EXIT_DONE && i < files; i++) {
        request->file = request->page.file = request->files.text[i];
        request->out = request->name[i];
        code = sandbox(view, request, request->file);
    }
    if (code == EXIT_DONE && files > 1) {
        request->out = request->name[files];
        code = sandbox(write_index, request, request->place);
    }
    if (code == EXIT_DONE)
        printf("%s\n", request->out);
    return code;
}

static int run(int argc, char **argv)
{
    struct request request = {.open = false};
    const int begun = command_begin(&command_view, argc, argv, &request);
    if (begun != COMMAND_GOES_ON)
        return begun;
    if (!strstr(page_template(), PAGE_DATA)) {
        fputs("stance view: this program was built without the page; `make web` builds both "
              "(analysis/README.md says what that takes)\n",
              stderr);
        return EXIT_USAGE;
    }
    request.page.answer = request.answers.text;
    request.page.answers = request.answers.count;
    for (size_t k = 0; k < request.answers.count; k++)
        request.page.whole = request.page.whole || strcmp(request.answers.text[k], "all") == 0;
    if (request.files.count > 1 && !request.place)
        return command_usage(&command_view, "pages of several files need a directory: -o DIR");
    /* What has another ending is not written over. */
    const size_t length = request.place ? strlen(request.place) : 0;
    if (request.files.count == 1 && request.place && !is_directory(request.place) &&
        (length <= 5 || strcmp(request.place + length - 5, ".html") != 0))
        return command_usage(&command_view, "-o takes a directory, or a name that ends in .html");
    if (!names_differ(&request))
        return EXIT_USAGE;
    if (request.files.count > 1 && mkdir(request.place, 0777) != 0 && errno != EEXIST)
        return failed(request.place, "make");
    const int code = write_pages(&request);
    if (code != EXIT_DONE)
        return code;
    return request.open ? show(request.out) : EXIT_DONE;
}

static const char *answer_word(size_t k)
{
    return k < STANCE_ANSWER_COUNT    ? stance_answers[k].name
           : k == STANCE_ANSWER_COUNT ? "all"
                                      : NULL;
}

#define TO(member) OPTION_TO(struct request, member)
static const struct option options[] = {
    {"FILE...", TO(files), .low = 1, .high = MOST_FILES, .text = "a results file"},
    {"-o", "PLACE", TO(place),
     .text = "the page's name, which ends in .html, or a directory; a file of that name is "
             "replaced, unless it is one of the results files"},
    {"--answers", "A,...|all", TO(answers), .most = 1, .listed = true, .word = answer_word,
     .text = "the answers that the page carries, for colours and for what the pointer shows; "
             "`all` of them. Unasked as many as take 24 MB. What is left out the page computes "
             "where one clicks"},
    {"--open", TO(open), .text = "opens it in the browser"},
    {0},
};

const struct command command_view = {
    "view",
    "a page for the browser: a map whose cases are simulated where one clicks",
    run,
    options,
    "Writes one self-contained page, NAME.html beside the file, which any browser opens from "
    "disk: no server, no network, nothing to install. It holds the file's labels, checksums and "
    "answers, its scenario, and the engine that computed it. A click on a case simulates and "
    "plays it, with the bits that the file has; parameters can be changed there and the map "
    "computed anew. Of several files there is a page each, and index.html leads to them: with -o "
    "DIR. Of a search (stance optimise) the page has its curves.\n",
    NULL,
};
