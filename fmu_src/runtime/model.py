"""The reduced model: modal oscillators between ports [2.29–2.32]."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
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
    """q̈ + D̃ q̇ + Λ q = B u,  D̃ = αI + βΛ + D_rest,  outputs from C q, C q̇ or C q̈ and R u [2.28, 2.32].

    lam: (r,) λ ≥ 0 ascending, 1/s², exactly 0 for rigid modes; alpha in 1/s, beta in s;
    D_rest: (r, r) 1/s, symmetric ≥ 0, what no α and β describe; an entry off its diagonal couples two modes;
    B: (r, m) one column per input; C: (s, r) and R: (s, m), `ROWS[law]` rows per output (kinds.py), R being
    the feed-through of its inputs; all in the order of `ports`. The modes are mass-normalised, so that q is
    in kg^½·m, B and C for forces and displacements in kg^-½.
    R_in: (m, m) symmetric, the residual flexibility between the inputs: ½ uᵀR_in u is its strain energy.
    residual: elastic modes that are switched off follow statically and join R and R_in.
    initial: "rest", or "static" for the equilibrium with the start values of the inputs.

    Raises ModelError where a shape or value is not so.
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

    def __post_init__(self) -> None:
        _check_names(self)
        r, m, s = len(self.lam), len(self.inputs), sum(ROWS[law] for law in self.laws)
        for key, array, shape in (
            ("lam", self.lam, (r,)),
            ("D_rest", self.D_rest, (r, r)),
            ("B", self.B, (r, m)),
            ("C", self.C, (s, r)),
            ("R", self.R, (s, m)),
            ("R_in", self.R_in, (m, m)),
        ):
            if array.shape != shape or array.dtype != np.float64:
                raise ModelError(f"{key}: got {array.dtype} {array.shape}, expected float64 {shape}")
            if not np.isfinite(array).all():
                raise ModelError(f"{key}: got a value that is not finite, expected finite numbers")
        if r == 0 or not (self.inputs or self.outputs):
            raise ModelError(f"got {r} modes, {m} inputs and no output, expected a mode and a port")
        if self.lam[0] < 0 or (np.diff(self.lam) < 0).any():
            raise ModelError("lam: expected eigenvalues ≥ 0 in ascending order")
        if not (0 <= self.alpha < np.inf and 0 <= self.beta < np.inf):
            raise ModelError(f"got alpha {self.alpha}, beta {self.beta}, expected finite numbers ≥ 0")
        if (np.diag(self.D_rest) < 0).any() or (self.D_rest != self.D_rest.T).any():
            raise ModelError("D_rest: expected a symmetric matrix with a diagonal ≥ 0")
        if (self.R_in != self.R_in.T).any():
            raise ModelError("R_in: expected a symmetric matrix")
        if self.initial not in ("rest", "static"):
            raise ModelError(f'initial: got {self.initial!r}, expected "rest" or "static"')
        if self.initial == "static" and self.lam[0] == 0:
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

    @property
    def coupled(self) -> Ints:
        """The modes that D_rest couples to another one, ascending."""
        off = self.D_rest - np.diag(np.diag(self.D_rest))
        found: Ints = np.flatnonzero(off.any(axis=1))
        return found

    @property
    def frequency(self) -> Floats:
        """fᵢ = ωᵢ/2π in Hz, (r,) [2.30, 2.31]."""
        return np.sqrt(self.lam) / (2 * np.pi)

    def damping(self, alpha: float, beta: float) -> Floats:
        """dᵢ = α + βλᵢ + D_rest,ᵢᵢ in 1/s, (r,) [2.28]: the diagonal of D̃."""
        return alpha + beta * self.lam + np.diag(self.D_rest)

    def damping_ratio(self, alpha: float, beta: float) -> Floats:
        """ζᵢ for these α, β, (r,); 0 for rigid modes."""
        return damping_ratio(self.lam, self.damping(alpha, beta))


def damping_ratio(lam: Floats, d: Floats) -> Floats:
    """ζᵢ = dᵢ/(2ωᵢ), and 0 for rigid modes, which have no ratio; lam, d and the result (r,)."""
    omega = np.sqrt(lam)
    zeta: Floats = np.divide(d, 2 * omega, out=np.zeros_like(omega), where=omega > 0)
    return zeta


def row_starts(laws: Sequence[Law]) -> list[int]:
    """The first row of C and R of each output, and the number of rows at the end."""
    return [0, *accumulate(ROWS[law] for law in laws)]


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
