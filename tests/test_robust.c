/* test_robust.c - signs of life and what others make of them. */
#include "support.h"

#include "runner/run/heartbeat.h"

#include <unistd.h>

/* ---- signs of life ------------------------------------------------------------------------ */

struct place {
    char file[64], lock[80];
};

static int make_place(void **state)
{
    struct place *place = calloc(1, sizeof *place);
    snprintf(place->file, sizeof place->file, "/tmp/stance-heartbeat-%d.h5", getpid());
    snprintf(place->lock, sizeof place->lock, "%s.lock", place->file);
    *state = place;
    return 0;
}

static int remove_place(void **state)
{
    struct place *place = *state;
    unlink(place->file);
    unlink(place->lock);
    free(place);
    return 0;
}
static CMFixtureFunction before_each = make_place, after_each = remove_place;

static void put(const char *file, const char *text)
{
    FILE *to = fopen(file, "w");
    assert_non_null(to);
    fputs(text, to);
    fclose(to);
}

TEST(test_pulse)
{
    const struct place *place = *state;
    struct parallel alone = parallel_alone();
    struct lock lock;
    struct heartbeat heartbeat;
    struct heartbeat_note note;
    stance_message message = {""};

    heartbeat_read(place->file, &note);
    assert_false(note.running || note.exists);
    parallel_share(&alone);
    assert_true(lock_take(&lock, place->file, false, &message));
    assert_true(heartbeat_begin(&heartbeat, &lock, &alone, "testing"));
    put(place->file, "results");
    heartbeat_guard(&heartbeat, place->file);
    heartbeat_read(place->file, &note);
    assert_true(note.running && note.here && note.exists);
    assert_string_equal(note.doing, "testing");
    assert_true(note.rate < 0);
    /* The rate is that of the last minute, whatever was before. */
    const double begin = heartbeat.due;
    uint64_t computed = 0;
    for (int k = 0; k <= 100; k++) {
        computed += k < 50 ? 7000 : 10;
        assert_true(heartbeat_beat(&heartbeat, begin + 2 * k, computed, 3, &message));
        assert_true(heartbeat_beat(&heartbeat, begin + 2 * k + 1, 0, 3, &message)); /* not yet */
    }
    heartbeat_read(place->file, &note);
    assert_true(fabs(note.rate - 5) < 1e-9);
    assert_true(note.computed == computed && note.round == 3);
    assert_true(note.ranks == 1 && note.alive == 1);
    /* Another file of that name, and none. */
    put(place->lock, "");
    unlink(place->file);
    assert_false(heartbeat_beat(&heartbeat, begin + 300, 0, 0, &message));
    assert_non_null(strstr(message.text, "was removed, moved or replaced"));
    heartbeat_end(&heartbeat);
    lock_release(&lock);
    parallel_unshare(&alone);
}

/* Whatever the note holds. */
TEST(test_strange_notes)
{
    static const char *const notes[] = {
        "",
        "{",
        "rubbish",
        "[1, 2]",
        "{\"host\": 1}",
        "{\"host\": \"x\"}",
        "{\"host\":\"x\",\"doing\":\"y\",\"start\":\"0\"}",
    };
    const struct place *place = *state;
    struct heartbeat_note note;
    for (size_t k = 0; k < COUNT(notes); k++) {
        put(place->lock, notes[k]);
        heartbeat_read(place->file, &note);
        assert_false(note.exists || note.running);
    }
    put(place->lock, "{\"host\":\"a\\u001b[2Jb\",\"doing\":\"y\",\"start\":0,\"time\":1,"
                     "\"ranks\":1,\"alive\":1,\"round\":0,\"computed\":1,\"rate\":-1}");
    heartbeat_read(place->file, &note);
    assert_true(note.exists && !note.running && note.age > 1e6);
    assert_string_equal(note.host, "a?[2Jb");
}
