/* Fuzz target of the resource reader: whatever the files hold, the model is refused with a reason in one line
 * or is what a model must be, and nothing leaks.
 *
 * An input is a byte of switches, a byte for the allocation that fails, then for each of `names` its size
 * in two bytes, the lower one first, and its content; where the input ends, the files left are missing. */
#include "counting_memory.h"
#include "memory_files.h"
#include "sha256.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define FILES 11
#define MODEL 1    /* model.json */
#define CHECKSUM 2 /* model.sha256 */
#define FIRST_ARRAY 3
#define MEND_CHECKSUMS 1 /* so that damaged files get past them */
#define FAIL_ALLOCATION 2

static const char *const names[FILES] = {"guid.txt",      "model/model.json", "model/model.sha256",
                                         "model/lam.npy", "model/D_rest.npy", "model/B.npy",
                                         "model/C.npy",   "model/R.npy",      "model/R_in.npy",
                                         "model/M_s.npy", "model/K_s.npy"};

static void must(bool truth)
{
    if (!truth)
        abort();
}

/* The k-th checksum in model.json becomes that of the k-th array. */
static void mend_checksums(unsigned char *header, size_t size, const MemoryFile *arrays, size_t count)
{
    static const char mark[] = "\"sha256\": \"";
    size_t length = sizeof mark - 1, found = 0;
    for (size_t k = 0; k + length + SHA256_SIZE - 1 <= size && found < count; k++)
        if (memcmp(header + k, mark, length) == 0) {
            char digest[SHA256_SIZE];
            sha256(arrays[found].bytes, arrays[found].size, digest);
            memcpy(header + k + length, digest, SHA256_SIZE - 1);
            found++;
        }
}

static void check_symmetric(const double *A, size_t n)
{
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            must(isfinite(A[i * n + j]) && A[i * n + j] == A[j * n + i]);
}

static void check_finite(const double *values, size_t count)
{
    for (size_t k = 0; k < count; k++)
        must(isfinite(values[k]));
}

/* The law belongs to the name; gives its rows. */
static size_t check_law(const char *name, Law law)
{
    static const struct {
        const char *part;
        Law law;
        size_t rows;
    } laws[] = {{".displacement.", POSITION, 1},    {".rotation.", POSITION, 1},  {"velocity.", VELOCITY, 1},
                {"acceleration.", ACCELERATION, 1}, {".reaction", REACTION, 3},   {".stress.mises", MISES, 6},
                {"energy.kinetic", KINETIC, 0},     {"energy.strain", STRAIN, 0}, {".stress.", POSITION, 1}};
    for (size_t k = 0; k < sizeof laws / sizeof *laws; k++)
        if (strstr(name, laws[k].part)) {
            must(law == laws[k].law);
            return laws[k].rows;
        }
    must(false);
    return 0;
}

static bool has_port(const char *name, const char *port)
{
    return strncmp(name, port, strlen(port)) == 0 && name[strlen(port)] == '.';
}

static void check_model(const ReducedModel *model)
{
    size_t rows = 0;
    must(model->r > 0 && model->k + model->r == model->n && model->m + model->p > 0);
    must(strlen(model->name) > 0);
    must(model->alpha >= 0.0 && isfinite(model->alpha) && model->beta >= 0.0 && isfinite(model->beta));
    must(model->lam[0] >= 0.0 && !(model->initial_static && model->lam[model->k] == 0.0));
    for (size_t i = 0; i < model->n; i++) {
        must(isfinite(model->lam[i]) && (i == 0 || model->lam[i] >= model->lam[i - 1]));
        must(model->D_rest[i * model->n + i] >= 0.0);
    }
    for (size_t i = 0; i < model->k; i++) {
        must(model->lam[i] == 0.0 && model->motions[i] < model->m);
        must(strstr(model->inputs[model->motions[i]], "motion.") != NULL);
        for (size_t j = 0; j < model->m; j++)
            must(model->B[i * model->m + j] == (j == model->motions[i]));
    }
    for (size_t j = 0; j < model->m; j++) {
        const char *name = model->inputs[j];
        must(!has_port(name, "energy"));
        must(has_port(name, "gravity") || has_port(name, "base") == !!strstr(name, ".acceleration."));
    }
    for (size_t k = 0; k < model->p; k++) {
        must(!has_port(model->outputs[k], "gravity") && !has_port(model->outputs[k], "base"));
        must(has_port(model->outputs[k], "energy") == (model->laws[k] >= KINETIC));
        rows += check_law(model->outputs[k], model->laws[k]);
    }
    must(rows == model->s);
    check_symmetric(model->D_rest, model->n);
    check_symmetric(model->R_in, model->m);
    check_symmetric(model->M_s, model->k);
    check_symmetric(model->K_s, model->k);
    check_finite(model->B, model->n * model->m);
    check_finite(model->C, model->s * model->n);
    check_finite(model->R, model->s * model->m);
}

static void check_reason(const Reason *reason)
{
    size_t length = strlen(reason->text);
    must(length > 0 && length < sizeof reason->text && strcspn(reason->text, "\r\n") == length);
}

/* Takes the files of the input apart; returns how many there are. */
static size_t split_input(const unsigned char *data, size_t size, MemoryFile *files)
{
    size_t count = 0;
    for (; count < FILES && size >= 2; count++) {
        size_t length = (size_t)(data[0] | data[1] << 8);
        length = length < size - 2 ? length : size - 2;
        files[count] = (MemoryFile){names[count], data + 2, length};
        data += 2 + length;
        size -= 2 + length;
    }
    return count;
}

static void read_both(const MemoryFiles *all)
{
    Files files = files_in_memory(all);
    Reason reason = {""};
    char guid[GUID_SIZE];
    if (read_guid(&files, &counting_memory, guid, &reason))
        must(strlen(guid) > 0);
    else
        check_reason(&reason);
    reason.text[0] = 0;
    const ReducedModel *model = read_model(&files, &counting_memory, &reason);
    if (model) {
        check_model(model);
        free_model(model, &counting_memory);
    } else {
        check_reason(&reason);
    }
    must(blocks_out() == 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    MemoryFile files[FILES];
    if (size < 2)
        return 0;
    size_t count = split_input(data + 2, size - 2, files);
    unsigned char *header = NULL, line[SHA256_SIZE];
    if (count > CHECKSUM && data[0] & MEND_CHECKSUMS) {
        header = malloc(files[MODEL].size + 1);
        must(header != NULL);
        memcpy(header, files[MODEL].bytes, files[MODEL].size);
        mend_checksums(header, files[MODEL].size, files + FIRST_ARRAY, count - FIRST_ARRAY);
        files[MODEL].bytes = header;
        sha256(header, files[MODEL].size, (char *)line);
        line[SHA256_SIZE - 1] = '\n';
        files[CHECKSUM] = (MemoryFile){names[CHECKSUM], line, sizeof line};
    }
    allow_allocations(data[0] & FAIL_ALLOCATION ? data[1] % 16u : SIZE_MAX);
    read_both(&(MemoryFiles){files, count});
    free(header);
    return 0;
}
