/* Directional derivatives at an instant: how unknowns move when knowns do. */
#ifndef MODALFMU_DIRECTIONAL_H
#define MODALFMU_DIRECTIONAL_H

#include "instance.h"

/* Whether a Real may be varied (inputs, states, and while initialising alpha, beta and, in place of s and s',
 * their starts), and whether it follows from these (outputs, derivatives of states, and while initialising
 * damping ratios, s, s' and a static start's q). */
INTERNAL bool is_known(const Instance *instance, Group group, size_t place);
INTERNAL bool is_unknown(const Instance *instance, Group group, size_t place);

/* The directions: none, then one after the other; several of one variable add up. */
INTERNAL void clear_directions(Instance *instance);
INTERNAL void add_direction(Instance *instance, Group group, size_t place, double dv);

/* Take the directions on to x'' (and to q in a static start): exact, the motion is linear in inputs and
 * states.
 *
 *     dx' = dv,   ds'' = da,   dq'' = df - D~ dq' - lam dq - (dalpha + lam dbeta) q',
 *     df = B du + N ds' + dalpha B_a s';   in a static start dq = df/lam, and then df - lam dq = 0. */
INTERNAL void spread_directions(Instance *instance);

/* The derivative of an unknown in the directions spread before. */
INTERNAL double directional_derivative(const Instance *instance, Group group, size_t place);

#endif
