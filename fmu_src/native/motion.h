/* What follows from the inputs and the state of an instance: modal forces, accelerations, outputs. */
#ifndef MODALFMU_MOTION_H
#define MODALFMU_MOTION_H

#include "instance.h"

/* The inputs' modal forces B u (order 0) and their rates, of the active modes, (n). */
INTERNAL const double *modal_force(Instance *instance, size_t order);

/* q and its derivatives up to this order, (n) each: q'' = f - d q' - lam q and its derivatives [2.32]. */
INTERNAL double *const *motion(Instance *instance, size_t order);

/* `count` Reals by their references, all of which are known to exist. */
INTERNAL void real_values(Instance *instance, const unsigned int *references, size_t count, double *values);

/* The derivative of an output, of an order 1 ... RATES, at the present time. */
INTERNAL double output_derivative(Instance *instance, size_t row, size_t order);

/* The nominal value of a state: |B|/lam of q (order 0), |B|/omega of v (order 1), 1 where that is none. */
INTERNAL double nominal(const Instance *instance, size_t order, size_t place);

#endif
