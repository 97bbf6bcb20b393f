"""The inner loops of a step, for every set of instructions that this processor has, against numpy."""

from ctypes import POINTER, c_int, c_uint
from typing import Any

import numpy as np
import pytest
from native_maths import COutputs, CPropagator, Doubles, Kernels, kernel_tables

from fmu_src.runtime.model import Floats

EPS = np.finfo(float).eps
LANES = 8


def aligned(values: Floats) -> Floats:
    """A copy that begins at a whole register of 64 bytes."""
    block = np.empty(values.size + 8)
    start = -block.ctypes.data % 64 // 8
    copy = block[start : start + values.size].reshape(values.shape)
    copy[...] = values
    return copy


def pointer(array: Floats) -> Any:
    return array.ctypes.data_as(Doubles)


def pointers(rows: Floats) -> Any:
    return (Doubles * len(rows))(*(pointer(row) for row in rows))


@pytest.fixture(params=range(3), ids=["baseline", "avx2", "avx512"])
def kernels(request: pytest.FixtureRequest) -> Kernels:
    tables = kernel_tables()
    if request.param >= len(tables):
        pytest.skip("this processor has no such instructions")
    assert tables[request.param].instructions.decode() == ("baseline", "avx2", "avx512")[request.param]
    return tables[request.param]


LENGTHS = [0, 8, 16, 24, 56, 200]


@pytest.mark.parametrize("n", LENGTHS)
def test_add(kernels: Kernels, n: int) -> None:
    rng = np.random.default_rng(n)
    f, column = aligned(rng.standard_normal(n)), aligned(rng.standard_normal(n))
    expected, bound = f + 0.7 * column, EPS * (np.abs(f) + np.abs(column))
    kernels.add(pointer(f), pointer(column), 0.7, n)
    assert (np.abs(f - expected) <= bound).all()


@pytest.mark.parametrize("n", LENGTHS)
@pytest.mark.parametrize("degree", [0, 2, 3])
def test_step_kernels(kernels: Kernels, n: int, degree: int) -> None:
    """[q, v] of every mode, and |q|² + |v|², against numpy: up to six products summed, a rounding each."""
    rng = np.random.default_rng(n)
    E11, E12, E21, E22, G0, G1, G2, G3 = rows = aligned(rng.standard_normal((8, n)))
    given_rows = aligned(rng.standard_normal((6, n)))
    after = aligned(np.full((2, n), np.nan))
    P = CPropagator(0.1, *(pointer(row) for row in rows))
    q, v, f = map(pointer, given_rows[:3])
    if degree == 0:
        size = kernels.step_held(P, q, v, f, *map(pointer, after), n)
    else:
        move = kernels.step if degree == 2 else kernels.step_cubic
        size = move(P, q, v, pointers(given_rows[2:]), *map(pointer, after), n)
    terms = 3 + degree
    for found, factors in zip(after, ((E11, E12, G0, G1, G2, G3), (E21, E22, E12, G0, G1, G2)), strict=True):
        products = np.array(factors[:terms]) * given_rows[:terms]
        assert (np.abs(found - products.sum(axis=0)) <= 8 * EPS * np.abs(products).sum(axis=0)).all()
    assert size == pytest.approx((after**2).sum(), rel=1e-14)


@pytest.mark.parametrize("degree", [0, 2, 3])
def test_what_is_next_to_nothing_becomes_nothing(kernels: Kernels, degree: int) -> None:
    """Neither a subnormal number nor one that soon would be; larger ones and not-a-number are left alone."""
    rows = aligned(np.zeros((8, LANES)))
    rows[0] = rows[3] = 1.0  # E11, E22
    motion = np.array([5e-324, -5e-324, 9e-141, -9e-141, 1.1e-140, -1.1e-140, np.nan, 1.0])
    q, v, *forces = given_rows = aligned(np.vstack([motion, -motion, np.zeros((4, LANES))]))
    after = aligned(np.full((2, LANES), np.nan))
    P = CPropagator(0.1, *(pointer(row) for row in rows))
    if degree == 0:
        kernels.step_held(P, pointer(q), pointer(v), pointer(forces[0]), *map(pointer, after), LANES)
    else:
        move = kernels.step if degree == 2 else kernels.step_cubic
        move(P, pointer(q), pointer(v), pointers(given_rows[2:]), *map(pointer, after), LANES)
    left = np.where(np.arange(LANES) < 4, 0.0, motion)
    np.testing.assert_array_equal(after, [left, -left])


@pytest.mark.parametrize("n", LENGTHS)
def test_outputs_kernel(kernels: Kernels, n: int) -> None:
    """Rows in any order and more than once, each by its law, the first `n` of their numbers only."""
    rng = np.random.default_rng(n)
    length, first = n + LANES, 5
    C, motion = aligned(rng.standard_normal((9, length))), aligned(rng.standard_normal((5, length)))
    laws = np.array([0, 1, 2, 2, 1, 0], dtype=np.int32)
    rows = [0, 1, 2, 4, 7, 8]
    asked = np.array([3, 0, 5, 5, 1, 4, 2], dtype=np.uint32)
    outputs = COutputs(
        (Doubles * len(rows))(*(pointer(C[row]) for row in rows)),
        n,
        laws.ctypes.data_as(POINTER(c_int)),
        pointers(motion),
    )
    references = (asked + np.uint32(first)).astype(np.uint32)
    for order in (0, 1, 2):
        y = np.full(len(asked), np.nan)
        place = references.ctypes.data_as(POINTER(c_uint))
        kernels.outputs(outputs, order, place, first, len(asked), pointer(y))
        for value, k in zip(y, asked, strict=True):
            products = C[rows[k], :n] * motion[laws[k] + order, :n]
            assert abs(value - products.sum()) <= n * EPS * np.abs(products).sum()


@pytest.mark.parametrize("n", LENGTHS)
def test_dot(kernels: Kernels, n: int) -> None:
    rng = np.random.default_rng(n)
    a, b = aligned(rng.standard_normal((2, n)))
    assert abs(kernels.dot(pointer(a), pointer(b), n) - (a * b).sum()) <= n * EPS * np.abs(a * b).sum()


def symmetric(rng: np.random.Generator, g: int, n: int) -> Floats:
    """(n, n), zeros behind g."""
    A = np.zeros((n, n))
    A[:g, :g] = rng.standard_normal((g, g))
    return aligned(A + A.T)


SIZES = [(2, 8), (8, 8), (11, 16), (24, 24), (50, 56)]


@pytest.mark.parametrize(("g", "n"), SIZES)
def test_coupled(kernels: Kernels, g: int, n: int) -> None:
    """q1 += X a + Y b, v1 += Z a + X b; nothing behind the g entries of a and b counts."""
    rng = np.random.default_rng(g)
    X, Y, Z = (symmetric(rng, g, n) for _ in range(3))
    a, b, q, v = aligned(rng.standard_normal((4, n)))
    a[g:] = b[g:] = np.nan
    found = aligned(np.array([q, v]))
    kernels.coupled(*map(pointer, (X, Y, Z, a, b, *found)), g, n)
    for value, start, (first, second) in zip(found, (q, v), ((X, Y), (Z, X)), strict=True):
        exact = start[:g] + first[:g, :g] @ a[:g] + second[:g, :g] @ b[:g]
        size = np.abs(start[:g]) + np.abs(first[:g, :g]) @ np.abs(a[:g])
        size += np.abs(second[:g, :g]) @ np.abs(b[:g])
        assert (np.abs(value[:g] - exact) <= (2 * g + 2) * EPS * size).all()
        np.testing.assert_array_equal(value[g:], start[g:])


@pytest.mark.parametrize(("g", "n"), SIZES)
def test_multiply(kernels: Kernels, g: int, n: int) -> None:
    """C += A B, column by column, on and below the diagonal; columns of A behind g do not count."""
    rng = np.random.default_rng(g)
    A, B, C = aligned(rng.standard_normal((3, n, n)))  # [column, row]
    B[:, g:] = np.nan
    start = C.copy()
    kernels.multiply(pointer(C), pointer(A), pointer(B), g, n)
    exact = start + B[:, :g] @ A[:g]
    size = np.abs(start) + np.abs(B[:, :g]) @ np.abs(A[:g])
    half = np.tril(np.ones((n, n), dtype=bool)).T  # [column, row]: the row is not above the column
    assert (np.abs(C - exact) <= (g + 2) * EPS * size)[half].all()
