/* The exact step of modes that damping couples: q'' + D~ q' + Lambda q = f with a full D~ >= 0 [2.22, 2.32].
 */
#ifndef MODALFMU_COUPLED_H
#define MODALFMU_COUPLED_H

#include "kernels.h"

#define COUPLED_SCRATCH 8 /* matrices that the coefficients are computed in */

/* With the net force p = f - Lambda q at the start of a step, for the force f + f' t + f'' t2/2 + f''' t3/6:
 *
 *     q(t+h) = q + E12 v + G0  p + G1 f' + G2 f'' + G3 f'''
 *     v(t+h) = v + N   v + E12 p + G0 f' + G1 f'' + G2 f''',   N = E22 - I,
 *
 * since E11 = I - G0 Lambda and E21 = -E12 Lambda. All are symmetric, (n, n) with zeros behind the g modes,
 * n = g rounded up to whole registers; units as in Propagator. G3 is NULL where it is not wanted. */
typedef struct {
    double *E12, *N, *G0, *G1, *G2, *G3;
} CoupledPropagator;

/* The coefficients for g coupled modes: their series over h/2^k, and k doublings.
 *
 * lam: (g) ascending, 1/s2; D: (n, n) = D~ symmetric >= 0, 1/s; h > 0 in s. Two steps of h are one of 2h, for
 * the motion and for a force f + f' t + ... alike; with Y = E11 - I = -G0 Lambda:
 *
 *     E12 <- 2 E12 + E12 N + Y E12
 *     N   <- 2 N + N N - E12 Lambda E12
 *     G0  <- 2 G0 + E12 E12 + Y G0
 *     G1  <- 2 G1 + h G0 + E12 G0 + Y G1
 *     G2  <- 2 G2 + h G1 + h2/2 G0 + E12 G1 + Y G2
 *     G3  <- 2 G3 + h G2 + h2/2 G1 + h3/6 G0 + E12 G2 + Y G3
 *
 * What is doubled are the deviations from standing still, so that slow modes keep their digits beside fast
 * ones; and of every matrix only the half where the row is the faster mode: products in the other half have
 * the rounding errors of the slower mode, too large by the ratio of the two. The errors are a few
 * eps (1 + omega h) where no mode is damped beyond critical, as those of modes alone, and a few
 * eps (1 + |A| h) at most; not a number where |A| h >= 1e15.
 * Source: scaling and squaring, Higham, Functions of Matrices, 2008, chapter 10.
 *
 * scratch: COUPLED_SCRATCH matrices (n, n) of any content, which are exchanged for those of P; the last one
 * may be NULL where G3 is. */
INTERNAL void coupled_propagator(CoupledPropagator *P, const double *lam, const double *D, size_t g, double h,
                                 const Kernels *kernels, double *scratch[COUPLED_SCRATCH]);

#endif
