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
}
