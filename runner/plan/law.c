/* law.c - see law.h. */
#include "law.h"

#include "runner/base/problem.h"
#include "runner/objects/program.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { PATH = 4200, LINE = 1024, MOST_NAMES = 48 * STANCE_PROGRAM_NUMBERS };

/* $XDG_CONFIG_HOME/stance/trusted; `make`: with its directories. false: there is no such place. */
static bool trusted_file(char path[PATH], bool make)
{
    const char *const own = getenv("XDG_CONFIG_HOME"), *const home = getenv("HOME");
    const bool given = own && own[0] == '/';
    if (!given && !(home && home[0] == '/'))
        return false;
    int n = snprintf(path, PATH - 32, "%s%s", given ? own : home, given ? "" : "/.config");
    if (n < 0 || n >= PATH - 32)
        return false;
    if (make)
        mkdir(path, 0700);
    n += snprintf(path + n, 8, "/stance");
    if (make)
        mkdir(path, 0700);
    snprintf(path + n, 9, "/trusted");
    return true;
}

bool law_is_trusted(const struct scenario *s, char *hash)
{
    char path[PATH], line[LINE];
    bool found = false;
    program_hash(s->law.source, hash);
    FILE *const in = trusted_file(path, false) ? fopen(path, "r") : NULL;
    while (in && !found && fgets(line, sizeof line, in)) {
        const size_t length = strcspn(line, " \t\r\n");
        found = length == strlen(hash) && strncmp(line, hash, length) == 0;
    }
    if (in)
        fclose(in);
    return found;
}

/* Where it stands: a scenario may name a file and hold another text. */
static const char *place_of(const struct scenario *s, char text[SHOWN_SIZE + 40])
{
    char name[SHOWN_SIZE];
    if (s->law.held)
        snprintf(text, SHOWN_SIZE + 40, "controller.source: the text in the scenario itself");
    else
        snprintf(text, SHOWN_SIZE + 40, "controller.file: %s", shown(name, s->law.name));
    return text;
}

/* What cannot be kept is trusted this once. */
static void keep_trust(const struct scenario *s, const char *hash)
{
    char path[PATH], name[SHOWN_SIZE + 40];
    const bool known = trusted_file(path, true);
    FILE *const out = known ? fopen(path, "a") : NULL;
    if (out)
        fprintf(out, "%s  %s\n", hash, place_of(s, name));
    if (!out || fclose(out) != 0)
        fprintf(stderr, "stance: the law is trusted for this time alone: %s%s%s\n",
                known ? path : "HOME names no folder", known ? ": " : "",
                known ? strerror(errno) : "");
}

void law_ask(const struct scenario *s, const char *hash, stance_message *message)
{
    char place[SHOWN_SIZE + 40];
    complain(message,
             "%s is C code that you have not run yet (SHA-256 %.12s...): read it, and add --trust",
             place_of(s, place), hash);
}

enum law_state law_take(struct scenario *s, enum law_trust trust, stance_message *message)
{
    char hash[CHECKSUM_SHA256_TEXT];
    if (!s->law.source)
        return LAW_NONE;
    if (trust != LAW_ASKED && !law_is_trusted(s, hash)) {
        if (trust == LAW_ASK) {
            law_ask(s, hash, message);
            return LAW_UNTRUSTED;
        }
        keep_trust(s, hash);
    }
    char names[MOST_NAMES] = "";
    for (size_t i = 0; i < s->law.parameters; i++) {
        const struct law_parameter *const p = &s->law.parameter[i];
        add_text(names, sizeof names, p->count ? "%s[%zu];" : "%s;", p->name, p->count);
    }
    const struct program_text text = {
        .file = s->law.name,
        .source = s->law.source,
        .parameters = names,
        .data = s->law.data,
        .count = s->law.data_count,
        .samples = s->sample.given ? s->axis[s->axes - 1].count : 1,
    };
    s->program = program_load(&text, s->scene, s->law.numbers, message);
    s->program_free = program_free;
    s->base.program = s->program;
    return s->program ? LAW_READY : LAW_BROKEN;
}
