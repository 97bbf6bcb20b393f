"""Systems with known modes, made in the tests."""

from importlib.util import find_spec

import numpy as np
import pytest
from boxes import box, joined, mapped, steel
from scipy.sparse import block_diag, csr_array, diags

from precompute.arrays import Floats, Ints
from precompute.assembly import assemble
from precompute.mesh import Mesh
from precompute.system import System

SOLVERS = [
    "superlu",
    pytest.param("pardiso", marks=pytest.mark.skipif(find_spec("pypardiso") is None, reason="no pypardiso")),
]


def along_x(n: int) -> Floats:
    """Rigid motions (n, 6) of DOFs that all point in x on the x axis: one translation."""
    R = np.zeros((n, 6))
    R[:, 0] = 1.0
    return R


def chain(n: int, ground: float = 0.0) -> System:
    """n masses of 1 kg, springs of 1 N/m between them, one of `ground` N/m from the first to ground."""
    K = diags([-np.ones(n - 1), np.r_[1, np.full(n - 2, 2.0), 1], -np.ones(n - 1)], [-1, 0, 1]).tolil()
    K[0, 0] += ground
    return System(csr_array(diags([np.ones(n)], [0])), csr_array(K.tocsr()), along_x(n))


def chain_free(n: int, modes: int) -> Floats:
    """λ of the free chain, k = 0, 1, …: 4 sin²(kπ/2n)."""
    return np.asarray(4 * np.sin(np.arange(modes) * np.pi / (2 * n)) ** 2)


def chain_held(n: int, modes: int) -> Floats:
    """λ of n masses whose first is held to ground by a spring like the others: 4 sin²((2k+1)π/(4n+2))."""
    return np.asarray(4 * np.sin((2 * np.arange(modes) + 1) * np.pi / (4 * n + 2)) ** 2)


def copies(number: int, n: int, gap: float) -> tuple[System, Floats]:
    """Chains of n masses, each held, not connected, the i-th stiffer by 1 + i·gap; and all λ, ascending."""
    one = chain(n, ground=1.0)
    stiffer = 1 + gap * np.arange(number)
    K = csr_array(block_diag([s * one.K for s in stiffer]).tocsr())
    M = csr_array(block_diag([one.M] * number).tocsr())
    return System(M, K, along_x(number * n)), np.sort(np.outer(stiffer, chain_held(n, n)).ravel())


def system_of(mesh: Mesh) -> System:
    """The mesh in steel."""
    return assemble(mesh, steel(mesh))


def dofs_where(mesh: Mesh, chosen: Floats) -> Ints:
    """The three DOFs of each chosen node."""
    return np.asarray((3 * np.flatnonzero(chosen)[:, None] + np.arange(3)).ravel())


def ring(cells: int, radius: float, thickness: float, width: float) -> Mesh:
    """A closed ring about z: two halves of hex20, one cell across."""

    def half(side: int) -> Mesh:
        def bend(p: Floats) -> Floats:
            angle, r = np.pi * (p[:, 0] + side), radius + thickness * (0.5 - p[:, 1])
            return np.stack([r * np.cos(angle), r * np.sin(angle), width * p[:, 2]], axis=1)

        return mapped(box("hex20", (cells // 2, 1, 1)), bend)

    return joined(half(0), half(1))


def hollow_sphere(cells: int, inner: float, outer: float) -> Mesh:
    """Six patches of hex20, each the image of a face of the cube, one cell thick."""
    whole = None
    for axis in range(3):
        for side in (1.0, -1.0):

            def shell(p: Floats, axis: int = axis, side: float = side) -> Floats:
                a, b = np.tan(np.pi / 4 * (2 * p[:, 0] - 1)), np.tan(np.pi / 4 * (2 * p[:, 1] - 1))
                face = np.roll(np.stack([side * a, b, np.full(len(p), side)], axis=1), axis + 1, axis=1)
                r = inner + (outer - inner) * p[:, 2]
                return face / np.linalg.norm(face, axis=1)[:, None] * r[:, None]

            patch = mapped(box("hex20", (cells, cells, 1)), shell)
            whole = patch if whole is None else joined(whole, patch)
    assert whole is not None
    return whole
