/* oscillators LIBRARY GUID LOCATION FOLDER METHOD OMEGA SAMPLES STEPS: the response to sin(OMEGA t), 1 s from
 * rest.
 *
 * The force acts on input 0; output 0 is printed at SAMPLES equal times, STEPS steps between two of them,
 * then the time of all steps in ns (the fastest of REPEATS). METHOD newmark: average acceleration on every
 * oscillator, q1 = q + h v + h2/4 (a + a1), v1 = v + h/2 (a + a1), in plain loops of the compiler; fmu: the
 * FMU's step with the first two derivatives of the force. */
#include "host.h"

#include "resources.h"

#include <math.h>

#define REPEATS 5

typedef struct {
    const ReducedModel *model;
    double omega;
    size_t samples, steps;
} Task;

static double newmark(const Task *task, double *y)
{
    const ReducedModel *model = task->model;
    size_t r = model->r;
    double *restrict q = lines_of_memory(r, sizeof *q), *restrict v = lines_of_memory(r, sizeof *v);
    double *restrict a = lines_of_memory(r, sizeof *a), *restrict d = lines_of_memory(r, sizeof *d);
    double *restrict b = lines_of_memory(r, sizeof *b), *restrict inverse =
                                                            lines_of_memory(r, sizeof *inverse);
    const double *restrict lam = model->lam;
    double h = 1.0 / (double)(task->samples * task->steps), start = nanoseconds();
    for (size_t i = 0; i < r; i++) {
        d[i] = model->alpha + model->beta * lam[i] + model->D_rest[i * r + i];
        b[i] = model->B[i * model->m];
        inverse[i] = 1.0 / (1.0 + 0.5 * h * d[i] + 0.25 * h * h * lam[i]);
    }
    for (size_t k = 0, number = 1; k < task->samples; k++) {
        for (size_t step = 0; step < task->steps; step++, number++) {
            double u = sin(task->omega * h * (double)number);
            for (size_t i = 0; i < r; i++) {
                double v_half = v[i] + 0.5 * h * a[i], q_free = q[i] + 0.5 * h * (v[i] + v_half);
                a[i] = (b[i] * u - d[i] * v_half - lam[i] * q_free) * inverse[i];
                q[i] = q_free + 0.25 * h * h * a[i];
                v[i] = v_half + 0.5 * h * a[i];
            }
        }
        y[k] = 0.0;
        for (size_t i = 0; i < r; i++)
            y[k] += model->C[i] * q[i];
    }
    double taken = nanoseconds() - start;
    double *vectors[] = {q, v, a, d, b, inverse};
    for (size_t k = 0; k < 6; k++)
        free(vectors[k]);
    return taken;
}

static double stepped(const Task *task, const Fmu *fmu, char **given, double *y)
{
    static const fmi2ValueReference input[] = {0, 0};
    static const fmi2Integer orders[] = {1, 2};
    fmi2ValueReference output = (fmi2ValueReference)task->model->m;
    fmi2Component c = started(fmu, given[2], given[3]);
    double w = task->omega, h = 1.0 / (double)(task->samples * task->steps), start = nanoseconds();
    fmi2Status status = fmi2OK;
    for (size_t k = 0, number = 0; k < task->samples; k++) {
        for (size_t step = 0; step < task->steps; step++, number++) {
            double t = h * (double)number, u = sin(w * t), rates[] = {w * cos(w * t), -w * w * u};
            status |= fmu->set(c, input, 1, &u);
            status |= fmu->set_rates(c, input, 2, orders, rates);
            status |= fmu->step(c, t, h, fmi2True);
        }
        status |= fmu->get(c, &output, 1, &y[k]);
    }
    double taken = nanoseconds() - start;
    require_ok(status, "a step");
    fmu->release(c);
    return taken;
}

int main(int count, char **given)
{
    if (count != 9)
        return 1;
    const Fmu fmu = load_fmu(given[1]);
    const Memory memory = {calloc, free};
    const Files files = files_of_folder(given[4]);
    Reason reason;
    const ReducedModel *model = required((void *)read_model(&files, &memory, &reason), given[4]);
    Task task = {model, strtod(given[6], NULL), strtoul(given[7], NULL, 10), strtoul(given[8], NULL, 10)};
    double *y = lines_of_memory(task.samples, sizeof *y), fastest = INFINITY;
    for (int k = 0; k < REPEATS; k++)
        fastest = fmin(fastest,
                       strcmp(given[5], "newmark") == 0 ? newmark(&task, y) : stepped(&task, &fmu, given, y));
    for (size_t k = 0; k < task.samples; k++)
        printf("y%zu %.17g\n", k, y[k]);
    printf("time %.17g\n", fastest);
    return 0;
}
