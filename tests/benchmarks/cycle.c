/* cycle LIBRARY GUID LOCATION FOLDER READ BATCHES: time of set + step + get, and of the bare loops.
 *
 * The bare work is B u, the update of q and v, and C q by the same kernels on the same numbers, with nothing
 * around them. The inputs change at every step, the first READ outputs are read. Both advance by turns, in
 * small batches of CYCLES; what is printed are medians in ns per cycle, and the largest difference of the two
 * results. */
#include "host.h"

#include "instance.h"
#include "resources.h"

#include <math.h>

#define CYCLES 20
#define PATTERNS 16 /* of the inputs, one after the other */
#define H 1e-3      /* s */

typedef struct {
    size_t n, m, read;
    double *B, *C, *f, *q[2], *v[2], *y;
    const Law *laws;
    double **rows; /* of C: each output of the parts here has one */
    Propagator P;
    const Kernels *kernels;
} Bare;

static Bare bare_work(const ReducedModel *model, size_t read)
{
    size_t r = model->r, m = model->m, n = (r + LANES - 1) / LANES * LANES;
    Bare x = {.n = n, .m = m, .read = read, .laws = model->laws, .kernels = best_kernels()};
    double **vectors[] = {&x.f,     &x.q[0],  &x.q[1],  &x.v[0], &x.v[1], &x.P.E11,
                          &x.P.E12, &x.P.E21, &x.P.E22, &x.P.G0, &x.P.G1, &x.P.G2};
    for (size_t k = 0; k < sizeof vectors / sizeof *vectors; k++)
        *vectors[k] = lines_of_memory(n, sizeof(double));
    x.y = lines_of_memory(read, sizeof(double));
    x.rows = lines_of_memory(model->p, sizeof *x.rows);
    x.B = lines_of_memory(m * n, sizeof(double));
    x.C = lines_of_memory(model->p * n, sizeof(double));
    for (size_t k = 0; k < model->p; k++)
        x.rows[k] = x.C + k * n;
    double *d = lines_of_memory(r, sizeof(double));
    for (size_t i = 0; i < r; i++) {
        d[i] = model->alpha + model->beta * model->lam[i] + model->D_rest[i * r + i];
        for (size_t j = 0; j < m; j++)
            x.B[j * n + i] = model->B[i * m + j];
        for (size_t row = 0; row < model->p; row++)
            x.C[row * n + i] = model->C[row * r + i];
    }
    propagator(&x.P, model->lam, d, r, H);
    free(d);
    return x;
}

static void bare_cycle(Bare *x, const double *u, const unsigned int *references)
{
    memset(x->f, 0, x->n * sizeof(double));
    for (size_t j = 0; j < x->m; j++)
        x->kernels->add(x->f, x->B + j * x->n, u[j], x->n);
    double size = x->kernels->step_held(&x->P, x->q[0], x->v[0], x->f, x->q[1], x->v[1], x->n);
    if (!isfinite(size))
        exit(4);
    double *q = x->q[0], *v = x->v[0];
    x->q[0] = x->q[1], x->v[0] = x->v[1];
    x->q[1] = q, x->v[1] = v;
    Outputs rows = {x->rows, x->n, x->laws, (double *const[]){x->q[0], x->v[0]}};
    x->kernels->outputs(&rows, 0, references, (unsigned int)x->m, x->read, x->y);
}

int main(int count, char **given)
{
    if (count != 7)
        return 1;
    const Fmu fmu = load_fmu(given[1]);
    const size_t read = strtoul(given[5], NULL, 10), batches = strtoul(given[6], NULL, 10);
    const Memory memory = {calloc, free};
    const Files files = files_of_folder(given[4]);
    Reason reason;
    const ReducedModel *model = required((void *)read_model(&files, &memory, &reason), given[4]);
    size_t m = model->m;
    Bare bare = bare_work(model, read);
    fmi2Component c = started(&fmu, given[2], given[3]);
    fmi2ValueReference *references = lines_of_memory(m + read, sizeof *references);
    for (size_t k = 0; k < m + read; k++)
        references[k] = (fmi2ValueReference)k;
    double *u = lines_of_memory(PATTERNS * m, sizeof *u), *y = lines_of_memory(read, sizeof *y);
    for (size_t k = 0; k < PATTERNS * m; k++)
        u[k] = sin(1.0 + (double)k);
    double *times[3], difference = 0.0;
    for (size_t k = 0; k < 3; k++)
        times[k] = lines_of_memory(batches, sizeof(double));
    double t = 0.0;
    for (size_t batch = 0, step = 0; batch < batches; batch++) {
        double start = nanoseconds();
        fmi2Status status = fmi2OK;
        for (size_t k = 0; k < CYCLES; k++, t += H) {
            status |= fmu.set(c, references, m, u + (step + k) % PATTERNS * m);
            status |= fmu.step(c, t, H, fmi2True);
            status |= fmu.get(c, references + m, read, y);
        }
        double between = nanoseconds();
        for (size_t k = 0; k < CYCLES; k++)
            bare_cycle(&bare, u + (step + k) % PATTERNS * m, references + m);
        double end = nanoseconds();
        require_ok(status, "a cycle");
        step += CYCLES;
        times[0][batch] = (between - start) / CYCLES;
        times[1][batch] = (end - between) / CYCLES;
        times[2][batch] = times[0][batch] / times[1][batch];
        for (size_t k = 0; k < read; k++)
            difference = fmax(difference, fabs(y[k] - bare.y[k]));
    }
    printf("fmu %.17g\nbare %.17g\nratio %.17g\ndifference %.17g\n", median(times[0], batches),
           median(times[1], batches), median(times[2], batches), difference);
    fmu.release(c);
    return 0;
}
