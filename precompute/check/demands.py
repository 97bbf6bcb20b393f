"""Every finding by its name: how grave it is, what is demanded, its place in FMI 2.0.4, how to mend it.

The demands of each check stand beside it; here are those of every call.
"""

from collections.abc import Mapping

from .finding import Demand
from .groups import MODULES

EVERYWHERE: Mapping[str, Demand] = {
    "library-loads": Demand(
        "error",
        "2.3",
        "the library loads on the platform whose folder it lies in",
        "link what it needs into it, or ship it beside it",
    ),
    "legal-call-refused": Demand(
        "error",
        "4.2.4",
        "a call that is legal where it is made succeeds",
        "allow it in this state, or see what it logged",
    ),
    "crash": Demand(
        "error", "2.1.3", "no call takes the master's process along", "debug the call that is named"
    ),
    "hang": Demand("error", "4.2.2", "every call comes to an end", "debug the call that is named"),
}
DEMANDS: Mapping[str, Demand] = {
    **EVERYWHERE,
    **{name: demand for module in MODULES for name, demand in module.DEMANDS.items()},
}
