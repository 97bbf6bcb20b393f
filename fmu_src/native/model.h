/* The reduced model: modal oscillators between ports [2.29-2.32]. */
#ifndef MODALFMU_MODEL_H
#define MODALFMU_MODEL_H

#include "common.h"

#define GUID_SIZE 64 /* of an FMU: 38 characters with braces; and the final 0 */

/* How an output is computed from q, u and their derivatives; the first three by the derivative of q. */
typedef enum {
    POSITION = 0,     /* C q + R u */
    VELOCITY = 1,     /* C q' + R u' */
    ACCELERATION = 2, /* C q'' + R u */
    REACTION,         /* C1 q'' + (C2 + alpha C1) q' + R1 u */
    MISES,            /* of the stress C q + R u in xx, yy, zz, xy, yz, zx */
    KINETIC,          /* q'^T q'/2 */
    STRAIN            /* q^T Lambda q/2 + u^T R_in u/2 */
} Law;

/* q'' + D~ q' + Lambda q = B u,  D~ = alpha I + beta Lambda + D_rest,  outputs from q and u [2.28, 2.32].
 *
 * lam: (r) ascending, 1/s2, 0 for rigid modes; alpha in 1/s, beta in s; D_rest: (r, r) 1/s, symmetric, an
 * entry off its diagonal couples two modes; B: (r, m), C: (s, r), R: (s, m) with law_rows(law) rows for each
 * output, rows one after the other; R_in: (m, m) symmetric; inputs, outputs: names in the order of the
 * columns of B and of the rows of C; laws: (p). The model is never written to after it was read. */
typedef struct {
    const char *name;
    size_t r, m, p, s;
    const double *lam;
    double alpha, beta;
    const double *D_rest;
    const double *B;
    const double *C;
    const double *R;
    const double *R_in;
    const char *const *inputs;
    const char *const *outputs;
    const Law *laws;
    bool residual;       /* elastic modes that are off follow statically */
    bool initial_static; /* start in equilibrium with the start values of the inputs */
} ReducedModel;

/* How many rows of C and R an output of this law takes. */
INTERNAL size_t law_rows(Law law);

/* d = alpha + beta lam + D_rest of a mode, 1/s: the diagonal of D~ [2.28]. */
INTERNAL double damping(const ReducedModel *model, size_t mode, double alpha, double beta);

/* zeta = d/(2 omega), and 0 for a rigid mode, which has none. */
INTERNAL double damping_ratio(double lam, double d);

#endif
