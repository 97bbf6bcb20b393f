#include "header.h"

#include "ports.h"

#include <math.h>
#include <string.h>

#define SCHEMA 3

static const char *kind_name(const Json *value)
{
    static const char *const names[] = {"null", "false", "true", "a number", "a text", "a list", "an object"};
    return value ? names[value->kind] : "nothing";
}

bool is_of_kind(const Json *value, JsonKind kind, const char *what, Reason *reason)
{
    const Json expected = {.kind = kind};
    return (value && value->kind == kind) || refuse(reason, HEADER ": %s: got %s, expected %s; " AGAIN, what,
                                                    kind_name(value), kind_name(&expected));
}

const Json *expected_member(const Json *object, const char *key, JsonKind kind, Reason *reason)
{
    const Json *value = object ? json_member(object, key) : NULL;
    return object && is_of_kind(value, kind, key, reason) ? value : NULL;
}

/* [A-Za-z_][A-Za-z0-9_]* */
bool is_identifier(const Json *text, const char *what, Reason *reason)
{
    static const char characters[] = "_ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789";
    bool digit_first = text->text[0] >= '0' && text->text[0] <= '9';
    return (text->size > 0 && !digit_first && strspn(text->text, characters) == text->size) ||
           refuse(reason, HEADER ": %s: expected a C identifier: letters, digits and _; " AGAIN, what);
}

static bool has_schema(const Json *header, Reason *reason)
{
    const Json *schema = expected_member(header, "schema", JSON_NUMBER, reason);
    if (!schema)
        return false;
    return schema->number == SCHEMA ||
           refuse(reason, HEADER ": got schema %g, expected %d; " AGAIN, schema->number, SCHEMA);
}

/* alpha or beta */
static bool read_damping(const Json *header, const char *key, double *number, Reason *reason)
{
    const Json *value = expected_member(header, key, JSON_NUMBER, reason);
    if (!value)
        return false;
    *number = value->number;
    return (*number >= 0.0 && isfinite(*number)) ||
           refuse(reason, HEADER ": %s: got %g, expected a finite number >= 0; " AGAIN, key, *number);
}

static bool read_initial(const Json *header, bool *initial_static, Reason *reason)
{
    const Json *initial = expected_member(header, "initial", JSON_TEXT, reason);
    if (!initial)
        return false;
    *initial_static = json_text_is(initial, "static");
    return *initial_static || json_text_is(initial, "rest") ||
           refuse(reason, HEADER ": initial: expected \"rest\" or \"static\"; " AGAIN);
}

static bool read_residual(const Json *header, bool *residual, Reason *reason)
{
    const Json *value = json_member(header, "residual");
    *residual = value && value->kind == JSON_TRUE;
    return *residual || (value && value->kind == JSON_FALSE) ||
           refuse(reason, HEADER ": residual: got %s, expected true or false; " AGAIN, kind_name(value));
}

/* n, the length of lam, 0 without a state; whether it is a whole number is seen when its file is read */
static bool count_coordinates(const Json *header, size_t *n, Reason *reason)
{
    const Json *arrays = expected_member(header, "arrays", JSON_OBJECT, reason);
    const Json *lam = expected_member(arrays, "lam", JSON_OBJECT, reason);
    const Json *shape = expected_member(lam, "shape", JSON_LIST, reason);
    if (!shape)
        return false;
    double length = shape->size == 1 && shape[1].kind == JSON_NUMBER ? shape[1].number : -1.0;
    if (!(length >= 0.0 && length <= (double)(ARRAY_LIMIT / sizeof(double))))
        return refuse(reason, HEADER ": lam: got %g modes, expected a number of them; " AGAIN, length);
    *n = (size_t)length;
    return true;
}

/* The model in one block of memory: itself, its texts' places, its k motions, the laws of its outputs, its
 * texts. */
static ReducedModel *new_model(const Json *name, const Json *ports, const PortSizes *sizes, size_t k,
                               const Memory *memory)
{
    size_t places = (sizes->inputs + sizes->outputs) * sizeof(char *) + k * sizeof(size_t);
    size_t laws_size = sizes->outputs * sizeof(Law), texts_size = name->size + 1 + sizes->bytes;
    ReducedModel *model = memory->allocate(1, sizeof *model + places + laws_size + texts_size);
    if (!model)
        return NULL;
    const char **inputs = (const char **)(void *)(model + 1), **outputs = inputs + sizes->inputs;
    size_t *motions = (size_t *)(void *)(outputs + sizes->outputs);
    Law *laws = (Law *)(void *)(motions + k);
    char *texts = (char *)(laws + sizes->outputs);
    memcpy(texts, name->text, name->size + 1);
    name_variables(ports, texts + name->size + 1, inputs, outputs, laws);
    prescribed_motions(ports, motions);
    model->name = texts;
    model->k = k;
    model->motions = motions;
    model->m = sizes->inputs;
    model->p = sizes->outputs;
    model->s = sizes->rows;
    model->inputs = inputs;
    model->outputs = outputs;
    model->laws = laws;
    return model;
}

/* Whether XML can hold the text: no control characters but tab and line ends, no U+FFFE and U+FFFF. */
static bool is_xml(const Json *text, const char *what, Reason *reason)
{
    bool fits = !strstr(text->text, "\xEF\xBF\xBE") && !strstr(text->text, "\xEF\xBF\xBF");
    for (size_t k = 0; k < text->size && fits; k++) {
        unsigned char c = (unsigned char)text->text[k];
        fits = c >= ' ' || c == '\t' || c == '\n' || c == '\r';
    }
    return fits || refuse(reason, HEADER ": %s: got a character that XML cannot hold; " AGAIN, what);
}

ReducedModel *described_model(const Json *header, const Memory *memory, Reason *reason)
{
    double alpha = 0.0, beta = 0.0;
    bool initial_static = false, residual = false;
    size_t n = 0;
    PortSizes sizes = {0, 0, 0, 0};
    if (!has_schema(header, reason) || !read_damping(header, "alpha", &alpha, reason) ||
        !read_damping(header, "beta", &beta, reason) || !read_initial(header, &initial_static, reason) ||
        !read_residual(header, &residual, reason) || !count_coordinates(header, &n, reason))
        return NULL;
    const Json *name = expected_member(header, "name", JSON_TEXT, reason);
    const Json *ports = name ? expected_member(header, "ports", JSON_LIST, reason) : NULL;
    const Json *description = ports ? expected_member(header, "description", JSON_TEXT, reason) : NULL;
    if (!description || !is_xml(description, "description", reason) || !is_identifier(name, "name", reason) ||
        !check_ports(ports, &sizes, memory, reason))
        return NULL;
    size_t k = prescribed_motions(ports, NULL);
    if (k > 0 && n <= k) {
        refuse(reason, HEADER ": lam: got no mode beside %zu prescribed motions, expected one; " AGAIN, k);
        return NULL;
    }
    ReducedModel *model = new_model(name, ports, &sizes, k, memory);
    if (!model) {
        refuse(reason, HEADER ": no memory for its names");
        return NULL;
    }
    model->alpha = alpha;
    model->beta = beta;
    model->initial_static = initial_static;
    model->residual = residual;
    model->n = n;
    model->r = n - k;
    return model;
}
