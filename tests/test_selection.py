"""Where supports and ports are: each rule on a row of five cubes of 10 mm, whose file is in mm."""

import logging

import numpy as np
import pytest

from precompute.errors import SelectionError
from precompute.mesh import Mesh
from precompute.node_table import NodeTable
from precompute.selection import Box, NamedSet, Nodes, Plane, Point, select_cells, select_nodes

MM = 1e-3
CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))


@pytest.fixture
def bar():
    """x 0 … 50 mm, y and z 0 … 10 mm; node ids 101, 103, … from x to y to z."""
    x, y, z = np.meshgrid(np.arange(6), np.arange(2), np.arange(2), indexing="ij")
    points = np.stack([x, y, z], axis=-1).reshape(-1, 3) * 10 * MM
    cells = np.array([[4 * (i + a) + 2 * b + c for a, b, c in CORNERS] for i in range(5)])
    return Mesh(
        points=points,
        cells={"hex8": cells[:4], "hex8r": cells[4:]},
        node_ids=101 + 2 * np.arange(24),
        node_sets={
            "CLAMP": np.arange(4),
            "tip": np.array([23]),
            "lost": np.zeros(0, np.int64),
            "both": np.arange(2),
        },
        cell_sets={
            "left": {"hex8": np.array([0])},
            "end": {"hex8r": np.array([0])},
            "both": {"hex8": np.array([1])},
        },
    )


def chosen(bar, at):
    return bar.points[select_nodes(bar, at, MM)] / MM


def test_node_set(bar):
    assert select_nodes(bar, "tip", MM).tolist() == [23]
    assert select_nodes(bar, NamedSet("CLAMP"), MM).tolist() == [0, 1, 2, 3]


def test_name_in_other_capitals(bar):
    assert select_nodes(bar, "clamp", MM).tolist() == [0, 1, 2, 3]  # decks know no case


def test_name_in_other_capitals_must_be_one(bar):
    twins = Mesh(bar.points, bar.cells, bar.node_ids, {"Tip": np.array([0]), "TIP": np.array([1])}, {})
    assert select_nodes(twins, "TIP", MM).tolist() == [1]
    with pytest.raises(SelectionError, match="no set is named 'tip'; did you mean 'TIP'"):
        select_nodes(twins, "tip", MM)


def test_cell_set_gives_its_nodes(bar):
    assert sorted(set(chosen(bar, "left")[:, 0])) == [0, 10]
    assert sorted(set(chosen(bar, "end")[:, 0])) == pytest.approx([40, 50])
    assert len(select_nodes(bar, "end", MM)) == 8


def test_node_set_goes_before_cell_set(bar):
    assert select_nodes(bar, "both", MM).tolist() == [0, 1]


def test_unknown_name(bar):
    with pytest.raises(SelectionError) as caught:
        select_nodes(bar, "clam", MM)
    assert str(caught.value) == (
        "no set is named 'clam'; did you mean 'CLAMP'? "
        "the mesh has the sets 'CLAMP', 'both', 'end', 'left', 'lost', 'tip'"
    )
    with pytest.raises(SelectionError, match="no set is named 'wing'; the mesh has the sets 'CLAMP'"):
        select_nodes(bar, "wing", MM)


def test_set_without_nodes(bar):
    with pytest.raises(SelectionError, match="set 'lost' has no node in a solid cell; the mesh has the sets"):
        select_nodes(bar, "lost", MM)


def test_mesh_without_sets(bar):
    plain = Mesh(bar.points, bar.cells, bar.node_ids, {}, {})
    with pytest.raises(
        SelectionError, match="the mesh has no set: name groups where it is made, or select by"
    ):
        select_nodes(plain, "clamp", MM)


def test_long_lists_are_shortened(bar):
    many = Mesh(bar.points, bar.cells, bar.node_ids, {f"s{i:02}": np.array([i]) for i in range(24)}, {})
    with pytest.raises(SelectionError, match=r"'s00', .*'s19' … \(24 in all\)$"):
        select_nodes(many, "other", MM)


def test_point_is_the_nearest_node(bar, caplog):
    caplog.set_level(logging.INFO, "modalfmu")
    assert chosen(bar, Point((30.1, 9.9, 0.1))) == pytest.approx(np.array([[30, 10, 0]]))
    assert caplog.messages == []


def test_first_of_equally_near_nodes(bar):
    assert select_nodes(bar, Point((0.0, 5.0, 5.0)), MM).tolist() == [0]


def test_point_far_from_all_nodes(bar, caplog):
    """1 % of the diagonal √(50² + 10² + 10²) mm = 52.0 mm is 0.52 mm."""
    select_nodes(bar, Point((50.5, 10.0, 10.0)), MM)
    assert caplog.messages == []
    assert select_nodes(bar, Point((50.55, 10.0, 10.0)), MM).tolist() == [23]
    assert caplog.messages == [
        "point [50.55, 10, 10]: the nearest node, 147 at [50, 10, 10], is 0.55 away, "
        "1% of the mesh's diagonal; is the point in its length unit?"
    ]


def test_box(bar):
    assert chosen(bar, Box((5.0, -1.0, -1.0), (25.0, 1.0, 11.0))) == pytest.approx(
        np.array([[10, 0, 0], [10, 0, 10], [20, 0, 0], [20, 0, 10]])
    )


def test_box_without_thickness(bar):
    assert len(chosen(bar, Box((50.0, 0.0, 0.0), (50.0, 10.0, 10.0)))) == 4
    assert chosen(bar, Box((20.0, 10.0, 0.0), (20.0, 10.0, 0.0))) == pytest.approx(np.array([[20, 10, 0]]))


@pytest.mark.parametrize("share", [0.9, 1.1])
def test_tolerance(bar, share):
    """1e-6 of the diagonal, inside at 0.9 of it, outside at 1.1."""
    step = share * 1e-6 * bar.diagonal / MM
    selections = [
        Plane("x", 50 + step),
        Box((50 + step, 0, 0), (60, 10, 10)),
        Box((-9, -9, -9), (-step, 9, 9)),
    ]
    for at in selections:
        if share < 1:
            assert len(select_nodes(bar, at, MM)) > 0
        else:
            with pytest.raises(SelectionError):
                select_nodes(bar, at, MM)


@pytest.mark.parametrize(
    ("normal", "axis", "at", "count"), [("x", 0, 30, 4), ("y", 1, 10, 12), ("z", 2, 0, 12)]
)
def test_plane(bar, normal, axis, at, count):
    found = chosen(bar, Plane(normal, at))
    assert len(found) == count
    assert found[:, axis] == pytest.approx(at, abs=1e-12)


def test_nothing_in_box_or_plane(bar):
    with pytest.raises(SelectionError) as caught:
        select_nodes(bar, Plane("x", 25), MM)
    assert str(caught.value) == (
        "plane x = 25 holds no node; the mesh reaches from [0, 0, 0] to [50, 10, 10] in its length unit; "
        "the mesh has the sets 'CLAMP', 'both', 'end', 'left', 'lost', 'tip'"
    )
    with pytest.raises(
        SelectionError, match=r"^box \[1, 1, 1\] to \[9, 9, 9\] holds no node; the mesh reaches"
    ):
        select_nodes(bar, Box((1, 1, 1), (9, 9, 9)), MM)


def test_scale_is_that_of_the_file(bar):
    assert select_nodes(bar, Plane("x", 0.05), 1.0).tolist() == select_nodes(bar, Plane("x", 50), MM).tolist()
    with pytest.raises(SelectionError):
        select_nodes(bar, Plane("x", 50), 1.0)


def test_node_numbers(bar):
    assert select_nodes(bar, Nodes((147, 101, 103, 101)), MM).tolist() == [0, 1, 23]


def test_node_numbers_that_do_not_exist(bar):
    with pytest.raises(SelectionError) as caught:
        select_nodes(bar, Nodes((101, 102, 0)), MM)
    assert str(caught.value).startswith(
        "got nodes 0, 102, in no solid cell of the mesh; its numbers lie between 101 and 147; "
        "the mesh has the sets"
    )
    with pytest.raises(SelectionError):
        select_nodes(bar, Nodes(()), MM)


@pytest.mark.parametrize(
    "at", ["CLAMP", "end", Plane("y", 0), Box((0, 0, 0), (50, 10, 0)), Nodes((111, 105)), Point((0, 0, 0))]
)
def test_rows_are_sorted_and_unique(bar, at):
    rows = select_nodes(bar, at, MM)
    assert rows.dtype == np.int64
    assert (np.diff(rows) > 0).all()


def test_cells(bar):
    assert select_cells(bar, "left") == {"hex8": [0]}
    assert select_cells(bar, "END") == {"hex8r": [0]}
    assert select_cells(bar, "both") == {"hex8": [1]}


def test_cells_of_no_set(bar):
    with pytest.raises(SelectionError, match=r"^no cell set is named 'lef'; did you mean 'left'"):
        select_cells(bar, "lef")
    with pytest.raises(
        SelectionError, match=r"^set 'tip' has nodes but no solid cells; the mesh has the cell sets"
    ):
        select_cells(bar, "tip")


class TestImportedNodes:
    """A table of nodes in place of a mesh."""

    @pytest.fixture
    def table(self, bar):
        return NodeTable(bar.points, bar.node_ids)

    def test_places_and_numbers(self, bar, table):
        for at in (Plane("x", 50), Box((0, 0, 0), (10, 0, 10)), Point((30, 10, 0)), Nodes((101, 147))):
            assert select_nodes(table, at, MM).tolist() == select_nodes(bar, at, MM).tolist()

    def test_sets_come_with_a_mesh_only(self, bar, table):
        with pytest.raises(SelectionError) as caught:
            select_nodes(table, "clamp", MM)
        assert str(caught.value) == (
            "no set is named 'clamp'; matrices bring no sets; select by nodes = [numbers], or give their mesh"
        )
        both = NodeTable(bar.points, bar.node_ids, bar.cells, bar.node_sets, bar.cell_sets)
        assert select_nodes(both, "clamp", MM).tolist() == [0, 1, 2, 3]
        assert len(select_nodes(both, "end", MM)) == 8

    def test_numbers_that_do_not_exist(self, table):
        with pytest.raises(
            SelectionError, match="got nodes 7, not in the matrices; their numbers lie between 101"
        ):
            select_nodes(table, Nodes((7, 101)), MM)

    @pytest.mark.parametrize("at", [Plane("x", 50), Box((0, 0, 0), (9, 9, 9)), Point((0, 0, 0))])
    def test_no_coordinates(self, bar, at):
        table = NodeTable(np.full((24, 3), np.nan), bar.node_ids)
        assert select_nodes(table, Nodes((103,)), MM).tolist() == [1]
        with pytest.raises(
            SelectionError, match=r"got matrices without coordinates, .* nodes = \[numbers\], or"
        ):
            select_nodes(table, at, MM)

    def test_nodes_of_unknown_place_are_passed_over(self, bar):
        points = bar.points.copy()
        points[0] = np.nan
        table = NodeTable(points, bar.node_ids)
        assert select_nodes(table, Point((0, 0, 0)), MM).tolist() == [1]
        assert select_nodes(table, Plane("x", 0), MM).tolist() == [1, 2, 3]
