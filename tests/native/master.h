/* A small master: it steps an FMU of ours with forces that are fractions, and prints all its Reals. */
#ifndef MASTER_H
#define MASTER_H

#include "fmi2FunctionTypes.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

/* The functions that it calls, wherever they come from. */
typedef struct {
    fmi2InstantiateTYPE *instantiate;
    fmi2SetupExperimentTYPE *setup;
    fmi2EnterInitializationModeTYPE *enter;
    fmi2ExitInitializationModeTYPE *leave;
    fmi2SetRealTYPE *set;
    fmi2GetRealTYPE *get;
    fmi2DoStepTYPE *step;
    fmi2TerminateTYPE *terminate;
    fmi2FreeInstanceTYPE *release;
} Functions;

static void print_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                          fmi2String category, fmi2String format, ...)
{
    (void)environment;
    va_list arguments;
    va_start(arguments, format);
    fprintf(stderr, "%s %s %d: ", name, category, (int)status);
    vfprintf(stderr, format, arguments);
    fprintf(stderr, "\n");
    va_end(arguments);
}

/* Steps of four sizes in turn; after each a line with all Reals. Gives 0, or the line of the call that
 * failed. */
static int run(const Functions *fmu, const char *guid, const char *location, unsigned int inputs,
               unsigned int reals, int steps)
{
    static const fmi2CallbackFunctions callbacks = {print_message, calloc, free, NULL, NULL};
    static const double sizes[] = {0.001, 0.02, 0.3, 0.0625};
    double time = 0.0;
    double *values = calloc(reals, sizeof *values);
    fmi2ValueReference *references = calloc(reals, sizeof *references);
    if (!values || !references)
        return __LINE__;
    for (unsigned int i = 0; i < reals; i++)
        references[i] = i;
    fmi2Component c =
        fmu->instantiate("one", fmi2CoSimulation, guid, location, &callbacks, fmi2False, fmi2True);
    if (!c)
        return __LINE__;
    if (fmu->setup(c, fmi2False, 0.0, time, fmi2False, 0.0) != fmi2OK || fmu->enter(c) != fmi2OK ||
        fmu->leave(c) != fmi2OK)
        return __LINE__;
    for (int k = 0; k < steps; k++) {
        double h = sizes[k % 4];
        for (unsigned int j = 0; j < inputs; j++)
            values[j] = ((7 * k + 3 * (int)j) % 11 - 5) / 4.0;
        if (fmu->set(c, references, inputs, values) != fmi2OK)
            return __LINE__;
        if (fmu->step(c, time, h, fmi2True) != fmi2OK)
            return __LINE__;
        time += h;
        if (fmu->get(c, references, reals, values) != fmi2OK)
            return __LINE__;
        for (unsigned int i = 0; i < reals; i++)
            printf("%.17g%c", values[i], i + 1 < reals ? ' ' : '\n');
    }
    if (fmu->terminate(c) != fmi2OK)
        return __LINE__;
    fmu->release(c);
    free(values);
    free(references);
    return 0;
}

#endif
