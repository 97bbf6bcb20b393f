/* steps LIBRARY GUID LOCATION INPUTS STEPS LOADS: fmi2DoStep one by one, with a new step size, and loading.
 *
 * Prints ns: median, p99.9 and maximum of STEPS steps of one size with the clock's own cost in them, that
 * cost, the median of a step whose size was never seen, and the median of LOADS calls of fmi2Instantiate. */
#include "host.h"

#include <math.h>

#define H 1e-3   /* s */
#define NEW 2000 /* steps of new sizes */

int main(int count, char **given)
{
    if (count != 7)
        return 1;
    const Fmu fmu = load_fmu(given[1]);
    const size_t m = strtoul(given[4], NULL, 10), steps = strtoul(given[5], NULL, 10);
    const size_t loads = strtoul(given[6], NULL, 10), most = steps > NEW ? steps : NEW;
    double *times = lines_of_memory(most > loads ? most : loads, sizeof *times);
    double *u = lines_of_memory(m, sizeof *u), t = 0.0;
    fmi2ValueReference *references = lines_of_memory(m, sizeof *references);
    fmi2Component c = started(&fmu, given[2], given[3]);
    for (size_t j = 0; j < m; j++)
        references[j] = (fmi2ValueReference)j;
    fmi2Status status = fmi2OK;
    for (size_t k = 0; k < steps; k++, t += H) {
        for (size_t j = 0; j < m; j++)
            u[j] = sin((double)(k + j));
        status |= fmu.set(c, references, m, u);
        double start = nanoseconds();
        status |= fmu.step(c, t, H, fmi2True);
        times[k] = nanoseconds() - start;
    }
    printf("median %.17g\n", median(times, steps)); /* sorted from here on */
    printf("p999 %.17g\nmaximum %.17g\n", quantile(times, steps, 0.999), times[steps - 1]);
    for (size_t k = 0; k < NEW; k++) {
        double start = nanoseconds();
        times[k] = nanoseconds() - start;
    }
    printf("clock %.17g\n", median(times, NEW));
    for (size_t k = 0; k < NEW; k++) {
        double h = H * (1.0 + 1e-6 * (double)(k + 1)), start = nanoseconds();
        status |= fmu.step(c, t, h, fmi2True);
        times[k] = nanoseconds() - start;
        t += h;
    }
    printf("new %.17g\n", median(times, NEW));
    require_ok(status, "a step");
    fmu.release(c);
    for (size_t k = 0; k < loads; k++) {
        double start = nanoseconds();
        c = fmu.instantiate("one", fmi2CoSimulation, given[2], given[3], &callbacks, fmi2False, fmi2False);
        times[k] = nanoseconds() - start;
        fmu.release(required(c, "an instance"));
    }
    printf("load %.17g\n", median(times, loads));
    return 0;
}
