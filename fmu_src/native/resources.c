#include "resources.h"

#include "header.h"
#include "npy.h"
#include "sha256.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#define HEADER_LIMIT ((size_t)1 << 24) /* bytes of model.json: some hundred thousand ports */
#define ARRAY_COUNT 8

/* One array: its key in model.json, its shape, and where the model has it. */
typedef struct {
    const char *key;
    int dimensions;
    size_t shape[2];
    const double **values;
} Array;

static bool has_shape(const Json *entry, const Array *array, Reason *reason)
{
    const Json *shape = expected_member(entry, "shape", JSON_LIST, reason);
    if (!shape)
        return false;
    bool fits = shape->size == (size_t)array->dimensions;
    for (size_t k = 0; k < shape->size && fits; k++)
        fits = shape[k + 1].kind == JSON_NUMBER && shape[k + 1].number == (double)array->shape[k];
    return fits || refuse(reason, HEADER ": %s: expected the shape %zu x %zu of the modes and ports; " AGAIN,
                          array->key, array->shape[0], array->shape[1]);
}

static bool has_checksum(const Json *entry, const char *file, const Bytes *content, Reason *reason)
{
    const Json *expected = expected_member(entry, "sha256", JSON_TEXT, reason);
    char found[SHA256_SIZE];
    if (!expected)
        return false;
    sha256(content->bytes, content->size, found);
    return json_text_is(expected, found) ||
           refuse(reason, "%s: its checksum is not that of model.json; " AGAIN, file);
}

/* The content of an array's file as numbers, once everything about it is checked. */
static bool unpack_array(const Json *entry, const char *file, Array *array, const Bytes *content,
                         Reason *reason)
{
    size_t count = array->shape[0] * array->shape[1];
    if (!has_checksum(entry, file, content, reason))
        return false;
    const double *values = unpack_npy(content, array->dimensions, array->shape);
    if (!values)
        return refuse(reason, "%s: got %zu bytes, expected %zu x %zu float64 numbers; " AGAIN, file,
                      content->size, array->shape[0], array->shape[1]);
    for (size_t i = 0; i < count; i++)
        if (!isfinite(values[i]))
            return refuse(reason, "%s: got %g, expected finite numbers; " AGAIN, file, values[i]);
    *array->values = values;
    return true;
}

/* One array's entry in model.json and its file. */
static bool read_array(const Json *arrays, Array *array, const Files *files, const Memory *memory,
                       Reason *reason)
{
    const Json *entry = expected_member(arrays, array->key, JSON_OBJECT, reason);
    if (!entry || !has_shape(entry, array, reason))
        return false;
    uint64_t size = (uint64_t)array->shape[0] * array->shape[1] * sizeof(double); /* n <= 2^28; m, s < 2^27 */
    if (size > ARRAY_LIMIT)
        return refuse(reason, HEADER ": %s: got the shape %zu x %zu, expected at most %zu bytes; " AGAIN,
                      array->key, array->shape[0], array->shape[1], ARRAY_LIMIT);
    char file[32] = "model/";
    strcat(strcat(file, array->key), ".npy");
    Bytes content = {NULL, 0};
    size_t limit = (size_t)size + NPY_HEADER_LIMIT;
    if (!files->read(files->context, file, limit, memory, &content, reason))
        return false;
    if (unpack_array(entry, file, array, &content, reason))
        return true;
    memory->release(content.bytes);
    return false;
}

static bool is_symmetric(const double *A, size_t n)
{
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < i; j++)
            if (A[i * n + j] != A[j * n + i])
                return false;
    return true;
}

/* A matrix that is symmetric with a diagonal >= 0. */
static bool check_form(const char *key, const double *A, size_t n, Reason *reason)
{
    for (size_t i = 0; i < n; i++)
        if (A[i * n + i] < 0.0)
            return refuse(reason, "model/%s.npy: expected a diagonal >= 0; " AGAIN, key);
    return is_symmetric(A, n) || refuse(reason, "model/%s.npy: expected a symmetric matrix; " AGAIN, key);
}

/* What the rows and columns of prescribed motions hold. */
static bool check_motions(const ReducedModel *model, Reason *reason)
{
    size_t k = model->k, n = model->n;
    for (size_t i = 0; i < k; i++) {
        if (model->lam[i] != 0.0)
            return refuse(reason, "model/lam.npy: expected 0 for the %zu prescribed motions; " AGAIN, k);
        for (size_t j = 0; j < model->m; j++)
            if (model->B[i * model->m + j] != (j == model->motions[i] ? 1.0 : 0.0))
                return refuse(reason,
                              "model/B.npy: expected in row %zu 1 for its own acceleration, else 0; " AGAIN,
                              i + 1);
    }
    const double *row = model->C;
    for (size_t output = 0; output < model->p; row += law_rows(model->laws[output++]) * n)
        for (size_t j = k; model->laws[output] == REACTION && j < n; j++)
            if (row[2 * n + j] != 0.0)
                return refuse(reason,
                              "model/C.npy: expected 0 for modes in the third row of a reaction; " AGAIN);
    return true;
}

/* 0 <= lambda ascending; lambda > 0 of the modes for a static start; matrices as they are described. */
static bool check_values(const ReducedModel *model, Reason *reason)
{
    const double *lam = model->lam;
    for (size_t i = 0; i < model->n; i++)
        if (lam[i] < (i > 0 ? lam[i - 1] : 0.0))
            return refuse(reason, "model/lam.npy: expected eigenvalues >= 0 in ascending order; " AGAIN);
    if (!check_form("D_rest", model->D_rest, model->n, reason) ||
        !check_form("M_s", model->M_s, model->k, reason) ||
        !check_form("K_s", model->K_s, model->k, reason) || !check_motions(model, reason))
        return false;
    if (!is_symmetric(model->R_in, model->m))
        return refuse(reason, "model/R_in.npy: expected a symmetric matrix; " AGAIN);
    return !(model->initial_static && model->r > 0 && lam[model->k] == 0.0) ||
           refuse(reason, HEADER ": got a static start with a rigid mode, expected lam > 0; " AGAIN);
}

static bool read_arrays(const Json *header, ReducedModel *model, const Files *files, const Memory *memory,
                        Reason *reason)
{
    size_t n = model->n, m = model->m, s = model->s, k = model->k;
    Array arrays[ARRAY_COUNT] = {
        {"lam", 1, {n, 1}, &model->lam}, {"D_rest", 2, {n, n}, &model->D_rest},
        {"B", 2, {n, m}, &model->B},     {"C", 2, {s, n}, &model->C},
        {"R", 2, {s, m}, &model->R},     {"R_in", 2, {m, m}, &model->R_in},
        {"M_s", 2, {k, k}, &model->M_s}, {"K_s", 2, {k, k}, &model->K_s},
    };
    for (size_t i = 0; i < ARRAY_COUNT; i++)
        if (!read_array(json_member(header, "arrays"), &arrays[i], files, memory, reason))
            return false;
    return check_values(model, reason);
}

/* Whether model.sha256 is the checksum of the text of model.json and a newline. */
static bool is_as_written(const Bytes *text, const Files *files, const Memory *memory, Reason *reason)
{
    Bytes line = {NULL, 0};
    char expected[SHA256_SIZE];
    if (!files->read(files->context, HEADER_CHECKSUM, sizeof expected, memory, &line, reason))
        return false;
    sha256(text->bytes, text->size, expected);
    expected[SHA256_SIZE - 1] = '\n';
    bool same = line.size == sizeof expected && memcmp(line.bytes, expected, sizeof expected) == 0;
    memory->release(line.bytes);
    return same || refuse(reason, HEADER ": its checksum is not that of model.sha256; " AGAIN);
}

const ReducedModel *read_model(const Files *files, const Memory *memory, Reason *reason)
{
    Bytes text = {NULL, 0};
    if (!files->read(files->context, HEADER, HEADER_LIMIT, memory, &text, reason))
        return NULL;
    const Json *header = NULL;
    ReducedModel *model = NULL;
    if (is_as_written(&text, files, memory, reason))
        header = parse_json(HEADER, text.bytes, text.size, memory, reason);
    if (header) {
        model = described_model(header, memory, reason);
        if (model && !read_arrays(header, model, files, memory, reason)) {
            free_model(model, memory);
            model = NULL;
        }
        memory->release((void *)header);
    }
    memory->release(text.bytes);
    return model;
}

void free_model(const ReducedModel *model, const Memory *memory)
{
    const double *const arrays[ARRAY_COUNT] = {model->lam, model->D_rest, model->B,   model->C,
                                               model->R,   model->R_in,   model->M_s, model->K_s};
    for (size_t k = 0; k < ARRAY_COUNT; k++)
        if (arrays[k])
            memory->release((void *)arrays[k]);
    memory->release((void *)model);
}

bool read_guid(const Files *files, const Memory *memory, char guid[GUID_SIZE], Reason *reason)
{
    Bytes line = {NULL, 0};
    if (!files->read(files->context, "guid.txt", GUID_SIZE + 1, memory, &line, reason))
        return false;
    size_t size = line.size;
    if (size > 0 && line.bytes[size - 1] == '\n')
        size--;
    if (size > 0 && line.bytes[size - 1] == '\r')
        size--;
    bool fits = size > 0 && size < GUID_SIZE;
    for (size_t k = 0; k < size && fits; k++) {
        fits = line.bytes[k] > ' ' && line.bytes[k] < 0x7F;
        guid[k] = (char)line.bytes[k];
    }
    guid[fits ? size : 0] = 0;
    memory->release(line.bytes);
    return fits ||
           refuse(reason, "guid.txt: expected one line of at most %d characters; " AGAIN, GUID_SIZE - 1);
}
