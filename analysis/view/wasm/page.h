/* page.h - what a page's engine knows: the scenario of its results file with the designs found
 * there, and the view, the scenario that is simulated: the file's own or one with values replaced.
 *
 * Compiled for WebAssembly alone, one instance to a thread of the browser. Functions that are
 * `exported` are called by the page: numbers and addresses only, text as UTF-8 with a zero after
 * it. They return 0 where something is wrong, and `message` then says what.
 */
#ifndef STANCE_VIEW_WASM_PAGE_H
#define STANCE_VIEW_WASM_PAGE_H

#include "runner/plan/plan.h"
#include "runner/scenario/schema.h"

/* EXPORTED(type, name, parameters) begins its definition. */
#define EXPORTED(type, name, ...)                                                                  \
    __attribute__((export_name(#name), used)) type name(__VA_ARGS__);                              \
    type name(__VA_ARGS__)

struct page {
    char *wire; /* the file's scenario, see wire.c */
    struct scenario file, view;
    struct plan file_plan, view_plan; /* the designs of each */
    struct schema schema;             /* of the view */
    bool changed;                     /* the view is not the file's scenario */
    bool resweeps;                    /* ... nor are its axes */
    uint64_t stored;                  /* answers that the file stores, a bit each */
    int number;                       /* that its newest scenario has there; -1: it has but one */
    stance_message message;
};
extern struct page page;

/* page_designs.c: design d of the view, from those of the file where they are for the same inputs.
 * False: there is none, and page.message says why where that is the page's fault. */
bool page_design(size_t d);
void page_designs_forget(void); /* what is remembered of the file's */

/* page_law.c: a law of the user's own, ready to be called; false: the page has none of it. */
bool page_take_law(struct scenario *s);

/* The case in a row of the view. False: it does not exist; or (page.message) cannot be had here. */
bool page_case(double index, stance_case *out, const stance_kernel **kernel);
/* Its result where it does not exist. */
void page_fail(stance_result *result);
/* Says what a result rests on, as a run does. */
void page_simulated(stance_result *result);
/* As files have it: enum results_kind, the answers, and the checksum over what is stored. */
uint8_t page_kind(const stance_result *result);
void page_answers(const stance_result *result, double *answer);
uint32_t page_checksum(const stance_result *result);

/* page_text.c: JSON in a buffer that the next one replaces. */
struct text {
    char *bytes;
    size_t length;
    FILE *out;
};
void text_begin(struct text *text);
/* In the format "'" is a quotation mark, '~' a comma that nothing opens before; '$' stands for a
 * string, '?' for a truth, '#' for a double, null where it is not finite, '&' for an unsigned long
 * long. */
void text_json(struct text *text, const char *format, ...);
const char *text_done(struct text *text);

#endif
