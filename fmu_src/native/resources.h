/* The reader of the resources: model.json and one .npy file per array, nothing used before it is checked:
 * model.json holds the checksums of the arrays, model.sha256 that of model.json. */
#ifndef MODALFMU_RESOURCES_H
#define MODALFMU_RESOURCES_H

#include "model.h"

/* A file's content, allocated by Memory. */
typedef struct {
    unsigned char *bytes;
    size_t size;
} Bytes;

/* Where files come from: `read` gives one file by its name below `resources/`, such as "model/lam.npy",
 * or refuses with a reason. */
typedef struct {
    bool (*read)(const void *context, const char *name, size_t limit, const Memory *memory, Bytes *content,
                 Reason *reason);
    const void *context;
} Files;

/* The folder's path in UTF-8 without its final slash, as `resource_location` gives it. */
INTERNAL Files files_of_folder(const char *folder);

/* The model that `write_model` of the Python side described, or NULL with a reason. Freed by `free_model`. */
INTERNAL const ReducedModel *read_model(const Files *files, const Memory *memory, Reason *reason);
INTERNAL void free_model(const ReducedModel *model, const Memory *memory);

/* The GUID of the FMU: resources/guid.txt, one line. */
INTERNAL bool read_guid(const Files *files, const Memory *memory, char guid[GUID_SIZE], Reason *reason);

#endif
