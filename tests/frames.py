"""Straight frames of Euler–Bernoulli beams with 6 degrees of freedom per node, by the textbook matrices.

Przemieniecki, Theory of Matrix Structural Analysis, 1968, 5.6 (K) and 11.4 (consistent M, no shear and no
rotary inertia).
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from precompute.arrays import Floats, Ints


@dataclass(frozen=True)
class Frame:
    """K, M (6k, 6k), points (k, 3); node of each row from 0, direction 0 … 5."""

    K: csr_array
    M: csr_array
    points: Floats
    node: Ints
    direction: Ints


@dataclass(frozen=True)
class Beam:
    """E, G Pa; ρ kg/m³; A m²; I_y, I_z, J m⁴ in the beam's own axes, x along it."""

    E: float
    G: float
    rho: float
    A: float
    Iy: float
    Iz: float
    J: float


def straight(beam: Beam, length: float, cells: int, axes: Floats) -> Frame:
    """The beam from the origin along axes[0]; axes: (3, 3), rows are the beam's x, y, z."""
    h = length / cells
    k, m = _element(beam, h)
    T = np.kron(np.eye(4), axes)
    k, m = T.T @ k @ T, T.T @ m @ T
    n = 6 * (cells + 1)
    K, M = np.zeros((n, n)), np.zeros((n, n))
    for e in range(cells):
        at = slice(6 * e, 6 * e + 12)
        K[at, at] += k
        M[at, at] += m
    points = np.outer(np.arange(cells + 1) * h, axes[0])
    node = np.repeat(np.arange(cells + 1), 6)
    symmetric = [csr_array(0.5 * (A + A.T)) for A in (K, M)]
    return Frame(*symmetric, points, node, np.tile(np.arange(6), cells + 1))


def _element(beam: Beam, h: float) -> tuple[Floats, Floats]:
    k, m = np.zeros((12, 12)), np.zeros((12, 12))
    ends = np.array([[1.0, -1.0], [-1.0, 1.0]])
    line = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6
    mass = beam.rho * beam.A * h
    for dof, stiffness, inertia in (
        (0, beam.E * beam.A / h, mass),
        (3, beam.G * beam.J / h, beam.rho * (beam.Iy + beam.Iz) * h),
    ):
        at = np.ix_([dof, dof + 6], [dof, dof + 6])
        k[at], m[at] = stiffness * ends, inertia * line
    bend_k = np.array(
        [
            [12, 6 * h, -12, 6 * h],
            [6 * h, 4 * h * h, -6 * h, 2 * h * h],
            [-12, -6 * h, 12, -6 * h],
            [6 * h, 2 * h * h, -6 * h, 4 * h * h],
        ]
    )
    bend_m = np.array(
        [
            [156, 22 * h, 54, -13 * h],
            [22 * h, 4 * h * h, 13 * h, -3 * h * h],
            [54, 13 * h, 156, -22 * h],
            [-13 * h, -3 * h * h, -22 * h, 4 * h * h],
        ]
    )
    for dofs, sign, area in (([1, 5, 7, 11], 1.0, beam.Iz), ([2, 4, 8, 10], -1.0, beam.Iy)):
        S = np.array([1.0, sign, 1.0, sign])  # w' = −θ_y, v' = +θ_z
        at = np.ix_(dofs, dofs)
        k[at] = beam.E * area / h**3 * bend_k * np.outer(S, S)
        m[at] = mass / 420 * bend_m * np.outer(S, S)
    return k, m
