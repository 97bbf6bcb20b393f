"""The uniform-strain hexahedron: no hourglass motion, no locking, the same in every frame."""

import numpy as np
import pytest
from boxes import box, steel
from scipy.linalg import eigh
from scipy.stats import special_ortho_group

from precompute.arrays import Floats
from precompute.assembly import assemble
from precompute.cell_matrices import stiffness
from precompute.elements import INTERPOLATIONS

CORNERS = INTERPOLATIONS["hex8"].nodes
LAM, MU = 1.2, 0.8  # Pa: nothing here depends on the size of the numbers
ROUNDING = 1e-13


def warped(seed: int = 2) -> Floats:
    """Nodes (1, 8, 3) of a hexahedron without a right angle or a flat face."""
    return (CORNERS * [1.0, 1.3, 0.7] + 0.12 * np.random.default_rng(seed).standard_normal((8, 3)))[None]


def test_only_the_six_rigid_motions_have_no_energy() -> None:
    lam = np.linalg.eigvalsh(stiffness("hex8r", warped(), LAM, MU)[0])
    assert np.abs(lam[:6]).max() < ROUNDING
    assert lam[6] > 1e-2 * lam[-1]  # an element without stabilisation has 18 of them


def test_turning_the_cell_turns_its_matrix() -> None:
    x = warped()
    R = special_ortho_group.rvs(3, random_state=3)
    K, turned = stiffness("hex8r", x, LAM, MU)[0], stiffness("hex8r", x @ R.T, LAM, MU)[0]
    blocks = np.kron(np.eye(8), R)
    np.testing.assert_allclose(turned, blocks @ K @ blocks.T, atol=ROUNDING)


def test_any_corner_may_be_the_first() -> None:
    order = [5, 1, 0, 4, 6, 2, 3, 7]  # the same cell seen from another side
    x = warped()
    K, other = stiffness("hex8r", x, LAM, MU)[0], stiffness("hex8r", x[:, order], LAM, MU)[0]
    dof = (3 * np.array(order)[:, None] + np.arange(3)).ravel()
    np.testing.assert_allclose(other, K[np.ix_(dof, dof)], atol=ROUNDING)


def bending_energy(family: str, young: float, poisson: float) -> float:
    """½ uᵀKu of a brick 2a × 2b × 2c under the nodal values of u_x = κ x y."""
    size = np.array([2.0, 1.0, 0.5])
    x = ((CORNERS - 0.5) * size)[None]
    u = np.zeros((8, 3))
    u[:, 0] = 1e-3 * x[0, :, 0] * x[0, :, 1]
    lam, mu = young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))
    return float(u.ravel() @ stiffness(family, x, lam, mu)[0] @ u.ravel() / 2)


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.499999])
def test_bending_has_the_energy_of_a_plate(poisson: float) -> None:
    """½ E/(1−ν²) ∫ (κ y)² dV, cylindrical bending: no shear, and no locking as ν → ½."""
    exact = 0.5 * 1e9 / (1 - poisson**2) * 1e-3**2 * (2.0 * 1.0**3 / 12 * 0.5)
    # entries of K of the size of Lamé's λ cancel: as ν → ½ their rounding grows by λ/E against what is left
    rounding = 1e-12 + 2e-16 * poisson / ((1 + poisson) * (1 - 2 * poisson))
    assert bending_energy("hex8r", 1e9, poisson) == pytest.approx(exact, rel=rounding)
    # the fully integrated brick pays for a shear γ_xy = κ x that bending does not have: (μ/E)(2a/2b)² more
    assert bending_energy("hex8", 1e9, poisson) > 2 * exact


def first_frequency(family: str) -> float:
    mesh = box(family, (10, 1, 1), (10.0, 1.0, 1.0))
    system = assemble(mesh, steel(mesh))
    free = np.repeat(mesh.points[:, 0] > 0, 3)
    K, M = (A[free][:, free].toarray() for A in (system.K, system.M))
    return float(np.sqrt(eigh(K, M, subset_by_index=(0, 0), eigvals_only=True)[0]) / (2 * np.pi))


def test_one_row_of_cells_bends_like_a_cantilever() -> None:
    """Euler-Bernoulli: f = 1.875104² / (2π L²) √(EI/ρA); shear takes off about 1 % at L/h = 10."""
    exact = 1.875104**2 / (2 * np.pi * 10.0**2) * np.sqrt(210e9 / 7850.0 / 12)
    assert first_frequency("hex8r") == pytest.approx(exact, rel=0.02)
    assert first_frequency("hex8") > 1.2 * exact  # locks
