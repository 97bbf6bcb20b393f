/* The reduced model: modal oscillators between ports [2.29-2.32], and ports whose motion is prescribed. */
#ifndef MODALFMU_MODEL_H
#define MODALFMU_MODEL_H

#include "common.h"

#define GUID_SIZE 64 /* of an FMU: 38 characters with braces; and the final 0 */

/* How an output is computed from x = [s; q], u and their derivatives; the first three by the derivative of x.
 */
typedef enum {
    POSITION = 0,     /* C x + R u */
    VELOCITY = 1,     /* C x' + R u' */
    ACCELERATION = 2, /* C x'' + R u */
    REACTION,         /* C1 (x'' + alpha x') + C2 x' + C3 (x + beta x') + R1 u */
    MISES,            /* of the stress C x + R u in xx, yy, zz, xy, yz, zx */
    KINETIC,          /* q'^T q'/2 + q'^T P s' + s'^T M_s s'/2, P = -B_a */
    STRAIN            /* q^T Lambda q/2 + s^T K_s s/2 + u^T R_in u/2 */
} Law;

/* s'' = a and q'' + D~ q' + Lambda q = B u + N s',  D~ = alpha I + beta Lambda + D_rest,  outputs from x, u
 * [2.28, 2.32].
 *
 * The coordinates x = [s; q] are k displacements and rotations of ports that are prescribed by their
 * accelerations a, which are among the inputs u, and the amplitudes of r modes of the part with these held,
 * n = k + r. The modes move relative to what follows s statically: B_a, the columns of a, are of its inertia,
 * and damping of the whole motion drags them, N = alpha B_a - D_qs, D_qs the part of D_rest between q and s.
 *
 * lam: (n) 1/s2, 0 for s, then ascending, 0 for rigid modes; alpha in 1/s, beta in s; D_rest: (n, n) 1/s,
 * symmetric, an entry off its diagonal couples two modes; B: (n, m), C: (rows, n), R: (rows, m) with
 * law_rows(law) rows for each output, rows one after the other, C3 of a reaction 0 for modes; R_in: (m, m),
 * M_s, K_s: (k, k) symmetric; motions: (k) the places of a in u; inputs, outputs: names in the order of the
 * columns of B and of the rows of C; laws: (p); s: the rows of C. The model is never written to after it was
 * read. */
typedef struct {
    const char *name;
    size_t k, r, n, m, p, s;
    const double *lam;
    double alpha, beta;
    const double *D_rest;
    const double *B;
    const double *C;
    const double *R;
    const double *R_in;
    const double *M_s;
    const double *K_s;
    const size_t *motions;
    const char *const *inputs;
    const char *const *outputs;
    const Law *laws;
    bool residual;       /* elastic modes that are off follow statically */
    bool initial_static; /* start in equilibrium with the start values of the inputs */
} ReducedModel;

/* How many rows of C and R an output of this law takes. */
INTERNAL size_t law_rows(Law law);

/* The diagonal of D~, 1/s: d = alpha + beta lam + D_rest of a mode [2.28], 0 of a prescribed motion. */
INTERNAL double damping(const ReducedModel *model, size_t i, double alpha, double beta);

/* The entry of N = alpha B_a - D_qs for the mode x_i and the prescribed velocity s'_j, 1/s; 0 where x_i is no
 * mode: alpha M and D act on the whole motion, beta K has no part in it. */
INTERNAL double drag(const ReducedModel *model, size_t i, size_t j, double alpha);

/* zeta = d/(2 omega), and 0 for a rigid mode, which has none. */
INTERNAL double damping_ratio(double lam, double d);

#endif
