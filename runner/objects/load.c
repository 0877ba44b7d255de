/* load.c - see load.h. */
#include "load.h"

#include "runner/base/message.h"

#include <dlfcn.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

/* No file has to be there on every machine, and nobody can change what is loaded. The descriptor
 * stays open: its number is the library's name, by which the linker would give the same library for
 * another image. */
bool load_library(const struct image *image, void **library, int *descriptor,
                  stance_message *message)
{
    char path[40];
    *descriptor = memfd_create("stance-object", MFD_CLOEXEC);
    if (*descriptor < 0)
        return complain(message, "no memory for a compiled object: %s", strerror(errno));
    for (size_t done = 0; done < image->size;) {
        const ssize_t n = write(*descriptor, image->bytes + done, image->size - done);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return complain(message, "no memory for a compiled object: %s", strerror(errno));
        done += (size_t)n;
    }
    snprintf(path, sizeof path, "/proc/self/fd/%d", *descriptor);
    *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    return *library || complain(message, "a compiled kernel cannot be loaded: %.180s", dlerror());
}

bool load_object(const struct image *image, struct object *object, stance_message *message)
{
    if (!load_library(image, &object->library, &object->memory, message))
        return false;
    const stance_object *const exported = dlsym(object->library, "stance_kernel_object");
    if (!exported || exported->case_size != sizeof(stance_case) ||
        exported->result_size != sizeof(stance_result))
        return complain(message, "a compiled kernel is not of this program");
    object->kernel.lanes = exported->lanes;
    object->kernel.stream = exported->stream;
    object->kernel.run = exported->run;
    return true;
}

/* The name of an answer that differs, NULL: none does. A NAN is as good as another. */
static const char *difference(const stance_result *a, const stance_result *b, int coordinates)
{
    if (a->status != b->status)
        return "status";
    for (int i = 0; i < STANCE_ANSWER_COUNT; i++) {
        const stance_answer *const answer = &stance_answers[i];
        const char *const left = (const char *)a + answer->offset;
        const char *const right = (const char *)b + answer->offset;
        double x[2] = {0, 0};
        if (answer->type == STANCE_DOUBLE) {
            memcpy(&x[0], left, sizeof x[0]);
            memcpy(&x[1], right, sizeof x[1]);
        }
        if (memcmp(left, right, answer->size) != 0 && !(isnan(x[0]) && isnan(x[1])))
            return answer->name;
    }
    const void *const states[][2] = {{a->position, b->position}, {a->velocity, b->velocity}};
    for (size_t k = 0; k < sizeof states / sizeof states[0]; k++)
        if (memcmp(states[k][0], states[k][1], (size_t)coordinates * sizeof(double)) != 0)
            return "state";
    return NULL;
}

enum { TOGETHER = 16 }; /* checks: of kernels with lanes some cost little more than one */

static double thread_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

bool load_check(const struct object *object, const stance_kernel *reference,
                const struct objects_request *request, double seconds, stance_message *message)
{
    struct together {
        stance_case input[TOGETHER];
        stance_result expected[TOGETHER], got[TOGETHER];
    } *const t = malloc(sizeof *t);
    const size_t n = reference ? request->checks : 0, turns = (n + TOGETHER - 1) / TOGETHER;
    const double begin = thread_seconds();
    bool good = t || no_memory(message);
    for (size_t turn = 0; good && turn < turns; turn++) {
        size_t count = 0;
        if (turn > 0 && thread_seconds() - begin > seconds)
            break;
        for (size_t i = turn; i < n; i += turns) /* of each kind some */
            t->input[count++] = request->check[i];
        reference->run(t->input, t->expected, count);
        object->kernel.run(t->input, t->got, count);
        for (size_t i = 0; good && i < count; i++) {
            const char *const what =
                difference(&t->expected[i], &t->got[i], request->scene->coordinates);
            good =
                !what || complain(message,
                                  "%s for %s, compiled by %.60s, computes another %s in check %zu: "
                                  "refused; another compiler may be named by CC",
                                  object->kernel.method->name, object->kernel.isa, object->compiler,
                                  what, turn + i * turns);
        }
    }
    free(t);
    return good;
}
