#include "instance.h"

#include "motion.h"

#include <math.h>

/* The place of the coefficients of a step size: kept ones, or computed ones in place of those used longest
 * ago. */
static size_t kept_coefficients(Instance *x, double h)
{
    size_t age = 0;
    while (age < x->kept_count && x->kept[x->newest[age]].h != h)
        age++;
    x->step_size_was_new = age == x->kept_count;
    if (x->step_size_was_new) {
        if (x->kept_count < KEPT_STEP_SIZES)
            x->newest[x->kept_count++] = (unsigned char)age;
        else
            age--;
        unsigned char slot = x->newest[age];
        propagator(&x->kept[slot], x->model->lam, x->d, x->active, h);
        switch_off(x, &x->kept[slot]);
        if (x->coupling.g > 0)
            coupled_coefficients(&x->coupling, slot, x->d, h, x->kernels);
    }
    unsigned char slot = x->newest[age];
    for (; age > 0; age--)
        x->newest[age] = x->newest[age - 1];
    x->newest[0] = slot;
    return slot;
}

static double larger(double a, double b)
{
    return a > b ? a : b;
}

static bool step_is_legal(const Instance *x, double time, double h, Reason *reason)
{
    if (!(isfinite(h) && h > 0.0))
        return refuse(reason, "communicationStepSize is %g, expected a finite number > 0", h);
    double distance = fabs(time - x->time), same = SAME_POINT * larger(1.0, fabs(x->time));
    if (!(distance <= same && distance <= 0.5 * h))
        return refuse(reason, "currentCommunicationPoint is %.17g, expected %.17g, where the last step ended",
                      time, x->time);
    return inputs_are_finite(x, reason);
}

/* u(t+h) = u + u' h + u'' h2/2 of one input, and its rate there. */
static double extrapolated(const Instance *x, size_t j, double h)
{
    return x->u[0][j] + h * (x->u[1][j] + 0.5 * h * x->u[2][j]);
}

static double extrapolated_rate(const Instance *x, size_t j, double h)
{
    return x->u[1][j] + h * x->u[2][j];
}

static bool extrapolation_is_finite(const Instance *x, double h)
{
    for (size_t j = 0; j < x->model->m; j++)
        if (!isfinite(extrapolated(x, j, h)) || !isfinite(extrapolated_rate(x, j, h)))
            return false;
    return true;
}

/* The inputs and rates at the end of the step; the rates hold no further. */
static void extrapolate_inputs(Instance *x, double h)
{
    for (size_t j = 0; j < x->model->m; j++) {
        x->u[0][j] = extrapolated(x, j, h);
        x->u[1][j] = extrapolated_rate(x, j, h);
    }
    x->forces_known = 0;
    x->rates_given = false;
    x->rates_left = true;
}

/* q, v after the step h in `next`; returns |q|2 + |v|2. */
static double moved(Instance *x, double h)
{
    const size_t slot = kept_coefficients(x, h);
    const Propagator *P = &x->kept[slot];
    const double *q = x->motion[0], *v = x->motion[1];
    const size_t degree = step_forces(x);
    double size;
    if (degree == 0)
        size = x->kernels->step_held(P, q, v, x->f[0], x->next[0], x->next[1], x->n_active);
    else if (degree <= RATES)
        size = x->kernels->step(P, q, v, x->f, x->next[0], x->next[1], x->n_active);
    else
        size = x->kernels->step_cubic(P, q, v, x->f, x->next[0], x->next[1], x->n_active);
    if (x->coupling.g > 0) /* in place of what these modes would do alone */
        size += coupled_step(&x->coupling, slot, q, v, x->f, degree, x->next[0], x->next[1], x->kernels);
    return size;
}

StepResult advance_instance(Instance *x, double time, double h, Reason *reason)
{
    if (!step_is_legal(x, time, h, reason))
        return STEP_ILLEGAL;
    double size = moved(x, h);
    if (!isfinite(size) || !isfinite(time + h) || (x->rates_given && !extrapolation_is_finite(x, h))) {
        refuse(reason, "the motion over communicationStepSize = %g is beyond the range of numbers", h);
        return STEP_BEYOND_RANGE;
    }
    for (size_t order = 0; order < 2; order++) {
        double *before = x->motion[order];
        x->motion[order] = x->next[order];
        x->next[order] = before;
    }
    x->motions_known = 2;
    if (x->drags)
        x->forces_known = 0;
    x->time = time + h;
    if (x->rates_given)
        extrapolate_inputs(x, h);
    else if (x->rates_left)
        clear_rates(x);
    return STEP_MADE;
}
