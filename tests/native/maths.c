/* The maths of the twin for ctypes: coefficients, the kernels of every set of instructions, steps of an
 * instance. */
#define MODALFMU_SINGLE_FILE /* as in an FMU: what is not asked for below stays private */
#include "common.c"
#include "propagator.c"
#include "kernels.c"
#include "coupled.c"
#include "coupling.c"
#include "model.c"
#include "variables.c"
#include "motion.c"
#include "outputs.c"
#include "instance.c"
#include "instance_memory.c"
#include "advance.c"

#include <stdlib.h>
#include <string.h>

#define MOST_INPUTS 8
#define MOST_OUTPUTS 64

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

/* One set of coefficients, (8, r): E11, E12, E21, E22, G0, G1, G2, G3. */
void coefficients(const double *lam, const double *d, size_t r, double h, double *out)
{
    Propagator P = {h,           out,         out + r,     out + 2 * r, out + 3 * r,
                    out + 4 * r, out + 5 * r, out + 6 * r, out + 7 * r};
    propagator(&P, lam, d, r, h);
}

/* One set of coefficients of g coupled modes, (6, g, g): E12, E22 - I, G0, G1, G2, G3; D: (g, g). */
void coupled_coefficients_of(const double *lam, const double *D, size_t g, double h, const Kernels *kernels,
                             double *out)
{
    const size_t n = (g + LANES - 1) / LANES * LANES, matrices = COUPLED_SCRATCH + 7;
    double *block = aligned_alloc(64, matrices * n * n * sizeof(double)), *scratch[COUPLED_SCRATCH];
    double *place[COUPLED_SCRATCH + 7];
    for (size_t k = 0; k < matrices; k++)
        place[k] = block + k * n * n;
    memset(block, 255, matrices * n * n * sizeof(double)); /* no number: what was there before */
    for (size_t j = 0; j < n; j++)
        for (size_t i = 0; i < n; i++)
            place[0][j * n + i] = i < g && j < g ? D[j * g + i] : 0.0;
    memcpy(scratch, place + 7, sizeof scratch);
    CoupledPropagator P = {place[1], place[2], place[3], place[4], place[5], place[6]};
    coupled_propagator(&P, lam, place[0], g, h, kernels, scratch);
    double *const found[] = {P.E12, P.N, P.G0, P.G1, P.G2, P.G3};
    for (size_t k = 0; k < 6; k++)
        for (size_t i = 0; i < g; i++)
            for (size_t j = 0; j < g; j++)
                out[(k * g + i) * g + j] = found[k][j * n + i];
    free(block);
}

/* What the run is made of; all arrays as in model.h. start: (2k), u: (steps, 3, m) inputs and their rates,
 * h: (steps), active: (steps). */
typedef struct {
    size_t k, n, m, p, s, steps;
    const double *lam, *D_rest, *B, *C, *R, *R_in, *M_s, *K_s, *start, *u, *h;
    const size_t *motions;
    const int *laws, *active;
    double alpha, beta;
    int initial_static, residual, held;
} Run;

/* motions: (5, n) x and its derivatives; outputs: (3, p) y and its derivatives. */
static void record(Instance *x, double *motions, double *outputs)
{
    size_t n = x->model->n, p = x->model->p;
    unsigned int references[MOST_OUTPUTS];
    double *const *q = motion(x, 4);
    for (size_t order = 0; order < 5; order++)
        memcpy(motions + order * n, q[order], n * sizeof(double));
    for (size_t k = 0; k < p; k++)
        references[k] = (unsigned int)(x->layout.start[OUTPUT] + k);
    for (size_t order = 0; order <= RATES; order++)
        output_values(x, order, references, p, outputs + order * p);
}

/* The steps one after the other; motions: (1 + steps, 5, n), outputs: (1 + steps, 3, p), the first ones
 * before any step, with the inputs of the first step. Gives the number of steps made. */
size_t run_steps(const Run *run, double *motions, double *outputs)
{
    static const char *const names[MOST_INPUTS] = {"a", "b", "c", "d", "e", "f", "g", "h"};
    Law laws[MOST_OUTPUTS];
    const Memory memory = {calloc, free};
    for (size_t k = 0; k < run->p; k++)
        laws[k] = (Law)run->laws[k];
    const ReducedModel model = {.name = "run",
                                .k = run->k,
                                .r = run->n - run->k,
                                .n = run->n,
                                .m = run->m,
                                .p = run->p,
                                .s = run->s,
                                .lam = run->lam,
                                .alpha = run->alpha,
                                .beta = run->beta,
                                .D_rest = run->D_rest,
                                .B = run->B,
                                .C = run->C,
                                .R = run->R,
                                .R_in = run->R_in,
                                .M_s = run->M_s,
                                .K_s = run->K_s,
                                .motions = run->motions,
                                .inputs = names,
                                .laws = laws,
                                .residual = run->residual != 0,
                                .initial_static = run->initial_static != 0};
    Instance *x = new_instance(&model, &memory);
    Reason reason;
    size_t made = 0;
    double time = 0.0;
    if (!x || run->m > MOST_INPUTS || run->p > MOST_OUTPUTS)
        return 0;
    for (size_t j = 0; run->steps > 0 && j < run->m; j++)
        set_input(x, j, run->u[j]);
    for (size_t j = 0; j < 2 * run->k; j++)
        set_start(x, j, run->start[j]);
    if (end_initialisation(x, &reason)) {
        record(x, motions, outputs);
        for (; made < run->steps; made++) {
            const double *u = run->u + made * 3 * run->m;
            set_active(x, (size_t)run->active[made]);
            for (size_t j = 0; j < run->m; j++) {
                set_input(x, j, u[j]);
                for (size_t order = 1; !run->held && order <= RATES; order++)
                    set_input_rate(x, order, j, u[order * run->m + j]);
            }
            if (advance_instance(x, time, run->h[made], &reason) != STEP_MADE)
                break;
            time += run->h[made];
            record(x, motions + (1 + made) * 5 * run->n, outputs + (1 + made) * 3 * run->p);
        }
    }
    free_instance(x, &memory);
    return made;
}
