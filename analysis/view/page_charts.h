/* page_charts.h - what of a file is better read off curves than off a map: shares along an axis,
 * indices of sensitivity, error against cost, a search as it went.
 *
 * A chart is an object for charts.ts: {title, text, x, y, series}; x and y {label, unit, log} and,
 * where places have names, words; a series {name, x, y, low, high, lines}.
 */
#ifndef STANCE_VIEW_PAGE_CHARTS_H
#define STANCE_VIEW_PAGE_CHARTS_H

#include "runner/store/results.h"

#include <jansson.h>

/* A list, new; NULL with one line in *message. */
json_t *page_charts(const struct results *r, stance_message *message);
/* Of the file of a search; *title is its title, cut. */
json_t *page_search_charts(const char *file, char title[256], stance_message *message);

#endif
