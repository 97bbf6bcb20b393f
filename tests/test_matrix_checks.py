"""What is refused or doubted in K, M and D, each by matrices that have that fault alone."""

import logging
import re
from pathlib import Path

import numpy as np
import pytest
from boxes import box, mapped, steel
from matrix_files import SI, write_coordinates, write_dofs
from scipy.sparse import csr_array

from precompute.assembly import assemble
from precompute.errors import MatrixError
from precompute.matrices import Imported, SystemFiles, read_system
from precompute.matrix_units import Units

MESH = box("hex8", (2, 2, 1), (0.2, 0.2, 0.1))
SYSTEM = assemble(MESH, steel(MESH))
K, M = SYSTEM.K, SYSTEM.M
N = K.shape[0]
NODE, DIRECTION = np.divmod(np.arange(N), 3)
IMPLAUSIBLE = "are the units of [system] right"


def read(
    folder: Path,
    K=K,
    M=M,
    D=None,
    node=NODE,
    direction=DIRECTION,
    points: np.ndarray | None = MESH.points,
    units: Units = SI,
    digits: int = 17,
) -> Imported:
    """Write and read back; points belong to node numbers."""
    damping = None if D is None else write_coordinates(folder / "D.mtx", csr_array(D), digits=digits)
    return read_system(
        SystemFiles(
            write_coordinates(folder / "K.mtx", csr_array(K), digits=digits),
            write_coordinates(folder / "M.mtx", csr_array(M), digits=digits),
            damping,
            write_dofs(folder / "dofs.csv", node + 1, direction, None if points is None else points[node]),
            units,
        )
    )


@pytest.fixture(autouse=True)
def said(caplog):
    caplog.set_level(logging.INFO, "modalfmu")
    return caplog


def warnings(said) -> list[str]:
    return [record.getMessage() for record in said.records if record.levelno >= logging.WARNING]


def refused(words: str, folder: Path, **changed) -> None:
    with pytest.raises(MatrixError, match=re.escape(words)) as caught:
        read(folder, **changed)
    assert "\n" not in str(caught.value)


def entry(A: csr_array, i: int, j: int, value: float) -> csr_array:
    """A with A_ij = A_ji = value."""
    A = A.tolil()
    A[i, j] = A[j, i] = value
    return csr_array(A)


def free_dofs() -> np.ndarray:
    """Those not at x = 0."""
    return np.flatnonzero(np.repeat(MESH.points[:, 0] > 0, 3))


def test_sound_matrices_raise_no_doubt(tmp_path, said):
    imported = read(tmp_path, D=1e-5 * K)
    assert warnings(said) == []
    assert said.messages == ["K is of a free body: no rigid motion costs energy"]
    assert imported.where(4) == "node 2 y at (0, 0, 0.1) m"


def test_negative_diagonal(tmp_path):
    refused("stiffness: got -1 on the diagonal at node 3 z", tmp_path, K=entry(K, 8, 8, -1.0))
    refused("mass: got -1 on the diagonal at node 3 z", tmp_path, M=entry(M, 8, 8, -1.0))
    refused("damping: got -1 on the diagonal at node 3 z", tmp_path, D=entry(K, 8, 8, -1.0))


def test_entries_too_large_off_the_diagonal(tmp_path):
    """A_ij² = 1.02 A_ii A_jj."""
    for word, name, A in (("stiffness", "K", K), ("mass", "M", M)):
        large = entry(A, 0, 3, 1.01 * np.sqrt(A[0, 0] * A[3, 3]))
        refused(f"{word}: got {large[0, 3]:g} between node ", tmp_path, **{name: large})


def test_stiffness_and_mass_exchanged(tmp_path):
    refused("are stiffness and mass exchanged?", tmp_path, K=M, M=K)
    free = free_dofs()  # supports eliminated: K then adds up to something as well
    refused(
        "are stiffness and mass exchanged?", tmp_path, K=M[free][:, free], M=K[free][:, free],
        node=NODE[free], direction=DIRECTION[free],
    )  # fmt: skip


def test_rows_in_another_order_than_the_table_says(tmp_path):
    """x of all nodes, then y, then z; the mass of a direction is then taken from rows of all three."""
    refused(
        "expected one mass and none between directions", tmp_path,
        node=np.tile(np.arange(18), 3), direction=np.repeat(np.arange(3), 18),
    )  # fmt: skip


def test_masses_that_differ_by_direction(tmp_path):
    refused("mass: got x ", tmp_path, M=entry(M, 2, 2, 2 * M[2, 2]))


def test_eliminated_directions_are_not_compared(tmp_path, said):
    """A symmetry plane: the nodes at z = 0 have no z."""
    free = np.flatnonzero(~((DIRECTION == 2) & (MESH.points[NODE, 2] == 0)))
    read(tmp_path, K=K[free][:, free], M=M[free][:, free], node=NODE[free], direction=DIRECTION[free])
    assert any(
        m.startswith("mass by the degrees of freedom that are there: x 31.4, y 31.4, z ")
        for m in said.messages
    )
    assert "K holds z rx ry: supports or springs to ground are already in it" in said.messages


def test_spring_to_ground(tmp_path, said):
    """10 kN/m at one node of steel cells: 4e-7 of K's entries is a spring, not lost digits."""
    read(tmp_path, K=entry(K, 0, 0, K[0, 0] + 1e7))
    assert "K holds x ry rz: supports or springs to ground are already in it" in said.messages
    assert warnings(said) == []


def test_negative_energy(tmp_path):
    """A negative spring between two corners, weaker than the diagonals there."""
    S = np.zeros((N, N))
    a, b = 0, N - 3
    S[np.ix_([a, b], [a, b])] = 0.4 * min(K[a, a], K[b, b]) * np.array([[-1, 1], [1, -1]])
    refused("stiffness: got 1 motions of negative strain energy, expected none", tmp_path, K=csr_array(K + S))


def test_digits_too_few_to_tell(tmp_path):
    """Four of them leave the rigid motions an energy of either sign."""
    refused(
        "motions of negative strain energy, expected none; export K with all its digits", tmp_path, digits=4
    )


def test_coordinates_of_another_order(tmp_path, said):
    points = MESH.points[np.random.default_rng(0).permutation(18)]
    read(tmp_path, points=points)
    assert len(warnings(said)) == 1
    assert re.search("K: translations cost no energy, rotations rx ry rz do; do the coordinates", said.text)


def test_fewer_digits_than_it_seems(tmp_path, said):
    """Errors of 10⁻⁹ in entries printed with 17 digits: rigid motions cost a billionth of K."""
    read(tmp_path, K=csr_array(K + 1e-9 * abs(K)))
    assert re.search(
        r"cost little energy \(.*\) but not none to its .*; export it with more digits", said.text
    )


def test_free_body_of_entries_that_went_through_fewer_digits(tmp_path, said):
    """Rounded to 13 digits, then printed with 17; without coordinates three translations have to show it."""
    rounded = csr_array(([float(f"{a:.12e}") for a in K.data], K.indices, K.indptr), shape=K.shape)
    lifted = csr_array(rounded + 1e-14 * abs(rounded))  # so that no energy is negative
    imported = read(tmp_path, K=lifted, points=None)
    assert said.messages == ["K is of a free body: no rigid motion costs energy"]
    assert 1e-15 < imported.system.precision < 1e-12


@pytest.mark.parametrize("digits", [6, 8, 10, 14])
def test_few_digits_still_show_a_free_body(tmp_path, said, digits):
    """Rounded entries leave rigid motions an energy far above ε, and within what the digits promise."""
    imported = read(tmp_path, digits=digits)
    assert said.messages == ["K is of a free body: no rigid motion costs energy"]
    assert imported.system.precision == pytest.approx(0.5 * 10.0 ** (1 - digits), rel=0.01)


@pytest.mark.parametrize(
    ("units", "words"),
    [
        (Units("m", "t", "s"), "mass per volume of the surrounding box: 7.85e+06 kg/m³ is outside"),
        (Units("mm", "kg", "s"), "mass per volume of the surrounding box: 7.85e+12 kg/m³ is outside"),
        (Units("ft", "mg", "s"), "mass per volume of the surrounding box: 0.277 kg/m³"),
        (Units("m", "kg", "ms"), "speed of waves across a cell"),
    ],
)
def test_units(tmp_path, said, units, words):
    """Steel in m, kg, s, declared otherwise: density × 10³, 10⁹; speed × 10³ … or still plausible."""
    read(tmp_path, units=units)
    if words.endswith("kg/m³"):  # 0.277 kg/m³ may be a truss
        assert warnings(said) == []
    else:
        assert re.search(re.escape(words), said.text)
        assert IMPLAUSIBLE in said.text


def test_parts_of_any_size(tmp_path, said):
    """The speed of waves is that of steel in a block of half a millimetre too."""
    mesh = mapped(MESH, lambda p: p * 2.5e-3)
    small = assemble(mesh, steel(mesh))
    read(tmp_path, K=small.K, M=small.M, points=mesh.points)
    assert warnings(said) == []


def test_units_without_coordinates(tmp_path, said):
    read(tmp_path, points=None)
    assert warnings(said) == []
    read(tmp_path, points=None, M=1e15 * M)
    assert [message.split(":")[0] for message in warnings(said)] == ["mass", "highest frequency"]


@pytest.mark.parametrize("direction", [0, 2, 4])
def test_small_parts_and_chains_pass(tmp_path, said, direction):
    """Two masses between three springs, all exact numbers of few digits; two flywheels on a shaft."""
    imported = read(
        tmp_path, K=csr_array(np.array([[2e4, -1e4], [-1e4, 2e4]])), M=csr_array(np.eye(2)),
        node=np.array([0, 1]), direction=np.array([direction] * 2), points=None,
    )  # fmt: skip
    assert warnings(said) == []
    assert imported.system.precision < 1e-15
