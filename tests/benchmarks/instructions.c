/* instructions MODES INPUTS OUTPUTS BATCHES: B u, the update and C q by each set of instructions, ns a cycle.
 */
#include "host.h"

#include "kernels.c" /* its tables are private to it */

#define CYCLES 20

static double *numbers(size_t count)
{
    double *x = lines_of_memory(count, sizeof *x);
    for (size_t k = 0; k < count; k++)
        x[k] = (double)(k % 97) / 97.0 - 0.5;
    return x;
}

int main(int count, char **given)
{
    if (count != 5)
        return 1;
    const size_t n = (strtoul(given[1], NULL, 10) + LANES - 1) / LANES * LANES,
                 m = strtoul(given[2], NULL, 10);
    const size_t p = strtoul(given[3], NULL, 10), batches = strtoul(given[4], NULL, 10);
    const Kernels *tables[] = {
        &kernels_baseline,
#if defined(__GNUC__) && defined(__x86_64__)
        &kernels_avx2,
        &kernels_avx512,
#endif
    };
    size_t usable = 1;
    for (size_t k = 0; k < sizeof tables / sizeof *tables; k++)
        if (tables[k] == best_kernels())
            usable = k + 1;
    Propagator P = {1.0,        numbers(n), numbers(n), numbers(n), numbers(n),
                    numbers(n), numbers(n), numbers(n), NULL};
    double *q = numbers(n), *v = numbers(n), *f = numbers(n), *q1 = numbers(n), *v1 = numbers(n),
           *y = numbers(p);
    double *B = numbers(m * n), *C = numbers(p * n), *u = numbers(m), *times[3], *motion[] = {q1, v1};
    unsigned int *references = lines_of_memory(p, sizeof *references);
    Law *laws = lines_of_memory(p, sizeof *laws);
    double **places = lines_of_memory(p, sizeof *places);
    for (size_t k = 0; k < p; k++) {
        references[k] = (unsigned int)k;
        places[k] = C + k * n;
    }
    Outputs rows = {places, n, laws, motion};
    for (size_t k = 0; k < usable; k++)
        times[k] = lines_of_memory(batches, sizeof(double));
    for (size_t batch = 0; batch < batches; batch++)
        for (size_t k = 0; k < usable; k++) {
            double start = nanoseconds();
            for (size_t cycle = 0; cycle < CYCLES; cycle++) {
                memset(f, 0, n * sizeof *f);
                for (size_t j = 0; j < m; j++)
                    tables[k]->add(f, B + j * n, u[j], n);
                y[0] += tables[k]->step_held(&P, q, v, f, q1, v1, n);
                tables[k]->outputs(&rows, 0, references, 0, p, y);
            }
            times[k][batch] = (nanoseconds() - start) / CYCLES;
        }
    for (size_t k = 0; k < usable; k++)
        printf("%s %.17g\n", tables[k]->instructions, median(times[k], batches));
    return 0;
}
