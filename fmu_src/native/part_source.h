/* Where an FMU's model comes from: the resources, or C arrays that were compiled in. */
#ifndef MODALFMU_PART_SOURCE_H
#define MODALFMU_PART_SOURCE_H

#include "model.h"

typedef struct {
    const ReducedModel *model;
    char guid[GUID_SIZE];
} Source;

/* The model and the GUID of the FMU whose resources are at this URI; false with a reason. */
INTERNAL bool open_source(Source *source, const char *location, const Memory *memory, Reason *reason);
INTERNAL void close_source(const Source *source, const Memory *memory);

#endif
