#include "component.h"

#include <stdio.h>
#include <string.h>

/* Names of the calls, what they are for and where they are legal, by Call. */
#define CALL_ENTRY(name, uses, modes) {"fmi2" #name, uses, modes},
static const struct {
    const char *name;
    unsigned int uses, modes;
} calls[] = {CALLS(CALL_ENTRY)};
#undef CALL_ENTRY

static const struct {
    const char *name;
    unsigned int bit;
} categories[] = {{"logStatusError", LOG_ERROR},
                  {"logStatusDiscard", LOG_DISCARD},
                  {"logStepSizes", LOG_STEP_SIZES},
                  {"logModel", LOG_MODEL},
                  {"logAll", LOG_ALL}};

static const char *mode_name(Mode mode)
{
    switch (mode) {
    case INSTANTIATED:
        return "before fmi2EnterInitializationMode";
    case INITIALIZATION_MODE:
        return "in initialization mode";
    case STEP_MODE:
        return "between the steps of a co-simulation";
    case EVENT_MODE:
        return "in event mode";
    case CONTINUOUS_MODE:
        return "in continuous-time mode";
    default:
        return "after fmi2Terminate";
    }
}

static const char *use_name(fmi2Type type)
{
    return type == fmi2CoSimulation ? "in a co-simulation" : "in model exchange";
}

unsigned int category_bit(const char *name)
{
    for (size_t k = 0; k < sizeof categories / sizeof *categories; k++)
        if (strcmp(name, categories[k].name) == 0)
            return categories[k].bit;
    return 0;
}

/* Escape a message for the logger, which takes it as printf takes a format, with # before a variable. */
static void escape(const char *message, char *format, size_t size)
{
    size_t length = 0;
    for (; *message && length + 2 < size; message++) {
        if (*message == '%' || *message == '#')
            format[length++] = *message;
        format[length++] = *message;
    }
    format[length] = 0;
}

void tell(const Component *c, fmi2Status status, Category category, const char *message)
{
    if (!c->callbacks.logger || !(c->logged & (unsigned int)category))
        return;
    char format[2 * MESSAGE_SIZE];
    escape(message, format, sizeof format);
    for (size_t k = 0; k < sizeof categories / sizeof *categories; k++)
        if (categories[k].bit == (unsigned int)category)
            c->callbacks.logger(c->callbacks.componentEnvironment, c->name, status, categories[k].name,
                                format);
}

fmi2Status refused(const Component *c, Call call, fmi2Status status, const Reason *reason)
{
    char message[MESSAGE_SIZE];
    snprintf(message, sizeof message, "%s: %s; nothing was changed", calls[call].name, reason->text);
    tell(c, status, status == fmi2Discard ? LOG_DISCARD : LOG_ERROR, message);
    return status;
}

Component *legal(fmi2Component component, Call call)
{
    Component *c = component;
    if (!c)
        return NULL;
    bool of_this_use = calls[call].uses & 1u << c->type;
    if (of_this_use && calls[call].modes & (unsigned int)c->mode)
        return c;
    Reason reason;
    refuse(&reason, "not legal %s", of_this_use ? mode_name(c->mode) : use_name(c->type));
    refused(c, call, fmi2Error, &reason);
    return NULL;
}
