"""Published transients: modal dynamics of CalculiX (a cantilever of 32 C3D20R, in mm, N and t), NAFEMS 5T."""

import gzip
from math import pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from boxes import box
from interfaces import interface_at
from scipy.sparse import coo_array, csr_array, kron
from solids import held, system_of

from fmu_src.runtime.model import Port, ReducedModel
from fmu_src.runtime.propagator import propagator
from fmu_src.runtime.step import at_rest, step
from precompute.arrays import Floats
from precompute.cell_matrices import determinants, jacobians
from precompute.damping import rayleigh
from precompute.eigen import Modes, solve_modes
from precompute.elements import ELEMENTS
from precompute.mesh import Mesh
from precompute.ports import port_nodes
from precompute.read_mesh import read_mesh
from precompute.reduction import reduce
from precompute.system import System

DECK = Path("/usr/share/doc/calculix-ccx-test/examples/test/beamdy1.inp.gz")

FREQUENCIES = [13096.03, 19319.52, 76839.71, 86955.23, 105963.6, 162998.5, 197645.0]
UNDAMPED = [-0.03917054, -0.1046704, -0.1126540, -0.05263218, -0.003658394]
UNDAMPED += [-0.03037663, -0.09801968, -0.1200060, -0.06679581, -0.008781502]
ALPHA_5000 = [-0.03858227, -0.1017664, -0.1094955, -0.05459229, -0.01066114, -0.03371741]
BETA_2E_4 = [-0.002894172, -0.005743276, -0.008453204, -0.01103075]


@pytest.fixture(scope="module", params=["deck", "made here"])
def beam(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Mesh, Modes]:
    """The mesh in metres and ten modes, K and M by 2×2×2 points as CalculiX has them for C3D20R."""
    if request.param == "made here":
        mesh = box("hex20r", (2, 2, 8), (1e-3, 1.5e-3, 8e-3))
    elif DECK.exists():
        copy = tmp_path_factory.mktemp("deck") / "beamdy1.inp"
        copy.write_bytes(gzip.decompress(DECK.read_bytes()))
        mesh = read_mesh(copy, "mm")
    else:
        pytest.skip("the Debian package calculix-ccx-test is not installed")
    exact = system_of(mesh, 210e9, 0.3, 7800.0)
    system = System(mass_by_eight_points(mesh, 7800.0), exact.K, exact.rigid)
    return mesh, solve_modes(system, held(mesh.points[:, 2] < 1e-9, "xyz"), count=10)


def mass_by_eight_points(mesh: Mesh, density: float) -> csr_array:
    """Σ ρ N_a N_b dV over the points that K of hex20r has: CalculiX reduces M too, we do not."""
    rule, nodes = ELEMENTS["hex20r"].stiffness, mesh.cells["hex20r"]
    dV = rule.w * determinants(jacobians(mesh.points[nodes], rule.dN))
    m = density * np.einsum("cq,qa,qb->cab", dV, rule.N, rule.N)
    rows, columns = np.broadcast_arrays(nodes[:, :, None], nodes[:, None, :])
    return csr_array(kron(coo_array((m.ravel(), (rows.ravel(), columns.ravel()))), np.eye(3)))


def deflection(beam: tuple[Mesh, Modes], alpha: float, beta: float, steps: int, h: float = 1e-5) -> Floats:
    """u_y of node 100 in mm after each step: −1 N in y on each of the 21 nodes at z = 8 mm."""
    mesh, modes = beam
    end = np.flatnonzero(mesh.points[:, 2] > 8e-3 - 1e-9)
    middle = np.argmin(np.linalg.norm(mesh.points - [0.5e-3, 0.75e-3, 8e-3], axis=1))
    model = reduce(
        "beamdy",
        "",
        modes.lam,
        modes.Phi,
        rayleigh(modes.lam, alpha, beta),
        interface_at(
            mesh,
            [
                (Port("load", ("force.y",), ()), port_nodes(mesh, end, "equal", "load")),
                (
                    Port("n100", (), ("displacement.y",)),
                    port_nodes(mesh, np.array([middle]), "equal", "n100"),
                ),
            ],
        ),
    )
    assert len(end) == 21
    return 1e3 * respond(model, -21.0, steps, h)


def respond(model: ReducedModel, force: float, steps: int, h: float) -> Floats:
    """The first output after each step under a constant force."""
    P = propagator(model.lam, model.damping(model.alpha, model.beta), h)
    state, u = at_rest(len(model.lam)), []
    for _ in range(steps):
        state = step(P, state, model.B[:, 0] * force)
        u.append(model.C[0] @ state.q)
    return np.array(u)


def test_frequencies_of_beamdy(beam: tuple[Mesh, Modes]) -> None:
    """To the seven digits that the list has."""
    np.testing.assert_allclose(beam[1].frequencies[:7], FREQUENCIES, rtol=5e-7)


@pytest.mark.parametrize(("family", "largest"), [("hex20r", 6e-4), ("hex20", 6e-3)])
def test_exact_mass_and_full_integration_are_other_elements(family: str, largest: float) -> None:
    """Our own choices differ by the element's error, visibly: M exact below, K by 3×3×3 points above."""
    mesh = box(family, (2, 2, 8), (1e-3, 1.5e-3, 8e-3))
    modes = solve_modes(system_of(mesh, 210e9, 0.3, 7800.0), held(mesh.points[:, 2] < 1e-9, "xyz"), count=7)
    difference = modes.frequencies / FREQUENCIES - 1
    assert np.abs(difference).max() < largest
    assert (np.abs(difference) > 1.5e-6).all()
    assert (difference < 0).all() if family == "hex20r" else (difference > 0).all()


@pytest.mark.parametrize(
    ("alpha", "beta", "published"),
    [(0.0, 0.0, UNDAMPED), (5000.0, 0.0, ALPHA_5000), (0.0, 2e-4, BETA_2E_4)],
    ids=["beamdy1, undamped", "beamdy3, under-damped", "beamdy4, over-damped"],
)
def test_transient_of_beamdy(
    beam: tuple[Mesh, Modes], alpha: float, beta: float, published: list[float]
) -> None:
    """Ten modes, each exact in time: within 1e-6 of the largest value, the digits that the list has."""
    u = deflection(beam, alpha, beta, len(published))
    bound = 1e-6 * np.abs(published).max()
    assert np.abs(u - published).max() < bound
    # steps longer by a part in 10⁴ miss by more
    assert np.abs(deflection(beam, alpha, beta, len(published), 1.0001e-5) - published).max() > 3 * bound


def test_deep_beam_5t_one_mode() -> None:
    """NAFEMS 5T: the published peak is δₛ(1 + e^{−ζπ/√(1−ζ²)}) with ζ = 2 %, f₁ = 42.65 Hz."""
    zeta, omega = 0.02, 2 * pi * 42.65
    model = ReducedModel(
        "five_t",
        "",
        np.array([omega**2]),
        2 * zeta * omega,
        0.0,
        np.zeros((1, 1)),
        np.ones((1, 1)),
        np.ones((1, 1)),
        np.zeros((1, 1)),
        np.zeros((1, 1)),
        (Port("middle", ("force.y",), ("displacement.y",)),),
    )
    peak_time = pi / (omega * sqrt(1 - zeta**2))
    u = respond(model, omega**2, 3000, peak_time / 1000)  # unit static deflection
    assert int(u.argmax()) == 999
    assert u.max() == pytest.approx(1 + np.exp(-zeta * pi / sqrt(1 - zeta**2)), rel=1e-12)
    assert u.max() == pytest.approx(1 + np.exp(-zeta * pi), rel=2e-5)  # as it is printed, without the root
