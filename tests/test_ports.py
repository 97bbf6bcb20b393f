"""The nodes of a port: area weights and equal weights, shares, faces."""

import logging

import numpy as np
import pytest
from boxes import box, mapped

from precompute.arrays import Floats
from precompute.mesh import FAMILIES, Mesh
from precompute.notice import LOGGER_NAME
from precompute.ports import PortNodes, port_nodes


def uneven(p: Floats) -> Floats:
    return np.column_stack([p[:, 0], p[:, 1] ** 2, p[:, 2]])


def test_equal_weights_are_not_area_weights() -> None:
    """On a face whose columns of nodes lie at unequal distances."""
    mesh = mapped(box("hex8", (1, 2, 1)), uneven)
    nodes = np.flatnonzero(mesh.points[:, 0] == 1.0)
    area, equal = (port_nodes(mesh, nodes, weights, "p") for weights in ("area", "equal"))
    y = mesh.points[nodes, 1]
    for of_area, of_nodes in ((area.weights, equal.weights), (area.shares, equal.shares)):
        np.testing.assert_allclose(of_nodes, np.full(6, 1 / 6), rtol=1e-15)
        np.testing.assert_allclose(of_area @ y, 0.5, rtol=1e-14)  # the centre of the face
        assert abs(of_nodes @ y - 0.5) > 0.05


@pytest.mark.parametrize("family", FAMILIES)
def test_weights_are_the_area_and_shares_are_not_negative(family: str) -> None:
    mesh = box(family, (2, 2, 2))
    nodes = np.flatnonzero(mesh.points[:, 2] == 1.0)
    port = port_nodes(mesh, nodes, "area", "top")
    for a in (port.weights, port.shares):
        assert a.sum() == pytest.approx(1.0, rel=1e-14)
        np.testing.assert_allclose(a @ mesh.points[nodes], [0.5, 0.5, 1.0], rtol=1e-13)
    assert (port.shares > 0).all()
    # corners of quadratic faces weigh nothing or less
    assert (port.weights.min() < 1e-15) == family.endswith(("10", "20", "20r"))
    assert sum(map(len, port.faces.values())) == (8 if family.startswith("t") or family == "wedge6" else 4)


def test_the_port_knows_its_own_nodes() -> None:
    cube = box("hex8", (1, 1, 1))
    mesh = Mesh(cube.points, cube.cells, np.arange(10, 90, 10), {}, {})
    port = port_nodes(mesh, np.array([6, 2]), "equal", "edge")
    assert port.ids.tolist() == [70, 30]
    np.testing.assert_array_equal(port.points, mesh.points[[6, 2]])


def test_nodes_without_a_whole_face_weigh_the_same_and_say_so(caplog: pytest.LogCaptureFixture) -> None:
    mesh = box("hex8", (1, 1, 1))
    with caplog.at_level(logging.INFO, LOGGER_NAME):
        port = port_nodes(mesh, np.array([0, 1, 2]), "area", "edge")
        assert "port edge: its 3 nodes cover no whole exterior face" in caplog.text
        caplog.clear()
        port_nodes(mesh, np.array([0]), "area", "corner")
        assert not caplog.text
    assert port.weights.tolist() == port.shares.tolist() == [1 / 3] * 3
    assert not port.faces


def test_equal_weights_keep_the_faces_for_a_pressure() -> None:
    mesh = box("hex8", (1, 1, 1))
    port = port_nodes(mesh, np.flatnonzero(mesh.points[:, 0] == 0), "equal", "side")
    assert [len(faces) for faces in port.faces.values()] == [1]


def test_a_port_has_nodes() -> None:
    none = np.zeros(0, dtype=np.int64)
    with pytest.raises(ValueError, match="port p: got 0 nodes"):
        PortNodes("p", none, none, np.zeros((0, 3)), np.zeros(0), np.zeros(0), {})
