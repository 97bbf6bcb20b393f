/* What follows from the inputs and the state of an instance: modal forces, accelerations and so on. */
#ifndef MODALFMU_MOTION_H
#define MODALFMU_MOTION_H

#include "instance.h"

/* The forces f = B u + N s' (order 0) and their rates, on the coordinates that are active, (n); on s the
 * accelerations that are prescribed. */
INTERNAL const double *modal_force(Instance *instance, size_t order);

/* The forces over the next step in `f`, with rates that were given: a polynomial in time of the degree that
 * is returned, 0 ... 1 + RATES. Of orders above it, up to RATES, the entries are 0 where it is not 0. */
INTERNAL size_t step_forces(Instance *instance);

/* x and its derivatives up to this order, (n) each: x'' = f - D~ x' - lam x and its derivatives [2.32]. */
INTERNAL double *const *motion(Instance *instance, size_t order);

#endif
