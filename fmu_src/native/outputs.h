/* What is measured: every output from q, u and their derivatives, by its law. */
#ifndef MODALFMU_OUTPUTS_H
#define MODALFMU_OUTPUTS_H

#include "instance.h"

/* Take up which modes are active: elastic ones that are off but follow statically, q = B u/lam, add
 * C B/lam to R of positions and velocities, and B^T B/lam to R_in. */
INTERNAL void feed_through(Instance *instance);

/* The derivatives of an order 0 ... RATES of `count` outputs, all given by their value references. u' is
 * that of the next step, if rates of inputs were given, or that which the last step ended with; else 0. */
INTERNAL void output_values(Instance *instance, size_t order, const unsigned int *references, size_t count,
                            double *values);

/* The change of an output in the directions that were spread. */
INTERNAL double output_direction(const Instance *instance, size_t output);

#endif
