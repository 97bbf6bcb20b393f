/* memory GUID LOCATION INPUTS REALS ROUNDS STEPS: in each round an instance is made, stepped with all inputs
 * set, rates given and all Reals got, saved, serialised, set, reset, and freed.
 *
 * Prints what the process and the host gave out after a tenth of the rounds and after all of them, and how
 * often memory was asked for inside steps, sets and gets. */
#include "counting_host.h"

#define H 1e-3

int main(int argument_count, char **given)
{
    if (argument_count != 7)
        return 1;
    const unsigned int inputs = (unsigned int)atoi(given[3]), reals = (unsigned int)atoi(given[4]);
    const int rounds = atoi(given[5]), steps = atoi(given[6]);
    double *values = room(reals, sizeof *values);
    fmi2ValueReference *references = room(reals, sizeof *references);
    fmi2Integer *first = room(inputs, sizeof *first);
    for (unsigned int i = 0; i < reals; i++)
        references[i] = i;
    for (unsigned int i = 0; i < inputs; i++)
        first[i] = 1;
    long early = resident(), inside = 0, largest = 0, states = 0;
    for (int round = 0; round < rounds; round++) {
        fmi2Component c = started(given[1], given[2]);
        fmi2FMUstate state = NULL;
        for (int k = 0; k < steps; k++) {
            const long asked = calls;
            for (unsigned int j = 0; j < inputs; j++)
                values[j] = (double)(k % 7) - 3.0;
            must(fmi2SetReal(c, references, inputs, values), "fmi2SetReal");
            must(fmi2SetRealInputDerivatives(c, references, inputs, first, values),
                 "fmi2SetRealInputDerivatives");
            must(fmi2DoStep(c, (double)k * H, H, fmi2True), "fmi2DoStep");
            must(fmi2GetReal(c, references, reals, values), "fmi2GetReal");
            inside += calls - asked;
            if (k % 10 == 0) { /* into the memory of the state before */
                must(fmi2GetFMUstate(c, &state), "fmi2GetFMUstate");
                must(fmi2SetFMUstate(c, state), "fmi2SetFMUstate");
                size_t size;
                char *saved = serialised(c, &size);
                resume(c, saved, size);
                free(saved);
                states++;
            }
            largest = bytes > largest ? bytes : largest;
        }
        must(fmi2FreeFMUstate(c, &state), "fmi2FreeFMUstate");
        must(fmi2Reset(c), "fmi2Reset");
        fmi2FreeInstance(c);
        if (round == rounds / 10)
            early = resident();
    }
    printf("resident %ld\ninside %ld\nlargest %ld\nstates %ld\nleft %ld\n", resident() - early, inside,
           largest, states, blocks);
    free(values);
    free(references);
    free(first);
    return 0;
}
