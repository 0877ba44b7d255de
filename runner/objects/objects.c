/* objects.c - rank 0 finds or makes the objects that any rank wants; all get the bytes.
 *
 * What is made while references compute is made by a thread of rank 0, which tells nobody: the
 * bytes go through the cache, by the name that all ranks were told before. */
#include "objects.h"
#include "cache.h"
#include "compiler.h"
#include "load.h"
#include "sources.h"

#include "runner/base/message.h"

#include <dlfcn.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    METHODS = 8,
    ISAS = OBJECTS_MOST / METHODS,
    DOING = 340,
    FRESH = 20, /* times as long as one that was checked before a fresh object is checked */
};

/* An object that some rank wants. */
struct making {
    const stance_method *method;
    const char *isa;
    const stance_kernel *reference; /* of this rank; NULL: none, or others alone want it */
    struct image image;             /* sealed */
    enum object_origin origin;
    bool checked; /* on this rank */
    struct image_label label;
    char name[CACHE_NAME]; /* of its file */
};

/* What rank 0 tells all before the images: how long each is (0: there is none) and where it comes
 * from. */
struct tidings {
    uint64_t size[OBJECTS_MOST];
    enum object_origin origin[OBJECTS_MOST];
    char name[OBJECTS_MOST][CACHE_NAME];
    enum exit_code code; /* EXIT_DONE, or the job ends, for the reason in `why`, which else says why
                            some are missing */
    stance_message why;
};

static bool on_demand(const stance_method *method)
{
    char path[80];
    snprintf(path, sizeof path, "engine/methods/%s.c", method->name);
    return sources_have(path);
}

/* The name of its file: by all that it is made of. */
static bool name_object(struct making *m, const char *tables, const struct compiler *compiler)
{
    const char *const text[] = {tables, m->method->name, m->isa, compiler_flags(m->isa)};
    if (!compiler_label(compiler, text, sizeof text / sizeof *text, &m->label))
        return false;
    snprintf(m->name, sizeof m->name, "%s-%s-%s.so", m->method->name, m->isa, m->label.key);
    return true;
}

/* ---- rank 0 -------------------------------------------------------------------------------- */

/* Runs the checks of a fresh image and seals it. What rank 0 does not want is checked by those who
 * do, what is kept by all who take it: it was checked with other numbers. */
static bool check(const struct objects_request *request, const struct cache *cache,
                  struct making *m, stance_message *message)
{
    struct object object = {.kernel = {request->scene->name, m->method, m->isa, 0, NULL, NULL},
                            .memory = -1};
    snprintf(object.compiler, sizeof object.compiler, "%s", m->label.compiler);
    const bool loads = load_object(&m->image, &object, message),
               good = loads && load_check(&object, m->reference, request, FRESH * request->patience,
                                          message);
    objects_release(&object, 1);
    m->checked = good;
    if (loads && !good)
        cache_refuse(cache, m->name, &m->label, message->text);
    return good && (image_seal(&m->image, &m->label) || no_memory(message));
}

/* "compiling implicit (avx2), midpoint (avx2)" */
static void say_what(struct making *const *missing, size_t count, char doing[DOING])
{
    size_t used = (size_t)snprintf(doing, DOING, "compiling");
    for (size_t i = 0; i < count && used < DOING; i++)
        used += (size_t)snprintf(doing + used, DOING - used, "%s %s (%s)", i ? "," : "",
                                 missing[i]->method->name, missing[i]->isa);
}

/* Compiles those, and closes the cache. What cannot be had stays without an image. */
static void compile(const struct objects_request *request, struct cache *cache,
                    const struct compiler *compiler, struct making *const *missing, size_t count,
                    struct watch *watch, stance_message *why)
{
    struct compilation wanted[OBJECTS_MOST];
    stance_message unkept = {""};
    for (size_t i = 0; i < count; i++)
        wanted[i] =
            (struct compilation){.method = missing[i]->method->name, .isa = missing[i]->isa};
    const struct compiler_file tables = {COMPILER_TABLES, request->tables};
    compiler_run(compiler, &tables, 1, wanted, count, watch);
    for (size_t i = 0; i < count; i++) {
        struct making *const m = missing[i];
        m->image = wanted[i].image;
        if (!m->image.bytes)
            *why = wanted[i].message;
        else if (watch->stopped || !check(request, cache, m, why))
            image_free(&m->image);
        else
            m->origin =
                cache_keep(cache, m->name, &m->image, &unkept) ? OBJECT_COMPILED : OBJECT_UNKEPT;
    }
    cache_close(cache);
    if (unkept.text[0])
        cache_say("%s; compiled for this run alone", unkept.text);
}

/* While all wait. EXIT_INTERRUPTED: told to stop. */
static enum exit_code compile_now(const struct objects_request *request, struct cache *cache,
                                  const struct compiler *compiler, struct making *const *missing,
                                  size_t count, stance_message *why)
{
    char doing[DOING];
    say_what(missing, count, doing);
    if (!request->quiet)
        cache_say("%s with %s", doing, compiler->version);
    struct watch watch = {.stop = request->stop,
                          .context = request->context,
                          .doing = doing,
                          .progress = progress_begin(request->quiet)};
    watch_begin(&watch);
    compile(request, cache, compiler, missing, count, &watch, why);
    watch_end(&watch);
    if (watch.stopped)
        complain(why, "stopped while kernels were compiled");
    return watch.stopped ? EXIT_INTERRUPTED : EXIT_DONE;
}

/* ---- later --------------------------------------------------------------------------------- */

struct objects_later {
    struct objects_request request; /* whose lists are its own */
    struct making making[OBJECTS_MOST];
    size_t count, coming;
    /* Of rank 0. */
    struct making *missing[OBJECTS_MOST];
    struct cache cache;
    pthread_t thread;
    bool begun;
    atomic_bool ended, stop;
    stance_message why;
};

static void *copy(const void *from, size_t size)
{
    void *const to = malloc(size + 1);
    return to ? memcpy(to, from, size) : NULL;
}

/* NULL: no memory. */
static struct objects_later *later_make(const struct objects_request *request,
                                        const struct making *making, size_t count)
{
    struct objects_later *const later = calloc(1, sizeof *later);
    if (!later)
        return NULL;
    later->request = *request;
    later->request.tables = copy(request->tables, strlen(request->tables) + 1);
    later->request.wanted = copy(request->wanted, request->count * sizeof *request->wanted);
    later->request.check = copy(request->check, request->checks * sizeof *request->check);
    later->count = count;
    for (size_t i = 0; i < count; i++) {
        later->making[i] = making[i];
        later->making[i].image = (struct image){NULL, 0};
        later->coming += making[i].origin == OBJECT_COMING;
    }
    if (later->request.tables && later->request.wanted && later->request.check)
        return later;
    objects_later_free(later);
    return NULL;
}

static bool told_to_end(void *context)
{
    return atomic_load(&((struct objects_later *)context)->stop);
}

static void *compile_later(void *context)
{
    struct objects_later *const later = context;
    struct watch watch = {.stop = told_to_end, .context = later, .progress = progress_begin(true)};
    struct compiler compiler; /* points into itself: found anew, not copied */
    if (compiler_find(&compiler, &later->why))
        compile(&later->request, &later->cache, &compiler, later->missing, later->coming, &watch,
                &later->why);
    else
        cache_close(&later->cache);
    atomic_store(&later->ended, true);
    return NULL;
}

/* Rank 0 begins; where it cannot, nothing comes. Closes the cache in the end. */
static void later_begin(struct objects_later *later, struct cache *cache,
                        const struct compiler *compiler)
{
    char doing[DOING];
    size_t n = 0;
    for (size_t i = 0; i < later->count; i++)
        if (later->making[i].origin == OBJECT_COMING)
            later->missing[n++] = &later->making[i];
    later->cache = *cache;
    say_what(later->missing, n, doing);
    if (!later->request.quiet)
        cache_say("%s with %s; kernels that are built in compute till then", doing,
                  compiler->version);
    pthread_attr_t wide; /* kernels need some MB, which is more than threads may have */
    if (pthread_attr_init(&wide) == 0) {
        later->begun = pthread_attr_setstacksize(&wide, (size_t)1 << 26) == 0 &&
                       pthread_create(&later->thread, &wide, compile_later, later) == 0;
        pthread_attr_destroy(&wide);
    }
    if (!later->begun) {
        complain(&later->why, "no thread to compile in");
        cache_close(&later->cache);
        atomic_store(&later->ended, true);
    }
}

/* Ranks that are bound to a core each share none but rank 0's, which is the compilers'; others
 * share all. */
bool objects_later_wait(const struct objects_later *later, const struct parallel *ranks)
{
    const size_t cores = compiler_cores(), rank = (size_t)ranks->rank;
    return cores == 1 ? rank == 0 : rank + later->coming >= cores;
}

bool objects_later_ended(const struct objects_later *later)
{
    return atomic_load(&later->ended);
}

void objects_later_free(struct objects_later *later)
{
    if (!later)
        return;
    atomic_store(&later->stop, true);
    if (later->begun)
        pthread_join(later->thread, NULL);
    for (size_t i = 0; i < later->count; i++)
        image_free(&later->making[i].image);
    free((void *)(uintptr_t)later->request.tables);
    free((void *)(uintptr_t)later->request.wanted);
    free((void *)(uintptr_t)later->request.check);
    free(later);
}

/* Which of them have no image and may get one, after a look into the cache. `why`: one is refused,
 * as is known. */
static size_t look(const struct objects_request *request, const struct cache *cache,
                   struct making *making, size_t count, struct making **missing,
                   stance_message *why)
{
    size_t n = 0;
    for (size_t i = 0; i < count; i++) {
        struct making *const m = &making[i];
        if (cache_find(cache, m->name, &m->image)) {
            m->origin = OBJECT_KEPT;
            continue;
        }
        m->origin =
            !request->again && cache_refused(cache, m->name, why) ? OBJECT_REFUSED : OBJECT_MISSING;
        if (m->origin == OBJECT_MISSING)
            missing[n++] = m;
    }
    return n;
}

/* Finds or makes the objects. Not EXIT_DONE: the job has to end; `why` says why, or why some are
 * missing. */
static enum exit_code make(const struct objects_request *request, bool may_come,
                           struct making *making, size_t count, struct objects_later **later,
                           stance_message *why)
{
    struct making *missing[OBJECTS_MOST];
    struct compiler compiler = {.identity = ""};
    struct cache cache;
    const bool compiles = compiler_find(&compiler, why);
    for (size_t i = 0; i < count; i++)
        if (!name_object(&making[i], request->tables, &compiler))
            return no_memory(why) ? EXIT_DONE : EXIT_IO;
    if (!cache_open(&cache, request->looks, why))
        return request->looks ? EXIT_DONE : EXIT_IO;
    const size_t n = look(request, &cache, making, count, missing, why);
    for (size_t i = 0; i < n && !compiles; i++)
        missing[i]->origin = OBJECT_REFUSED; /* as good as */
    if (request->brief || request->looks) {
        why->text[0] = '\0'; /* nothing is missed */
    } else if (n > 0 && compiles && may_come) {
        for (size_t i = 0; i < n; i++)
            missing[i]->origin = OBJECT_COMING;
        *later = later_make(request, making, count);
        if (!*later)
            return no_memory(why) ? EXIT_DONE : EXIT_IO;
        later_begin(*later, &cache, &compiler);
        return EXIT_DONE;
    } else if (n > 0 && compiles) {
        return compile_now(request, &cache, &compiler, missing, n, why);
    } else if (n > 0) {
        const size_t used = strlen(why->text);
        snprintf(why->text + used, sizeof why->text - used,
                 "; `stance build` where there is one, and copy %.100s/%.60s...", cache.path,
                 missing[0]->name);
    }
    cache_close(&cache);
    return EXIT_DONE;
}

/* ---- all ranks ----------------------------------------------------------------------------- */

/* The objects that any rank wants: the same list on every rank. Returns how many. */
static size_t list_wanted(const struct parallel *ranks, const struct objects_request *request,
                          struct making making[OBJECTS_MOST])
{
    uint8_t map[METHODS][ISAS] = {{0}};
    const stance_method *const *const methods = stance_methods();
    size_t n = 0;
    for (size_t k = 0; k < request->count; k++)
        for (size_t m = 0; m < METHODS && methods[m]; m++)
            for (size_t i = 0; i < ISAS && compiler_isa(i); i++)
                if (request->wanted[k].method == methods[m] && on_demand(methods[m]) &&
                    strcmp(request->wanted[k].isa, compiler_isa(i)) == 0)
                    map[m][i] = (uint8_t)(k + 1);
    uint8_t all[METHODS][ISAS];
    memcpy(all, map, sizeof all);
    parallel_largest(ranks, &all[0][0], sizeof all);
    for (size_t m = 0; m < METHODS; m++) {
        for (size_t i = 0; i < ISAS; i++) {
            const stance_kernel *const own =
                map[m][i] > 0 ? request->wanted[map[m][i] - 1].reference : NULL;
            if (all[m][i] > 0)
                making[n++] =
                    (struct making){.method = methods[m], .isa = compiler_isa(i), .reference = own};
        }
    }
    return n;
}

/* Rank 0's images reach every rank. Collective; `why` as of make, on every rank. */
static enum exit_code share(const struct parallel *ranks, enum exit_code code,
                            struct making *making, size_t count, stance_message *why)
{
    struct tidings tidings = {.code = code, .why = *why};
    bool room = true;
    for (size_t i = 0; i < count; i++) {
        tidings.size[i] = making[i].image.size;
        tidings.origin[i] = making[i].origin;
        memcpy(tidings.name[i], making[i].name, sizeof tidings.name[i]);
    }
    parallel_broadcast(ranks, &tidings, sizeof tidings);
    *why = tidings.why;
    if (tidings.code != EXIT_DONE)
        return tidings.code;
    for (size_t i = 0; i < count && ranks->rank > 0; i++) {
        struct image *const image = &making[i].image;
        making[i].origin = tidings.origin[i];
        memcpy(making[i].name, tidings.name[i], sizeof making[i].name);
        *image = (struct image){malloc(tidings.size[i] + 1), tidings.size[i]};
        room = room && image->bytes;
    }
    if (!room)
        no_memory(why);
    if (!parallel_agree(ranks, room, why->text, sizeof why->text))
        return EXIT_IO;
    for (size_t i = 0; i < count; i++)
        parallel_broadcast(ranks, making[i].image.bytes, making[i].image.size);
    return EXIT_DONE;
}

/* The kernel that this rank wants, from its image. *refused: it computes something else. */
static bool take(const struct objects_request *request, const struct making *m,
                 const stance_kernel *reference, struct object *object, uint8_t *refused,
                 stance_message *message)
{
    struct image_label label;
    if (!image_label(&m->image, &label))
        return complain(message, "a compiled kernel did not arrive whole");
    object->origin = m->origin;
    memcpy(object->key, label.key, sizeof object->key);
    memcpy(object->compiler, label.compiler, sizeof object->compiler);
    if (!load_object(&m->image, object, message))
        return false;
    *refused |= !m->checked && !load_check(object, reference, request, request->patience, message);
    return !*refused;
}

/* The kernel that is built in, in place of an object. */
static void take_reference(const struct objects_wanted *wanted, enum object_origin origin,
                           struct object *object)
{
    objects_release(object, 1);
    object->kernel = *wanted->reference;
    object->origin = origin;
    object->key[0] = object->compiler[0] = '\0';
}

/* Which of them a rank wants; count: none. */
static size_t place_of(const struct objects_wanted *wanted, const struct making *making,
                       size_t count)
{
    size_t at = 0;
    while (at < count &&
           (making[at].method != wanted->method || strcmp(making[at].isa, wanted->isa) != 0))
        at++;
    return at;
}

/* What this rank wants and does not have, from what there is. refused[count]: what it must not
 * have. */
static enum exit_code take_all(const struct objects_request *request, const struct making *making,
                               size_t count, struct object *object, uint8_t *refused,
                               stance_message *message)
{
    enum exit_code code = EXIT_DONE;
    for (size_t k = 0; k < request->count; k++) {
        const struct objects_wanted *const wanted = &request->wanted[k];
        const size_t at = place_of(wanted, making, count);
        const bool found = at < count && making[at].image.size > 0;
        if (object[k].origin != OBJECT_COMING)
            continue;
        if (found &&
            take(request, &making[at], wanted->reference, &object[k], &refused[at], message))
            continue;
        if (found && !refused[at]) {
            code = EXIT_IO;
        } else if (!found && !wanted->reference) {
            if (!on_demand(wanted->method)) /* else make has said why */
                complain(message, "%s is not compiled on demand, and none of this size is built in",
                         wanted->method->name);
            return EXIT_USAGE;
        }
        if (wanted->reference) /* which alone refuses */
            take_reference(wanted,
                           at == count ? OBJECT_REFERENCE
                           : found     ? OBJECT_REFUSED
                                       : making[at].origin,
                           &object[k]);
    }
    return code;
}

/* Objects of the cache that are refused are not taken again. */
static void forget_own(const struct making *making, size_t count, const uint8_t *refused,
                       const stance_message *why)
{
    struct cache cache;
    stance_message ignored;
    if (!memchr(refused, 1, count) || !cache_open(&cache, false, &ignored))
        return;
    for (size_t i = 0; i < count; i++) {
        struct image_label label;
        if (refused[i] && image_label(&making[i].image, &label))
            cache_refuse(&cache, making[i].name, &label, why->text);
    }
    cache_close(&cache);
}

/* Nor are those that another rank refuses. Collective: `why` is that of the first such rank. true:
 * there are any. */
static bool forget(const struct parallel *ranks, const struct making *making, size_t count,
                   uint8_t *refused, stance_message *why)
{
    parallel_largest(ranks, refused, count);
    if (ranks->rank == 0)
        forget_own(making, count, refused, why);
    return memchr(refused, 1, count) != NULL;
}

/* The signal to stop may be this rank's own. */
static void ask_to_stop(void *context)
{
    const struct objects_request *const request = context;
    if (request->stop)
        request->stop(request->context); /* which tells rank 0 */
}

enum exit_code objects_take(const struct parallel *ranks, const struct objects_request *request,
                            struct object *object, struct objects_later **later,
                            stance_message *message)
{
    struct making making[OBJECTS_MOST];
    const size_t count = list_wanted(ranks, request, making);
    uint8_t waits = !later;
    bool missing = false;
    for (size_t k = 0; k < request->count; k++) {
        waits |= !request->wanted[k].reference;
        object[k] = (struct object){.kernel = {.structure = request->scene->name,
                                               .method = request->wanted[k].method,
                                               .isa = request->wanted[k].isa},
                                    .origin = OBJECT_COMING,
                                    .memory = -1};
    }
    message->text[0] = '\0';
    struct objects_later *coming = NULL;
    parallel_largest(ranks, &waits, 1);
    const enum exit_code made =
        ranks->rank > 0 ? EXIT_DONE : make(request, !waits, making, count, &coming, message);
    parallel_meet(ranks, ask_to_stop, (void *)(uintptr_t)request); /* till then the cores are the
                                                                      compiler's */
    uint8_t code = (uint8_t)share(ranks, made, making, count, message);
    if (code == EXIT_DONE) {
        uint8_t refused[OBJECTS_MOST] = {0}, own = 0;
        stance_message why = *message;
        code = (uint8_t)take_all(request, making, count, object, refused, message);
        for (size_t i = 0; i < count; i++)
            own |= refused[i];
        parallel_agree(ranks, code == EXIT_DONE && !own, message->text, sizeof message->text);
        parallel_largest(ranks, &code, 1);
        if (code == EXIT_DONE && !request->looks && forget(ranks, making, count, refused, message))
            why = *message;
        uint8_t full = 0; /* some rank's memory */
        for (size_t i = 0; i < count && code == EXIT_DONE; i++)
            if (making[i].origin == OBJECT_COMING && !coming) {
                coming = later_make(request, making, count);
                full = !coming && !no_memory(message);
                break;
            }
        parallel_largest(ranks, &full, 1);
        if (full)
            code = EXIT_IO;
        for (size_t i = 0; i < count; i++)
            missing |=
                (making[i].image.size == 0 && making[i].origin != OBJECT_COMING) || refused[i];
        if (code == EXIT_DONE && missing && ranks->rank == 0 && why.text[0] && !request->looks)
            cache_say("%s; kernels that are built in compute instead, more slowly", why.text);
    }
    for (size_t i = 0; i < count; i++)
        image_free(&making[i].image);
    if (code != EXIT_DONE) {
        objects_release(object, request->count);
        objects_later_free(coming);
        coming = NULL;
    }
    if (later)
        *later = coming;
    return (enum exit_code)code;
}

void objects_later_take(struct objects_later *later, struct object *object)
{
    const struct objects_request *const request = &later->request;
    stance_message why = later->why;
    uint8_t refused[OBJECTS_MOST] = {0};
    struct cache cache;
    int missing = 0;
    if (!later->begun && cache_open(&cache, false, &why)) { /* they are in rank 0's memory */
        for (size_t i = 0; i < later->count; i++)
            if (later->making[i].origin == OBJECT_COMING &&
                cache_find(&cache, later->making[i].name, &later->making[i].image))
                later->making[i].origin = OBJECT_KEPT;
        cache_close(&cache);
    }
    for (size_t i = 0; i < later->count; i++)
        if (later->making[i].origin == OBJECT_COMING)
            later->making[i].origin = OBJECT_REFUSED; /* as good as */
    for (size_t k = 0; k < request->count; k++)
        missing -= object[k].origin == OBJECT_REFUSED;
    take_all(request, later->making, later->count, object, refused, &why);
    for (size_t k = 0; k < request->count; k++)
        missing += object[k].origin == OBJECT_REFUSED;
    forget_own(later->making, later->count, refused, &why);
    if (missing > 0)
        cache_say("%s; kernels that are built in compute on, more slowly",
                  why.text[0] ? why.text : "a compiled kernel is not in the cache");
}

void objects_release(struct object *object, size_t count)
{
    for (size_t k = 0; k < count; k++) {
        if (object[k].library)
            dlclose(object[k].library);
        if (object[k].memory >= 0)
            close(object[k].memory);
        object[k].library = NULL;
        object[k].memory = -1;
    }
}
