"""Small parts with ports that are driven by their accelerations: dense matrices, and their reduced models.

The full part is its own oracle: its constrained equations by the exponential of their state matrix, in
coordinates that know nothing of modes and static shapes.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh, expm, null_space

from fmu_src.runtime.kinds import outputs_of
from fmu_src.runtime.model import Floats, Port, ReducedModel

MOVES = ("left.motion.y", "left.angular_motion.z", "right.motion.x")  # s, the first k of them
MOVED = {"left.displacement.y": 0, "left.velocity.y": 0, "left.acceleration.y": 0, "left.rotation.z": 1}
REACTIONS = ("left.reaction.y", "left.reaction_moment.z", "right.reaction.x")
N = 9  # DOFs, of which a support holds the last


def ports(k: int) -> tuple[Port, ...]:
    """Driven in k directions, with forces before, between and behind."""

    def of(port: str, names: tuple[str, ...]) -> tuple[str, ...]:
        return tuple(name.split(".", 1)[1] for name in names[:k] if name.startswith(port))

    left = ("displacement.y", "velocity.y", "acceleration.y", "rotation.z", *of("left", REACTIONS))
    return (
        Port("left", ("force.x", *of("left", MOVES)), (*left, "stress.mises")),
        Port("right", (*of("right", MOVES), "force.y"), ("acceleration.y", *of("right", REACTIONS))),
        Port("gap", (), ("displacement.z", "velocity.z")),
        Port("clamp", (), ("reaction.z",)),
        Port("gravity", ("z",), ()),
        Port("energy", (), ("kinetic", "strain")),
    )


@dataclass(frozen=True, eq=False)
class Part:
    """M ü + (αM + βK + wwᵀ) u̇ + K u = b f + W r with Wᵀu = [s; 0].

    M, K: (n, n); w: (n, 2), dashpots; W: (n, k + 1), the last column a support: r are the reactions of the
    motions and of the support; b: (n, m), 0 for the accelerations among the inputs, whose places are
    `motions`; c: output → rows (1 or 6, n) of what it measures.
    """

    M: Floats
    K: Floats
    w: Floats
    W: Floats
    b: Floats
    motions: NDArray[np.intp]
    c: Mapping[str, Floats]
    alpha: float
    beta: float

    @property
    def k(self) -> int:
        return len(self.motions)


def part(
    k: int = 3,
    *,
    seed: int = 1,
    rigid: bool = False,
    dashpots: bool = True,
    alpha: float = 0.4,
    beta: float = 2e-3,
) -> Part:
    """rigid: a motion is left that neither the ports nor the support hold; dashpots: two, else w = 0."""
    rng = np.random.default_rng(seed)
    names = [f"{port.name}.{key}" for port in ports(k) for key in port.inputs]
    motions = np.array([names.index(name) for name in MOVES[:k]], dtype=np.intp)
    A, B, C, W = rng.standard_normal((4, N, N))
    M, K, w = np.eye(N) + 0.1 * A @ A.T, 40.0 * B @ B.T, 2.0 * C[:, :2] * dashpots
    W = np.column_stack([W[:, :k], np.eye(N)[:, -1]])
    b = rng.standard_normal((N, len(names)))
    b[:, motions] = 0.0
    if rigid:
        free = rng.standard_normal(N)
        free[-1] = 0.0
        rest = np.eye(N) - np.outer(free, free) / (free @ free)
        K, W, w = rest @ K @ rest, rest @ W, rest @ w
    c = {}
    for port in ports(k):
        for key in port.outputs:
            name, law = f"{port.name}.{key}", outputs_of(port.name)[key].law
            if law in ("position", "velocity", "acceleration", "mises"):
                own = rng.standard_normal((6 if law == "mises" else 1, N))
                c[name] = W[:, [MOVED[name]]].T if MOVED.get(name, k) < k else own
    return Part(M, symmetric(K), w, W, b, motions, c, alpha, beta)


def symmetric(A: Floats) -> Floats:
    return (A + A.T) / 2


def reduced(full: Part, **changes: object) -> ReducedModel:
    """The model with all modes: it moves as the full part does."""
    k, m = full.k, full.b.shape[1]
    Z = null_space(full.W.T)
    lam, Y = eigh(symmetric(Z.T @ full.K @ Z), symmetric(Z.T @ full.M @ Z))
    lam = np.where(lam < 1e-9 * lam[-1], 0.0, lam)
    Phi, held = Z @ Y, np.zeros((k + 1, k + 1))
    static = np.linalg.pinv(np.block([[full.K, full.W], [full.W.T, held]]), rcond=1e-11)[:N, N:]
    Psi = static[:, :k]
    T = np.column_stack([Psi, Phi])
    w = T.T @ full.w
    B = np.vstack([np.zeros((k, m)), Phi.T @ full.b])
    B[:k, full.motions], B[k:, full.motions] = np.eye(k), -Phi.T @ full.M @ Psi
    C, R = [], []
    for port in ports(k):
        for key in port.outputs:
            name = f"{port.name}.{key}"
            if "reaction" in key:
                psi = static[:, REACTIONS.index(name) if name in REACTIONS else k]
                elastic = np.concatenate([psi @ full.K @ Psi, np.zeros(len(lam))])
                C += [psi @ full.M @ T, (psi @ full.w) @ w.T, elastic]
                R += [-psi @ full.b, np.zeros(m), np.zeros(m)]
            elif name in full.c:
                moved = MOVED.get(name, k)
                C += [*(full.c[name] @ T)] if moved >= k else [np.eye(len(T.T))[moved]]
                R += [np.zeros(m)] * len(full.c[name])
    given = {
        "name": "driven",
        "description": "ports that are moved",
        "lam": np.concatenate([np.zeros(k), lam]),
        "alpha": full.alpha,
        "beta": full.beta,
        "D_rest": symmetric(w @ w.T),
        "B": B,
        "C": np.array(C),
        "R": np.array(R),
        "R_in": np.zeros((m, m)),
        "ports": ports(k),
        "M_s": symmetric(Psi.T @ full.M @ Psi),
        "K_s": symmetric(Psi.T @ full.K @ Psi),
    }
    return ReducedModel(**{**given, **changes})  # type: ignore[arg-type]  # changes are of any field


def driven(name: str = "driven", **of: object) -> ReducedModel:
    """The reduced model of a part (see `part`)."""
    return reduced(part(**of), name=name)  # type: ignore[arg-type]


class Full:
    """The full part in motion: w and ẇ of u = P s + Z w, P and Z not knowing M, K, D; s and ṡ; the inputs."""

    def __init__(self, of: Part, s: Floats, s_dot: Floats) -> None:
        """At the static deformation that the start of s gives, moving as its start of ṡ does."""
        self.part = of
        k, m = of.k, of.b.shape[1]
        self.Z = null_space(of.W.T)
        self.P = (of.W @ np.linalg.inv(of.W.T @ of.W))[:, :k]
        Z, P, r = self.Z, self.P, self.Z.shape[1]
        self.D = of.alpha * of.M + of.beta * of.K + of.w @ of.w.T
        S = np.eye(m)[of.motions]
        on_w, place = np.linalg.inv(Z.T @ of.M @ Z) @ Z.T, np.cumsum([0, r, r, k, k, m, m, m])
        w, w_dot, at_s, at_s_dot, u, u_dot, u_ddot = (slice(a, b) for a, b in pairwise(place))
        self.A = A = np.zeros((place[-1], place[-1]))
        A[w, w_dot] = np.eye(r)
        A[w_dot, w], A[w_dot, w_dot] = -on_w @ of.K @ Z, -on_w @ self.D @ Z
        A[w_dot, at_s], A[w_dot, at_s_dot] = -on_w @ of.K @ P, -on_w @ self.D @ P
        A[w_dot, u] = on_w @ (of.b - of.M @ P @ S)
        A[at_s, at_s_dot], A[at_s_dot, u] = np.eye(k), S
        A[u, u_dot] = A[u_dot, u_ddot] = np.eye(m)
        self.places = (w, w_dot, at_s, at_s_dot, u)
        shape = np.linalg.pinv(np.vstack([Z.T @ of.K @ Z])) @ -(Z.T @ of.K @ P)
        self.x = np.zeros(place[-1])
        self.x[w], self.x[w_dot], self.x[at_s], self.x[at_s_dot] = shape @ s, shape @ s_dot, s, s_dot
        self.inputs = slice(u.start, u_ddot.stop)

    def move(self, h: float, u: Floats) -> None:
        """Over a step h with these inputs and rates (1 … 3, m)."""
        self.x[self.inputs] = 0.0
        self.x[self.inputs.start :][: u.size] = u.ravel()
        self.x = expm(self.A * h) @ self.x

    def motion(self) -> list[Floats]:
        """u and its derivatives up to the fourth, (n,) each."""
        w, _, s, _, _ = self.places
        rates = [self.x]
        for _ in range(4):
            rates.append(self.A @ rates[-1])
        return [self.Z @ x[w] + self.P @ x[s] for x in rates]

    def outputs(self) -> dict[str, Floats]:
        """Every output but its stress, with its first and second derivative."""
        of, u = self.part, self.motion()
        rates = [self.x, self.A @ self.x, self.A @ self.A @ self.x]
        f = [x[self.places[-1]] for x in rates]
        found = {}
        for name, rows in of.c.items():
            law = outputs_of("left")[name.split(".", 1)[1]].law
            first = {"position": 0, "velocity": 1, "acceleration": 2}.get(law)
            if first is not None:
                found[name] = np.array([rows[0] @ u[first + order] for order in range(3)])
        forces = [of.M @ u[i + 2] + self.D @ u[i + 1] + of.K @ u[i] - of.b @ f[i] for i in range(3)]
        r = np.linalg.lstsq(of.W, np.array(forces).T, rcond=None)[0]
        found |= {name: r[j] for j, name in enumerate([*REACTIONS[: of.k], "clamp.reaction.z"])}
        for name, G, e in (("kinetic", of.M, 1), ("strain", of.K, 0)):
            a, b, c = u[e : e + 3]
            found[f"energy.{name}"] = np.array([a @ G @ a / 2, a @ G @ b, b @ G @ b + a @ G @ c])
        return found
