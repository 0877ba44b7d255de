/* build_info.h - what this program was built from: revision, compiler, flags, libraries. */
#ifndef STANCE_STORE_BUILD_INFO_H
#define STANCE_STORE_BUILD_INFO_H

enum { BUILD_LIBRARIES_SIZE = 256 };

extern const char build_revision[], /* of git, with "-dirty" when the tree was changed */
    build_compiler[], build_flags[];

/* Versions of the libraries in use, as "HDF5 1.10.8, Open MPI 4.1.4, ...". */
void build_libraries(char text[BUILD_LIBRARIES_SIZE]);

#endif
