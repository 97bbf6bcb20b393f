"""Craig–Bampton: how the interface deforms the part, and how the part swings with the interface held."""

from collections.abc import Callable, Sequence

import numpy as np
from scipy.sparse import csr_array, identity

from fmu_src.runtime.kinds import outputs_of
from fmu_src.runtime.model import Port, row_starts

from .arrays import Floats
from .errors import EigenError
from .factor import Solver
from .fixed_interface import fixed_interface_modes, hold_interface
from .interface import Interface
from .notice import notice
from .orthonormal import orthonormal
from .statics import StaticSolver

LOADS = ("force", "moment")
MOTIONS = ("displacement", "velocity", "acceleration", "absolute_acceleration")
ROTATIONS = ("rotation", "angular_velocity", "angular_acceleration")


def interface_motions(interface: Interface, solve: StaticSolver) -> Floats:
    """The columns w of W: the motions wᵀu of the ports that their forces, moments and outputs use: (n, k).

    Orthonormal; those that depend on others, such as the same motion as input and output, are there once.
    Raises EigenError: none, and no motion is prescribed either.
    """
    loads = [key.split(".")[0] in LOADS for port in interface.ports for key in port.inputs]
    W = np.column_stack(
        [
            interface.b[:, np.flatnonzero(loads)].toarray(),
            interface.c[_motion_rows(interface.ports)].toarray().T,
        ]
    )
    W[solve.held] = 0.0
    W = orthonormal(W, csr_array(identity(len(W), format="csr")))
    if W.shape[1] == 0 and interface.moved is None:
        raise EigenError(
            'basis: kind = "craig-bampton" needs a port with forces, moments or motions, and not held; '
            "add one"
        )
    return W


def craig_bampton(
    W: Floats,
    solve: StaticSolver,
    count: int | None = None,
    max_frequency: float | None = None,
    solver: Solver = "auto",
    progress: Callable[[str], None] = lambda line: None,
) -> Floats:
    """V = [R, K⁺W, Φ_f] (n, k): the rigid and constraint modes, and the fixed-interface modes.

    W: (n, j), orthonormal columns; the interface motions are Wᵀu. Constraint modes are the static responses
    to unit motions of the interface, K⁺W (WᵀK⁺W)⁻¹ for a supported part: their span is that of K⁺W. A free
    part moves with all its rigid modes, and K⁺W includes inertia relief, so that it responds to loads
    on its interface exactly at rest, as a supported one does. Φ_f: the modes with Wᵀφ = 0.
    count: fixed-interface modes (those rigid motions that the interface leaves included, 0 is legal), or
    max_frequency in Hz.
    Raises EigenError: more modes than there are, no convergence, memory.
    Source: Craig & Bampton, AIAA Journal 6 (1968).
    """
    held = hold_interface(W, solve)
    left = held.left.shape[1]
    if left:
        notice(f"basis: the interface leaves {left} rigid motions to the fixed-interface modes")
    modes = fixed_interface_modes(held, count, max_frequency, solver, progress)
    notice(f"basis: {W.shape[1]} constraint modes, {left + len(modes.lam)} fixed-interface modes")
    constraint = held.J[:, : W.shape[1]]
    return np.column_stack([solve.rigid, constraint[:, np.any(constraint, axis=0)], modes.Phi])


def _motion_rows(ports: Sequence[Port]) -> list[int]:
    keys = [(port.name, key) for port in ports for key in port.outputs]
    starts = row_starts([outputs_of(name)[key].law for name, key in keys])
    return [a for a, (_, key) in zip(starts, keys, strict=False) if key.split(".")[0] in MOTIONS + ROTATIONS]
