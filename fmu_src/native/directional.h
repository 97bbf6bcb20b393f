/* Directional derivatives at an instant: how unknowns move when knowns do. */
#ifndef MODALFMU_DIRECTIONAL_H
#define MODALFMU_DIRECTIONAL_H

#include "instance.h"

/* Whether a Real may be varied (inputs, states, and while initialising alpha and beta), and whether it
 * follows from these (outputs, derivatives of states, and while initialising damping ratios and a static
 * start's q). */
INTERNAL bool is_known(const Instance *instance, Group group);
INTERNAL bool is_unknown(const Instance *instance, Group group);

/* The directions: none, then one after the other; several of one variable add up. */
INTERNAL void clear_directions(Instance *instance);
INTERNAL void add_direction(Instance *instance, Group group, size_t place, double dv);

/* Take the directions on to q'' (and to q in a static start): exact, the motion is linear in inputs and
 * states.
 *
 *     dq' = dv,   dq'' = B du - D~ dv - lam dq - (dalpha + lam dbeta) v;
 *     in a static start dq = B du/lam, and then B du - lam dq = 0. */
INTERNAL void spread_directions(Instance *instance);

/* The derivative of an unknown in the directions spread before. */
INTERNAL double directional_derivative(const Instance *instance, Group group, size_t place);

#endif
