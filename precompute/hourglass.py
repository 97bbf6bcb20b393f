"""Assumed-strain stabilisation of the hexahedron with uniform strain (hex8r).

The uniform strain part sees only the mean gradient b_a = 1/V ∫ ∇N_a dV, so 12 motions besides the
rigid ones have no energy: the amplitudes q_αi of the hourglass functions
h₁ = ηζ, h₂ = ζξ, h₃ = ξη, h₄ = ξηζ (ξ, η, ζ ∈ [−1, 1]) in each direction i,

    q_αi = Σ_a γ_αa u_ai,   γ_α = (h_α − Σ_j (h_αᵀ x_j) b_j) / 8.

γ_αᵀ 1 = 0 and γ_αᵀ x_j = 0 for every shape (as b_iᵀ x_j = δ_ij): constant strain has q = 0, it stays exact.
The strains assumed for q are those of Belytschko and Bindeman, Assumed strain stabilization of the eight
node hexahedral element, Comput. Methods Appl. Mech. Eng. 105 (1993) 225-260 (field ASQBI). With
h_α,i = ∂h_α/∂x_i and (i, j, k) any order of the axes:

    ε_ii = Σ_α h_α,i q_αi − Σ_{j≠i} (ν/(1−ν) h_k,j q_kj + ν h₄,j q_4j)
    γ_ij = h_i,j q_ii + h_j,i q_jj

Why: h_k q_kj is bending in the plane i, j; it gets σ_ii = 0 and no shear, as in a beam. h₄ q_4j gets uniaxial
stress. h_i q_ii is twist: shear alone. The element neither locks in bending nor as ν → ½.
The mean of every h_α,i over the cell is 0, so uniform and assumed strains are orthogonal: their K add.

The axes i are the rotation R of the polar decomposition ∂x/∂ξ = R S at the centre: K turns with the cell and
does not depend on which corner is numbered first. As in the paper, h_α,i = (∂h_α/∂ξ_i) / S_ii.
"""

import numpy as np

from .arrays import Floats
from .elements import INTERPOLATIONS

_SIGNS = 2 * INTERPOLATIONS["hex8"].nodes - 1  # ξ, η, ζ of the corners, (8, 3)
_AXES = ((0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0))


def _hourglass_functions(xi: Floats) -> Floats:
    """h_α at points ξ (p, 3) ∈ [−1, 1]³: (p, 4)."""
    x, y, z = xi.T
    return np.stack([y * z, z * x, x * y, x * y * z], axis=1)


def _hourglass_gradients(xi: Floats) -> Floats:
    """∂h_α/∂ξ_i at points ξ (p, 3): (p, 4, 3)."""
    x, y, z = xi.T
    o = np.zeros_like(x)
    rows = [[o, z, y], [z, o, x], [y, x, o], [y * z, z * x, x * y]]
    return np.moveaxis(np.array(rows), 2, 0)


def _assumed_strain(h: Floats, poisson: float) -> Floats:
    """The displayed strains xx, yy, zz, yz, zx, xy per amplitude: (c, p, 6, 4, 3) from h_α,i (c, p, 4, 3)."""
    B = np.zeros((*h.shape[:2], 6, 4, 3))
    plane = poisson / (1 - poisson)
    for i in range(3):
        B[:, :, i, :, i] = h[..., i]
    for i, j, k in _AXES:
        B[:, :, i, k, j] = -plane * h[..., k, j]
        B[:, :, i, 3, j] = -poisson * h[..., 3, j]
        B[:, :, 3 + k, i, i] = h[..., i, j]
    return B


def _elasticity(lam: float, mu: float) -> Floats:
    """σ = C ε with engineering shear strains: (6, 6) in Pa."""
    C = np.diag([2 * mu] * 3 + [mu] * 3)
    C[:3, :3] += lam
    return C


def hourglass_stiffness(x: Floats, b: Floats, V: Floats, lam: float, mu: float) -> Floats:
    """K_hg = Tᵀ [V/8 Σ_p Bᵀ C B] T, (c, 24, 24) in N/m, with T_(αi)(am) = γ_αa R_mi.

    x: nodes (c, 8, 3) in m; b: mean gradients (c, 8, 3) in 1/m; V: volumes (c,) in m³; λ, μ in Pa.
    """
    c = len(x)
    J = np.swapaxes(x, 1, 2) @ _SIGNS / 8
    left, _, right = np.linalg.svd(J)
    R = left @ right
    S = np.einsum("cmi,cmi->ci", R, J)  # diagonal of Rᵀ J

    h_nodes = _hourglass_functions(_SIGNS).T  # (4, 8)
    gamma = (h_nodes - (h_nodes @ x) @ np.swapaxes(b, 1, 2)) / 8

    points = _SIGNS / np.sqrt(3.0)  # 2 × 2 × 2 Gauss points: exact for these products
    h = _hourglass_gradients(points) / S[:, None, None, :]
    B = _assumed_strain(h, lam / (2 * (lam + mu))).reshape(c, 8, 6, 12)
    K_q = (np.swapaxes(B, 2, 3) @ _elasticity(lam, mu) @ B).sum(axis=1) * (V / 8)[:, None, None]

    T = np.einsum("cna,cmi->cniam", gamma, R).reshape(c, 12, 24)
    K: Floats = np.swapaxes(T, 1, 2) @ K_q @ T
    return K
