/* Resource files that are bytes in memory, each copied into a block of exactly its size. */
#ifndef MEMORY_FILES_H
#define MEMORY_FILES_H

#include "resources.h"

typedef struct {
    const char *name;
    const unsigned char *bytes;
    size_t size;
} MemoryFile;

typedef struct {
    const MemoryFile *files;
    size_t count;
} MemoryFiles;

Files files_in_memory(const MemoryFiles *files);

#endif
