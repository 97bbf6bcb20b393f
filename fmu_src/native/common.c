#include "common.h"

#include <stdarg.h>
#include <stdio.h>

/* How much of a text in UTF-8 stays where it was cut off: no part of a character. */
static size_t whole_characters(const char *text, size_t length)
{
    while (length > 0 && (text[length - 1] & 0xC0) == 0x80)
        length--;
    return length > 0 && (text[length - 1] & 0x80) ? length - 1 : length;
}

bool refuse(Reason *reason, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    size_t longest = sizeof reason->text - 1;
    if (vsnprintf(reason->text, sizeof reason->text, format, arguments) > (int)longest)
        reason->text[whole_characters(reason->text, longest)] = 0;
    va_end(arguments);
    return false;
}
