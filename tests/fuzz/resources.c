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

#define FILES 7
#define MODEL 1    /* model.json */
#define CHECKSUM 2 /* model.sha256 */
#define FIRST_ARRAY 3
#define MEND_CHECKSUMS 1 /* so that damaged files get past them */
#define FAIL_ALLOCATION 2

static const char *const names[FILES] = {"guid.txt",      "model/model.json", "model/model.sha256",
                                         "model/lam.npy", "model/D_rest.npy", "model/B.npy",
                                         "model/C.npy"};

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

static void check_model(const ReducedModel *model)
{
    must(model->r > 0 && model->m + model->p > 0 && strlen(model->name) > 0);
    must(model->alpha >= 0.0 && isfinite(model->alpha) && model->beta >= 0.0 && isfinite(model->beta));
    must(model->lam[0] >= 0.0 && !(model->initial_static && model->lam[0] == 0.0));
    for (size_t i = 0; i < model->r; i++) {
        must(isfinite(model->lam[i]) && (i == 0 || model->lam[i] >= model->lam[i - 1]));
        for (size_t j = 0; j < model->r; j++)
            must(i == j ? model->D_rest[i * model->r + j] >= 0.0 : model->D_rest[i * model->r + j] == 0.0);
    }
    for (size_t k = 0; k < model->r * model->m; k++)
        must(isfinite(model->B[k]));
    for (size_t k = 0; k < model->p * model->r; k++)
        must(isfinite(model->C[k]));
    for (size_t j = 0; j < model->m; j++)
        must(strstr(model->inputs[j], ".force.") != NULL);
    for (size_t i = 0; i < model->p; i++) {
        static const char *const kinds[] = {".displacement.", ".velocity.", ".acceleration."};
        must(strstr(model->outputs[i], kinds[model->output_kinds[i]]) != NULL);
    }
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
