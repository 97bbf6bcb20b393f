/* The life of a component: fmi2Instantiate ... fmi2FreeInstance. */
#include "component.h"
#include "motion.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

/* The host's memory functions, or the C library's where the host gives none. */
static bool host_memory(const fmi2CallbackFunctions *callbacks, Memory *memory, Reason *reason)
{
    memory->allocate = callbacks->allocateMemory;
    memory->release = callbacks->freeMemory;
    if (!memory->allocate && !memory->release) {
        memory->allocate = calloc;
        memory->release = free;
    }
    if (!memory->allocate || !memory->release)
        return refuse(reason, "got one of allocateMemory and freeMemory, expected both or none");
    return true;
}

static bool out_of_memory(Reason *reason)
{
    return refuse(reason, "the host's allocateMemory gave no memory");
}

/* Read the model and make the instance; what was made so far is in `c`, whatever this returns. */
static bool fill_component(Component *c, fmi2String name, fmi2String guid, fmi2String location,
                           Reason *reason)
{
    if (!name || name[strspn(name, " \t\r\n")] == 0)
        return refuse(reason, "got no instanceName, expected a text");
    if (!guid)
        return refuse(reason, "got no GUID, expected that of modelDescription.xml");
    c->name = c->memory.allocate(strlen(name) + 1, 1);
    if (!c->name)
        return out_of_memory(reason);
    memcpy(c->name, name, strlen(name) + 1);
    Source source = {0}; /* the rest of the GUID too: it is compared as a whole */
    if (!open_source(&source, location, &c->memory, reason))
        return false;
    c->source = source;
    if (strcmp(guid, source.guid) != 0)
        return refuse(reason,
                      "got the GUID %.64s, expected %s, that of the resources: they belong to another FMU",
                      guid, source.guid);
    c->instance = new_instance(source.model, &c->memory);
    return c->instance ? true : out_of_memory(reason);
}

/* Not fmi2FreeInstance: by that name a host may have another FMU's function. */
static void free_component(Component *c)
{
    if (!c)
        return;
    if (c->instance)
        free_instance(c->instance, &c->memory);
    if (c->source.model)
        close_source(&c->source, &c->memory);
    if (c->name)
        c->memory.release(c->name);
    c->memory.release(c);
}

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID,
                              fmi2String fmuResourceLocation, const fmi2CallbackFunctions *functions,
                              fmi2Boolean visible, fmi2Boolean loggingOn)
{
    (void)visible;
    if (!functions)
        return NULL;
    Reason reason;
    Component started = {.callbacks = *functions, .type = fmuType, .mode = INSTANTIATED, .last_step = fmi2OK};
    started.logged = loggingOn ? LOG_ALL : LOG_ERROR;
    Component *c = NULL;
    bool ok = host_memory(functions, &started.memory, &reason);
    if (ok && fmuType != fmi2CoSimulation && fmuType != fmi2ModelExchange)
        ok = refuse(&reason, "got fmuType %d, expected fmi2ModelExchange or fmi2CoSimulation", (int)fmuType);
    if (ok) {
        c = started.memory.allocate(1, sizeof *c);
        ok = c ? true : out_of_memory(&reason);
    }
    if (ok) {
        *c = started;
        ok = fill_component(c, instanceName, fmuGUID, fmuResourceLocation, &reason);
    }
    char message[MESSAGE_SIZE];
    if (!ok) {
        snprintf(message, sizeof message, "fmi2Instantiate: %s", reason.text);
        started.name = (char *)(instanceName ? instanceName : "");
        tell(&started, fmi2Error, LOG_ERROR, message);
        free_component(c);
        return NULL;
    }
    const ReducedModel *model = c->source.model;
    snprintf(message, sizeof message, "%.64s: %zu modes, %zu inputs, %zu outputs; %s instructions",
             model->name, model->r, model->m, model->p, c->instance->kernels->instructions);
    tell(c, fmi2OK, LOG_MODEL, message);
    return c;
}

void fmi2FreeInstance(fmi2Component component)
{
    free_component(component);
}

fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean loggingOn, size_t nCategories,
                               const fmi2String names[])
{
    Component *c = legal(component, CALL_SetDebugLogging);
    if (!c)
        return fmi2Error;
    Reason reason;
    unsigned int chosen = nCategories == 0 ? LOG_ALL : 0;
    for (size_t k = 0; k < nCategories; k++) {
        unsigned int bit = names && names[k] ? category_bit(names[k]) : 0;
        if (!bit) {
            refuse(&reason, "got the category %.64s, expected one of modelDescription.xml",
                   names && names[k] ? names[k] : "NULL");
            return refused(c, CALL_SetDebugLogging, fmi2Error, &reason);
        }
        chosen |= bit;
    }
    c->logged =
        (loggingOn ? c->logged | chosen : c->logged & ~chosen) | LOG_ERROR; /* errors are always told */
    return fmi2OK;
}

fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean toleranceDefined, fmi2Real tolerance,
                               fmi2Real startTime, fmi2Boolean stopTimeDefined, fmi2Real stopTime)
{
    (void)toleranceDefined; /* a tolerance means nothing to an exact step */
    (void)tolerance;
    Component *c = legal(component, CALL_SetupExperiment);
    if (!c)
        return fmi2Error;
    Reason reason;
    if (!isfinite(startTime) || (stopTimeDefined && !(stopTime >= startTime))) {
        refuse(&reason, "got startTime %g and stopTime %g, expected a finite start and no earlier stop",
               startTime, stopTimeDefined ? stopTime : INFINITY);
        return refused(c, CALL_SetupExperiment, fmi2Error, &reason);
    }
    c->stop = stopTime;
    c->stop_defined = stopTimeDefined != fmi2False;
    c->instance->time = startTime;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component component)
{
    Component *c = legal(component, CALL_EnterInitializationMode);
    if (!c)
        return fmi2Error;
    c->mode = INITIALIZATION_MODE;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component component)
{
    Component *c = legal(component, CALL_ExitInitializationMode);
    if (!c)
        return fmi2Error;
    Reason reason;
    if (!end_initialisation(c->instance, &reason))
        return refused(c, CALL_ExitInitializationMode, fmi2Error, &reason);
    c->mode = c->type == fmi2CoSimulation ? STEP_MODE : EVENT_MODE;
    return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component component)
{
    Component *c = legal(component, CALL_Terminate);
    if (!c)
        return fmi2Error;
    c->mode = TERMINATED;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component component)
{
    Component *c = legal(component, CALL_Reset);
    if (!c)
        return fmi2Error;
    reset_instance(c->instance);
    c->mode = INSTANTIATED;
    c->stop_defined = c->states_jumped = false;
    c->stop = 0.0;
    c->last_step = fmi2OK;
    return fmi2OK;
}
