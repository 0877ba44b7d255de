/* mujoco_model.h - a model of MuJoCo from text. */
#ifndef STANCE_TESTS_MUJOCO_MODEL_H
#define STANCE_TESTS_MUJOCO_MODEL_H

#include <mujoco/mujoco.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* NULL, with a line on standard error: it is none. */
static inline mjModel *mujoco_model(const char *xml)
{
    char message[400] = "no memory";
    const size_t length = strlen(xml);
    mjVFS *const files = malloc(sizeof *files); /* a few hundred kilobytes */
    mjModel *model = NULL;
    if (files) {
        mj_defaultVFS(files);
        if (mj_makeEmptyFileVFS(files, "model.xml", (int)length + 1) == 0) {
            memcpy(files->filedata[mj_findFileVFS(files, "model.xml")], xml, length + 1);
            model = mj_loadXML("model.xml", files, message, sizeof message);
        }
        mj_deleteVFS(files);
        free(files);
    }
    if (!model)
        fprintf(stderr, "MuJoCo: %s\n", message);
    return model;
}

#endif
