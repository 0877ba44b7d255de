/* page_template.c - the page without data, which `make web` makes; empty in a program that was
 * built without it. */
#include "page_template.h"

#ifdef STANCE_PAGE
__asm__(".pushsection .rodata\nstance_page_template:\n.incbin \"" STANCE_PAGE
        "\"\n.byte 0\n.popsection\n");
extern const char stance_page_template[] __attribute__((visibility("hidden")));
#else
static const char stance_page_template[] = "";
#endif

const char *page_template(void)
{
    return stance_page_template;
}
