/* program.c - see program.h. */
#include "program.h"
#include "cache.h"
#include "compiler.h"
#include "load.h"

#include "engine/mechanism.h"

#include "runner/base/message.h"
#include "runner/ranks/crash.h"

#include <dlfcn.h>
#include <elf.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* What the object exports: as in stance_law.h. */
struct law_object {
    unsigned long sample, parameters, memory, torques; /* bytes */
    const char *names;                                 /* of parameters: "a;b[2];" */
    void (*law)(const double *now, const double *is, double *mine, double *out);
};

struct program {
    stance_program base;
    const struct law_object *object;
    void *library;
    int descriptor;
    int measured, sample, memory, torques; /* numbers */
    uint64_t samples;
    struct crash_law *watch;
    char file[100];
    bool said; /* what it does wrong is said once */
};

/* ---- a case's -------------------------------------------------------------------------------- */

/* A number that no law computes by chance: between what is its own. */
static const double guard = 0x1.57a11ce0badc0p-731;

/* Of a case, with a guard before and behind each: sample, memory, torques. All from the sample on.
 */
enum { GUARD = 16 }; /* numbers: room for what runs a little too far */
static double *memory_of(const struct program *p, double *sample)
{
    return sample + p->sample + GUARD;
}
static double *torque_of(const struct program *p, double *sample)
{
    return sample + p->sample + p->memory + 2 * GUARD;
}

static bool guarded(const struct program *p, double *sample)
{
    const double *const out = torque_of(p, sample);
    return sample[-1] == guard && sample[p->sample] == guard && out[-1] == guard &&
           out[p->torques] == guard;
}

static double *begin(const stance_program *program, const stance_case *c)
{
    const struct program *const p = (const struct program *)program;
    double *const all =
        calloc((size_t)p->sample + (size_t)p->memory + (size_t)p->torques + 4 * (size_t)GUARD,
               sizeof *all);
    if (!all)
        return NULL;
    double *const sample = all + GUARD, *const out = torque_of(p, sample);
    sample[-1] = sample[p->sample] = out[-1] = out[p->torques] = guard;
    program_put_rest(c, sample + p->measured);
    return sample;
}

static void end(const stance_program *program, double *sample)
{
    (void)program;
    free(sample ? sample - GUARD : NULL);
}

static uint64_t case_of(const struct program *p, const stance_case *c)
{
    return c->grid_index * p->samples + c->sample_index;
}

/* Says it once; the case fails by itself. */
static const double *useless(const struct program *p, const stance_case *c)
{
    if (!p->said)
        cache_say("the law %s gives torques that are not finite in case %llu, or others: such "
                  "cases fail%s",
                  p->file, (unsigned long long)case_of(p, c),
                  c->has_target ? ""
                                : "; now->target and now->rest are NAN, as the scenario begins at "
                                  "no equilibrium");
    ((struct program *)(uintptr_t)p)->said = true;
    return NULL;
}

static const double *act(const stance_program *program, const stance_case *c, double *sample)
{
    const struct program *const p = (const struct program *)program;
    double *const out = torque_of(p, sample), sum = 0;
    for (int i = 0; i < p->torques; i++)
        out[i] = 0;
    crash_law_begins(p->watch, p->file, case_of(p, c));
    p->object->law(sample, c->parameter, memory_of(p, sample), out);
    crash_law_ends(p->watch);
    for (int i = 0; i < p->torques; i++)
        sum += out[i] - out[i];
    if (!guarded(p, sample))
        crash_law_fault(p->file, " wrote beyond what is its own", p->watch->index);
    return sum == 0 ? out : useless(p, c);
}

/* ---- the scenario's names, as C -------------------------------------------------------------- */

/* A name that C takes: letters, digits, _; none of its own words. */
static void name_in_c(const char *name, char text[STANCE_NAME + 8])
{
    static const char words[] =
        " auto break case char const continue default do double else enum extern float for goto if "
        "inline int long register restrict return short signed sizeof static struct switch typedef "
        "union unsigned void volatile while all asm typeof sin cos tan asin acos atan atan2 exp "
        "tanh "
        "fma fmin fmax floor data NAN INFINITY M_PI M_PI_2 M_PI_4 M_E ";
    char search[STANCE_NAME + 2];
    size_t n = 0;
    for (; n < STANCE_NAME && name[n]; n++) {
        const char c = name[n];
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' ||
                           (c >= '0' && c <= '9' && n > 0);
        text[n] = plain ? c : '_';
    }
    text[n] = '\0';
    snprintf(search, sizeof search, " %.*s ", STANCE_NAME - 2, text);
    if (strstr(words, search))
        snprintf(text + n, 8, "_");
}

static void print_names(FILE *out, const char *list, int n, const char *const *name)
{
    char text[STANCE_NAME + 8];
    fprintf(out, "#define LAW_%s(X)", list);
    for (int i = 0; i < n; i++) {
        name_in_c(name[i], text);
        fprintf(out, " X(%s)", text);
    }
    fprintf(out, "\nenum { %s = %d };\n", list, n);
}

/* names.h, and the source with its name; freed by the caller. NULL: no memory. */
static char *names_text(const struct program_text *text, const stance_scene *scene)
{
    const char *coordinate[STANCE_MAX_COORDINATES];
    char *all = NULL;
    size_t size;
    FILE *const out = open_memstream(&all, &size);
    if (!out)
        return NULL;
    for (int i = 0; i < scene->coordinates; i++)
        coordinate[i] = scene->coordinate[i].name;
    print_names(out, "COORDINATES", scene->coordinates, coordinate);
    print_names(out, "CONTACTS", scene->contacts, scene->contact_name);
    print_names(out, "ACTUATORS", scene->actuators, scene->actuator_name);
    fprintf(out, "enum { POSTURES = %d };\n", scene->postures);
    fprintf(out, "enum { DATA = %zu };\nstatic const double data[DATA] = {", text->count);
    for (size_t i = 0; i < text->count; i++)
        fprintf(out, "%s%a", i ? ", " : "", text->data[i]);
    fprintf(out, "};\n");
    if (fclose(out) == 0)
        return all;
    free(all);
    return NULL;
}

static char *source_text(const struct program_text *text)
{
    char *all = NULL;
    size_t size;
    FILE *const out = open_memstream(&all, &size);
    if (!out)
        return NULL;
    fputs("#line 1 \"", out);
    for (const char *c = text->file; *c; c++)
        fputc(*c == '"' || *c == '\\' || (unsigned char)*c < ' ' ? '_' : *c, out);
    fprintf(out, "\"\n%s", text->source);
    if (fclose(out) == 0)
        return all;
    free(all);
    return NULL;
}

/* ---- compiling ------------------------------------------------------------------------------- */

#define LAW_DIRECTORY "runner/objects/law"
/* Arrays whose size is known are not left; what is undefined is looked at in the object. */
#define LAW_FLAGS                                                                                  \
    "-I" LAW_DIRECTORY " -Werror=implicit-function-declaration -Werror=implicit-int "              \
    "-Werror=incompatible-pointer-types -fsanitize-undefined-trap-on-error"
/* gcc takes an array at the end of a struct for one without end, unless told otherwise. */
#define LAW_FLAGS_GCC LAW_FLAGS " -fsanitize=bounds-strict"
#define LAW_FLAGS_CLANG LAW_FLAGS " -fsanitize=bounds"

/* One lane; of processors without fused multiply-adds two, which emulate them. */
static const char *law_isa(void)
{
    const char *last = "scalar";
    for (int rank = 0; stance_isa(rank); rank++) {
        last = stance_isa(rank);
        if (strcmp(last, "scalar") == 0)
            break;
    }
    return last;
}

static const char *law_flags(const struct compiler *compiler)
{
    return strstr(compiler->version, "clang") ? LAW_FLAGS_CLANG : LAW_FLAGS_GCC;
}

void program_hash(const char *source, char hash[CHECKSUM_SHA256_TEXT])
{
    checksum_sha256(source, strlen(source), hash);
}

/* `law` says for what, and how; its image is handed over. */
static bool compile(struct compilation *law, const char *source, const char *names,
                    const struct compiler *compiler, struct image *image, stance_message *message)
{
    const struct compiler_file files[] = {{"names.h", names}, {"law.c", source}};
    struct watch watch = {.doing = "compiling a law", .progress = progress_begin(true)};
    law->source[0] = "law.c";
    law->source[1] = LAW_DIRECTORY "/law_math.c";
    watch_begin(&watch);
    compiler_run(compiler, files, sizeof files / sizeof *files, law, 1, &watch);
    watch_end(&watch);
    *image = law->image;
    if (!image->bytes)
        *message = law->message;
    return image->bytes != NULL;
}

bool program_for_page(const struct program_text *text, const stance_scene *scene,
                      struct image *image, stance_message *message)
{
    static const char flags[] =
        "--target=wasm32-wasi -O2 -std=c17 -ffp-contract=off -fno-math-errno -w -I. "
        "-DSTANCE_LANES=2 "
        "-msimd128 -mexec-model=reactor -Wl,--strip-all,--gc-sections -lm " LAW_FLAGS_CLANG;
    struct compilation law = {.method = text->file, .isa = "WebAssembly", .flags = flags};
    struct compiler clang;
    char *const source = source_text(text), *const names = names_text(text, scene);
    *image = (struct image){NULL, 0};
    bool good = (source && names) || no_memory(message);
    good = good && (compiler_named(&clang, "clang") ||
                    complain(message, "clang, which compiles laws for pages, does not run here"));
    good = good && compile(&law, source, names, &clang, image, message);
    free(source);
    free(names);
    return good;
}

/* ---- what is in it --------------------------------------------------------------------------- */

/* The compiler may ask for these by itself, and processors without the instruction for the last. */
static bool may_call(const char *name)
{
    static const char *const known[] = {"memcpy", "memmove", "memset", "memcmp", "fma"};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (strcmp(name, known[i]) == 0)
            return true;
    return false;
}

/* A section of an ELF file; false: it is not whole. */
static bool section(const struct image *image, size_t i, Elf64_Shdr *to)
{
    Elf64_Ehdr head;
    memcpy(&head, image->bytes, sizeof head);
    const size_t at = head.e_shoff + i * sizeof *to;
    if (i >= head.e_shnum || head.e_shoff > image->size || at + sizeof *to > image->size)
        return false;
    memcpy(to, image->bytes + at, sizeof *to);
    return to->sh_type == SHT_NOBITS ||
           (to->sh_offset <= image->size && to->sh_size <= image->size - to->sh_offset);
}

static const char *text_at(const struct image *image, const Elf64_Shdr *strings, size_t at)
{
    return at < strings->sh_size ? image->bytes + strings->sh_offset + at : "";
}

/* Functions that it calls and nobody has. */
static bool calls_known(const struct image *image, const Elf64_Shdr *symbols, const char *file,
                        stance_message *message)
{
    Elf64_Shdr strings;
    if (!section(image, symbols->sh_link, &strings))
        return complain(message, "%s: not compiled to an ELF file", file);
    for (size_t i = 1; i < symbols->sh_size / sizeof(Elf64_Sym); i++) {
        Elf64_Sym symbol;
        memcpy(&symbol, image->bytes + symbols->sh_offset + i * sizeof symbol, sizeof symbol);
        const char *const name = text_at(image, &strings, symbol.st_name);
        if (symbol.st_shndx == SHN_UNDEF && strcmp(name, "law") == 0)
            return complain(message, "%.80s: has no function law (stance_law.h says which)", file);
        if (symbol.st_shndx == SHN_UNDEF && !may_call(name))
            return complain(
                message,
                "%.60s: calls %.40s, which is none of the functions of stance_law.h (sin, cos, "
                "tan, atan2, exp, tanh, sqrt, fabs, fma, fmax, floor ...)",
                file, name);
    }
    return true;
}

/* Nothing runs when it is loaded or given back. */
static bool begins_quietly(const struct image *image, const Elf64_Shdr *dynamic)
{
    for (size_t i = 0; i < dynamic->sh_size / sizeof(Elf64_Dyn); i++) {
        Elf64_Dyn entry;
        memcpy(&entry, image->bytes + dynamic->sh_offset + i * sizeof entry, sizeof entry);
        if (entry.d_tag == DT_INIT || entry.d_tag == DT_FINI)
            return false;
    }
    return true;
}

/* Nothing outlives a call, and nothing is called that is not there. */
static bool look_into(const struct image *image, const char *file, stance_message *message)
{
    static const char *const linkers[] = {".dynamic", ".got", ".got.plt", ".data.rel.ro"};
    Elf64_Ehdr head = {0};
    Elf64_Shdr names, is;
    if (image->size > sizeof head)
        memcpy(&head, image->bytes, sizeof head);
    if (memcmp(head.e_ident, ELFMAG, SELFMAG) != 0 || !section(image, head.e_shstrndx, &names))
        return complain(message, "%.80s: not compiled to an ELF file", file);
    for (size_t i = 1; i < head.e_shnum; i++) {
        if (!section(image, i, &is))
            return complain(message, "%.80s: not compiled to a whole ELF file", file);
        const char *const name = text_at(image, &names, is.sh_name);
        bool lasts = (is.sh_flags & SHF_WRITE) && is.sh_size > 0;
        for (size_t k = 0; k < sizeof linkers / sizeof *linkers; k++)
            lasts = lasts && strncmp(name, linkers[k], strlen(linkers[k])) != 0;
        if (is.sh_type == SHT_INIT_ARRAY || is.sh_type == SHT_FINI_ARRAY ||
            (is.sh_type == SHT_DYNAMIC && !begins_quietly(image, &is)))
            return complain(message, "%.80s: has constructors or destructors: law alone is called",
                            file);
        if (lasts)
            return complain(message,
                            "%.80s: has variables that outlive a call of law (static, or outside "
                            "functions): make them const, or MEMORY",
                            file);
        if (is.sh_type == SHT_DYNSYM && !calls_known(image, &is, file, message))
            return false;
    }
    return true;
}

/* ---- loading --------------------------------------------------------------------------------- */

static bool found(const struct program_text *text, const char *source, const char *names,
                  struct image *image, stance_message *message)
{
    const char *const part[] = {source, names, LAW_FLAGS_GCC, LAW_FLAGS_CLANG,
                                compiler_flags(law_isa())};
    struct compiler compiler = {.identity = ""};
    struct image_label label;
    struct cache cache;
    stance_message unkept;
    char name[CACHE_NAME];
    const bool compiles = compiler_find(&compiler, message);
    const stance_message why = *message;
    if (!compiler_label(&compiler, part, sizeof part / sizeof *part, &label))
        return no_memory(message);
    if (!cache_open(&cache, false, message))
        return false;
    snprintf(name, sizeof name, "program-%s.so", label.key);
    bool good = cache_find(&cache, name, image);
    if (!good && !compiles) {
        complain(message, "%.80s: %.140s", text->file, why.text);
    } else if (!good) {
        struct compilation law = {
            .method = text->file, .isa = law_isa(), .flags = law_flags(&compiler)};
        good = compile(&law, source, names, &compiler, image, message) &&
               look_into(image, text->file, message) &&
               (image_seal(image, &label) || no_memory(message));
        if (good)
            cache_keep(&cache, name, image, &unkept);
    }
    cache_close(&cache);
    return good;
}

/* What the object says of itself against what the scenario knows. */
static bool take(struct program *p, const stance_scene *scene, size_t numbers, const char *names,
                 stance_message *message)
{
    p->object = dlsym(p->library, "stance_law_object");
    if (!p->object)
        return complain(message, "%.80s: does not include stance_law.h", p->file);
    p->measured = STANCE_SAMPLE_HEAD + 2 * scene->coordinates + scene->contacts;
    p->sample = p->measured + scene->coordinates + scene->actuators;
    p->torques = scene->actuators;
    p->memory = (int)(p->object->memory / sizeof(double));
    p->base.remembers = p->memory > 0;
    if (p->object->sample != (size_t)p->sample * sizeof(double) ||
        p->object->torques != (size_t)p->torques * sizeof(double))
        return complain(message, "%.80s: was not compiled for this robot", p->file);
    if (p->object->parameters != numbers * sizeof(double) || strcmp(p->object->names, names) != 0)
        return complain(
            message,
            "%.40s: its PARAMETERS are %.50s to the compiler and %.50s to the scenario: "
            "they must not depend on #if",
            p->file, p->object->names[0] ? p->object->names : "none", names[0] ? names : "none");
    return true;
}

stance_program *program_load(const struct program_text *text, const stance_scene *scene,
                             size_t numbers, stance_message *message)
{
    struct image image = {NULL, 0};
    struct program *const p = calloc(1, sizeof *p);
    char *const source = source_text(text), *const names = names_text(text, scene);
    bool good = (p && source && names) || no_memory(message);
    if (good) {
        p->base = (stance_program){false, begin, act, end};
        p->descriptor = -1;
        p->samples = text->samples;
        snprintf(p->file, sizeof p->file, "%s", text->file);
        good = found(text, source, names, &image, message) &&
               load_library(&image, &p->library, &p->descriptor, message) &&
               take(p, scene, numbers, text->parameters, message);
        p->watch = good ? crash_law_watch() : NULL;
    }
    image_free(&image);
    free(source);
    free(names);
    if (good)
        return &p->base;
    program_free(p ? &p->base : NULL);
    return NULL;
}

void program_free(stance_program *program)
{
    struct program *const p = (struct program *)program;
    if (p && p->library)
        dlclose(p->library);
    if (p && p->descriptor >= 0)
        close(p->descriptor);
    free(p);
}
