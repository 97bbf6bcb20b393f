"""What inputs and outputs there are: their names, units and, for outputs, the law that gives them.

Most ports have the ordinary ones; the ports named gravity, base and energy have their own.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

Law: TypeAlias = Literal["position", "velocity", "acceleration", "reaction", "mises", "kinetic", "strain"]

ROWS: Mapping[Law, int] = {
    "position": 1,  # C x + R u
    "velocity": 1,  # C ẋ + R u̇
    "acceleration": 1,  # C ẍ + R u
    "reaction": 3,  # C₁ (ẍ + αẋ) + C₂ ẋ + C₃ (x + βẋ) + R₁ u
    "mises": 6,  # of the stress C x + R u in xx, yy, zz, xy, yz, zx
    "kinetic": 0,  # ½ q̇ᵀq̇ + q̇ᵀP ṡ + ½ ṡᵀM_s ṡ
    "strain": 0,  # ½ qᵀΛq + ½ sᵀK_s s + ½ uᵀR_in u
}
"""How many rows of C and R an output of each law takes; x = [s; q] (model.py)."""

STATIC_LAWS: tuple[Law, ...] = ("position", "velocity", "mises")
"""What a mode that follows statically has a part in; its acceleration, so its reaction, is 0."""

STRESSES = ("xx", "yy", "zz", "xy", "yz", "zx")


@dataclass(frozen=True)
class Input:
    """unit: as in the FMU; text: what it is, with {port}.

    prescribes: of an acceleration that is prescribed, the keys of the displacement and the velocity that
    follow from it.
    """

    unit: str
    text: str
    prescribes: tuple[str, str] | None = None


@dataclass(frozen=True)
class Output:
    """The same, with the law that gives its value."""

    unit: str
    text: str
    law: Law


def _along(kind: str) -> Mapping[str, str]:
    return {f"{kind}.{k}": f"{kind.replace('_', ' ')} in {k}" for k in "xyz"}


def _about(kind: str) -> Mapping[str, str]:
    return {f"{kind}.{k}": f"{kind.replace('_', ' ')} about {k}" for k in "xyz"}


ORDINARY_INPUTS: Mapping[str, Input] = {
    **{key: Input("N", f"{text} at {{port}}") for key, text in _along("force").items()},
    **{key: Input("N.m", f"{text} at {{port}}") for key, text in _about("moment").items()},
    "pressure": Input("Pa", "pressure into the faces of {port}"),
    **{
        f"motion.{k}": Input(
            "m/s2", f"prescribed acceleration in {k} of {{port}}", (f"displacement.{k}", f"velocity.{k}")
        )
        for k in "xyz"
    },
    **{
        f"angular_motion.{k}": Input(
            "rad/s2",
            f"prescribed angular acceleration about {k} of {{port}}",
            (f"rotation.{k}", f"angular_velocity.{k}"),
        )
        for k in "xyz"
    },
}
ORDINARY_OUTPUTS: Mapping[str, Output] = {
    **{k: Output("m", f"{text} of {{port}}", "position") for k, text in _along("displacement").items()},
    **{k: Output("m/s", f"{text} of {{port}}", "velocity") for k, text in _along("velocity").items()},
    **{
        k: Output("m/s2", f"{text} of {{port}}", "acceleration") for k, text in _along("acceleration").items()
    },
    **{
        k: Output("m/s2", f"{text} of {{port}}", "acceleration")
        for k, text in _along("absolute_acceleration").items()
    },
    **{k: Output("rad", f"{text} of {{port}}", "position") for k, text in _about("rotation").items()},
    **{
        k: Output("rad/s", f"{text} of {{port}}", "velocity")
        for k, text in _about("angular_velocity").items()
    },
    **{
        k: Output("rad/s2", f"{text} of {{port}}", "acceleration")
        for k, text in _about("angular_acceleration").items()
    },
    **{f"stress.{k}": Output("Pa", f"stress {k} at {{port}}", "position") for k in STRESSES},
    "stress.mises": Output("Pa", "von Mises stress at {port}", "mises"),
    **{k: Output("N", f"{text} of {{port}}", "reaction") for k, text in _along("reaction").items()},
    **{k: Output("N.m", f"{text} of {{port}}", "reaction") for k, text in _about("reaction_moment").items()},
    # the same the other way round, as another part takes them
    **{f"action.{k}": Output("N", f"force in {k} of {{port}} on what moves it", "reaction") for k in "xyz"},
    **{
        f"action_moment.{k}": Output("N.m", f"moment about {k} of {{port}} on what moves it", "reaction")
        for k in "xyz"
    },
}
# What joins parts has it the other way round: told how its ends move, it gives the forces on them.
LINK_INPUTS: Mapping[str, Input] = {
    key: Input(ORDINARY_OUTPUTS[key].unit, ORDINARY_OUTPUTS[key].text)
    for kind in ("displacement", "velocity", "rotation", "angular_velocity")
    for key in _along(kind)
}
LINK_OUTPUTS: Mapping[str, Output] = {
    **{key: Output("N", f"{text} on {{port}}", "position") for key, text in _along("force").items()},
    **{key: Output("N.m", f"{text} on {{port}}", "position") for key, text in _about("moment").items()},
}
GRAVITY: Mapping[str, Input] = {k: Input("m/s2", f"acceleration of gravity in {k}") for k in "xyz"}
BASE: Mapping[str, Input] = {
    f"acceleration.{k}": Input("m/s2", f"acceleration of the supports in {k}") for k in "xyz"
}
ENERGY: Mapping[str, Output] = {
    "kinetic": Output("J", "kinetic energy of the motion relative to the base", "kinetic"),
    "strain": Output("J", "strain energy", "strain"),
}
ALL_INPUTS: Mapping[str, Input] = {**ORDINARY_INPUTS, **LINK_INPUTS}
ALL_OUTPUTS: Mapping[str, Output] = {**ORDINARY_OUTPUTS, **LINK_OUTPUTS}


def inputs_of(port: str) -> Mapping[str, Input]:
    """The inputs that the port of this name may have."""
    return {"gravity": GRAVITY, "base": BASE, "energy": {}}.get(port, ALL_INPUTS)


def outputs_of(port: str) -> Mapping[str, Output]:
    """The outputs that the port of this name may have."""
    return {"gravity": {}, "base": {}, "energy": ENERGY}.get(port, ALL_OUTPUTS)
