/* The bytes of an input, taken one after the other as the arguments of calls. */
#ifndef FUZZ_INPUT_H
#define FUZZ_INPUT_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    const uint8_t *data;
    size_t size;
} Input;

static inline void must(bool truth)
{
    if (!truth)
        abort();
}

static inline unsigned int byte(Input *input)
{
    if (input->size == 0)
        return 0;
    input->size--;
    return *input->data++;
}

/* Numbers that a host may well give, numbers that it should not, or any eight bytes. */
static inline double real(Input *input)
{
    static const double known[] = {1e-3,     0.1, 1.0,   -1.0,   0.0,    -0.0,   1e-9,  1e3,
                                   INFINITY, NAN, 1e300, -1e300, 5e-324, 1e-300, 1e150, -INFINITY};
    unsigned int chosen = byte(input);
    if (chosen < 240)
        return known[chosen % 16];
    uint64_t bits = 0;
    for (int k = 0; k < 8; k++)
        bits = bits << 8 | byte(input);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Arrays of exactly this length, so that a place beyond it is found out. */
static inline void *array(size_t count, size_t size)
{
    void *memory = malloc(count * size + (count == 0));
    must(memory != NULL);
    return memory;
}

static inline double *reals(Input *input, size_t count)
{
    double *values = array(count, sizeof *values);
    for (size_t k = 0; k < count; k++)
        values[k] = real(input);
    return values;
}

static inline unsigned int *references(Input *input, size_t count)
{
    unsigned int *values = array(count, sizeof *values);
    for (size_t k = 0; k < count; k++) {
        unsigned int chosen = byte(input);
        values[k] = chosen < 250 ? chosen % 80 : 0xFFFFFFFFu - (255 - chosen);
    }
    return values;
}

static inline int *small_integers(Input *input, size_t count)
{
    int *values = array(count, sizeof *values);
    for (size_t k = 0; k < count; k++) {
        int chosen = (int)byte(input);
        values[k] = chosen < 200 ? chosen % 8 : chosen < 228 ? -chosen : chosen < 242 ? INT32_MAX : INT32_MIN;
    }
    return values;
}

#endif
