/* One instance of the FMU: its inputs, parameters and state, and what follows from them.
 *
 * No FMI here; the formulas are those of propagator.h, coupled.h, kernels.h, motion.h and outputs.h.
 * Instances share nothing that is written to: each may be used from a thread of its own. */
#ifndef MODALFMU_INSTANCE_H
#define MODALFMU_INSTANCE_H

#include "coupling.h"
#include "variables.h"

#define SAME_POINT                                                                                           \
    1e-9        /* relative to max(1, |t|): a step that starts this near to the last one's end starts there */
#define RATES 2 /* orders of the input derivatives and of the output derivatives */

/* All vectors of coordinates x = [s; q] have n entries, model->n of them used; those of the motion behind
 * `active` are 0. */
typedef struct {
    const ReducedModel *model;
    Layout layout;
    const Kernels *kernels;
    size_t n, n_inputs; /* model->n and m rounded up to whole registers */
    double *d;          /* the diagonal of D~ for the present alpha, beta; */
    double *N;          /* the k columns of N for the present alpha, */
    bool drags;         /* which has an entry */
    double *start;      /* of s, then of s', (2k) */
    double *B, *C;      /* the columns of B, the rows of C */
    double **C_of;      /* (p): the first row of each output, */
    bool rows_only;     /* which has no other and is multiplied by q, q' or q'', */
    Law highest_row;    /* of such outputs the last law */
    bool feeds_through; /* R or R_in is there, */
    double *R, *R_in;   /* their rows for the active modes, n_inputs numbers each, */
    double **R_of;      /* (p): the first row of each output in R, */
    bool *through;      /* (p): and whether one of its rows has an entry */
    bool initialising;  /* until fmi2ExitInitializationMode */
    bool settled;       /* a static start is in equilibrium with the present inputs */
    double time, alpha, beta;
    size_t active, n_active;   /* coordinates that move, at least k; the same rounded up to whole registers */
    double *u[1 + RATES];      /* the inputs and their rates, (n_inputs) each */
    bool rates_given;          /* rates were set for the next step, */
    bool rates_left;           /* or are those that the last step ended with */
    double *f[2 + RATES];      /* B u + N s' and its rates, */
    size_t forces_known;       /* so many of which are up to date */
    double *motion[3 + RATES]; /* x = q, x' = v, x'' = a and their derivatives, */
    size_t motions_known;      /* so many of which are up to date: at least q and v */
    double *next[2];           /* where a step writes the new q, v */
    Propagator kept[KEPT_STEP_SIZES];
    unsigned char newest[KEPT_STEP_SIZES]; /* places in `kept`, the one used last first */
    size_t kept_count;
    Coupling coupling;        /* modes that damping couples */
    double *seed_u, *seed[3]; /* directions of a directional derivative: of u; of q, v, a; of alpha, beta */
    double seed_alpha, seed_beta;
    void *block;            /* the memory of all the vectors */
    bool step_size_was_new; /* in the last step; the coefficients were computed */
} Instance;

/* How a step ended. Where it is not made, inputs, parameters, time and state are as they were. */
typedef enum { STEP_MADE, STEP_ILLEGAL, STEP_BEYOND_RANGE } StepResult;

/* An instance at its start values, or NULL where there is no memory. The model must outlive it. */
INTERNAL Instance *new_instance(const ReducedModel *model, const Memory *memory);
INTERNAL void free_instance(Instance *instance, const Memory *memory);

/* Back to the start values. */
INTERNAL void reset_instance(Instance *instance);

/* Take up alpha, beta from here on; the state stays. */
INTERNAL void set_damping(Instance *instance, double alpha, double beta);

/* Keep the first coordinates, `active` >= k of them; modes switched off go to rest, those switched on start
 * from rest. */
INTERNAL void set_active(Instance *instance, size_t active);

/* Where a prescribed motion begins: s_place for a place below k, s'_(place - k) from there on. */
INTERNAL void set_start(Instance *instance, size_t place, double value);

/* The input at this place; its rate of an order 1 ... RATES over the next step. */
INTERNAL void set_input(Instance *instance, size_t place, double value);
INTERNAL void set_input_rate(Instance *instance, size_t order, size_t place, double value);

/* No rates: the inputs are held. */
INTERNAL void clear_rates(Instance *instance);

/* One entry of x (order 0) or x' (order 1); that of a mode switched off stays 0. */
INTERNAL void set_state(Instance *instance, size_t order, size_t place, double value);

/* End of the initialisation: the initial state is fixed. Refused where it is not finite. */
INTERNAL bool end_initialisation(Instance *instance, Reason *reason);

/* Whether the motion can be computed: an input may be set to anything. */
INTERNAL bool inputs_are_finite(const Instance *instance, Reason *reason);

/* Modes that are off share a register with the last ones that are on: their coefficients are 0. */
INTERNAL void switch_off(const Instance *instance, const Propagator *P);

/* Move the state over one step, or say why not. */
INTERNAL StepResult advance_instance(Instance *instance, double time, double h, Reason *reason);

#endif
