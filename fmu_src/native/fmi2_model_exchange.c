/* Model exchange: states x = [s; q], x' and their derivatives, for the solver of the tool; no events. */
#include "component.h"
#include "motion.h"
#include "reals.h"

#include <math.h>

fmi2Status fmi2EnterEventMode(fmi2Component component)
{
    Component *c = legal(component, CALL_EnterEventMode);
    if (!c)
        return fmi2Error;
    c->mode = EVENT_MODE;
    return fmi2OK;
}

fmi2Status fmi2NewDiscreteStates(fmi2Component component, fmi2EventInfo *eventInfo)
{
    Component *c = legal(component, CALL_NewDiscreteStates);
    if (!c)
        return fmi2Error;
    Reason reason;
    if (!eventInfo) {
        refuse(&reason, "got a NULL pointer");
        return refused(c, CALL_NewDiscreteStates, fmi2Error, &reason);
    }
    eventInfo->newDiscreteStatesNeeded = fmi2False;
    eventInfo->terminateSimulation = fmi2False;
    eventInfo->nominalsOfContinuousStatesChanged = fmi2False;
    eventInfo->valuesOfContinuousStatesChanged = c->states_jumped ? fmi2True : fmi2False;
    eventInfo->nextEventTimeDefined = fmi2False;
    eventInfo->nextEventTime = 0.0;
    c->states_jumped = false;
    return fmi2OK;
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component component)
{
    Component *c = legal(component, CALL_EnterContinuousTimeMode);
    if (!c)
        return fmi2Error;
    c->mode = CONTINUOUS_MODE;
    return fmi2OK;
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component component, fmi2Boolean noSetFMUStatePriorToCurrentPoint,
                                       fmi2Boolean *enterEventMode, fmi2Boolean *terminateSimulation)
{
    (void)noSetFMUStatePriorToCurrentPoint;
    Component *c = legal(component, CALL_CompletedIntegratorStep);
    if (!c)
        return fmi2Error;
    Reason reason;
    if (!enterEventMode || !terminateSimulation) {
        refuse(&reason, "got a NULL pointer");
        return refused(c, CALL_CompletedIntegratorStep, fmi2Error, &reason);
    }
    *enterEventMode = *terminateSimulation = fmi2False;
    return fmi2OK;
}

fmi2Status fmi2SetTime(fmi2Component component, fmi2Real time)
{
    Component *c = legal(component, CALL_SetTime);
    if (!c)
        return fmi2Error;
    Reason reason;
    if (!isfinite(time)) {
        refuse(&reason, "got the time %g, expected a finite number", time);
        return refused(c, CALL_SetTime, fmi2Error, &reason);
    }
    c->instance->time = time;
    return fmi2OK;
}

/* The component, if an array of so many numbers, one for each state, may be used now. */
static Component *with_states(fmi2Component component, Call call, const void *values, size_t count)
{
    Component *c = legal(component, call);
    if (!c)
        return NULL;
    Reason reason;
    size_t states = 2 * c->source.model->n;
    if (count == states && (values || count == 0)) /* a model without a state may get no array */
        return c;
    refuse(&reason, "got %zu values%s, expected an array of %zu", count, values ? "" : " at a NULL pointer",
           states);
    refused(c, call, fmi2Error, &reason);
    return NULL;
}

fmi2Status fmi2SetContinuousStates(fmi2Component component, const fmi2Real x[], size_t nx)
{
    Component *c = with_states(component, CALL_SetContinuousStates, x, nx);
    if (!c)
        return fmi2Error;
    size_t n = c->source.model->n;
    Reason reason;
    for (size_t i = 0; i < nx; i++)
        if (!isfinite(x[i])) {
            refuse(&reason, "got %g for state %zu, expected a finite number: try a smaller step", x[i],
                   i + 1);
            return refused(c, CALL_SetContinuousStates, fmi2Discard, &reason);
        }
    for (size_t i = 0; i < n; i++) {
        set_state(c->instance, 0, i, x[i]);
        set_state(c->instance, 1, i, x[n + i]);
    }
    return fmi2OK;
}

fmi2Status fmi2GetDerivatives(fmi2Component component, fmi2Real derivatives[], size_t nx)
{
    Component *c = with_states(component, CALL_GetDerivatives, derivatives, nx);
    if (!c)
        return fmi2Error;
    Reason reason;
    if (!inputs_are_finite(c->instance, &reason))
        return refused(c, CALL_GetDerivatives, fmi2Discard, &reason);
    size_t k = c->source.model->k, n = c->source.model->n;
    double *const *q = motion(c->instance, 2);
    for (size_t i = k; i < n; i++) /* a prescribed acceleration is an input */
        if (!isfinite(q[2][i])) {
            refuse(&reason, "the derivative of modes.velocity[%zu] is %g: try a smaller step", i + 1 - k,
                   q[2][i]);
            return refused(c, CALL_GetDerivatives, fmi2Discard, &reason);
        }
    for (size_t i = 0; i < n; i++) {
        derivatives[i] = q[1][i];
        derivatives[n + i] = q[2][i];
    }
    return fmi2OK;
}

fmi2Status fmi2GetEventIndicators(fmi2Component component, fmi2Real eventIndicators[], size_t ni)
{
    (void)eventIndicators;
    Component *c = legal(component, CALL_GetEventIndicators);
    if (!c || ni == 0)
        return c ? fmi2OK : fmi2Error;
    Reason reason;
    refuse(&reason, "got %zu event indicators, expected 0", ni);
    return refused(c, CALL_GetEventIndicators, fmi2Error, &reason);
}

fmi2Status fmi2GetContinuousStates(fmi2Component component, fmi2Real x[], size_t nx)
{
    Component *c = with_states(component, CALL_GetContinuousStates, x, nx);
    if (!c)
        return fmi2Error;
    size_t n = c->source.model->n;
    double *const *q = motion(c->instance, 1);
    for (size_t i = 0; i < n; i++) {
        x[i] = q[0][i];
        x[n + i] = q[1][i];
    }
    return fmi2OK;
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component component, fmi2Real x_nominal[], size_t nx)
{
    Component *c = with_states(component, CALL_GetNominalsOfContinuousStates, x_nominal, nx);
    if (!c)
        return fmi2Error;
    size_t n = c->source.model->n;
    for (size_t i = 0; i < n; i++) {
        x_nominal[i] = nominal(c->instance, 0, i);
        x_nominal[n + i] = nominal(c->instance, 1, i);
    }
    return fmi2OK;
}
