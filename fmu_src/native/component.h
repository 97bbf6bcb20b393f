/* What stands behind an fmi2Component: an instance, its mode, and the log. */
#ifndef MODALFMU_COMPONENT_H
#define MODALFMU_COMPONENT_H

#include "instance.h"
#include "part_source.h"

#include "fmi2_names.h"

/* The states of FMI 2.0 (sections 3.2.3 and 4.2.4); a refused call leaves the state as it was. */
typedef enum {
    INSTANTIATED = 1,
    INITIALIZATION_MODE = 2,
    STEP_MODE = 4,        /* co-simulation, between two steps */
    EVENT_MODE = 8,       /* model exchange */
    CONTINUOUS_MODE = 16, /* model exchange */
    TERMINATED = 32
} Mode;

/* The uses of the FMU, as bits. */
#define MODEL_EXCHANGE (1 << fmi2ModelExchange)
#define CO_SIMULATION (1 << fmi2CoSimulation)
#define BOTH (MODEL_EXCHANGE | CO_SIMULATION)

/* Every call on a component, the uses that it is for, and the modes in which it is legal. */
#define ANY_MODE (INSTANTIATED | INITIALIZATION_MODE | STEP_MODE | EVENT_MODE | CONTINUOUS_MODE | TERMINATED)
#define AFTER_START (INITIALIZATION_MODE | STEP_MODE | EVENT_MODE | CONTINUOUS_MODE | TERMINATED)
#define CALLS(CALL)                                                                                          \
    CALL(SetDebugLogging, BOTH, ANY_MODE)                                                                    \
    CALL(SetupExperiment, BOTH, INSTANTIATED)                                                                \
    CALL(EnterInitializationMode, BOTH, INSTANTIATED)                                                        \
    CALL(ExitInitializationMode, BOTH, INITIALIZATION_MODE)                                                  \
    CALL(Terminate, BOTH, STEP_MODE | EVENT_MODE | CONTINUOUS_MODE)                                          \
    CALL(Reset, BOTH, ANY_MODE)                                                                              \
    CALL(GetReal, BOTH, AFTER_START)                                                                         \
    CALL(GetInteger, BOTH, AFTER_START)                                                                      \
    CALL(GetBoolean, BOTH, AFTER_START)                                                                      \
    CALL(GetString, BOTH, AFTER_START)                                                                       \
    CALL(SetReal, BOTH, INSTANTIATED | INITIALIZATION_MODE | STEP_MODE | EVENT_MODE | CONTINUOUS_MODE)       \
    CALL(SetInteger, BOTH, INSTANTIATED | INITIALIZATION_MODE | STEP_MODE | EVENT_MODE)                      \
    CALL(SetBoolean, BOTH, INSTANTIATED | INITIALIZATION_MODE | STEP_MODE | EVENT_MODE)                      \
    CALL(SetString, BOTH, INSTANTIATED | INITIALIZATION_MODE | STEP_MODE | EVENT_MODE)                       \
    CALL(GetFMUstate, BOTH, ANY_MODE)                                                                        \
    CALL(SetFMUstate, BOTH, ANY_MODE)                                                                        \
    CALL(FreeFMUstate, BOTH, ANY_MODE)                                                                       \
    CALL(SerializedFMUstateSize, BOTH, ANY_MODE)                                                             \
    CALL(SerializeFMUstate, BOTH, ANY_MODE)                                                                  \
    CALL(DeSerializeFMUstate, BOTH, ANY_MODE)                                                                \
    CALL(GetDirectionalDerivative, BOTH, AFTER_START)                                                        \
    CALL(SetRealInputDerivatives, CO_SIMULATION, INSTANTIATED | INITIALIZATION_MODE | STEP_MODE)             \
    CALL(GetRealOutputDerivatives, CO_SIMULATION, STEP_MODE | TERMINATED)                                    \
    CALL(DoStep, CO_SIMULATION, STEP_MODE)                                                                   \
    CALL(CancelStep, CO_SIMULATION, 0) /* no step is asynchronous */                                         \
    CALL(GetStatus, CO_SIMULATION, STEP_MODE | TERMINATED)                                                   \
    CALL(GetRealStatus, CO_SIMULATION, STEP_MODE | TERMINATED)                                               \
    CALL(GetIntegerStatus, CO_SIMULATION, STEP_MODE | TERMINATED)                                            \
    CALL(GetBooleanStatus, CO_SIMULATION, STEP_MODE | TERMINATED)                                            \
    CALL(GetStringStatus, CO_SIMULATION, STEP_MODE | TERMINATED)                                             \
    CALL(EnterEventMode, MODEL_EXCHANGE, EVENT_MODE | CONTINUOUS_MODE)                                       \
    CALL(NewDiscreteStates, MODEL_EXCHANGE, EVENT_MODE)                                                      \
    CALL(EnterContinuousTimeMode, MODEL_EXCHANGE, EVENT_MODE)                                                \
    CALL(CompletedIntegratorStep, MODEL_EXCHANGE, CONTINUOUS_MODE)                                           \
    CALL(SetTime, MODEL_EXCHANGE, EVENT_MODE | CONTINUOUS_MODE)                                              \
    CALL(SetContinuousStates, MODEL_EXCHANGE, CONTINUOUS_MODE)                                               \
    CALL(GetDerivatives, MODEL_EXCHANGE, AFTER_START)                                                        \
    CALL(GetEventIndicators, MODEL_EXCHANGE, AFTER_START)                                                    \
    CALL(GetContinuousStates, MODEL_EXCHANGE, AFTER_START)                                                   \
    CALL(GetNominalsOfContinuousStates, MODEL_EXCHANGE, ANY_MODE)

#define CALL_NAME(name, uses, modes) CALL_##name,
typedef enum { CALLS(CALL_NAME) NUMBER_OF_CALLS } Call;
#undef CALL_NAME

#define MESSAGE_SIZE (sizeof(Reason) + 64) /* of a reason and the name of a call */

/* Log categories, as bits. */
typedef enum { LOG_ERROR = 1, LOG_DISCARD = 2, LOG_STEP_SIZES = 4, LOG_MODEL = 8, LOG_ALL = 15 } Category;

typedef struct {
    Instance *instance;
    Source source;
    Memory memory;
    fmi2CallbackFunctions callbacks;
    fmi2Type type;
    Mode mode;
    unsigned int logged; /* categories */
    bool stop_defined;
    double stop;
    fmi2Status last_step; /* what the last fmi2DoStep returned */
    bool states_jumped;   /* modes were switched off since fmi2NewDiscreteStates */
    char *name;
} Component;

/* The component, if there is one and the call is legal in its mode; else NULL, and the log says why. */
INTERNAL Component *legal(fmi2Component component, Call call);

/* Log why a call is refused; gives `status`, fmi2Error or fmi2Discard. */
INTERNAL fmi2Status refused(const Component *component, Call call, fmi2Status status, const Reason *reason);

/* A message of this category, shorter than MESSAGE_SIZE, if it is wanted. */
INTERNAL void tell(const Component *component, fmi2Status status, Category category, const char *message);

/* The bit of a category's name, 0 where there is none. */
INTERNAL unsigned int category_bit(const char *name);

#endif
