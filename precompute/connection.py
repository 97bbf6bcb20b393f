"""The full model with all that the part file puts at its ports."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_array, vstack

from .arrays import Floats
from .constrained import Constrained
from .coupled_damping import projected_damping
from .damping import Damping, damping_of
from .doubts import doubt_held_ports, doubt_point_stress
from .eigen import Modes
from .exchange import Exchange, exchange_of
from .extra_damping import Dashpots
from .full_part import FullPart, nodes_at
from .moved_part import MovedPart
from .moved_ports import hold_motions
from .part import Part
from .port_elements import element_motion, with_masses, with_springs
from .port_motion import motion
from .port_rows import direction_of
from .ports import PortNodes, port_nodes
from .projection import rows_over
from .rayleigh_part import split_rayleigh
from .rigid_ports import constrain
from .system import System


@dataclass(frozen=True)
class Connection:
    """M ü + D u̇ + K u = b u_in with springs, masses and rigid ports, before any reduction.

    full: the part without them; system: over the DOFs of `full`, with springs and masses; exchange: inputs
    and outputs; dashpots: w (1, n) and c of each; rayleigh: α in 1/s and β in s of the material, beside
    those of [damping]; held: the same system over û, u = T û, where rigid ports move as one and ports whose
    motion is prescribed are held.
    """

    full: FullPart
    system: System
    exchange: Exchange
    dashpots: Dashpots
    rayleigh: tuple[float, float]
    held: Constrained

    @property
    def own_dashpots(self) -> Dashpots:
        """The dashpots over û."""
        return [(rows_over(w, self.held.T), c) for w, c in self.dashpots]

    def where(self, dof: int) -> str:
        """The place of a DOF of û, for messages."""
        return self.full.where(int(self.held.origin[dof]))


def connect(part: Part, full: FullPart) -> Connection:
    """Ports, springs, masses, dashpots and rigid ports of the part file on the full model.

    Raises a ModalFmuError where a port selects nothing or cannot do what is asked of it.
    """
    places = [_port_nodes(part, full, k) for k in range(len(part.ports))]
    doubt_held_ports(part, places, full.fixed, full.dofs)
    doubt_point_stress(part, places)
    system, rayleigh = _with_own_damping(part, full)
    by_name = {place.name: place for place in places}
    dofs = full.dofs
    springs = [(element_motion(by_name, s.port, s.direction, s.to, dofs), s.stiffness) for s in part.springs]
    dashpots = [(element_motion(by_name, d.port, d.direction, d.to, dofs), d.damping) for d in part.dashpots]
    system = with_springs(system, springs)
    system = with_masses(system, [(by_name[mass.port], mass.mass) for mass in part.masses], dofs)
    rigid = [place for port, place in zip(part.ports, places, strict=True) if port.kind == "rigid"]
    exchange = exchange_of(part, places, full.supports)
    moved = [motion(by_name[port], direction_of(key), dofs) for port, key in exchange.motions]
    W = csr_array(vstack([csr_array((0, len(dofs.node))), *moved], format="csr"))
    held = hold_motions(constrain(system, full.fixed, dofs, rigid), W, exchange.motions)
    return Connection(full, system, exchange, dashpots, rayleigh, held)


def _port_nodes(part: Part, full: FullPart, k: int) -> PortNodes:
    port = part.ports[k]
    nodes = nodes_at(part, full.nodes, f"port[{k + 1}].at", port.at)
    return port_nodes(full.nodes, nodes, "equal" if port.kind == "rigid" else port.weights, port.name)


def _with_own_damping(part: Part, full: FullPart) -> tuple[System, tuple[float, float]]:
    """The system, with the damping that comes with the material or the matrices, and its α and β.

    Springs and masses at ports do not have the damping of the material: with them its α M + β K is a matrix
    of the body alone.
    """
    system, (alpha, beta) = full.system, full.rayleigh
    added = bool(part.springs or part.masses)
    if part.system is not None and not added:
        return split_rayleigh(system)
    if added and (alpha or beta):
        own = csr_array(alpha * system.M + beta * system.K)
        return replace(system, D=own if system.D is None else csr_array(system.D + own)), (0.0, 0.0)
    return system, (alpha, beta)


def damped(part: Part, connection: Connection, modes: Modes) -> Damping:
    """All damping of these modes, Φ over û."""
    return damping_of(
        part.damping,
        modes.lam,
        modes.Phi,
        connection.held.system.D,
        connection.own_dashpots,
        connection.rayleigh,
    )


def drag(connection: Connection, moved: MovedPart, modes: Modes) -> Floats:
    """ΨᵀD [Ψ TΦ] in 1/s, (k, k + r), of the damping beyond Rayleigh's: what it does where the ports move.

    Without what is rounding only; shapes Ψ of a rigid motion count as rigid modes do there.
    """
    shapes = np.column_stack([moved.Psi, connection.held.T @ modes.Phi])
    stiffness = np.concatenate([np.diag(moved.K), modes.lam])
    return projected_damping(stiffness, shapes, connection.system.D, connection.dashpots)[: len(moved.K)]
