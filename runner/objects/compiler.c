/* compiler.c - see compiler.h. */
#include "compiler.h"
#include "sources.h"

#include "runner/base/checksum.h"
#include "runner/base/message.h"

#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <limits.h>
#include <sched.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

/* From the Makefile: what the kernels of the program are compiled with. */
#ifndef STANCE_OBJECT_FLAGS
#define STANCE_OBJECT_FLAGS ""
#define STANCE_OBJECT_ISAS
#endif

/* An object needs nothing but functions of the C library, which the program has. Warnings are for
 * those who write kernels. */
#define FLAGS                                                                                      \
    STANCE_OBJECT_FLAGS " -w -g0 -pipe -fPIC -fvisibility=hidden -shared -nostdlib -I."            \
                        " -DSTANCE_OBJECT -DSTANCE_SCENE_LANES=\"" COMPILER_TABLES "\""
#define ISA(name, ...) {#name, FLAGS " " #__VA_ARGS__},
static const struct {
    const char *name, *flags;
} isas[] = {STANCE_OBJECT_ISAS{NULL, NULL}};
#undef ISA

enum { FLAGS_SIZE = 1000, ARGUMENTS = 100, OUTPUT = 4000 };

const char *compiler_isa(size_t index)
{
    return isas[index].name;
}

const char *compiler_flags(const char *isa)
{
    for (size_t i = 0; isas[i].name; i++)
        if (strcmp(isas[i].name, isa) == 0)
            return isas[i].flags;
    return NULL;
}

/* Splits text at blanks, in place; at most `most` words. */
static size_t split(char *text, char **word, size_t most)
{
    char *rest = NULL;
    size_t n = 0;
    for (char *w = strtok_r(text, " ", &rest); w && n < most; w = strtok_r(NULL, " ", &rest))
        word[n++] = w;
    return n;
}

/* ---- processes ----------------------------------------------------------------------------- */

/* This process's environment, but for temporary files in the working directory and messages in
 * English; to be freed. */
static char **environment(void)
{
    static char tmpdir[] = "TMPDIR=.", language[] = "LC_ALL=C";
    size_t n = 0, kept = 0;
    while (environ[n])
        n++;
    char **const all = malloc((n + 3) * sizeof *all);
    for (size_t i = 0; all && i < n; i++)
        if (strncmp(environ[i], "TMPDIR=", 7) != 0 && strncmp(environ[i], "LC_ALL=", 7) != 0)
            all[kept++] = environ[i];
    if (all) {
        all[kept++] = tmpdir;
        all[kept++] = language;
        all[kept] = NULL;
    }
    return all;
}

/* Starts a program, in a directory (negative: here), that writes into `output`. Negative: it cannot
 * be started. */
static pid_t start(char *const *argument, int directory, int output)
{
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t group; /* of its own, to be ended as a whole */
    pid_t child;
    if (posix_spawn_file_actions_init(&actions) != 0)
        return -1;
    if (posix_spawnattr_init(&group) != 0) {
        posix_spawn_file_actions_destroy(&actions);
        return -1;
    }
    char **const variables = environment();
    const bool good =
        variables && posix_spawnattr_setflags(&group, POSIX_SPAWN_SETPGROUP) == 0 &&
        posix_spawnattr_setpgroup(&group, 0) == 0 &&
        posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0) == 0 &&
        posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO) == 0 &&
        posix_spawn_file_actions_adddup2(&actions, output, STDERR_FILENO) == 0 &&
        (directory < 0 || posix_spawn_file_actions_addfchdir_np(&actions, directory) == 0) &&
        posix_spawnp(&child, argument[0], &actions, &group, argument, variables) == 0;
    free(variables);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&group);
    return good ? child : -1;
}

/* Its status as of waitpid, -1 when there is none. Where the watch (NULL: nobody) says stop it is
 * ended. */
static int await(pid_t child, struct watch *watch)
{
    int status = -1;
    while (child > 0) {
        const pid_t found = waitpid(child, &status, watch && !watch->stopped ? WNOHANG : 0);
        if (found == child)
            return status;
        if (found < 0 && errno != EINTR)
            return -1;
        if (found == 0 && watch_wait(watch))
            kill(-child, SIGKILL);
    }
    return -1;
}

/* What a program wrote, up to OUTPUT bytes, as text. Closes the file. */
static void read_output(int output, char text[OUTPUT])
{
    const ssize_t n = pread(output, text, OUTPUT - 1, 0);
    text[n > 0 ? n : 0] = '\0';
    close(output);
}

/* ---- which compiler ------------------------------------------------------------------------ */

/* Appends what the compiler says to an option. false: it does not run, or fails, or says nothing.
 */
static bool ask(const struct compiler *compiler, char *option, char text[OUTPUT])
{
    char *argument[COMPILER_WORDS + 2];
    memcpy(argument, compiler->word, compiler->words * sizeof *argument);
    argument[compiler->words] = option;
    argument[compiler->words + 1] = NULL;
    const int output = memfd_create("compiler", MFD_CLOEXEC);
    if (output < 0)
        return false;
    const int status = await(start(argument, -1, output), NULL);
    read_output(output, text);
    return status == 0 && text[0];
}

/* It will run in another directory. */
static bool make_absolute(struct compiler *compiler)
{
    char here[PATH_MAX];
    const char *const name = compiler->word[0];
    if (name[0] == '/' || !strchr(name, '/'))
        return true;
    const int n = getcwd(here, sizeof here)
                      ? snprintf(compiler->path, sizeof compiler->path, "%s/%s", here, name)
                      : -1;
    compiler->word[0] = compiler->path;
    return n > 0 && (size_t)n < sizeof compiler->path;
}

/* Is there a compiler of this name? */
bool compiler_named(struct compiler *compiler, const char *name)
{
    static char version[] = "--version", machine[] = "-dumpmachine";
    char said[2 * OUTPUT], hash[CHECKSUM_SHA256_TEXT];
    if (strlen(name) >= sizeof compiler->text)
        return false;
    snprintf(compiler->text, sizeof compiler->text, "%s", name);
    compiler->words = split(compiler->text, compiler->word, COMPILER_WORDS);
    if (compiler->words == 0 || !make_absolute(compiler) || !ask(compiler, version, said))
        return false;
    snprintf(compiler->version, sizeof compiler->version, "%.*s", (int)strcspn(said, "\n"), said);
    if (!ask(compiler, machine, said + strlen(said)))
        return false;
    /* The name as well: `gcc -m32` says the same as `gcc`. */
    const size_t used = strlen(said);
    snprintf(said + used, sizeof said - used, "%s", name);
    checksum_sha256(said, strlen(said), hash);
    snprintf(compiler->identity, sizeof compiler->identity, "%.32s", hash);
    return true;
}

bool compiler_find(struct compiler *compiler, stance_message *why)
{
    static const char *const names[] = {"cc", "gcc", "clang"};
    const char *const chosen = getenv("CC");
    if (chosen && chosen[0])
        return compiler_named(compiler, chosen) ||
               complain(why, "the compiler CC='%.60s' does not run", chosen);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (compiler_named(compiler, names[i]))
            return true;
    return complain(why, "there is no compiler here (CC, cc, gcc, clang)");
}

bool compiler_label(const struct compiler *compiler, const char *const *text, size_t texts,
                    struct image_label *label)
{
    size_t size, embedded;
    char *all = NULL, hash[CHECKSUM_SHA256_TEXT];
    const char *const engine = sources(&embedded);
    FILE *const stream = open_memstream(&all, &size);
    for (size_t i = 0; stream && i < texts; i++)
        fwrite(text[i], 1, strlen(text[i]) + 1, stream); /* each with its end */
    if (stream)
        fwrite(engine, 1, embedded, stream);
    const bool good = stream && !ferror(stream);
    if ((stream && fclose(stream) != 0) || !good || !all) {
        free(all);
        return false;
    }
    checksum_sha256(all, size, hash);
    free(all);
    snprintf(label->key, sizeof label->key, "%.32s-%s", hash, compiler->identity);
    snprintf(label->compiler, sizeof label->compiler, "%s", compiler->version);
    return true;
}

/* ---- compiling ----------------------------------------------------------------------------- */

/* What a compiler that failed said: its first lines, from the first error on. */
static void complain_of(struct compilation *c, const struct compiler *compiler, int status,
                        char *said)
{
    const char *const error = strstr(said, "error");
    char *from = said;
    for (char *line = said; error && (line = strchr(line, '\n')) && line < error;)
        from = ++line;
    for (char *s = from; *s; s++)
        if ((unsigned char)*s < ' ')
            *s = s[1] && *s == '\n' ? '|' : ' ';
    const bool killed = status != -1 && WIFSIGNALED(status);
    if (c->source[0] && error) { /* a law: its first error alone, with its place */
        complain(&c->message, "%.*s", (int)strcspn(from, "|"), from);
        return;
    }
    complain(&c->message, "%.30s does not compile %s for %s (%s %d): %.130s", compiler->text,
             c->method, c->isa, killed ? "signal" : "exit code",
             status == -1 ? 127
             : killed     ? WTERMSIG(status)
                          : WEXITSTATUS(status),
             from[0] ? from : "and does not say why");
}

/* One that has been started. */
struct running {
    pid_t child;
    int output;
};

static void object_name(const struct compilation *c, char name[80])
{
    snprintf(name, 80, "%s-%s.so", c->source[0] ? "law" : c->method, c->isa);
}

static struct running begin(const struct compiler *compiler, int directory,
                            const struct compilation *c)
{
    char flags[FLAGS_SIZE], method[80], object[80], *argument[ARGUMENTS];
    static char to[] = "-o";
    const char *const own = compiler_flags(c->isa);
    snprintf(flags, sizeof flags, "%s %s", own ? own : "", c->flags ? c->flags : "");
    snprintf(method, sizeof method, "engine/methods/%s.c", c->method);
    object_name(c, object);
    memcpy(argument, compiler->word, compiler->words * sizeof *argument);
    size_t n = compiler->words;
    n += split(flags, argument + n, ARGUMENTS - COMPILER_WORDS - 4 - COMPILER_SOURCES);
    argument[n++] = to;
    argument[n++] = object;
    for (size_t i = 0; i < COMPILER_SOURCES && c->source[i]; i++)
        argument[n++] = (char *)(uintptr_t)c->source[i];
    if (!c->source[0])
        argument[n++] = method;
    argument[n] = NULL;
    struct running running = {-1, memfd_create("messages", MFD_CLOEXEC)};
    if (running.output >= 0)
        running.child = start(argument, directory, running.output);
    return running;
}

static void end(const struct compiler *compiler, int directory, struct running running,
                struct compilation *c, struct watch *watch)
{
    char name[80], said[OUTPUT] = "";
    if (watch->stopped && running.child > 0)
        kill(-running.child, SIGKILL);
    const int status = await(running.child, watch);
    if (running.output >= 0)
        read_output(running.output, said);
    object_name(c, name);
    const int object = openat(directory, name, O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
    c->image = (struct image){NULL, 0};
    if (status != 0 || object < 0 || !image_read(&c->image, object))
        complain_of(c, compiler, status, said);
    if (object >= 0)
        close(object);
}

size_t compiler_cores(void)
{
    cpu_set_t set;
    return sched_getaffinity(0, sizeof set, &set) == 0 ? (size_t)CPU_COUNT(&set) : 1;
}

static void run_all(const struct compiler *compiler, int directory, struct compilation *wanted,
                    size_t count, struct watch *watch)
{
    enum { MANY = 64 };
    struct running running[MANY] = {{.child = -1}};
    const size_t most = compiler_cores() < MANY ? compiler_cores() : MANY;
    for (size_t begun = 0, ended = 0; ended < (watch->stopped ? begun : count);) {
        if (begun < count && begun - ended < most && !watch->stopped) {
            running[begun % MANY] = begin(compiler, directory, &wanted[begun]);
            begun++;
        } else {
            end(compiler, directory, running[ended % MANY], &wanted[ended], watch);
            ended++;
        }
    }
}

static int remove_one(const char *path, const struct stat *information, int kind, struct FTW *at)
{
    (void)information, (void)kind, (void)at;
    return remove(path);
}

void compiler_run(const struct compiler *compiler, const struct compiler_file *file, size_t files,
                  struct compilation *wanted, size_t count, struct watch *watch)
{
    const char *const named = getenv("TMPDIR"), *const base = named && named[0] ? named : "/tmp";
    char place[PATH_MAX];
    snprintf(place, sizeof place, "%s/stance-XXXXXX", base);
    const int directory =
        mkdtemp(place) ? open(place, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC) : -1;
    bool written = directory >= 0 && sources_write(directory);
    for (size_t i = 0; written && i < files; i++)
        written = sources_write_file(directory, file[i].path, file[i].text, strlen(file[i].text));
    if (written)
        run_all(compiler, directory, wanted, count, watch);
    else
        for (size_t i = 0; i < count; i++)
            complain(&wanted[i].message, "nothing can be compiled in %.100s (TMPDIR): %s", base,
                     strerror(errno));
    if (directory >= 0) {
        close(directory);
        nftw(place, remove_one, 8, FTW_DEPTH | FTW_PHYS);
    }
}
