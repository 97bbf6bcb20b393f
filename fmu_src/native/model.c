#include "model.h"

#include <math.h>

double damping(const ReducedModel *model, size_t mode, double alpha, double beta)
{
    return alpha + beta * model->lam[mode] + model->D_rest[mode * model->r + mode];
}

double damping_ratio(double lam, double d)
{
    return lam > 0.0 ? d / (2.0 * sqrt(lam)) : 0.0;
}
