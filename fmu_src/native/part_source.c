#include "part_source.h"

#ifdef MODALFMU_EMBEDDED_MODEL

#include "embedded_model.c"

#include <string.h>

bool open_source(Source *source, const char *location, const Memory *memory, Reason *reason)
{
    (void)location;
    (void)memory;
    (void)reason;
    source->model = &embedded_model;
    memcpy(source->guid, embedded_guid, sizeof embedded_guid);
    return true;
}

void close_source(const Source *source, const Memory *memory)
{
    (void)source;
    (void)memory;
}

#else

#include "location.h"
#include "resources.h"

bool open_source(Source *source, const char *location, const Memory *memory, Reason *reason)
{
    char *folder = resource_location(location, memory, reason);
    if (!folder)
        return false;
    Files files = files_of_folder(folder);
    source->model = NULL;
    if (read_guid(&files, memory, source->guid, reason))
        source->model = read_model(&files, memory, reason);
    memory->release(folder);
    return source->model != NULL;
}

void close_source(const Source *source, const Memory *memory)
{
    free_model(source->model, memory);
}

#endif
