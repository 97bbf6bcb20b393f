/* lives GUID LOCATION MODES INPUTS OUTPUTS COUNT THREADS: so many random lives of instances, one after the
 * other in each thread. Wrong calls, damaged states and failing memory among the right ones: all follow from
 * its number.
 *
 * Prints a sum of all that was seen, the same for any number of threads; fails where memory is not given
 * back. */
#include "fmi2Functions.h"

#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ROUNDS 60
#define SLOTS 3
#define MOST 64 /* numbers in any array */

typedef struct {
    const char *guid, *location;
    unsigned int modes, inputs, outputs;
    unsigned int first, beyond; /* seeds */
    uint64_t seen;
    unsigned long calls, refusals, failed;
    pthread_t thread;
} Work;

typedef struct {
    Work *work;
    fmi2Component c;
    fmi2Type type;
    uint64_t random, seen;
    double time;
    fmi2FMUstate states[SLOTS];
    double times[SLOTS];
} Life;

static atomic_long blocks;
static _Thread_local unsigned long allowed;

static void *allocate(size_t count, size_t size)
{
    if (allowed == 0)
        return NULL;
    allowed--;
    void *block = calloc(count, size);
    blocks += block != NULL;
    return block;
}

static void release(void *block)
{
    blocks -= block != NULL;
    free(block);
}

static void log_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                        fmi2String category, fmi2String format, ...)
{
    char text[1000];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    ((Work *)environment)->refusals += status != fmi2OK && strlen(text) > 0 && name && category;
}

/* xorshift64* of Marsaglia and Vigna */
static unsigned int any(Life *life, unsigned int below)
{
    life->random ^= life->random >> 12;
    life->random ^= life->random << 25;
    life->random ^= life->random >> 27;
    return (unsigned int)((life->random * 0x2545F4914F6CDD1Du) >> 33) % below;
}

static double number(Life *life)
{
    static const double rare[] = {0.0, 1e308, -1e308, 1e-308};
    return any(life, 50) == 0 ? rare[any(life, 4)] : ((int)any(life, 2001) - 1000) / 100.0;
}

static void see(Life *life, fmi2Status status, const double *values, size_t count)
{
    life->work->calls++;
    life->seen = life->seen * 31 + (uint64_t)status;
    for (size_t k = 0; status == fmi2OK && k < count; k++) {
        uint64_t bits;
        memcpy(&bits, &values[k], sizeof bits);
        life->seen = life->seen * 31 + bits;
    }
}

static void use_variables(Life *life)
{
    fmi2Component c = life->c;
    unsigned int m = life->work->inputs, p = life->work->outputs, reals = m + p + 2 + 6 * life->work->modes;
    fmi2ValueReference places[MOST];
    fmi2Integer orders[MOST];
    double values[MOST];
    size_t count = any(life, m + 1);
    for (unsigned int k = 0; k < MOST; k++) {
        places[k] = any(life, 40) == 0 ? any(life, 2 * reals) : any(life, m);
        values[k] = number(life);
        orders[k] = 1 + (int)any(life, any(life, 20) ? 2 : 4);
    }
    switch (any(life, 8)) {
    case 0:
        see(life, fmi2SetRealInputDerivatives(c, places, count, orders, values), NULL, 0);
        break;
    case 1:
        for (unsigned int k = 0; k < p; k++)
            places[k] = m + k;
        see(life, fmi2GetRealOutputDerivatives(c, places, p, orders, values), values, p);
        break;
    case 2:
        places[0] = m + p + any(life, 2); /* damping */
        values[0] = number(life) * number(life) / 100.0;
        see(life, fmi2SetReal(c, places, 1, values), NULL, 0);
        break;
    case 3:
        orders[0] = (int)any(life, life->work->modes + 2);
        places[0] = 0;
        see(life, fmi2SetInteger(c, places, 1, orders), NULL, 0);
        see(life, fmi2GetInteger(c, places, 1, orders), NULL, 0);
        break;
    case 4: {
        fmi2ValueReference unknowns[MOST];
        double changes[MOST];
        for (unsigned int k = 0; k < p; k++)
            unknowns[k] = m + k;
        see(life, fmi2GetDirectionalDerivative(c, unknowns, p, places, count, values, changes), changes, p);
        break;
    }
    case 5:
        for (unsigned int k = 0; k < MOST; k++)
            places[k] = any(life, reals);
        see(life, fmi2GetReal(c, places, MOST, values), values, MOST);
        break;
    default:
        see(life, fmi2SetReal(c, places, count, values), NULL, 0);
    }
}

static void use_states(Life *life)
{
    size_t slot = any(life, SLOTS), size = 0;
    switch (any(life, 5)) {
    case 0:
    case 1:
        see(life, fmi2GetFMUstate(life->c, &life->states[slot]), NULL, 0);
        life->times[slot] = life->time;
        break;
    case 2:
        see(life, fmi2SetFMUstate(life->c, life->states[slot]), NULL, 0);
        if (life->states[slot])
            life->time = life->times[slot];
        break;
    case 3:
        see(life, fmi2FreeFMUstate(life->c, &life->states[slot]), NULL, 0);
        break;
    default: {
        if (fmi2SerializedFMUstateSize(life->c, life->states[slot], &size) != fmi2OK)
            break;
        char *bytes = malloc(size);
        see(life, fmi2SerializeFMUstate(life->c, life->states[slot], bytes, size), NULL, 0);
        bytes[any(life, (unsigned int)size)] ^= (char)(any(life, 2) << any(life, 8));
        fmi2FMUstate copy = NULL;
        if (fmi2DeSerializeFMUstate(life->c, bytes, size, &copy) == fmi2OK) {
            see(life, fmi2SetFMUstate(life->c, copy), NULL, 0);
            fmi2FreeFMUstate(life->c, &copy);
        }
        free(bytes);
    }
    }
}

static void go_on(Life *life)
{
    fmi2Component c = life->c;
    fmi2EventInfo info;
    fmi2Boolean event, end;
    size_t states = 2 * life->work->modes;
    double x[MOST], h = any(life, 10) ? 0.01 * (1 + any(life, 20)) : number(life);
    for (size_t k = 0; k < states; k++)
        x[k] = number(life);
    if (life->type == fmi2CoSimulation || any(life, 40) == 0) {
        fmi2Status status = fmi2DoStep(c, life->time, h, fmi2True);
        see(life, status, NULL, 0);
        life->time += status == fmi2OK ? h : 0.0;
    } else {
        see(life, fmi2NewDiscreteStates(c, &info), NULL, 0);
        see(life, fmi2EnterContinuousTimeMode(c), NULL, 0);
        see(life, fmi2SetTime(c, life->time += 0.1), NULL, 0);
        see(life, fmi2SetContinuousStates(c, x, states), NULL, 0);
        see(life, fmi2GetDerivatives(c, x, states), x, states);
        see(life, fmi2CompletedIntegratorStep(c, fmi2True, &event, &end), NULL, 0);
        if (any(life, 2))
            see(life, fmi2EnterEventMode(c), NULL, 0);
    }
}

static void live(Work *work, unsigned int seed)
{
    fmi2CallbackFunctions callbacks = {log_message, allocate, release, NULL, work};
    Life life = {.work = work,
                 .type = seed % 2 ? fmi2CoSimulation : fmi2ModelExchange,
                 .random = seed * UINT64_C(2654435761) + 1};
    allowed = any(&life, 8) ? ~0ul : any(&life, 30);
    const char *guid = any(&life, 16) ? work->guid : "another";
    life.c =
        fmi2Instantiate("life", life.type, guid, work->location, &callbacks, fmi2False, any(&life, 2) != 0);
    if (!life.c) {
        work->failed++;
        return;
    }
    for (int round = 0; round < ROUNDS; round++)
        switch (any(&life, 20)) {
        case 0:
            see(&life, fmi2SetupExperiment(life.c, fmi2False, 0.0, life.time, fmi2False, 0.0), NULL, 0);
            break;
        case 1:
            see(&life, fmi2ExitInitializationMode(life.c), NULL, 0);
            break;
        case 2:
            see(&life, any(&life, 10) ? fmi2OK : fmi2Terminate(life.c), NULL, 0);
            break;
        case 3:
            if (any(&life, 10) == 0) {
                see(&life, fmi2Reset(life.c), NULL, 0);
                life.time = 0.0;
            }
            break;
        case 4:
        case 5:
        case 6:
            see(&life, fmi2EnterInitializationMode(life.c), NULL, 0);
            break;
        case 7:
        case 8:
            use_states(&life);
            break;
        case 9:
        case 10:
        case 11:
            go_on(&life);
            break;
        default:
            use_variables(&life);
        }
    for (size_t slot = 0; slot < SLOTS; slot++)
        fmi2FreeFMUstate(life.c, &life.states[slot]);
    fmi2FreeInstance(life.c);
    work->seen += life.seen;
}

static void *work_on(void *given)
{
    Work *work = given;
    for (unsigned int seed = work->first; seed < work->beyond; seed++)
        live(work, seed);
    return NULL;
}

int main(int count, char **given)
{
    if (count != 8)
        return 2;
    unsigned int lives = (unsigned int)atoi(given[6]), threads = (unsigned int)atoi(given[7]);
    Work *all = calloc(threads, sizeof *all);
    if (!all)
        return 3;
    uint64_t seen = 0;
    unsigned long calls = 0, refusals = 0, failed = 0;
    for (unsigned int k = 0; k < threads; k++) {
        all[k] = (Work){.guid = given[1],
                        .location = given[2],
                        .modes = (unsigned int)atoi(given[3]),
                        .inputs = (unsigned int)atoi(given[4]),
                        .outputs = (unsigned int)atoi(given[5]),
                        .first = lives / threads * k,
                        .beyond = lives / threads * (k + 1)};
        if (2 * all[k].modes > MOST || all[k].inputs > MOST || all[k].outputs > MOST)
            return 4;
        if (pthread_create(&all[k].thread, NULL, work_on, &all[k]) != 0)
            return 5;
    }
    for (unsigned int k = 0; k < threads; k++) {
        pthread_join(all[k].thread, NULL);
        seen += all[k].seen;
        calls += all[k].calls;
        refusals += all[k].refusals;
        failed += all[k].failed;
    }
    free(all);
    printf("%u lives, %lu without an instance, %lu calls, %lu messages of refusal, %ld blocks left, seen "
           "%016llx\n",
           lives / threads * threads, failed, calls, refusals, (long)blocks, (unsigned long long)seen);
    return blocks == 0 ? 0 : 6;
}
