/* The two kinds of JSON values that need more than a look: texts and numbers [RFC 8259, 6, 7]. */
#ifndef MODALFMU_JSON_SCALARS_H
#define MODALFMU_JSON_SCALARS_H

#include "json.h"

/* The text that is left, and, once something else stands there, what was expected. */
typedef struct {
    unsigned char *at, *end;
    const char *expected;
} JsonInput;

/* Takes note of what was expected and returns false. */
INTERNAL bool json_expected(JsonInput *input, const char *expected);

/* Whether this character comes next; it is passed then. */
INTERNAL bool json_passes(JsonInput *input, char character);

/* The text that begins at a quotation mark, unescaped in place. */
INTERNAL bool scan_json_text(JsonInput *input, Json *value);

/* The number that begins at a digit or minus sign. */
INTERNAL bool scan_json_number(JsonInput *input, Json *value);

#endif
