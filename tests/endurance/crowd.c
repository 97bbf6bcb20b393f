/* crowd GUID LOCATION INPUTS REALS COUNT STEPS THREADS HOW: many instances, each with inputs and steps of its
 * own that follow from its number; thread k owns every instance whose number is k modulo THREADS.
 *
 * HOW: "turns" for all of a thread's instances at once, which step in turn; "alone" for one after the other;
 * "shared", which FMI forbids, for threads that set an input of an instance that the first one steps.
 * Prints "seen" with what each saw, the same however they live, and what they take in memory together. */
#include "counting_host.h"

#include <pthread.h>

typedef struct {
    fmi2Component c;
    uint64_t random, seen;
    double t;
} One;

typedef struct {
    const char *guid, *location;
    unsigned int inputs, reals, first, stride, count;
    int steps;
    fmi2ValueReference *references;
    One *all;
    pthread_t thread;
} Work;

/* All threads meet before the first step and after the last one; at one barrier for both a thread that wakes
 * late would be taken to follow those that are at its end already. */
static pthread_barrier_t begun, ended;

static void begin(const Work *work, unsigned int number)
{
    One *one = &work->all[number];
    *one = (One){.c = started(work->guid, work->location), .random = number * UINT64_C(2654435761) + 1};
}

/* Inputs, at times their rates, damping or a state saved and set; a step; all Reals. */
static void step(const Work *work, One *one)
{
    enum { MOST = 128 };
    static const double sizes[] = {0.001, 0.0125, 0.02, 0.3, 0.0625};
    static const fmi2Integer first[MOST] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
    double values[MOST], h = sizes[drawn(&one->random) % 5];
    if (work->reals > MOST || work->inputs > 10)
        exit(5);
    for (unsigned int j = 0; j < work->inputs; j++)
        values[j] = ((double)drawn(&one->random) - 0x1p30) * 0x1p-30;
    must(fmi2SetReal(one->c, work->references, work->inputs, values), "fmi2SetReal");
    if (drawn(&one->random) % 3 == 0)
        must(fmi2SetRealInputDerivatives(one->c, work->references, work->inputs, first, values),
             "fmi2SetRealInputDerivatives");
    if (drawn(&one->random) % 8 == 0) {
        size_t size;
        char *saved = serialised(one->c, &size);
        must(fmi2DoStep(one->c, one->t, 0.7 * h, fmi2True), "fmi2DoStep");
        resume(one->c, saved, size);
        free(saved);
    }
    must(fmi2DoStep(one->c, one->t, h, fmi2True), "fmi2DoStep");
    one->t += h;
    must(fmi2GetReal(one->c, work->references, work->reals, values), "fmi2GetReal");
    see(&one->seen, values, work->reals);
}

static void *in_turns(void *given)
{
    const Work *work = given;
    for (unsigned int i = work->first; i < work->count; i += work->stride)
        begin(work, i);
    pthread_barrier_wait(&begun);
    for (int k = 0; k < work->steps; k++)
        for (unsigned int i = work->first; i < work->count; i += work->stride)
            step(work, &work->all[i]);
    pthread_barrier_wait(&ended);
    for (unsigned int i = work->first; i < work->count; i += work->stride)
        fmi2FreeInstance(work->all[i].c);
    return NULL;
}

static void *alone(void *given)
{
    const Work *work = given;
    pthread_barrier_wait(&begun);
    for (unsigned int i = work->first; i < work->count; i += work->stride) {
        begin(work, i);
        for (int k = 0; k < work->steps; k++)
            step(work, &work->all[i]);
        fmi2FreeInstance(work->all[i].c);
    }
    pthread_barrier_wait(&ended);
    return NULL;
}

/* Into the first instance of the first thread. */
static void *intruding(void *given)
{
    const Work *work = given;
    pthread_barrier_wait(&begun);
    for (int k = 0; k < work->steps; k++)
        fmi2SetReal(work->all[0].c, work->references, 1, &(double){k});
    pthread_barrier_wait(&ended);
    return NULL;
}

int main(int argument_count, char **given)
{
    if (argument_count != 9)
        return 1;
    const unsigned int instances = (unsigned int)atoi(given[5]), threads = (unsigned int)atoi(given[7]);
    const unsigned int reals = (unsigned int)atoi(given[4]);
    void *(*const life)(void *) = given[8][0] == 'a' ? alone : in_turns;
    void *(*const other)(void *) = given[8][0] == 's' ? intruding : life;
    Work *all = room(threads, sizeof *all);
    One *ones = room(instances, sizeof *ones);
    fmi2ValueReference *references = room(reals, sizeof *references);
    for (unsigned int i = 0; i < reals; i++)
        references[i] = i;
    pthread_barrier_init(&begun, NULL, threads + 1);
    pthread_barrier_init(&ended, NULL, threads + 1);
    const long before = resident();
    for (unsigned int k = 0; k < threads; k++) {
        all[k] = (Work){.guid = given[1],
                        .location = given[2],
                        .inputs = (unsigned int)atoi(given[3]),
                        .reals = reals,
                        .first = k,
                        .stride = threads,
                        .count = instances,
                        .steps = atoi(given[6]),
                        .references = references,
                        .all = ones};
        if (pthread_create(&all[k].thread, NULL, k == 0 ? life : other, &all[k]) != 0)
            return 6;
    }
    pthread_barrier_wait(&begun);
    const long held = bytes, made = blocks;
    pthread_barrier_wait(&ended);
    const long after = resident();
    for (unsigned int k = 0; k < threads; k++)
        pthread_join(all[k].thread, NULL);
    printf("seen");
    for (unsigned int i = 0; i < instances; i++)
        printf(" %016llx", (unsigned long long)ones[i].seen);
    printf("\nblocks %ld\nbytes %ld\nresident %ld\nleft %ld\n", made, held, after - before, blocks);
    free(all);
    free(ones);
    free(references);
    return 0;
}
