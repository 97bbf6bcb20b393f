"""Parts, masses, springs and joints as one system M ü + D u̇ + K u = f, for the monolithic solution."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import block_diag, eigh, null_space

from fmu_src.runtime.kinds import ROWS
from fmu_src.runtime.model import ReducedModel
from precompute.arrays import Floats
from precompute.connection import connect
from precompute.full_part import read_full_part
from precompute.part import Part
from precompute.part_interface import interface_of
from precompute.pipeline import reduce_part, silent

ANGULAR = {"moment": "r", "rotation": "r", "angular_velocity": "r", "angular_acceleration": "r"}
LINEAR = {"force": "", "displacement": "", "velocity": "", "acceleration": ""}
PREFIX = LINEAR | ANGULAR


@dataclass(frozen=True, eq=False)  # arrays have no one truth value
class Body:
    """M ü + D u̇ + K u = Σ w f, and a port moves by wᵀu.

    M, D, K: (n, n) symmetric; ports: w (n,) of each direction of each port, named "tip.z", "tip.rz".
    """

    M: Floats
    D: Floats
    K: Floats
    ports: Mapping[str, Floats]


def port_of(variable: str) -> str:
    """The direction of a port that a variable of the FMU is of: "tip.velocity.z" → "tip.z"."""
    port, kind, axis = variable.rsplit(".", 2)
    return f"{port}.{PREFIX[kind]}{axis}"


def full_body(part: Part) -> Body:
    """All degrees of freedom that no support holds, with the damping αM + βK of the part file.

    Raises ValueError for another form of damping, which is that of modes and has no matrix.
    """
    model = reduce_part(part).model
    connection = connect(part, read_full_part(part, silent))
    if model.D_rest.any():
        raise ValueError(f"{part.name}: got damping that is not αM + βK, expected [damping] alpha and beta")
    interface, held = interface_of(connection, None), connection.held
    free = np.setdiff1d(np.arange(held.T.shape[1]), held.fixed)
    M, K = (A.toarray()[np.ix_(free, free)] for A in (held.system.M, held.system.K))
    w = _by_port(model, interface.b.toarray()[free], interface.c.toarray()[:, free])
    return Body(M, model.alpha * M + model.beta * K, K, w)


def reduced_body(model: ReducedModel) -> Body:
    """q̈ + D̃ q̇ + Λ q = B u, what the FMU of this model solves."""
    D = np.diag(model.alpha + model.beta * model.lam) + model.D_rest
    return Body(np.eye(len(model.lam)), D, np.diag(model.lam), _by_port(model, model.B, model.C))


def point_mass(mass: float, port: str) -> Body:
    """One mass in kg, free in one direction."""
    return Body(np.array([[mass]]), np.zeros((1, 1)), np.zeros((1, 1)), {port: np.ones(1)})


def together(bodies: Mapping[str, Body]) -> Body:
    """Bodies side by side; a port "tip.z" of the body "left" becomes "left.tip.z"."""
    M, D, K = (block_diag(*(getattr(body, key) for body in bodies.values())) for key in "MDK")
    ports, start = {}, 0
    for name, body in bodies.items():
        for port, w in body.ports.items():
            ports[f"{name}.{port}"] = np.pad(w, (start, len(M) - start - len(w)))
        start += len(body.M)
    return Body(M, D, K, ports)


def joined(body: Body, first: str, second: str | None, stiffness: float, damping: float) -> Body:
    """A spring (N/m) and a damper (N·s/m) between two ports, or from the first one to the ground."""
    g = body.ports[first] - (body.ports[second] if second else 0.0)
    G = np.outer(g, g)
    return replace(body, K=body.K + stiffness * G, D=body.D + damping * G)


def tied(body: Body, pairs: Iterable[tuple[str, str]]) -> Body:
    """Ports that move as one: u = T û with (w₁ − w₂)ᵀ T = 0 for each pair, T orthonormal."""
    T = null_space(np.array([body.ports[a] - body.ports[b] for a, b in pairs]))
    M, D, K = (T.T @ A @ T for A in (body.M, body.D, body.K))
    return Body(M, D, K, {name: T.T @ w for name, w in body.ports.items()})


def modal(body: Body, count: int | None = None) -> Body:
    """The same in the lowest modes of the whole system, all of them where no count is given."""
    lam, Phi = eigh(body.K, body.M, subset_by_index=None if count is None else (0, count - 1))
    ports = {name: Phi.T @ w for name, w in body.ports.items()}
    return Body(np.eye(len(lam)), Phi.T @ body.D @ Phi, np.diag(lam), ports)


def _by_port(model: ReducedModel, B: Floats, C: Floats) -> Mapping[str, Floats]:
    """w of every direction that has a force or a motion; what is fed through has no w."""
    motions = [name for name, law in zip(model.outputs, model.laws, strict=True) if ROWS[law]]
    if model.R.any() or len(C) != len(motions):
        raise ValueError(f"{model.name}: got feed-through or stresses, expected forces and motions alone")
    measured = {port_of(name): c for name, c in zip(motions, C, strict=True)}
    return measured | {port_of(name): b for name, b in zip(model.inputs, B.T, strict=True)}
