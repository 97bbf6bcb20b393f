/* What every file of the twin may use: linkage, memory of the host, and one-line reasons. */
#ifndef MODALFMU_COMMON_H
#define MODALFMU_COMMON_H

#include <stdbool.h>
#include <stddef.h>

/* In the single-file build all functions are private to that file, so that many FMUs link into one program.
 */
#ifdef MODALFMU_SINGLE_FILE
#define INTERNAL static
#else
#define INTERNAL extern
#endif

/* Memory of the host: `allocate` gives zeroed memory or NULL, as calloc does. */
typedef struct {
    void *(*allocate)(size_t count, size_t size);
    void (*release)(void *memory);
} Memory;

/* Why something was refused: one line, what was got, what was expected. */
typedef struct {
    char text[256];
} Reason;

#if defined(__GNUC__)
#define PRINTF_LIKE(text, first) __attribute__((format(printf, text, first)))
#else
#define PRINTF_LIKE(text, first)
#endif

/* Fills in the reason (cut off where it is too long) and returns false. */
INTERNAL bool refuse(Reason *reason, const char *format, ...) PRINTF_LIKE(2, 3);

#endif
