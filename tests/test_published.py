"""Published frequencies: benchmarks of NAFEMS, Barton's plate."""

from math import pi, sqrt

import numpy as np
from boxes import box, joined, mapped
from solids import held, system_of

from precompute.arrays import Floats
from precompute.eigen import solve_modes
from precompute.mesh import Mesh


def test_tapered_membrane_fv32() -> None:
    """NAFEMS FV32: x 0 … 10, width 5 → 1, t = 0.05, plane stress, as a solid of half the thickness.

    0.02 %: a thin solid is in plane stress up to (t/width)² ~ 1e-4 and less.
    """

    def taper(p: Floats) -> Floats:
        return np.column_stack([p[:, 0], (p[:, 1] - 0.5) * (5 - 0.4 * p[:, 0]), p[:, 2]])

    mesh = mapped(box("hex20", (16, 8, 1), (10.0, 1.0, 0.025)), taper)
    x, _, z = mesh.points.T
    system = system_of(mesh, 200e9, 0.3, 8000.0)
    root, middle, surface = held(x < 1e-9, "xy"), held(z < 1e-9, "z"), held(z > 0.025 - 1e-9, "z")
    modes = solve_modes(system, np.unique(np.concatenate([root, middle])), count=6)
    published = np.array([44.623, 130.03, 162.70, 246.05, 379.90, 391.44])
    np.testing.assert_allclose(modes.frequencies, published, rtol=2e-4)
    # plane strain, with the surface held too, is another case
    strain = solve_modes(system, np.unique(np.concatenate([root, middle, surface])), count=6)
    assert (strain.frequencies / published).min() > 1.02


def hollow_octant(cells: int, layers: int, inner: float, outer: float) -> Mesh:
    """An eighth of a hollow sphere: three patches of a cube, each mapped by equal angles."""

    def patch(p: Floats) -> Floats:
        a, b = np.tan(np.pi / 4 * p[:, 0]), np.tan(np.pi / 4 * p[:, 1])
        direction = np.column_stack([a, b, np.ones_like(a)])
        radius = inner + (outer - inner) * p[:, 2]
        return radius[:, None] * direction / np.linalg.norm(direction, axis=1, keepdims=True)

    one = mapped(box("hex20", (cells, cells, layers)), patch)
    turned = [mapped(one, lambda p, k=k: np.roll(p, k, axis=1)) for k in range(3)]
    return joined(joined(turned[0], turned[1]), turned[2])


def test_thick_hollow_sphere_fv42() -> None:
    """NAFEMS FV42: radial modes of r 1.8 … 6.0; exact 369.94, 838.03, 1451.19 Hz.

    Found among the others by their shape: u ∥ r and the same all over a sphere.
    """
    mesh = hollow_octant(4, 6, 1.8, 6.0)
    fixed = np.unique(np.concatenate([held(np.abs(mesh.points[:, k]) < 1e-9, "xyz"[k]) for k in range(3)]))
    system = system_of(mesh, 200e9, 0.3, 8000.0)
    modes = solve_modes(system, fixed, max_frequency=1600.0)
    radius = np.linalg.norm(mesh.points, axis=1)
    radial = modes.Phi.reshape(-1, 3, len(modes.lam)) * (mesh.points / radius[:, None])[:, :, None]
    outer = radial.sum(axis=1)[radius > 6.0 - 1e-9]
    uniform = np.abs(outer.mean(axis=0)) > 10 * outer.std(axis=0)
    # 0.1 %: six layers of quadratic cells over at most a wave and a half
    np.testing.assert_allclose(modes.frequencies[uniform], [369.94, 838.03, 1451.19], rtol=1e-3)
    assert len(modes.lam) > 10  # so picking them meant something


def test_square_plate_of_barton() -> None:
    """One edge clamped: f = λ²/(2πa²) √(Et²/(12ρ(1−ν²))) (Barton, J. Appl. Mech. 18 (1951) 129–134).

    0.5 %: Barton's values are upper bounds, made of a few beam functions, some tenths of a per cent high.
    """
    E, nu, rho, a, t = 200e9, 0.3, 8000.0, 1.0, 0.01
    mesh = box("hex20", (24, 24, 1), (a, a, t))
    modes = solve_modes(system_of(mesh, E, nu, rho), held(mesh.points[:, 0] < 1e-9, "xyz"), count=6)
    unit = sqrt(E * t**2 / (12 * rho * (1 - nu**2))) / (2 * pi * a**2)
    published = np.array([3.492, 8.525, 21.43, 27.33, 31.11, 54.44])
    np.testing.assert_allclose(modes.frequencies / unit, published, rtol=5e-3)
    assert (modes.frequencies / unit < published).all()
