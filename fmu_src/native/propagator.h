/* The exact step of modal oscillators [2.33, 2.34]: over-, critically, under-damped and rigid. */
#ifndef MODALFMU_PROPAGATOR_H
#define MODALFMU_PROPAGATOR_H

#include "common.h"

#define KEPT_STEP_SIZES 16 /* masters form h as a difference of times, which jitters over a few values */

/* [q, v](t+h) = E(h) [q, v](t) + G0 f + G1 f' + G2 f'' + G3 f'''
 *
 * for the force f + f' t + f'' t2/2 + f''' t3/6 over the step. E = [[E11, E12], [E21, E22]]; the velocity
 * rows of G0 ... G3 are their derivatives by h: E12, G0, G1, G2. One entry per mode; h in s, E11, E22 in 1,
 * E12 in s, E21 in 1/s, Gk in s^(k+2). G3 is NULL where it is not wanted: no motion is prescribed. */
typedef struct {
    double h;
    double *E11, *E12, *E21, *E22, *G0, *G1, *G2, *G3;
} Propagator;

/* Coefficients of q'' + d q' + lam q = f + f' t + f'' t2/2 + f''' t3/6 over a step h [2.32-2.34], for r
 * modes.
 *
 * lam >= 0 in 1/s2, d >= 0 in 1/s, h > 0 in s. With r1, r2 the roots of r2 + d r + lam = 0, x = r h, every
 * coefficient is a divided difference of exp (Higham, Functions of Matrices, 2008, B.16):
 *
 *     E12 = h exp[x1, x2],  Gk = h^(k+2) exp[x1, x2, 0^(k+1)],
 *
 * evaluated so that no case and no limit between cases cancels; not finite where a value is beyond
 * the range of numbers. */
INTERNAL void propagator(Propagator *P, const double *lam, const double *d, size_t r, double h);

#endif
