"""What cannot be integrated is refused in one line that says which cells and how to mend them."""

from dataclasses import replace

import numpy as np
import pytest
from boxes import box, joined, mapped, mesh_of, steel

from precompute.assembly import assemble
from precompute.errors import MeshError, ModalFmuError
from precompute.material import CellMaterial
from precompute.mesh import FAMILIES, Mesh


def message(mesh: Mesh, materials: list[CellMaterial]) -> str:
    with pytest.raises(MeshError) as caught:
        assemble(mesh, materials)
    text = str(caught.value)
    assert "\n" not in text
    return text


def with_sets(mesh: Mesh) -> Mesh:
    return replace(mesh, cell_sets={"rim": {"hex8": np.array([0, 1])}, "core": {"hex8": np.array([2, 3])}})


@pytest.mark.parametrize("family", FAMILIES)
def test_a_mirrored_mesh_is_inverted(family: str) -> None:
    mesh = mapped(box(family, (1, 1, 1)), lambda p: p * [1.0, 1.0, -1.0])
    count = len(mesh.cells[family])
    text = message(mesh, steel(mesh))
    assert text.startswith(f"inverted or flat cells (det J ≤ 0 at an integration point): {count}, first ")
    assert f"{family} cell 1 near (" in text
    assert "reorder the nodes" in text


def test_only_the_inverted_cells_are_named_with_their_place() -> None:
    mesh = box("hex8", (3, 1, 1), (3.0, 1.0, 1.0))
    cells = mesh.cells["hex8"].copy()
    cells[1] = cells[1][[4, 5, 6, 7, 0, 1, 2, 3]]
    text = message(mesh_of(mesh.points, {"hex8": cells}), steel(mesh))
    assert "point): 1, first " in text
    assert "hex8 cell 2 near (1.5, 0.5, 0.5) m; " in text


def test_a_flat_cell_is_refused_though_rounding_gives_it_a_volume() -> None:
    points = np.array([[0.1, 0.2, 0.3], [1.1, 0.5, 0.7], [0.4, 1.3, 0.9]])
    flat = np.concatenate([points, [points.mean(axis=0)]])
    mesh = mesh_of(flat, {"tet4": np.array([[0, 1, 2, 3]])})
    assert "inverted or flat cells" in message(mesh, steel(mesh))
    # thin, but a volume: 1e-6 of an edge is far from flat
    thin = flat + np.array([[0.0], [0.0], [0.0], [1e-6]]) * np.cross(
        points[1] - points[0], points[2] - points[0]
    )
    assert assemble(mesh_of(thin, mesh.cells), steel(mesh)).M.sum() > 0


@pytest.mark.parametrize(
    "order", [[*range(8), *range(12, 20), *range(8, 12)], [*range(12), *range(16, 20), *range(12, 16)]]
)
def test_hex20_in_the_order_of_another_code_is_seen(order: list[int]) -> None:
    """Mid-edge nodes of the upright edges before those of the top, or in front of all."""
    mesh = box("hex20", (1, 1, 1))
    other = mesh_of(mesh.points, {"hex20": mesh.cells["hex20"][:, order]})
    assert "inverted" in message(other, steel(mesh))


def test_a_mid_edge_node_folded_over_its_neighbour() -> None:
    mesh = box("tet10", (1, 1, 1))
    first = mesh.cells["tet10"][0]
    points = mesh.points.copy()
    points[first[4]] = points[first[0]] + 3.0 * (points[first[1]] - points[first[0]])
    assert "mid-edge nodes near the middle" in message(mesh_of(points, mesh.cells), steel(mesh))


def test_cells_without_material_are_counted_and_placed() -> None:
    mesh = with_sets(box("hex8", (4, 1, 1), (4.0, 1.0, 1.0)))
    rim = replace(steel(mesh)[0], cells=mesh.cell_sets["rim"])
    text = message(mesh, [rim])
    assert text.startswith(
        "cells without material: 2, first hex8 cell 3 near (2.5, 0.5, 0.5) m, hex8 cell 4 near"
    )
    assert "in the cell sets 'core'" in text


def test_a_whole_family_without_material() -> None:
    mesh = joined(
        box("hex8", (1, 1, 1)), mapped(box("wedge6", (1, 1, 1)), lambda p: p + np.array([1.0, 0.0, 0.0]))
    )
    hexahedra = replace(steel(mesh)[0], cells={"hex8": np.array([0])})
    assert message(mesh, [hexahedra]).startswith("cells without material: 2, first wedge6 cell 1 near")


def test_cells_in_two_materials_name_both() -> None:
    mesh = with_sets(box("hex8", (4, 1, 1), (4.0, 1.0, 1.0)))
    rim = CellMaterial("brass", 1e11, 0.3, 8500.0, mesh.cell_sets["rim"])
    text = message(mesh, [*steel(mesh), rim])
    assert text.startswith("cells in more than one material ('steel', 'brass'): 2, first hex8 cell 1 near")
    assert "'rim'" in text
    assert "'core'" not in text


@pytest.mark.parametrize("cells", [{}, {"hex8": np.zeros(0, dtype=np.int64)}])
def test_a_material_without_cells_lists_the_sets(cells: dict[str, np.ndarray]) -> None:
    mesh = with_sets(box("hex8", (4, 1, 1)))
    empty = CellMaterial("brass", 1e11, 0.3, 8500.0, cells)
    text = message(mesh, [*steel(mesh), empty])
    assert text.startswith("material 'brass' covers no cell")
    assert "'rim', 'core'" in text


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("young", 0.0),
        ("young", float("nan")),
        ("poisson", 0.5),
        ("poisson", -1.0),
        ("density", -1.0),
        ("density", float("inf")),
    ],
)
def test_material_numbers_out_of_range(key: str, value: float) -> None:
    good = {"young": 210e9, "poisson": 0.3, "density": 7850.0}
    with pytest.raises(ModalFmuError, match=f"material 'steel': got {key} = {value}; expected"):
        CellMaterial("steel", **(good | {key: value}), cells={})


@pytest.mark.parametrize("family", ["hex8", "tet10"])
def test_a_cell_in_the_place_of_another_is_refused(family: str) -> None:
    mesh = box(family, (2, 1, 1))
    cells = mesh.cells[family]
    turned = cells[1, [1, 2, 3, 0, 5, 6, 7, 4]] if family == "hex8" else cells[1]
    twins = mesh_of(mesh.points, {family: np.concatenate([cells, turned[None]])})
    text = message(twins, steel(twins))
    assert text.startswith("cells in the place of another: 1, first ")
    assert f"{family} cell {len(cells) + 1} " in text
    assemble(mesh, steel(mesh))
