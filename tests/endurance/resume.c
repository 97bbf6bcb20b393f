/* resume GUID LOCATION INPUTS REALS STEPS EVERY FILE: steps whose inputs follow from their number. EVERY so
 * many the state goes to FILE, which is never half a state: it is written beside and renamed.
 *
 * Where FILE is there, another process has come that far, and this one goes on. Prints "from K", all Reals
 * after the last step and what was seen in every step since the first. */
#include "counting_host.h"

#define H 1e-3

typedef struct {
    uint64_t step, seen, size;
} Head;

static void write_state(fmi2Component c, const char *path, uint64_t step, uint64_t seen)
{
    char beside[4096];
    snprintf(beside, sizeof beside, "%s.part", path);
    size_t size;
    char *saved = serialised(c, &size);
    Head head = {step, seen, size};
    FILE *file = fopen(beside, "wb");
    if (!file || fwrite(&head, sizeof head, 1, file) != 1 || fwrite(saved, size, 1, file) != 1 ||
        fclose(file) != 0 || rename(beside, path) != 0)
        exit(5);
    free(saved);
}

static Head read_state(fmi2Component c, const char *path)
{
    Head head = {0};
    FILE *file = fopen(path, "rb");
    if (!file)
        return head;
    char *saved = NULL;
    if (fread(&head, sizeof head, 1, file) != 1 ||
        fread(saved = room(head.size, 1), head.size, 1, file) != 1 || fgetc(file) != EOF)
        exit(6);
    resume(c, saved, head.size);
    free(saved);
    fclose(file);
    return head;
}

int main(int argument_count, char **given)
{
    if (argument_count != 8)
        return 1;
    const unsigned int inputs = (unsigned int)atoi(given[3]), reals = (unsigned int)atoi(given[4]);
    const uint64_t steps = strtoul(given[5], NULL, 10), every = strtoul(given[6], NULL, 10);
    double *values = room(reals, sizeof *values);
    fmi2ValueReference *references = room(reals, sizeof *references);
    for (unsigned int i = 0; i < reals; i++)
        references[i] = i;
    fmi2Component c = started(given[1], given[2]);
    Head head = read_state(c, given[7]);
    printf("from %llu\n", (unsigned long long)head.step);
    fflush(stdout);
    for (uint64_t k = head.step; k < steps; k++) {
        uint64_t random = k + 1;
        if (k % every == 0 && k != head.step)
            write_state(c, given[7], k, head.seen);
        for (unsigned int j = 0; j < inputs; j++)
            values[j] = ((double)drawn(&random) - 0x1p30) * 0x1p-30;
        must(fmi2SetReal(c, references, inputs, values), "fmi2SetReal");
        must(fmi2DoStep(c, (double)k * H, H, fmi2True), "fmi2DoStep");
        must(fmi2GetReal(c, references, reals, values), "fmi2GetReal");
        see(&head.seen, values, reals);
    }
    printf("reals");
    for (unsigned int i = 0; i < reals; i++)
        printf(" %a", values[i]);
    printf("\nseen %016llx\n", (unsigned long long)head.seen);
    fmi2FreeInstance(c);
    free(values);
    free(references);
    return 0;
}
