/* command_merge.c - `stance merge OUT FILE FILE...`: the files of an array job into one. */
#include "lock.h"
#include "merge.h"

#include "runner/base/command.h"
#include "runner/base/message.h"
#include "runner/base/sandbox.h"
#include "runner/base/words.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

extern const struct command command_merge; /* below */

struct request {
    struct option_texts operands;
    const char *output, **files;
    size_t count;
    bool force;
};

/* Where all files are shards of one sweep, of one number of shards: those that no file is of. */
static void name_missing_shards(const struct merge *m)
{
    enum { NAMED = 8 };
    const uint64_t count = m->kind == MERGE_EQUAL ? m->part[0].of.origin.shard.count : 0;
    uint64_t missing = 0;
    char list[NAMED * 20] = "";
    for (size_t p = 0; p < m->parts; p++)
        if (m->part[p].of.origin.shard.count != count)
            return;
    for (uint64_t k = 1; k <= count; k++) {
        bool there = false;
        for (size_t p = 0; p < m->parts && !there; p++)
            there = m->part[p].of.origin.shard.number == k;
        if (!there && ++missing <= NAMED)
            words_add(list, sizeof list, "%s %llu/%llu", list[0] ? "," : "", (unsigned long long)k,
                      (unsigned long long)count);
    }
    if (missing > NAMED)
        words_add(list, sizeof list, " and %llu more", (unsigned long long)(missing - NAMED));
    if (missing > 0)
        fprintf(stderr, "stance merge: not among the files: shard%s\n", list);
}

static void print_result(const struct request *request, const struct merge *m)
{
    const struct adopted_rows *rows = &m->rows;
    const struct adopted *const first = &m->part[0].of;
    const bool one = rows->damaged == 1;
    printf("%s: %llu cases from %zu files", request->output, (unsigned long long)m->scenario->cases,
           m->parts);
    if (m->kind != MERGE_EQUAL)
        printf(" along %s, %zu values", m->path, m->points);
    if (rows->same > 0)
        printf("; %llu were in several files, and equal", (unsigned long long)rows->same);
    if (rows->copied < m->scenario->cases)
        printf("; %llu are not computed yet",
               (unsigned long long)(m->scenario->cases - rows->copied));
    putchar('\n');
    name_missing_shards(m);
    if (rows->damaged > 0)
        fprintf(stderr, "stance merge: %llu case%s left out: not as %s say%s\n",
                (unsigned long long)rows->damaged, one ? "" : "s",
                one ? "its checksum" : "their checksums", one ? "s" : "");
    for (size_t p = 1; p < m->parts; p++) {
        const struct adopted *const part = &m->part[p].of;
        if (strcmp(part->origin.revision, first->origin.revision) != 0) {
            fprintf(stderr,
                    "stance merge: warning: %s was begun by revision %s, %s by %s: results "
                    "may differ\n",
                    part->file, part->origin.revision, first->file, first->origin.revision);
            break;
        }
    }
    for (int k = 0; k < MERGE_NOTES; k++)
        if (m->noted[k])
            fprintf(stderr, "stance merge: %s (attribute merge_note)\n", merge_notes[k]);
}

/* Whether all parts can be read now: nobody writes them. */
static bool at_rest(const struct request *request)
{
    char note[LOCK_NOTE];
    for (size_t p = 0; p < request->count; p++) {
        if (lock_is_held(request->files[p], note)) {
            fprintf(stderr, "stance merge: %s: a job is writing it\n", request->files[p]);
            return false;
        }
    }
    return true;
}

static int work(void *context)
{
    const struct request *request = context;
    struct merge m;
    store_prepare();
    struct lock lock = {.descriptor = -1};
    bool good = merge_plan(&m, request->files, request->count);
    m.usage = m.usage && !good;
    good = good && lock_take(&lock, request->output, false, &m.message) &&
           merge_write(&m, request->output);
    lock_release(&lock);
    if (good)
        print_result(request, &m);
    else
        fprintf(stderr, "stance merge: %s\n", m.message.text);
    const int code = good ? EXIT_DONE : m.usage ? EXIT_USAGE : EXIT_IO;
    merge_free(&m);
    return code;
}

static int start(struct request *request)
{
    if (strlen(request->output) >= 1024) {
        fprintf(stderr, "stance merge: %.60s...: %s\n", request->output, strerror(ENAMETOOLONG));
        return EXIT_USAGE;
    }
    for (size_t p = 1; p < request->count; p++) {
        for (size_t q = 0; q < p; q++) {
            if (strcmp(request->files[p], request->files[q]) == 0) {
                fprintf(stderr, "stance merge: %s is given twice\n", request->files[p]);
                return EXIT_USAGE;
            }
        }
    }
    if (!request->force && access(request->output, F_OK) == 0) {
        fprintf(stderr, "stance merge: %s exists; --force replaces it\n", request->output);
        return EXIT_IO;
    }
    return at_rest(request) ? sandbox(work, request, "one of the files") : EXIT_IO;
}

static int run(int argc, char **argv)
{
    struct request request = {.force = false};
    const int code = command_begin(&command_merge, argc, argv, &request);
    if (code != COMMAND_GOES_ON)
        return code;
    request.output = request.operands.text[0];
    request.files = request.operands.text + 1;
    request.count = request.operands.count - 1;
    return start(&request);
}

static const struct option options[] = {
    {"OUT FILE FILE...", OPTION_TO(struct request, operands), .low = 3,
     .text = "a file to write and two or more to read"},
    {"--force", OPTION_TO(struct request, force), .text = "replace OUT"},
    {0},
};

const struct command command_merge = {
    "merge",
    "the files of an array job into one",
    run,
    options,
    "The files' scenarios may\n"
    "\n"
    "  be equal                 each file has computed some of the cases: `stance run --shard`\n"
    "  differ along one axis    each file has some of its points: an array of tasks with --set "
    "sweep.grid[0].from=... or --set sweep.grid[0].values=...\n"
    "  differ in one value      which becomes the first axis: tasks with --set "
    "ground.friction=...\n"
    "\n"
    "and in their titles, of which the first is kept. Numbers are sorted where the files' own "
    "are; words stay in the order of the files. Every row is verified by its checksum and copied "
    "as it is, with its trajectory; cases that no file has stay pending. A case that several "
    "files have must be the same in all of them. OUT is a results file like any other, and "
    "`stance run --resume` computes what is pending; its attribute `merged_from` names the files "
    "and how many cases came from each.\n"
    "\n"
    "Random numbers are keyed by a case's index in its own file: with torque noise or "
    "sweep.refine.probes the merged file is not what one run of the whole gives. Nor is it along "
    "an axis that sweep.refine refines: each part was refined for itself. This is said, also in "
    "the attribute `merge_note`.\n",
    NULL,
};
