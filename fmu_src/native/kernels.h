/* The inner loops of a step, for the widest instructions of the processor at hand. */
#ifndef MODALFMU_KERNELS_H
#define MODALFMU_KERNELS_H

#include "model.h"
#include "propagator.h"

/* Vectors are padded with zeros to a multiple of this many numbers: one AVX-512 register, two of AVX2. */
#define LANES 8

/* The rows of C, `length` numbers each, the first n of which count, and q, q', q'' ... that they multiply. */
typedef struct {
    const double *C;
    size_t length, n;
    const OutputKind *kinds;
    double *const *motion;
} Outputs;

/* All lengths n are multiples of LANES, all vectors start at a whole register. */
typedef struct {
    const char *instructions;
    /* f += column u */
    void (*add)(double *f, const double *column, double u, size_t n);
    /* q1 = E11 q + E12 v + G0 f + G1 f' + G2 f'', v1 alike; f holds f, f', f''. Returns |q1|2 + |v1|2. */
    double (*step)(const Propagator *P, const double *q, const double *v, double *const f[3], double *q1,
                   double *v1, size_t n);
    /* The same for a force that is held: f' = f'' = 0. */
    double (*step_held)(const Propagator *P, const double *q, const double *v, const double *f, double *q1,
                        double *v1, size_t n);
    /* y[k] = C[row] q^(kind of the row + order), row = references[k] - first */
    void (*outputs)(const Outputs *rows, size_t order, const unsigned int *references, unsigned int first,
                    size_t count, double *y);
} Kernels;

/* The kernels for this processor; a table that never changes. */
INTERNAL const Kernels *best_kernels(void);

#endif
