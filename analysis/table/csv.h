/* csv.h - tables for other programs: comma-separated values as RFC 4180 has them.
 *
 * The writer puts commas between the fields of a row and ends rows with CR LF. What the stream
 * itself says of its errors (ferror, fclose) is the caller's.
 */
#ifndef STANCE_TABLE_CSV_H
#define STANCE_TABLE_CSV_H

#include <stdbool.h>
#include <stdio.h>

/* A table that is written to `file`; {.file = stdout} begins one. */
struct csv {
    FILE *file;
    bool inside; /* the row has a field already */
};

/* A field of text, in quotes where it has commas, quotes or ends of lines. */
void csv_text(struct csv *csv, const char *text);
/* A number, as short as gives the same double again; empty for NAN, "inf" or "-inf". */
void csv_number(struct csv *csv, double value);
void csv_end_row(struct csv *csv);

/* The fields of a whole row of text, such as the head: words[count]. */
void csv_row(struct csv *csv, const char *const *words, size_t count);

#endif
