/* Memory that counts what is out and can run out. */
#ifndef COUNTING_MEMORY_H
#define COUNTING_MEMORY_H

#include "common.h"

extern const Memory counting_memory;

/* From now on so many allocations succeed, and then none. */
void allow_allocations(size_t count);

/* Blocks that were given out and not given back. */
size_t blocks_out(void);

#endif
