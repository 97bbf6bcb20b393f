"""The ready parts: each against its own references, and its README against both."""

from itertools import pairwise
from math import pi, sqrt

import numpy as np
import pytest
from ready_parts import MODELS, column, computed, reduction, table

from precompute.arrays import Floats
from precompute.part import read_part

NAMES = ["bracket", "cantilever", "ring", "tuning_fork"]


@pytest.mark.parametrize("name", [*NAMES, "flexure"])
def test_readme_says_what_is_computed(name: str) -> None:
    frequency = computed(name)
    # printed with four decimals; other versions of LAPACK and Lanczos move the ninth digit
    np.testing.assert_allclose(column(name, "f / Hz"), frequency, rtol=1e-7, atol=5.1e-5)
    # the difference as printed: two decimals of a per cent, or two digits of a part in one
    for row, f, reference in zip(
        table(name), column(name, "f / Hz"), column(name, "reference / Hz"), strict=True
    ):
        text = row["difference"]
        printed = float(text.removesuffix("%")) / (100 if text.endswith("%") else 1)
        assert printed == pytest.approx(f / reference - 1, abs=5.1e-5 if text.endswith("%") else 1e-6)


@pytest.mark.parametrize("name", ["bracket", "tuning_fork"])
def test_agrees_with_calculix_on_the_same_mesh(name: str) -> None:
    """Two codes, one discretisation: what is left is the number of points in the mass and ccx's digits."""
    reference = column(name, "reference / Hz")
    difference = np.abs(computed(name) / reference - 1)
    assert difference.max() < 5e-5
    assert difference[:4].max() < 1e-6  # long waves do not see the mass's quadrature
    assert (np.diff(reference) / reference[:-1]).min() > 1e-3  # so none is taken for its neighbour


@pytest.mark.parametrize(
    ("name", "script"),
    [
        *((name, "make_mesh.py") for name in (*NAMES, "mast", "arm", "chain", "servo", "stop")),
        ("flexure", "make_matrices.py"),
    ],
)
def test_files_are_small_and_complete(name: str, script: str) -> None:
    folder = MODELS / name
    assert {"README.md", script, "part.toml"} <= {path.name for path in folder.iterdir()}
    assert read_part(folder).mesh is not None
    assert max(path.stat().st_size for path in folder.iterdir() if path.is_file()) < 3_000_000


def test_total_masses() -> None:
    """ρV of the exact geometry; curved hexahedra of 20 nodes miss a circle by far less than 1e-6."""
    assert reduction("cantilever").total_mass == pytest.approx(7850 * 1.0 * 0.03 * 0.02, rel=1e-12)
    assert reduction("ring").total_mass == pytest.approx(7850 * 2 * pi * 0.2 * 0.005**2, rel=1e-6)


def thin_ring(n: int, in_plane: bool) -> float:
    """ω² = n²(n²−1)²/(n² + k) EI/(ρAR⁴), k = 1 in plane, EI/GJ out of plane; in Hz (Love § 293)."""
    E, G, rho, R, a = 210e9, 210e9 / 2.6, 7850.0, 0.2, 0.005
    EI, GJ = E * a**4 / 12, G * 0.140577 * a**4  # J of a square: Timoshenko & Goodier § 109
    k = 1.0 if in_plane else EI / GJ
    return n * (n * n - 1) / sqrt(n * n + k) * sqrt(EI / (rho * a**2)) / R**2 / (2 * pi)


def test_ring_against_thin_rings() -> None:
    expected = np.repeat([thin_ring(n, plane) for n in range(2, 6) for plane in (False, True)], 2)
    np.testing.assert_allclose(column("ring", "reference / Hz"), expected, atol=5.1e-5)
    # shear and rotary inertia −(na/R)²/6, mesh +0.2 %
    np.testing.assert_allclose(computed("ring"), expected, rtol=2.5e-3)
    # a ring without twist (k = n² − 1 would be another classic mistake) is far outside
    assert abs(thin_ring(2, True) / thin_ring(2, False) - 1) > 2e-2


def test_ring_is_free_and_its_modes_come_in_pairs() -> None:
    """Six modes at exactly 0, then equal pairs (Lanczos resolves λ to 1e-8), well apart from one another."""
    found = reduction("ring")
    assert found.modes.rigid == 6
    assert (found.model.lam[:6] == 0).all()
    first, second = found.model.frequency[6:].reshape(-1, 2).T
    np.testing.assert_allclose(first, second, rtol=1e-8)
    assert min(b / a for a, b in pairwise(first)) > 1.01


def prong_ends(name: str) -> tuple[Floats, Floats]:
    """Φ (3, r) at the middle of each prong's outer end: upper and lower."""
    found = reduction(name)
    points = found.full.nodes.points
    ends = [np.argmin(np.linalg.norm(points - [0.08642, y, 0.0], axis=1)) for y in (0.0075, -0.0075)]
    upper, lower = found.modes.Phi.reshape(-1, 3, len(found.model.lam))[ends]
    return upper, lower


def test_tuning_fork_sounds_a() -> None:
    """440 Hz in the mode whose prongs move against each other; the stem feels nothing of it."""
    found = reduction("tuning_fork")
    upper, lower = prong_ends("tuning_fork")
    in_plane = np.abs(upper[1]) > 10 * np.abs(upper[2])
    against = in_plane & (upper[1] * lower[1] < 0)
    tone = int(np.flatnonzero(against)[0])
    assert found.model.frequency[tone] == pytest.approx(440.0, abs=0.1)
    outputs = dict(zip(found.model.outputs, np.abs(found.model.C), strict=True))
    stem = outputs["stem.displacement.y"] / outputs["prong.displacement.y"]
    together = int(np.flatnonzero(in_plane & (upper[1] * lower[1] > 0))[0])
    assert stem[tone] < 0.01
    assert stem[together] > 0.05  # while the mode in phase shakes it
    assert "the tone" in table("tuning_fork")[tone]["shape"]


def test_bracket_has_the_size_it_is_meant_to_have() -> None:
    found = reduction("bracket")
    assert 27_000 < found.dofs < 33_000
    assert set(found.full.nodes.node_sets) == {"bolts", "bearing", "load_face"}
    assert set(found.full.nodes.cell_sets) == {"body"}
    assert np.ptp(found.full.nodes.points, axis=0) == pytest.approx([0.1, 0.06, 0.09])  # mm were read
