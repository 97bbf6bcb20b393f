"""Faults of the library in states: one change of the native twin's sources each."""

from planted import Edit, Fault, code

STATE = (
    code(
        "restoring a state forgets the rates of the inputs",
        "saved_state.c",
        "x->rates_given = head.rates_given == 1;",
        "x->rates_given = false;",
        "state-inputs",
        "state",
    ),
    code(
        "restoring a state forgets the time",
        "saved_state.c",
        "    x->time = head.time;\n",
        "",
        "legal-call-refused",
        "state",
    ),
    code(
        "restoring a state forgets the modal velocities",
        "saved_state.c",
        "    memcpy(x->motion[1], v, x->active * sizeof(double));",
        "    (void)v;",
        "state-restore",
        "state",
    ),
    code(
        "restoring a state forgets the damping",
        "saved_state.c",
        "if (head.alpha != x->alpha || head.beta != x->beta)",
        "if (false)",
        "state-parameters",
        "state",
    ),
    code(
        "restoring a state forgets the inputs",
        "saved_state.c",
        "        memcpy(x->u[order], inputs, m * sizeof(double));",
        "        if (order > 0) memcpy(x->u[order], inputs, m * sizeof(double));",
        "state-inputs",
        "state",
    ),
    code(
        "restoring a state forgets the mode",
        "fmi2_state.c",
        "    c->mode = (Mode)head.mode;\n",
        "",
        "legal-call-refused",
        "state",
    ),
    code(
        "all states are one and the same memory",
        "fmi2_state.c",
        "    unsigned char *bytes = c->memory.allocate(1, state_size(c));\n",
        "    static unsigned char *bytes; if (!bytes) bytes = c->memory.allocate(1, state_size(c));\n",
        "legal-call-refused",
        "state",
    ),
    code(
        "a new state does not go into the one that is there",
        "fmi2_state.c",
        "    save_state(c->instance, bytes + sizeof head);",
        "    if (!*FMUstate) save_state(c->instance, bytes + sizeof head);",
        "state-overwrite",
        "state",
    ),
    code(
        "freeing a state leaves a dangling pointer",
        "fmi2_state.c",
        "        *FMUstate = NULL;\n",
        "",
        "state-free",
        "state",
    ),
    code(
        "freeing a state frees nothing",
        "fmi2_state.c",
        "        c->memory.release(*FMUstate);\n",
        "",
        "memory-leak",
        "arguments",
    ),
    code(
        "serialising leaves out the end",
        "fmi2_state.c",
        "memcpy(serializedState, FMUstate, state_size(c));",
        "memcpy(serializedState, FMUstate, state_size(c) - 32);",
        "serialise-roundtrip",
        "state",
    ),
    code(
        "serialising writes beyond the size it named",
        "fmi2_state.c",
        "    memcpy(serializedState, FMUstate, state_size(c));",
        "    memcpy(serializedState, FMUstate, state_size(c)); serializedState[state_size(c)] = 1;",
        "serialise-size",
        "state",
    ),
    code(
        "states can be serialised by declaration only",
        "component.h",
        "CALL(SerializeFMUstate, BOTH, ANY_MODE)",
        "CALL(SerializeFMUstate, BOTH, 0)",
        "legal-call-refused",
        "state",
    ),
    Fault(
        "a serialised state is good in its own process only",
        (
            Edit(
                "fmi2_state.c",
                "    memcpy(bytes, &head, sizeof head);\n",
                "    extern int getpid(void);\n"
                "    if (!c->stop_defined) head.stop = getpid();\n    memcpy(bytes, &head, sizeof head);\n",
            ),
            Edit(
                "fmi2_state.c",
                "    if (!consistent(&head))\n",
                "    extern int getpid(void);\n"
                "    if (!consistent(&head) || (!head.stop_defined && head.stop != getpid()))\n",
            ),
        ),
        "serialise-elsewhere",
        "state",
    ),
)
