"""What is legal and probably not meant: when a line about it appears, and when not."""

import logging
from pathlib import Path

import numpy as np
import pytest
from small_part import LENGTH, write_part

from precompute.dofs import Dofs, mesh_dofs
from precompute.doubts import doubt_held_ports, doubt_point_stress, doubt_ratios
from precompute.mesh import Mesh
from precompute.notice import LOGGER_NAME
from precompute.part import Part, read_part
from precompute.ports import PortNodes, port_nodes
from precompute.read_mesh import read_mesh

OUTPUTS = 'outputs = ["displacement.x", "displacement.z", "velocity.z"]'


@pytest.fixture
def said(caplog: pytest.LogCaptureFixture) -> pytest.LogCaptureFixture:
    caplog.set_level(logging.INFO, logger=LOGGER_NAME)
    return caplog


def bar(folder: Path, *changes: tuple[str, str]) -> tuple[Part, Mesh]:
    part = read_part(write_part(folder, *changes))
    return part, read_mesh(folder / "bar.vtu", "m")


def tip(mesh: Mesh) -> PortNodes:
    return port_nodes(mesh, np.flatnonzero(mesh.points[:, 0] == LENGTH), "area", "tip")


@pytest.mark.parametrize(
    ("form", "words"),
    [
        ("ratio = 2.0", "part.toml: damping.ratio: 2 is 200 %; is it in percent? 2 % is 0.02"),
        ("ratio = 1.0", "damping.ratio: 1 is 100 %"),
        ("ratios = [[10.0, 0.02], [50.0, 3.0]]", "damping.ratios: 3 is 300 %"),
        ("table = [[1, 2.0], [2, 1.5]]", "damping.table: 2 is 200 %"),
        ("structural = 4.0", "damping.structural: 4 is 400 %"),
    ],
)
def test_ratios_in_percent(tmp_path: Path, said: pytest.LogCaptureFixture, form: str, words: str) -> None:
    doubt_ratios(bar(tmp_path, ("ratio = 0.02", form))[0])
    (record,) = said.records
    assert record.levelno == logging.WARNING
    assert words in record.message


@pytest.mark.parametrize(
    "form",
    [
        "ratio = 0.99",
        "ratio = 0.0",
        "ratios = [[10.0, 0.02], [50.0, 0.3]]",
        "table = [[1, 0.2]]",
        "alpha = 30.0",
    ],
)
def test_ratios_below_1_are_not_doubted(tmp_path: Path, said: pytest.LogCaptureFixture, form: str) -> None:
    doubt_ratios(bar(tmp_path, ("ratio = 0.02", form))[0])
    assert not said.records


def test_held_ports_are_named_in_each_direction_that_they_move_in(
    tmp_path: Path, said: pytest.LogCaptureFixture
) -> None:
    part, mesh = bar(tmp_path)
    where = tip(mesh)
    dofs = mesh_dofs(len(mesh.points))
    fixed = np.sort(np.concatenate([3 * where.nodes, 3 * where.nodes + 1]))  # x and y; the port has x and z
    doubt_held_ports(part, [where], fixed, dofs)
    (record,) = said.records
    assert record.levelno == logging.WARNING
    assert record.message == "port tip: a support holds all of its nodes in x; nothing will move there"
    said.clear()
    doubt_held_ports(part, [where], fixed[2:], dofs)  # one node is free
    assert not said.records


def test_held_ports_may_show_stress_and_rotation(tmp_path: Path, said: pytest.LogCaptureFixture) -> None:
    changes = (
        ('inputs = ["force.x", "force.z"]', 'inputs = ["pressure"]'),
        (OUTPUTS, 'outputs = ["stress.xx", "stress.mises", "rotation.z"]'),
    )
    part, mesh = bar(tmp_path, *changes)
    where = tip(mesh)
    doubt_held_ports(part, [where], np.arange(3 * len(mesh.points)), mesh_dofs(len(mesh.points)))
    assert not said.records


def test_held_ports_are_found_by_the_table_of_degrees_of_freedom(
    tmp_path: Path, said: pytest.LogCaptureFixture
) -> None:
    """Rows in another order: y, x, z of each node."""
    part, mesh = bar(tmp_path)
    where = tip(mesh)
    n = len(mesh.points)
    dofs = Dofs(np.repeat(np.arange(n), 3), np.tile(np.array([1, 0, 2]), n))
    doubt_held_ports(part, [where], 3 * where.nodes, dofs)  # y: no variable of the port
    assert not said.records
    doubt_held_ports(part, [where], 3 * where.nodes + 1, dofs)
    assert "in x" in said.text


def test_stress_under_a_point_force(tmp_path: Path, said: pytest.LogCaptureFixture) -> None:
    part, mesh = bar(tmp_path, (OUTPUTS, 'outputs = ["stress.mises"]'))
    doubt_point_stress(part, [tip(mesh)])
    assert not said.records  # four nodes
    point = port_nodes(mesh, np.array([0]), "equal", "tip")
    doubt_point_stress(part, [point])
    assert "port tip: stress at the one node that takes the force grows without bound" in said.text


def test_stress_without_a_force_there_is_not_doubted(tmp_path: Path, said: pytest.LogCaptureFixture) -> None:
    changes = (('inputs = ["force.x", "force.z"]\n', ""), (OUTPUTS, 'outputs = ["stress.mises"]'))
    part, mesh = bar(tmp_path, *changes)
    doubt_point_stress(part, [port_nodes(mesh, np.array([0]), "equal", "tip")])
    assert not said.records
