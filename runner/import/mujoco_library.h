/* mujoco_library.h - libmujoco, loaded when it is there: nothing else of the program needs it.
 *
 * What is known of it stands in its header; a library of another version than the header's has
 * other structs and is refused. Its errors end the process with one line (it would wait for a key),
 * so that it is for processes of their own (runner/base/sandbox.h); its warnings are dropped (it
 * would write a file).
 */
#ifndef RUNNER_IMPORT_MUJOCO_LIBRARY_H
#define RUNNER_IMPORT_MUJOCO_LIBRARY_H

#include "spatial.h"

#if __has_include(<mujoco/mujoco.h>)
#include <mujoco/mujoco.h>
#if mjVERSION_HEADER >= 220 && mjVERSION_HEADER < 230 /* later ones have other members */
#define MUJOCO_HEADER
#endif
#endif

#ifdef MUJOCO_HEADER

/* clang-format off */
#define MUJOCO_FUNCTIONS(X) \
    X(mj_version) X(mj_loadXML) X(mj_deleteModel) X(mj_makeData) X(mj_deleteData) X(mj_resetData) \
    X(mj_name2id) X(mj_id2name) X(mj_forward) X(mj_fwdPosition) X(mj_fwdVelocity) X(mj_fwdActuation) \
    X(mj_fullM) X(mj_rnePostConstraint) X(mj_objectVelocity) X(mj_objectAcceleration) X(mju_mat2Quat)
/* clang-format on */

struct mujoco {
    void *library;
#define MUJOCO_POINTER(name) __typeof__(name) *(name);
    MUJOCO_FUNCTIONS(MUJOCO_POINTER)
#undef MUJOCO_POINTER
};

void mujoco_close(struct mujoco *m);

/* A file's model, to be given to mj_deleteModel; NULL: `error` of `size` bytes says why, in lines.
 * What the library's helpers print meanwhile (of meshes) goes nowhere. */
mjModel *mujoco_load(const struct mujoco *m, const char *path, char *error, int size);

/* Numbers that both models have in the same units, of MuJoCo's body or joint (of one coordinate)
 * `id`: from there, or with `put` to there. */
void mujoco_body(const mjModel *m, int id, struct spatial_body *body, bool put);
void mujoco_joint(const mjModel *m, int id, struct spatial_joint *joint, bool put);
#else
struct mujoco {
    void *library;
};
#endif

/* False: it is not there, or this program was built without its header; `message` says how to get
 * it. */
bool mujoco_open(struct mujoco *m, spatial_message *message);

#endif
