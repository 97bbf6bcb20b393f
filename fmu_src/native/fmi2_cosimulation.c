/* Steps of a co-simulation. */
#include "component.h"

#include <math.h>
#include <stdio.h>

/* A step may not end behind the stop time of fmi2SetupExperiment, but for rounding. */
static bool before_stop(const Component *c, double end, Reason *reason)
{
    double rounding = SAME_POINT * (fabs(c->stop) > 1.0 ? fabs(c->stop) : 1.0);
    return !c->stop_defined || !(end > c->stop + rounding) ||
           refuse(reason, "the step ends at %.17g, expected no later than stopTime = %.17g", end, c->stop);
}

fmi2Status fmi2DoStep(fmi2Component component, fmi2Real currentCommunicationPoint,
                      fmi2Real communicationStepSize, fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
    (void)noSetFMUStatePriorToCurrentPoint;
    Component *c = legal(component, CALL_DoStep);
    if (!c)
        return fmi2Error;
    Reason reason;
    StepResult result = STEP_ILLEGAL;
    if (before_stop(c, currentCommunicationPoint + communicationStepSize, &reason))
        result = advance_instance(c->instance, currentCommunicationPoint, communicationStepSize, &reason);
    c->last_step = result == STEP_MADE ? fmi2OK : result == STEP_ILLEGAL ? fmi2Error : fmi2Discard;
    if (result != STEP_MADE)
        return refused(c, CALL_DoStep, c->last_step, &reason);
    if (c->instance->step_size_was_new && c->logged & LOG_STEP_SIZES) {
        char message[128];
        snprintf(message, sizeof message,
                 "fmi2DoStep: the step size %.17g is new, its coefficients were computed",
                 communicationStepSize);
        tell(c, fmi2OK, LOG_STEP_SIZES, message);
    }
    return fmi2OK;
}

fmi2Status fmi2CancelStep(fmi2Component component)
{
    legal(component, CALL_CancelStep);
    return fmi2Error;
}

/* Answer a question about the last step, or refuse it. */
static fmi2Status step_status(fmi2Component component, Call call, bool answered, const void *value)
{
    Component *c = legal(component, call);
    if (!c)
        return fmi2Error;
    Reason reason;
    if (answered && value)
        return fmi2OK;
    refuse(&reason, "%s", value ? "got a status kind that has no value of this type" : "got a NULL pointer");
    return refused(c, call, value ? fmi2Discard : fmi2Error, &reason);
}

fmi2Status fmi2GetStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Status *value)
{
    fmi2Status status = step_status(component, CALL_GetStatus, kind == fmi2DoStepStatus, value);
    if (status == fmi2OK)
        *value = ((Component *)component)->last_step;
    return status;
}

fmi2Status fmi2GetRealStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Real *value)
{
    fmi2Status status = step_status(component, CALL_GetRealStatus, kind == fmi2LastSuccessfulTime, value);
    if (status == fmi2OK)
        *value = ((Component *)component)->instance->time;
    return status;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Integer *value)
{
    (void)kind;
    return step_status(component, CALL_GetIntegerStatus, false, value);
}

fmi2Status fmi2GetBooleanStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Boolean *value)
{
    fmi2Status status = step_status(component, CALL_GetBooleanStatus, kind == fmi2Terminated, value);
    if (status == fmi2OK)
        *value = fmi2False; /* the part never asks to end the simulation */
    return status;
}

fmi2Status fmi2GetStringStatus(fmi2Component component, const fmi2StatusKind kind, fmi2String *value)
{
    fmi2Status status = step_status(component, CALL_GetStringStatus, kind == fmi2PendingStatus, value);
    if (status == fmi2OK)
        *value = ""; /* no step is ever pending */
    return status;
}
