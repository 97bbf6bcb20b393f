/* The variables of the FMU: the value reference of a Real is its place among the Reals. */
#ifndef MODALFMU_VARIABLES_H
#define MODALFMU_VARIABLES_H

#include "model.h"

/* The groups of Reals in the order in which they stand. */
typedef enum {
    INPUT,
    OUTPUT,
    ALPHA,
    BETA,
    START, /* of s, then of s' */
    FREQUENCY,
    DAMPING_RATIO,
    AMPLITUDE, /* the coordinates x = [s; q]; and so on */
    MODAL_VELOCITY,
    AMPLITUDE_RATE,
    VELOCITY_RATE,
    NO_VARIABLE
} Group;

/* Where each group begins; the entry of NO_VARIABLE is the number of Reals. */
typedef struct {
    size_t start[NO_VARIABLE + 1];
} Layout;

INTERNAL Layout layout(const ReducedModel *model);

/* The group of a value reference; `place` becomes its number inside the group. */
INTERNAL Group group_of(const Layout *layout, unsigned int reference, size_t *place);

#endif
