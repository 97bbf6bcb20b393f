/* JSON text [RFC 8259] as an array of values, each followed by what it holds. */
#ifndef MODALFMU_JSON_H
#define MODALFMU_JSON_H

#include "common.h"

#define JSON_DEPTH 16 /* lists and objects inside each other; deeper text is refused */

typedef enum { JSON_NULL, JSON_FALSE, JSON_TRUE, JSON_NUMBER, JSON_TEXT, JSON_LIST, JSON_OBJECT } JsonKind;

/* One value. A list is followed by its items, an object by its members: a text, the key, then the value.
 *
 * number: the double nearest to the decimal number, infinite beyond the range;
 * text: UTF-8 with a final 0 (and zeros inside where the text has \u0000);
 * size: bytes of a text, items of a list, members of an object;
 * span: this value and all that it holds, so that value + span is what follows it. */
typedef struct {
    JsonKind kind;
    size_t size, span;
    double number;
    const char *text;
} Json;

/* The value that is all of the text, to be given back to memory->release; or NULL with a reason that begins
 * with `name`. Texts are unescaped in place: the values point into `text`, which must outlive them. */
INTERNAL const Json *parse_json(const char *name, unsigned char *text, size_t size, const Memory *memory,
                                Reason *reason);

/* Whether the text is this one. */
INTERNAL bool json_text_is(const Json *text, const char *expected);

/* The member of an object, the last one where there are several; NULL where there is none. */
INTERNAL const Json *json_member(const Json *object, const char *key);

#endif
