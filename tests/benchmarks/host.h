/* What the drivers share: an FMU's library loaded as a host loads it, the clock, and medians. */
#ifndef HOST_H
#define HOST_H

#define _POSIX_C_SOURCE 200809L

#include "fmi2FunctionTypes.h"

#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct {
    fmi2InstantiateTYPE *instantiate;
    fmi2FreeInstanceTYPE *release;
    fmi2SetupExperimentTYPE *setup;
    fmi2EnterInitializationModeTYPE *enter;
    fmi2ExitInitializationModeTYPE *leave;
    fmi2SetRealTYPE *set;
    fmi2SetRealInputDerivativesTYPE *set_rates;
    fmi2GetRealTYPE *get;
    fmi2DoStepTYPE *step;
} Fmu;

static inline void *required(void *found, const char *what)
{
    if (!found) {
        fprintf(stderr, "%s: not there\n", what);
        exit(2);
    }
    return found;
}

static inline void require_ok(fmi2Status status, const char *what)
{
    if (status != fmi2OK) {
        fprintf(stderr, "%s: status %d\n", what, (int)status);
        exit(3);
    }
}

static inline void find(void *library, const char *name, void *function)
{
    void *address = required(dlsym(library, name), name);
    memcpy(function, &address, sizeof address); /* C has no conversion from an object's pointer */
}

static inline Fmu load_fmu(const char *path)
{
    void *library = required(dlopen(path, RTLD_NOW | RTLD_LOCAL), path);
    Fmu fmu;
    find(library, "fmi2Instantiate", &fmu.instantiate);
    find(library, "fmi2FreeInstance", &fmu.release);
    find(library, "fmi2SetupExperiment", &fmu.setup);
    find(library, "fmi2EnterInitializationMode", &fmu.enter);
    find(library, "fmi2ExitInitializationMode", &fmu.leave);
    find(library, "fmi2SetReal", &fmu.set);
    find(library, "fmi2SetRealInputDerivatives", &fmu.set_rates);
    find(library, "fmi2GetReal", &fmu.get);
    find(library, "fmi2DoStep", &fmu.step);
    return fmu;
}

static inline void log_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                               fmi2String category, fmi2String format, ...)
{
    (void)environment;
    (void)status;
    va_list arguments;
    va_start(arguments, format);
    fprintf(stderr, "%s, %s: ", name, category);
    vfprintf(stderr, format, arguments);
    fprintf(stderr, "\n");
    va_end(arguments);
}

static const fmi2CallbackFunctions callbacks = {log_message, calloc, free, NULL, NULL};

/* An instance in co-simulation, ready to step from t = 0. */
static inline fmi2Component started(const Fmu *fmu, const char *guid, const char *location)
{
    fmi2Component c =
        fmu->instantiate("one", fmi2CoSimulation, guid, location, &callbacks, fmi2False, fmi2False);
    required(c, "an instance");
    require_ok(fmu->setup(c, fmi2False, 0.0, 0.0, fmi2False, 0.0), "fmi2SetupExperiment");
    require_ok(fmu->enter(c), "fmi2EnterInitializationMode");
    require_ok(fmu->leave(c), "fmi2ExitInitializationMode");
    return c;
}

/* Zeroed memory at the start of a cache line. */
static inline void *lines_of_memory(size_t count, size_t size)
{
    size_t bytes = (count * size + 63) / 64 * 64;
    void *memory = required(aligned_alloc(64, bytes ? bytes : 64), "memory");
    return memset(memory, 0, bytes);
}

static inline double nanoseconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static inline int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The value below which this part of the values lies; sorts them. */
static inline double quantile(double *values, size_t count, double part)
{
    qsort(values, count, sizeof *values, ascending);
    return values[(size_t)(part * (double)(count - 1))];
}

static inline double median(double *values, size_t count)
{
    return quantile(values, count, 0.5);
}

#endif
