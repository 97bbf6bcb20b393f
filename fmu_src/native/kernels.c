#include "kernels.h"

#if defined(__GNUC__) && defined(__x86_64__)
#include <cpuid.h>
#endif

#if defined(__GNUC__)
#define INLINE static inline __attribute__((always_inline))
#else
#define INLINE static inline
#endif

#define COLUMNS 4 /* of a product that are summed at once; LANES is a multiple of it */

INLINE double flushed(double x)
{
    return x < TINY && x > -TINY ? 0.0 : x;
}

INLINE void add_body(double *restrict f, const double *restrict column, double u, size_t n)
{
    for (size_t i = 0; i < n; i++)
        f[i] += column[i] * u;
}

/* The sum of LANES partial sums, one after the other: summed in pairs, clang keeps them in 128-bit registers.
 */
INLINE double total(const double sum[LANES])
{
    double s = 0.0;
    for (size_t k = 0; k < LANES; k++)
        s += sum[k];
    return s;
}

INLINE double step_held_body(const Propagator *P, const double *restrict q, const double *restrict v,
                             const double *restrict f, double *restrict q1, double *restrict v1, size_t n)
{
    const double *restrict E11 = P->E11, *restrict E12 = P->E12, *restrict E21 = P->E21,
                           *restrict E22 = P->E22;
    const double *restrict G0 = P->G0;
    double sum[LANES] = {0};
    for (size_t i = 0; i < n; i += LANES)
        for (size_t k = 0; k < LANES; k++) {
            size_t j = i + k;
            q1[j] = flushed(E11[j] * q[j] + E12[j] * v[j] + G0[j] * f[j]);
            v1[j] = flushed(E21[j] * q[j] + E22[j] * v[j] + E12[j] * f[j]);
            sum[k] += q1[j] * q1[j] + v1[j] * v1[j];
        }
    return total(sum);
}

INLINE double step_body(const Propagator *P, const double *restrict q, const double *restrict v,
                        double *const f[3], double *restrict q1, double *restrict v1, size_t n)
{
    const double *restrict E11 = P->E11, *restrict E12 = P->E12, *restrict E21 = P->E21,
                           *restrict E22 = P->E22;
    const double *restrict G0 = P->G0, *restrict G1 = P->G1, *restrict G2 = P->G2;
    const double *restrict f0 = f[0], *restrict f1 = f[1], *restrict f2 = f[2];
    double sum[LANES] = {0};
    for (size_t i = 0; i < n; i += LANES)
        for (size_t k = 0; k < LANES; k++) {
            size_t j = i + k;
            q1[j] = flushed(E11[j] * q[j] + E12[j] * v[j] + G0[j] * f0[j] + G1[j] * f1[j] + G2[j] * f2[j]);
            v1[j] = flushed(E21[j] * q[j] + E22[j] * v[j] + E12[j] * f0[j] + G0[j] * f1[j] + G1[j] * f2[j]);
            sum[k] += q1[j] * q1[j] + v1[j] * v1[j];
        }
    return total(sum);
}

INLINE double step_cubic_body(const Propagator *P, const double *restrict q, const double *restrict v,
                              double *const f[4], double *restrict q1, double *restrict v1, size_t n)
{
    const double *restrict E11 = P->E11, *restrict E12 = P->E12, *restrict E21 = P->E21,
                           *restrict E22 = P->E22;
    const double *restrict G0 = P->G0, *restrict G1 = P->G1, *restrict G2 = P->G2, *restrict G3 = P->G3;
    const double *restrict f0 = f[0], *restrict f1 = f[1], *restrict f2 = f[2], *restrict f3 = f[3];
    double sum[LANES] = {0};
    for (size_t i = 0; i < n; i += LANES)
        for (size_t k = 0; k < LANES; k++) {
            size_t j = i + k;
            q1[j] = flushed(E11[j] * q[j] + E12[j] * v[j] + G0[j] * f0[j] + G1[j] * f1[j] + G2[j] * f2[j] +
                            G3[j] * f3[j]);
            v1[j] = flushed(E21[j] * q[j] + E22[j] * v[j] + E12[j] * f0[j] + G0[j] * f1[j] + G1[j] * f2[j] +
                            G2[j] * f3[j]);
            sum[k] += q1[j] * q1[j] + v1[j] * v1[j];
        }
    return total(sum);
}

INLINE double dot_body(const double *restrict a, const double *restrict b, size_t n)
{
    double sum[LANES] = {0};
    for (size_t i = 0; i < n; i += LANES)
        for (size_t k = 0; k < LANES; k++)
            sum[k] += a[i + k] * b[i + k];
    return total(sum);
}

INLINE void outputs_body(const Outputs *rows, size_t order, const unsigned int *references,
                         unsigned int first, size_t count, double *restrict y)
{
    size_t n = rows->n;
    for (size_t j = 0; j < count; j++) {
        size_t output = references[j] - first;
        y[j] = dot_body(rows->row[output], rows->motion[rows->law[output] + order], n);
    }
}

INLINE void coupled_body(const double *restrict X, const double *restrict Y, const double *restrict Z,
                         const double *restrict a, const double *restrict b, double *restrict q1,
                         double *restrict v1, size_t g, size_t n)
{
    for (size_t i = 0; i < n; i += LANES) {
        double Xa[LANES] = {0}, Yb[LANES] = {0}, Za[LANES] = {0}, Xb[LANES] = {0};
        for (size_t j = 0; j < g; j++)
            for (size_t k = 0; k < LANES; k++) {
                size_t at = j * n + i + k;
                Xa[k] += X[at] * a[j];
                Yb[k] += Y[at] * b[j];
                Za[k] += Z[at] * a[j];
                Xb[k] += X[at] * b[j];
            }
        for (size_t k = 0; k < LANES; k++) {
            q1[i + k] += Xa[k] + Yb[k];
            v1[i + k] += Za[k] + Xb[k];
        }
    }
}

INLINE void multiply_body(double *restrict C, const double *restrict A, const double *restrict B, size_t g,
                          size_t n)
{
    for (size_t j = 0; j < n; j += COLUMNS)
        for (size_t i = j / LANES * LANES; i < n; i += LANES) {
            double sum[COLUMNS][LANES] = {{0}};
            for (size_t l = 0; l < g; l++)
                for (size_t c = 0; c < COLUMNS; c++)
                    for (size_t k = 0; k < LANES; k++)
                        sum[c][k] += A[l * n + i + k] * B[(j + c) * n + l];
            for (size_t c = 0; c < COLUMNS; c++)
                for (size_t k = 0; k < LANES; k++)
                    C[(j + c) * n + i + k] += sum[c][k];
        }
}

/* The bodies, compiled for one set of instructions. */
#define KERNELS(NAME, TARGET)                                                                                \
    TARGET static void add_##NAME(double *f, const double *column, double u, size_t n)                       \
    {                                                                                                        \
        add_body(f, column, u, n);                                                                           \
    }                                                                                                        \
    TARGET static double step_##NAME(const Propagator *P, const double *q, const double *v,                  \
                                     double *const f[3], double *q1, double *v1, size_t n)                   \
    {                                                                                                        \
        return step_body(P, q, v, f, q1, v1, n);                                                             \
    }                                                                                                        \
    TARGET static double step_cubic_##NAME(const Propagator *P, const double *q, const double *v,            \
                                           double *const f[4], double *q1, double *v1, size_t n)             \
    {                                                                                                        \
        return step_cubic_body(P, q, v, f, q1, v1, n);                                                       \
    }                                                                                                        \
    TARGET static double step_held_##NAME(const Propagator *P, const double *q, const double *v,             \
                                          const double *f, double *q1, double *v1, size_t n)                 \
    {                                                                                                        \
        return step_held_body(P, q, v, f, q1, v1, n);                                                        \
    }                                                                                                        \
    TARGET static void outputs_##NAME(const Outputs *rows, size_t order, const unsigned int *references,     \
                                      unsigned int first, size_t count, double *y)                           \
    {                                                                                                        \
        outputs_body(rows, order, references, first, count, y);                                              \
    }                                                                                                        \
    TARGET static double dot_##NAME(const double *a, const double *b, size_t n)                              \
    {                                                                                                        \
        return dot_body(a, b, n);                                                                            \
    }                                                                                                        \
    TARGET static void coupled_##NAME(const double *X, const double *Y, const double *Z, const double *a,    \
                                      const double *b, double *q1, double *v1, size_t g, size_t n)           \
    {                                                                                                        \
        coupled_body(X, Y, Z, a, b, q1, v1, g, n);                                                           \
    }                                                                                                        \
    TARGET static void multiply_##NAME(double *C, const double *A, const double *B, size_t g, size_t n)      \
    {                                                                                                        \
        multiply_body(C, A, B, g, n);                                                                        \
    }                                                                                                        \
    static const Kernels kernels_##NAME = {                                                                  \
        #NAME,          add_##NAME, step_##NAME,    step_cubic_##NAME, step_held_##NAME,                     \
        outputs_##NAME, dot_##NAME, coupled_##NAME, multiply_##NAME};

KERNELS(baseline, )

#if defined(__GNUC__) && defined(__x86_64__)

KERNELS(avx2, __attribute__((target("avx2,fma"))))
KERNELS(avx512, __attribute__((target("avx512f,avx2,fma"))))

/* What the processor has and what the operating system saves on a change of threads. */
const Kernels *best_kernels(void)
{
    unsigned int a, b, c, d, saved, high;
    if (!__get_cpuid(1, &a, &b, &c, &d) || !(c & bit_OSXSAVE) || !(c & bit_FMA))
        return &kernels_baseline;
    __asm__ volatile("xgetbv" : "=a"(saved), "=d"(high) : "c"(0));
    if ((saved & 0x06) != 0x06 || !__get_cpuid_count(7, 0, &a, &b, &c, &d) || !(b & bit_AVX2))
        return &kernels_baseline;
    return (saved & 0xe0) == 0xe0 && (b & bit_AVX512F) ? &kernels_avx512 : &kernels_avx2;
}

#else

const Kernels *best_kernels(void)
{
    return &kernels_baseline;
}

#endif
