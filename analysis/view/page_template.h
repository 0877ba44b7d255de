/* page_template.h - the page that data are put into, and what simulates in it. */
#ifndef STANCE_VIEW_PAGE_TEMPLATE_H
#define STANCE_VIEW_PAGE_TEMPLATE_H

#include <stddef.h>
#include <stdint.h>

/* Where the data go that the page begins with, and all others. */
#define PAGE_DATA "<!--stance:data-->"
#define PAGE_MORE "<!--stance:more-->"

/* HTML as `make web` made it, with PAGE_DATA and then PAGE_MORE once; "": this program was built
 * without. */
const char *page_template(void);

/* The engine of a structure, "runtime" for any: a WebAssembly module, deflated (zlib).
 * NULL: there is none. */
const uint8_t *page_engine(const char *scene, size_t *size);

#endif
