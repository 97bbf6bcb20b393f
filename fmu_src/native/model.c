#include "model.h"

#include <math.h>

size_t law_rows(Law law)
{
    switch (law) {
    case REACTION:
        return 3;
    case MISES:
        return 6;
    case KINETIC:
    case STRAIN:
        return 0;
    default:
        return 1;
    }
}

double damping(const ReducedModel *model, size_t i, double alpha, double beta)
{
    return i < model->k ? 0.0 : alpha + beta * model->lam[i] + model->D_rest[i * model->n + i];
}

double drag(const ReducedModel *model, size_t i, size_t j, double alpha)
{
    return i < model->k
               ? 0.0
               : alpha * model->B[i * model->m + model->motions[j]] - model->D_rest[i * model->n + j];
}

double damping_ratio(double lam, double d)
{
    return lam > 0.0 ? d / (2.0 * sqrt(lam)) : 0.0;
}
