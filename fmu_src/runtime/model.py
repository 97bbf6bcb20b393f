"""The reduced model: modal oscillators between ports [2.29–2.32]."""

import re
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .errors import ModelError

Floats: TypeAlias = NDArray[np.float64]

IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*", re.ASCII)
NOT_XML = re.compile("[^\t\n\r -\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
LONGEST_NAME = 200  # the FMU's files carry it, and file systems end at 255 bytes
INPUT_UNITS = {"force": "N"}
OUTPUT_UNITS = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s2"}
INPUTS = tuple(f"{kind}.{k}" for kind in INPUT_UNITS for k in "xyz")
OUTPUTS = tuple(f"{kind}.{k}" for kind in OUTPUT_UNITS for k in "xyz")


@dataclass(frozen=True)
class Port:
    """Where the part meets the rest of the system; `inputs` and `outputs` such as "force.x"."""

    name: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


@dataclass(frozen=True, eq=False)  # arrays have no one truth value
class ReducedModel:
    """q̈ + D̃ q̇ + Λ q = B f,  y = C q, C q̇ or C q̈,  D̃ = αI + βΛ + D_rest [2.28, 2.32].

    lam: (r,) λ ≥ 0 ascending, 1/s², exactly 0 for rigid modes; alpha in 1/s, beta in s;
    D_rest: (r, r) 1/s, diagonal, what no α and β describe; B: (r, m) one column per input;
    C: (p, r) one row per output, both in the order of `ports`; the modes are mass-normalised,
    so that B and C are in kg^-1/2 and q in kg^1/2·m. initial: "rest", or "static" for the
    equilibrium with the start values of the inputs.

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
    ports: tuple[Port, ...]
    initial: Literal["rest", "static"] = "rest"

    def __post_init__(self) -> None:
        _check_names(self)
        r, m, p = len(self.lam), len(self.inputs), len(self.outputs)
        for key, array, shape in (
            ("lam", self.lam, (r,)),
            ("D_rest", self.D_rest, (r, r)),
            ("B", self.B, (r, m)),
            ("C", self.C, (p, r)),
        ):
            if array.shape != shape or array.dtype != np.float64:
                raise ModelError(f"{key}: got {array.dtype} {array.shape}, expected float64 {shape}")
            if not np.isfinite(array).all():
                raise ModelError(f"{key}: got a value that is not finite, expected finite numbers")
        if r == 0 or m + p == 0:
            raise ModelError(f"got {r} modes, {m} inputs and {p} outputs, expected a mode and a port")
        if self.lam[0] < 0 or (np.diff(self.lam) < 0).any():
            raise ModelError("lam: expected eigenvalues ≥ 0 in ascending order")
        if not (0 <= self.alpha < np.inf and 0 <= self.beta < np.inf):
            raise ModelError(f"got alpha {self.alpha}, beta {self.beta}, expected finite numbers ≥ 0")
        diagonal = np.diag(self.D_rest)
        if (diagonal < 0).any() or np.count_nonzero(self.D_rest) != np.count_nonzero(diagonal):
            raise ModelError("D_rest: expected a diagonal matrix with entries ≥ 0")
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
    def output_kinds(self) -> tuple[str, ...]:
        """What each output is, a key of OUTPUT_UNITS."""
        return tuple(key.split(".")[0] for port in self.ports for key in port.outputs)

    @property
    def frequency(self) -> Floats:
        """fᵢ = ωᵢ/2π in Hz, (r,) [2.30, 2.31]."""
        return np.sqrt(self.lam) / (2 * np.pi)

    def damping(self, alpha: float, beta: float) -> Floats:
        """dᵢ = α + βλᵢ + D_rest,ᵢᵢ in 1/s, (r,) [2.28]."""
        return alpha + beta * self.lam + np.diag(self.D_rest)

    def damping_ratio(self, alpha: float, beta: float) -> Floats:
        """ζᵢ for these α, β, (r,); 0 for rigid modes."""
        return damping_ratio(self.lam, self.damping(alpha, beta))


def damping_ratio(lam: Floats, d: Floats) -> Floats:
    """ζᵢ = dᵢ/(2ωᵢ), and 0 for rigid modes, which have no ratio; lam, d and the result (r,)."""
    omega = np.sqrt(lam)
    zeta: Floats = np.divide(d, 2 * omega, out=np.zeros_like(omega), where=omega > 0)
    return zeta


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
    known = INPUTS + OUTPUTS
    for port in model.ports:
        unknown = [k for k in port.inputs if k not in INPUTS] + [k for k in port.outputs if k not in OUTPUTS]
        if unknown:
            raise ModelError(f"port {port.name}: got {unknown[0]!r}, expected one of {', '.join(known)}")
        if len({*port.inputs}) + len({*port.outputs}) < len(port.inputs + port.outputs):
            raise ModelError(f"port {port.name}: got a variable twice, expected each once")
