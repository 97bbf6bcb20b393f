"""The reduced model: modal oscillators between ports [2.29–2.32], and ports whose motion is prescribed."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import accumulate
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .errors import ModelError
from .kinds import ROWS, Law, inputs_of, outputs_of

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.intp]

IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*", re.ASCII)
NOT_XML = re.compile("[^\t\n\r -\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
LONGEST_NAME = 200  # the FMU's files carry it, and file systems end at 255 bytes


@dataclass(frozen=True)
class Port:
    """Where the part meets the rest of the system; `inputs` and `outputs` such as "force.x"."""

    name: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


@dataclass(frozen=True, eq=False)  # arrays have no one truth value
class ReducedModel:
    """s̈ = a and q̈ + D̃ q̇ + Λ q = B u + N ṡ,  D̃ = αI + βΛ + D_rest,  outputs from x, ẋ, ẍ and R u [2.28, 2.32].

    The coordinates x = [s; q] are k displacements and rotations of ports that are prescribed by their
    accelerations a, which are among the inputs u, and the amplitudes q of r modes of the part with these
    held: it deforms by Ψ s + Φ q, Ψ what follows s statically, ΨᵀKΦ = 0. The modes move relative to Ψ s, so
    that B_a = −ΦᵀMΨ are the columns of a, and damping of the whole motion drags them: N = αB_a − ΦᵀDΨ.

    lam: (k + r,) 1/s², 0 for s, then λ ≥ 0 ascending, exactly 0 for rigid modes; alpha in 1/s, beta in s;
    empty where there is no state: then all that is left is R u, as of a spring between two parts;
    D_rest: (k + r, k + r) 1/s, symmetric ≥ 0, what no α and β describe, ΦᵀDΨ beside the modes; an entry off
    its diagonal couples two modes; the part between s and s moves nothing;
    B: (k + r, m) one column per input, in the rows of s 1 for its own acceleration and else 0;
    C: (rows, k + r) and R: (rows, m), `ROWS[law]` rows per output (kinds.py), R being the feed-through of its
    inputs; all in the order of `ports`. The modes are mass-normalised, so that q is in kg^½·m, B and C for
    forces and displacements in kg^-½. The third row of a reaction has entries for s only (ΨᵀKΦ = 0).
    R_in: (m, m) symmetric, the residual flexibility between the inputs: ½ uᵀR_in u is its strain energy.
    residual: elastic modes that are switched off follow B u statically and join R and R_in.
    initial: "rest", or "static" for the equilibrium with the start values of the inputs and of ṡ.
    M_s = ΨᵀMΨ and K_s = ΨᵀKΨ: (k, k) symmetric, of the energies; (0, 0) where nothing is prescribed.

    Raises ModelError where a shape or value is not so.
    Source: Clough & Penzien, Dynamics of Structures, 2nd ed., chapter 26 (multi-support excitation).
    """

    name: str
    description: str
    lam: Floats
    alpha: float
    beta: float
    D_rest: Floats
    B: Floats
    C: Floats
    R: Floats
    R_in: Floats
    ports: tuple[Port, ...]
    initial: Literal["rest", "static"] = "rest"
    residual: bool = False
    M_s: Floats = field(default_factory=lambda: np.zeros((0, 0)))
    K_s: Floats = field(default_factory=lambda: np.zeros((0, 0)))

    def __post_init__(self) -> None:
        _check_names(self)
        n, m, s = len(self.lam), len(self.inputs), sum(ROWS[law] for law in self.laws)
        for key, array, shape in (
            ("lam", self.lam, (n,)),
            ("D_rest", self.D_rest, (n, n)),
            ("B", self.B, (n, m)),
            ("C", self.C, (s, n)),
            ("R", self.R, (s, m)),
            ("R_in", self.R_in, (m, m)),
            ("M_s", self.M_s, (self.k, self.k)),
            ("K_s", self.K_s, (self.k, self.k)),
        ):
            if array.shape != shape or array.dtype != np.float64:
                raise ModelError(f"{key}: got {array.dtype} {array.shape}, expected float64 {shape}")
            if not np.isfinite(array).all():
                raise ModelError(f"{key}: got a value that is not finite, expected finite numbers")
        if not (self.inputs or self.outputs):
            raise ModelError("got no inputs and outputs, expected a port")
        if self.k and self.r <= 0:
            raise ModelError(f"got {self.r} modes beside {self.k} prescribed motions, expected a mode")
        _check_motions(self)
        if (self.lam < 0).any() or (np.diff(self.lam) < 0).any():
            raise ModelError("lam: expected eigenvalues ≥ 0 in ascending order")
        if not (0 <= self.alpha < np.inf and 0 <= self.beta < np.inf):
            raise ModelError(f"got alpha {self.alpha}, beta {self.beta}, expected finite numbers ≥ 0")
        for key, array in (("D_rest", self.D_rest), ("M_s", self.M_s), ("K_s", self.K_s)):
            if (np.diag(array) < 0).any() or (array != array.T).any():
                raise ModelError(f"{key}: expected a symmetric matrix with a diagonal ≥ 0")
        if (self.R_in != self.R_in.T).any():
            raise ModelError("R_in: expected a symmetric matrix")
        if self.initial not in ("rest", "static"):
            raise ModelError(f'initial: got {self.initial!r}, expected "rest" or "static"')
        if self.initial == "static" and (self.lam[self.k : self.k + 1] == 0).any():
            raise ModelError('initial = "static" needs a body without rigid modes: support it, or use "rest"')

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs, the columns of B."""
        return tuple(f"{port.name}.{key}" for port in self.ports for key in port.inputs)

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs, the rows of C."""
        return tuple(f"{port.name}.{key}" for port in self.ports for key in port.outputs)

    @property
    def laws(self) -> tuple[Law, ...]:
        """How each output is computed."""
        return tuple(outputs_of(port.name)[key].law for port in self.ports for key in port.outputs)

    @cached_property
    def motions(self) -> Ints:
        """The places (k,) among the inputs of the accelerations that are prescribed, in the order of s."""
        given = [inputs_of(port.name)[key].prescribes for port in self.ports for key in port.inputs]
        return np.flatnonzero([prescribed is not None for prescribed in given])

    @cached_property
    def k(self) -> int:
        """How many motions are prescribed."""
        return len(self.motions)

    @property
    def r(self) -> int:
        """How many modes there are."""
        return len(self.lam) - self.k

    @property
    def coupled(self) -> Ints:
        """The places in x of the modes that D_rest couples to another one, ascending."""
        off = self.D_rest - np.diag(np.diag(self.D_rest))
        found: Ints = self.k + np.flatnonzero(off[self.k :, self.k :].any(axis=1))
        return found

    @property
    def frequency(self) -> Floats:
        """fᵢ = ωᵢ/2π of the modes in Hz, (r,) [2.30, 2.31]."""
        return np.sqrt(self.lam[self.k :]) / (2 * np.pi)

    def damping(self, alpha: float, beta: float) -> Floats:
        """The diagonal of D̃ in 1/s, (k + r,): 0 for s, dᵢ = α + βλᵢ + D_rest,ᵢᵢ for the modes [2.28]."""
        d: Floats = alpha + beta * self.lam + np.diag(self.D_rest)
        d[: self.k] = 0.0
        return d

    def damping_ratio(self, alpha: float, beta: float) -> Floats:
        """ζᵢ of the modes for these α, β, (r,); 0 for rigid modes."""
        return damping_ratio(self.lam[self.k :], self.damping(alpha, beta)[self.k :])

    def drag(self, alpha: float) -> Floats:
        """N = αB_a − ΦᵀDΨ in 1/s, (k + r, k), 0 in the rows of s: N ṡ is the modal force of what brakes Ψṡ.

        αM and D act on the whole motion Ψ s + Φ q; βK adds nothing, as ΦᵀKΨ = 0.
        """
        N: Floats = alpha * self.B[:, self.motions] - self.D_rest[:, : self.k]
        N[: self.k] = 0.0
        return N


def damping_ratio(lam: Floats, d: Floats) -> Floats:
    """ζᵢ = dᵢ/(2ωᵢ), and 0 for rigid modes, which have no ratio; lam, d and the result (r,)."""
    omega = np.sqrt(lam)
    zeta: Floats = np.divide(d, 2 * omega, out=np.zeros_like(omega), where=omega > 0)
    return zeta


def row_starts(laws: Sequence[Law]) -> list[int]:
    """The first row of C and R of each output, and the number of rows at the end."""
    return [0, *accumulate(ROWS[law] for law in laws)]


def _check_motions(model: ReducedModel) -> None:
    """What the rows and columns of s hold."""
    k, B_s = model.k, np.zeros((model.k, len(model.inputs)))
    B_s[np.arange(k), model.motions] = 1.0
    if model.lam[:k].any():
        raise ModelError(f"lam: expected 0 for the first {k}, whose motion is prescribed")
    if (model.B[:k] != B_s).any():
        raise ModelError(f"B: expected in the first {k} rows 1 for the acceleration of each, else 0")
    starts = row_starts(model.laws)
    elastic = [starts[i] + 2 for i, law in enumerate(model.laws) if law == "reaction"]
    if model.C[elastic, k:].any():
        raise ModelError("C: expected 0 for modes in the third row of a reaction: held ports feel no K Φ")


def _check_names(model: ReducedModel) -> None:
    if len(model.name) > LONGEST_NAME:
        raise ModelError(f"name: got {len(model.name)} characters, expected at most {LONGEST_NAME}")
    for what, name in [("name", model.name), *(("port", port.name) for port in model.ports)]:
        if not IDENTIFIER.fullmatch(name):
            raise ModelError(f"{what}: got {name!r}, expected a C identifier: letters, digits and _")
    if bad := NOT_XML.search(model.description):
        raise ModelError(
            f"description: got the character {bad.group()!r}, which XML cannot hold; leave it out"
        )
    names = [port.name for port in model.ports]
    if len(set(names)) != len(names):
        raise ModelError(f"ports: got the names {names}, expected unique names")
    for port in model.ports:
        for given, known in ((port.inputs, inputs_of(port.name)), (port.outputs, outputs_of(port.name))):
            unknown = [key for key in given if key not in known]
            if unknown:
                listed = ", ".join(known) or "none"
                raise ModelError(f"port {port.name}: got {unknown[0]!r}, expected one of {listed}")
            if len({*given}) < len(given):
                raise ModelError(f"port {port.name}: got a variable twice, expected each once")
