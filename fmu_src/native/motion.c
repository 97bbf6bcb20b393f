#include "motion.h"

#include <string.h>

/* f += B u */
static void add_inputs(Instance *x, double *f, const double *u)
{
    for (size_t j = 0; j < x->model->m; j++)
        if (u[j] != 0.0)
            x->kernels->add(f, x->B + j * x->n, u[j], x->n_active);
}

/* f += N s' or one of its derivatives, s''... = a...: the inputs' of an order less */
static void add_drag(Instance *x, double *f, size_t order)
{
    for (size_t j = 0; x->drags && j < x->model->k; j++) {
        double rate = order == 0 ? x->motion[1][j] : x->u[order - 1][x->model->motions[j]];
        if (rate != 0.0)
            x->kernels->add(f, x->N + j * x->n, rate, x->n_active);
    }
}

const double *modal_force(Instance *x, size_t order)
{
    for (; x->forces_known <= order; x->forces_known++) {
        double *f = x->f[x->forces_known];
        memset(f, 0, x->n * sizeof(double));
        if (x->forces_known <= RATES)
            add_inputs(x, f, x->u[x->forces_known]);
        add_drag(x, f, x->forces_known);
        memset(f + x->active, 0, (x->n - x->active) * sizeof(double));
    }
    return x->f[order];
}

size_t step_forces(Instance *x)
{
    size_t degree = (x->rates_given ? RATES : 0) + x->drags;
    modal_force(x, x->rates_given ? degree : 0);
    if (degree == 1) { /* s' rises; rates that the last step ended with do not hold */
        for (size_t order = 1; order <= RATES; order++)
            memset(x->f[order], 0, x->n * sizeof(double));
        add_drag(x, x->f[1], 1);
        memset(x->f[1] + x->active, 0, (x->n - x->active) * sizeof(double));
        x->forces_known = 1;
    }
    return degree;
}

/* A static start follows the inputs until initialisation ends: q = f/lam [2.35, 2.36]. */
static void static_solution(Instance *x)
{
    const double *f = modal_force(x, 0);
    for (size_t i = x->model->k; i < x->active; i++)
        x->motion[0][i] = f[i] / x->model->lam[i];
    x->settled = true;
}

/* The derivatives of q that are not up to date, up to this order. */
static void extend_motion(Instance *x, size_t order)
{
    for (; x->motions_known <= order; x->motions_known++) {
        size_t k = x->motions_known;
        const double *f = modal_force(x, k - 2), *q = x->motion[k - 2], *v = x->motion[k - 1];
        for (size_t i = 0; i < x->active; i++)
            x->motion[k][i] = f[i] - x->d[i] * v[i] - x->model->lam[i] * q[i];
        coupled_damping(&x->coupling, v, x->motion[k], x->kernels);
    }
}

double *const *motion(Instance *x, size_t order)
{
    if (x->initialising && x->model->initial_static && !x->settled)
        static_solution(x);
    if (x->motions_known <= order)
        extend_motion(x, order);
    return x->motion;
}
