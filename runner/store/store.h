/* store.h - the results file: HDF5 that follows netCDF-4, written by independent raw writes.
 *
 * Layout (root group):
 *   one dimension scale per grid axis, named by its path, with values, `units`, `long_name`;
 *     an axis of several paths adds a variable "<path>" over that dimension for every further
 *     path; an axis of words is a string variable. Without a sweep: one dimension `case`, length 1.
 *   with sweep.sample as the last dimension `sample`, with what design its points are of and, where
 *     that has changed since there are files, the `generator` that made them: points of another
 *     generator are never mixed with new ones; "<path>" over it for every path that it varies.
 *   every answer of STANCE_ANSWERS (stance.h) over those dimensions, row-major in their order;
 * where a case has none `_FillValue`: NAN, of counts STANCE_NO_COUNT (0 in files of earlier
 * versions, which keep it when they are gone on with, and lack answers that came later); codes have
 * no such value; `status` (0 pending, 1 done, 2 failed), written after everything else of a case;
 *     `final_state` has a last dimension `state` (string names x ... vq2);
 *     `checksum`: CRC-32C over the case's stored answers in the order of the table, then
 *     `final_state` (where stored), then `status`, as the little-endian bytes of the file.
 *   group `design`: over those grid axes that the design depends on (scalar when none does):
 *     `gain` (..., actuator, posture_state), `equilibrium_position` (..., coordinate),
 *     `equilibrium_torque` (..., actuator), `start_position` (..., coordinate), all NAN where there
 *     is none, and `status`: done, or failed where the design does not exist.
 *   group `trajectory`, when recorded: dimensions case (value: flat index), time, coordinate,
 *     actuator, contact, component; `position`, `velocity`, `torque`, `force`, `gap`; NAN after
 *     the end of a case; `checksum` (case): CRC-32C over these five in this order.
 *   group `timing`: `wall_time` (rank, seconds of computing), `cases` (rank): the only part that
 *     differs between runs. A resumed run adds its ranks' numbers, modulo the length.
 *   root attributes: Conventions "CF-1.8", title, format_version (int 1), program_version,
 *     git_revision, compiler (with flags), library_versions, instruction_set (of what computes on
 *     rank 0: several are separated by ", "), ranks, hosts, date, seed, scenario (text), axes
 *     (comma-separated dimension names, in order), scenario_sha256. Of the file of a shard
 *     (shard.h) `shard`, "2/8", too: the other shards' cases stay pending, and no space is taken
 *     for them.
 *     Of a merged file also merged_from (a line for each part) and, where it is not what one run
 *     gives, merge_note.
 *   group `history`, in a file that went on with another scenario: the texts of the earlier ones,
 *     `scenario`, and their `git_revision` and `date`, the first one first; root attributes are the
 *     newest's. Then a variable `scenario_number` over the cases says which scenario a case was
 *     computed with, counted from 0; the newest has the highest number. Its checksum takes it after
 *     `final_state`.
 *   every variable but the answers, the trajectories' own and those of `timing` has an attribute
 *     `checksum` over its values (file_checksums.h), which whoever reads the file verifies.
 * A file of one case of a sweep (`run --only`) has the dimension `case` with the flat index as
 * its value, and over it one variable per path of the axes.
 *
 * Rows of pending cases are whatever the file system hands out for reserved space, mostly zeros:
 * look at `status` first. A variable of an actuator that a scene lacks is left out.
 */
#ifndef STANCE_STORE_STORE_H
#define STANCE_STORE_STORE_H

#include "runner/plan/shard.h"
#include "runner/scenario/scenario.h"

enum { STORE_ROWS = 256 }; /* most rows in one call of store_verify */

struct plan;        /* plan.h */
struct parallel;    /* parallel.h */
struct store;       /* an open file */
struct store_block; /* rows in memory as they will be in the file, column after column */

/* Call before MPI starts: an unfinished file must not be touched again at exit. */
void store_prepare(void);

/* The directory that a file is in. */
void store_directory(const char *file, char *directory, size_t size);

/* Bytes that the file of a plan takes on the disk, near enough to say whether it fits. */
uint64_t store_size(const struct plan *plan, int ranks);

/* Every function below writes the one-line reason of a failure into *message. */

/* Rank 0 alone: creates the file, which must not exist, with everything but the cases, and
 * reserves its space, but for a shard, whose file has holes. On failure nothing is left behind.
 * Designs must have been computed. `before`: the origin of a file whose rows it takes over to go on
 * with another scenario (adopt.h), for the group `history`; NULL: there is none. */
struct store_origin;
bool store_create(const char *file, const struct plan *plan, const struct store_origin *before,
                  int ranks, const char *hosts, stance_message *message);

/* Whether axes, designs and scenario of a file are as their checksums say (file_checksums.h). To
 * `resume` asks for more: that there are checksums, and that nothing in the file is out of order.
 * Damage may crash the HDF5 library: call it where that does no harm (sandbox.h). */
bool store_check(const char *file, bool resume, stance_message *message);

enum { STORE_MOST_ANCESTORS = 200, STORE_TEXTS = 3 };

/* A scenario that cases of a file were computed with before it went on with another: its resolved
 * text, git_revision and date, as the group `history` names them. */
struct store_ancestor {
    char *text[STORE_TEXTS];
};
extern const char *const store_text_names[STORE_TEXTS];

/* What a file was made from, for a resume; release with store_origin_free. */
struct store_origin {
    char *scenario; /* resolved text */
    char revision[80], date[40];
    char *title, *hosts;
    struct shard shard;
    char *generator; /* of the points of its sample, doe_generator; NULL: none is named */
    int ranks;
    size_t ancestors; /* scenarios before that one, the first one first */
    struct store_ancestor *ancestor;
};
bool store_read_origin(const char *file, struct store_origin *origin, stance_message *message);
void store_origin_free(struct store_origin *origin);
/* Whether the points of the file's sample are those that the scenario's are: not where another
 * generator made them. */
bool store_same_points(const char *file, const struct store_origin *origin,
                       const struct scenario *scenario, stance_message *message);
/* Values of logarithmic axes and of a sample as the file has them, into axis->value; other axes are
 * left. */
bool store_read_axes(const char *file, struct scenario_axis *axis, int axes,
                     stance_message *message);

/* Collective: opens a file of this plan for writing. `parallel`: the ranks that open it together,
 * and of which nobody writes rows between those of another's list; NULL: this process alone. */
bool store_open(struct store **store, const char *file, const struct plan *plan,
                const struct parallel *parallel, stance_message *message);
/* Opens one alone and for reading only. */
bool store_open_to_read(struct store **store, const char *file, const struct plan *plan,
                        stance_message *message);
/* Collective: ends the writing; the store is freed in any case. After a failed write call
 * store_abandon instead, which leaves the file as it is. */
bool store_close(struct store *store, stance_message *message);
void store_abandon(struct store *store);

/* Collective, right after store_open: designs of the file into the plan. */
bool store_read_designs(struct store *store, struct plan *plan, stance_message *message);
/* Bytes of a row in a block; a block for `rows` rows, freed by free(); NULL: no memory. */
size_t store_row_size(const struct store *store);
struct store_block *store_block_make(const struct store *store, size_t rows);
/* What is stored of a result, its checksum included, into a slot of the block. */
void store_put(struct store_block *block, size_t slot, const stance_result *result);
/* As many slots of the block as there are rows (one at least), from `slot` on, to those rows of the
 * file, their status last; one write per variable and unbroken stretch of the innermost axis. */
bool store_write(struct store *store, struct store_block *block, size_t slot,
                 const struct rows *rows, stance_message *message);
/* Makes a trajectory of the file's cases blank, all NAN; room is made where `position` is NULL, and
 * freed by free(position). false: no memory. */
bool store_blank_trajectory(const struct store *store, stance_trajectory *trajectory);
/* The trajectory at one place of the recorded cases; before the row itself. */
bool store_write_trajectory(struct store *store, uint64_t place,
                            const stance_trajectory *trajectory, stance_message *message);
/* What the file has of 1 to STORE_ROWS rows. Trajectories of recorded cases are verified, too. */
struct store_found {
    bool whole;              /* done or failed, and as its checksum says */
    uint8_t status, outcome; /* as in the file; outcome where it is stored */
};
bool store_verify(struct store *store, const struct rows *rows, struct store_found *found,
                  stance_message *message);
/* Appends the times of a file to those of another, rank after rank from *rank on, which moves on.
 */
bool store_copy_timing(struct store *from, struct store *to, int *rank, stance_message *message);
/* An attribute of the whole file. */
bool store_annotate(struct store *store, const char *name, const char *text,
                    stance_message *message);

/* Adds to the timing group; for rank 0. wall_time[ranks], cases[ranks]. */
bool store_add_timing(struct store *store, int ranks, const double *wall_time, const double *cases,
                      stance_message *message);

/* Rows of an open file (HDF5 identifier) whose answers are not as their checksums say become
 * pending in status[cases], which holds the file's own; trajectories are not looked at. false: the
 * rows cannot be read, or no memory. A file without checksums is taken as it is. */
struct store_damage {
    uint64_t cases, first; /* how many, the lowest of them */
};
bool store_distrust(int64_t file, uint8_t *status, uint64_t cases, struct store_damage *damage);

/* Counts the cases of a file, which another process may be writing. */
struct store_counts {
    uint64_t cases, done, failed;
};
bool store_count(const char *file, struct store_counts *counts, stance_message *message);

/* Whether a file of that size on the disk, and that length, can fit at all, before HDF5 begins what
 * it could not end. */
bool store_fits(const char *file, uint64_t size, uint64_t length, stance_message *message);
/* Brings a file to the disk; `whole`: the space of all of it is reserved there. */
bool store_bring(const char *file, bool whole, stance_message *message);
/* Brings a file that was made beside another to the disk, then under its name. */
bool store_take_place(const char *made, const char *file, stance_message *message);

#endif
