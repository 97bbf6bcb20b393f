#include "instance.h"

#include "motion.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#define ALIGNMENT 64     /* bytes of the widest register */
#define MODAL_VECTORS 14 /* what place_vectors hands out */
#define INPUT_VECTORS 4
#define COEFFICIENTS 7

static size_t padded(size_t count)
{
    return (count + LANES - 1) / LANES * LANES;
}

/* How many numbers an instance of the model keeps; 0 where they cannot be counted. */
static size_t vector_numbers(const ReducedModel *model)
{
    size_t n = padded(model->r);
    size_t columns = MODAL_VECTORS + KEPT_STEP_SIZES * COEFFICIENTS + model->m + model->p;
    size_t limit = SIZE_MAX / sizeof(double) / 4;
    if (model->r > limit || model->m > limit || model->p > limit || columns > limit / n)
        return 0;
    return columns * n + INPUT_VECTORS * padded(model->m);
}

static double *take(double **rest, size_t count)
{
    double *taken = *rest;
    *rest += count;
    return taken;
}

/* Hand out the one block of memory to the vectors. */
static void place_vectors(Instance *x, double *rest)
{
    size_t n = x->n, m = x->model->m, p = x->model->p;
    double **modal[MODAL_VECTORS] = {
        &x->d,         &x->f[0],      &x->f[1],    &x->f[2],    &x->motion[0], &x->motion[1], &x->motion[2],
        &x->motion[3], &x->motion[4], &x->next[0], &x->next[1], &x->seed[0],   &x->seed[1],   &x->seed[2]};
    double **of_inputs[INPUT_VECTORS] = {&x->u[0], &x->u[1], &x->u[2], &x->seed_u};
    for (size_t k = 0; k < MODAL_VECTORS; k++)
        *modal[k] = take(&rest, n);
    for (size_t k = 0; k < INPUT_VECTORS; k++)
        *of_inputs[k] = take(&rest, padded(m));
    for (size_t k = 0; k < KEPT_STEP_SIZES; k++) {
        Propagator *P = &x->kept[k];
        double **coefficients[COEFFICIENTS] = {&P->E11, &P->E12, &P->E21, &P->E22, &P->G0, &P->G1, &P->G2};
        for (size_t i = 0; i < COEFFICIENTS; i++)
            *coefficients[i] = take(&rest, n);
    }
    x->B = take(&rest, m * n);
    x->C = take(&rest, p * n);
}

/* The columns of B and the rows of C, padded with zeros. */
static void copy_model(Instance *x)
{
    const ReducedModel *model = x->model;
    size_t r = model->r, m = model->m, p = model->p;
    for (size_t i = 0; i < r; i++)
        for (size_t j = 0; j < m; j++)
            x->B[j * x->n + i] = model->B[i * m + j];
    for (size_t row = 0; row < p; row++) {
        OutputKind kind = model->output_kinds[row];
        memcpy(x->C + row * x->n, model->C + row * r, r * sizeof(double));
        x->highest_kind = kind > x->highest_kind ? kind : x->highest_kind;
    }
}

Instance *new_instance(const ReducedModel *model, const Memory *memory)
{
    size_t numbers = vector_numbers(model);
    Instance *x = numbers ? memory->allocate(1, sizeof *x) : NULL;
    void *block = x ? memory->allocate(1, numbers * sizeof(double) + ALIGNMENT) : NULL;
    if (!block) {
        if (x)
            memory->release(x);
        return NULL;
    }
    x->model = model;
    x->layout = layout(model);
    x->kernels = best_kernels();
    x->n = padded(model->r);
    x->block = block;
    place_vectors(x, (double *)(((uintptr_t)block + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT));
    copy_model(x);
    reset_instance(x);
    return x;
}

void free_instance(Instance *x, const Memory *memory)
{
    memory->release(x->block);
    memory->release(x);
}

void reset_instance(Instance *x)
{
    size_t inputs = x->model->m * sizeof(double), modes = x->n * sizeof(double);
    for (size_t order = 0; order <= RATES; order++)
        memset(x->u[order], 0, inputs);
    memset(x->motion[0], 0, modes);
    memset(x->motion[1], 0, modes);
    x->initialising = true;
    x->rates_given = x->rates_left = false;
    x->time = 0.0;
    set_active(x, x->model->r);
    set_damping(x, x->model->alpha, x->model->beta);
}

void set_damping(Instance *x, double alpha, double beta)
{
    x->alpha = alpha;
    x->beta = beta;
    for (size_t i = 0; i < x->model->r; i++)
        x->d[i] = damping(x->model, i, alpha, beta);
    x->kept_count = 0;
    x->motions_known = 2;
}

/* Modes that are off share a register with the last ones that are on: their coefficients are 0. */
static void switch_off(const Instance *x, const Propagator *P)
{
    double *const coefficients[COEFFICIENTS] = {P->E11, P->E12, P->E21, P->E22, P->G0, P->G1, P->G2};
    for (size_t k = 0; k < COEFFICIENTS; k++)
        memset(coefficients[k] + x->active, 0, (x->n_active - x->active) * sizeof(double));
}

void set_active(Instance *x, size_t active)
{
    size_t off = (x->n - active) * sizeof(double);
    for (size_t order = 0; order <= 2 + RATES; order++)
        memset(x->motion[order] + active, 0, off);
    memset(x->next[0] + active, 0, off);
    memset(x->next[1] + active, 0, off);
    if (active > x->active) /* the kept coefficients are those of fewer modes */
        x->kept_count = 0;
    x->active = active;
    x->n_active = padded(active);
    for (size_t k = 0; k < x->kept_count; k++)
        switch_off(x, &x->kept[k]);
    x->forces_known = 0;
    x->motions_known = 2;
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

/* No rates: the inputs are held. */
static void clear_rates(Instance *x)
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
}

bool end_initialisation(Instance *x, Reason *reason)
{
    const double *q = motion(x, 0)[0];
    for (size_t i = 0; i < x->active; i++)
        if (!isfinite(q[i]))
            return refuse(reason,
                          "the static start gives modes.amplitude[%zu] = %g, expected a finite number: "
                          "set finite inputs",
                          i + 1, q[i]);
    x->initialising = false;
    return true;
}

/* The coefficients of a step size: kept ones, or computed ones in place of those used longest ago. */
static const Propagator *kept_propagator(Instance *x, double h)
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
        propagator(&x->kept[x->newest[age]], x->model->lam, x->d, x->active, h);
        switch_off(x, &x->kept[x->newest[age]]);
    }
    unsigned char place = x->newest[age];
    for (; age > 0; age--)
        x->newest[age] = x->newest[age - 1];
    x->newest[0] = place;
    return &x->kept[place];
}

static double larger(double a, double b)
{
    return a > b ? a : b;
}

bool inputs_are_finite(const Instance *x, Reason *reason)
{
    for (size_t j = 0; j < x->model->m; j++)
        if (!isfinite(x->u[0][j]))
            return refuse(reason, "%s is %g, expected a finite number", x->model->inputs[j], x->u[0][j]);
    return true;
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

StepResult advance_instance(Instance *x, double time, double h, Reason *reason)
{
    if (!step_is_legal(x, time, h, reason))
        return STEP_ILLEGAL;
    const Propagator *P = kept_propagator(x, h);
    const double *q = x->motion[0], *v = x->motion[1];
    double size;
    if (x->rates_given) {
        modal_force(x, RATES);
        size = x->kernels->step(P, q, v, x->f, x->next[0], x->next[1], x->n_active);
    } else {
        size = x->kernels->step_held(P, q, v, modal_force(x, 0), x->next[0], x->next[1], x->n_active);
    }
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
    x->time = time + h;
    if (x->rates_given)
        extrapolate_inputs(x, h);
    else if (x->rates_left)
        clear_rates(x);
    return STEP_MADE;
}
