#include "coupling.h"

#include <math.h>
#include <string.h>

/* Whether D_rest couples the mode to another one of the first `count` coordinates. */
static bool has_partner(const ReducedModel *model, size_t mode, size_t count)
{
    for (size_t j = model->k; j < count; j++)
        if (j != mode && model->D_rest[mode * model->n + j] != 0.0)
            return true;
    return false;
}

size_t coupled_modes(const ReducedModel *model, size_t *mode)
{
    size_t count = 0;
    for (size_t i = model->k; i < model->n; i++)
        if (has_partner(model, i, model->n)) {
            if (mode)
                mode[count] = i;
            count++;
        }
    return count;
}

bool set_coupling(Coupling *group, const ReducedModel *model, size_t active)
{
    size_t before = group->g;
    group->g = 0;
    for (size_t k = 0; k < group->every; k++) {
        size_t mode = group->every_mode[k];
        if (mode < active && has_partner(model, mode, active))
            group->mode[group->g++] = mode;
    }
    if (group->g == before) /* one set holds the other: they are equal */
        return false;
    size_t g = group->g, n = group->n = (g + LANES - 1) / LANES * LANES;
    memset(group->D_off, 0, n * n * sizeof(double));
    for (size_t i = 0; i < g; i++) {
        group->lam[i] = model->lam[group->mode[i]];
        for (size_t j = 0; j < g; j++)
            if (i != j)
                group->D_off[j * n + i] = model->D_rest[group->mode[i] * model->n + group->mode[j]];
    }
    return true;
}

void coupled_coefficients(Coupling *group, size_t slot, const double *d, double h, const Kernels *kernels)
{
    size_t g = group->g, n = group->n;
    memcpy(group->D, group->D_off, n * n * sizeof(double));
    for (size_t i = 0; i < g; i++)
        group->D[i * n + i] = d[group->mode[i]];
    coupled_propagator(&group->kept[slot], group->lam, group->D, g, h, kernels, group->scratch);
}

/* What is next to nothing becomes 0, as in kernels.c. */
static double not_tiny(double x)
{
    return fabs(x) < TINY ? 0.0 : x;
}

double coupled_step(Coupling *group, size_t slot, const double *q, const double *v, double *const f[4],
                    size_t degree, double *q1, double *v1, const Kernels *kernels)
{
    const CoupledPropagator *P = &group->kept[slot];
    const size_t g = group->g, n = group->n, *mode = group->mode;
    for (size_t i = 0; i < g; i++) {
        group->q_end[i] = q[mode[i]];
        group->v_end[i] = group->v[i] = v[mode[i]];
        group->p[i] = f[0][mode[i]] - group->lam[i] * q[mode[i]];
    }
    kernels->coupled(P->E12, P->G0, P->N, group->v, group->p, group->q_end, group->v_end, g, n);
    if (degree > 0) {
        for (size_t i = 0; i < g; i++) {
            group->f1[i] = f[1][mode[i]];
            group->f2[i] = f[2][mode[i]];
        }
        kernels->coupled(P->G1, P->G2, P->G0, group->f1, group->f2, group->q_end, group->v_end, g, n);
    }
    for (size_t j = 0; degree > 2 && j < g; j++) {
        kernels->add(group->q_end, P->G3 + j * n, f[3][mode[j]], n);
        kernels->add(group->v_end, P->G2 + j * n, f[3][mode[j]], n);
    }
    double size = 0.0;
    for (size_t i = 0; i < g; i++) {
        double q_end = q1[mode[i]] = not_tiny(group->q_end[i]);
        double v_end = v1[mode[i]] = not_tiny(group->v_end[i]);
        size += q_end * q_end + v_end * v_end;
    }
    return size;
}

void coupled_damping(Coupling *group, const double *v, double *a, const Kernels *kernels)
{
    const size_t g = group->g, n = group->n, *mode = group->mode;
    memset(group->v_end, 0, n * sizeof(double));
    for (size_t j = 0; j < g; j++)
        kernels->add(group->v_end, group->D_off + j * n, v[mode[j]], n);
    for (size_t i = 0; i < g; i++)
        a[mode[i]] -= group->v_end[i];
}
