/* claim.c - see claim.h. */
#include "claim.h"
#include "work.h"

#include "runner/base/message.h"
#include "runner/ranks/crash.h"
#include "runner/ranks/deadline.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

bool claim_ranks(const char *who, struct parallel *parallel)
{
    bool first;
    if (parallel_misses_launcher(&first)) {
        if (first)
            fprintf(stderr,
                    "stance %s: srun started several of these without an MPI that joins them: use "
                    "mpirun, or srun --mpi=pmix\n",
                    who);
        return false;
    }
    store_prepare();
    *parallel = parallel_start();
    if (parallel->size > 1)
        deadline_prepare(parallel->rank);
    crash_watch(parallel->rank);
    work_catch_signals();
    return true;
}

int claim_options(const struct parallel *parallel, const struct command *command, int argc,
                  char **argv, void *options)
{
    int code = parallel->rank == 0 ? command_begin(command, argc, argv, options) : EXIT_DONE;
    parallel_broadcast(parallel, &code, sizeof code);
    return code == COMMAND_GOES_ON && parallel->rank != 0
               ? command_begin(command, argc, argv, options)
               : code;
}

bool claim_scenario(const struct parallel *parallel, struct scenario *s, const char *file,
                    bool read, stance_message *message)
{
    uint64_t length = parallel->rank == 0 && read ? strlen(s->text) + 1 : 0;

    message->text[0] = '\0';
    parallel_broadcast(parallel, &length, sizeof length);
    if (length == 0)
        return false;
    char *const text = parallel->rank == 0 ? s->text : malloc(length);
    if (!text)
        abort(); /* the others wait in the broadcast: MPI ends the job */
    parallel_broadcast(parallel, text, length);
    if (parallel->rank == 0)
        return true;
    const bool good = s && scenario_read(s, file, text, NULL, 0, NULL);
    free(text);
    return good || complain(message, "a rank cannot read the scenario that rank 0 reads");
}

bool claim_file(const char *file, bool force, bool resume, bool own, struct lock *lock,
                bool *exists, stance_message *message)
{
    struct stat information;

    *exists = lstat(file, &information) == 0;
    if (*exists && !force && !resume)
        return complain(message, "%.150s exists; --force replaces it, --resume goes on with it",
                        file);
    if (*exists && !S_ISREG(information.st_mode) && !S_ISLNK(information.st_mode))
        return complain(message, "%.200s: not a regular file", file);
    if (own && mkdir("results", 0777) != 0 && errno != EEXIST)
        return complain(message, "cannot make the directory results: %s", strerror(errno));
    /* A link that is replaced is a file of its own; through others the file they name is written.
     */
    return (force ? lock_take : lock_take_through)(lock, file, message);
}

static void print_word(FILE *to, const char *word)
{
    if (word[strspn(word, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                          "_-+./,:=@%")] == '\0' &&
        word[0]) {
        fprintf(to, " %s", word);
        return;
    }
    fputs(" '", to);
    for (; *word; word++)
        fputs(*word == '\'' ? "'\\''" : (const char[]){*word, '\0'}, to);
    fputc('\'', to);
}

void claim_say_stopped(const struct parallel *parallel, int argc, char **argv, const char *again,
                       const char *what)
{
    char *line = NULL; /* in one piece: a launcher mixes what ranks write in pieces */
    size_t size = 0;
    FILE *to = parallel->rank == 0 ? open_memstream(&line, &size) : NULL;
    if (!to)
        return;
    fprintf(to, "stance %s: %s; go on with:", argv[0], what);
    if (parallel->size > 1)
        fprintf(to, " mpirun -n %d", parallel->size);
    print_word(to, program_invocation_name);
    for (int i = 0; i < argc; i++)
        if (strcmp(argv[i], "--force") != 0 && strcmp(argv[i], "--resume") != 0)
            print_word(to, argv[i]);
    fprintf(to, " %s\n", again);
    if (fclose(to) == 0)
        fputs(line, stderr);
    free(line);
}
