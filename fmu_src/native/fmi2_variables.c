/* Getting and setting variables; a call with one wrong reference or value changes nothing. */
#include "component.h"
#include "directional.h"
#include "reals.h"

#include <math.h>

/* References and values are there if any are asked for. */
static bool arrays_given(const void *references, const void *values, size_t count, Reason *reason)
{
    return count == 0 || (references && values) || refuse(reason, "got a NULL pointer, expected an array");
}

static bool references_exist(const fmi2ValueReference vr[], size_t count, size_t size, Reason *reason)
{
    fmi2ValueReference highest = 0;
    for (size_t k = 0; k < count; k++)
        highest = vr[k] > highest ? vr[k] : highest;
    return count == 0 || highest < size ||
           refuse(reason, "got value reference %u, expected less than %zu", highest, size);
}

fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference vr[], size_t nvr, fmi2Real value[])
{
    Component *c = legal(component, CALL_GetReal);
    if (!c)
        return fmi2Error;
    Reason reason;
    if (!arrays_given(vr, value, nvr, &reason) ||
        !references_exist(vr, nvr, c->instance->layout.start[NO_VARIABLE], &reason))
        return refused(c, CALL_GetReal, fmi2Error, &reason);
    real_values(c->instance, vr, nvr, value);
    return fmi2OK;
}

/* Whether this Real can be set to this value now. */
static bool can_set(const Component *c, fmi2ValueReference vr, double value, Reason *reason)
{
    size_t place;
    Group group = group_of(&c->instance->layout, vr, &place);
    switch (group) {
    case INPUT:
        return true; /* a step is where an input must be finite */
    case ALPHA:
    case BETA:
        if (c->mode == CONTINUOUS_MODE)
            return refuse(reason, "damping can be changed in event mode only");
        return (isfinite(value) && value >= 0.0) ||
               refuse(reason, "got a damping parameter of %g, expected a finite number >= 0", value);
    case START:
        if (!c->instance->initialising)
            return refuse(reason, "the start of a prescribed motion can be set before "
                                  "fmi2ExitInitializationMode only");
        return isfinite(value) || refuse(reason, "got a start of %g, expected a finite number", value);
    case AMPLITUDE:
    case MODAL_VELOCITY:
        if (c->instance->initialising && !is_known(c->instance, group, place))
            return refuse(reason, "value reference %u is calculated; it cannot be set", vr);
        break;
    default:
        return refuse(reason, "value reference %u is calculated or constant; it cannot be set", vr);
    }
    if (!c->instance->initialising && c->mode != CONTINUOUS_MODE)
        return refuse(reason, "the modal state can be set before fmi2ExitInitializationMode or in "
                              "continuous-time mode only");
    return isfinite(value) || refuse(reason, "got a modal state of %g, expected a finite number", value);
}

fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference vr[], size_t nvr,
                       const fmi2Real value[])
{
    Component *c = legal(component, CALL_SetReal);
    if (!c)
        return fmi2Error;
    Instance *x = c->instance;
    Reason reason;
    size_t place;
    if (!arrays_given(vr, value, nvr, &reason) ||
        !references_exist(vr, nvr, x->layout.start[NO_VARIABLE], &reason))
        return refused(c, CALL_SetReal, fmi2Error, &reason);
    for (size_t k = 0; k < nvr; k++)
        if (!can_set(c, vr[k], value[k], &reason))
            return refused(c, CALL_SetReal, fmi2Error, &reason);
    double alpha = x->alpha, beta = x->beta;
    for (size_t k = 0; k < nvr; k++)
        switch (group_of(&x->layout, vr[k], &place)) {
        case INPUT:
            set_input(x, place, value[k]);
            break;
        case ALPHA:
            alpha = value[k];
            break;
        case BETA:
            beta = value[k];
            break;
        case START:
            set_start(x, place, value[k]);
            break;
        case AMPLITUDE:
            set_state(x, 0, place, value[k]);
            break;
        default: /* can_set lets nothing else pass */
            set_state(x, 1, place, value[k]);
        }
    if (alpha != x->alpha || beta != x->beta)
        set_damping(x, alpha, beta);
    return fmi2OK;
}

fmi2Status fmi2GetInteger(fmi2Component component, const fmi2ValueReference vr[], size_t nvr,
                          fmi2Integer value[])
{
    Component *c = legal(component, CALL_GetInteger);
    if (!c)
        return fmi2Error;
    Reason reason;
    if (!arrays_given(vr, value, nvr, &reason) || !references_exist(vr, nvr, 1, &reason))
        return refused(c, CALL_GetInteger, fmi2Error, &reason);
    for (size_t k = 0; k < nvr; k++)
        value[k] = (fmi2Integer)(c->instance->active - c->source.model->k);
    return fmi2OK;
}

/* Whether a mode that this many coordinates leave out is not at rest. */
static bool moves_beyond(const Instance *x, size_t active)
{
    for (size_t i = active; i < x->active; i++)
        if (x->motion[0][i] != 0.0 || x->motion[1][i] != 0.0)
            return true;
    return false;
}

fmi2Status fmi2SetInteger(fmi2Component component, const fmi2ValueReference vr[], size_t nvr,
                          const fmi2Integer value[])
{
    Component *c = legal(component, CALL_SetInteger);
    if (!c)
        return fmi2Error;
    Reason reason;
    size_t r = c->source.model->r;
    if (!arrays_given(vr, value, nvr, &reason) || !references_exist(vr, nvr, 1, &reason))
        return refused(c, CALL_SetInteger, fmi2Error, &reason);
    for (size_t k = 0; k < nvr; k++)
        if (value[k] < 0 || (size_t)value[k] > r) {
            refuse(&reason, "got modes.active = %d, expected 0 ... %zu", value[k], r);
            return refused(c, CALL_SetInteger, fmi2Error, &reason);
        }
    if (nvr > 0) {
        size_t active = c->source.model->k + (size_t)value[nvr - 1];
        if (c->mode == EVENT_MODE)
            c->states_jumped |= moves_beyond(c->instance, active);
        set_active(c->instance, active);
    }
    return fmi2OK;
}

/* There are no Booleans and no Strings. */
static fmi2Status no_variables(fmi2Component component, Call call, size_t count)
{
    Component *c = legal(component, call);
    if (!c || count == 0)
        return c ? fmi2OK : fmi2Error;
    Reason reason;
    refuse(&reason, "this FMU has no variable of this type");
    return refused(c, call, fmi2Error, &reason);
}

fmi2Status fmi2GetBoolean(fmi2Component component, const fmi2ValueReference vr[], size_t nvr,
                          fmi2Boolean value[])
{
    (void)vr;
    (void)value;
    return no_variables(component, CALL_GetBoolean, nvr);
}

fmi2Status fmi2SetBoolean(fmi2Component component, const fmi2ValueReference vr[], size_t nvr,
                          const fmi2Boolean value[])
{
    (void)vr;
    (void)value;
    return no_variables(component, CALL_SetBoolean, nvr);
}

fmi2Status fmi2GetString(fmi2Component component, const fmi2ValueReference vr[], size_t nvr,
                         fmi2String value[])
{
    (void)vr;
    (void)value;
    return no_variables(component, CALL_GetString, nvr);
}

fmi2Status fmi2SetString(fmi2Component component, const fmi2ValueReference vr[], size_t nvr,
                         const fmi2String value[])
{
    (void)vr;
    (void)value;
    return no_variables(component, CALL_SetString, nvr);
}
