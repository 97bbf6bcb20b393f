/* What inputs and outputs there are: their names, and for outputs the law that gives them.
 *
 * Most ports have the ordinary ones; the ports named gravity, base and energy have their own. */
#ifndef MODALFMU_KINDS_H
#define MODALFMU_KINDS_H

#include "model.h"

/* The law of an input is ACCELERATION where that is prescribed, else it means nothing. */
typedef struct {
    const char *name;
    Law law;
} Kind;

/* The variables that a port may have under one of its keys. */
typedef struct {
    size_t count;
    const Kind *kinds;
} Kinds;

INTERNAL Kinds inputs_of_port(const char *port);
INTERNAL Kinds outputs_of_port(const char *port);

#endif
