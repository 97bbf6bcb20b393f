#include "ports.h"

#include "kinds.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* The kind of a variable; NULL where it is none of the known ones. */
static const Kind *kind_of(const Json *variable, const Kinds *known)
{
    for (size_t k = 0; k < known->count; k++)
        if (json_text_is(variable, known->kinds[k].name))
            return &known->kinds[k];
    return NULL;
}

/* The variables of one port under a key: known ones, none twice. Outputs count their rows too. */
static bool check_variables(const Json *port, const char *key, Kinds known, size_t *count, size_t *rows,
                            size_t *bytes, Reason *reason)
{
    const Json *name = json_member(port, "name");
    const Json *list = expected_member(port, key, JSON_LIST, reason);
    if (!list)
        return false;
    const Json *variable = list + 1;
    uint64_t found = 0;
    for (size_t k = 0; k < list->size; k++, variable += variable->span) {
        if (!is_of_kind(variable, JSON_TEXT, key, reason))
            return false;
        const Kind *kind = kind_of(variable, &known);
        if (!kind && known.count == 0)
            return refuse(reason, HEADER ": port %s: %s: expected none; " AGAIN, name->text, key);
        uint64_t bit = kind ? UINT64_C(1) << (kind - known.kinds) : 0;
        if (!kind || found & bit)
            return refuse(reason, HEADER ": port %s: %s: expected %s ... %s, each once; " AGAIN, name->text,
                          key, known.kinds[0].name, known.kinds[known.count - 1].name);
        found |= bit;
        *rows += law_rows(kind->law);
        *bytes += name->size + 1 + variable->size + 1;
    }
    *count += list->size;
    return true;
}

static int compare_names(const void *a, const void *b)
{
    return strcmp((*(const Json *const *)a)->text, (*(const Json *const *)b)->text);
}

/* No port name twice. */
static bool check_unique(const Json *ports, const Memory *memory, Reason *reason)
{
    const Json **names = memory->allocate(ports->size + 1, sizeof *names), *port = ports + 1;
    if (!names)
        return refuse(reason, HEADER ": no memory for its ports");
    for (size_t k = 0; k < ports->size; k++, port += port->span)
        names[k] = json_member(port, "name");
    qsort(names, ports->size, sizeof *names, compare_names);
    bool unique = true;
    for (size_t k = 1; k < ports->size && unique; k++)
        unique = compare_names(&names[k - 1], &names[k]) != 0 ||
                 refuse(reason, HEADER ": got two ports %s, expected unique names; " AGAIN, names[k]->text);
    memory->release(names);
    return unique;
}

bool check_ports(const Json *ports, PortSizes *sizes, const Memory *memory, Reason *reason)
{
    const Json *port = ports + 1;
    size_t no_rows = 0; /* of inputs */
    for (size_t k = 0; k < ports->size; k++, port += port->span) {
        const Json *name = is_of_kind(port, JSON_OBJECT, "ports", reason)
                               ? expected_member(port, "name", JSON_TEXT, reason)
                               : NULL;
        if (!name || !is_identifier(name, "name of a port", reason) ||
            !check_variables(port, "inputs", inputs_of_port(name->text), &sizes->inputs, &no_rows,
                             &sizes->bytes, reason) ||
            !check_variables(port, "outputs", outputs_of_port(name->text), &sizes->outputs, &sizes->rows,
                             &sizes->bytes, reason))
            return false;
    }
    if (sizes->inputs + sizes->outputs == 0)
        return refuse(reason, HEADER ": ports: got no inputs and outputs, expected a port; " AGAIN);
    return check_unique(ports, memory, reason);
}

size_t prescribed_motions(const Json *ports, size_t *places)
{
    const Json *port = ports + 1;
    size_t count = 0, input = 0;
    for (size_t k = 0; k < ports->size; k++, port += port->span) {
        const Json *list = json_member(port, "inputs");
        const Kinds known = inputs_of_port(json_member(port, "name")->text);
        for (size_t i = 0; i < list->size; i++, input++)
            if (kind_of(list + 1 + i, &known)->law == ACCELERATION) {
                if (places)
                    places[count] = input;
                count++;
            }
    }
    return count;
}

/* Writes "port.force.x" for the variables of one port under a key and takes note of where each is. */
static char *join_names(const Json *port, const char *key, char *bytes, const char **names)
{
    const Json *name = json_member(port, "name"), *list = json_member(port, key);
    for (size_t k = 0; k < list->size; k++) {
        const Json *variable = list + 1 + k;
        names[k] = bytes;
        memcpy(bytes, name->text, name->size);
        bytes += name->size;
        *bytes++ = '.';
        memcpy(bytes, variable->text, variable->size + 1);
        bytes += variable->size + 1;
    }
    return bytes;
}

void name_variables(const Json *ports, char *bytes, const char **inputs, const char **outputs, Law *laws)
{
    const Json *port = ports + 1;
    for (size_t k = 0; k < ports->size; k++, port += port->span) {
        const Json *measured = json_member(port, "outputs");
        const Kinds known = outputs_of_port(json_member(port, "name")->text);
        bytes = join_names(port, "inputs", bytes, inputs);
        bytes = join_names(port, "outputs", bytes, outputs);
        for (size_t i = 0; i < measured->size; i++)
            *laws++ = kind_of(measured + 1 + i, &known)->law;
        inputs += json_member(port, "inputs")->size;
        outputs += measured->size;
    }
}
