/* The FMI 2.0 functions; with FMI2_FUNCTION_PREFIX before their names, also where the header ignores it. */
#ifndef MODALFMU_FMI2_NAMES_H
#define MODALFMU_FMI2_NAMES_H

#include "fmi2Functions.h"

#ifdef FMI2_FUNCTION_PREFIX
#define JOINED_NAME(prefix, name) prefix##name
#define PREFIXED_NAME(prefix, name) JOINED_NAME(prefix, name)
#undef fmi2FullName
#define fmi2FullName(name) PREFIXED_NAME(FMI2_FUNCTION_PREFIX, name)
#endif

#endif
