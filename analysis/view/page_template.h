/* page_template.h - the page that data are put into. */
#ifndef STANCE_VIEW_PAGE_TEMPLATE_H
#define STANCE_VIEW_PAGE_TEMPLATE_H

/* Where the data go. */
#define PAGE_PLACE "<!--stance:data-->"

/* HTML as `make web` made it, with PAGE_PLACE once; "": this program was built without. */
const char *page_template(void);

#endif
