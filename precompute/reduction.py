"""The reduced model between ports: f = ΦᵀF and u = Φq at the ports only [2.20, 2.22]."""

from collections.abc import Sequence
from typing import Literal

import numpy as np

from fmu_src.runtime.model import Port, ReducedModel

from .arrays import Floats
from .damping import Damping
from .ports import PortNodes, participation


def reduce(
    name: str,
    description: str,
    lam: Floats,
    Phi: Floats,
    damping: Damping,
    ports: Sequence[tuple[Port, PortNodes]],
    initial: Literal["rest", "static"] = "rest",
) -> ReducedModel:
    """B = Φᵀb and C = bᵀΦ with b the weights of each port and direction.

    lam: (r,) 1/s²; Phi: (3n, r) mass-normalised, kg^-1/2. Raises ModelError where `initial` is "static"
    and the body has rigid modes.
    """
    r = len(lam)
    B, C = [], []
    for port, where in ports:
        motion = dict(zip("xyz", participation(Phi, where), strict=True))
        B += [motion[name[-1]] for name in port.inputs]
        C += [motion[name[-1]] for name in port.outputs]
    return ReducedModel(
        name=name,
        description=description,
        lam=lam,
        alpha=damping.alpha,
        beta=damping.beta,
        D_rest=damping.D_rest,
        B=np.array(B, dtype=np.float64).reshape(-1, r).T.copy(),
        C=np.array(C, dtype=np.float64).reshape(-1, r),
        ports=tuple(port for port, _ in ports),
        initial=initial,
    )
