/* scenario_file.c - the text of a scenario file. */
#include "reader.h"
#include "tree_nodes.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/magic.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

enum { PATH_SIZE = 160, FILE_PATH = 1300 };

/* Whether reading would wait for a writer who may never come. A pipe without a name, such as the
 * shell's <(command), has one from the start. */
static bool is_deserted(int descriptor)
{
    enum { PATIENCE = 900 }; /* ms */
    struct pollfd waited = {.fd = descriptor, .events = POLLIN};
    struct stat status;
    struct statfs system;

    return fstat(descriptor, &status) == 0 && S_ISFIFO(status.st_mode) &&
           fstatfs(descriptor, &system) == 0 && system.f_type != PIPEFS_MAGIC &&
           poll(&waited, 1, PATIENCE) == 0;
}

/* NULL: see errno. */
static FILE *open_file(const char *file)
{
    int descriptor = open(file, O_RDONLY | O_NONBLOCK | O_CLOEXEC), error = ETIMEDOUT;
    FILE *in = NULL;

    if (descriptor >= 0 && !is_deserted(descriptor)) {
        fcntl(descriptor, F_SETFL, 0); /* now wait for whatever comes */
        in = fdopen(descriptor, "rb");
        error = errno;
    }
    if (descriptor >= 0 && !in) {
        close(descriptor);
        errno = error;
    }
    return in;
}

char *scenario_text(const char *file, struct problems *problems, size_t *length)
{
    struct mark nowhere = {0};
    struct stat status;
    char *text = NULL;
    FILE *in = open_file(file);

    if (!in || fstat(fileno(in), &status) != 0) {
        const int error = errno;
        char with[PATH_SIZE];
        snprintf(with, sizeof with, "%s.yaml", file);
        if (error == ENOENT && strlen(file) < sizeof with - 5 && access(with, R_OK) == 0)
            problem_add(problems, nowhere, "%s; did you mean '%s'?", strerror(error), with);
        else
            problem_add(problems, nowhere, "%s",
                        error == ETIMEDOUT ? "a named pipe into which nothing is written"
                                           : strerror(error));
    } else if (S_ISDIR(status.st_mode)) {
        problem_add(problems, nowhere, "is a directory, not a scenario file");
    } else if (!(text = malloc(TREE_MAX_BYTES + 2))) {
        problem_add(problems, nowhere, "out of memory");
    } else {
        *length = fread(text, 1, TREE_MAX_BYTES + 1, in);
        text[*length] = '\0';
        const char *wrong = ferror(in) ? strerror(errno) : NULL;
        if (!wrong && *length > TREE_MAX_BYTES)
            wrong = "larger than 1 MiB, the most a scenario may take";
        if (*length >= 8 && memcmp(text, "\x89HDF\r\n\x1a\n", 8) == 0) {
            problem_add(problems, nowhere,
                        "a results file, not a scenario; write stance summary %s", file);
            free(text);
            text = NULL;
        } else if (wrong) {
            problem_add(problems, nowhere, "%s", wrong);
            free(text);
            text = NULL;
        }
    }
    if (in)
        fclose(in);
    return text;
}

/* ---- what a scenario names ---------------------------------------------------------------------
 */

/* Beside the scenario, unless it is absolute. */
static void beside(const struct reader *r, const char *name, char path[FILE_PATH])
{
    const char *const slash = strrchr(r->s->file, '/');
    const int directory = name[0] == '/' || !slash ? 0 : (int)(slash - r->s->file) + 1;
    snprintf(path, FILE_PATH, "%.*s%s", directory, r->s->file, name);
}

const char *reader_file(struct reader *r, const char *key, const struct tree_node *node,
                        size_t most)
{
    char path[FILE_PATH];
    struct stat status;
    beside(r, node->text, path);
    char *const text = tree_allocate(&r->tree, most + 2);
    FILE *const in = text ? open_file(path) : NULL;
    const char *wrong = NULL;
    size_t length = 0;
    if (!text)
        wrong = "out of memory";
    else if (in && fstat(fileno(in), &status) == 0 && !S_ISREG(status.st_mode))
        wrong = "is no regular file";
    else if (in)
        length = fread(text, 1, most + 1, in);
    if (!wrong && (!in || ferror(in)))
        wrong = strerror(errno);
    if (length > most)
        wrong = "is larger than may be (256 KiB of source, 512 KiB of numbers)";
    if (in)
        fclose(in);
    if (wrong) {
        problem_add(&r->problems, node->mark, "%s: %.200s: %s", key, path, wrong);
        return NULL;
    }
    struct problems ignored = {0};
    if (memchr(text, '\0', length) || !tree_check_text(text, length, &ignored)) {
        problem_add(&r->problems, node->mark, "%s: %.200s: is no text in UTF-8", key, path);
        return NULL;
    }
    return text;
}
