#include "memory_files.h"

#include <string.h>

static bool read_from_memory(const void *context, const char *name, size_t limit, const Memory *memory,
                             Bytes *content, Reason *reason)
{
    const MemoryFiles *all = context;
    size_t k = 0;
    while (k < all->count && strcmp(all->files[k].name, name) != 0)
        k++;
    if (k == all->count)
        return refuse(reason, "%s: is missing", name);
    const MemoryFile *file = &all->files[k];
    if (file->size > limit)
        return refuse(reason, "%s: got %zu bytes, expected at most %zu", name, file->size, limit);
    content->bytes = memory->allocate(file->size > 0 ? file->size : 1, 1);
    if (!content->bytes)
        return refuse(reason, "%s: no memory", name);
    content->size = file->size;
    if (file->size > 0)
        memcpy(content->bytes, file->bytes, file->size);
    return true;
}

Files files_in_memory(const MemoryFiles *files)
{
    return (Files){read_from_memory, files};
}
