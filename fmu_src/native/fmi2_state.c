/* Saving and restoring a component: an fmi2FMUstate is a block of bytes that can be serialised as it is. */
#include "component.h"
#include "saved_state.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/* What stands before the bytes of saved_state.h. */
typedef struct {
    char guid[GUID_SIZE]; /* of the FMU: other FMUs have other states */
    uint64_t size;        /* of all */
    uint64_t type, mode, stop_defined, states_jumped, last_step;
    double stop;
} StateHead;

static size_t state_size(const Component *c)
{
    return sizeof(StateHead) + saved_size(c->instance);
}

static fmi2Status no_state(const Component *c, Call call, const char *what)
{
    Reason reason;
    refuse(&reason, "%s", what);
    return refused(c, call, fmi2Error, &reason);
}

/* The head of a state of this FMU. */
static bool read_head(const Component *c, const unsigned char *bytes, size_t size, StateHead *head,
                      Reason *reason)
{
    if (size != state_size(c))
        return refuse(reason, "got %zu bytes, expected %zu: it is no state of this FMU", size, state_size(c));
    memcpy(head, bytes, sizeof *head);
    if (memcmp(head->guid, c->source.guid, GUID_SIZE) != 0 || head->size != size ||
        head->type != (uint64_t)c->type)
        return refuse(reason, "the bytes are no state of this FMU in this use of it");
    return true;
}

/* Memory for a state, that of an earlier one where there is one; NULL with a reason. */
static unsigned char *state_memory(const Component *c, const fmi2FMUstate *FMUstate, Reason *reason)
{
    StateHead head;
    if (*FMUstate)
        return read_head(c, *FMUstate, state_size(c), &head, reason) ? *FMUstate : NULL;
    unsigned char *bytes = c->memory.allocate(1, state_size(c));
    if (!bytes)
        refuse(reason, "the host's allocateMemory gave no memory");
    return bytes;
}

fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate *FMUstate)
{
    Component *c = legal(component, CALL_GetFMUstate);
    if (!c)
        return fmi2Error;
    if (!FMUstate)
        return no_state(c, CALL_GetFMUstate, "got a NULL pointer");
    Reason reason;
    unsigned char *bytes = state_memory(c, FMUstate, &reason);
    if (!bytes)
        return refused(c, CALL_GetFMUstate, fmi2Error, &reason);
    StateHead head = {.size = state_size(c),
                      .type = (uint64_t)c->type,
                      .mode = (uint64_t)c->mode,
                      .stop_defined = c->stop_defined,
                      .states_jumped = c->states_jumped,
                      .last_step = (uint64_t)c->last_step,
                      .stop = c->stop};
    memcpy(head.guid, c->source.guid, GUID_SIZE);
    memcpy(bytes, &head, sizeof head);
    save_state(c->instance, bytes + sizeof head);
    *FMUstate = bytes;
    return fmi2OK;
}

/* The mode is one of this type, and the instance's state is one of that mode. */
static bool consistent(const StateHead *head)
{
    uint64_t running = head->type == fmi2CoSimulation ? STEP_MODE : EVENT_MODE | CONTINUOUS_MODE;
    uint64_t possible = INSTANTIATED | INITIALIZATION_MODE | TERMINATED | running;
    bool one_mode = head->mode != 0 && (head->mode & (head->mode - 1)) == 0;
    return one_mode && (head->mode & possible) && head->stop_defined <= 1 && head->states_jumped <= 1 &&
           head->last_step <= fmi2Error && !(head->stop_defined && isnan(head->stop));
}

fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate FMUstate)
{
    Component *c = legal(component, CALL_SetFMUstate);
    if (!c)
        return fmi2Error;
    const unsigned char *bytes = FMUstate;
    StateHead head;
    Reason reason;
    if (!bytes)
        return no_state(c, CALL_SetFMUstate, "got a NULL pointer");
    if (!read_head(c, bytes, state_size(c), &head, &reason))
        return refused(c, CALL_SetFMUstate, fmi2Error, &reason);
    bool initialising = (head.mode & (INSTANTIATED | INITIALIZATION_MODE)) != 0;
    if (!consistent(&head))
        return no_state(c, CALL_SetFMUstate, "the state is damaged");
    if (!restore_state(c->instance, bytes + sizeof head, initialising, &reason))
        return refused(c, CALL_SetFMUstate, fmi2Error, &reason);
    c->mode = (Mode)head.mode;
    c->stop_defined = head.stop_defined == 1;
    c->states_jumped = head.states_jumped == 1;
    c->last_step = (fmi2Status)head.last_step;
    c->stop = head.stop;
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate *FMUstate)
{
    Component *c = legal(component, CALL_FreeFMUstate);
    if (!c)
        return fmi2Error;
    if (FMUstate && *FMUstate) {
        c->memory.release(*FMUstate);
        *FMUstate = NULL;
    }
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate FMUstate, size_t *size)
{
    Component *c = legal(component, CALL_SerializedFMUstateSize);
    if (!c)
        return fmi2Error;
    if (!FMUstate || !size)
        return no_state(c, CALL_SerializedFMUstateSize, "got a NULL pointer");
    StateHead head;
    Reason reason;
    if (!read_head(c, FMUstate, state_size(c), &head, &reason))
        return refused(c, CALL_SerializedFMUstateSize, fmi2Error, &reason);
    *size = state_size(c);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate FMUstate, fmi2Byte serializedState[],
                                 size_t size)
{
    Component *c = legal(component, CALL_SerializeFMUstate);
    if (!c)
        return fmi2Error;
    if (!FMUstate || !serializedState)
        return no_state(c, CALL_SerializeFMUstate, "got a NULL pointer");
    StateHead head;
    Reason reason;
    if (!read_head(c, FMUstate, state_size(c), &head, &reason))
        return refused(c, CALL_SerializeFMUstate, fmi2Error, &reason);
    if (size < state_size(c))
        return no_state(c, CALL_SerializeFMUstate, "got fewer bytes than fmi2SerializedFMUstateSize says");
    memcpy(serializedState, FMUstate, state_size(c));
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte serializedState[], size_t size,
                                   fmi2FMUstate *FMUstate)
{
    Component *c = legal(component, CALL_DeSerializeFMUstate);
    if (!c)
        return fmi2Error;
    if (!FMUstate || !serializedState)
        return no_state(c, CALL_DeSerializeFMUstate, "got a NULL pointer");
    StateHead head;
    Reason reason;
    if (!read_head(c, (const unsigned char *)serializedState, size, &head, &reason))
        return refused(c, CALL_DeSerializeFMUstate, fmi2Error, &reason);
    unsigned char *bytes = state_memory(c, FMUstate, &reason);
    if (!bytes)
        return refused(c, CALL_DeSerializeFMUstate, fmi2Error, &reason);
    memcpy(bytes, serializedState, size);
    *FMUstate = bytes;
    return fmi2OK;
}
