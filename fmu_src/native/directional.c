#include "directional.h"

#include "motion.h"
#include "outputs.h"

#include <string.h>

static bool static_start(const Instance *x)
{
    return x->initialising && x->model->initial_static;
}

bool is_known(const Instance *x, Group group)
{
    if (group == ALPHA || group == BETA)
        return x->initialising;
    return group == INPUT || group == MODAL_VELOCITY || (group == AMPLITUDE && !static_start(x));
}

bool is_unknown(const Instance *x, Group group)
{
    if (group == DAMPING_RATIO)
        return x->initialising;
    return group == OUTPUT || group == AMPLITUDE_RATE || group == VELOCITY_RATE ||
           (group == AMPLITUDE && static_start(x));
}

void clear_directions(Instance *x)
{
    memset(x->seed_u, 0, x->model->m * sizeof(double));
    for (size_t order = 0; order < 2; order++)
        memset(x->seed[order], 0, x->n * sizeof(double));
    x->seed_alpha = x->seed_beta = 0.0;
}

void add_direction(Instance *x, Group group, size_t place, double dv)
{
    if (group == INPUT)
        x->seed_u[place] += dv;
    else if (group == ALPHA)
        x->seed_alpha += dv;
    else if (group == BETA)
        x->seed_beta += dv;
    else if (place < x->active) /* a mode switched off does not move */
        x->seed[group == AMPLITUDE ? 0 : 1][place] += dv;
}

void spread_directions(Instance *x)
{
    double *dq = x->seed[0], *da = x->seed[2];
    const double *dv = x->seed[1], *v = motion(x, 1)[1];
    memset(da, 0, x->n * sizeof(double));
    for (size_t j = 0; j < x->model->m; j++)
        if (x->seed_u[j] != 0.0)
            x->kernels->add(da, x->B + j * x->n, x->seed_u[j], x->n_active);
    memset(da + x->active, 0, (x->n - x->active) * sizeof(double));
    for (size_t i = 0; i < x->active; i++) {
        if (static_start(x)) {
            dq[i] = da[i] / x->model->lam[i];
            da[i] = 0.0;
        } else {
            da[i] -= x->model->lam[i] * dq[i];
        }
        da[i] -= x->d[i] * dv[i] + (x->seed_alpha + x->model->lam[i] * x->seed_beta) * v[i];
    }
    coupled_damping(&x->coupling, dv, da, x->kernels);
}

double directional_derivative(const Instance *x, Group group, size_t place)
{
    if (group == OUTPUT)
        return output_direction(x, place);
    if (group == DAMPING_RATIO)
        return damping_ratio(x->model->lam[place], x->seed_alpha + x->model->lam[place] * x->seed_beta);
    if (group == AMPLITUDE || group == AMPLITUDE_RATE || group == VELOCITY_RATE)
        return x->seed[group == AMPLITUDE ? 0 : group == AMPLITUDE_RATE ? 1 : 2][place];
    return 0.0;
}
