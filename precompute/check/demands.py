"""Every finding by its name: how grave it is, what is demanded, its place in FMI 2.0.4, how to mend it."""

from collections.abc import Mapping

from .finding import Demand, Severity


def _demand(severity: Severity, clause: str, demands: str, mend: str) -> Demand:
    return Demand(severity, demands, clause, mend)


DEMANDS: Mapping[str, Demand] = {
    # --- the library
    "library-loads": _demand(
        "error",
        "2.3",
        "the library loads on the platform whose folder it lies in",
        "link what it needs into it, or ship it beside it",
    ),
    "missing-function": _demand(
        "error",
        "2.3",
        "all functions of a co-simulation FMU are there",
        "export it; what is not supported returns fmi2Error",
    ),
    "version": _demand(
        "error",
        "2.1.4",
        "fmi2GetVersion gives 2.0, fmi2GetTypesPlatform default",
        "return those of the headers",
    ),
    "instantiation": _demand(
        "error", "2.1.5", "with the right arguments fmi2Instantiate gives an instance", "see what it logged"
    ),
    "initialisation": _demand(
        "error",
        "2.1.6",
        "fmi2SetupExperiment, Enter- and ExitInitializationMode succeed with the start values",
        "choose start values with which the model can begin",
    ),
    "first-step": _demand("error", "4.2.2", "the first step succeeds", "see what it logged"),
    "legal-call-refused": _demand(
        "error",
        "4.2.4",
        "a call that is legal where it is made succeeds",
        "allow it in this state, or see what it logged",
    ),
    "crash": _demand(
        "error", "2.1.3", "no call takes the master's process along", "debug the call that is named"
    ),
    "hang": _demand("error", "4.2.2", "every call comes to an end", "debug the call that is named"),
    # --- instances
    "not-repeatable": _demand(
        "warning",
        "4.1.1",
        "the same inputs give the same outputs",
        "initialise all memory; draw random numbers from a seed that is a parameter",
    ),
    "second-instance": _demand(
        "error",
        "2.1.5",
        "instances do not know of each other",
        "keep nothing in static variables, or declare canBeInstantiatedOnlyOncePerProcess",
    ),
    "reset": _demand(
        "error",
        "2.1.6",
        "after fmi2Reset an instance is as after fmi2Instantiate",
        "set every variable and state back",
    ),
    "guid-mismatch-accepted": _demand(
        "error",
        "2.1.5",
        "fmi2Instantiate compares the GUID with its own and gives NULL where it is another",
        "compile the GUID in, or read it from the resources, and compare",
    ),
    "instantiation-silent": _demand(
        "warning",
        "2.1.5",
        "where fmi2Instantiate gives NULL, the logger is told why",
        "call the logger before",
    ),
    "resource-location": _demand(
        "error",
        "2.1.5",
        "fmuResourceLocation is a URI: file:///path and file:/path, with escaped characters",
        "take the scheme off and undo the %xx",
    ),
    "free-null": _demand("error", "2.1.5", "fmi2FreeInstance of NULL does nothing", "return at once"),
    "null-callbacks": _demand(
        "error",
        "2.1.5",
        "with canNotUseMemoryManagementFunctions allocateMemory and freeMemory may be NULL",
        "do not call them, or take the flag off",
    ),
    "pointer-kept": _demand(
        "error",
        "2.1.5",
        "arguments of fmi2Instantiate, the callbacks' struct too, are valid during the call only",
        "copy the struct and the texts",
    ),
    "memory-misuse": _demand(
        "error",
        "2.1.5",
        "memory of allocateMemory is used within its bounds and freed once",
        "find it with a sanitizer",
    ),
    "memory-leak": _demand(
        "error", "2.1.5", "fmi2FreeInstance frees all that allocateMemory gave", "free what is named"
    ),
    "memory-functions": _demand(
        "warning",
        "2.1.5",
        "with canNotUseMemoryManagementFunctions the host's functions are not called",
        "take the flag off",
    ),
    "get-after-terminate": _demand(
        "error",
        "2.1.6",
        "the final values can be read after fmi2Terminate",
        "keep them until fmi2FreeInstance",
    ),
    # --- state
    "state-restore": _demand(
        "error",
        "2.1.8",
        "what follows a restored state is what followed it before, to the bit",
        "save and restore everything that a later call reads",
    ),
    "state-inputs": _demand(
        "error", "2.1.8", "the state holds the values of the inputs", "save the inputs too"
    ),
    "state-parameters": _demand(
        "error",
        "2.1.8",
        "the state holds the values of the parameters",
        "save them, and what was made of them",
    ),
    "state-overwrite": _demand(
        "error",
        "2.1.8",
        "fmi2GetFMUstate into a state that is there puts the actual one into it",
        "copy into it",
    ),
    "state-free": _demand(
        "error",
        "2.1.8",
        "fmi2FreeFMUstate ignores a NULL state and gives a null pointer back",
        "set *FMUstate to NULL",
    ),
    "serialise-size": _demand(
        "error",
        "2.1.8",
        "fmi2SerializeFMUstate keeps to the size that it named",
        "name the size that is written",
    ),
    "serialise-roundtrip": _demand(
        "error",
        "2.1.8",
        "a state made from its bytes is the state they were made of",
        "write values, not pointers, and all of them",
    ),
    # --- order of calls
    "step-before-initialisation": _demand(
        "warning",
        "4.2.4",
        "fmi2DoStep is legal after fmi2ExitInitializationMode only",
        "keep the mode, and return fmi2Error in others",
    ),
    "step-after-terminate": _demand(
        "warning", "4.2.4", "fmi2DoStep is not legal after fmi2Terminate", "return fmi2Error"
    ),
    "set-after-terminate": _demand(
        "warning", "4.2.4", "fmi2SetXXX is not legal after fmi2Terminate", "return fmi2Error"
    ),
    "get-before-initialisation": _demand(
        "warning", "4.2.4", "fmi2GetXXX is legal from fmi2EnterInitializationMode on", "return fmi2Error"
    ),
    "wrong-mode": _demand(
        "warning",
        "4.2.4",
        "each call is legal in the modes of the table only",
        "keep the mode, return fmi2Error",
    ),
    "step-zero": _demand(
        "warning", "4.2.2", "communicationStepSize is greater than 0", "return fmi2Error where it is not"
    ),
    "time-going-back": _demand(
        "warning",
        "4.2.2",
        "currentCommunicationPoint is where the last step ended, unless a state was restored",
        "keep the time, and return fmi2Error where it differs by more than rounding",
    ),
    "time-gap": _demand(
        "warning",
        "4.2.2",
        "currentCommunicationPoint is where the last step ended",
        "keep the time, and return fmi2Error where it differs by more than rounding",
    ),
    "past-stop-time": _demand(
        "error",
        "2.1.6",
        "a step past the stop time of fmi2SetupExperiment is fmi2Error",
        "keep stopTime and compare",
    ),
    "unknown-reference-accepted": _demand(
        "warning",
        "2.1.7",
        "value references are those of the model description",
        "return fmi2Error for others",
    ),
    "empty-call-refused": _demand(
        "note", "2.1.7", "a call for no variables does nothing", "return fmi2OK where nvr is 0"
    ),
    # --- values
    "start-values": _demand(
        "error",
        "2.2.7",
        "variables with initial=exact and inputs begin with their start values",
        "take the start values of model description and code from one source",
    ),
    "set-lost": _demand(
        "error", "2.1.7", "what is set stays until it is set again", "store it, and give it back when asked"
    ),
    "set-constant": _demand("warning", "2.2.7", "constants cannot be set", "return fmi2Error"),
    "set-output": _demand("warning", "4.2.4", "between steps outputs cannot be set", "return fmi2Error"),
    "set-fixed": _demand(
        "warning",
        "4.2.4",
        "fixed parameters cannot be set after initialisation",
        "return fmi2Error, or declare it tunable",
    ),
    "not-finite": _demand(
        "error", "2.1.3", "a step of fmi2OK gives numbers", "return fmi2Discard or fmi2Error with the reason"
    ),
    "out-of-range": _demand(
        "warning", "2.2.7", "values keep to their min and max", "widen the range that is declared"
    ),
    "nan-accepted": _demand(
        "note",
        "4.2.2",
        "a step that cannot be made with its inputs or parameters is fmi2Error or fmi2Discard",
        "refuse values that are no numbers",
    ),
    "reading-changes": _demand(
        "error", "2.1.7", "fmi2GetXXX changes nothing", "compute what is read, and leave the state alone"
    ),
    "array-overrun": _demand("error", "2.1.7", "fmi2GetXXX writes nvr values", "count them"),
    "string-kept": _demand("error", "2.1.7", "fmi2SetString copies the texts", "copy them"),
    # --- steps
    "step-refused": _demand(
        "error", "4.2.2", "steps with inputs near their start values succeed", "see what it logged"
    ),
    "variable-step": _demand(
        "error",
        "4.3.1",
        "with canHandleVariableCommunicationStepSize each step goes to currentCommunicationPoint + size",
        "use the size that is given, or take the flag off",
    ),
    "start-time": _demand(
        "error", "4.2.2", "the first step begins at startTime of fmi2SetupExperiment", "begin where it says"
    ),
    "time-rounding": _demand(
        "warning",
        "4.2.2",
        "a communication point differs from the FMU's own time by rounding",
        "compare with a tolerance",
    ),
    "step-status": _demand(
        "error",
        "4.2.3",
        "fmi2GetXXXStatus tells of the last step, or gives fmi2Discard",
        "keep its end and its status",
    ),
    "time-variable": _demand(
        "error",
        "4.2.2",
        "a step ends exactly at currentCommunicationPoint + communicationStepSize",
        "set the time so",
    ),
    # --- messages
    "logger-category": _demand(
        "error",
        "2.1.5",
        "messages have a category of LogCategories, NULL where there are none",
        "declare what is used",
    ),
    "logger-instance": _demand(
        "error", "2.1.5", "messages carry the name of the instance that sends them", "keep a copy of the name"
    ),
    "logger-environment": _demand(
        "error", "2.1.5", "the logger gets componentEnvironment as its first argument", "pass it on"
    ),
    "logger-line": _demand("note", "2.1.5", "messages have no trailing line break", "leave it out"),
    "logger-off": _demand(
        "warning", "2.1.5", "with loggingOn = fmi2False there is no debug logging", "ask before each message"
    ),
    "debug-logging": _demand(
        "error",
        "2.1.5",
        "fmi2SetDebugLogging takes the declared categories",
        "know them, or do not declare them",
    ),
    # --- structure and derivatives
    "dependencies-missing": _demand(
        "error",
        "2.2.8",
        "an unknown depends on nothing that its dependencies do not list",
        "list it, or leave the attribute out: then it depends on everything",
    ),
    "dependencies-unused": _demand(
        "note",
        "2.2.8",
        "dependencies list what the unknown depends on",
        "take it off, if it vanishes everywhere",
    ),
    "directional-derivative": _demand(
        "error",
        "2.1.9",
        "fmi2GetDirectionalDerivative gives the partial derivatives of what fmi2GetReal gives",
        "derive what is computed; central differences here are right to some 1e-6",
    ),
    "directional-seed": _demand(
        "error", "2.1.9", "the derivative is linear in its seed", "add the columns, each times its seed"
    ),
    "input-derivative": _demand(
        "error",
        "4.2.1",
        "with canInterpolateInputs the derivatives of the inputs have their effect on the next step",
        "let the inputs follow the polynomial from the beginning of the step",
    ),
    "input-derivative-kept": _demand(
        "warning",
        "4.2.1",
        "derivatives of inputs are set for the beginning of one step",
        "forget them when the step is made",
    ),
    "derivative": _demand(
        "error",
        "2.2.7",
        "a variable with the attribute derivative is that derivative",
        "compute it at the same time",
    ),
    "derivative-order-zero": _demand("warning", "4.2.1", "orders begin at 1", "return fmi2Error"),
    "output-derivative": _demand(
        "error",
        "4.2.1",
        "derivatives of outputs, up to maxOutputDerivativeOrder, are those at the end of the step",
        "derive the outputs, or declare a lower order",
    ),
    # --- memory
    "memory-growth": _demand(
        "error",
        "2.1.5",
        "what is repeated takes no more memory each time",
        "free it; valgrind or a sanitizer names it",
    ),
    # --- model description
    "model-description": _demand(
        "error",
        "2.2",
        "modelDescription.xml is valid by the schema and the rules of its elements",
        "as FMPy says",
    ),
    "range": _demand("error", "2.2.7", "min ≤ start ≤ max, and nominal is not 0", "choose them so"),
    "model-structure": _demand(
        "error",
        "2.2.8",
        "indices of ModelStructure are those of variables, in order",
        "count from 1",
    ),
    "dependencies-unknown": _demand(
        "warning",
        "2.2.8",
        "dependencies are on inputs, states and time; of InitialUnknowns also on what has initial=exact",
        "leave the others out: they do not change there",
    ),
    "state-dependencies": _demand(
        "note",
        "2.2.8",
        "without providesDirectionalDerivative a co-simulation FMU does not list dependencies on states",
        "leave the states out",
    ),
    "alias": _demand(
        "error",
        "2.1.7",
        "variables with one value reference are one value",
        "give each value a reference of its own",
    ),
    "capabilities": _demand(
        "error", "4.3.1", "canSerializeFMUstate needs canGetAndSetFMUstate", "declare both"
    ),
    "default-experiment": _demand(
        "warning", "2.2.5", "stopTime is after startTime, stepSize greater than 0", "choose so"
    ),
    "files-missing": _demand(
        "error", "2.3", "files that are listed are in the FMU", "add them, or do not list them"
    ),
    "unit-undefined": _demand("error", "2.2.2", "units of variables are in UnitDefinitions", "define them"),
    "unit-definition": _demand(
        "error",
        "2.2.2",
        "a BaseUnit has the exponents, factor and offset of its unit",
        "count the SI base units",
    ),
    "unit-derivative": _demand(
        "warning",
        "2.2.7",
        "the unit of a derivative is that of its variable by second",
        "correct one of them",
    ),
}
