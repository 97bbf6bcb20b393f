"""What truncated modes still do statically: residual flexibility, or residual vectors."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fmu_src.runtime.kinds import ROWS, STATIC_LAWS, outputs_of
from fmu_src.runtime.model import Port

from .arrays import Bools, Floats
from .eigen import Modes
from .interface import Interface
from .notice import warning
from .ritz import reduced_modes
from .statics import StaticSolver

NEW = 1e-6  # of the static response, in the norm of strain energy: less adds nothing to the kept modes


@dataclass(frozen=True)
class Residual:
    """R: (s, m), the feed-through of each row; R_in: (m, m) symmetric ≥ 0, strain energy ½ uᵀ R_in u."""

    R: Floats
    R_in: Floats


def residual_flexibility(interface: Interface, modes: Modes, solve: StaticSolver) -> Residual:
    """R = c (K⁺ − Φ Λ⁻¹ Φᵀ) b and R_in = bᵀ (K⁺ − Φ Λ⁻¹ Φᵀ) b over the elastic modes.

    All over the DOFs of `solve`. R is 0 in rows of acceleration and reaction. With X = (K⁺ − ΦΛ⁻¹Φᵀ) b,
    R_in = XᵀKX, which rounding leaves positive.
    Source: MacNeal, Computers & Structures 1 (1971); inertia relief as in Craig & Kurdila, ch. 17.
    """
    X = _truncated(modes, interface.b.toarray(), solve)
    R = np.where(static_rows(interface.ports)[:, None], interface.c @ X, 0.0)
    R_in = X.T @ (solve.system.K @ X)
    return Residual(R, (R_in + R_in.T) / 2)


def with_residual_modes(modes: Modes, b: Floats, solve: StaticSolver) -> Modes:
    """The modes of span(Φ, X), X = (K⁺ − Φ Λ⁻¹ Φᵀ) b: static loads b (n, m) deform it exactly.

    Nothing is fed through. Loads to which the modes already respond in full, and combinations of loads that
    respond alike, add nothing. The kept modes of the full model stay as they are, those of a basis may mix.
    Source: Dickens, Nakagawa & Wittbrodt, Computers & Structures 62 (1997), modal truncation augmentation.
    """
    b = b[:, solve.deforms(b)]
    X = _truncated(modes, b, solve) / np.sqrt(np.sum(b * solve(b), axis=0))
    share, Y = np.linalg.eigh(X.T @ (solve.system.K @ X))
    new = X @ Y[:, share > NEW**2]
    if new.shape[1] == 0:
        return modes
    solver = f"{modes.solver}, {new.shape[1]} residual vectors"
    more = reduced_modes(np.column_stack([modes.Phi, new]), solve.system, solve.rigid, solver)
    lost = len(modes.lam) + new.shape[1] - len(more.lam)
    if lost:
        warning(
            f'residual: {lost} of {new.shape[1]} residual vectors move no mass, so residual = "modes" lacks '
            "them; residual = true has them all"
        )
    return more


def _truncated(modes: Modes, b: Floats, solve: StaticSolver) -> Floats:
    """X = (K⁺ − Φ Λ⁻¹ Φᵀ) b, with ΦᵀKX = 0 once more, lest the rounding of soft modes stay in it."""
    lam, Phi = modes.lam[modes.rigid :, None], modes.Phi[:, modes.rigid :]
    X = solve(b) - Phi @ (Phi.T @ b / lam)
    X -= Phi @ (Phi.T @ (solve.system.K @ X) / lam)
    return X


def static_rows(ports: Sequence[Port]) -> Bools:
    """Which rows of c are motions or stresses that a static load leaves at once: (s,)."""
    laws = [outputs_of(port.name)[key].law for port in ports for key in port.outputs]
    rows: Bools = np.repeat([law in STATIC_LAWS for law in laws], [ROWS[law] for law in laws]).astype(bool)
    return rows
