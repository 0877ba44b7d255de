/* page_index.c - a page that leads to pages: a card for each file, with a small map and its shares.
 *
 * The map is over the two axes with most points at the middle of all others, thinned to CELLS
 * places a side and drawn as runs of equal kinds: SVG that needs no script.
 */
#include "page_data.h"

#include "analysis/draw/gnuplot.h"
#include "analysis/statistics/statistics.h"
#include "runner/store/search_file.h"

#include "analysis/optimise/search_study.h"

#include <ctype.h>
#include <string.h>

enum { CELLS = 72 };

/* Text of the user as text. */
static void put_text(FILE *out, const char *text)
{
    for (; *text; text++)
        if (strchr("<>&\"'", *text))
            fprintf(out, "&#%d;", *text);
        else
            fputc(*text, out);
}

/* ---- the small map ------------------------------------------------------------------------ */

/* Place of cell i of n along an axis of `count` points. */
static size_t place(size_t i, size_t n, size_t count)
{
    return n > 1 ? i * (count - 1) / (n - 1) : 0;
}

static uint8_t kind_at(const struct results *r, const int axis[2], size_t x, size_t y)
{
    uint64_t index = 0;
    for (int a = 0; a < r->axes; a++) {
        const size_t count = r->axis[a].count;
        index = index * count + (a == axis[0] ? x : a == axis[1] ? y : count / 2);
    }
    return r->kind[index];
}

/* The first of the axes with most points, but for `other`; -1: none. */
static int longest(const struct results *r, int other)
{
    int axis = -1;
    for (int a = 0; a < r->axes; a++)
        if (a != other && (axis < 0 || r->axis[a].count > r->axis[axis].count))
            axis = a;
    return axis;
}

static void put_map(FILE *out, const struct results *r)
{
    const int first = longest(r, -1), second = longest(r, first);
    const int axis[2] = {second >= 0 && second < first ? second : first,
                         second >= 0 && second < first ? first : second};
    const size_t across = r->axis[axis[0]].count, up = axis[1] >= 0 ? r->axis[axis[1]].count : 1;
    const size_t columns = across < CELLS ? across : CELLS, rows = up < CELLS ? up : CELLS;
    char colour[8];
    fprintf(out,
            "<svg viewBox=\"0 0 %zu %zu\" preserveAspectRatio=\"none\" role=\"img\" "
            "aria-label=\"map of outcomes\" shape-rendering=\"crispEdges\">",
            columns, rows);
    for (size_t j = 0; j < rows; j++)
        for (size_t i = 0, next; i < columns; i = next) {
            const size_t y = place(rows - 1 - j, rows, up);
            const uint8_t kind = kind_at(r, axis, place(i, columns, across), y);
            for (next = i + 1; next < columns; next++)
                if (kind_at(r, axis, place(next, columns, across), y) != kind)
                    break;
            gnuplot_kind_colour(results_kind_names[kind], colour);
            fprintf(out, "<path d=\"M%zu %zuh%zuv1h-%zuz\" fill=\"%s\"/>", i, j, next - i, next - i,
                    colour);
        }
    fputs("</svg>", out);
}

/* A sample has no map: its shares, side by side. */
static void put_shares(FILE *out, const struct statistics_counts *counts, uint64_t cases)
{
    double from = 0;
    fputs("<svg viewBox=\"0 0 100 72\" preserveAspectRatio=\"none\" role=\"img\" "
          "aria-label=\"shares of outcomes\">",
          out);
    for (int k = 0; k < RESULTS_KIND_COUNT; k++) {
        const double width = 100 * (double)counts->kind[k] / (double)cases;
        char colour[8];
        gnuplot_kind_colour(results_kind_names[k], colour);
        if (width > 0)
            fprintf(out, "<rect x=\"%.3f\" y=\"0\" width=\"%.3f\" height=\"72\" fill=\"%s\"/>",
                    from, width, colour);
        from += width;
    }
    fputs("</svg>", out);
}

/* ---- cards -------------------------------------------------------------------------------- */

void page_index_begin(FILE *out)
{
    fputs("<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
          "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
          "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
          "'unsafe-inline'\">\n<title>stance: studies</title>\n<style>\n"
          ":root{color-scheme:light dark}\n"
          "body{font:16px/1.45 system-ui,sans-serif;margin:0 auto;max-width:76rem;padding:1rem}\n"
          "h1{font-size:1.3rem}p{max-width:46rem}\n"
          "ul{list-style:none;padding:0;display:grid;gap:1rem;"
          "grid-template-columns:repeat(auto-fill,minmax(15rem,1fr))}\n"
          "a{display:block;height:100%;box-sizing:border-box;padding:.7rem;border:1px solid #8888;"
          "border-radius:.4rem;text-decoration:none;color:inherit}\n"
          "a:hover,a:focus-visible{border-color:#0072b2;outline:2px solid #0072b2}\n"
          "svg{width:100%;height:9rem;display:block;background:#8882}\n"
          "strong{display:block;margin:.5rem 0 .2rem}small{opacity:.75;display:block}\n"
          "</style></head><body>\n<h1>stance: studies</h1>\n"
          "<p>Each is a page of its own, which simulates: click a case to see what happens there, "
          "change the floor, the controller or the robot and the map is computed anew, here in "
          "the browser, by the engine that computed the files.</p>\n<ul>\n",
          out);
}

/* Its link: the name of a file as a relative address (RFC 3986), nothing in it is a scheme, a query
 * or a part. */
static void put_head(FILE *out, const char *page)
{
    fputs("<li><a href=\"", out);
    for (; *page; page++)
        fprintf(out, isalnum((unsigned char)*page) || strchr("-._~", *page) ? "%c" : "%%%02X",
                (unsigned char)*page);
    fputs("\">", out);
}

bool page_index_card(FILE *out, const char *file, const char *page, stance_message *message)
{
    struct results r;
    if (search_file_is(file)) {
        struct search_study study;
        if (!search_study_open(&study, file, message))
            return false;
        put_head(out, page);
        fputs("<strong>", out);
        put_text(out, study.f.title ? study.f.title : study.name);
        fprintf(out, "</strong><small>search: %zu candidates</small></a></li>\n",
                study.f.length[SEARCH_CANDIDATE]);
        search_study_close(&study);
        return true;
    }
    if (!results_open(&r, file, message))
        return false;
    struct statistics_counts counts;
    statistics_count(&r, -1, 0, &counts);
    put_head(out, page);
    if (r.single || r.sample >= 0)
        put_shares(out, &counts, r.cases);
    else
        put_map(out, &r);
    fputs("<strong>", out);
    put_text(out, r.title);
    fputs("</strong><small>", out);
    if (r.single)
        fprintf(out, "one case: %s", results_kind_names[r.kind[0]]);
    else
        fprintf(out, "%llu cases", (unsigned long long)r.cases);
    for (int k = 0; k < RESULTS_KIND_COUNT && !r.single; k++)
        if (counts.kind[k] > 0)
            fprintf(out, ", %.3g %% %s", 100 * (double)counts.kind[k] / (double)r.cases,
                    results_kind_names[k]);
    fputs("</small></a></li>\n", out);
    results_close(&r);
    return true;
}

void page_index_end(FILE *out)
{
    fputs("</ul>\n</body></html>\n", out);
}
