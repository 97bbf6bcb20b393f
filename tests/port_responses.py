"""Small parts with ports, and their frequency responses by complex solves of the full matrices."""

from collections.abc import Sequence

import numpy as np
from boxes import box
from scipy.linalg import eigh
from scipy.sparse import csc_array, csr_array
from systems import chain, system_of
from threadpoolctl import threadpool_limits

from fmu_src.runtime.model import Port, ReducedModel
from precompute.arrays import Floats, Ints
from precompute.full_model import FullModel
from precompute.interface import Interface
from precompute.oscillators import Complexes, Oscillators
from precompute.system import System
from precompute.transfer import Block, blocks_of, lines_of, measured

NOTHING: Ints = np.zeros(0, dtype=np.int64)


class Beam:
    """A steel beam of hex20 along x, 1 m long; forces and motions at its tip and in its middle."""

    def __init__(self) -> None:
        mesh = box("hex20", (4, 1, 1), (1.0, 0.15, 0.1))
        self.points = mesh.points
        self.system = system_of(mesh)
        x = mesh.points[:, 0]
        self.clamp = (3 * np.flatnonzero(x < 1e-9)[:, None] + np.arange(3)).ravel()
        self.tip, self.middle = np.flatnonzero(x > 1 - 1e-9), np.flatnonzero(abs(x - 0.5) < 1e-9)
        y, z = self.motion(self.tip, 1), self.motion(self.tip, 2)
        inner = self.motion(self.middle, 2)
        ports = (
            Port(
                "tip",
                ("force.y", "force.z"),
                ("displacement.y", "displacement.z", "velocity.z", "acceleration.z"),
            ),
            Port("middle", ("force.z",), ("displacement.z",)),
        )
        self.interface = interface(ports, [y, z, inner], [y, z, z, z, inner])
        self.inner = csr_array(inner[None])

    def motion(self, nodes: Ints, axis: int) -> Floats:
        """The mean motion of the nodes, a row over all DOFs."""
        row = np.zeros(self.system.K.shape[0])
        row[3 * nodes + axis] = 1 / len(nodes)
        return row

    def half_damped(self, alpha: float, beta: float) -> csr_array:
        """αM + βK of the outer half alone, as a material with damping of its own gives it."""
        outer = csr_array(np.diag(np.repeat((self.points[:, 0] > 0.45).astype(float), 3)))
        return csr_array(outer @ (alpha * self.system.M + beta * self.system.K) @ outer)


def interface(
    ports: tuple[Port, ...], loads: Sequence[Floats], rows: Sequence[Floats], direct: Floats | None = None
) -> Interface:
    """Columns of b, rows of c."""
    through = np.zeros((len(rows), len(loads))) if direct is None else direct
    return Interface(ports, csc_array(np.array(loads).T), csr_array(np.array(rows)), through)


def held_chain(n: int, outputs: tuple[str, ...] = ("displacement.x",)) -> tuple[System, Interface]:
    """n masses of 1 kg in a row, springs of 1 N/m, the first to ground; force and motions at the last."""
    end = np.eye(n)[-1]
    port = Port("end", ("force.x",), outputs)
    return chain(n, ground=1.0), interface((port,), [end], [end] * len(outputs))


def modal_damping(system: System, fixed: Ints, ratio: float) -> Floats:
    """MΦ diag(2ζω) ΦᵀM over all modes, (n, n): the damping that a ratio stands for."""
    free = np.setdiff1d(np.arange(system.K.shape[0]), fixed)
    M = system.M.toarray()[np.ix_(free, free)]
    lam, Phi = eigh(system.K.toarray()[np.ix_(free, free)], M)
    D = np.zeros(system.K.shape)
    D[np.ix_(free, free)] = M @ Phi @ np.diag(2 * ratio * np.sqrt(np.maximum(lam, 0))) @ Phi.T @ M
    return D


def brute_force(
    system: System, fixed: Ints, D: Floats, between: Interface, frequency: Floats, alpha: float
) -> Complexes:
    """H(f) (f, p, n_u) by a dense complex solve at every frequency; D: (n, n) all damping."""
    free = np.setdiff1d(np.arange(system.K.shape[0]), fixed)
    K, M = (A.toarray()[np.ix_(free, free)] for A in (system.K, system.M))
    b, c = between.b.toarray()[free], between.c.toarray()[:, free]
    D = D[np.ix_(free, free)]
    omega = 2 * np.pi * frequency
    with threadpool_limits(1):  # the threads of BLAS cost more than they give at this size
        x = np.array([c @ np.linalg.solve(K + 1j * w * D - w**2 * M, b) for w in omega])
    return measured(lines_of(between.ports), x, between.direct, alpha, omega)


def model_of(full: FullModel, system: Oscillators) -> ReducedModel:
    """Oscillators of unit mass as the reduced model that an FMU carries."""
    order = np.argsort(system.k, kind="stable")
    D = (system.D + system.D.T)[np.ix_(order, order)] / 2
    m = system.B.shape[1]
    return ReducedModel(
        name="part",
        description="",
        lam=np.ascontiguousarray(system.k[order]),
        alpha=0.0,
        beta=0.0,
        D_rest=np.ascontiguousarray(D),
        B=np.ascontiguousarray(system.B[order]),
        C=np.ascontiguousarray(system.C[:, order]),
        R=system.R + np.zeros((len(system.C), m)),
        R_in=np.zeros((m, m)),
        ports=full.ports,
    )


def relative(E: Complexes, H: Complexes, block: Block) -> Floats:
    """‖E_block‖₂ at every frequency over the peak of ‖H_block‖₂, by singular values."""
    own, whole = (A[:, block.lines[:, None], block.columns] for A in (E, H))
    peak = np.max(np.linalg.svd(whole, compute_uv=False))
    return np.asarray(np.linalg.svd(own, compute_uv=False)[:, 0] / peak)


def largest(E: Complexes, H: Complexes, between: Interface) -> float:
    """The largest relative deviation over frequencies and kinds."""
    return max(float(np.max(relative(E, H, block))) for block in blocks_of(between.ports))
