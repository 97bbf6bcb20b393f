/* What follows from the inputs and the state of an instance: modal forces, accelerations and so on. */
#ifndef MODALFMU_MOTION_H
#define MODALFMU_MOTION_H

#include "instance.h"

/* The inputs' modal forces B u (order 0) and their rates, of the active modes, (n). */
INTERNAL const double *modal_force(Instance *instance, size_t order);

/* q and its derivatives up to this order, (n) each: q'' = f - D~ q' - lam q and its derivatives [2.32]. */
INTERNAL double *const *motion(Instance *instance, size_t order);

#endif
