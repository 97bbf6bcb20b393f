#include "ports.h"

#include <stdlib.h>
#include <string.h>

#define DIRECTIONS 3

/* The variables that a port may have under a key; outputs stand in the order of OutputKind. */
typedef struct {
    const char *key;
    size_t count;
    const char *variables[3 * DIRECTIONS];
} Known;

static const Known known_inputs = {"inputs", DIRECTIONS, {"force.x", "force.y", "force.z"}};
static const Known known_outputs = {
    "outputs",
    3 * DIRECTIONS,
    {"displacement.x", "displacement.y", "displacement.z", "velocity.x", "velocity.y", "velocity.z",
     "acceleration.x", "acceleration.y", "acceleration.z"},
};

/* The place of a variable among the known ones; their count where it is none of them. */
static size_t variable_place(const Json *variable, const Known *known)
{
    size_t place = 0;
    while (place < known->count && !json_text_is(variable, known->variables[place]))
        place++;
    return place;
}

/* The variables of one port: known ones, none twice. */
static bool check_variables(const Json *port, const Known *known, size_t *count, size_t *bytes,
                            Reason *reason)
{
    const Json *name = json_member(port, "name");
    const Json *list = expected_member(port, known->key, JSON_LIST, reason);
    if (!list)
        return false;
    const Json *variable = list + 1;
    unsigned int found = 0;
    for (size_t k = 0; k < list->size; k++, variable += variable->span) {
        if (!is_of_kind(variable, JSON_TEXT, known->key, reason))
            return false;
        size_t place = variable_place(variable, known);
        if (place == known->count || (found >> place & 1))
            return refuse(reason, HEADER ": port %s: %s: expected %s ... %s, each once; " AGAIN, name->text,
                          known->key, known->variables[0], known->variables[known->count - 1]);
        found |= 1u << place;
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
    for (size_t k = 0; k < ports->size; k++, port += port->span) {
        const Json *name = is_of_kind(port, JSON_OBJECT, "ports", reason)
                               ? expected_member(port, "name", JSON_TEXT, reason)
                               : NULL;
        if (!name || !is_identifier(name, "name of a port", reason) ||
            !check_variables(port, &known_inputs, &sizes->inputs, &sizes->bytes, reason) ||
            !check_variables(port, &known_outputs, &sizes->outputs, &sizes->bytes, reason))
            return false;
    }
    if (sizes->inputs + sizes->outputs == 0)
        return refuse(reason, HEADER ": ports: got no inputs and outputs, expected a port; " AGAIN);
    return check_unique(ports, memory, reason);
}

/* Writes "port.force.x" for the variables of one port and takes note of where each is and of its kind. */
static char *join_names(const Json *port, const Known *known, char *bytes, const char **names,
                        OutputKind *kinds)
{
    const Json *name = json_member(port, "name"), *list = json_member(port, known->key);
    for (size_t k = 0; k < list->size; k++) {
        const Json *variable = list + 1 + k;
        names[k] = bytes;
        if (kinds)
            kinds[k] = (OutputKind)(variable_place(variable, known) / DIRECTIONS);
        memcpy(bytes, name->text, name->size);
        bytes += name->size;
        *bytes++ = '.';
        memcpy(bytes, variable->text, variable->size + 1);
        bytes += variable->size + 1;
    }
    return bytes;
}

void name_variables(const Json *ports, char *bytes, const char **inputs, const char **outputs,
                    OutputKind *output_kinds)
{
    const Json *port = ports + 1;
    for (size_t k = 0; k < ports->size; k++, port += port->span) {
        bytes = join_names(port, &known_inputs, bytes, inputs, NULL);
        bytes = join_names(port, &known_outputs, bytes, outputs, output_kinds);
        inputs += json_member(port, "inputs")->size;
        outputs += json_member(port, "outputs")->size;
        output_kinds += json_member(port, "outputs")->size;
    }
}
