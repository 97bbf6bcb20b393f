/* Fuzz target of the sequence of calls: whatever a host calls, in any order and with any arguments, nothing
 * crashes or leaks, a refused call leaves the serialised state as it was, and a step replayed gives the same
 * bits.
 *
 * An input is a byte for the allocation that fails (255: none), then calls: a byte for the instance, a byte
 * for the call, and its arguments. Where the input ends, bytes are 0. The model is that of embedded_model.c.
 */
#include "modalfmu.c"

#include "counting_memory.h"
#include "kinds_of_calls.h"

#define INSTANCES 3
#define LONGEST 300 /* calls */

static fmi2Component instances[INSTANCES];

static void check_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                          fmi2String category, fmi2String format, ...)
{
    (void)environment;
    va_list arguments;
    char text[1024];
    va_start(arguments, format);
    int length = vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    must(name && status <= fmi2Error && category_bit(category) && length > 0 && !strchr(text, '\n'));
}

/* The serialised state, whatever the host's memory; but for `last_step`, which tells of the refused step
 * itself. */
static size_t state_of(Component *c, unsigned char *bytes)
{
    motion(c->instance, 0); /* a static start is settled when it is looked at */
    StateHead head = {.size = state_size(c),
                      .type = (uint64_t)c->type,
                      .mode = (uint64_t)c->mode,
                      .stop_defined = c->stop_defined,
                      .states_jumped = c->states_jumped,
                      .stop = c->stop};
    memcpy(head.guid, c->source.guid, GUID_SIZE);
    memcpy(bytes, &head, sizeof head);
    save_state(c->instance, bytes + sizeof head);
    return state_size(c);
}

static fmi2Component new_component(Input *input)
{
    static const fmi2CallbackFunctions without = {NULL, NULL, NULL, NULL, NULL};
    fmi2CallbackFunctions callbacks = {check_message, counting_memory.allocate, counting_memory.release, NULL,
                                       NULL};
    unsigned int kind = byte(input);
    if (kind & 4)
        callbacks.freeMemory = kind & 8 ? NULL : callbacks.freeMemory;
    const fmi2CallbackFunctions *given = kind == 255 ? NULL : kind == 254 ? &without : &callbacks;
    const char *guid = kind & 16 ? (kind & 32 ? NULL : "{another}") : embedded_guid;
    fmi2Type type = kind & 64 ? (fmi2Type)(kind % 8) : (fmi2Type)(kind & 1);
    return fmi2Instantiate(kind & 2 && kind & 128 ? "" : "one", type, guid, NULL, given, fmi2False, kind & 1);
}

/* A step; one that is made ends later than it began, and gives the same bits once more from the same state.
 */
static fmi2Status step_call(fmi2Component component, Input *input)
{
    Component *c = component;
    bool on_time = byte(input) < 230;
    double h = real(input), t = on_time && c ? c->instance->time : real(input);
    unsigned char before[4096], once[4096], again[4096];
    if (c)
        state_of(c, before);
    fmi2Status status = fmi2DoStep(c, t, h, fmi2True);
    if (status != fmi2OK)
        return status;
    size_t size = state_of(c, once);
    const Instance *x = c->instance;
    must(x->time == t + h && x->time >= t && h > 0.0);
    must(!x->rates_given &&
         x->kept[x->newest[0]].h == h); /* its own coefficients; derivatives hold for one step */
    for (size_t i = 0; i < x->n; i++)
        must(isfinite(x->motion[0][i]) && isfinite(x->motion[1][i]) &&
             (i < x->active || x->motion[0][i] == 0.0));
    must(fmi2SetFMUstate(c, before) == fmi2OK);
    must(fmi2DoStep(c, t, h, fmi2True) == fmi2OK);
    state_of(c, again);
    must(memcmp(once, again, size) == 0);
    return fmi2OK;
}

static void one_call(Input *input)
{
    unsigned int place = byte(input), call = byte(input) % 46u;
    fmi2Component *c = &instances[place % INSTANCES];
    unsigned char before[4096], after[4096];
    if (call == 45) {
        fmi2FreeInstance(*c);
        *c = NULL;
        return;
    }
    if (!*c) {
        *c = new_component(input);
        return;
    }
    fmi2Component given = place == 255 ? NULL : *c;
    size_t size = state_of(*c, before);
    fmi2Status status = call < 12   ? life_call(given, call, input)
                        : call < 23 ? values_call(given, call - 12, input)
                        : call < 27 ? state_call(given, call - 23, input)
                        : call < 37 ? exchange_call(given, call - 27, input)
                                    : step_call(given, input);
    must(status == fmi2OK || status == fmi2Error || status == fmi2Discard);
    state_of(*c, after);
    must(status == fmi2OK || memcmp(before, after, size) == 0);
    size_t active = ((Component *)*c)->instance->active;
    must(active >= embedded_model.k && active <= embedded_model.n);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    Input input = {data, size};
    unsigned int allocations = byte(&input);
    allow_allocations(allocations == 255 ? SIZE_MAX : allocations);
    for (int k = 0; k < LONGEST && input.size > 0; k++)
        one_call(&input);
    for (size_t k = 0; k < SLOTS; k++) {
        if (slots[k])
            counting_memory.release(slots[k]);
        slots[k] = NULL;
    }
    for (size_t k = 0; k < INSTANCES; k++) {
        fmi2FreeInstance(instances[k]);
        instances[k] = NULL;
    }
    must(blocks_out() == 0);
    return 0;
}
