#include "kinds.h"

#include <string.h>

#define XYZ(kind, law)                                                                                       \
    {kind ".x", law}, {kind ".y", law},                                                                      \
    {                                                                                                        \
        kind ".z", law                                                                                       \
    }

static const Kind ordinary_inputs[] = {
    XYZ("force", POSITION),
    XYZ("moment", POSITION),
    {"pressure", POSITION},
    XYZ("motion", ACCELERATION),
    XYZ("angular_motion", ACCELERATION),
    /* of what joins parts: */
    XYZ("displacement", POSITION),
    XYZ("velocity", POSITION),
    XYZ("rotation", POSITION),
    XYZ("angular_velocity", POSITION),
};
static const Kind gravity_inputs[] = {{"x", POSITION}, {"y", POSITION}, {"z", POSITION}};
static const Kind base_inputs[] = {XYZ("acceleration", POSITION)};
static const Kind ordinary_outputs[] = {
    XYZ("displacement", POSITION),
    XYZ("velocity", VELOCITY),
    XYZ("acceleration", ACCELERATION),
    XYZ("absolute_acceleration", ACCELERATION),
    XYZ("rotation", POSITION),
    XYZ("angular_velocity", VELOCITY),
    XYZ("angular_acceleration", ACCELERATION),
    {"stress.xx", POSITION},
    {"stress.yy", POSITION},
    {"stress.zz", POSITION},
    {"stress.xy", POSITION},
    {"stress.yz", POSITION},
    {"stress.zx", POSITION},
    {"stress.mises", MISES},
    XYZ("reaction", REACTION),
    XYZ("reaction_moment", REACTION),
    XYZ("action", REACTION),
    XYZ("action_moment", REACTION),
    /* of what joins parts: */
    XYZ("force", POSITION),
    XYZ("moment", POSITION),
};
static const Kind energies[] = {{"kinetic", KINETIC}, {"strain", STRAIN}};

#define ALL_OF(kinds) ((Kinds){sizeof(kinds) / sizeof *(kinds), kinds})
#define NONE ((Kinds){0, NULL})

Kinds inputs_of_port(const char *port)
{
    if (strcmp(port, "gravity") == 0)
        return ALL_OF(gravity_inputs);
    if (strcmp(port, "base") == 0)
        return ALL_OF(base_inputs);
    return strcmp(port, "energy") == 0 ? NONE : ALL_OF(ordinary_inputs);
}

Kinds outputs_of_port(const char *port)
{
    if (strcmp(port, "energy") == 0)
        return ALL_OF(energies);
    return strcmp(port, "gravity") == 0 || strcmp(port, "base") == 0 ? NONE : ALL_OF(ordinary_outputs);
}
