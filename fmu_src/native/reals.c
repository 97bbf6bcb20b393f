#include "reals.h"

#include "motion.h"
#include "outputs.h"

#include <math.h>

#define TWO_PI 6.283185307179586

/* How many of the references, from the first one on, are outputs. */
static size_t run_of_outputs(const Instance *x, const unsigned int *references, size_t count)
{
    const unsigned int first = (unsigned int)x->layout.start[OUTPUT], p = (unsigned int)x->model->p;
    size_t run = 0;
    while (run < count && references[run] - first < p) /* one below `first` wraps round to beyond p */
        run++;
    return run;
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
    case START:
        return x->start[place];
    case FREQUENCY:
        return sqrt(x->model->lam[x->model->k + place]) / TWO_PI;
    case DAMPING_RATIO:
        return damping_ratio(x->model->lam[x->model->k + place], x->d[x->model->k + place]);
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

double nominal(const Instance *x, size_t order, size_t place)
{
    double omega = sqrt(x->model->lam[place]), force = 0.0;
    for (size_t j = 0; j < x->model->m; j++)
        force = fmax(force, fabs(x->B[j * x->n + place]));
    if (!(omega > 1e-100 && omega < 1e100 && force > 1e-100 && force < 1e100))
        return 1.0;
    return order == 0 ? force / (omega * omega) : force / omega;
}
