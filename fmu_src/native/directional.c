#include "directional.h"

#include "motion.h"
#include "outputs.h"

#include <string.h>

static bool static_start(const Instance *x)
{
    return x->initialising && x->model->initial_static;
}

/* Whether a state follows from other variables. */
static bool follows(const Instance *x, Group group, size_t place)
{
    return x->initialising && (place < x->model->k || (group == AMPLITUDE && static_start(x)));
}

bool is_known(const Instance *x, Group group, size_t place)
{
    if (group == ALPHA || group == BETA || group == START)
        return x->initialising;
    return group == INPUT || ((group == AMPLITUDE || group == MODAL_VELOCITY) && !follows(x, group, place));
}

bool is_unknown(const Instance *x, Group group, size_t place)
{
    if (group == DAMPING_RATIO)
        return x->initialising;
    return group == OUTPUT || group == AMPLITUDE_RATE || group == VELOCITY_RATE ||
           ((group == AMPLITUDE || group == MODAL_VELOCITY) && follows(x, group, place));
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
    else if (group == START)
        x->seed[place < x->model->k ? 0 : 1][place < x->model->k ? place : place - x->model->k] += dv;
    else if (place < x->active) /* a mode switched off does not move */
        x->seed[group == AMPLITUDE ? 0 : 1][place] += dv;
}

/* df = B du + N ds' + dalpha B_a s' of the modes, da of prescribed motions. */
static void force_direction(Instance *x, const double *dv, const double *v, double *df)
{
    const size_t k = x->model->k;
    memset(df, 0, x->n * sizeof(double));
    for (size_t j = 0; j < x->model->m; j++)
        if (x->seed_u[j] != 0.0)
            x->kernels->add(df, x->B + j * x->n, x->seed_u[j], x->n_active);
    for (size_t j = 0; j < k; j++) {
        const double *B_a = x->B + x->model->motions[j] * x->n, *N = x->N + j * x->n;
        for (size_t i = k; i < x->active; i++)
            df[i] += N[i] * dv[j] + x->seed_alpha * B_a[i] * v[j];
    }
    memset(df + x->active, 0, (x->n - x->active) * sizeof(double));
}

void spread_directions(Instance *x)
{
    double *dq = x->seed[0], *da = x->seed[2];
    const double *dv = x->seed[1], *v = motion(x, 1)[1];
    force_direction(x, dv, v, da);
    for (size_t i = x->model->k; i < x->active; i++) {
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
    if (group == DAMPING_RATIO) {
        double lam = x->model->lam[x->model->k + place];
        return damping_ratio(lam, x->seed_alpha + lam * x->seed_beta);
    }
    return x->seed[group == AMPLITUDE ? 0 : group == VELOCITY_RATE ? 2 : 1][place];
}
