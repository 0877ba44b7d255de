/* search_summary.c - see search_summary.h. */
#include "search_summary.h"
#include "search_front.h"

static bool print_csv(const struct search_study *study)
{
    struct table t = {0};
    search_table_confirmed(&t, study);
    const bool good = table_write_csv(&t, stdout);
    table_free(&t);
    return good;
}

int search_summarise(struct report *report, stance_message *message)
{
    struct search_study study;
    struct search_front front;
    if (report->files.count > 1) {
        if (!search_front_open(&front, report->files.text, report->files.count, message))
            return EXIT_IO;
        const bool good = search_front_print(&front, report->form);
        search_front_close(&front);
        return good ? EXIT_DONE : EXIT_IO;
    }
    if (!search_study_open(&study, report->file, message))
        return EXIT_IO;
    const bool good = (report->form == TABLE_AS_JSON  ? search_print_json
                       : report->form == TABLE_AS_CSV ? print_csv
                                                      : search_print_text)(&study);
    search_study_close(&study);
    return good ? EXIT_DONE : EXIT_IO;
}
