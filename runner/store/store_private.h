/* store_private.h - shared by those who write results files: store.c (rows), adopt_rows.c (rows of
 * another file), store_make.c and store_layout.c (creation), store_space.c (room on the disk),
 * store_look.c (questions) and file_checksums.c (checksums). */
#ifndef STANCE_STORE_STORE_PRIVATE_H
#define STANCE_STORE_STORE_PRIVATE_H

#include "store.h"
#include "store_make.h"

#include "runner/plan/plan.h"

#include <hdf5_hl.h>

/* The variables over the cases, in the order of the table, then those of our own. */
enum {
    COLUMN_FINAL_STATE = SCENARIO_FINAL_STATE, /* after the answers, STANCE_ANSWER_... */
    COLUMN_SCENARIO_NUMBER,                    /* of files with a history only */
    COLUMN_CHECKSUM,
    COLUMN_STATUS,
    COLUMNS,
};

/* The layout of the file: its variables, and what they are over beside the cases, the axes of
 * designs, or the recorded cases and their instants. */
enum store_over {
    OVER_NONE,
    OVER_STATE,
    OVER_POSTURE, /* posture_state */
    OVER_COORDINATE,
    OVER_ACTUATOR,
    OVER_CONTACT,
    OVER_COMPONENT, /* normal, tangential */
    OVERS,
};
struct store_variable {
    const char *name; /* with its group */
    enum store_kind kind;
    bool filled;             /* has `_FillValue` */
    const char *unit, *text; /* may be NULL */
    enum store_over over[2];
    size_t place; /* of a design: its part; of a trajectory: offset of the pointer */
};
enum { TRACKS = 5, TRACK_CHECKSUM = TRACKS };
extern const struct store_variable store_columns[COLUMNS], store_designs[RESOLVED_PARTS],
    store_design_status, store_tracks[TRACKS + 1];
/* Numbers per case, design, or case and instant; 0: it is left out. */
size_t store_width(const stance_scene *scene, const struct store_variable *variable);

/* Whether a variable is over the cases; over those that are recorded, their checksum included. */
bool store_is_column(const char *path);
bool store_is_track(const char *path);
/* Whether a scenario stores a column. */
bool store_has_column(const struct scenario *scenario, int column);

/* Why a file is not of the sweep that its scenario describes. */
#define STORE_ONE_CASE "%.100s: holds one case of a sweep (run --only), not the sweep"
/* "FILE: cannot ...: reason" of a system call. Returns false. */
bool store_system_failed(stance_message *message, const char *file, const char *what, int error);

/* Numbers of all designs, NAN where there is none, freed by the caller; NULL: no memory. */
double *store_design_values(const struct plan *plan, int column);

struct store {
    char file[1024];
    const struct plan *plan;
    hid_t id;
    int ranks;                   /* that have it open together */
    bool spans;                  /* store_write may write back what lies between rows of a list: all
                                  * ranks see each other's writes at once, on one host */
    hid_t column[COLUMNS];       /* -1: not stored */
    size_t width[COLUMNS];       /* elements per case, and */
    size_t size[COLUMNS];        /* ... bytes */
    int64_t no_count;            /* what it has for a count that there is none of: `_FillValue` */
    struct store_block *checked; /* [STORE_ROWS], for store_verify; made when it is needed */
    hid_t trajectory[TRACKS + 1];       /* -1: not stored; the last one is their checksum */
    size_t trajectory_size[TRACKS + 1]; /* elements per case; 0: not stored */
};

/* Rows in memory, column after column. */
struct store_block {
    const struct store *store;
    void *column[COLUMNS]; /* [rows][width]; NULL: not stored */
};

/* Where a column of a row is. */
static inline void *store_cell(const struct store_block *block, int column, size_t slot)
{
    return (char *)block->column[column] + slot * block->store->size[column];
}

/* Moves rows between the file and a block, from `slot` on: all columns in order, the checksum and
 * then the status last. */
bool store_move_rows(const struct store *store, const struct store_block *block, size_t slot,
                     const struct rows *rows, enum hdf_direction way, stance_message *message);
/* What the checksum of a row of a block ought to be; gives it to the row. */
uint32_t store_row_checksum(const struct store_block *block, size_t slot);
static inline void store_seal(const struct store_block *block, size_t slot)
{
    *(uint32_t *)store_cell(block, COLUMN_CHECKSUM, slot) = store_row_checksum(block, slot);
}
/* Moves a trajectory between the file and memory; its checksum as it follows from the numbers, and
 * as it is in the file. */
bool store_move_trajectory(struct store *store, uint64_t place, enum hdf_direction way,
                           const stance_trajectory *trajectory, uint32_t *crc, uint32_t *stored);

/* Adds to a variable of group `timing` from place `first` on, modulo its length. */
bool store_add_times(const struct store *store, const char *name, size_t first, size_t count,
                     const double *more);

/* File access for one process: no HDF5 locks (ours is another), no buffering of raw data, so that
 * writes reach the system in the order in which they are made. Close with H5Pclose. */
hid_t store_serial_access(void);

#endif
