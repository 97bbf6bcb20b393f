#include "json.h"

#include "json_scalars.h"

#include <string.h>

/* The parser: the text that is left and the values that are found. */
typedef struct {
    JsonInput input;
    Json *next;
} JsonParser;

static bool scan_value(JsonParser *parser, int depth);

static void skip_space(JsonInput *input)
{
    while (json_passes(input, ' ') || json_passes(input, '\t') || json_passes(input, '\n') ||
           json_passes(input, '\r')) {
    }
}

/* key : value */
static bool scan_member(JsonParser *parser, int depth)
{
    JsonInput *input = &parser->input;
    if (input->at == input->end || *input->at != '"')
        return json_expected(input, "a key in quotation marks");
    Json *key = parser->next++;
    key->span = 1;
    if (!scan_json_text(input, key))
        return false;
    skip_space(input);
    if (!json_passes(input, ':'))
        return json_expected(input, "a colon");
    return scan_value(parser, depth);
}

/* Items or members with commas between, to the closing bracket; the opening one is passed. */
static bool scan_members(JsonParser *parser, Json *value, char closing, int depth)
{
    JsonInput *input = &parser->input;
    if (depth == JSON_DEPTH)
        return json_expected(input, "fewer levels of brackets");
    value->kind = closing == ']' ? JSON_LIST : JSON_OBJECT;
    skip_space(input);
    if (json_passes(input, closing))
        return true;
    do {
        skip_space(input);
        if (!(value->kind == JSON_LIST ? scan_value(parser, depth + 1) : scan_member(parser, depth + 1)))
            return false;
        value->size++;
    } while (json_passes(input, ','));
    return json_passes(input, closing) || json_expected(input, "a comma or a closing bracket");
}

static bool scan_word(JsonInput *input, Json *value)
{
    static const char *const words[] = {"null", "false", "true"};
    for (size_t k = 0; k < 3; k++) {
        size_t length = strlen(words[k]);
        if ((size_t)(input->end - input->at) >= length && memcmp(input->at, words[k], length) == 0) {
            value->kind = (JsonKind)(JSON_NULL + k);
            input->at += length;
            return true;
        }
    }
    return json_expected(input, "a value");
}

static bool scan_of_its_kind(JsonParser *parser, Json *value, int depth)
{
    JsonInput *input = &parser->input;
    unsigned char first = input->at < input->end ? *input->at : 0;
    if (json_passes(input, '['))
        return scan_members(parser, value, ']', depth);
    if (json_passes(input, '{'))
        return scan_members(parser, value, '}', depth);
    if (first == '"')
        return scan_json_text(input, value);
    if (first == '-' || (first >= '0' && first <= '9'))
        return scan_json_number(input, value);
    return scan_word(input, value);
}

/* A value with the white space around it. */
static bool scan_value(JsonParser *parser, int depth)
{
    Json *value = parser->next++;
    skip_space(&parser->input);
    bool scanned = scan_of_its_kind(parser, value, depth);
    value->span = (size_t)(parser->next - value);
    skip_space(&parser->input);
    return scanned;
}

/* No less than the values of a text: each stands at its begin or behind one of these characters. */
static size_t most_values(const unsigned char *text, size_t size)
{
    size_t count = 1;
    for (size_t k = 0; k < size; k++)
        count += text[k] == '[' || text[k] == '{' || text[k] == ',' || text[k] == ':';
    return count;
}

const Json *parse_json(const char *name, unsigned char *text, size_t size, const Memory *memory,
                       Reason *reason)
{
    Json *values = memory->allocate(most_values(text, size), sizeof *values);
    if (!values) {
        refuse(reason, "%s: no memory for its values", name);
        return NULL;
    }
    JsonParser parser = {{text, text + size, NULL}, values};
    JsonInput *input = &parser.input;
    if (scan_value(&parser, 0) && (input->at == input->end || json_expected(input, "the end")))
        return values;
    refuse(reason, "%s: expected %s at byte %zu", name, input->expected, (size_t)(input->at - text));
    memory->release(values);
    return NULL;
}

bool json_text_is(const Json *text, const char *expected)
{
    size_t length = strlen(expected);
    return text->size == length && memcmp(text->text, expected, length) == 0;
}

const Json *json_member(const Json *object, const char *key)
{
    const Json *found = NULL, *name = object + 1;
    for (size_t k = 0; object->kind == JSON_OBJECT && k < object->size; k++) {
        if (json_text_is(name, key))
            found = name + 1;
        name += 1 + name[1].span;
    }
    return found;
}
