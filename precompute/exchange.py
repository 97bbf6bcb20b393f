"""What is exchanged with the system around the part, with the nodes that each of it concerns."""

from collections.abc import Sequence
from dataclasses import dataclass

from fmu_src.runtime.kinds import inputs_of
from fmu_src.runtime.model import Port

from .arrays import Ints
from .part import Part
from .part_values import Axis
from .ports import PortNodes
from .support_reactions import Held


@dataclass(frozen=True)
class Exchange:
    """Inputs and outputs in the order of the FMU's variables.

    ports: the variables of each with its nodes; pairs: outputs with the names of two ports [a, b], b minus a;
    supports: all of them, those with outputs named; gravity, base: axes of the
    inputs gravity.x …, base.acceleration.x …; energy: "kinetic", "strain".
    """

    ports: Sequence[tuple[Port, PortNodes]]
    pairs: Sequence[tuple[Port, tuple[str, str]]] = ()
    supports: Sequence[Held] = ()
    gravity: Sequence[Axis] = ()
    base: Sequence[Axis] = ()
    energy: Sequence[str] = ()

    @property
    def variables(self) -> tuple[Port, ...]:
        """The ports of the FMU: those of the part, pairs, supports, gravity, base, energy."""
        whole = (
            Port("gravity", tuple(self.gravity), ()),
            Port("base", tuple(f"acceleration.{axis}" for axis in self.base), ()),
            Port("energy", (), tuple(self.energy)),
        )
        return (
            *(port for port, _ in self.ports),
            *(port for port, _ in self.pairs),
            *(
                Port(support.name, (), support.outputs)
                for support in self.supports
                if support.name and support.outputs
            ),
            *(port for port in whole if port.inputs or port.outputs),
        )

    @property
    def keys(self) -> tuple[tuple[str, str], ...]:
        """Port and key of each input: ("tip", "force.x"), ("gravity", "x") …"""
        return tuple((port.name, key) for port in self.variables for key in port.inputs)

    @property
    def motions(self) -> tuple[tuple[str, str], ...]:
        """Those that prescribe a motion: ("root", "motion.x") …"""
        return tuple((port, key) for port, key in self.keys if inputs_of(port)[key].prescribes)

    @property
    def inputs(self) -> tuple[str, ...]:
        """Their names: "tip.force.x", "gravity.x" …"""
        return tuple(f"{port}.{key}" for port, key in self.keys)


def exchange_of(part: Part, places: Sequence[PortNodes], held: Sequence[Ints]) -> Exchange:
    """What the part file asks for; places: the nodes of each port; held: the DOFs that each support holds."""
    return Exchange(
        [(Port(p.name, p.inputs, p.outputs), where) for p, where in zip(part.ports, places, strict=True)],
        [(Port(pair.name, (), pair.outputs), pair.ports) for pair in part.pairs],
        [Held(dofs, s.name or "", s.outputs) for s, dofs in zip(part.supports, held, strict=True)],
        gravity=("x", "y", "z") if part.loads.gravity else (),
        base=part.loads.base,
        energy=part.energy.outputs,
    )
