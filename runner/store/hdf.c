/* hdf.c - see hdf.h. */
#include "hdf.h"

#include "runner/base/message.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST_TEXT = 1 << 22 }; /* bytes of a text of fixed length */

hid_t hdf_type(enum store_kind kind)
{
    const hid_t types[] = {
        [KIND_uint8_t] = H5T_STD_U8LE,   [KIND_uint32_t] = H5T_STD_U32LE,
        [KIND_int32_t] = H5T_STD_I32LE,  [KIND_int64_t] = H5T_STD_I64LE,
        [KIND_uint64_t] = H5T_STD_U64LE, [KIND_double] = H5T_IEEE_F64LE,
    };
    return types[kind];
}

size_t hdf_size(enum store_kind kind)
{
    return kind == KIND_uint8_t ? 1 : kind == KIND_uint32_t || kind == KIND_int32_t ? 4 : 8;
}

void hdf_close_all(const hid_t *id, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (id[i] >= 0)
            H5Idec_ref(id[i]);
}

/* ---- errors ------------------------------------------------------------------------------- */

/* What HDF5 said when a call failed: the next call, be it a close, wipes HDF5's own memory. The
 * system's words ("No space left on device") are worth more than HDF5's, the first more than the
 * later ones. */
static struct {
    char text[120];
    bool system;
} reason;

static herr_t find_reason(unsigned n, const H5E_error2_t *error, void *unused)
{
    (void)n, (void)unused;
    const char *system = error->desc ? strstr(error->desc, "error message = '") : NULL;
    unsigned long long there, meant;
    if (error->desc &&
        sscanf(error->desc,
               "truncated file: eof = %llu, sblock->base_addr = %*u, stored_eof = %llu", &there,
               &meant) == 2) {
        snprintf(reason.text, sizeof reason.text,
                 "only %llu of its %llu bytes are there; copy it again, or compute it anew", there,
                 meant);
        reason.system = true;
    } else if (system && !reason.system) {
        system += strlen("error message = '");
        snprintf(reason.text, sizeof reason.text, "%.*s", (int)strcspn(system, "'"), system);
        reason.system = true;
    } else if (reason.text[0] == '\0' && error->desc) {
        snprintf(reason.text, sizeof reason.text, "%.*s", (int)strcspn(error->desc, "\n"),
                 error->desc);
    }
    return 0;
}

/* HDF5 calls this whenever one of its functions fails. */
static herr_t remember_reason(hid_t stack, void *unused)
{
    return H5Ewalk2(stack, H5E_WALK_UPWARD, find_reason, unused);
}

void hdf_remember(void)
{
    H5Eset_auto2(H5E_DEFAULT, remember_reason, NULL);
}

bool store_failed(stance_message *message, const char *file, const char *what)
{
    complain(message, "%.80s: cannot %s: %s", file, what,
             reason.text[0] ? reason.text : "unknown reason");
    reason.text[0] = '\0';
    reason.system = false;
    return false;
}

/* ---- files -------------------------------------------------------------------------------- */

hid_t hdf_open_to_read(const char *file, stance_message *message)
{
    struct stat information;
    const char *wrong = NULL, *suffix = strrchr(file, '.');
    hid_t id = -1;

    hdf_remember();
    if (stat(file, &information) != 0 || (S_ISREG(information.st_mode) && access(file, R_OK) != 0))
        wrong = strerror(errno);
    else if (!S_ISREG(information.st_mode))
        wrong = S_ISDIR(information.st_mode) ? strerror(EISDIR) : "not a file";
    else if (H5Fis_hdf5(file) <= 0)
        wrong = suffix && (!strcmp(suffix, ".yaml") || !strcmp(suffix, ".yml"))
                    ? "a scenario, not a results file; stance run makes one of it"
                : information.st_size == 0 ? "an empty file, not an HDF5 file"
                                           : "not an HDF5 file";
    if (wrong) {
        complain(message, "%.100s: %s", file, wrong);
        return -1;
    }
    const hid_t properties = H5Pcreate(H5P_FILE_ACCESS);
    if (H5Pset_fclose_degree(properties, H5F_CLOSE_STRONG) >= 0 &&
        H5Pset_file_locking(properties, false, true) >= 0)
        id = H5Fopen(file, H5F_ACC_RDONLY, properties);
    hdf_close(properties);
    if (id < 0)
        store_failed(message, file, "read the file");
    return id;
}

bool hdf_is_no(hid_t id, const char *file, const char *what, stance_message *message)
{
    if (hdf_whole(id, "search_version", 0) > 0)
        return complain(message,
                        "%.110s: of a search (stance optimise), not a results file: stance "
                        "summary, plot and status read it; running its -best.yaml gives one",
                        file);
    return complain(message, "%.120s: not %s", file, what);
}

bool hdf_exists(hid_t file, const char *path)
{
    char part[128];
    for (const char *slash = strchr(path, '/'); slash; slash = strchr(slash + 1, '/')) {
        snprintf(part, sizeof part, "%.*s", (int)(slash - path), path);
        if (H5Lexists(file, part, H5P_DEFAULT) <= 0)
            return false;
    }
    return H5Lexists(file, path, H5P_DEFAULT) > 0;
}

/* ---- attributes --------------------------------------------------------------------------- */

/* An attribute of one element; -1: there is none. */
static hid_t open_attribute(hid_t object, const char *name)
{
    if (H5Aexists(object, name) <= 0)
        return -1;
    hid_t attribute = H5Aopen(object, name, H5P_DEFAULT), space = H5Aget_space(attribute);
    const bool one = H5Sget_simple_extent_npoints(space) == 1;
    hdf_close(space, one ? -1 : attribute);
    return one ? attribute : -1;
}

char *hdf_text(hid_t object, const char *name)
{
    hid_t attribute = open_attribute(object, name);
    char **words = attribute < 0 ? NULL : hdf_words(attribute, 0, 1);
    char *text = words ? words[0] : NULL;
    free(words);
    hdf_close(attribute);
    return text;
}

bool hdf_number(hid_t object, const char *name, hid_t type, void *value)
{
    hid_t attribute = open_attribute(object, name);
    const bool good = attribute >= 0 && H5Aread(attribute, type, value) >= 0;
    hdf_close(attribute);
    return good;
}

int hdf_whole(hid_t object, const char *name, int fallback)
{
    int value;
    return hdf_number(object, name, H5T_NATIVE_INT, &value) && value > 0 ? value : fallback;
}

/* ---- elements ----------------------------------------------------------------------------- */

hid_t hdf_type_of(hid_t object)
{
    return H5Iget_type(object) == H5I_ATTR ? H5Aget_type(object) : H5Dget_type(object);
}

int hdf_shape(hid_t object, hsize_t length[H5S_MAX_RANK])
{
    const bool attribute = H5Iget_type(object) == H5I_ATTR;
    hid_t space = attribute ? H5Aget_space(object) : H5Dget_space(object);
    const int rank = space < 0 ? -1 : H5Sget_simple_extent_dims(space, length, NULL);
    hdf_close(space);
    return rank;
}

size_t hdf_elements(hid_t dataset)
{
    hid_t space = H5Dget_space(dataset), type = H5Dget_type(dataset);
    hid_t file = H5Iget_file_id(dataset);
    hsize_t size = 0;
    hssize_t points = space < 0 ? -1 : H5Sget_simple_extent_npoints(space);
    const size_t width = type < 0 ? 0 : H5Tget_size(type);
    bool good = file >= 0 && H5Fget_filesize(file, &size) >= 0 && points > 0 && width > 0 &&
                (hsize_t)points <= size / width;
    hdf_close(space, type, file);
    return good ? (size_t)points : 0;
}

bool hdf_read(hid_t dataset, enum store_kind kind, void *data)
{
    return H5Dread(dataset, hdf_type(kind), H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0;
}

/* Adds to a selection the flat, row-major range [first, last) below dimension `level` of a grid: a
 * part of a row, whole rows, and a part of a row again, each a hyperslab at its level. start[] is
 * fixed above `level`. */
static bool select_range(hid_t space, int rank, const hsize_t *length, int level, hsize_t *start,
                         hsize_t first, hsize_t last)
{
    hsize_t inner = 1, count[H5S_MAX_RANK];
    for (int d = level + 1; d < rank; d++)
        inner *= length[d];
    hsize_t whole = (first + inner - 1) / inner, end = last / inner;
    if (whole > end) { /* within one row */
        start[level] = end;
        return select_range(space, rank, length, level + 1, start, first - end * inner,
                            last - end * inner);
    }
    if (first < whole * inner) {
        start[level] = whole - 1;
        if (!select_range(space, rank, length, level + 1, start, first - (whole - 1) * inner,
                          inner))
            return false;
    }
    if (whole < end) {
        start[level] = whole;
        for (int d = 0; d < rank; d++) {
            count[d] = d < level ? 1 : d == level ? end - whole : length[d];
            start[d] = d <= level ? start[d] : 0;
        }
        if (H5Sselect_hyperslab(space, H5S_SELECT_OR, start, NULL, count, NULL) < 0)
            return false;
    }
    if (end * inner < last) {
        start[level] = end;
        return select_range(space, rank, length, level + 1, start, 0, last - end * inner);
    }
    return true;
}

/* Selects `width` elements of each row of a list, one by one. */
static bool select_list(hid_t space, int rank, const hsize_t *length, size_t width,
                        const struct rows *rows)
{
    const size_t elements = (size_t)rows->count * width;
    hsize_t *place = malloc(elements * (size_t)rank * sizeof *place), *at = place;
    for (size_t i = 0; place && i < elements; i++, at += rank) {
        uint64_t rest = rows_at(rows, i / width) * width + i % width;
        for (int d = rank - 1; d >= 0; d--) {
            at[d] = rest % length[d];
            rest /= length[d];
        }
    }
    bool good = place && H5Sselect_elements(space, H5S_SELECT_SET, elements, place) >= 0;
    free(place);
    return good;
}

bool hdf_move_rows(hid_t dataset, hid_t type, size_t width, const struct rows *rows,
                   enum hdf_direction way, void *data)
{
    hsize_t length[H5S_MAX_RANK], start[H5S_MAX_RANK] = {0};
    const uint64_t first = rows_at(rows, 0), last = rows_at(rows, rows->count - 1);
    const hsize_t n = rows->count * width, end = (last + 1) * width;
    hid_t space = H5Dget_space(dataset), memory = H5Screate_simple(1, &n, NULL);
    const int rank = H5Sget_simple_extent_dims(space, length, NULL);
    bool good = memory >= 0 && rank >= 0 && H5Sget_simple_extent_npoints(space) >= (hssize_t)end;
    if (good && rank > 0) {
        good = last - first + 1 == rows->count
                   ? H5Sselect_none(space) >= 0 &&
                         select_range(space, rank, length, 0, start, first * width, end)
                   : select_list(space, rank, length, width, rows);
    }
    good =
        good && (way == HDF_WRITE ? H5Dwrite(dataset, type, memory, space, H5P_DEFAULT, data)
                                  : H5Dread(dataset, type, memory, space, H5P_DEFAULT, data)) >= 0;
    hdf_close(space, memory);
    return good;
}

bool hdf_move(hid_t object, hid_t type, hsize_t at, hsize_t n, enum hdf_direction way, void *data)
{
    return H5Iget_type(object) == H5I_ATTR
               ? H5Aread(object, type, data) >= 0
               : hdf_move_rows(object, type, 1, &(struct rows){.first = at, .count = n}, way, data);
}

char **hdf_words(hid_t object, hsize_t at, size_t n)
{
    hid_t type = hdf_type_of(object);
    const bool text = type >= 0 && H5Tget_class(type) == H5T_STRING;
    const bool variable = text && H5Tis_variable_str(type) > 0;
    const size_t size = variable ? sizeof(char *) : text ? H5Tget_size(type) : 0;
    char *raw = size > 0 && size <= MOST_TEXT ? calloc(n + 1, size + 1) : NULL;
    char **words = raw ? calloc(n + 1, sizeof *words) : NULL;
    bool good = words && hdf_move(object, type, at, n, HDF_READ, raw);

    for (size_t i = 0; words && i < n; i++) {
        char *found = raw + i * size;
        if (variable)
            memcpy(&found, raw + i * size, sizeof found);
        words[i] = !good ? NULL : variable ? strdup(found ? found : "") : strndup(found, size);
        if (variable)
            H5free_memory(found);
    }
    for (size_t i = 0; good && i < n; i++)
        good = words[i] != NULL;
    if (!good) {
        hdf_free_words(words, n);
        words = NULL;
    }
    free(raw);
    hdf_close(type);
    return words;
}

void hdf_free_words(char **words, size_t n)
{
    for (size_t i = 0; words && i < n; i++)
        free(words[i]);
    free(words);
}
