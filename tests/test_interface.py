"""All that is exchanged, put together: the order of columns and rows, known fields and known work."""

from pathlib import Path

import numpy as np
import pytest
from boxes import box, mapped, steel
from small_part import write_part
from solids import held
from systems import system_of

from fmu_src.runtime.kinds import ROWS, outputs_of
from fmu_src.runtime.model import Port
from precompute.arrays import Floats, Ints
from precompute.dofs import mesh_dofs
from precompute.errors import ModalFmuError
from precompute.exchange import Exchange, exchange_of
from precompute.interface import Interface, build_interface
from precompute.part import read_part
from precompute.ports import PortNodes, port_nodes
from precompute.statics import static_solver
from precompute.stress import stress_rows
from precompute.support_reactions import Held

STRAIGHT = box("hex20", (3, 1, 1), (3.0, 1.0, 1.0))
MESH = mapped(STRAIGHT, lambda p: p @ np.array([[1, 0, 0.2], [0, 1, 0], [0, 0, 1]]))
DOFS = mesh_dofs(len(MESH.points))
SYSTEM = system_of(MESH)
X = STRAIGHT.points[:, 0]
ROOT = held(X == 0, "xyz")
MOTIONS = ("displacement", "velocity", "acceleration", "rotation", "angular_velocity", "angular_acceleration")


def port(at: float, name: str) -> PortNodes:
    return port_nodes(MESH, np.flatnonzero(at == X), "area", name)


TIP, SIDE = port(3.0, "tip"), port_nodes(MESH, np.flatnonzero(STRAIGHT.points[:, 2] == 1), "area", "side")
SIDE_OUTPUTS = ("stress.yz", "absolute_acceleration.y", "stress.mises", "stress.xx")
EVERYTHING = Exchange(
    [
        (Port("tip", ("moment.y", "force.x"), tuple(f"{kind}.z" for kind in MOTIONS)), TIP),
        (
            Port(
                "side", ("pressure",), ("stress.yz", "absolute_acceleration.y", "stress.mises", "stress.xx")
            ),
            SIDE,
        ),
    ],
    [(Port("gap", (), ("rotation.x", "displacement.x")), ("side", "tip"))],
    [Held(held(X == 0, "xy")), Held(held(X == 0, "z"), "clamp", ("reaction.z",))],
    gravity=("x", "y", "z"),
    base=("y",),
    energy=("strain",),
)


def built(exchange: Exchange = EVERYTHING, fixed: Ints = ROOT) -> Interface:
    with static_solver(SYSTEM, fixed) as solve:
        return build_interface(
            exchange,
            MESH,
            DOFS,
            SYSTEM,
            fixed,
            solve=solve,
            stress=lambda where: stress_rows(MESH, steel(MESH), where.nodes, where.shares),
        )


def test_the_order_of_the_variables() -> None:
    assert [port.name for port in EVERYTHING.variables] == [
        *("tip", "side", "gap", "clamp", "gravity", "base", "energy")
    ]
    assert EVERYTHING.inputs == (
        *("tip.moment.y", "tip.force.x", "side.pressure"),
        *("gravity.x", "gravity.y", "gravity.z", "base.acceleration.y"),
    )
    assert built().ports == EVERYTHING.variables


def test_as_many_rows_as_each_law_has() -> None:
    shared = built()
    laws = [outputs_of(port.name)[key].law for port in shared.ports for key in port.outputs]
    assert shared.c.shape == (sum(ROWS[law] for law in laws), len(DOFS.node))
    assert shared.b.shape == (len(DOFS.node), 7)
    assert shared.direct.shape == (shared.c.shape[0], 7)


def linear(H: Floats) -> Floats:
    return (MESH.points @ H.T).ravel()


def test_rows_measure_known_fields() -> None:
    """u = H x with H of every shape: motions of the faces' centres, Hooke's stress, differences of both."""
    H = 1e-3 * np.random.default_rng(0).standard_normal((3, 3))
    c = built().c @ linear(H)
    tip, side = (where.weights @ where.points for where in (TIP, SIDE))
    strain = (H + H.T) / 2
    young, poisson = 210e9, 0.3
    stress = young / (1 + poisson) * (strain + poisson / (1 - 2 * poisson) * np.trace(H) * np.eye(3))
    six = [stress[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))]
    np.testing.assert_allclose(c[:3], [(H @ tip)[2]] * 3, rtol=1e-11)
    assert c[3] == c[4] == c[5]
    scale = np.abs(stress).max()
    np.testing.assert_allclose(c[6], stress[1, 2], atol=1e-11 * scale)
    assert c[7] == pytest.approx((H @ side)[1], rel=1e-11)
    np.testing.assert_allclose(c[8:14], six, atol=1e-11 * scale)
    np.testing.assert_allclose(c[14], stress[0, 0], atol=1e-11 * scale)
    assert c[16] == pytest.approx((H @ (tip - side))[0], rel=1e-11)


def test_rotations_are_rotations() -> None:
    theta = np.array([0.1, 0.2, 0.3])
    c = built().c @ np.cross(theta, MESH.points).ravel()
    np.testing.assert_allclose(c[3:6], 0.3, rtol=1e-12)
    assert c[15] == pytest.approx(0, abs=1e-14)  # no rotation between two ports of a rigid body


def test_columns_do_the_work_of_their_inputs() -> None:
    """Fᵀu for a rigid u = t + θ × x: moment·θ, force·u, −p ∮ n·u dA, weight · u of the centre of gravity."""
    shared = built()
    t, theta = np.array([0.1, 0.2, 0.3]), np.array([0.4, 0.5, -0.6])
    work = shared.b.T @ (t + np.cross(theta, MESH.points)).ravel()
    at = [
        t + np.cross(theta, x)
        for x in (TIP.weights @ TIP.points, SIDE.weights @ SIDE.points, MESH.bounds.mean(axis=0))
    ]
    assert work[0] == pytest.approx(0.5, rel=1e-12)
    assert work[1] == pytest.approx(at[0][0], rel=1e-12)
    assert work[2] == pytest.approx(-3.0 * at[1] @ [-0.2, 0, 1], rel=1e-12)  # n A of the sheared top
    np.testing.assert_allclose(work[3:6], 7850 * 3.0 * at[2], rtol=1e-11)
    assert work[6] == pytest.approx(-work[4], rel=1e-15)


def test_what_is_known_without_deformation() -> None:
    direct = built().direct
    wanted = np.zeros((17, 7))
    wanted[7, 6] = 1.0  # side.absolute_acceleration.y follows base.acceleration.y
    np.testing.assert_array_equal(direct[:17], wanted)
    # the clamp takes −F_z of every input, and weight and pressure are known
    area, weight = 3.0, 3.0 * 7850
    np.testing.assert_allclose(direct[17], [0, 0, area, 0, 0, -weight, 0], atol=1e-9 * weight)
    assert not direct[18:].any()


def test_neither_inputs_nor_outputs() -> None:
    silent = built(Exchange([(Port("tip", (), ("displacement.x",)), TIP)]))
    assert silent.b.shape == (len(DOFS.node), 0)
    assert silent.direct.shape == (1, 0)
    deaf = built(Exchange([(Port("tip", ("force.x",), ()), TIP)]))
    assert deaf.c.shape == (0, len(DOFS.node))
    assert deaf.direct.shape == (0, 1)


def test_stress_needs_its_rows() -> None:
    with pytest.raises(ModalFmuError, match="got stress at port side"):
        build_interface(Exchange([(Port("side", (), ("stress.xx",)), SIDE)]), MESH, DOFS, SYSTEM, ROOT)


def test_an_interface_has_shapes_that_fit() -> None:
    shared = built(Exchange([(Port("tip", ("force.x",), ("velocity.x",)), TIP)]))
    with pytest.raises(ModalFmuError, match=r"Interface: got b \(\d+, 1\), c \(1, \d+\), direct \(2, 1\)"):
        Interface(shared.ports, shared.b, shared.c, np.zeros((2, 1)))


def test_a_part_file_asks_for_it(tmp_path: Path) -> None:
    tables = """
[[port]]
name = "root"
at = { plane = { normal = "x", at = 0.5 } }
inputs = ["moment.x"]

[[pair]]
name = "gap"
ports = ["root", "tip"]
outputs = ["rotation.x"]

[loads]
gravity = true
base = ["z"]

[energy]
outputs = ["kinetic"]

[modes]
"""
    named = 'fix = ["x", "y", "z"]\nname = "clamp"\noutputs = ["reaction.y"]'
    part = read_part(write_part(tmp_path, ("\n[modes]\n", tables), ('fix = ["x", "y", "z"]', named)))
    exchange = exchange_of(part, [TIP, SIDE], [ROOT])
    assert exchange.variables == (
        Port("tip", ("force.x", "force.z"), ("displacement.x", "displacement.z", "velocity.z")),
        Port("root", ("moment.x",), ()),
        Port("gap", (), ("rotation.x",)),
        Port("clamp", (), ("reaction.y",)),
        Port("gravity", ("x", "y", "z"), ()),
        Port("base", ("acceleration.z",), ()),
        Port("energy", (), ("kinetic",)),
    )
    assert exchange.pairs[0][1] == ("root", "tip")
    assert exchange.ports[1][1] is SIDE
    assert exchange.supports[0].dofs is ROOT
