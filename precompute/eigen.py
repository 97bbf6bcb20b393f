"""Linear modal analysis: K φ = λ M φ, ΦᵀMΦ = I, ΦᵀKΦ = Λ [2.23]."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from .arrays import Floats, Ints
from .canonical import EQUAL, canonical
from .dense import dense_modes
from .errors import EigenError
from .factor import Solver, choose, factoriser
from .lanczos import extend
from .notice import notice, warning
from .pencil import Pairs, Pencil, nothing
from .restraint import restrain, tell_rigid
from .rounding import eigenvalue_noise
from .sturm import count_below, lowest_modes
from .system import System
from .zero_energy import Where, refuse_mechanisms

DENSE = 500  # DOFs up to which all modes at once are as quick as some
SHARE = 4  # more than a quarter of the modes: all at once
ORTHONORMAL = 1e-10  # allowed in ΦᵀMΦ − I; Rayleigh–Ritz leaves 1e-14
MANY = 300  # modes: the Lanczos basis then costs more than its solves
LARGE = 60_000  # DOFs from which SuperLU takes minutes where PARDISO takes seconds

Say = Callable[[str], None]


@dataclass(frozen=True)
class Modes:
    """K φᵢ = λᵢ M φᵢ, ΦᵀMΦ = I [2.23].

    lam: (r,) in 1/s², ascending, exactly 0 for the `rigid` first ones; Phi: (n, r) in kg^-1/2 over all DOFs,
    0 at the fixed ones; solver: what ran, in human words.
    """

    lam: Floats
    Phi: Floats
    rigid: int
    solver: str

    def __post_init__(self) -> None:
        if self.lam.ndim != 1 or self.Phi.shape[1:] != self.lam.shape:
            raise EigenError(f"Modes: got lam {self.lam.shape}, Phi {self.Phi.shape}; expected (r,), (n, r)")
        if np.any(self.lam < 0):
            raise EigenError(f"Modes: got λ = {np.min(self.lam):g}, expected λ ≥ 0")

    @property
    def frequencies(self) -> Floats:
        """fᵢ = √λᵢ / 2π in Hz."""
        return np.asarray(np.sqrt(self.lam) / (2 * np.pi))


def solve_modes(
    system: System,
    fixed: Ints,
    *,
    count: int | None = None,
    max_frequency: float | None = None,
    solver: Solver = "auto",
    where: Where = "DOF {}".format,
    progress: Say = lambda line: None,
) -> Modes:
    """The lowest modes of K φ = λ M φ [2.23] with φ = 0 at the fixed DOFs, none missed, rigid ones first.

    count: how many, rigid ones included; or max_frequency in Hz: all with f ≤ max_frequency.
    where: DOF → its place, for messages; progress: is told what is going on.
    Raises EigenError: not exactly one of the two, more modes than free DOFs, none up to max_frequency, modes
    that do not converge or cannot be found, memory, solver not installed. ZeroEnergyError: loose pieces,
    hinges, DOFs without stiffness.
    """
    restraint = restrain(system, fixed, where)
    free, rigid = restraint.free, restraint.rigid
    _check_request(count, max_frequency, len(free))
    pencil = _pencil(system, free, rigid)
    if count is not None and count > pencil.elastic + rigid.shape[1]:
        raise EigenError(
            f"count: got {count}, the part has {pencil.elastic + rigid.shape[1]} free DOFs with mass"
        )
    tell_rigid(rigid)

    ceiling = 0.0 if max_frequency is None else (2 * np.pi * max_frequency) ** 2
    wanted = 1 if count is None else max(count - rigid.shape[1], 1)
    found = canonical(_elastic_modes(pencil, wanted, ceiling, solver, progress))
    refuse_mechanisms(pencil, found, free, where)
    lam = np.concatenate([np.zeros(rigid.shape[1]), found.lam])
    r = number_up_to(lam, ceiling) if count is None else count
    if r < len(lam) and lam[r] - lam[r - 1] <= EQUAL * lam[r]:
        notice(f"modes {r} and {r + 1} share one frequency; only the first of them is kept")
    Phi = np.zeros((len(rigid), r))
    Phi[:, : rigid.shape[1]] = rigid[:, :r]
    Phi[free, rigid.shape[1] :] = found.Phi[:, : max(r - rigid.shape[1], 0)]
    check_orthonormal(system, Phi)
    return Modes(lam[:r], Phi, min(rigid.shape[1], r), found.solver)


def _elastic_modes(pencil: Pencil, wanted: int, ceiling: float, solver: Solver, say: Say) -> Pairs:
    """At least `wanted` elastic pairs and all with λ ≤ ceiling: by Lanczos, small systems all at once."""
    n = pencil.K.shape[0]
    if pencil.elastic == 0:
        return nothing(pencil)
    if n > LARGE and choose(solver) == "superlu":
        notice(f'{n} free DOFs with SuperLU: pip install "modalfmu[fast]" brings PARDISO, which is faster')
    with factoriser(solver) as factorise:

        @cache
        def count(s: float) -> int | None:
            say("counting the modes below")
            return count_below(pencil, factorise, s)

        def search(known: Pairs, k: int) -> Pairs:
            if n <= DENSE or SHARE * (len(known.lam) + k) > pencil.elastic:
                say("all modes at once")
                return dense_modes(pencil)
            say("factorising")
            return extend(pencil, factorise(pencil.shifted(pencil.sigma)), known, k, say)

        if ceiling and n > DENSE:
            wanted = max(wanted, count(ceiling) or 0)
            if wanted > MANY:
                warning(
                    f"max_frequency: about {wanted} modes lie below {np.sqrt(ceiling) / (2 * np.pi):g} Hz; "
                    f"finding them takes long and the FMU carries them all; lower it, or give a count"
                )
        pairs = lowest_modes(pencil, search, count, wanted, ceiling)
    notice(f"modes of {n} free DOFs by {pairs.solver}")
    return pairs


def number_up_to(lam: Floats, ceiling: float) -> int:
    """How many λ ≤ ceiling, those equal to it within rounding included."""
    r = int(np.sum(lam <= ceiling * (1 + EQUAL)))
    if r == 0:
        raise EigenError(
            f"max_frequency: got {np.sqrt(ceiling) / (2 * np.pi):g} Hz, but the first mode is at "
            f"{np.sqrt(lam[0]) / (2 * np.pi):.6g} Hz; raise it"
        )
    return r


def check_orthonormal(system: System, Phi: Floats) -> None:
    error = float(np.max(np.abs(Phi.T @ (system.M @ Phi) - np.eye(Phi.shape[1]))))
    if not error <= ORTHONORMAL:
        raise EigenError(
            f"modes: got max|ΦᵀMΦ − I| = {error:.1e}, expected {ORTHONORMAL:g} at most; is M symmetric?"
        )


def _check_request(count: int | None, max_frequency: float | None, free: int) -> None:
    if (count is None) == (max_frequency is None):
        raise EigenError(
            f"modes: got count = {count}, max_frequency = {max_frequency}; expected exactly one of them"
        )
    if count is not None and not 1 <= count <= free:
        raise EigenError(f"count: got {count}, the part has {free} free DOFs; expected 1 to {free}")
    if max_frequency is not None and not 0 < max_frequency < np.inf:
        raise EigenError(f"max_frequency: got {max_frequency}, expected a positive number of Hz")


def _pencil(system: System, free: Ints, rigid: Floats) -> Pencil:
    """K and M without the rows and columns of the supports."""
    K, M = system.K, system.M
    if len(free) < K.shape[0]:
        K, M = K[free][:, free], M[free][:, free]
    noise = eigenvalue_noise(K, M, system.rigid[free, :3], system.precision)
    return Pencil(K, M, rigid[free], noise, system.precision)
