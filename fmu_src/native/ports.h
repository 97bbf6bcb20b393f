/* The ports of model.json: the single source of the names, the columns of B and the rows of C. */
#ifndef MODALFMU_PORTS_H
#define MODALFMU_PORTS_H

#include "header.h"

/* How much the ports take: inputs, outputs, and bytes of their names with the final 0 of each. */
typedef struct {
    size_t inputs, outputs, bytes;
} PortSizes;

/* Counts after checks: names are identifiers, none twice; variables are known ones, none twice in a port. */
INTERNAL bool check_ports(const Json *ports, PortSizes *sizes, const Memory *memory, Reason *reason);

/* Writes the names "port.force.x" of checked ports into `bytes` and where they are, and what outputs are. */
INTERNAL void name_variables(const Json *ports, char *bytes, const char **inputs, const char **outputs,
                             OutputKind *output_kinds);

#endif
