/* The ports of model.json: the single source of the names, the columns of B and the rows of C and R. */
#ifndef MODALFMU_PORTS_H
#define MODALFMU_PORTS_H

#include "header.h"

/* How much the ports take: inputs, outputs, rows of the outputs, and bytes of their names with the final 0 of
 * each. */
typedef struct {
    size_t inputs, outputs, rows, bytes;
} PortSizes;

/* Counts after checks: names are identifiers, none twice; variables are ones that a port of this name may
 * have, none twice in a port. */
INTERNAL bool check_ports(const Json *ports, PortSizes *sizes, const Memory *memory, Reason *reason);

/* How many inputs of checked ports prescribe an acceleration; `places`, if it is given, becomes the places of
 * these among the inputs. */
INTERNAL size_t prescribed_motions(const Json *ports, size_t *places);

/* Writes the names "port.force.x" of checked ports into `bytes` and where they are, and the laws of outputs.
 */
INTERNAL void name_variables(const Json *ports, char *bytes, const char **inputs, const char **outputs,
                             Law *laws);

#endif
