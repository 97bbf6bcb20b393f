/* two_parts GUID GUID INPUTS REALS STEPS: two FMUs linked into one program, their names prefixed. */
#include "master.h"

#define PART(prefix)                                                                                         \
    fmi2InstantiateTYPE prefix##_fmi2Instantiate;                                                            \
    fmi2SetupExperimentTYPE prefix##_fmi2SetupExperiment;                                                    \
    fmi2EnterInitializationModeTYPE prefix##_fmi2EnterInitializationMode;                                    \
    fmi2ExitInitializationModeTYPE prefix##_fmi2ExitInitializationMode;                                      \
    fmi2SetRealTYPE prefix##_fmi2SetReal;                                                                    \
    fmi2GetRealTYPE prefix##_fmi2GetReal;                                                                    \
    fmi2DoStepTYPE prefix##_fmi2DoStep;                                                                      \
    fmi2TerminateTYPE prefix##_fmi2Terminate;                                                                \
    fmi2FreeInstanceTYPE prefix##_fmi2FreeInstance;                                                          \
    static const Functions prefix = {prefix##_fmi2Instantiate,                                               \
                                     prefix##_fmi2SetupExperiment,                                           \
                                     prefix##_fmi2EnterInitializationMode,                                   \
                                     prefix##_fmi2ExitInitializationMode,                                    \
                                     prefix##_fmi2SetReal,                                                   \
                                     prefix##_fmi2GetReal,                                                   \
                                     prefix##_fmi2DoStep,                                                    \
                                     prefix##_fmi2Terminate,                                                 \
                                     prefix##_fmi2FreeInstance};

PART(soft)
PART(stiff)

int main(int count, char **given)
{
    if (count != 6)
        return 2;
    unsigned int inputs = (unsigned int)atoi(given[3]), reals = (unsigned int)atoi(given[4]);
    int steps = atoi(given[5]);
    int line = run(&soft, given[1], "", inputs, reals, steps);
    if (!line)
        line = run(&stiff, given[2], "", inputs, reals, steps);
    return line;
}
