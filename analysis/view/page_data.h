/* page_data.h - what a page holds of a results file: a head in JSON, and blocks of numbers.
 *
 * Numbers are little-endian, those of more than a byte shuffled (all first bytes, then all second
 * ones ...), deflated (zlib, RFC 1950), in base64. analysis/view/page/data.ts reads them.
 */
#ifndef STANCE_VIEW_PAGE_DATA_H
#define STANCE_VIEW_PAGE_DATA_H

#include "runner/store/results.h"

#include <jansson.h>
#include <stdio.h>

enum {
    PAGE_MOST_CASES = 8000000,
};
/* Compressed bytes of answers that a page carries unasked. */
#define PAGE_BYTES 24e6

struct page_request {
    const char *file;    /* as it is to stand in commands */
    const char **answer; /* [answers] those to be carried; none: as many as PAGE_BYTES allow */
    size_t answers;
    bool whole; /* all of them */
};

/* Writes the page's script elements: to `out` those that its map is drawn from, to `more` the
 * others. False: *message says why; errors of `out` and `more` are the caller's. */
bool page_data_write(FILE *out, FILE *more, const struct results *r,
                     const struct page_request *request, stance_message *message);

/* The same of the file of a search: its charts. */
bool page_search_write(FILE *out, const char *file, stance_message *message);

/* page_blocks.c: a block of `count` numbers, of the type "u8", "u32", "f32" or "f64", and its entry
 * in the head's object `blocks`. *bytes, not NULL: what it takes, compressed. False: no memory. */
bool page_block(FILE *out, json_t *blocks, const char *name, const char *type, const void *numbers,
                size_t count, size_t *bytes);
/* A script element of bytes as base64. */
void page_base64(FILE *out, const char *id, const uint8_t *bytes, size_t size);
/* One of JSON, without '<' and '&'. */
void page_json(FILE *out, const char *id, const json_t *json);

/* page_charts.c: a list of what is better read off curves than off a map, new; NULL with one line
 * in *message. A chart is an object for charts.ts: {title, text, x, y, series}; x and y {label,
 * unit, log} and, where places have names, words; a series {name, x, y, low, high, lines}. */
json_t *page_charts(const struct results *r, stance_message *message);
/* Of the file of a search; *title is its title, cut. */
json_t *page_search_charts(const char *file, char title[256], stance_message *message);

/* page_index.c: a page that leads to others, card after card. `page`: where the link goes. False:
 * the file cannot be read, *message says why. */
void page_index_begin(FILE *out);
bool page_index_card(FILE *out, const char *file, const char *page, stance_message *message);
void page_index_end(FILE *out);

/* page_template.c: the page that data are put into, HTML as `make web` made it, with PAGE_DATA,
 * where the data go that the page begins with, and then PAGE_MORE, for all others, once; "": this
 * program was built without. */
#define PAGE_DATA "<!--stance:data-->"
#define PAGE_MORE "<!--stance:more-->"
const char *page_template(void);
/* The engine of a structure, "runtime" for any: a WebAssembly module, deflated (zlib).
 * NULL: there is none. */
const uint8_t *page_engine(const char *scene, size_t *size);

/* page_wire.c: a scenario's text as wire text (analysis/view/wasm/wire.c), freed by the caller;
 * NULL: it is none, or no memory. */
char *page_wire(const char *scenario);

#endif
