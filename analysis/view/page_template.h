/* page_template.h - the page that data are put into, and what simulates in it. */
#ifndef STANCE_VIEW_PAGE_TEMPLATE_H
#define STANCE_VIEW_PAGE_TEMPLATE_H

#include <stddef.h>
#include <stdint.h>

/* Where the data go. */
#define PAGE_PLACE "<!--stance:data-->"

/* HTML as `make web` made it, with PAGE_PLACE once; "": this program was built without. */
const char *page_template(void);

/* The engine of a scene, "runtime" for described ones: a WebAssembly module, deflated (zlib).
 * NULL: there is none. */
const uint8_t *page_engine(const char *scene, size_t *size);

#endif
