/* csv.c - fields, quotes and ends of rows. */
#include "csv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void begin_field(struct csv *csv)
{
    if (csv->inside)
        fputc(',', csv->file);
    csv->inside = true;
}

void csv_text(struct csv *csv, const char *text)
{
    begin_field(csv);
    if (!strpbrk(text, ",\"\r\n")) {
        fputs(text, csv->file);
        return;
    }
    fputc('"', csv->file);
    for (; *text; text++) {
        if (*text == '"')
            fputc('"', csv->file);
        fputc(*text, csv->file);
    }
    fputc('"', csv->file);
}

void csv_number(struct csv *csv, double value)
{
    enum { SURE = 15, MOST = 17 }; /* digits that may be enough, that always are */
    char text[40];
    begin_field(csv);
    if (isnan(value))
        return;
    for (int digits = SURE; digits <= MOST; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        if (strtod(text, NULL) == value)
            break;
    }
    fputs(text, csv->file);
}

void csv_end_row(struct csv *csv)
{
    fputs("\r\n", csv->file);
    csv->inside = false;
}

void csv_row(struct csv *csv, const char *const *words, size_t count)
{
    for (size_t i = 0; i < count; i++)
        csv_text(csv, words[i]);
    csv_end_row(csv);
}
