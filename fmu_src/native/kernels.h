/* The inner loops of a step, for the widest instructions of the processor at hand. */
#ifndef MODALFMU_KERNELS_H
#define MODALFMU_KERNELS_H

#include "model.h"
#include "propagator.h"

/* Vectors are padded with zeros to a multiple of this many numbers: one AVX-512 register, two of AVX2. */
#define LANES 8

/* A decaying mode ends at 0: neither it nor its square in |q1|2 + |v1|2 becomes a subnormal number, on
 * which many processors are a hundred times slower. */
#define TINY 1e-140

/* The rows of C, the first n numbers of which count, and q, q', q'' ... that they multiply: row[k] of an
 * output whose law[k] is POSITION, VELOCITY or ACCELERATION. */
typedef struct {
    double *const *row;
    size_t n;
    const Law *law;
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
    /* The same with f''' too, by G3. */
    double (*step_cubic)(const Propagator *P, const double *q, const double *v, double *const f[4],
                         double *q1, double *v1, size_t n);
    /* The same for a force that is held: f' = f'' = 0. */
    double (*step_held)(const Propagator *P, const double *q, const double *v, const double *f, double *q1,
                        double *v1, size_t n);
    /* y[k] = C q^(law + order) with the row and the law of the output references[k] - first */
    void (*outputs)(const Outputs *rows, size_t order, const unsigned int *references, unsigned int first,
                    size_t count, double *y);
    /* a^T b */
    double (*dot)(const double *a, const double *b, size_t n);
    /* q1 += X a + Y b, v1 += Z a + X b; X, Y, Z: (n, n) symmetric, the first g columns of which count */
    void (*coupled)(const double *X, const double *Y, const double *Z, const double *a, const double *b,
                    double *q1, double *v1, size_t g, size_t n);
    /* C += A B, (n, n) column by column, the first g columns of A; at least on and below the diagonal */
    void (*multiply)(double *C, const double *A, const double *B, size_t g, size_t n);
} Kernels;

/* The kernels for this processor; a table that never changes. */
INTERNAL const Kernels *best_kernels(void);

#endif
