"""Frequency responses of a reduced model whose ports are pushed and moved, motions included."""

import numpy as np
from numpy.typing import NDArray

from fmu_src.runtime.model import ReducedModel, row_starts
from precompute.oscillators import Complexes


def responses(model: ReducedModel, omega: float) -> Complexes:
    """H (p, m) of all outputs but mises and energies at one ω in rad/s, by its equations.

    s = a/(iω)², (Λ − ω² + iωD̃) q = B u + N ṡ.
    """
    k, iw = model.k, 1j * omega
    a = np.eye(len(model.inputs))[model.motions]
    D = model.D_rest + np.diag(model.alpha + model.beta * model.lam)
    A = np.diag(model.lam + iw**2) + iw * D
    q = np.linalg.solve(A[k:, k:], (model.B + model.drag(model.alpha) @ a / iw)[k:])
    x: NDArray[np.complex128] = np.concatenate([a / iw**2, q])
    y = []
    for row, law in zip(row_starts(model.laws), model.laws, strict=False):
        if law in ("mises", "kinetic", "strain"):
            continue
        C, R = model.C[row], model.R[row]
        match law:
            case "position":
                y.append(C @ x + R)
            case "velocity":
                y.append(iw * (C @ x + R))
            case "acceleration":
                y.append(iw**2 * (C @ x) + R)
            case "reaction":
                C_1, C_2, C_3 = model.C[row : row + 3] @ x
                y.append((iw**2 + iw * model.alpha) * C_1 + iw * C_2 + (1 + iw * model.beta) * C_3 + R)
    return np.array(y)
