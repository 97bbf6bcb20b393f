/* The whole FMU in one file: compile this one, with the headers of FMI 2.0 on the include path.
 *
 * MODALFMU_EMBEDDED_MODEL: take the model from embedded_model.c instead of the resources; no file is read.
 * FMI2_FUNCTION_PREFIX: a prefix of the functions' names, for several FMUs in one program. */
#define MODALFMU_SINGLE_FILE

#include "common.c"
#include "model.c"
#include "propagator.c"
#include "kernels.c"
#include "coupled.c"
#include "coupling.c"
#include "variables.c"
#include "motion.c"
#include "outputs.c"
#include "instance.c"
#include "instance_memory.c"
#include "advance.c"
#include "reals.c"
#include "directional.c"
#include "saved_state.c"

#ifndef MODALFMU_EMBEDDED_MODEL
#include "json_scalars.c"
#include "json.c"
#include "sha256.c"
#include "npy.c"
#include "kinds.c"
#include "ports.c"
#include "header.c"
#include "folder.c"
#include "resources.c"
#include "location.c"
#endif

#include "part_source.c"
#include "component.c"
#include "fmi2_life.c"
#include "fmi2_variables.c"
#include "fmi2_derivatives.c"
#include "fmi2_cosimulation.c"
#include "fmi2_model_exchange.c"
#include "fmi2_state.c"
