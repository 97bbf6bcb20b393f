#include "propagator.h"

#include <math.h>

#define SMALL 1.5   /* |x2| below which the series is used; beyond it the closed forms lose at most a digit */
#define LARGE 1e300 /* lam h2 from which on it or its inverse would not be a full number: no coefficients */
#define TERMS 30    /* 1.5^k (k+1)/(k+2)! falls below 1e-17 of the leading term before k = 25 */

/* exp[x1, x2] and its like without their powers of h: E12/h, G0/h2, G1/h3, G2/h4, G3/h5. */
typedef struct {
    double E11, e, E22, g0, g1, g2, g3;
} Differences;

/* exp[x1, x2, 0^n] = sum hk(x1, x2)/(k+1+n)!, hk the complete homogeneous symmetric polynomials.
 *
 * With delta = d h = -(x1+x2), Lam = lam h2 = x1 x2: hk = -delta hk-1 - Lam hk-2, real for complex roots too.
 * E11 = 1 - Lam exp[x1, x2, 0] and E22 = E11 - delta exp[x1, x2], since E11 is the free motion from q = 1
 * and also 1 minus the response to the constant force lam. */
static Differences small_roots(double lam, double d, double h)
{
    double delta = d * h, Lam = lam * h * h;
    double before = 0.0, sym = 1.0, factorial = 1.0; /* (k+1)! */
    Differences x = {0};
    for (int k = 0; k < TERMS && fabs(sym) + fabs(before) > 1e-17 * factorial; k++) {
        double term = sym / factorial;
        x.e += term;
        x.g0 += term / (k + 2);
        x.g1 += term / ((k + 2) * (k + 3));
        x.g2 += term / ((k + 2) * (k + 3) * (k + 4));
        x.g3 += term / ((k + 2) * (k + 3) * (k + 4) * (k + 5));
        double next = -delta * sym - Lam * before;
        before = sym;
        sym = next;
        factorial *= k + 2;
    }
    x.E11 = 1.0 - Lam * x.g0;
    x.E22 = x.E11 - delta * x.e;
    return x;
}

/* phi_n(x) = exp[x, 0^n] = sum x^k/(k+n)! for x <= 0; far from 0 by phi_n = (phi_n-1 - 1/(n-1)!)/x. */
static void phis(double x, double phi[5])
{
    if (x > -1.0) {
        double series = 0.0;
        for (int k = 20; k > 0; k--) /* Horner: sum x^k/(k+4)! = (1 + x/5 (1 + x/6 (1 + ...)))/24 */
            series = 1.0 + x / (k + 4) * series;
        phi[4] = series / 24.0;
        phi[3] = (1.0 + x / 4 * series) / 6.0;
        phi[2] = 0.5 + x * phi[3];
        phi[1] = 1.0 + x * phi[2];
    } else {
        phi[1] = expm1(x) / x;
        phi[2] = (phi[1] - 1.0) / x;
        phi[3] = (phi[2] - 0.5) / x;
        phi[4] = (phi[3] - 1.0 / 6.0) / x;
    }
    phi[0] = exp(x);
}

/* Over- and critically damped and rigid: x2 <= x1 <= 0, x1 = -lam h/(d/2 + s) without subtraction.
 *
 *     exp[x1, x2]      = e^x1 phi(z),  phi(z) = (1 - e^-z)/z,  z = x1 - x2 = 2 s h
 *     exp[x1, x2, 0^n] = (exp[x1, 0^n] - exp[x1, x2, 0^(n-1)])/(-x2)
 *
 * With -x2 >= 1.5 each difference is at least a fifth of its first term. */
static Differences real_roots(double lam, double d, double s, double h)
{
    double x2 = -(0.5 * d + s) * h, x1 = lam * h * h / x2, z = 2.0 * s * h, phi[5];
    phis(x1, phi);
    Differences x;
    x.e = phi[0] * (z > 0.0 ? -expm1(-z) / z : 1.0);
    x.E11 = phi[0] - x1 * x.e;
    x.E22 = exp(x2) + x1 * x.e;
    x.g0 = (phi[1] - x.e) / -x2;
    x.g1 = (phi[2] - x.g0) / -x2;
    x.g2 = (phi[3] - x.g1) / -x2;
    x.g3 = (phi[4] - x.g2) / -x2;
    return x;
}

/* Under-damped, a = d/2, w = sqrt(lam - a2) = s: E12 = e^-ah sin(wh)/w.
 *
 * lam G0 = 1 - E11, lam G1 = h - E12 - d G0, lam G2 = h2/2 - G0 - d G1, lam G3 = h3/6 - G1 - d G2 (the
 * equation of motion integrated); with omega h >= 1.5 and d < 2 omega no difference loses more than a digit.
 */
static Differences complex_roots(double lam, double d, double s, double h)
{
    double ah = 0.5 * d * h, wh = s * h, Lam = lam * h * h;
    double decay = exp(-ah), cosine = decay * cos(wh);
    Differences x;
    x.e = decay * sin(wh) / wh;
    x.E11 = cosine + ah * x.e;
    x.E22 = cosine - ah * x.e;
    x.g0 = (1.0 - x.E11) / Lam;
    x.g1 = (1.0 - x.e - d * h * x.g0) / Lam;
    x.g2 = (0.5 - x.g0 - d * h * x.g1) / Lam;
    x.g3 = (1.0 / 6.0 - x.g1 - d * h * x.g2) / Lam;
    return x;
}

void propagator(Propagator *P, const double *lam, const double *d, size_t r, double h)
{
    P->h = h;
    for (size_t i = 0; i < r; i++) {
        double half = 0.5 * d[i];
        double disc =
            half * half - lam[i]; /* its rounding is one of lam, in which the coefficients are smooth */
        double s = sqrt(fabs(disc));
        double largest = (disc > 0.0 ? half + s : sqrt(lam[i])) * h; /* |x2| */
        Differences x = {NAN, NAN, NAN, NAN, NAN, NAN, NAN};
        bool within = lam[i] * h * h < LARGE;
        if (within && largest < SMALL)
            x = small_roots(lam[i], d[i], h);
        else if (within && disc >= 0.0)
            x = real_roots(lam[i], d[i], s, h);
        else if (within)
            x = complex_roots(lam[i], d[i], s, h);
        P->E11[i] = x.E11;
        P->E12[i] = x.e * h;
        P->E21[i] = -lam[i] * P->E12[i];
        P->E22[i] = x.E22;
        P->G0[i] = x.g0 * h * h;
        P->G1[i] = x.g1 * h * h * h;
        P->G2[i] = x.g2 * h * h * h * h;
        if (P->G3)
            P->G3[i] = x.g3 * h * h * h * h * h;
    }
}
