/* The reduced model: modal oscillators between ports [2.29-2.32]. */
#ifndef MODALFMU_MODEL_H
#define MODALFMU_MODEL_H

#include "common.h"

#define GUID_SIZE 64 /* of an FMU: 38 characters with braces; and the final 0 */

/* What an output is, by the derivative of q that it is made of. */
typedef enum { DISPLACEMENT = 0, VELOCITY = 1, ACCELERATION = 2 } OutputKind;

/* q'' + D~ q' + Lambda q = B u,  y = C q, C q' or C q'',  D~ = alpha I + beta Lambda + D_rest [2.28, 2.32].
 *
 * lam: (r) ascending, 1/s2, 0 for rigid modes; alpha in 1/s, beta in s; D_rest: (r, r) 1/s, diagonal;
 * B: (r, m), C: (p, r), rows one after the other; inputs, outputs: names in the order of the columns of B
 * and the rows of C; output_kinds: (p). The model is never written to after it was read. */
typedef struct {
    const char *name;
    size_t r, m, p;
    const double *lam;
    double alpha, beta;
    const double *D_rest;
    const double *B;
    const double *C;
    const char *const *inputs;
    const char *const *outputs;
    const OutputKind *output_kinds;
    bool initial_static; /* start in equilibrium with the start values of the inputs */
} ReducedModel;

/* d = alpha + beta lam + D_rest of a mode, 1/s [2.28]. */
INTERNAL double damping(const ReducedModel *model, size_t mode, double alpha, double beta);

/* zeta = d/(2 omega), and 0 for a rigid mode, which has none. */
INTERNAL double damping_ratio(double lam, double d);

#endif
