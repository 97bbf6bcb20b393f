#include "json_scalars.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Halfway between two doubles lies a number of fewer digits: of more it only matters whether all are 0. */
#define DECIDING_DIGITS 800
#define EXPONENT_LIMIT 99999 /* with so many digits, anything beyond is 0 or infinite */
#define EXPONENT_SIZE 8      /* e-99999 and the final 0 */

bool json_expected(JsonInput *input, const char *expected)
{
    input->expected = expected;
    return false;
}

bool json_passes(JsonInput *input, char character)
{
    bool passes = input->at < input->end && *input->at == (unsigned char)character;
    input->at += passes;
    return passes;
}

/* Bytes of the UTF-8 sequence at the start of the input, 0 where it is ill-formed [Unicode 15, table 3-7]. */
static size_t utf8_length(const JsonInput *input)
{
    const unsigned char *at = input->at;
    unsigned char first = at[0];
    size_t length = first < 0x80 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
    if (first >= 0xF5 || (first >= 0x80 && first < 0xC2) || (size_t)(input->end - at) < length)
        return 0;
    unsigned char low = first == 0xE0 ? 0xA0 : first == 0xF0 ? 0x90 : 0x80;  /* no longer form than needed */
    unsigned char high = first == 0xED ? 0x9F : first == 0xF4 ? 0x8F : 0xBF; /* no surrogates, <= U+10FFFF */
    for (size_t k = 1; k < length; k++) {
        if (at[k] < low || at[k] > high)
            return 0;
        low = 0x80;
        high = 0xBF;
    }
    return length;
}

/* Writes a code point in UTF-8, at most 4 bytes. */
static unsigned char *write_utf8(unsigned char *to, uint32_t point)
{
    if (point < 0x80) {
        *to++ = (unsigned char)point;
        return to;
    }
    int shift = point < 0x800 ? 6 : point < 0x10000 ? 12 : 18; /* of the bits in the first byte */
    unsigned int mark = shift == 6 ? 0xC0 : shift == 12 ? 0xE0 : 0xF0;
    *to++ = (unsigned char)(mark | point >> shift);
    while (shift > 0) {
        shift -= 6;
        *to++ = (unsigned char)(0x80 | (point >> shift & 0x3F));
    }
    return to;
}

/* The four hexadecimal digits after \u. */
static bool scan_code_unit(JsonInput *input, uint32_t *unit)
{
    *unit = 0;
    for (int k = 0; k < 4; k++) {
        unsigned char c = input->at < input->end ? *input->at : 0, letter = c | 0x20;
        bool is_letter = letter >= 'a' && letter <= 'f';
        if (!is_letter && !(c >= '0' && c <= '9'))
            return json_expected(input, "a hexadecimal digit");
        *unit = *unit << 4 | (uint32_t)(is_letter ? letter - 'a' + 10 : c - '0');
        input->at++;
    }
    return true;
}

/* The code point after \u: one code unit, or the two of a surrogate pair. */
static bool scan_code_point(JsonInput *input, uint32_t *point)
{
    uint32_t low;
    if (!scan_code_unit(input, point))
        return false;
    if (*point < 0xD800 || *point > 0xDFFF)
        return true;
    if (*point > 0xDBFF || !json_passes(input, '\\') || !json_passes(input, 'u'))
        return json_expected(input, "a pair of surrogates");
    if (!scan_code_unit(input, &low))
        return false;
    if (low < 0xDC00 || low > 0xDFFF)
        return json_expected(input, "a pair of surrogates");
    *point = 0x10000 + ((*point - 0xD800) << 10) + (low - 0xDC00);
    return true;
}

/* What stands behind a backslash; never longer than the escape. */
static bool scan_escape(JsonInput *input, unsigned char **to)
{
    static const char letters[] = "\"\\/bfnrt", meanings[] = "\"\\/\b\f\n\r\t";
    uint32_t point;
    if (json_passes(input, 'u')) {
        if (!scan_code_point(input, &point))
            return false;
        *to = write_utf8(*to, point);
        return true;
    }
    const char *letter = input->at < input->end && *input->at ? strchr(letters, *input->at) : NULL;
    if (!letter)
        return json_expected(input, "one of \"\\/bfnrtu after a backslash");
    *(*to)++ = (unsigned char)meanings[letter - letters];
    input->at++;
    return true;
}

bool scan_json_text(JsonInput *input, Json *value)
{
    unsigned char *begin = ++input->at, *to = begin;
    while (!json_passes(input, '"')) {
        if (input->at == input->end)
            return json_expected(input, "a quotation mark");
        if (*input->at < 0x20)
            return json_expected(input, "an escape for a control character");
        if (json_passes(input, '\\')) {
            if (!scan_escape(input, &to))
                return false;
            continue;
        }
        size_t length = utf8_length(input);
        if (length == 0)
            return json_expected(input, "UTF-8");
        memmove(to, input->at, length);
        to += length;
        input->at += length;
    }
    *to = 0; /* at or before the closing quotation mark */
    value->kind = JSON_TEXT;
    value->text = (const char *)begin;
    value->size = (size_t)(to - begin);
    return true;
}

/* A decimal number as digits without leading zeros times a power of ten. */
typedef struct {
    char digits[DECIDING_DIGITS + 1 + EXPONENT_SIZE]; /* one stands for all that are left out */
    int count;
    bool more; /* a digit other than 0 was left out */
    long long exponent;
} Decimal;

/* One digit or more, each worth a tenth of the one before; behind the point `places` is 1, before it 0. */
static bool scan_digits(JsonInput *input, Decimal *decimal, int places)
{
    const unsigned char *begin = input->at;
    for (; input->at < input->end && *input->at >= '0' && *input->at <= '9'; input->at++) {
        bool kept = decimal->count < DECIDING_DIGITS;
        if (kept && (decimal->count > 0 || *input->at != '0'))
            decimal->digits[decimal->count++] = (char)*input->at;
        decimal->more |= !kept && *input->at != '0';
        decimal->exponent += !kept - places;
    }
    return input->at > begin || json_expected(input, "a digit");
}

/* The power of ten after e or E; far beyond the range it need not be exact. */
static bool scan_exponent(JsonInput *input, Decimal *decimal)
{
    long long exponent = 0;
    bool negative = json_passes(input, '-');
    if (!negative)
        json_passes(input, '+');
    const unsigned char *begin = input->at;
    for (; input->at < input->end && *input->at >= '0' && *input->at <= '9'; input->at++)
        if (exponent < 1LL << 40) /* more than the text has digits */
            exponent = 10 * exponent + (*input->at - '0');
    decimal->exponent += negative ? -exponent : exponent;
    return input->at > begin || json_expected(input, "a digit");
}

/* The nearest double. Digits and an exponent alone: strtod would look for the decimal comma of the locale. */
static double nearest_double(Decimal *decimal)
{
    if (decimal->count == 0)
        return 0.0;
    if (decimal->more) {
        decimal->digits[decimal->count++] = '1';
        decimal->exponent--;
    }
    long long exponent = decimal->exponent, limit = EXPONENT_LIMIT;
    exponent = exponent > limit ? limit : exponent < -limit ? -limit : exponent;
    snprintf(decimal->digits + decimal->count, EXPONENT_SIZE, "e%lld", exponent);
    return strtod(decimal->digits, NULL);
}

bool scan_json_number(JsonInput *input, Json *value)
{
    Decimal decimal = {{0}, 0, false, 0};
    bool negative = json_passes(input, '-');
    if (!json_passes(input, '0') && !scan_digits(input, &decimal, 0))
        return false;
    if (json_passes(input, '.') && !scan_digits(input, &decimal, 1))
        return false;
    if ((json_passes(input, 'e') || json_passes(input, 'E')) && !scan_exponent(input, &decimal))
        return false;
    double size = nearest_double(&decimal);
    value->kind = JSON_NUMBER;
    value->number = negative ? -size : size;
    return true;
}
