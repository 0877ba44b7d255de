/* mujoco_library.c - libmujoco at run time. */
#include "mujoco_library.h"

#include "runner/base/command.h"
#include "runner/base/message.h"

#ifdef MUJOCO_HEADER

#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

/* Where standard error goes, while it is hushed; -1: it is not. The library's errors know no
 * context. */
static int hushed = -1;

static void hush(void)
{
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    fflush(stderr);
    hushed = nowhere < 0 ? -1 : fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    if (hushed >= 0)
        dup2(nowhere, STDERR_FILENO);
    if (nowhere >= 0)
        close(nowhere);
}

static void speak(void)
{
    fflush(stderr);
    if (hushed < 0)
        return;
    dup2(hushed, STDERR_FILENO);
    close(hushed);
    hushed = -1;
}

/* What it cannot go on from. */
static void end_here(const char *text)
{
    speak();
    fprintf(stderr, "stance import: libmujoco: %.200s\n", text);
    fflush(stderr);
    _exit(EXIT_USAGE);
}

static void pass_over(const char *text)
{
    (void)text;
}

/* A function or variable by its name. */
static bool find(void *library, const char *name, void *pointer)
{
    void *const found = dlsym(library, name);
    memcpy(pointer, &found, sizeof found);
    return found != NULL;
}

static bool find_all(struct mujoco *m)
{
    void (**error)(const char *) = NULL, (**warning)(const char *) = NULL;
    bool all = find(m->library, "mju_user_error", &error) &&
               find(m->library, "mju_user_warning", &warning);
#define MUJOCO_FIND(name) all = all && find(m->library, #name, &m->name);
    MUJOCO_FUNCTIONS(MUJOCO_FIND)
#undef MUJOCO_FIND
    if (all) {
        *error = end_here;
        *warning = pass_over;
    }
    return all;
}

bool mujoco_open(struct mujoco *m, spatial_message *message)
{
    char exact[32];
    snprintf(exact, sizeof exact, "libmujoco.so.%d.%d.%d", mjVERSION_HEADER / 100,
             mjVERSION_HEADER / 10 % 10, mjVERSION_HEADER % 10);
    *m = (struct mujoco){.library = dlopen(exact, RTLD_NOW | RTLD_LOCAL)};
    if (!m->library)
        m->library = dlopen("libmujoco.so", RTLD_NOW | RTLD_LOCAL);
    if (!m->library)
        return complain(message, "libmujoco is not installed (Debian: apt install libmujoco-dev)");
    if (!find_all(m) || m->mj_version() != mjVERSION_HEADER) {
        mujoco_close(m);
        return complain(message,
                        "libmujoco is not of version %d, for which this program was built: "
                        "build it again beside that library's header",
                        mjVERSION_HEADER);
    }
    return true;
}

mjModel *mujoco_load(const struct mujoco *m, const char *path, char *error, int size)
{
    hush();
    mjModel *const model = m->mj_loadXML(path, NULL, error, size);
    speak();
    return model;
}

static void move(double *ours, double *theirs, size_t count, bool put)
{
    memcpy(put ? theirs : ours, put ? ours : theirs, count * sizeof *ours);
}

void mujoco_body(const mjModel *m, int id, struct spatial_body *body, bool put)
{
    move(body->at, m->body_pos + 3 * id, 3, put);
    move(body->centre, m->body_ipos + 3 * id, 3, put);
    move(&body->mass, m->body_mass + id, 1, put);
}

void mujoco_joint(const mjModel *m, int id, struct spatial_joint *joint, bool put)
{
    const int q = m->jnt_qposadr[id], dof = m->jnt_dofadr[id];
    move(joint->axis, m->jnt_axis + 3 * id, 3, put);
    move(joint->at, m->jnt_pos + 3 * id, 3, put);
    move(joint->limits, m->jnt_range + 2 * id, 2, put);
    move(&joint->stiffness, m->jnt_stiffness + id, 1, put);
    move(&joint->damping, m->dof_damping + dof, 1, put);
    move(&joint->armature, m->dof_armature + dof, 1, put);
    move(&joint->reference, m->qpos0 + q, 1, put);
    move(&joint->spring_reference, m->qpos_spring + q, 1, put);
}

void mujoco_close(struct mujoco *m)
{
    if (m->library)
        dlclose(m->library);
    m->library = NULL;
}

#else

bool mujoco_open(struct mujoco *m, spatial_message *message)
{
    (void)m;
    return complain(message, "this program was built without libmujoco 2.2 (Debian: apt install "
                             "libmujoco-dev, then make)");
}

#endif
