/* fmuResourceLocation, a file URI, as the path of a folder. */
#ifndef MODALFMU_LOCATION_H
#define MODALFMU_LOCATION_H

#include "common.h"

/* The UTF-8 path of a URI such as file:///C:/a%20b/resources, allocated by Memory, without a final slash;
 * NULL with a reason where it is none. */
INTERNAL char *resource_location(const char *uri, const Memory *memory, Reason *reason);

/* The same by the rules of Windows, where paths have drives and servers, or by those of the other systems. */
INTERNAL char *location_path(const char *uri, bool windows, const Memory *memory, Reason *reason);

#endif
