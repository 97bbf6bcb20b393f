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
) -> ReducedModel:
    """B = Φᵀb, C = cΦ and R = direct feed-through + residual flexibility.

    lam: (r,) 1/s²; Phi: (n, r) mass-normalised, kg^-1/2, over the DOFs of `interface`. Raises ModelError
    where `initial` is "static" and the body has rigid modes.
    """
    m = interface.b.shape[1]
    R, R_in = (0.0, np.zeros((m, m))) if residual is None else (residual.R, residual.R_in)
    return ReducedModel(
        name=name,
        description=description,
        lam=lam,
        alpha=damping.alpha,
        beta=damping.beta,
        D_rest=damping.D_rest,
        B=np.ascontiguousarray((interface.b.T @ Phi).T),
        C=np.ascontiguousarray(interface.c @ Phi),
        R=interface.direct + R,
        R_in=R_in,
        ports=interface.ports,
        initial=initial,
        residual=residual is not None,
    )
