"""Stiffness and mass of single cells, many at a time.

K_ab = ∫ λ ∇N_a ⊗ ∇N_b + μ ∇N_b ⊗ ∇N_a + μ (∇N_a · ∇N_b) I dV,  m_ab = ∫ ρ N_a N_b dV
(Hughes, The Finite Element Method, 2000, sections 2.8, 3.8 and 7.2), with ∇N = J⁻ᵀ ∂N/∂ξ, J = ∂x/∂ξ.
"""

import numpy as np

from .arrays import Floats
from .elements import ELEMENTS, Rule
from .hourglass import hourglass_stiffness


def jacobians(x: Floats, dN: Floats) -> Floats:
    """J_ij = ∂x_i/∂ξ_j = Σ_a x_ai ∂N_a/∂ξ_j: (c, q, 3, d) from nodes x (c, k, 3) and dN (q, k, d)."""
    c, k, _ = x.shape
    q, _, d = dN.shape
    # one product of two plain matrices: much faster than one small product per cell
    J = x.transpose(0, 2, 1).reshape(3 * c, k) @ dN.transpose(1, 0, 2).reshape(k, q * d)
    return J.reshape(c, 3, q, d).transpose(0, 2, 1, 3)


def cofactors(J: Floats) -> Floats:
    """cof J = det(J) J⁻ᵀ, whose columns are the cross products of J's columns: (..., 3, 3)."""
    a, b, c = J[..., 0], J[..., 1], J[..., 2]
    return np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=-1)


def determinants(J: Floats) -> Floats:
    """det J (...)."""
    det: Floats = np.einsum("...i,...i->...", J[..., 0], np.cross(J[..., 1], J[..., 2]))
    return det


def gradients(x: Floats, rule: Rule) -> tuple[Floats, Floats]:
    """∇N_a (c, q, k, 3) in 1/m and w det J (c, q) in m³ at the points of a rule, from nodes x (c, k, 3)."""
    J = jacobians(x, rule.dN)
    cof = cofactors(J)
    det = np.einsum("...i,...i->...", J[..., 0], cof[..., 0])
    inverse = np.swapaxes(cof, -1, -2) / det[..., None, None]
    return rule.dN @ inverse, rule.w * det


def isotropic(lam: float, mu: float, G: Floats, dV: Floats) -> Floats:
    """The displayed K_ab at the points of a rule: (c, 3k, 3k) in N/m from ∇N (c, q, k, 3) and dV (c, q)."""
    c, q, k, _ = G.shape
    H = (np.sqrt(dV)[..., None, None] * G).reshape(c, q, 3 * k)
    A = (np.swapaxes(H, 1, 2) @ H).reshape(c, k, 3, k, 3)  # ∫ ∇N_a ⊗ ∇N_b dV
    K = lam * A + mu * np.swapaxes(A, 2, 4)
    trace = mu * (A[:, :, 0, :, 0] + A[:, :, 1, :, 1] + A[:, :, 2, :, 2])
    for i in range(3):
        K[:, :, i, :, i] += trace
    return K.reshape(c, 3 * k, 3 * k)


def stiffness(family: str, x: Floats, lam: float, mu: float) -> Floats:
    """K (c, 3k, 3k) in N/m, DOF 3·node + direction, of cells with nodes x (c, k, 3) in m; λ, μ in Pa.

    hex8r takes the strain of the mean gradients b_a = 1/V ∫ ∇N_a dV in the whole cell (Flanagan and
    Belytschko, Int. J. Numer. Methods Eng. 17 (1981) 679-706; the gradients at the centre would fail the
    patch test on warped cells), and a stabilisation.
    """
    G, dV = gradients(x, ELEMENTS[family].stiffness)
    if family != "hex8r":
        return isotropic(lam, mu, G, dV)
    V = dV.sum(axis=1)
    b = np.einsum("cq,cqai->cai", dV, G) / V[:, None, None]
    return isotropic(lam, mu, b[:, None], V[:, None]) + hourglass_stiffness(x, b, V, lam, mu)


def mass(family: str, x: Floats, density: float) -> Floats:
    """m (c, k, k) in kg of cells with nodes x (c, k, 3) in m, density in kg/m³; M = m ⊗ I₃."""
    rule = ELEMENTS[family].mass
    k = rule.N.shape[1]
    dV = rule.w * determinants(jacobians(x, rule.dN))
    NN = (rule.N[:, :, None] * rule.N[:, None, :]).reshape(-1, k * k)
    return (density * (dV @ NN)).reshape(-1, k, k)
