/* The calls of the fuzz target, by kind, with arguments taken from the input; behind modalfmu.c. */
#ifndef KINDS_OF_CALLS_H
#define KINDS_OF_CALLS_H

#include "fuzz_input.h"

#define SLOTS 3 /* for saved states, of all instances */

static fmi2FMUstate slots[SLOTS];

static fmi2Status values_call(fmi2Component c, unsigned int call, Input *input)
{
    size_t count = byte(input) % 8u;
    fmi2ValueReference *vr = references(input, count);
    fmi2Integer *integers = small_integers(input, count);
    double *values = reals(input, count);
    unsigned int missing = byte(input); /* which array is NULL, seldom */
    const fmi2ValueReference *given = missing == 1 ? NULL : vr;
    double *reals_given = missing == 2 ? NULL : values;
    fmi2Status status = fmi2Error;
    switch (call) {
    case 0:
        status = fmi2SetReal(c, given, count, reals_given);
        break;
    case 1:
        status = fmi2GetReal(c, given, count, reals_given);
        break;
    case 2:
        status = fmi2SetInteger(c, given, count, missing == 2 ? NULL : integers);
        break;
    case 3:
        status = fmi2GetInteger(c, given, count, missing == 2 ? NULL : integers);
        break;
    case 4:
        status = fmi2SetRealInputDerivatives(c, given, count, missing == 3 ? NULL : integers, reals_given);
        break;
    case 5:
        status = fmi2GetRealOutputDerivatives(c, given, count, missing == 3 ? NULL : integers, reals_given);
        break;
    case 6:
        status = fmi2SetBoolean(c, given, count, integers);
        break;
    case 7:
        status = fmi2GetBoolean(c, given, count, integers);
        break;
    case 8:
        status = fmi2SetString(c, given, count, NULL);
        break;
    case 9:
        status = fmi2GetString(c, given, count, NULL);
        break;
    default: {
        size_t knowns = byte(input) % 8u;
        fmi2ValueReference *known = references(input, knowns);
        double *seed = reals(input, knowns);
        status = fmi2GetDirectionalDerivative(c, given, count, missing == 3 ? NULL : known, knowns, seed,
                                              reals_given);
        free(known);
        free(seed);
    }
    }
    const size_t real_count = embedded_model.m + embedded_model.p + 2 + 2 * embedded_model.k +
                              2 * embedded_model.r + 4 * embedded_model.n;
    const size_t known_below = call == 2 || call == 3 ? 1 : real_count;
    for (size_t k = 0; k < count; k++)
        must(status != fmi2OK || (vr[k] < known_below && given)); /* one unknown reference refuses the call */
    free(vr);
    free(integers);
    free(values);
    return status;
}

static fmi2Status state_call(fmi2Component c, unsigned int call, Input *input)
{
    fmi2FMUstate *slot = &slots[byte(input) % SLOTS];
    unsigned int missing = byte(input);
    size_t size = 0, place = byte(input) * 256u + byte(input), full = 0;
    fmi2Status status = fmi2Error;
    if (call == 0)
        return fmi2GetFMUstate(c, missing == 1 ? NULL : slot);
    if (call == 1)
        return fmi2SetFMUstate(c, missing == 1 ? NULL : *slot);
    if (call == 2)
        return fmi2FreeFMUstate(c, missing == 1 ? NULL : slot);
    if (!c || fmi2SerializedFMUstateSize(c, *slot, missing == 1 ? NULL : &full) != fmi2OK)
        return fmi2Error;
    size = missing == 2 ? full / 2 : missing == 3 ? full + 1 : full;
    char *bytes = malloc(size);
    must(bytes != NULL);
    memset(bytes, 0, size);
    status = fmi2SerializeFMUstate(c, *slot, bytes, size);
    if (missing & 128) /* a damaged one; it is refused now or when it is set, or it is a state */
        bytes[place % size] = (char)byte(input);
    status = status == fmi2OK ? fmi2DeSerializeFMUstate(c, bytes, size, missing == 4 ? NULL : slot) : status;
    free(bytes);
    return status;
}

static fmi2Status exchange_call(fmi2Component c, unsigned int call, Input *input)
{
    size_t states = 2 * embedded_model.n, count = byte(input);
    count = count < 200 ? states : count - 200;
    fmi2EventInfo event;
    fmi2Boolean a, b;
    unsigned int missing = byte(input);
    double *values = reals(input, count), *given = missing == 1 ? NULL : values;
    fmi2Status status = fmi2Error;
    switch (call) {
    case 0:
        status = fmi2EnterEventMode(c);
        break;
    case 1:
        status = fmi2NewDiscreteStates(c, missing == 1 ? NULL : &event);
        break;
    case 2:
        status = fmi2EnterContinuousTimeMode(c);
        break;
    case 3:
        status = fmi2CompletedIntegratorStep(c, fmi2True, missing == 1 ? NULL : &a, &b);
        break;
    case 4:
        status = fmi2SetTime(c, real(input));
        break;
    case 5:
        status = fmi2SetContinuousStates(c, given, count);
        break;
    case 6:
        status = fmi2GetDerivatives(c, given, count);
        break;
    case 7:
        status = fmi2GetContinuousStates(c, given, count);
        break;
    case 8:
        status = fmi2GetNominalsOfContinuousStates(c, given, count);
        break;
    default:
        status = fmi2GetEventIndicators(c, given, missing == 2 ? 1 : 0);
    }
    free(values);
    return status;
}

static fmi2Status life_call(fmi2Component c, unsigned int call, Input *input)
{
    const fmi2String names[] = {"logAll", byte(input) & 1 ? "nonsense" : "logStatusError", NULL};
    double start = real(input), stop = real(input), value;
    fmi2Integer integer;
    fmi2Boolean boolean;
    fmi2String text;
    fmi2Status status;
    fmi2StatusKind kind = (fmi2StatusKind)(byte(input) % 5u);
    switch (call) {
    case 0:
        return fmi2SetupExperiment(c, fmi2False, 0.0, start, byte(input) & 1, stop);
    case 1:
        return fmi2EnterInitializationMode(c);
    case 2:
        return fmi2ExitInitializationMode(c);
    case 3:
        return fmi2Terminate(c);
    case 4:
        return fmi2Reset(c);
    case 5:
        return fmi2SetDebugLogging(c, byte(input) & 1, byte(input) % 4u, byte(input) ? names : NULL);
    case 6:
        return fmi2CancelStep(c);
    case 7:
        return fmi2GetStatus(c, kind, &status);
    case 8:
        return fmi2GetRealStatus(c, kind, byte(input) == 1 ? NULL : &value);
    case 9:
        return fmi2GetIntegerStatus(c, kind, &integer);
    case 10:
        return fmi2GetBooleanStatus(c, kind, &boolean);
    default:
        return fmi2GetStringStatus(c, kind, &text);
    }
}

#endif
