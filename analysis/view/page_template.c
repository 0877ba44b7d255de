/* page_template.c - the page without data and the engines, which `make web` makes; nothing in a
 * program that was built without them. */
#include "page_data.h"

#include <string.h>

#ifdef STANCE_PAGE
__asm__(".pushsection .rodata\nstance_page_template:\n.incbin \"" STANCE_PAGE
        "\"\n.byte 0\n.popsection\n");
extern const char stance_page_template[] __attribute__((visibility("hidden")));

#define ENGINE(scene)                                                                              \
    __asm__(".pushsection .rodata\nstance_engine_" #scene ":\n.incbin \"build/web/engine-" #scene  \
            ".z\"\nstance_engine_end_" #scene ":\n.byte 0\n.popsection\n");                        \
    extern const uint8_t stance_engine_##scene[],                                                  \
        stance_engine_end_##scene[] __attribute__((visibility("hidden")));
STANCE_PAGE_ENGINES
#undef ENGINE
#define ENGINE(scene) {#scene, stance_engine_##scene, stance_engine_end_##scene},
#else
static const char stance_page_template[] = "";
#define STANCE_PAGE_ENGINES
#endif

static const struct {
    const char *scene;
    const uint8_t *begin, *end;
} engines[] = {STANCE_PAGE_ENGINES{NULL, NULL, NULL}};

const char *page_template(void)
{
    return stance_page_template;
}

const uint8_t *page_engine(const char *scene, size_t *size)
{
    for (size_t k = 0; engines[k].scene; k++)
        if (strcmp(engines[k].scene, scene) == 0) {
            *size = (size_t)(engines[k].end - engines[k].begin);
            return engines[k].begin;
        }
    return NULL;
}
