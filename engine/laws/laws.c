/* laws.c - the laws there are. */
#include "engine/stance.h"

#include <string.h>

#define COUNT(name) +1
_Static_assert(STANCE_LAWS(COUNT) <= STANCE_MAX_LAWS, "room for all laws");
#define DECLARE(name) extern const stance_law stance_law_##name;
STANCE_LAWS(DECLARE)

const stance_law *const *stance_laws(void)
{
#define LIST(name) &stance_law_##name,
    static const stance_law *const laws[] = {STANCE_LAWS(LIST) NULL};
    return laws;
}

int stance_law_first(const stance_law *law)
{
    int first = 0;
    for (const stance_law *const *before = stance_laws(); *before != law; before++)
        first += (*before)->parameters;
    return first;
}

const stance_law *stance_law_find(const char *name)
{
    for (const stance_law *const *law = stance_laws(); *law; law++)
        if (strcmp((*law)->name, name) == 0)
            return *law;
    return NULL;
}
