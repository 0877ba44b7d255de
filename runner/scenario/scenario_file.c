/* scenario_file.c - the text of a scenario file, and of what it names; changed texts. */
#include "reader.h"

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

/* Opens a file to be read; where a named pipe, reading which would wait for a writer who may never
 * come, is deserted, errno is ETIMEDOUT. A pipe without a name, such as the shell's <(command), has
 * a writer from the start. */
static FILE *open_file(const char *file, struct stat *status)
{
    enum { PATIENCE = 900 }; /* ms */
    const int descriptor = open(file, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    struct pollfd waited = {.fd = descriptor, .events = POLLIN};
    struct statfs system;
    FILE *in = NULL;
    if (descriptor < 0)
        return NULL;
    if (fstat(descriptor, status) == 0 && S_ISFIFO(status->st_mode) &&
        fstatfs(descriptor, &system) == 0 && system.f_type != PIPEFS_MAGIC &&
        poll(&waited, 1, PATIENCE) == 0) {
        errno = ETIMEDOUT;
    } else {
        fcntl(descriptor, F_SETFL, 0); /* now wait for whatever comes */
        in = fdopen(descriptor, "rb");
    }
    if (!in) {
        const int error = errno;
        close(descriptor);
        errno = error;
    }
    return in;
}

/* At most so many bytes, into text[most + 2], of which the last is 0. Returns what is wrong; NULL:
 * nothing. `larger`: what is said of more. `named`: a scenario names it, of which a stranger may
 * have made a pipe or a terminal that never ends. */
static const char *read_file(const char *file, bool named, char *text, size_t most,
                             const char *larger, size_t *length)
{
    struct stat status = {0};
    const bool other = named && stat(file, &status) == 0 && !S_ISREG(status.st_mode);
    *length = 0;
    if (other && !S_ISDIR(status.st_mode))
        return "is no regular file";
    FILE *const in = open_file(file, &status);
    const char *wrong = NULL;
    if (!in)
        return errno == ETIMEDOUT ? "a named pipe into which nothing is written" : strerror(errno);
    if (S_ISDIR(status.st_mode))
        wrong = "is a directory, not a file";
    else
        *length = fread(text, 1, most + 1, in);
    if (ferror(in))
        wrong = strerror(errno);
    else if (*length > most)
        wrong = larger;
    fclose(in);
    return wrong;
}

char *scenario_text(const char *file, struct problems *problems, size_t *length)
{
    const struct mark nowhere = {0};
    char *const text = calloc(1, TREE_MAX_BYTES + 2);
    if (!text) {
        problem_no_memory(problems);
        return NULL;
    }
    errno = 0;
    const char *const wrong = read_file(file, false, text, TREE_MAX_BYTES,
                                        "larger than 1 MiB, the most a scenario may take", length);
    char with[PATH_SIZE];
    snprintf(with, sizeof with, "%.*s.yaml", PATH_SIZE - 6, file);
    if (*length >= 8 && memcmp(text, "\x89HDF\r\n\x1a\n", 8) == 0)
        problem_add(problems, nowhere, "a results file, not a scenario; write stance summary %s",
                    file);
    else if (wrong && errno == ENOENT && strlen(file) + 5 < sizeof with && access(with, R_OK) == 0)
        problem_add(problems, nowhere, "%s; did you mean '%s'?", wrong, with);
    else if (wrong)
        problem_add(problems, nowhere, "%s", wrong);
    else
        return text;
    free(text);
    return NULL;
}

/* ---- what a scenario names ---------------------------------------------------------------------
 */

const char *reader_file(struct reader *r, const char *key, const struct tree_node *node,
                        size_t most)
{
    /* Beside the scenario, unless it is absolute. */
    const char *const slash = node->text[0] == '/' ? NULL : strrchr(r->s->file, '/');
    char path[FILE_PATH];
    size_t length;
    char *const text = tree_allocate(&r->tree, most + 2);
    struct problems ignored = {0};
    snprintf(path, sizeof path, "%.*s%s", slash ? (int)(slash - r->s->file) + 1 : 0, r->s->file,
             node->text);
    const char *wrong =
        text ? read_file(path, true, text, most,
                         "is larger than may be (256 KiB of source, 512 KiB of numbers)", &length)
             : "out of memory";
    if (!wrong && (memchr(text, '\0', length) || !tree_check_text(text, length, &ignored)))
        wrong = "is no text in UTF-8";
    if (wrong)
        problem_add(&r->problems, node->mark, "%s: %.200s: %s", key, path, wrong);
    return wrong ? NULL : text;
}

/* ---- changed texts --------------------------------------------------------------------------- */

/* Drops the key at a path of mappings' keys. */
static void drop_key(struct tree_node *node, const char *path)
{
    char name[TREE_MAX_NAME];
    size_t index = 0, i;
    for (bool first = true; node && *path; first = false) {
        if (!tree_path_step(&path, first, name, &index) || !tree_place(node, name, &i))
            return;
        if (!*path) {
            node->count--;
            memmove(&node->key[i], &node->key[i + 1], (node->count - i) * sizeof *node->key);
            memmove(&node->item[i], &node->item[i + 1], (node->count - i) * sizeof(void *));
            return;
        }
        node = node->item[i];
    }
}

char *scenario_rewrite(const char *text, const char *const *drop, size_t drops,
                       const char *const *set, size_t sets)
{
    struct tree tree = {0};
    struct problems *problems = calloc(1, sizeof *problems);
    char *result = NULL;
    bool good = problems && tree_parse(&tree, text, strlen(text), problems);
    for (size_t i = 0; good && i < drops; i++)
        drop_key(tree.root, drop[i]);
    for (size_t i = 0; good && i < sets; i++)
        good = tree_set(&tree, set[i], (int)i + 1, problems);
    if (good)
        result = tree_write(tree.root);
    tree_free(&tree);
    free(problems);
    return result;
}
