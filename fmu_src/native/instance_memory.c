#include "instance.h"

#include <stdint.h>
#include <string.h>

#define ALIGNMENT 64 /* bytes of the widest register */

/* A block of memory that is handed out from its start; first without memory, to find its size. */
typedef struct {
    double *block;
    size_t used;
    bool too_large;
} Store;

/* The next `rows` times `length` numbers. */
static double *take(Store *store, size_t rows, size_t length)
{
    size_t limit = SIZE_MAX / sizeof(double) / 4 - store->used;
    double *taken = store->block ? store->block + store->used : NULL;
    if (length > 0 && rows > limit / length)
        store->too_large = true;
    else
        store->used += rows * length;
    return taken;
}

static size_t padded(size_t count)
{
    return (count + LANES - 1) / LANES * LANES;
}

/* Memory of the coupled modes; whether with G3. */
static void place_coupling(Coupling *group, Store *store, bool cubic)
{
    size_t every = group->every, n = padded(every);
    double **vectors[] = {&group->lam, &group->v,     &group->p,    &group->f1,
                          &group->f2,  &group->q_end, &group->v_end};
    group->every_mode = (size_t *)(void *)take(store, 1, n); /* a size_t takes no more than a double */
    group->mode = (size_t *)(void *)take(store, 1, n);
    for (size_t k = 0; k < sizeof vectors / sizeof *vectors; k++)
        *vectors[k] = take(store, 1, n);
    group->D_off = take(store, n, n);
    group->D = take(store, n, n);
    for (size_t k = 0; k < KEPT_STEP_SIZES; k++) {
        CoupledPropagator *P = &group->kept[k];
        double **coefficients[] = {&P->E12, &P->N, &P->G0, &P->G1, &P->G2};
        for (size_t i = 0; i < sizeof coefficients / sizeof *coefficients; i++)
            *coefficients[i] = take(store, n, n);
        P->G3 = cubic ? take(store, n, n) : NULL;
    }
    for (size_t k = 0; k < COUPLED_SCRATCH; k++)
        group->scratch[k] = k < COUPLED_SCRATCH - 1 || cubic ? take(store, n, n) : NULL;
}

/* Hand out memory to everything. */
static void place_vectors(Instance *x, Store *store)
{
    const ReducedModel *model = x->model;
    size_t n = x->n, inputs = x->n_inputs, rows = x->feeds_through ? model->s : 0;
    double **modal[] = {&x->d,         &x->f[0],      &x->f[1],      &x->f[2],      &x->f[3],
                        &x->motion[0], &x->motion[1], &x->motion[2], &x->motion[3], &x->motion[4],
                        &x->next[0],   &x->next[1],   &x->seed[0],   &x->seed[1],   &x->seed[2]};
    double **of_inputs[] = {&x->u[0], &x->u[1], &x->u[2], &x->seed_u};
    for (size_t k = 0; k < sizeof modal / sizeof *modal; k++)
        *modal[k] = take(store, 1, n);
    for (size_t k = 0; k < sizeof of_inputs / sizeof *of_inputs; k++)
        *of_inputs[k] = take(store, 1, inputs);
    for (size_t k = 0; k < KEPT_STEP_SIZES; k++) {
        Propagator *P = &x->kept[k];
        double **coefficients[] = {&P->E11, &P->E12, &P->E21, &P->E22, &P->G0, &P->G1, &P->G2};
        for (size_t i = 0; i < sizeof coefficients / sizeof *coefficients; i++)
            *coefficients[i] = take(store, 1, n);
        P->G3 = model->k > 0 ? take(store, 1, n) : NULL;
    }
    x->N = take(store, model->k, n);
    x->start = take(store, 2, padded(model->k));
    x->B = take(store, model->m, n);
    x->C = take(store, model->s, n);
    x->R = take(store, rows, inputs);
    x->R_in = take(store, x->feeds_through ? model->m : 0, inputs);
    place_coupling(&x->coupling, store, model->k > 0);
    x->C_of = (double **)(void *)take(store, 1, padded(model->p)); /* nor does an address */
    x->R_of = (double **)(void *)take(store, 1, padded(model->p));
    x->through = (bool *)(void *)take(store, 1, padded(model->p));
}

static bool any_entry(const double *values, size_t count)
{
    for (size_t k = 0; k < count; k++)
        if (values[k] != 0.0)
            return true;
    return false;
}

/* The columns of B and the rows of C, padded with zeros; which rows are whose. */
static void copy_model(Instance *x)
{
    const ReducedModel *model = x->model;
    size_t n = model->n, m = model->m, row = 0;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < m; j++)
            x->B[j * x->n + i] = model->B[i * m + j];
    for (size_t k = 0; k < model->s; k++)
        memcpy(x->C + k * x->n, model->C + k * n, n * sizeof(double));
    x->rows_only = true;
    for (size_t k = 0; k < model->p; k++) {
        Law law = model->laws[k];
        x->C_of[k] = x->C + row * x->n;
        x->R_of[k] = x->feeds_through ? x->R + row * x->n_inputs : NULL;
        row += law_rows(law);
        if (law > ACCELERATION)
            x->rows_only = false;
        else if (law > x->highest_row)
            x->highest_row = law;
    }
}

Instance *new_instance(const ReducedModel *model, const Memory *memory)
{
    size_t m = model->m;
    Instance started = {.model = model, .layout = layout(model), .kernels = best_kernels()};
    started.active = SIZE_MAX; /* not known yet, so that the reset takes up even 0 modes */
    started.n = padded(model->n);
    started.n_inputs = padded(m);
    started.feeds_through =
        model->residual || any_entry(model->R, model->s * m) || any_entry(model->R_in, m * m);
    started.coupling.every = coupled_modes(model, NULL);
    Store store = {0};
    place_vectors(&started, &store);
    Instance *x = store.too_large ? NULL : memory->allocate(1, sizeof *x);
    void *block = x ? memory->allocate(1, store.used * sizeof(double) + ALIGNMENT) : NULL;
    if (!block) {
        if (x)
            memory->release(x);
        return NULL;
    }
    store = (Store){.block = (double *)(((uintptr_t)block + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT)};
    *x = started;
    x->block = block;
    place_vectors(x, &store);
    copy_model(x);
    coupled_modes(model, x->coupling.every_mode);
    reset_instance(x);
    return x;
}

void free_instance(Instance *x, const Memory *memory)
{
    memory->release(x->block);
    memory->release(x);
}
