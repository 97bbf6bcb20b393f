#include "npy.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* Where the numbers begin; 0 where the header is not the one that numpy.save writes for this shape:
 * magic, version 1.0, length of the rest, a dictionary, spaces, a newline. */
static size_t npy_start(const Bytes *content, int dimensions, const size_t shape[2])
{
    const unsigned char *bytes = content->bytes;
    char expected[120], columns[24] = "";
    if (dimensions == 2)
        snprintf(columns, sizeof columns, " %zu", shape[1]);
    int length = snprintf(expected, sizeof expected,
                          "{'descr': '<f8', 'fortran_order': False, 'shape': (%zu,%s), }", shape[0], columns);
    if (content->size < 10 || memcmp(bytes, "\x93NUMPY\x01\x00", 8) != 0)
        return 0;
    size_t k = 10 + (size_t)length, start = 10 + (size_t)(bytes[8] | bytes[9] << 8);
    if (start > content->size || start <= k || memcmp(bytes + 10, expected, (size_t)length) != 0)
        return 0;
    while (bytes[k] == ' ' && k < start - 1)
        k++;
    return k == start - 1 && bytes[k] == '\n' ? start : 0;
}

double *unpack_npy(const Bytes *content, int dimensions, const size_t shape[2])
{
    size_t start = npy_start(content, dimensions, shape);
    uint64_t count = (uint64_t)shape[0] * (dimensions == 2 ? shape[1] : 1);
    if (start == 0 || (content->size - start) % 8 != 0 || (content->size - start) / 8 != count)
        return NULL;
    const unsigned char *from = content->bytes + start;
    double *values = (double *)(void *)content->bytes;
    for (size_t i = 0; i < (size_t)count; i++, from += 8) { /* `from` stays ahead of where it writes */
        uint64_t bits = 0;
        for (int k = 7; k >= 0; k--) /* little-endian, whatever the host is */
            bits = bits << 8 | from[k];
        double value;
        memcpy(&value, &bits, sizeof value);
        values[i] = value;
    }
    return values;
}
