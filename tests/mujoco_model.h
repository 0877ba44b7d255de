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

/* What differs between models of the biped; NULL: nothing. */
struct mujoco_biped {
    const double *robot; /* leg, trunk, foot's, trunk's and hip's mass */
    double gravity, step, friction;
    const char *option, *flag, *contact, *actuator; /* of <option>, in it, of <geom>s, at the end */
    const char *joint[2];                           /* of each hip's */
    double point;                                   /* kg m^2 of a foot, which is a point mass */
    int feet[2];                                    /* 1: may touch the ground */
};
static const double mujoco_radius = 1e-4; /* m, of the spheres at the feet */

/* Hinges, trunk and hip one rigid body with its exact centre and inertia, feet as spheres above a
 * ground that lies as much lower. +theta turns x towards z: about -y. */
static inline mjModel *mujoco_biped(const struct mujoco_biped *b)
{
    const double l = b->robot[0], lt = b->robot[1], mt = b->robot[3], mh = b->robot[4];
    const double inertia = mt * mh / (mt + mh) * lt * lt;
    char xml[4096], leg[2][700];
    for (int i = 0; i < 2; i++)
        snprintf(leg[i], sizeof leg[i],
                 "<body pos='0 0 %.17g'><joint name='q%d' type='hinge' axis='0 -1 0' %s/>"
                 "<inertial pos='0 0 %.17g' mass='%.17g' diaginertia='%g %g %g'/>"
                 "<geom type='sphere' size='%.17g' pos='0 0 %.17g' contype='%d' conaffinity='%d'/>"
                 "</body>",
                 -lt, i + 1, b->joint[i] ? b->joint[i] : "", -l, b->robot[2], b->point, b->point,
                 b->point, mujoco_radius, -l, b->feet[i], b->feet[i]);
    const int length = snprintf(
        xml, sizeof xml,
        "<mujoco><compiler angle='radian' inertiafromgeom='false'/>"
        "<option timestep='%.17g' gravity='0 0 %.17g' %s>%s</option>"
        "<default><geom friction='%.17g 0.005 0.0001' %s/></default>"
        "<worldbody><geom type='plane' size='0 0 1' pos='0 0 %.17g' contype='1' conaffinity='1'/>"
        "<body><joint type='slide' axis='1 0 0'/><joint type='slide' axis='0 0 1'/>"
        "<joint type='hinge' axis='0 -1 0'/>"
        "<inertial pos='0 0 %.17g' mass='%.17g' diaginertia='%.17g %.17g 1e-9'/>%s%s</body>"
        "</worldbody>%s</mujoco>",
        b->step, -b->gravity, b->option ? b->option : "", b->flag ? b->flag : "", b->friction,
        b->contact ? b->contact : "", -mujoco_radius, -lt * mh / (mt + mh), mt + mh, inertia,
        inertia, leg[0], leg[1], b->actuator ? b->actuator : "");
    return length > 0 && (size_t)length < sizeof xml ? mujoco_model(xml) : NULL;
}

#endif
