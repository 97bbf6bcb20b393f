/* The Reals of the FMU by their value references. */
#ifndef MODALFMU_REALS_H
#define MODALFMU_REALS_H

#include "instance.h"

/* `count` Reals, all of which are known to exist. */
INTERNAL void real_values(Instance *instance, const unsigned int *references, size_t count, double *values);

/* The nominal value of a state: |B|/lam of q (order 0), |B|/omega of v (order 1), 1 where that is none. */
INTERNAL double nominal(const Instance *instance, size_t order, size_t place);

#endif
