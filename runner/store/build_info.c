/* build_info.c - the Makefile hands over revision, compiler and flags as macros. */
#include "build_info.h"

#include "runner/ranks/parallel.h"

#include <gnu/libc-version.h>
#include <hdf5.h>
#include <jansson.h>
#include <stdio.h>
#include <sundials/sundials_version.h>
#include <yaml.h>

#ifndef STANCE_REVISION
#define STANCE_REVISION "unknown"
#endif
#ifndef STANCE_COMPILER
#define STANCE_COMPILER "unknown compiler"
#endif
#ifndef STANCE_CFLAGS
#define STANCE_CFLAGS "unknown flags"
#endif

/* LAPACK's own version query, a Fortran routine. */
extern void ilaver_(int *major, int *minor, int *patch);

const char build_revision[] = STANCE_REVISION, build_compiler[] = STANCE_COMPILER,
           build_flags[] = STANCE_CFLAGS;

void build_libraries(char text[BUILD_LIBRARIES_SIZE])
{
    char mpi[64], sundials[32] = "?";
    unsigned hdf5[3] = {0};
    int major = 0, minor = 0, patch = 0;

    parallel_library(mpi, sizeof mpi);
    H5get_libversion(&hdf5[0], &hdf5[1], &hdf5[2]);
    ilaver_(&major, &minor, &patch);
    (void)SUNDIALSGetVersion(sundials, sizeof sundials);
    snprintf(text, BUILD_LIBRARIES_SIZE,
             "HDF5 %u.%u.%u, %s, libyaml %s, jansson %s, LAPACK %d.%d.%d, SUNDIALS %s, glibc %s",
             hdf5[0], hdf5[1], hdf5[2], mpi, yaml_get_version_string(), JANSSON_VERSION, major,
             minor, patch, sundials, gnu_get_libc_version());
}
