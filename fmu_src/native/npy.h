/* Arrays of doubles in NumPy's file format, version 1.0. */
#ifndef MODALFMU_NPY_H
#define MODALFMU_NPY_H

#include "resources.h"

#define NPY_HEADER_LIMIT (10 + 0xFFFF) /* bytes before the numbers, at most */

/* The numbers of an array of `dimensions` 1 or 2 and this shape, rows one after the other: unpacked in place,
 * from the content's first byte on. NULL where the content is not exactly such a file. */
INTERNAL double *unpack_npy(const Bytes *content, int dimensions, const size_t shape[2]);

#endif
