#include "instance.h"

#include "motion.h"
#include "outputs.h"

#include <math.h>
#include <string.h>

void reset_instance(Instance *x)
{
    size_t inputs = x->model->m * sizeof(double), modes = x->n * sizeof(double);
    for (size_t order = 0; order <= RATES; order++)
        memset(x->u[order], 0, inputs);
    memset(x->start, 0, 2 * x->model->k * sizeof(double));
    memset(x->motion[0], 0, modes);
    memset(x->motion[1], 0, modes);
    x->initialising = true;
    x->rates_given = x->rates_left = false;
    x->time = 0.0;
    set_active(x, x->model->n);
    set_damping(x, x->model->alpha, x->model->beta);
}

/* N for the present alpha. */
static void set_drag(Instance *x)
{
    x->drags = false;
    for (size_t j = 0; j < x->model->k; j++)
        for (size_t i = 0; i < x->model->n; i++) {
            double entry = x->N[j * x->n + i] = drag(x->model, i, j, x->alpha);
            x->drags |= entry != 0.0;
        }
    x->forces_known = 0;
    x->settled = false;
}

void set_damping(Instance *x, double alpha, double beta)
{
    x->alpha = alpha;
    x->beta = beta;
    for (size_t i = 0; i < x->model->n; i++)
        x->d[i] = damping(x->model, i, alpha, beta);
    set_drag(x);
    x->kept_count = 0;
    x->motions_known = 2;
}

void switch_off(const Instance *x, const Propagator *P)
{
    double *const coefficients[] = {P->E11, P->E12, P->E21, P->E22, P->G0, P->G1, P->G2, P->G3};
    for (size_t k = 0; k < sizeof coefficients / sizeof *coefficients && coefficients[k]; k++)
        memset(coefficients[k] + x->active, 0, (x->n_active - x->active) * sizeof(double));
}

/* What depends on which modes are active: who is coupled, what the inputs move at once, kept coefficients. */
static void change_active(Instance *x, size_t active)
{
    bool kept_hold = active < x->active; /* else they are those of fewer modes */
    x->active = active;
    x->n_active = (active + LANES - 1) / LANES * LANES;
    if (set_coupling(&x->coupling, x->model, active) || !kept_hold)
        x->kept_count = 0;
    for (size_t k = 0; k < x->kept_count; k++)
        switch_off(x, &x->kept[k]);
    feed_through(x);
}

void set_active(Instance *x, size_t active)
{
    size_t off = (x->n - active) * sizeof(double);
    for (size_t order = 0; order <= 2 + RATES; order++)
        memset(x->motion[order] + active, 0, off);
    memset(x->next[0] + active, 0, off);
    memset(x->next[1] + active, 0, off);
    if (active != x->active)
        change_active(x, active);
    x->forces_known = 0;
    x->motions_known = 2;
    x->settled = false;
}

void set_start(Instance *x, size_t place, double value)
{
    size_t k = x->model->k;
    x->start[place] = value;
    set_state(x, place < k ? 0 : 1, place < k ? place : place - k, value);
    x->settled = false;
}

void set_input(Instance *x, size_t place, double value)
{
    if (x->u[0][place] == value)
        return;
    x->u[0][place] = value;
    x->forces_known = 0;
    x->motions_known = 2;
    x->settled = false;
}

void clear_rates(Instance *x)
{
    for (size_t order = 1; order <= RATES; order++)
        memset(x->u[order], 0, x->model->m * sizeof(double));
    x->forces_known = x->forces_known < 1 ? x->forces_known : 1;
    x->rates_left = false;
}

void set_input_rate(Instance *x, size_t order, size_t place, double value)
{
    if (!x->rates_given)
        clear_rates(x);
    x->rates_given = true;
    x->u[order][place] = value;
    x->forces_known = x->forces_known < order ? x->forces_known : order;
    x->motions_known = x->motions_known < 3 ? x->motions_known : 3;
}

void set_state(Instance *x, size_t order, size_t place, double value)
{
    if (place < x->active)
        x->motion[order][place] = value;
    x->motions_known = 2;
    if (x->drags && place < x->model->k)
        x->forces_known = 0;
}

bool end_initialisation(Instance *x, Reason *reason)
{
    const double *q = motion(x, 0)[0];
    for (size_t i = x->model->k; i < x->active; i++)
        if (!isfinite(q[i]))
            return refuse(reason,
                          "the static start gives modes.amplitude[%zu] = %g, expected a finite number: "
                          "set finite inputs",
                          i + 1 - x->model->k, q[i]);
    x->initialising = false;
    return true;
}

bool inputs_are_finite(const Instance *x, Reason *reason)
{
    for (size_t j = 0; j < x->model->m; j++)
        if (!isfinite(x->u[0][j]))
            return refuse(reason, "%s is %g, expected a finite number", x->model->inputs[j], x->u[0][j]);
    return true;
}
