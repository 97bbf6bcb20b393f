/* Directional derivatives, input derivatives, output derivatives. */
#include "component.h"
#include "directional.h"
#include "outputs.h"

#include <math.h>

/* The group of a reference that must be known (or unknown), else NO_VARIABLE with a reason. */
static Group varied_group(const Instance *x, fmi2ValueReference vr, bool known, size_t *place, Reason *reason)
{
    Group group = group_of(&x->layout, vr, place);
    if (group != NO_VARIABLE && (known ? is_known(x, group, *place) : is_unknown(x, group, *place)))
        return group;
    refuse(reason, "got value reference %u, expected %s of ModelStructure", vr,
           known ? "a dependency" : "an unknown");
    return NO_VARIABLE;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component component, const fmi2ValueReference vUnknown_ref[],
                                        size_t nUnknown, const fmi2ValueReference vKnown_ref[], size_t nKnown,
                                        const fmi2Real dvKnown[], fmi2Real dvUnknown[])
{
    Component *c = legal(component, CALL_GetDirectionalDerivative);
    if (!c)
        return fmi2Error;
    Instance *x = c->instance;
    Reason reason;
    size_t place;
    if ((nUnknown > 0 && (!vUnknown_ref || !dvUnknown)) || (nKnown > 0 && (!vKnown_ref || !dvKnown))) {
        refuse(&reason, "got a NULL pointer, expected an array");
        return refused(c, CALL_GetDirectionalDerivative, fmi2Error, &reason);
    }
    for (size_t k = 0; k < nUnknown; k++)
        if (varied_group(x, vUnknown_ref[k], false, &place, &reason) == NO_VARIABLE)
            return refused(c, CALL_GetDirectionalDerivative, fmi2Error, &reason);
    clear_directions(x);
    for (size_t k = 0; k < nKnown; k++) {
        Group group = varied_group(x, vKnown_ref[k], true, &place, &reason);
        if (group == NO_VARIABLE)
            return refused(c, CALL_GetDirectionalDerivative, fmi2Error, &reason);
        add_direction(x, group, place, dvKnown[k]);
    }
    spread_directions(x);
    for (size_t k = 0; k < nUnknown; k++) {
        Group group = group_of(&x->layout, vUnknown_ref[k], &place);
        dvUnknown[k] = directional_derivative(x, group, place);
    }
    return fmi2OK;
}

/* A reference of this group with an order 1 ... RATES. */
static bool derivative_exists(const Instance *x, fmi2ValueReference vr, fmi2Integer order, Group expected,
                              Reason *reason)
{
    size_t place;
    if (group_of(&x->layout, vr, &place) != expected)
        return refuse(reason, "got value reference %u, expected an %s", vr,
                      expected == INPUT ? "input" : "output");
    return (order >= 1 && order <= RATES) || refuse(reason, "got order %d, expected 1 or %d", order, RATES);
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component component, const fmi2ValueReference vr[], size_t nvr,
                                       const fmi2Integer order[], const fmi2Real value[])
{
    Component *c = legal(component, CALL_SetRealInputDerivatives);
    if (!c)
        return fmi2Error;
    Reason reason;
    bool ok = nvr == 0 || (vr && order && value) || refuse(&reason, "got a NULL pointer, expected an array");
    for (size_t k = 0; ok && k < nvr; k++) {
        ok = derivative_exists(c->instance, vr[k], order[k], INPUT, &reason);
        if (ok && !isfinite(value[k]))
            ok = refuse(&reason, "got %g as a derivative of %s, expected a finite number", value[k],
                        c->source.model->inputs[vr[k]]);
    }
    if (!ok)
        return refused(c, CALL_SetRealInputDerivatives, fmi2Error, &reason);
    for (size_t k = 0; k < nvr; k++)
        set_input_rate(c->instance, (size_t)order[k], vr[k], value[k]);
    return fmi2OK;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component component, const fmi2ValueReference vr[], size_t nvr,
                                        const fmi2Integer order[], fmi2Real value[])
{
    Component *c = legal(component, CALL_GetRealOutputDerivatives);
    if (!c)
        return fmi2Error;
    Instance *x = c->instance;
    Reason reason;
    bool ok = nvr == 0 || (vr && order && value) || refuse(&reason, "got a NULL pointer, expected an array");
    for (size_t k = 0; ok && k < nvr; k++)
        ok = derivative_exists(x, vr[k], order[k], OUTPUT, &reason);
    if (!ok)
        return refused(c, CALL_GetRealOutputDerivatives, fmi2Error, &reason);
    for (size_t k = 0; k < nvr; k++)
        output_values(x, (size_t)order[k], &vr[k], 1, &value[k]);
    return fmi2OK;
}
