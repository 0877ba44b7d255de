/* probe.c - lets a child process read a file's structure first.
 *
 * HDF5 1.10 reports most damage, but some damaged headers and string heaps make it run past its
 * own buffers. A user's command is to end with a message even then: the child walks through all
 * objects, attributes and strings, which are all that the library interprets, and when it dies the
 * parent says so. Numbers are not read: they cannot do harm.
 */
#include "probe.h"

#include <errno.h>
#include <fcntl.h>
#include <hdf5.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MOST_STRINGS = 1 << 20, LONGEST_STRING = 1 << 22 };

/* Reads `count` strings of a dataset or attribute, and forgets them. */
static void read_strings(hid_t object, bool attribute, hid_t type, hssize_t count)
{
    bool variable = H5Tis_variable_str(type) > 0;
    size_t size = variable ? sizeof(char *) : H5Tget_size(type);
    if (count < 1 || count > MOST_STRINGS ||
        size > LONGEST_STRING / (size_t)count + sizeof(char *)) {
        return;
    }
    char *buffer = calloc((size_t)count, size);
    if (!buffer) {
        return;
    }
    herr_t status = attribute ? H5Aread(object, type, buffer)
                              : H5Dread(object, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer);
    for (hssize_t i = 0; variable && status >= 0 && i < count; i++) {
        char *text;
        memcpy(&text, buffer + (size_t)i * size, sizeof text);
        H5free_memory(text);
    }
    free(buffer);
}

static herr_t visit_attribute(hid_t object, const char *name, const H5A_info_t *info, void *nothing)
{
    (void)info, (void)nothing;
    hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
    hid_t type = H5Aget_type(attribute), space = H5Aget_space(attribute);
    if (type >= 0 && H5Tget_class(type) == H5T_STRING) {
        read_strings(attribute, true, type, H5Sget_simple_extent_npoints(space));
    }
    H5Sclose(space);
    H5Tclose(type);
    H5Aclose(attribute);
    return 0;
}

static herr_t visit_link(hid_t file, const char *name, const H5L_info_t *link, void *nothing)
{
    (void)link;
    hid_t object = H5Oopen(file, name, H5P_DEFAULT);
    if (object < 0) {
        return 0;
    }
    H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, NULL, visit_attribute, nothing);
    if (H5Iget_type(object) == H5I_DATASET) {
        hid_t type = H5Dget_type(object), space = H5Dget_space(object);
        if (type >= 0 && H5Tget_class(type) == H5T_STRING) {
            read_strings(object, false, type, H5Sget_simple_extent_npoints(space));
        }
        H5Sclose(space);
        H5Tclose(type);
    }
    H5Oclose(object);
    return 0;
}

/* Nobody is to hear a child die. */
static void silence(void)
{
    const struct rlimit none = {0, 0};
    int sink = open("/dev/null", O_WRONLY);
    setrlimit(RLIMIT_CORE, &none);
    if (sink >= 0) {
        dup2(sink, STDOUT_FILENO);
        dup2(sink, STDERR_FILENO);
    }
}

/* What it meets does not matter, only that it comes to its end. */
static void walk(const char *file)
{
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
    H5Pset_file_locking(access, false, true);
    hid_t id = H5Fopen(file, H5F_ACC_RDONLY, access);
    if (id >= 0) {
        H5Aiterate2(id, H5_INDEX_NAME, H5_ITER_INC, NULL, visit_attribute, NULL);
        H5Lvisit(id, H5_INDEX_NAME, H5_ITER_INC, visit_link, NULL);
        H5Fclose(id);
    }
    H5Pclose(access);
}

bool probe_file(const char *file, void (*attempt)(void *context), void *context,
                stance_message *message)
{
    int status = 0;
    pid_t child = fork();
    if (child == 0) {
        silence();
        attempt(context);
        walk(file);
        _exit(0);
    }
    if (child < 0) {
        snprintf(message->text, sizeof message->text, "%.100s: cannot be examined: %s", file,
                 strerror(errno));
        return false;
    }
    while (waitpid(child, &status, 0) < 0) {
        if (errno != EINTR) {
            return true;
        }
    }
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) {
        return true;
    }
    snprintf(message->text, sizeof message->text,
             "%.100s: damaged: its structure cannot be read without harm", file);
    return false;
}
