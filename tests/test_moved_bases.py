"""Any basis, choice of modes and certificate of a part whose ports are moved, against all of its modes."""

import logging
from pathlib import Path

import numpy as np
import pytest
from moved_bar import MODES, OUTPUTS, RATIO, SIX, SUPPORT, reduced, root
from moved_responses import responses
from small_part import write_part

from fmu_src.runtime.model import ReducedModel
from precompute.arrays import Floats
from precompute.certificate_report import certificate_lines
from precompute.errors import EigenError, ModalFmuError
from precompute.notice import LOGGER_NAME
from precompute.part import read_part
from precompute.pipeline import Reduction, reduce_part
from precompute.transfer import blocks_of, spectral_norms

MEASURED = (OUTPUTS, 'outputs = ["velocity.z", "stress.zx"]')
CLAMP = root(SIX, '["reaction.x", "reaction.z", "reaction_moment.y"]', 'kind = "rigid"')
GAP = """[[pair]]
name = "gap"
ports = ["root", "tip"]
outputs = ["displacement.x", "displacement.z"]

[[port]]
name = "middle"
at = { plane = { normal = "x", at = 0.5 } }
outputs = ["stress.xx"]

"""
DAMPING = (RATIO, "[damping]\nbeta = 1e-6\n")
ELASTIC = ("tip.stress.zx", "gap.displacement.x", "gap.displacement.z", "middle.stress.xx")
ALL = "[modes]\ncount = 72\n"


def moved(folder: Path, modes: str, *, certified: bool = False) -> Reduction:
    changes = ((SUPPORT, ""), MEASURED, DAMPING, (MODES, CLAMP + GAP + modes))
    return reduced(folder, *changes, certified=certified)


def elastic(model: ReducedModel, f: float, kinds: tuple[str, ...]) -> Floats:
    """|H| at a frequency of what a rigid body does not show, per inputs of these kinds."""
    columns = [i for i, name in enumerate(model.inputs) if name.split(".")[1] in kinds]
    rows = [model.outputs.index(name) for name in ELASTIC]
    return np.asarray(np.abs(responses(model, 2 * np.pi * f))[np.ix_(rows, columns)])


@pytest.mark.parametrize(
    ("text", "pushed", "driven"),
    [
        ("[modes]\ncount = 2\nresidual = true\n", True, True),
        ('[modes]\ncount = 2\nresidual = "modes"\n', True, True),
        ('[basis]\nkind = "krylov"\n\n[modes]\ncount = 8\n', True, True),
        ('[basis]\nkind = "craig-bampton"\n\n[modes]\ncount = 0\n', True, False),
        ("[modes]\ncount = 2\n", False, False),
    ],
    ids=["residual", "residual modes", "Krylov", "Craig–Bampton", "modes"],
)
def test_bases_that_are_exact_at_rest(tmp_path: Path, text: str, pushed: bool, driven: bool) -> None:
    """Under steady forces and accelerations; Craig and Bampton know of forces, not of inertia."""
    whole, model = moved(tmp_path, ALL).model, moved(tmp_path, text).model
    for kinds, exact in ((("force",), pushed), (("motion", "angular_motion"), driven)):
        wanted, found = (elastic(of, 1e-3, kinds) for of in (whole, model))
        scale = wanted.max(axis=1, keepdims=True)
        error = np.max(np.abs(found - wanted) / scale)
        assert (error < 1e-7) == exact  # κ(K) times rounding
        if not exact:
            assert error > 1e-4


def test_craig_and_bampton_with_ports_that_are_only_moved_has_their_modes(tmp_path: Path) -> None:
    """The ports are held already: nothing is left to be a constraint mode."""
    changes = ((SUPPORT, ""), ('inputs = ["force.x", "force.z"]\n', ""), (OUTPUTS, 'outputs = ["stress.xx"]'))
    text = '[basis]\nkind = "craig-bampton"\n\n' + MODES
    models = [reduced(tmp_path, *changes, (MODES, CLAMP + own)).model for own in (text, MODES)]
    np.testing.assert_allclose(models[0].lam, models[1].lam, rtol=1e-12)
    assert models[0].r == 8


class TestFile:
    def part(self, folder: Path, U: Floats) -> Reduction:
        np.save(folder / "U.npy", U)
        changes = (
            (SUPPORT, ""),
            MEASURED,
            DAMPING,
            (MODES, CLAMP + GAP + '[basis]\nkind = "file"\nfile = "U.npy"\n'),
        )
        return reduced(folder, *changes)

    def test_of_its_own_modes(self, tmp_path: Path) -> None:
        own = moved(tmp_path, MODES)
        mixed = own.modes.Phi @ np.random.default_rng(0).standard_normal((8, 8))
        again = self.part(tmp_path, mixed).model
        np.testing.assert_allclose(again.lam, own.model.lam, rtol=1e-9)
        np.testing.assert_allclose(
            np.abs(again.B[6:]), np.abs(own.model.B[6:]), atol=1e-7 * np.abs(own.model.B[6:]).max()
        )

    def test_that_moves_the_port(self, tmp_path: Path) -> None:
        own = moved(tmp_path, MODES)
        with pytest.raises(
            EigenError, match=r"basis: U\.npy moves a port whose motion is an input, expected 0"
        ):
            self.part(tmp_path, own.Psi[:, :1] + own.modes.Phi)


def test_a_certificate_finds_what_is_missing(tmp_path: Path) -> None:
    """error = ‖H − H_r‖ of all modes and of three: what is prescribed is in both, and cancels."""
    whole, found = moved(tmp_path, ALL).model, moved(tmp_path, "[modes]\ncount = 3\n", certified=True)
    certificate = found.certificate
    assert certificate is not None
    kinds = {(c.output, c.input): c for c in certificate.comparisons}
    assert {"motion", "angular_motion", "force"} == {by for _, by in kinds}
    E = np.array([responses(whole, w) - responses(found.model, w) for w in 2 * np.pi * certificate.frequency])
    for block in blocks_of(whole.ports):
        comparison = kinds[block.output, block.input]
        error = spectral_norms(E[:, block.lines[:, None], block.columns])
        np.testing.assert_allclose(
            comparison.error * comparison.peak, error, rtol=0.02, atol=2e-3 * comparison.peak
        )
    assert kinds["stress", "motion"].largest > 1e-3
    assert kinds["reaction_moment", "angular_motion"].peak > 0
    assert "relative to the static shape" in "\n".join(certificate_lines(certificate))


@pytest.mark.parametrize(
    ("damping", "told"), [("beta = 1e-6", False), ("ratio = 0.01", False), ("alpha = 50.0", True)]
)
def test_what_a_certificate_does_not_compare_is_told(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, damping: str, told: bool
) -> None:
    """What damping adds by the velocities of ports: of β and of ratios nothing, αM drags."""
    changes = ((SUPPORT, ""), MEASURED, (RATIO, f"[damping]\n{damping}\n"))
    with caplog.at_level(logging.INFO, LOGGER_NAME):
        found = reduced(tmp_path, *changes, (MODES, CLAMP + "[modes]\ncount = 3\n"), certified=True)
    assert found.certificate is not None
    assert ("compared for their accelerations alone" in caplog.text) == told


def test_modes_chosen_by_their_error(tmp_path: Path) -> None:
    """Stress at the clamp's side under its motion: within 1 % of all modes' over the band."""
    choice = "[modes]\nerror = 0.01\nband = [0.0, 2000.0]\n"
    whole, found = moved(tmp_path, ALL).model, moved(tmp_path, choice, certified=True)
    assert found.certificate is not None
    assert found.certificate.kept
    model = found.model
    assert model.r < 25
    row = model.outputs.index("middle.stress.xx")
    column = model.inputs.index("root.motion.x")
    frequencies = np.linspace(10, 2000, 60)
    H, H_r = (
        np.array([responses(of, 2 * np.pi * f)[row, column] for f in frequencies]) for of in (whole, model)
    )
    assert np.max(np.abs(H - H_r)) < 0.01 * np.max(np.abs(H))


@pytest.mark.parametrize(("port", "carried"), [(CLAMP, True), ("", False)], ids=["moved", "free"])
def test_a_base_carries_the_ports_that_are_moved(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, port: str, carried: bool
) -> None:
    """They move relative to it, so it moves a part without supports; one without either it does not."""
    loads = '[loads]\nbase = ["x"]\n\n'
    with caplog.at_level(logging.WARNING, LOGGER_NAME):
        reduced(tmp_path, (SUPPORT, ""), (MODES, port + loads + MODES))
    assert ("moves the frame of reference but not the part" in caplog.text) != carried


def test_a_support_that_holds_the_motion_is_told(tmp_path: Path) -> None:
    port = root('["motion.x"]')
    with pytest.raises(ModalFmuError) as caught:
        reduced(tmp_path, (MODES, port + MODES))
    assert str(caught.value) == (
        "part.toml: port root: got the input motion.x, but supports hold the port so; remove it, or hold less"
    )


def test_a_port_that_does_not_tell_a_rotation_cannot_be_turned(tmp_path: Path) -> None:
    tip = ('at = { plane = { normal = "x", at = 1.0 } }\n', "at = { point = [1.0, 0.0, 0.0] }\n")
    part = write_part(tmp_path, tip, ('"force.z"', '"angular_motion.y"'))
    with pytest.raises(
        ModalFmuError, match=r"part\.toml: port tip: got a rotation or moment about y, which one"
    ):
        reduce_part(read_part(part))
