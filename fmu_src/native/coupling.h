/* The modes of an instance that damping couples, which advance together. */
#ifndef MODALFMU_COUPLING_H
#define MODALFMU_COUPLING_H

#include "coupled.h"

/* All of it lies in the memory of the instance, with room for all modes that D_rest couples. */
typedef struct {
    size_t every;          /* modes that D_rest couples to another one, */
    size_t *every_mode;    /* and their places among the coordinates, ascending */
    size_t g, n;           /* those that are active and coupled to an active one; rounded up to registers */
    size_t *mode;          /* their places */
    double *lam;           /* (n) */
    double *D_off, *D;     /* (n, n): D_rest off its diagonal; D~ */
    double *v, *p;         /* (g): v and p = f - Lambda q at the start of a step, */
    double *f1, *f2;       /* (g): the rates of f; */
    double *q_end, *v_end; /* (n): q and v at its end */
    CoupledPropagator kept[KEPT_STEP_SIZES];
    double *scratch[COUPLED_SCRATCH];
} Coupling;

/* How many modes D_rest couples to another one; `mode`, if it is given, becomes the places of these in x. */
INTERNAL size_t coupled_modes(const ReducedModel *model, size_t *mode);

/* Take up which coordinates are active: those with a partner among them are coupled. Gives whether others
 * than before are, so that no kept coefficients hold. */
INTERNAL bool set_coupling(Coupling *group, const ReducedModel *model, size_t active);

/* The coefficients in place `slot` of a step h, d being the diagonal of D~ of all modes. */
INTERNAL void coupled_coefficients(Coupling *group, size_t slot, const double *d, double h,
                                   const Kernels *kernels);

/* The step of the coupled modes: from their entries in q, v to those in q1, v1, all of all coordinates; f
 * holds f and, where the force is of a degree above 0 in time, f', f'', and f''' where it is 3. Returns what
 * they add to |q1|2 + |v1|2. */
INTERNAL double coupled_step(Coupling *group, size_t slot, const double *q, const double *v,
                             double *const f[4], size_t degree, double *q1, double *v1,
                             const Kernels *kernels);

/* a -= D_off v: the coupled part of -D~ v, in vectors of all coordinates. */
INTERNAL void coupled_damping(Coupling *group, const double *v, double *a, const Kernels *kernels);

#endif
