"""The reduced model between ports: f = Φᵀb u and y = cΦ q at the ports only [2.20, 2.22]."""

from typing import Literal

import numpy as np

from fmu_src.runtime.model import ReducedModel

from .arrays import Floats
from .damping import Damping
from .interface import Interface
from .residual import Residual


def reduce(
    name: str,
    description: str,
    lam: Floats,
    Phi: Floats,
    damping: Damping,
    interface: Interface,
    residual: Residual | None = None,
    initial: Literal["rest", "static"] = "rest",
    drag: Floats | None = None,
) -> ReducedModel:
    """B = Φᵀb, C = cΦ and R = direct feed-through + residual flexibility.

    lam: (r,) 1/s²; Phi: (n, r) mass-normalised, kg^-1/2, over the DOFs of `interface`. Where that has k
    prescribed motions s, the coordinates are [s; q], C = [cΨ cΦ], and drag is ΨᵀD[Ψ Φ] (k, k + r) in 1/s.
    Raises ModelError where `initial` is "static" and the body has rigid modes.
    """
    m, moved = interface.b.shape[1], interface.moved
    R, R_in = (0.0, np.zeros((m, m))) if residual is None else (residual.R, residual.R_in)
    B, C, D_rest = (interface.b.T @ Phi).T, interface.c @ Phi, damping.D_rest
    M_s = K_s = np.zeros((0, 0))
    if moved is not None:
        assert drag is not None  # it comes with prescribed motions
        k, M_s, K_s = len(moved.M), moved.M, moved.K
        lam = np.concatenate([np.zeros(k), lam])
        B, C = np.concatenate([np.eye(m)[interface.motions], B]), np.column_stack([moved.c, C])
        D_rest = np.block([[drag[:, :k], drag[:, k:]], [drag[:, k:].T, D_rest]])
    return ReducedModel(
        name=name,
        description=description,
        lam=lam,
        alpha=damping.alpha,
        beta=damping.beta,
        D_rest=D_rest,
        B=np.ascontiguousarray(B),
        C=np.ascontiguousarray(C),
        R=interface.direct + R,
        R_in=R_in,
        ports=interface.ports,
        initial=initial,
        residual=residual is not None,
        M_s=M_s,
        K_s=K_s,
    )
