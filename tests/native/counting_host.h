/* What the programs share: a host that counts the memory it gives, and an instance that is ready to step. */
#ifndef COUNTING_HOST_H
#define COUNTING_HOST_H

#define _POSIX_C_SOURCE 200809L

#include "fmi2Functions.h"

#include <stdarg.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define HEAD 16 /* bytes before a block: its size, and the alignment of calloc kept */

static atomic_long calls, blocks, bytes; /* calls of the allocator; what is out */

/* Without an order, which would hide from ThreadSanitizer what is not in order otherwise. */
static inline void count(long one, long all)
{
    atomic_fetch_add_explicit(&blocks, one, memory_order_relaxed);
    atomic_fetch_add_explicit(&bytes, all, memory_order_relaxed);
}

static inline void *allocate(size_t number, size_t size)
{
    size_t all = number * size;
    char *block = calloc(1, HEAD + all);
    if (!block)
        return NULL;
    memcpy(block, &all, sizeof all);
    atomic_fetch_add_explicit(&calls, 1, memory_order_relaxed);
    count(1, (long)all);
    return block + HEAD;
}

static inline void release(void *given)
{
    if (!given)
        return;
    char *block = (char *)given - HEAD;
    size_t all;
    memcpy(&all, block, sizeof all);
    count(-1, -(long)all);
    free(block);
}

/* kB of this process in memory. */
static inline long resident(void)
{
    long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file || fscanf(file, "%*s %ld", &pages) != 1)
        pages = 0;
    if (file)
        fclose(file);
    return pages * (sysconf(_SC_PAGESIZE) / 1024);
}

static inline void log_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                               fmi2String category, fmi2String format, ...)
{
    (void)environment;
    va_list arguments;
    va_start(arguments, format);
    fprintf(stderr, "%s, %s, %d: ", name, category, (int)status);
    vfprintf(stderr, format, arguments);
    fprintf(stderr, "\n");
    va_end(arguments);
}

static inline void must(fmi2Status status, const char *what)
{
    if (status != fmi2OK) {
        fprintf(stderr, "%s: status %d\n", what, (int)status);
        exit(3);
    }
}

static inline void *room(size_t number, size_t size)
{
    void *found = calloc(number ? number : 1, size);
    if (!found)
        exit(4);
    return found;
}

/* An instance in co-simulation, in initialization mode. */
static inline fmi2Component initialising(const char *guid, const char *location)
{
    static const fmi2CallbackFunctions callbacks = {log_message, allocate, release, NULL, NULL};
    fmi2Component c =
        fmi2Instantiate("one", fmi2CoSimulation, guid, location, &callbacks, fmi2False, fmi2False);
    if (!c)
        exit(2);
    must(fmi2SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0), "fmi2SetupExperiment");
    must(fmi2EnterInitializationMode(c), "fmi2EnterInitializationMode");
    return c;
}

static inline fmi2Component started(const char *guid, const char *location)
{
    fmi2Component c = initialising(guid, location);
    must(fmi2ExitInitializationMode(c), "fmi2ExitInitializationMode");
    return c;
}

/* xorshift64* of Marsaglia and Vigna */
static inline uint64_t drawn(uint64_t *random)
{
    *random ^= *random >> 12;
    *random ^= *random << 25;
    *random ^= *random >> 27;
    return (*random * UINT64_C(0x2545F4914F6CDD1D)) >> 33;
}

/* Numbers into one that changes with the last bit of each. */
static inline void see(uint64_t *seen, const double *values, size_t number)
{
    for (size_t k = 0; k < number; k++) {
        uint64_t bits;
        memcpy(&bits, &values[k], sizeof bits);
        *seen = (*seen ^ bits) * UINT64_C(0x9E3779B97F4A7C15);
        *seen ^= *seen >> 29;
    }
}

/* The state as bytes that another instance, in any process, can go on from. */
static inline char *serialised(fmi2Component c, size_t *size)
{
    fmi2FMUstate state = NULL;
    must(fmi2GetFMUstate(c, &state), "fmi2GetFMUstate");
    must(fmi2SerializedFMUstateSize(c, state, size), "fmi2SerializedFMUstateSize");
    char *saved = room(*size, 1);
    must(fmi2SerializeFMUstate(c, state, saved, *size), "fmi2SerializeFMUstate");
    must(fmi2FreeFMUstate(c, &state), "fmi2FreeFMUstate");
    return saved;
}

static inline void resume(fmi2Component c, const char *saved, size_t size)
{
    fmi2FMUstate state = NULL;
    must(fmi2DeSerializeFMUstate(c, saved, size, &state), "fmi2DeSerializeFMUstate");
    must(fmi2SetFMUstate(c, state), "fmi2SetFMUstate");
    must(fmi2FreeFMUstate(c, &state), "fmi2FreeFMUstate");
}

#endif
