#include "coupled.h"

#include <math.h>
#include <string.h>

#define SMALL_NORM 1.5  /* |A| h up to which the series is used, as for modes alone */
#define LARGE_NORM 1e15 /* |A| h from which on no digit would be left */
#define LAST_TERM 1e-19 /* of |A|^k h^k/k! */

/* The largest row sum of |A| h in the coordinates [w q, v], A = [[0, W], [-Lambda/W, -D]]: their squares are
 * energies where w = omega >= 1/h, and w = 1/h below. */
static double coupled_norm(const double *lam, const double *D, size_t g, size_t n, double h)
{
    double largest = 1.0;
    for (size_t i = 0; i < g; i++) {
        double x = sqrt(lam[i]) * h, sum = x > 1.0 ? x : x * x;
        for (size_t j = 0; j < g; j++)
            sum += fabs(D[j * n + i]) * h;
        if (sum > largest)
            largest = sum;
        if (x > largest)
            largest = x;
    }
    return largest;
}

/* The upper half becomes that of a symmetric matrix. */
static void mirror(double *A, size_t n)
{
    for (size_t j = 0; j < n; j++)
        for (size_t i = j + 1; i < n; i++)
            A[i * n + j] = A[j * n + i];
}

/* Sums of the series over h: with P0 = 0, P1 = I, Pk+1 = -D h Pk - Lambda h2 Pk-1,
 *
 *     E12 = h sum Pk/k!,  N = sum Pk+1/k!,  Gn = h^(n+2) sum Pk/(k+1+n)!. */
static void coupled_series(const CoupledPropagator *P, const double *lam, const double *D, size_t g, size_t n,
                           double h, double norm, const Kernels *kernels, double *const scratch[])
{
    const size_t count = n * n;
    double *minus_Dh = scratch[0], *before = scratch[1], *now = scratch[2], *after = scratch[3];
    double *const sums[] = {P->E12, P->N, P->G0, P->G1, P->G2, P->G3};
    for (size_t k = 0; k < sizeof sums / sizeof *sums; k++)
        if (sums[k])
            memset(sums[k], 0, count * sizeof(double));
    memset(before, 0, count * sizeof(double));
    memset(now, 0, count * sizeof(double));
    for (size_t i = 0; i < count; i++)
        minus_Dh[i] = -h * D[i];
    for (size_t i = 0; i < g; i++)
        now[i * n + i] = 1.0;
    double factorial = 1.0, bound = 1.0; /* (k+1)!, norm^k/k! */
    for (int k = 0; bound > LAST_TERM; k++) {
        for (size_t i = 0; i < count; i++) {
            double term = now[i] / factorial;
            P->E12[i] += term * h;
            P->N[i] += k > 0 ? term * (k + 1) : 0.0; /* but for I */
            P->G0[i] += term * h * h / (k + 2);
            P->G1[i] += term * h * h * h / ((k + 2) * (k + 3));
            P->G2[i] += term * h * h * h * h / ((k + 2) * (k + 3) * (k + 4));
        }
        for (size_t i = 0; P->G3 && i < count; i++)
            P->G3[i] += now[i] / factorial * h * h * h * h * h / ((k + 2.0) * (k + 3) * (k + 4) * (k + 5));
        memset(after, 0, count * sizeof(double));
        for (size_t j = 0; j < g; j++)
            for (size_t i = 0; i < g; i++)
                after[j * n + i] = -lam[i] * h * h * before[j * n + i];
        kernels->multiply(after, minus_Dh, now, g, n);
        mirror(after, n);
        double *free_again = before;
        before = now;
        now = after;
        after = free_again;
        factorial *= k + 2;
        bound *= norm / (k + 1);
    }
}

/* The coefficients of 2h from those of h. */
static void double_step(CoupledPropagator *P, const double *lam, size_t g, size_t n, double h,
                        const Kernels *kernels, double *scratch[COUPLED_SCRATCH])
{
    const size_t count = n * n;
    double *Y = scratch[5], *E21 = scratch[6];
    for (size_t j = 0; j < g; j++)
        for (size_t i = 0; i < n; i++) {
            Y[j * n + i] = -P->G0[j * n + i] * lam[j];
            E21[j * n + i] = -P->E12[j * n + i] * lam[j];
        }
    CoupledPropagator next = {scratch[0], scratch[1], scratch[2],
                              scratch[3], scratch[4], P->G3 ? scratch[7] : NULL};
    for (size_t i = 0; i < count; i++) {
        next.E12[i] = 2.0 * P->E12[i];
        next.N[i] = 2.0 * P->N[i];
        next.G0[i] = 2.0 * P->G0[i];
        next.G1[i] = 2.0 * P->G1[i] + h * P->G0[i];
        next.G2[i] = 2.0 * P->G2[i] + h * P->G1[i] + 0.5 * h * h * P->G0[i];
    }
    for (size_t i = 0; P->G3 && i < count; i++)
        next.G3[i] = 2.0 * P->G3[i] + h * P->G2[i] + 0.5 * h * h * P->G1[i] + h * h * h / 6.0 * P->G0[i];
    const struct {
        double *sum, *A, *B;
    } products[] = {{next.E12, P->E12, P->N}, {next.E12, Y, P->E12},     {next.N, P->N, P->N},
                    {next.N, E21, P->E12},    {next.G0, P->E12, P->E12}, {next.G0, Y, P->G0},
                    {next.G1, P->E12, P->G0}, {next.G1, Y, P->G1},       {next.G2, P->E12, P->G1},
                    {next.G2, Y, P->G2},      {next.G3, P->E12, P->G2},  {next.G3, Y, P->G3}};
    for (size_t k = 0; k < sizeof products / sizeof *products; k++)
        if (products[k].sum)
            kernels->multiply(products[k].sum, products[k].A, products[k].B, g, n);
    struct {
        double **old, **doubled;
    } exchanges[] = {{&P->E12, &scratch[0]}, {&P->N, &scratch[1]},  {&P->G0, &scratch[2]},
                     {&P->G1, &scratch[3]},  {&P->G2, &scratch[4]}, {&P->G3, &scratch[7]}};
    for (size_t k = 0; k < sizeof exchanges / sizeof *exchanges; k++) {
        double *doubled = *exchanges[k].doubled, *old = *exchanges[k].old;
        if (!old)
            continue;
        mirror(doubled, n);
        *exchanges[k].doubled = old;
        *exchanges[k].old = doubled;
    }
}

void coupled_propagator(CoupledPropagator *P, const double *lam, const double *D, size_t g, double h,
                        const Kernels *kernels, double *scratch[COUPLED_SCRATCH])
{
    const size_t n = (g + LANES - 1) / LANES * LANES;
    double norm = coupled_norm(lam, D, g, n, h);
    if (!(norm < LARGE_NORM)) {
        double *const all[] = {P->E12, P->N, P->G0, P->G1, P->G2, P->G3};
        for (size_t k = 0; k < sizeof all / sizeof *all; k++)
            for (size_t i = 0; all[k] && i < n * n; i++)
                all[k][i] = NAN;
        return;
    }
    double part = h;
    int doublings = 0;
    for (; norm > SMALL_NORM; norm *= 0.5, part *= 0.5)
        doublings++;
    coupled_series(P, lam, D, g, n, part, norm, kernels, scratch);
    for (; doublings > 0; doublings--, part *= 2.0)
        double_step(P, lam, g, n, part, kernels, scratch);
}
