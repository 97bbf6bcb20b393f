"""From part file to reduced model: ports, weights, order of rows, supports, and what is doubted."""

import logging
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from boxes import box, mapped
from interfaces import interface_at
from small_part import write_mesh, write_part

from fmu_src.runtime.model import Port
from precompute.damping import Damping
from precompute.errors import EigenError, ModelError
from precompute.notice import LOGGER_NAME
from precompute.part import read_part
from precompute.pipeline import Reduction, reduce_part
from precompute.ports import port_nodes
from precompute.reduction import reduce
from precompute.shape import Shape, deformed_points, read_shape, surface_shape, write_shape


def reduced(folder: Path, *changes: tuple[str, str]) -> Reduction:
    return reduce_part(read_part(write_part(folder, *changes)))


def test_power_at_a_port_is_power_in_the_modes() -> None:
    """Fᵀu̇ = fᵀq̇: columns of B and rows of C of one port and direction are the same numbers."""
    rng = np.random.default_rng(0)
    mesh, nodes = box("tet4", (1, 1, 1)), np.array([0, 2, 3])
    Phi = rng.standard_normal((3 * len(mesh.points), 5))
    where = replace(port_nodes(mesh, nodes, "equal", "p"), weights=np.array([0.5, 0.75, -0.25]))
    by_hand = 0.5 * Phi[0:3] + 0.75 * Phi[6:9] - 0.25 * Phi[9:12]
    port = Port("p", ("force.z", "force.x"), ("velocity.z", "displacement.x", "acceleration.y"))
    lam = np.arange(1.0, 6.0)
    damping = Damping(0.0, 0.0, np.zeros((5, 5)))
    model = reduce("part", "", lam, Phi, damping, interface_at(mesh, [(port, where)]))
    np.testing.assert_allclose(model.B.T, by_hand[[2, 0]], rtol=1e-15)
    np.testing.assert_allclose(model.C, by_hand[[2, 0, 1]], rtol=1e-15)


def test_static_gain_is_that_of_the_full_model(tmp_path: Path) -> None:
    """C Λ⁻¹ B with all modes = bᵀ K⁻¹ b: the bar stretches by FL/EA with ν = 0."""
    model = reduced(tmp_path, ("count = 8", "count = 72")).model
    gain = model.C[0] @ (model.B[:, 0] / model.lam)
    assert gain == pytest.approx(1.0 / (210e9 * 0.01), rel=1e-10)  # conditioning of K times rounding


def test_equal_weights_are_not_area_weights(tmp_path: Path) -> None:
    """On a face whose columns of nodes lie at unequal distances."""
    stretched = mapped(box("hex8", (1, 2, 1)), lambda p: np.column_stack([p[:, 0], p[:, 1] ** 2, p[:, 2]]))
    nodes = np.flatnonzero(stretched.points[:, 0] == 1.0)
    area = port_nodes(stretched, nodes, "area", "p").weights
    equal = port_nodes(stretched, nodes, "equal", "p").weights
    np.testing.assert_allclose(equal, np.full(6, 1 / 6), rtol=1e-15)
    y = stretched.points[nodes, 1]
    np.testing.assert_allclose(area @ y, 0.5, rtol=1e-14)  # the centre of the face
    assert abs(equal @ y - 0.5) > 0.05
    unweighted = reduced(
        tmp_path, ('outputs = ["displacement.x"', 'weights = "equal"\noutputs = ["displacement.x"')
    )
    assert unweighted.part.ports[0].weights == "equal"


def test_nodes_without_a_whole_face_weigh_the_same_and_say_so(caplog: pytest.LogCaptureFixture) -> None:
    mesh = box("hex8", (1, 1, 1))
    with caplog.at_level(logging.INFO, LOGGER_NAME):
        weights = port_nodes(mesh, np.array([0, 1, 2]), "area", "edge").weights
        assert "port edge: its 3 nodes cover no whole exterior face" in caplog.text
        caplog.clear()
        port_nodes(mesh, np.array([0]), "area", "corner")
        assert not caplog.text
    assert weights.tolist() == [1 / 3] * 3


def test_a_node_held_twice_is_held_once(tmp_path: Path) -> None:
    support = '[[support]]\nat = { plane = { normal = "x", at = 0.0 } }\nfix = ["x", "y", "z"]\n'
    twice = reduced(tmp_path, (support, support + support))
    assert twice.dofs == 72
    assert reduced(tmp_path).dofs == 72


def test_max_frequency_keeps_what_lies_below(tmp_path: Path) -> None:
    f = reduced(tmp_path).model.frequency
    for limit, expected in ((f[4] * 0.9995, 4), (f[4] * 1.0005, 5)):
        kept = reduced(tmp_path, ("count = 8", f"max_frequency = {float(limit)!r}"))
        assert len(kept.model.lam) == expected


def test_mistakes_of_the_whole_part_name_its_file(tmp_path: Path) -> None:
    with pytest.raises(EigenError, match=r"^part\.toml: count: got 73"):
        reduced(tmp_path, ("count = 8", "count = 73"))
    free = ('[[support]]\nat = { plane = { normal = "x", at = 0.0 } }\nfix = ["x", "y", "z"]\n', "")
    with pytest.raises(ModelError, match=r"^part\.toml: initial"):
        reduced(tmp_path, free, ("count = 8", 'count = 8\ninitial = "static"'))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            ("young = 210000000000.0", "young = 210000.0"),
            "material[1].young: 210000 Pa is softer than rubber",
        ),
        (("density = 7850.0", "density = 7.85e-9"), "material[1].density: no solid has 7.85e-09 kg/m³"),
        (
            ('at = { plane = { normal = "x", at = 1.0 } }', 'at = { plane = { normal = "x", at = 0.0 } }'),
            "port tip: a support holds all of its nodes in x",
        ),
    ],
)
def test_what_is_probably_not_meant_is_said(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, change: tuple[str, str], message: str
) -> None:
    with caplog.at_level(logging.INFO, LOGGER_NAME):
        reduced(tmp_path)
        assert message not in caplog.text
        assert "6 hex8: linear cells bend too stiffly" in caplog.text
        reduced(tmp_path, change)
    assert message in caplog.text


def test_a_great_many_modes_are_said_beforehand(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    fine = box("hex8", (10, 6, 6), (1.0, 0.1, 0.1))
    part = write_part(tmp_path, ("count = 8", "max_frequency = 2e5"))
    write_mesh(tmp_path, fine.points, fine.cells["hex8"])
    with caplog.at_level(logging.INFO, LOGGER_NAME):
        many = reduce_part(read_part(part))
    assert len(many.model.lam) > 300
    assert "modes lie below 200000 Hz" in caplog.text


def test_shape_survives_the_archive_and_deforms(tmp_path: Path) -> None:
    mesh = box("hex20", (2, 1, 1))
    Phi = np.random.default_rng(1).standard_normal((3 * len(mesh.points), 4))
    shape = surface_shape(mesh, Phi.reshape(-1, 3, 4))
    path = tmp_path / "part.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in write_shape(shape).items():
            archive.writestr(name, content)
    back = read_shape(path)
    q = np.array([1.0, -2.0, 0.5, 0.0])
    u = (Phi @ q).reshape(-1, 3)
    place = [int(np.argmin(np.linalg.norm(mesh.points - p, axis=1))) for p in back.points]
    moved = deformed_points(back, q, scale=3.0)
    np.testing.assert_allclose(moved, mesh.points[place] + 3 * u[place], atol=1e-5)  # float32
    faces = {"quad8": shape.faces["quad8"] + 1}
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in write_shape(Shape(shape.points, faces, shape.Phi)).items():
            archive.writestr(name, content)
    with pytest.raises(ModelError, match="do not fit"):
        read_shape(path)
