#include "motion.h"

#include <math.h>
#include <string.h>

#define TWO_PI 6.283185307179586

const double *modal_force(Instance *x, size_t order)
{
    for (; x->forces_known <= order; x->forces_known++) {
        double *f = x->f[x->forces_known];
        const double *u = x->u[x->forces_known];
        memset(f, 0, x->n * sizeof(double));
        for (size_t j = 0; j < x->model->m; j++)
            if (u[j] != 0.0)
                x->kernels->add(f, x->B + j * x->n, u[j], x->n_active);
        memset(f + x->active, 0, (x->n - x->active) * sizeof(double));
    }
    return x->f[order];
}

/* A static start follows the inputs until initialisation ends: q = f/lam [2.35, 2.36]. */
static void static_solution(Instance *x)
{
    const double *f = modal_force(x, 0);
    for (size_t i = 0; i < x->active; i++)
        x->motion[0][i] = f[i] / x->model->lam[i];
    x->settled = true;
}

double *const *motion(Instance *x, size_t order)
{
    if (x->initialising && x->model->initial_static && !x->settled)
        static_solution(x);
    for (; x->motions_known <= order; x->motions_known++) {
        size_t k = x->motions_known;
        const double *f = modal_force(x, k - 2), *q = x->motion[k - 2], *v = x->motion[k - 1];
        for (size_t i = 0; i < x->active; i++)
            x->motion[k][i] = f[i] - x->d[i] * v[i] - x->model->lam[i] * q[i];
    }
    return x->motion;
}

/* How many of the references, from the first one on, are outputs. */
static size_t run_of_outputs(const Instance *x, const unsigned int *references, size_t count)
{
    const unsigned int first = (unsigned int)x->layout.start[OUTPUT], p = (unsigned int)x->model->p;
    size_t run = 0;
    while (run < count && references[run] - first < p) /* one below `first` wraps round to beyond p */
        run++;
    return run;
}

/* y = C q^(kind + order) for a run of outputs, all computed from what was asked for and no more. */
static void output_values(Instance *x, size_t order, const unsigned int *references, size_t count,
                          double *values)
{
    const OutputKind *kinds = x->model->output_kinds;
    const unsigned int first = (unsigned int)x->layout.start[OUTPUT];
    size_t highest = VELOCITY; /* q and v are there in any case */
    for (size_t k = 0; k < count && highest < x->highest_kind; k++)
        highest = kinds[references[k] - first] > highest ? kinds[references[k] - first] : highest;
    Outputs rows = {x->C, x->n, x->n_active, kinds, motion(x, highest + order)};
    x->kernels->outputs(&rows, order, references, first, count, values);
}

/* The Real of a group that is not the outputs'. */
static double other_value(Instance *x, Group group, size_t place)
{
    switch (group) {
    case INPUT:
        return x->u[0][place];
    case ALPHA:
        return x->alpha;
    case BETA:
        return x->beta;
    case FREQUENCY:
        return sqrt(x->model->lam[place]) / TWO_PI;
    case DAMPING_RATIO:
        return damping_ratio(x->model->lam[place], x->d[place]);
    case AMPLITUDE:
        return motion(x, 0)[0][place];
    case MODAL_VELOCITY:
    case AMPLITUDE_RATE:
        return motion(x, 1)[1][place];
    case VELOCITY_RATE:
        return motion(x, 2)[2][place];
    default:
        return NAN;
    }
}

void real_values(Instance *x, const unsigned int *references, size_t count, double *values)
{
    for (size_t k = 0; k < count;) {
        size_t run = run_of_outputs(x, references + k, count - k), place;
        if (run > 0) {
            output_values(x, 0, references + k, run, values + k);
            k += run;
        } else {
            Group group = group_of(&x->layout, references[k], &place);
            values[k++] = other_value(x, group, place);
        }
    }
}

double output_derivative(Instance *x, size_t row, size_t order)
{
    const unsigned int output = (unsigned int)(x->layout.start[OUTPUT] + row);
    double value;
    output_values(x, order, &output, 1, &value);
    return value;
}

double nominal(const Instance *x, size_t order, size_t place)
{
    double omega = sqrt(x->model->lam[place]), force = 0.0;
    for (size_t j = 0; j < x->model->m; j++)
        force = fmax(force, fabs(x->B[j * x->n + place]));
    if (!(omega > 1e-100 && omega < 1e100 && force > 1e-100 && force < 1e100))
        return 1.0;
    return order == 0 ? force / (omega * omega) : force / omega;
}
