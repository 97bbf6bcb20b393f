"""A frame with six DOFs at every node, imported as K, M and D: its moved ports against the full equations.

[K + iωD − ω²M, Wᵀ; W, 0] [u; −μ] = [F; s]: motions as Lagrange constraints, whose multipliers μ drive them.
"""

from pathlib import Path

import numpy as np
import pytest
from frames import Beam, straight
from matrix_files import write_dofs
from moved_responses import responses
from scipy.io import mmwrite
from scipy.sparse import csr_array

from fmu_src.runtime.instance import Instance
from fmu_src.runtime.model import row_starts
from precompute.arrays import Floats
from precompute.connection import connect
from precompute.full_part import read_full_part
from precompute.oscillators import Complexes
from precompute.part import read_part
from precompute.pipeline import Reduction, reduce_part, silent

TURN = np.array([[2.0, 1.0, 2.0], [-2.0, 2.0, 1.0], [-1.0, -2.0, 2.0]]) / 3  # no axis along the beam
BEAM = Beam(E=2e9, G=8e8, rho=1200.0, A=4e-4, Iy=1.2e-8, Iz=2.5e-8, J=3e-8)
FRAME = straight(BEAM, 1.2, 5, TURN)
N = 36
SPRING, GROUND, INNER, MASS, ALPHA, BETA = 4e3, 30.0, 12.0, 0.3, 2.0, 3e-5

PART = f"""
[part]
name = "frame"

[system]
stiffness = "K.mtx"
mass = "M.mtx"
DAMPING
dofs = "dofs.csv"

[[support]]
name = "foot"
at = {{ nodes = [1] }}
fix = ["x", "y", "z", "rz"]
outputs = ["reaction.x", "reaction.z"]

[[port]]
name = "end"
at = {{ nodes = [6] }}
kind = "KIND"
inputs = ["motion.x", "angular_motion.z", "force.z"]
outputs = ["reaction.x", "reaction_moment.z", "displacement.x", "rotation.z", "acceleration.z"]

[[port]]
name = "side"
at = {{ nodes = [3, 4] }}
inputs = ["motion.z", "motion.y"]
outputs = ["reaction.y", "reaction.z", "velocity.x"]

[[port]]
name = "knee"
at = {{ nodes = [2] }}
inputs = ["force.x", "moment.y"]
outputs = ["displacement.x", "angular_acceleration.y", "absolute_acceleration.x"]

[[pair]]
name = "gap"
ports = ["knee", "end"]
outputs = ["displacement.z", "rotation.x"]

[[spring]]
port = "side"
to = "knee"
direction = "x"
stiffness = {SPRING}

[[dashpot]]
port = "side"
direction = "z"
damping = {GROUND}

[[dashpot]]
port = "knee"
to = "end"
direction = "rz"
damping = {INNER}

[[mass]]
port = "side"
mass = {MASS}

[loads]
gravity = true
base = ["x"]

[energy]
outputs = ["kinetic", "strain"]

[modes]
count = COUNT

[damping]
alpha = {ALPHA}
beta = {BETA}
"""


def unit(*entries: tuple[int, int, float]) -> Floats:
    """A row over the DOFs: node from 1, direction, value."""
    row = np.zeros(N)
    for node, direction, value in entries:
        row[6 * (node - 1) + direction] += value
    return row


def side(direction: int) -> Floats:
    return unit((3, direction, 0.5), (4, direction, 0.5))


W = np.stack([unit((6, 0, 1.0)), unit((6, 5, 1.0)), side(2), side(1)])
FOOT = [0, 1, 2, 5]
FREE = np.setdiff1d(np.arange(N), FOOT)
X, Z = (np.tile(np.eye(6)[k], 6) for k in (0, 2))


def matrices(own: bool) -> tuple[Floats, Floats, Floats]:
    """K, M with the spring and the mass; D of the dashpots, α, β, and of the half that has its own."""
    K, M = FRAME.K.toarray(), FRAME.M.toarray()
    inner = side(0) - unit((2, 0, 1.0))
    K = K + SPRING * np.outer(inner, inner)
    M = M + MASS * sum(np.outer(side(k), side(k)) for k in range(3))
    turning = unit((2, 5, 1.0), (6, 5, -1.0))
    D = ALPHA * M + BETA * K + GROUND * np.outer(side(2), side(2)) + INNER * np.outer(turning, turning)
    return K, M, D + own * half()


def half() -> Floats:
    """A damping matrix that is neither Rayleigh's nor diagonal in the modes."""
    part = np.diag((np.arange(N) < 18).astype(float))
    damping: Floats = part @ (5.0 * FRAME.M.toarray() + 1e-4 * FRAME.K.toarray()) @ part
    return (damping + damping.T) / 2


def reduced(
    folder: Path, own: bool, count: int = 28, kind: str = "average", residual: str = "false"
) -> Reduction:
    for name, A in (("K", FRAME.K), ("M", FRAME.M), ("D", csr_array(half()))):
        mmwrite(folder / f"{name}.mtx", A, precision=17)
    write_dofs(folder / "dofs.csv", FRAME.node + 1, FRAME.direction, FRAME.points[FRAME.node])
    text = (
        PART.replace("COUNT", str(count)).replace("DAMPING", 'damping = "D.mtx"' * own).replace("KIND", kind)
    )
    text = text.replace("[modes]", f"[modes]\nresidual = {residual}")
    (folder / "part.toml").write_text(text)
    return reduce_part(read_part(folder))


def full(own: bool, omega: float, inputs: tuple[str, ...]) -> dict[str, Complexes]:
    """Every linear output per input, (m,)."""
    K, M, D = matrices(own)
    iw = 1j * omega
    A, w = K + iw * D + iw**2 * M, W[:, FREE]
    loads = {
        "end.force.z": unit((6, 2, 1.0)),
        "knee.force.x": unit((2, 0, 1.0)),
        "knee.moment.y": unit((2, 4, 1.0)),
        "gravity.x": M @ X,
        "gravity.y": M @ np.tile(np.eye(6)[1], 6),
        "gravity.z": M @ Z,
        "base.acceleration.x": -M @ X,
    }
    moves = ("end.motion.x", "end.angular_motion.z", "side.motion.z", "side.motion.y")
    F = np.stack([loads.get(name, np.zeros(N)) for name in inputs], axis=1)
    s = np.array([[float(name == move) for name in inputs] for move in moves]) / iw**2
    saddle = np.block([[A[np.ix_(FREE, FREE)], w.T], [w, np.zeros((4, 4))]])
    solved = np.linalg.solve(saddle, np.concatenate([F[FREE], s]))
    u = np.zeros((N, len(inputs)), dtype=complex)
    u[FREE], mu = solved[: len(FREE)], -solved[len(FREE) :]
    foot = A @ u - F
    base = np.array([float(name == "base.acceleration.x") for name in inputs])
    return {
        "end.reaction.x": mu[0],
        "end.reaction_moment.z": mu[1],
        "end.displacement.x": u[30],
        "end.rotation.z": u[35],
        "end.acceleration.z": iw**2 * u[32],
        "side.reaction.y": mu[3],
        "side.reaction.z": mu[2],
        "side.velocity.x": iw * side(0) @ u,
        "knee.displacement.x": u[6],
        "knee.angular_acceleration.y": iw**2 * u[10],
        "knee.absolute_acceleration.x": iw**2 * u[6] + base,
        "gap.displacement.z": u[32] - u[8],
        "gap.rotation.x": u[33] - u[9],
        "foot.reaction.x": foot[0],
        "foot.reaction.z": foot[2],
    }


@pytest.mark.parametrize("own", [False, True], ids=["Rayleigh and dashpots", "a damping matrix too"])
def test_every_output_is_that_of_the_full_equations(tmp_path: Path, own: bool) -> None:
    """With all 28 modes of 36 DOFs less four held and four moved, below the first mode to far above."""
    model = reduced(tmp_path, own).model
    assert (model.k, model.r) == (4, 28)
    for f in (0.1, 0.8 * model.frequency[0], model.frequency[3], 1.3 * model.frequency[12]):
        found, wanted = responses(model, 2 * np.pi * f), full(own, 2 * np.pi * f, model.inputs)
        assert tuple(wanted) == model.outputs[: len(wanted)]
        for name, row in wanted.items():
            np.testing.assert_allclose(
                found[model.outputs.index(name)], row, rtol=1e-8, atol=1e-9 * np.abs(row).max(), err_msg=name
            )  # κ(K) times rounding


def test_residual_vectors_hold_what_drags(tmp_path: Path) -> None:
    """At steady velocities α, dashpots and the damping matrix deform the part as they do with all modes."""
    whole = reduced(tmp_path, True).model
    model = reduced(tmp_path, True, 6, residual='"modes"').model
    steady = 2 * np.pi * 1e-3  # Hz; ω²/λ ≈ 1e-9 of the inertia is there still
    H, H_r = responses(whole, steady), responses(model, steady)
    row = model.outputs.index("gap.rotation.x")
    motions = [name.split(".")[1].endswith("motion") for name in model.inputs]
    wanted, found = H[row, motions] * 1j * steady, H_r[row, motions] * 1j * steady
    assert model.r < whole.r
    np.testing.assert_allclose(found, wanted, atol=1e-8 * np.abs(wanted).max())


def test_a_dashpot_between_ports_at_rest_loads_no_mode(tmp_path: Path) -> None:
    """side.z is held, and the ends of the other one are not: not by a little, but not at all."""
    part = reduced(tmp_path, False).part
    between, turning = connect(part, read_full_part(part, silent)).own_dashpots
    assert between[0].nnz == 0
    assert between[1] == GROUND
    assert turning[0].nnz == 1  # of the knee alone: the end turns as it is told


def test_a_part_that_follows_as_a_rigid_body_is_not_dragged(tmp_path: Path) -> None:
    """D of two of the five beams, which rest as the port takes them along: 0, not the last printed digits."""
    D = np.zeros((N, N))
    D[:18, :18] = 1e-4 * straight(BEAM, 0.48, 2, TURN).K.toarray()
    for name, A, digits in (("K", FRAME.K, 17), ("M", FRAME.M, 17), ("D", csr_array(D), 13)):
        mmwrite(tmp_path / f"{name}.mtx", A, precision=digits)
    write_dofs(tmp_path / "dofs.csv", FRAME.node + 1, FRAME.direction, FRAME.points[FRAME.node])
    six = [f"{kind}.{axis}" for kind in ("motion", "angular_motion") for axis in "xyz"]
    (tmp_path / "part.toml").write_text(
        '[part]\nname = "frame"\n[system]\nstiffness = "K.mtx"\nmass = "M.mtx"\ndamping = "D.mtx"\n'
        'dofs = "dofs.csv"\n[[port]]\nname = "end"\nat = { nodes = [6] }\n'
        f'inputs = {six}\noutputs = ["reaction.x"]\n[modes]\ncount = 12\n'
    )
    model = reduce_part(read_part(tmp_path)).model
    np.testing.assert_array_equal(model.D_rest[:, :6], 0.0)
    assert np.diag(model.D_rest)[6:].max() > 100.0  # 1/s: it does damp the modes


def test_a_rigid_port_of_one_node_is_the_node(tmp_path: Path) -> None:
    (tmp_path / "rigid").mkdir()
    plain, rigid = reduced(tmp_path, True).model, reduced(tmp_path / "rigid", True, kind="rigid").model
    for f in (1.0, 40.0):
        H = responses(plain, 2 * np.pi * f)
        scale = np.abs(H).max(axis=1, keepdims=True)
        np.testing.assert_allclose(responses(rigid, 2 * np.pi * f) / scale, H / scale, atol=1e-9)


def test_energies_are_those_of_the_whole_motion(tmp_path: Path) -> None:
    """½ u̇ᵀMu̇ and ½ uᵀKu of u = Ψ s + Φ q, after steps that leave nothing at rest."""
    reduction = reduced(tmp_path, True, count=9)
    model, (K, M, _) = reduction.model, matrices(True)
    instance = Instance(model)
    instance.set_start({instance.layout.start.start + i: 0.01 * (i + 1) for i in range(8)})
    instance.initialising = False
    rng = np.random.default_rng(0)
    for k in range(20):
        instance.set_inputs(np.arange(len(model.inputs)), rng.standard_normal(len(model.inputs)))
        assert instance.advance(0.01 * k, 0.01) is None
    shapes = np.column_stack([reduction.Psi, reduction.modes.Phi])
    u, v = shapes @ instance.state.q, shapes @ instance.state.v
    y = dict(zip(model.outputs, instance.reals()[instance.layout.outputs], strict=True))
    assert y["energy.kinetic"] == pytest.approx(v @ M @ v / 2, rel=1e-10)
    assert y["energy.strain"] == pytest.approx(u @ K @ u / 2, rel=1e-10)
    assert np.abs(W @ u - instance.state.q[:4]).max() < 1e-12 * np.abs(u).max()


def test_reduced_matrices_are_those_of_craig_and_bampton(tmp_path: Path) -> None:
    """[ΨᵀMΨ, ΨᵀMΦ; …, I] and [ΨᵀKΨ, 0; 0, Λ]: symmetric, positive, and the full ones seen in [Ψ Φ]."""
    reduction = reduced(tmp_path, False)
    model, (K, M, D) = reduction.model, matrices(False)
    shapes = np.column_stack([reduction.Psi, reduction.modes.Phi])
    P = -model.B[4:, model.motions]
    mass = np.block([[model.M_s, P.T], [P, np.eye(model.r)]])
    stiff = np.zeros_like(mass)
    stiff[:4, :4] = model.K_s
    stiff += np.diag(model.lam)
    damping = model.D_rest + ALPHA * mass + BETA * stiff
    for own, whole in ((mass, M), (stiff, K), (damping, D)):
        seen = shapes.T @ whole @ shapes
        np.testing.assert_allclose(own, seen, atol=1e-9 * np.abs(seen).max())
    assert np.linalg.eigvalsh(mass).min() > 0
    assert (model.M_s == model.M_s.T).all()
    assert np.linalg.eigvalsh(model.K_s).min() > -1e-12 * model.K_s.max()
    # reactions are the rows of the same matrices, in the order of the outputs
    starts = dict(zip(model.outputs, row_starts(model.laws), strict=False))
    order = {"end.reaction.x": 0, "end.reaction_moment.z": 1, "side.reaction.z": 2, "side.reaction.y": 3}
    for name, j in order.items():
        C_1, C_2, C_3 = model.C[starts[name] : starts[name] + 3]
        np.testing.assert_allclose(C_1, mass[j], atol=1e-10 * np.abs(mass[j]).max())
        np.testing.assert_allclose(C_2, model.D_rest[j], atol=1e-10 * np.abs(model.D_rest[j]).max())
        np.testing.assert_allclose(C_3, stiff[j], atol=1e-12 * np.abs(stiff[j]).max())
