/* schedule_picture.h - what `stance bench schedule` found, and its picture. */
#ifndef STANCE_BENCH_SCHEDULE_PICTURE_H
#define STANCE_BENCH_SCHEDULE_PICTURE_H

#include "simulate.h"

#include "engine/stance.h"

enum { SCHEDULE_STUDY_MOST = 16 };

struct schedule_study {
    struct simulated_machine machine;
    uint64_t cases;
    const char *answers;         /* what is kept, separated by commas */
    size_t row_size;             /* bytes of that, checksum and status included */
    int variables;               /* in so many variables */
    double step_time, case_time; /* s, means of the run that the costs are from */
    size_t count;
    int ranks[SCHEDULE_STUDY_MOST];
    struct simulation result[SCHEDULE_STUDY_MOST];
};

/* DIRECTORY/STEM.svg and .png: efficiency, and what is lost to what, against the ranks. */
bool schedule_picture(const struct schedule_study *study, const char *directory, const char *stem,
                      stance_message *message);

#endif
