#include "outputs.h"

#include "motion.h"

#include <math.h>
#include <string.h>

/* Whether R of an output of this law gains what modes that are off, but follow, would add. */
static bool can_follow(Law law)
{
    return law == POSITION || law == VELOCITY || law == MISES;
}

/* What an elastic mode, a place in x, that is off adds to R and R_in. */
static void follow(Instance *x, size_t mode)
{
    const ReducedModel *model = x->model;
    const double *B = model->B + mode * model->m, lam = model->lam[mode];
    for (size_t k = 0; k < model->p; k++)
        for (size_t row = 0; can_follow(model->laws[k]) && row < law_rows(model->laws[k]); row++)
            for (size_t j = 0; j < model->m; j++)
                x->R_of[k][row * x->n_inputs + j] += x->C_of[k][row * x->n + mode] * (B[j] / lam);
    for (size_t i = 0; i < model->m; i++)
        for (size_t j = 0; j < model->m; j++)
            x->R_in[i * x->n_inputs + j] += B[i] * (B[j] / lam);
}

void feed_through(Instance *x)
{
    const ReducedModel *model = x->model;
    size_t m = model->m, length = x->n_inputs;
    if (!x->feeds_through)
        return;
    for (size_t row = 0; row < model->s; row++)
        memcpy(x->R + row * length, model->R + row * m, m * sizeof(double));
    for (size_t i = 0; i < m; i++)
        memcpy(x->R_in + i * length, model->R_in + i * m, m * sizeof(double));
    for (size_t mode = x->active; model->residual && mode < model->n; mode++)
        if (model->lam[mode] > 0.0)
            follow(x, mode);
    for (size_t k = 0; k < model->p; k++) {
        x->through[k] = false;
        for (size_t j = 0; j < law_rows(model->laws[k]) * length; j++)
            x->through[k] |= x->R_of[k][j] != 0.0;
    }
}

/* x, x', x'' and u at an instant, or their derivatives, or the directions in which they move. */
typedef struct {
    double *const *q;
    const double *u;
} Moment;

/* The derivative of this order of everything at the present time; motion() must know what is asked of x. */
static Moment moment(const Instance *x, size_t order)
{
    return (Moment){x->motion + order, x->u[order]};
}

/* C x + R u of one of the rows of an output. */
static double row_value(const Instance *x, size_t output, size_t row, const double *q, const double *u)
{
    double value = x->kernels->dot(x->C_of[output] + row * x->n, q, x->n_active);
    if (u && x->through[output])
        value += x->kernels->dot(x->R_of[output] + row * x->n_inputs, u, x->n_inputs);
    return value;
}

/* C3 (s + b s') of a reaction: of prescribed motions only. */
static double elastic_value(const Instance *x, size_t output, const double *s, const double *rate, double b)
{
    const double *row = x->C_of[output] + 2 * x->n;
    double value = 0.0;
    for (size_t j = 0; j < x->model->k; j++)
        value += row[j] * (s[j] + b * rate[j]);
    return value;
}

/* An output that is linear in x and u; u' has no part in it. */
static double linear_value(const Instance *x, size_t output, const Moment *at)
{
    switch (x->model->laws[output]) {
    case POSITION:
        return row_value(x, output, 0, at->q[0], at->u);
    case VELOCITY:
        return row_value(x, output, 0, at->q[1], NULL);
    case ACCELERATION:
        return row_value(x, output, 0, at->q[2], at->u);
    default: /* REACTION */
        return row_value(x, output, 0, at->q[2], at->u) + row_value(x, output, 1, at->q[1], NULL) +
               x->alpha * row_value(x, output, 0, at->q[1], NULL) +
               elastic_value(x, output, at->q[0], at->q[1], x->beta);
    }
}

/* The bilinear form of von Mises: its value for twice the same stress xx, yy, zz, xy, yz, zx is the square.
 */
static double mises_form(const double a[6], const double b[6])
{
    double normal =
        (a[0] - a[1]) * (b[0] - b[1]) + (a[1] - a[2]) * (b[1] - b[2]) + (a[2] - a[0]) * (b[2] - b[0]);
    return 0.5 * normal + 3.0 * (a[3] * b[3] + a[4] * b[4] + a[5] * b[5]);
}

/* The form of twice the kinetic energy: q'^T q' + 2 q'^T P s' + s'^T M_s s', P = -B_a. */
static double kinetic_form(const Instance *x, const double *a, const double *b)
{
    const ReducedModel *model = x->model;
    size_t k = model->k;
    if (k == 0)
        return x->kernels->dot(a, b, x->n_active);
    double sum = 0.0;
    for (size_t i = k; i < x->active; i++)
        sum += a[i] * b[i];
    for (size_t j = 0; j < k; j++) {
        const double *B = x->B + model->motions[j] * x->n;
        for (size_t i = k; i < x->active; i++)
            sum -= B[i] * (a[i] * b[j] + a[j] * b[i]);
        for (size_t i = 0; i < k; i++)
            sum += a[i] * model->M_s[i * k + j] * b[j];
    }
    return sum;
}

/* The symmetric bilinear form F of an output that is quadratic: F/2 is an energy, F the square of mises. */
static double form(const Instance *x, size_t output, const Moment *a, const Moment *b)
{
    double sum = 0.0, stress[2][6];
    switch (x->model->laws[output]) {
    case KINETIC:
        return kinetic_form(x, a->q[1], b->q[1]);
    case STRAIN:
        for (size_t i = 0; i < x->active; i++)
            sum += a->q[0][i] * (x->model->lam[i] * b->q[0][i]);
        for (size_t i = 0; i < x->model->k; i++)
            for (size_t j = 0; j < x->model->k; j++)
                sum += a->q[0][i] * x->model->K_s[i * x->model->k + j] * b->q[0][j];
        for (size_t j = 0; x->feeds_through && j < x->model->m; j++)
            sum += a->u[j] * x->kernels->dot(x->R_in + j * x->n_inputs, b->u, x->n_inputs);
        return sum;
    default: /* MISES */
        for (size_t k = 0; k < 6; k++) {
            stress[0][k] = row_value(x, output, k, a->q[0], a->u);
            stress[1][k] = row_value(x, output, k, b->q[0], b->u);
        }
        return mises_form(stress[0], stress[1]);
    }
}

/* The derivative of mises = sqrt(F) that that of F/2 gives: s' = (F/2)'/s, and no derivative where s is 0. */
static double divided(double half_rate, double s)
{
    return s > 0.0 ? half_rate / s : 0.0;
}

/* An output that is quadratic in x and u, or its derivative: with F of two derivatives of the motion,
 *
 *     (F/2)' = F01,  (F/2)'' = F11 + F02;   s = sqrt(F00),  s' = F01/s,  s'' = (F11 + F02 - s'^2)/s. */
static double quadratic_value(const Instance *x, size_t output, size_t order)
{
    bool is_mises = x->model->laws[output] == MISES;
    Moment now = moment(x, 0), rate = moment(x, 1), second = moment(x, 2);
    double s = is_mises || order == 0 ? form(x, output, &now, &now) : 0.0;
    s = is_mises ? sqrt(s) : s;
    if (order == 0)
        return is_mises ? s : 0.5 * s;
    double first = form(x, output, &now, &rate);
    if (order == 1)
        return is_mises ? divided(first, s) : first;
    double next = form(x, output, &rate, &rate) + form(x, output, &now, &second);
    if (!is_mises)
        return next;
    first = divided(first, s);
    return divided(next - first * first, s);
}

/* One output of more rows than one, or of none. */
static double one_value(Instance *x, size_t output, size_t order)
{
    Law law = x->model->laws[output];
    motion(x, order + (law == REACTION ? 2 : law == KINETIC ? 1 : 0));
    if (law >= MISES)
        return quadratic_value(x, output, order);
    Moment at = moment(x, order);
    return linear_value(x, output, &at);
}

/* How many of the outputs, from the first one on, are one row of C each. */
static size_t run_of_rows(const Instance *x, const unsigned int *references, unsigned int first, size_t count)
{
    size_t run = x->rows_only ? count : 0;
    while (run < count && x->model->laws[references[run] - first] <= ACCELERATION)
        run++;
    return run;
}

/* y = C q^(law + order) + R u^(order) for a run of outputs of one row each; R u^(order + 1) of a velocity. */
static void row_values(Instance *x, size_t order, const unsigned int *references, unsigned int first,
                       size_t count, double *values)
{
    const Law *laws = x->model->laws;
    size_t highest = VELOCITY; /* q and v are there in any case */
    for (size_t k = 0; k < count && highest < x->highest_row; k++)
        highest = laws[references[k] - first] > highest ? laws[references[k] - first] : highest;
    Outputs rows = {x->C_of, x->n_active, laws, motion(x, highest + order)};
    x->kernels->outputs(&rows, order, references, first, count, values);
    if (!x->feeds_through)
        return;
    for (size_t k = 0; k < count; k++) {
        size_t output = references[k] - first, rate = order + (laws[output] == VELOCITY);
        if (x->through[output] && rate <= RATES)
            values[k] += x->kernels->dot(x->R_of[output], x->u[rate], x->n_inputs);
    }
}

void output_values(Instance *x, size_t order, const unsigned int *references, size_t count, double *values)
{
    const unsigned int first = (unsigned int)x->layout.start[OUTPUT];
    for (size_t k = 0; k < count;) {
        size_t run = run_of_rows(x, references + k, first, count - k);
        if (run > 0)
            row_values(x, order, references + k, first, run, values + k);
        else
            values[k] = one_value(x, references[k] - first, order);
        k += run > 0 ? run : 1;
    }
}

double output_direction(const Instance *x, size_t output)
{
    const Moment direction = {x->seed, x->seed_u}, now = moment(x, 0);
    Law law = x->model->laws[output];
    if (law < MISES) {
        double value = linear_value(x, output, &direction);
        if (law == REACTION && x->seed_alpha != 0.0)
            value += x->seed_alpha * row_value(x, output, 0, x->motion[1], NULL);
        if (law == REACTION && x->seed_beta != 0.0)
            value += x->seed_beta * elastic_value(x, output, x->motion[1], x->motion[1], 0.0);
        return value;
    }
    double half = form(x, output, &now, &direction);
    return law == MISES ? divided(half, sqrt(form(x, output, &now, &now))) : half;
}
