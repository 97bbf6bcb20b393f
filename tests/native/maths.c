/* The maths of the twin for ctypes: coefficients, the kernels of every set of instructions, steps of an
 * instance. */
#define MODALFMU_SINGLE_FILE /* as in an FMU: what is not asked for below stays private */
#include "common.c"
#include "propagator.c"
#include "kernels.c"
#include "model.c"
#include "variables.c"
#include "motion.c"
#include "instance.c"

#include <stdlib.h>
#include <string.h>

/* The tables that this processor can run, the narrowest first; gives their number. */
size_t usable_kernels(const Kernels *tables[3])
{
    const Kernels *best = best_kernels();
    const Kernels *all[] = {
        &kernels_baseline,
#if defined(__GNUC__) && defined(__x86_64__)
        &kernels_avx2,
        &kernels_avx512,
#endif
    };
    size_t count = 0;
    do
        tables[count] = all[count];
    while (all[count++] != best);
    return count;
}

/* One set of coefficients, (7, r): E11, E12, E21, E22, G0, G1, G2. */
void coefficients(const double *lam, const double *d, size_t r, double h, double *out)
{
    Propagator P = {h, out, out + r, out + 2 * r, out + 3 * r, out + 4 * r, out + 5 * r, out + 6 * r};
    propagator(&P, lam, d, r, h);
}

/* What the run is made of; all arrays as in model.h. u: (steps, 3, m) inputs and their rates, h: (steps). */
typedef struct {
    size_t r, m, p, steps;
    const double *lam, *D_rest, *B, *C, *u, *h;
    const int *kinds;
    double alpha, beta;
    int initial_static, held;
} Run;

static void record(Instance *x, double *motions, double *outputs)
{
    size_t r = x->model->r, p = x->model->p, first = x->layout.start[OUTPUT];
    double *const *q = motion(x, 4);
    for (size_t order = 0; order < 5; order++)
        memcpy(motions + order * r, q[order], r * sizeof(double));
    for (size_t row = 0; row < p; row++) {
        unsigned int reference = (unsigned int)(first + row);
        real_values(x, &reference, 1, outputs + row);
    }
}

/* The steps one after the other; motions: (1 + steps, 5, r) q, q' ... q'''', outputs: (1 + steps, p), the
 * first ones before any step, with the inputs of the first step. Gives the number of steps made. */
size_t run_steps(const Run *run, double *motions, double *outputs)
{
    static const char *const names[] = {"a", "b", "c", "d", "e", "f", "g", "h"}; /* of up to 8 inputs */
    OutputKind kinds[8];
    const Memory memory = {calloc, free};
    for (size_t row = 0; row < run->p; row++)
        kinds[row] = (OutputKind)run->kinds[row];
    const ReducedModel model = {
        "run",       run->r, run->m, run->p, run->lam, run->alpha, run->beta,
        run->D_rest, run->B, run->C, names,  names,    kinds,      run->initial_static != 0};
    Instance *x = new_instance(&model, &memory);
    Reason reason;
    size_t made = 0;
    double time = 0.0;
    if (!x)
        return 0;
    for (size_t j = 0; run->steps > 0 && j < run->m; j++)
        set_input(x, j, run->u[j]);
    if (end_initialisation(x, &reason)) {
        record(x, motions, outputs);
        for (; made < run->steps; made++) {
            const double *u = run->u + made * 3 * run->m;
            for (size_t j = 0; j < run->m; j++) {
                set_input(x, j, u[j]);
                for (size_t order = 1; !run->held && order <= RATES; order++)
                    set_input_rate(x, order, j, u[order * run->m + j]);
            }
            if (advance_instance(x, time, run->h[made], &reason) != STEP_MADE)
                break;
            time += run->h[made];
            record(x, motions + (1 + made) * 5 * run->r, outputs + (1 + made) * run->p);
        }
    }
    free_instance(x, &memory);
    return made;
}
