#include "model.h"

#include <math.h>

size_t law_rows(Law law)
{
    switch (law) {
    case REACTION:
        return 2;
    case MISES:
        return 6;
    case KINETIC:
    case STRAIN:
        return 0;
    default:
        return 1;
    }
}

double damping(const ReducedModel *model, size_t mode, double alpha, double beta)
{
    return alpha + beta * model->lam[mode] + model->D_rest[mode * model->r + mode];
}

double damping_ratio(double lam, double d)
{
    return lam > 0.0 ? d / (2.0 * sqrt(lam)) : 0.0;
}
