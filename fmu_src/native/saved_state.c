#include "saved_state.h"

#include "motion.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/* What stands before the vectors u, u', u'', the starts, x, x'. */
typedef struct {
    uint64_t n, m, active;
    uint64_t rates_given, rates_left;
    double time, alpha, beta;
} SavedHead;

size_t saved_size(const Instance *x)
{
    return sizeof(SavedHead) + ((1 + RATES) * x->model->m + 2 * (x->model->k + x->model->n)) * sizeof(double);
}

void save_state(Instance *x, unsigned char *bytes)
{
    double *const *q_v = motion(x, VELOCITY); /* a static start is settled */
    size_t m = x->model->m, n = x->model->n, starts = 2 * x->model->k * sizeof(double);
    SavedHead head = {n, m, x->active, x->rates_given, x->rates_left, x->time, x->alpha, x->beta};
    memcpy(bytes, &head, sizeof head);
    bytes += sizeof head;
    for (size_t order = 0; order <= RATES; order++, bytes += m * sizeof(double))
        memcpy(bytes, x->u[order], m * sizeof(double));
    memcpy(bytes, x->start, starts);
    bytes += starts;
    for (size_t order = 0; order < 2; order++, bytes += n * sizeof(double))
        memcpy(bytes, q_v[order], n * sizeof(double));
}

static bool all_finite(const unsigned char *bytes, size_t count)
{
    for (size_t k = 0; k < count; k++) {
        double value;
        memcpy(&value, bytes + k * sizeof value, sizeof value);
        if (!isfinite(value))
            return false;
    }
    return true;
}

bool restore_state(Instance *x, const unsigned char *bytes, bool initialising, Reason *reason)
{
    size_t m = x->model->m, n = x->model->n, k = x->model->k;
    SavedHead head;
    memcpy(&head, bytes, sizeof head);
    const unsigned char *inputs = bytes + sizeof head, *rates = inputs + m * sizeof(double);
    const unsigned char *start = rates + RATES * m * sizeof(double), *q = start + 2 * k * sizeof(double);
    const unsigned char *v = q + n * sizeof(double);
    bool q_follows = initialising && x->model->initial_static; /* the inputs, which may be infinite */
    bool motion_is_finite = all_finite(start, 2 * k) && all_finite(q, q_follows ? k : n) && all_finite(v, n);
    if (head.n != n || head.m != m || head.active < k || head.active > n || head.rates_given > 1 ||
        head.rates_left > 1)
        return refuse(reason, "the state is damaged, or not one of this model");
    if (!(motion_is_finite && (!head.rates_given || all_finite(rates, RATES * m)) && isfinite(head.time) &&
          head.alpha >= 0.0 && isfinite(head.alpha) && head.beta >= 0.0 && isfinite(head.beta)))
        return refuse(reason, "the state is damaged: it holds a value out of range");
    set_active(x, (size_t)head.active);
    x->initialising = initialising;
    x->rates_given = head.rates_given == 1;
    x->rates_left = head.rates_left == 1;
    x->time = head.time;
    for (size_t order = 0; order <= RATES; order++, inputs += m * sizeof(double))
        memcpy(x->u[order], inputs, m * sizeof(double));
    memcpy(x->start, start, 2 * k * sizeof(double));
    memcpy(x->motion[0], q, x->active * sizeof(double));
    memcpy(x->motion[1], v, x->active * sizeof(double));
    if (head.alpha != x->alpha || head.beta != x->beta)
        set_damping(x, head.alpha, head.beta);
    return true;
}
