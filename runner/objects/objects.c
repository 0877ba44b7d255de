/* objects.c - rank 0 finds or makes the objects that any rank wants; all get the bytes. */
#include "objects.h"
#include "cache.h"
#include "compiler.h"
#include "load.h"
#include "sources.h"

#include "runner/base/checksum.h"
#include "runner/base/message.h"

#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { METHODS = 8, ISAS = OBJECTS_MOST / METHODS };
enum { ROOM = 2 << 20 }; /* bytes on the disk that compiling a kernel takes at most */

/* An object that some rank wants. */
struct making {
    const stance_method *method;
    const char *isa;
    const stance_kernel *reference; /* of this rank; NULL: none, or others alone want it */
    struct image image;             /* sealed */
    size_t stem;                    /* characters of the name that are any compiler's */
    char name[CACHE_NAME];          /* of its file */
    struct image_label label;
    enum object_origin origin;
    bool checked; /* on this rank */
};

/* What rank 0 tells all before the images: how long each is (0: there is none) and where it comes
 * from. */
struct tidings {
    uint64_t size[OBJECTS_MOST];
    enum object_origin origin[OBJECTS_MOST];
    bool stop; /* the job, for the reason in `why`, which else says why some are missing */
    stance_message why;
};

static bool on_demand(const stance_method *method)
{
    char path[80];
    snprintf(path, sizeof path, "engine/methods/%s.c", method->name);
    return sources_have(path);
}

/* ---- keys ---------------------------------------------------------------------------------- */

/* Hash of texts, each with its end. false: no memory. */
static bool hash_texts(const char *const *text, size_t count, char half[IMAGE_HALF])
{
    size_t size, embedded;
    char *all = NULL, hash[CHECKSUM_SHA256_TEXT];
    const char *const engine = sources(&embedded);
    FILE *const stream = open_memstream(&all, &size);
    for (size_t i = 0; stream && i < count; i++)
        fwrite(text[i], 1, strlen(text[i]) + 1, stream);
    if (stream)
        fwrite(engine, 1, embedded, stream);
    const bool good = stream && !ferror(stream);
    if ((stream && fclose(stream) != 0) || !good || !all) {
        free(all);
        return false;
    }
    checksum_sha256(all, size, hash);
    snprintf(half, IMAGE_HALF, "%.32s", hash);
    free(all);
    return true;
}

static bool name_object(struct making *m, const char *tables, const struct compiler *compiler)
{
    const char *const text[] = {tables, m->method->name, m->isa, compiler_flags(m->isa)};
    char what[IMAGE_HALF];
    if (!hash_texts(text, 4, what))
        return false;
    snprintf(m->label.key, sizeof m->label.key, "%s-%s", what, compiler->identity);
    snprintf(m->label.compiler, sizeof m->label.compiler, "%s", compiler->version);
    m->stem = (size_t)snprintf(m->name, sizeof m->name, "%s-%s-%s", m->method->name, m->isa, what);
    snprintf(m->name + m->stem, sizeof m->name - m->stem, "-%s.so", compiler->identity);
    return true;
}

/* A number for what is simulated, whatever the method. */
static uint64_t number_of(const char *tables)
{
    char half[IMAGE_HALF];
    return hash_texts(&tables, 1, half) ? strtoull(half + 16, NULL, 16) : 0;
}

/* ---- rank 0 -------------------------------------------------------------------------------- */

/* Runs the checks of a fresh image and seals it. What rank 0 does not want is checked by those who
 * do, what is kept by all who take it: it was checked with other numbers. */
static bool check(const struct objects_request *request, struct making *m, stance_message *message)
{
    struct object object = {.kernel = {request->scene, m->method, m->isa, 0, NULL, NULL},
                            .memory = -1};
    snprintf(object.compiler, sizeof object.compiler, "%s", m->label.compiler);
    const bool good = load_object(&m->image, &object, message) &&
                      load_check(&object, m->reference, request, message);
    objects_release(&object, 1);
    m->label.checked = m->reference && request->checks > 0;
    m->checked = good;
    return good && (image_seal(&m->image, &m->label) || no_memory(message));
}

static void tell(const struct making *const *missing, size_t count, const struct compiler *compiler)
{
    char list[300] = "";
    size_t used = 0;
    for (size_t i = 0; i < count && used < sizeof list; i++)
        used += (size_t)snprintf(list + used, sizeof list - used, "%s%s (%s)", i ? ", " : "",
                                 missing[i]->method->name, missing[i]->isa);
    cache_say("compiling %s with %s", list, compiler->version);
}

/* Compiles those. What cannot be had stays without an image. */
static void compile(const struct objects_request *request, const struct cache *cache,
                    const struct compiler *compiler, struct making *const *missing, size_t count,
                    stance_message *why)
{
    struct compilation wanted[OBJECTS_MOST];
    struct place place;
    if (!cache_place(cache, number_of(request->tables), ROOM * count, &place, why))
        return;
    if (!sources_write_file(place.directory, COMPILER_TABLES, request->tables,
                            strlen(request->tables))) {
        complain(why, "there is no room to compile in");
        cache_leave(&place);
        return;
    }
    if (!request->quiet)
        tell((const struct making *const *)missing, count, compiler);
    for (size_t i = 0; i < count; i++)
        wanted[i] =
            (struct compilation){.method = missing[i]->method->name, .isa = missing[i]->isa};
    compiler_run(compiler, place.directory, wanted, count);
    for (size_t i = 0; i < count; i++) {
        struct making *const m = missing[i];
        m->image = wanted[i].image;
        m->origin = OBJECT_COMPILED;
        if (!m->image.bytes)
            *why = wanted[i].message;
        else if (check(request, m, why))
            cache_keep(cache, &place, m->name, &m->image);
        else
            image_free(&m->image);
    }
    cache_leave(&place);
}

/* Which of them have no image, after a look into the cache. */
static size_t look(const struct cache *cache, bool stem, struct making *making, size_t count,
                   struct making **missing)
{
    size_t n = 0;
    for (size_t i = 0; i < count; i++) {
        struct making *const m = &making[i];
        char name[CACHE_NAME];
        snprintf(name, sizeof name, "%.*s", stem ? (int)m->stem : CACHE_NAME, m->name);
        if (!m->image.bytes && !cache_find(cache, name, stem, &m->image))
            missing[n++] = m;
    }
    return n;
}

/* Finds or makes the objects. false: the job has to stop; `why` says why, or why some are missing.
 */
static bool make(const struct objects_request *request, struct making *making, size_t count,
                 stance_message *why)
{
    struct making *missing[OBJECTS_MOST];
    struct compiler compiler = {.identity = ""};
    struct cache cache;
    const bool compiles = compiler_find(&compiler, why);
    for (size_t i = 0; i < count; i++)
        if (!name_object(&making[i], request->tables, &compiler))
            return no_memory(why);
    if (!cache_open(&cache, why))
        return false;
    size_t n = look(&cache, !compiles, making, count, missing);
    if (n > 0 && request->brief) {
        why->text[0] = '\0';
    } else if (n > 0 && compiles) {
        cache_lock(&cache, number_of(request->tables));
        n = look(&cache, false, making, count, missing); /* another job may have made it */
        if (n > 0)
            compile(request, &cache, &compiler, missing, n, why);
    } else if (n > 0) {
        const size_t used = strlen(why->text);
        snprintf(why->text + used, sizeof why->text - used,
                 "; `stance build` where there is one, and copy %.100s/%.60s...", cache.path,
                 missing[0]->name);
    }
    cache_close(&cache);
    return true;
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
static bool share(const struct parallel *ranks, bool good, struct making *making, size_t count,
                  stance_message *why)
{
    struct tidings tidings = {.stop = !good, .why = *why};
    bool room = true;
    for (size_t i = 0; i < count; i++) {
        tidings.size[i] = making[i].image.size;
        tidings.origin[i] = making[i].origin;
    }
    parallel_broadcast(ranks, &tidings, sizeof tidings);
    *why = tidings.why;
    if (tidings.stop)
        return false;
    for (size_t i = 0; i < count && ranks->rank > 0; i++) {
        struct image *const image = &making[i].image;
        making[i].origin = tidings.origin[i];
        *image = (struct image){malloc(tidings.size[i] + 1), tidings.size[i]};
        room = room && image->bytes;
    }
    if (!room)
        no_memory(why);
    if (!parallel_agree(ranks, room, why->text, sizeof why->text))
        return false;
    for (size_t i = 0; i < count; i++)
        parallel_broadcast(ranks, making[i].image.bytes, making[i].image.size);
    return true;
}

/* The kernel that this rank wants, from its image; *differs: it computes something else than the
 * reference, and is not taken. */
static bool take(const struct objects_request *request, const struct making *m,
                 const stance_kernel *reference, struct object *object, bool *differs,
                 stance_message *message)
{
    struct image_label label;
    *differs = false;
    if (!image_label(&m->image, &label))
        return complain(message, "a compiled kernel did not arrive whole");
    object->origin = m->origin;
    memcpy(object->key, label.key, sizeof object->key);
    memcpy(object->compiler, label.compiler, sizeof object->compiler);
    if (!load_object(&m->image, object, message))
        return false;
    *differs = !m->checked && !load_check(object, reference, request, message);
    if (*differs)
        objects_release(object, 1);
    return true;
}

/* What this rank wants, from what there is; *differs: something of it is not taken, `message` says
 * why. */
static enum exit_code take_all(const struct objects_request *request, const struct making *making,
                               size_t count, struct object *object, bool *differs,
                               stance_message *message)
{
    for (size_t k = 0; k < request->count; k++) {
        const struct objects_wanted *const wanted = &request->wanted[k];
        const struct making *found = NULL;
        for (size_t i = 0; i < count; i++)
            if (making[i].method == wanted->method && strcmp(making[i].isa, wanted->isa) == 0 &&
                making[i].image.size > 0)
                found = &making[i];
        bool refused = false;
        if (found && !take(request, found, wanted->reference, &object[k], &refused, message))
            return EXIT_IO;
        *differs |= refused;
        if (!found && !wanted->reference) {
            if (!on_demand(wanted->method)) /* else make has said why */
                complain(message, "%s is not compiled on demand, and none of this size is built in",
                         wanted->method->name);
            return EXIT_USAGE;
        }
        if (!found || refused)
            object[k] = (struct object){
                .kernel = *wanted->reference, .origin = OBJECT_REFERENCE, .memory = -1};
    }
    return EXIT_DONE;
}

static void nothing(void *context)
{
    (void)context;
}

const char *objects_isa(size_t index)
{
    return compiler_isa(index);
}

enum exit_code objects_take(const struct parallel *ranks, const struct objects_request *request,
                            struct object *object, stance_message *message)
{
    struct making making[OBJECTS_MOST];
    const size_t count = list_wanted(ranks, request, making);
    uint8_t code = EXIT_IO;
    bool missing = false, differs = false;
    for (size_t k = 0; k < request->count; k++)
        object[k] = (struct object){.kernel = {.scene = request->scene,
                                               .method = request->wanted[k].method,
                                               .isa = request->wanted[k].isa},
                                    .memory = -1};
    message->text[0] = '\0';
    const bool made = ranks->rank > 0 || make(request, making, count, message);
    parallel_meet(ranks, nothing, NULL); /* until then the cores are the compiler's */
    if (share(ranks, made, making, count, message)) {
        stance_message why = *message;
        code = (uint8_t)take_all(request, making, count, object, &differs, message);
        if (differs)
            why = *message;
        parallel_agree(ranks, code == EXIT_DONE, message->text, sizeof message->text);
        parallel_largest(ranks, &code, 1);
        for (size_t i = 0; i < count; i++)
            missing |= making[i].image.size == 0 && !request->brief;
        if (code == EXIT_DONE && (missing || differs) && ranks->rank == 0)
            cache_say("%s; kernels that are built in compute instead, more slowly", why.text);
    }
    for (size_t i = 0; i < count; i++)
        image_free(&making[i].image);
    if (code != EXIT_DONE)
        objects_release(object, request->count);
    return (enum exit_code)code;
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
