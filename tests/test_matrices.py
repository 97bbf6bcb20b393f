"""Imported models: matrices that CalculiX wrote, our own in every layout, frames with rotations."""

import logging
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from boxes import box, steel
from frames import Beam, straight
from matrix_files import LAYOUTS, write_coordinates, write_dofs, write_lines, write_system
from scipy.sparse import csr_array

from precompute.assembly import assemble
from precompute.dofs import Dofs, mesh_dofs
from precompute.eigen import solve_modes
from precompute.errors import MatrixError, ZeroEnergyError
from precompute.material import CellMaterial
from precompute.matrices import Imported, SystemFiles, read_system
from precompute.matrix_units import Units
from precompute.node_table import asking_for_coordinates
from precompute.read_mesh import read_mesh
from precompute.system import rigid_motions

DATA = Path(__file__).parent / "data" / "matrices"
MM = Units("mm", "t", "s")
FREE = np.zeros(0, dtype=np.int64)


@pytest.fixture(autouse=True)
def messages(caplog):
    caplog.set_level(logging.INFO, "modalfmu")


def calculix(name: str) -> SystemFiles:
    """job.sti, .mas and .dof, written by CalculiX 2.20 from job.inp (*FREQUENCY, SOLVER=MATRIXSTORAGE)."""
    return SystemFiles(DATA / f"{name}.sti", DATA / f"{name}.mas", units=MM)


def frequencies(imported: Imported, count: int, fixed=None) -> np.ndarray:
    held = imported.fixed if fixed is None else fixed
    return solve_modes(imported.system, held, count=count, where=imported.where).frequencies


class TestCalculix:
    """Frequencies as CalculiX's own solver printed them for the same decks, to the 7 digits printed."""

    def test_clamped_nodes_are_not_in_its_matrices(self):
        imported = read_system(calculix("beam"))
        assert imported.nodes.node_ids.tolist() == [21, 22, 23, 24, 31, 32, 33, 34]
        assert frequencies(imported, 4) == pytest.approx([8122.582, 8122.582, 20566.29, 34987.33], rel=3e-7)

    def test_with_constraints_and_turned_axes(self):
        """33 x (it follows 34 x) and 31 z (held) are missing; node 32 is in global axes again."""
        imported = read_system(calculix("constrained"), read_mesh(DATA / "constrained.inp", "mm"))
        names = [imported.where(dof).split(" at ")[0] for dof in range(len(imported.dofs.node))]
        assert "node 34 x" in names
        assert "node 33 x" not in names
        assert "node 31 z" not in names
        assert len(names) == 22
        assert frequencies(imported, 4) == pytest.approx([11154.08, 15413.66, 34983.89, 37527.10], rel=6e-7)

    def test_matrices_are_ours(self):
        """C3D8 with eight points in both programs: equal in N/m and kg to the 14 digits that it prints."""
        mesh = read_mesh(DATA / "free.inp", "mm")
        imported = read_system(calculix("free"), mesh)
        ours = assemble(mesh, [CellMaterial("steel", 210e9, 0.3, 7850.0, {"hex8": np.arange(2)})])
        order = 3 * imported.dofs.node + imported.dofs.direction
        for A, B in ((imported.system.K, ours.K), (imported.system.M, ours.M)):
            assert abs(A - B[order][:, order]).max() <= 1e-13 * abs(B).max()
        assert imported.system.M.sum() == pytest.approx(3 * 7850 * 4e-6, rel=1e-12)

    def test_expanded_beams_are_refused(self):
        files = replace(calculix("beam"), dofs=DATA / "beam_elements.dof")
        with pytest.raises(
            MatrixError,
            match=r"^beam_elements.dof: rows 2 and 4 are both node 1 y, expected each motion once",
        ):
            read_system(files)

    def test_mesh_gives_places_and_sets(self, caplog):
        mesh = read_mesh(DATA / "beam.inp", "mm")
        imported = read_system(calculix("beam"), mesh)
        assert np.array_equal(imported.nodes.points, mesh.points)
        assert set(imported.nodes.node_sets) == set(mesh.node_sets)
        assert imported.where(0) == "node 21 x at (0.02, 0, 0) m"
        assert "K holds x y z rx ry rz: supports or springs to ground are already in it" in caplog.messages

    def test_precision_is_that_of_the_digits(self):
        assert read_system(calculix("free")).system.precision == pytest.approx(0.5e-13, rel=0.01)


@pytest.fixture(scope="module")
def block():
    """A free steel box of 2 × 1 × 1 hexahedra and a node numbering with gaps."""
    mesh = box("hex8", (2, 1, 1), (0.2, 0.1, 0.1))
    return replace(mesh, node_ids=7 + 10 * np.arange(12)), assemble(mesh, steel(mesh))


def rows_of(mesh, order) -> tuple[np.ndarray, np.ndarray]:
    """Node numbers and directions of the rows 3·node + direction in another order."""
    node, direction = np.divmod(order, 3)
    return mesh.node_ids[node], direction


class TestLayouts:
    @pytest.mark.parametrize("layout", LAYOUTS)
    def test_gives_back_what_was_written(self, tmp_path, block, layout):
        """Rows in any order; exact where 17 digits are written, else to the digits."""
        mesh, system = block
        order = np.random.default_rng(3).permutation(36)
        node, direction = rows_of(mesh, order)
        K, M = system.K[order][:, order], system.M[order][:, order]
        imported = read_system(write_system(tmp_path, layout, K, M, node, direction), mesh)
        back = 3 * imported.dofs.node + imported.dofs.direction
        digits = {"abaqus input": 16, "abaqus coordinate": 16, "calculix": 14, "ansys": 16}.get(layout)
        allowed = 0.0 if digits is None else 0.5 * 10.0 ** (1 - digits)
        for A, ours in ((imported.system.K, system.K), (imported.system.M, system.M)):
            expected = ours[back][:, back]
            assert np.all(abs(A - expected).toarray() <= allowed * abs(expected).toarray())
            assert abs(A - A.T).nnz == 0
        assert imported.fixed.size == 0
        assert np.allclose(
            imported.system.rigid, rigid_motions(mesh_dofs(len(mesh.points)), mesh.points)[back], atol=1e-16
        )

    @pytest.mark.parametrize(
        "layout", ["market symmetric", "abaqus input", "abaqus coordinate", "ansys", "npz"]
    )
    def test_free_body(self, tmp_path, block, layout):
        mesh, system = block
        node, direction = rows_of(mesh, np.arange(36))
        imported = read_system(write_system(tmp_path, layout, system.K, system.M, node, direction), mesh)
        found = frequencies(imported, 12)
        assert np.all(found[:6] == 0.0)
        assert found == pytest.approx(solve_modes(system, FREE, count=12).frequencies, rel=1e-9)

    def test_order_of_rows_changes_nothing(self, tmp_path, block):
        mesh, system = block
        found = []
        for seed in (1, 2):
            order = np.random.default_rng(seed).permutation(36)
            node, direction = rows_of(mesh, order)
            K, M = system.K[order][:, order], system.M[order][:, order]
            files = write_system(tmp_path / str(seed), "market symmetric", K, M, node, direction)
            found.append(frequencies(read_system(files, mesh), 12))
        assert found[0] == pytest.approx(found[1], rel=1e-9)

    def test_abaqus_coordinates_with_the_mesh_alone(self, tmp_path, block, caplog):
        mesh, system = block
        files = SystemFiles(
            write_coordinates(tmp_path / "job_STIF1.mtx", system.K),
            write_coordinates(tmp_path / "job_MASS1.mtx", system.M),
        )
        imported = read_system(files, mesh)
        assert np.array_equal(imported.dofs.node, np.repeat(np.arange(12), 3))
        assert abs(imported.system.K - system.K).nnz == 0
        assert "matrices without a table of DOFs: taken as x, y, z of each node" in " ".join(caplog.messages)

    def test_ansys_nodal_vector(self, tmp_path, block):
        """*EXPORT of the vector BACK: the node of each three rows."""
        mesh, system = block
        nodes = np.random.default_rng(5).permutation(12)
        order = (3 * nodes[:, None] + np.arange(3)).ravel()
        files = write_system(
            tmp_path, "ansys", system.K[order][:, order], system.M[order][:, order], *rows_of(mesh, order)
        )
        head = ["%%MatrixMarket matrix array integer general ", "% Creator: ANSYS Inc", "12 1"]
        vector = write_lines(tmp_path / "back.mmf", [*head, *map(str, mesh.node_ids[nodes])])
        imported = read_system(replace(files, dofs=vector), mesh)
        assert (3 * imported.dofs.node + imported.dofs.direction).tolist() == order.tolist()

    def test_held_by_abaqus_penalties(self, tmp_path, block, caplog):
        """10³⁶ on the diagonal: the DOFs stay, with their mass, and are fixed."""
        mesh, system = block
        fixed = np.flatnonzero(np.repeat(mesh.points[:, 0] == 0.0, 3))
        K = system.K.tolil()
        for dof in fixed:
            K[dof, dof] = 1e36
        node, direction = rows_of(mesh, np.arange(36))
        files = write_system(tmp_path, "abaqus input", csr_array(K), system.M, node, direction)
        imported = read_system(files, mesh)
        assert imported.fixed.tolist() == fixed.tolist()
        assert imported.system.M.sum() == pytest.approx(system.M.sum(), rel=1e-12)
        assert frequencies(imported, 6) == pytest.approx(
            solve_modes(system, fixed, count=6).frequencies, rel=1e-9
        )
        assert "12 degrees of freedom are held by 1e+36" in " ".join(caplog.messages)

    def test_damping(self, tmp_path, block):
        mesh, system = block
        node, direction = rows_of(mesh, np.arange(36))
        files = write_system(tmp_path, "market symmetric", system.K, system.M, node, direction)
        D = write_coordinates(tmp_path / "D.mtx", 2.0 * system.M + 1e-5 * system.K)
        imported = read_system(replace(files, damping=D, units=MM), mesh)
        assert imported.system.D is not None
        expected = (2.0 * system.M + 1e-5 * system.K) * 1e3  # t/s
        assert abs(imported.system.D - expected).max() <= 1e-15 * abs(expected).max()


STEEL = Beam(E=210e9, G=80e9, rho=7850.0, A=2e-4, Iy=1.6e-9, Iz=6.7e-9, J=4.6e-9)
LENGTH = 0.5
SKEW = np.linalg.qr(np.array([[1.0, 2.0, 0.5], [0.3, -1.0, 2.0], [1.0, 0.2, -0.7]]))[
    0
].T  # axes of no direction


def bending(beta: list[float]) -> list[float]:
    """(βL)² √(EI/ρA L⁴)/2π for both moments of area, ascending."""
    both = [
        np.square(beta) / (2 * np.pi) * np.sqrt(STEEL.E * area / (STEEL.rho * STEEL.A)) / LENGTH**2
        for area in (STEEL.Iy, STEEL.Iz)
    ]
    return sorted(np.concatenate(both))


class TestFrame:
    """Six DOFs per node. Hermitian cells are too stiff by (βh)⁴/1440 of ω: 2.2e-6 for βL = 4.73, 20 cells."""

    def files(self, folder: Path, frame, units: Units, order=None) -> SystemFiles:
        """The frame in other units: rotations carry lengths."""
        order = np.arange(len(frame.node)) if order is None else order
        metres, kilograms, seconds = (
            units.metres,
            {"kg": 1.0, "t": 1e3}[units.mass],
            {"s": 1.0, "ms": 1e-3}[units.time],
        )
        S = np.where(frame.direction < 3, 1.0, 1 / metres)
        K, M = (A.toarray() * np.outer(S, S) / kilograms for A in (frame.K * seconds**2, frame.M))
        K, M = (csr_array(A[np.ix_(order, order)]) for A in (K, M))
        folder.mkdir(exist_ok=True)
        points = frame.points[frame.node[order]] / metres
        return SystemFiles(
            write_coordinates(folder / "K.txt", K),
            write_coordinates(folder / "M.txt", M, "lower"),
            dofs=write_dofs(folder / "dofs.csv", frame.node[order] + 1, frame.direction[order], points),
            units=units,
        )

    @pytest.mark.parametrize("units", [Units(), MM, Units("mm", "kg", "ms"), Units("cm", "kg", "s")])
    def test_cantilever(self, tmp_path, units):
        imported = read_system(self.files(tmp_path, straight(STEEL, LENGTH, 20, SKEW), units))
        fixed = np.flatnonzero(imported.dofs.node == 0)
        found = frequencies(imported, 4, fixed)
        assert found == pytest.approx(bending([1.8751040687, 4.6940911330]), rel=3e-6)

    def test_torsion_and_tension(self, tmp_path):
        """c/4L: linear cells are too stiff by (kh)²/24 = (π/20)²/24 = 1.03e-3 of ω; a stub bends later."""
        stub = 0.02
        imported = read_system(self.files(tmp_path, straight(STEEL, stub, 10, SKEW), MM))
        found = frequencies(imported, 30, np.flatnonzero(imported.dofs.node == 0))
        tension = np.sqrt(STEEL.E / STEEL.rho) / (4 * stub)
        torsion = np.sqrt(STEEL.G * STEEL.J / (STEEL.rho * (STEEL.Iy + STEEL.Iz))) / (4 * stub)
        for f in (tension, torsion):
            assert np.min(abs(found / f / (1 + 1.03e-3) - 1)) < 2e-6

    def test_free_in_any_order(self, tmp_path):
        """Rotational DOFs take part in the rigid motions: exactly six, and the free-free beam."""
        frame = straight(STEEL, LENGTH, 20, SKEW)
        order = np.random.default_rng(0).permutation(126)
        found = frequencies(read_system(self.files(tmp_path, frame, MM, order)), 8)
        assert np.all(found[:6] == 0.0)
        assert found[6:] == pytest.approx(bending([4.7300407449])[:2], rel=3e-6)

    def test_moments_of_inertia(self, tmp_path):
        """RᵀMR about the middle in kg m², with rotations of nodes: m L²/12 across, ρ(I_y + I_z)L along."""
        imported = read_system(self.files(tmp_path, straight(STEEL, LENGTH, 4, SKEW), MM))
        R = imported.system.rigid
        inertia = SKEW @ (R.T @ (imported.system.M @ R))[3:, 3:] @ SKEW.T
        mass = STEEL.rho * STEEL.A * LENGTH
        polar = STEEL.rho * (STEEL.Iy + STEEL.Iz) * LENGTH
        assert inertia == pytest.approx(np.diag([polar, *[mass * LENGTH**2 / 12] * 2]), abs=1e-14)


class TestFewDigits:
    """Rounded entries leave rigid motions some energy, which must not pass for springs or for modes."""

    @pytest.mark.parametrize("digits", [6, 8, 11, 14])
    def test_free_body(self, tmp_path, block, digits):
        """λ is off by no more than 2ε|φ|ᵀ|K||φ|/φᵀKφ, here 40 ε."""
        mesh, system = block
        files = SystemFiles(
            write_coordinates(tmp_path / "K.mtx", system.K, digits=digits),
            write_coordinates(tmp_path / "M.mtx", system.M, digits=digits),
        )
        imported = read_system(files, mesh)
        found = frequencies(imported, 12)
        assert np.all(found[:6] == 0.0)
        exact = solve_modes(system, FREE, count=12).frequencies
        assert found[6:] == pytest.approx(exact[6:], rel=40 * imported.system.precision)

    def test_calculix(self):
        mesh = read_mesh(DATA / "free.inp", "mm")
        found = frequencies(read_system(calculix("free"), mesh), 12)
        ours = assemble(mesh, [CellMaterial("steel", 210e9, 0.3, 7850.0, {"hex8": np.arange(2)})])
        assert np.all(found[:6] == 0.0)
        assert found[6:] == pytest.approx(solve_modes(ours, FREE, count=12).frequencies[6:], rel=1e-11)


class TestWithoutCoordinates:
    def test_free_body_asks_for_them(self, tmp_path, block):
        mesh, system = block
        node, direction = rows_of(mesh, np.arange(36))
        files = write_system(tmp_path, "market symmetric", system.K, system.M, node, direction)
        imported = read_system(files)
        assert not imported.system.rigid[:, 3:].any()
        with (
            pytest.raises(ZeroEnergyError, match=r"3 zero-energy modes .* columns x, y, z of the DOF table"),
            asking_for_coordinates(imported.nodes),
        ):
            frequencies(imported, 8)

    def test_supported_body_needs_none(self, tmp_path, block):
        mesh, system = block
        node, direction = rows_of(mesh, np.arange(36))
        fixed = np.flatnonzero(np.repeat(mesh.points[:, 0] == 0.0, 3))
        imported = read_system(write_system(tmp_path, "npz", system.K, system.M, node, direction))
        assert frequencies(imported, 6, fixed) == pytest.approx(
            solve_modes(system, fixed, count=6).frequencies, rel=1e-10
        )

    def test_other_errors_are_left_alone(self, block):
        nodes = read_system(calculix("beam"), read_mesh(DATA / "beam.inp", "mm")).nodes
        with pytest.raises(ZeroEnergyError, match=r"^a hinge$"), asking_for_coordinates(nodes):
            raise ZeroEnergyError("a hinge")


class TestFilesThatDoNotFit:
    @pytest.fixture
    def files(self, tmp_path, block) -> SystemFiles:
        mesh, system = block
        return write_system(tmp_path, "market symmetric", system.K, system.M, *rows_of(mesh, np.arange(36)))

    def refused(self, files: SystemFiles, words: str, mesh=None) -> None:
        with pytest.raises(MatrixError, match=re.escape(words)) as caught:
            read_system(files, mesh)
        assert "\n" not in str(caught.value)

    def test_no_table(self, files):
        self.refused(replace(files, dofs=None), "K.mtx: got 36 rows, but nothing that tells their nodes")

    def test_mesh_of_another_size(self, files):
        mesh = box("hex8", (1, 1, 1))
        self.refused(replace(files, dofs=None), "K.mtx: got 36 rows and a mesh of 8 nodes, but nothing", mesh)

    def test_short_table(self, files, tmp_path):
        short = write_lines(tmp_path / "short.csv", files.dofs.read_text().splitlines()[:-1])
        self.refused(replace(files, dofs=short), "short.csv: got 35 rows, expected 36, those of the matrices")

    def test_mass_of_another_model(self, files, tmp_path):
        mass = write_coordinates(tmp_path / "other.mtx", csr_array(np.eye(39)))
        self.refused(replace(files, mass=mass), "other.mtx: got 39 rows, expected 36 as in the stiffness")

    def test_labels_that_the_table_lacks(self, tmp_path, block):
        mesh, system = block
        node, direction = rows_of(mesh, np.arange(36))
        files = write_system(tmp_path, "abaqus input", system.K, system.M, node, direction)
        table = write_dofs(tmp_path / "dofs.csv", [8, *node[1:]], direction)
        self.refused(
            replace(files, dofs=table), "K.mtx: got node 7, degree of freedom 1, which the table of DOFs"
        )

    def test_labels_in_another_order_than_the_table(self, tmp_path, block):
        """The table decides the order, and brings coordinates; entries go by their labels."""
        mesh, system = block
        files = write_system(tmp_path, "abaqus input", system.K, system.M, *rows_of(mesh, np.arange(36)))
        order = np.random.default_rng(9).permutation(36)
        table = write_dofs(tmp_path / "xyz.csv", *rows_of(mesh, order), mesh.points[order // 3])
        imported = read_system(replace(files, dofs=table))
        assert abs(imported.system.K - system.K[order][:, order]).max() <= 1e-15 * abs(system.K).max()
        assert imported.nodes.located

    def test_labels_in_one_file_only(self, tmp_path, block):
        mesh, system = block
        files = write_system(tmp_path, "abaqus input", system.K, system.M, *rows_of(mesh, np.arange(36)))
        mass = write_coordinates(tmp_path / "plain.mtx", system.M)
        self.refused(replace(files, mass=mass), "K.mtx: got 36 rows, but nothing that tells their nodes")

    def test_mesh_of_other_nodes(self, files, block):
        mesh = replace(block[0], node_ids=1000 + np.arange(12))
        self.refused(files, "mesh: got nodes 1000 to 1011, none of which is in the matrices (7 to 117)", mesh)

    def test_mesh_in_other_units(self, files, block, tmp_path):
        mesh, _ = block
        node, direction = rows_of(mesh, np.arange(36))
        table = write_dofs(tmp_path / "mm.csv", node, direction, 1e3 * mesh.points[np.arange(36) // 3])
        self.refused(replace(files, dofs=table), "are their units of length right?", mesh)
        read_system(replace(files, dofs=table, units=Units("mm", "kg", "s")), mesh)

    def test_one_node_at_two_places(self, files, block, tmp_path):
        mesh, _ = block
        points = mesh.points[np.arange(36) // 3].copy()
        points[4] += 0.1
        table = write_dofs(tmp_path / "two.csv", *rows_of(mesh, np.arange(36)), points)
        self.refused(replace(files, dofs=table), "dofs: got different coordinates for rows of node 17")

    def test_nodes_beyond_the_mesh_are_kept(self, files, block, caplog):
        mesh, _ = block
        partial = box("hex8", (1, 1, 1), (0.1, 0.1, 0.1))
        inside = np.flatnonzero(mesh.points[:, 0] < 0.15)
        partial = replace(partial, points=mesh.points[inside], node_ids=mesh.node_ids[inside])
        imported = read_system(files, partial)
        assert imported.nodes.node_ids.tolist() == [*mesh.node_ids[inside], *np.delete(mesh.node_ids, inside)]
        assert not imported.nodes.located
        assert "4 nodes of the matrices are not in the mesh" in " ".join(caplog.messages)
        assert isinstance(imported.dofs, Dofs)
