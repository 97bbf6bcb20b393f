/* undamped GUID LOCATION MODES AMPLITUDE STEPS SAVES RESTORE PLAN H...: free modes, step after step.
 *
 * AMPLITUDE is the reference of modes.amplitude[1]; each mode starts from q = 1, q' = 0. PLAN: "held" steps
 * of the first H, "grid" steps from k H to (k+1) H as masters form them, "drawn" steps of any H at random.
 * SAVES times the state is saved, a force and two steps disturb the modes, and if RESTORE is 1 the state is
 * set again, by turns as it is and through its bytes.
 *
 * Prints "size H COUNT" for each size of step, "motion K q... q'..." after 10, 100, ... and all steps, and
 * what the memory did between a tenth of the steps and their end. */
#include "counting_host.h"

#define SIZES 1000

static double sizes[SIZES];
static unsigned long counts[SIZES];
static size_t sizes_count, last;

static void count_size(double h)
{
    if (sizes_count == 0 || sizes[last] != h)
        for (last = 0; last < sizes_count && sizes[last] != h;)
            last++;
    if (last == SIZES)
        exit(5);
    if (last == sizes_count)
        sizes[sizes_count++] = h;
    counts[last]++;
}

/* Away from the state and back. */
static void save_and_restore(fmi2Component c, double t, double h, int by_bytes, int restore)
{
    static const fmi2ValueReference force = 0;
    static const double one = 1.0;
    fmi2FMUstate state = NULL;
    size_t size = 0;
    must(fmi2GetFMUstate(c, &state), "fmi2GetFMUstate");
    char *saved = serialised(c, &size);
    must(fmi2SetReal(c, &force, 1, &one), "fmi2SetReal");
    must(fmi2DoStep(c, t, h, fmi2True), "fmi2DoStep");
    must(fmi2DoStep(c, t + h, 0.75 * h, fmi2True), "fmi2DoStep");
    if (restore && by_bytes)
        resume(c, saved, size);
    else if (restore)
        must(fmi2SetFMUstate(c, state), "fmi2SetFMUstate");
    must(fmi2FreeFMUstate(c, &state), "fmi2FreeFMUstate");
    free(saved);
}

static void print_motion(fmi2Component c, unsigned long k, unsigned int modes, const unsigned int *places)
{
    double *x = room(2 * modes, sizeof *x);
    must(fmi2GetReal(c, places, 2 * modes, x), "fmi2GetReal");
    printf("motion %lu", k);
    for (unsigned int i = 0; i < 2 * modes; i++)
        printf(" %a", x[i]);
    printf("\n");
    fflush(stdout);
    free(x);
}

int main(int argument_count, char **given)
{
    if (argument_count < 10)
        return 1;
    const unsigned int modes = (unsigned int)atoi(given[3]), amplitude = (unsigned int)atoi(given[4]);
    const unsigned long steps = strtoul(given[5], NULL, 10), saves = strtoul(given[6], NULL, 10);
    const int restore = atoi(given[7]), plan = given[8][0], plans = argument_count - 9;
    double *h = room((size_t)plans, sizeof *h), t = 0.0;
    for (int k = 0; k < plans; k++)
        h[k] = strtod(given[9 + k], NULL);
    unsigned int *places = room(2 * modes, sizeof *places); /* of q and q' */
    for (unsigned int i = 0; i < 2 * modes; i++)
        places[i] = amplitude + i;
    fmi2Component c = initialising(given[1], given[2]);
    for (unsigned int i = 0; i < modes; i++)
        must(fmi2SetReal(c, places + i, 1, &(double){1.0}), "fmi2SetReal");
    must(fmi2ExitInitializationMode(c), "fmi2ExitInitializationMode");
    const unsigned long every = saves ? (steps + saves - 1) / saves : 1;
    uint64_t random = 1;
    long memory = resident(), taken = 0, held = 0;
    for (unsigned long k = 0, decade = 10, saved = 0; k < steps;) {
        double size = h[0];
        if (plan == 'd')
            size = h[drawn(&random) % (unsigned int)plans];
        if (plan == 'g') {
            t = (double)k * h[0];
            double next = (double)(k + 1) * h[0]; /* rounded: in one expression it would be fused */
            size = next - t;
        }
        if (saves && k % every == every / 2)
            save_and_restore(c, t, size, (int)(saved++ % 2), restore);
        must(fmi2DoStep(c, t, size, fmi2True), "fmi2DoStep");
        count_size(size);
        t += size;
        if (k == steps / 10)
            memory = resident(), taken = calls, held = bytes;
        if (++k == decade || k == steps)
            print_motion(c, k, modes, places), decade *= 10;
    }
    printf("resident %ld\nallocations %ld\nbytes %ld\n", resident() - memory, calls - taken, bytes - held);
    for (size_t k = 0; k < sizes_count; k++)
        printf("size %a %lu\n", sizes[k], counts[k]);
    fmi2FreeInstance(c);
    printf("left %ld\n", blocks);
    free(places);
    free(h);
    return 0;
}
