/* asked.c - commands that look at one scenario. */
#include "asked.h"
#include "instruction_set.h"
#include "law.h"
#include "plan.h"

#include "runner/base/checksum.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const struct option asked_options[] = {
    {"SCENARIO", OPTION_TO(struct asked, file), .low = 1, .text = "a scenario file"},
    {OPTION_SET(struct asked, sets)},
    {0},
};
const struct option asked_simulates[] = {
    {.rows = asked_options},
    {OPTION_TRUST(struct asked, trust)},
    {0},
};

bool asked_law(const struct scenario *s)
{
    char hash[CHECKSUM_SHA256_TEXT];
    if (!s->law.source || s->program || law_is_trusted(s, hash))
        return true;
    stance_message message;
    law_ask(s, hash, &message);
    fprintf(stderr, "%s: %s\n", s->file, message.text);
    return false;
}

const char *asked_method(size_t k)
{
    return stance_methods()[k] ? stance_methods()[k]->name : NULL;
}

struct scenario *asked_again(const char *file, const char *text, const char *const *sets,
                             size_t count)
{
    stance_message message;
    struct scenario *const s = scenario_new(file, text, sets, count, stderr);
    if (!s || law_take(s, LAW_ASK, &message) != LAW_BROKEN)
        return s;
    fprintf(stderr, "%s\n", message.text);
    scenario_drop(s);
    return NULL;
}

int asked_work(const struct asked *asked, int (*work)(const struct scenario *s, void *request),
               void *request)
{
    struct scenario *const s =
        scenario_new(asked->file, NULL, asked->sets.text, asked->sets.count, stderr);
    if (!s)
        return access(asked->file, R_OK) == 0 ? EXIT_USAGE : EXIT_IO;
    stance_message message;
    const bool broken = law_take(s, asked->trust ? LAW_TRUST : LAW_ASK, &message) == LAW_BROKEN;
    if (broken)
        fprintf(stderr, "%s\n", message.text);
    const int code = broken ? EXIT_USAGE : work(s, request);
    scenario_drop(s);
    return code;
}

int asked_run(const struct command *command, int argc, char **argv,
              int (*work)(const struct scenario *s, void *request), void *request)
{
    const int code = command_begin(command, argc, argv, request);
    if (code != COMMAND_GOES_ON)
        return code;
    return instruction_set_usable(command->name) ? asked_work(request, work, request) : EXIT_USAGE;
}

int asked_first(const struct command *command, const struct scenario *s,
                int (*work)(const struct scenario *s, const stance_case *c, void *request),
                void *request)
{
    const struct parallel alone = parallel_alone();
    struct plan plan;
    struct plan_error error = {0};
    stance_case *const c = calloc(1, sizeof *c);
    const char *why = c ? error.message.text : strerror(ENOMEM);
    int code = EXIT_USAGE;
    const bool made = c && plan_make(&plan, s, true, 0, false, &error);
    if (made && plan_compute_designs(&plan, &alone, &error) && plan_check_cases(&plan, &error)) {
        why = plan_resolve(&plan, 0, c, NULL) ? NULL : "the first case does not exist";
        code = why ? EXIT_USAGE : work(s, c, request);
    }
    if (why)
        fprintf(stderr, "stance %s: %s\n", command->name, why);
    if (made)
        plan_free(&plan);
    free(c);
    return code;
}
