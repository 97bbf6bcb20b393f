"""Whole parts whose ports are moved: against moving supports, closed forms, and the same part pushed."""

from pathlib import Path

import numpy as np
import pytest
from moved_bar import MODES, OUTPUTS, RATIO, SIX, SUPPORT, reduced, root
from moved_responses import responses
from small_part import CELLS, DENSITY, LENGTH, WIDTH, YOUNG, bar, beside, write_mesh, write_part

from fmu_src.runtime.instance import Instance
from fmu_src.runtime.model import ReducedModel
from precompute.arrays import Floats
from precompute.cli import main
from precompute.fmu_face import read_face
from precompute.oscillators import Complexes
from precompute.part import read_part
from precompute.pipeline import package, reduce_part
from precompute.shape import deformed_points, read_shape
from precompute.simulation import simulate

AREA = WIDTH**2
MASS = DENSITY * AREA * LENGTH


def run(model: ReducedModel, inputs: list[dict[str, float]], h: float) -> dict[str, Floats]:
    """Every output after steps of h under these inputs, (steps,)."""
    instance = Instance(model)
    instance.initialising = False
    found = []
    for k, given in enumerate(inputs):
        u = np.array([given.get(name, 0.0) for name in model.inputs])
        instance.set_inputs(np.arange(len(u)), u)
        assert instance.advance(k * h, h) is None
        found.append(instance.reals()[instance.layout.outputs].copy())
    return dict(zip(model.outputs, np.transpose(found), strict=True))


class TestMovingSupport:
    """A clamp that the base moves is a rigid port whose six motions are prescribed."""

    MEASURED = (
        OUTPUTS,
        'outputs = ["displacement.x", "displacement.z", "velocity.z", "stress.xx", "stress.zx"]',
    )
    ABSOLUTE = (OUTPUTS, MEASURED[1].replace("]", ', "absolute_acceleration.x", "absolute_acceleration.z"]'))
    RELATIVE = (OUTPUTS, MEASURED[1].replace("]", ', "acceleration.x", "acceleration.z"]'))
    REACTIONS = '["reaction.x", "reaction.z", "displacement.x", "displacement.z", "velocity.z"]'

    @pytest.mark.parametrize("modes", [MODES, "[modes]\ncount = 3\nresidual = true\n"])
    @pytest.mark.parametrize("damping", [RATIO, "[damping]\nbeta = 2e-6\n"])
    def test_is_a_moved_port(self, tmp_path: Path, damping: str, modes: str) -> None:
        """Few modes, residuals: stresses, motions relative to the clamp, its force on the part."""
        choice, energy = ((RATIO, damping), (MODES, modes)), '[energy]\noutputs = ["strain"]\n'
        clamp = SUPPORT + 'name = "clamp"\noutputs = ["reaction.x", "reaction.z"]\n'
        loads = '[loads]\nbase = ["x", "z"]\ngravity = true\n' + energy
        base = reduced(
            tmp_path, (SUPPORT, clamp), self.ABSOLUTE, *choice, ("[modes]", loads + "[modes]")
        ).model
        port = root(SIX, self.REACTIONS, 'kind = "rigid"') + "[loads]\ngravity = true\n" + energy
        moved = reduced(tmp_path, (SUPPORT, ""), self.RELATIVE, *choice, ("[modes]", port + "[modes]")).model
        np.testing.assert_allclose(moved.frequency, base.frequency, rtol=1e-12)

        rng = np.random.default_rng(0)
        values = rng.standard_normal((40, 4)) * [3.0, 2.0, 500.0, 4.0]
        h = 0.3 / base.frequency[0]
        by_base = run(base, [named(v, "base.acceleration") for v in values], h)
        by_port = run(moved, [named(v, "root.motion") for v in values], h)
        for axis in "xz":
            pairs = [
                (by_port[f"tip.acceleration.{axis}"], by_base[f"tip.absolute_acceleration.{axis}"]),
                (by_port[f"root.reaction.{axis}"], by_base[f"clamp.reaction.{axis}"]),
            ]
            for found, wanted in pairs:
                np.testing.assert_allclose(found, wanted, atol=1e-10 * np.abs(wanted).max())
            own = by_port[f"tip.displacement.{axis}"] - by_port[f"root.displacement.{axis}"]
            wanted = by_base[f"tip.displacement.{axis}"]
            # the port travels far: rounding of its way, not of the deformation
            np.testing.assert_allclose(
                own, wanted, atol=1e-14 * np.abs(by_port[f"root.displacement.{axis}"]).max()
            )
            assert np.abs(wanted).max() > 0
        for name in ("tip.stress.xx", "tip.stress.zx", "energy.strain"):
            scale = np.abs(by_base[name]).max()
            np.testing.assert_allclose(by_port[name], by_base[name], atol=1e-9 * scale)
            assert scale > 0


def test_what_is_not_there_is_exactly_zero(tmp_path: Path) -> None:
    """So that no output is said to depend on what cannot reach it: modes do not move the clamp."""
    port = root(SIX, '["displacement.x", "velocity.z", "rotation.y"]', 'kind = "rigid"')
    model = reduced(tmp_path, (SUPPORT, ""), (MODES, port + MODES)).model
    unit = dict(zip(model.outputs, model.C, strict=True))
    for name, j in (("displacement.x", 0), ("velocity.z", 2), ("rotation.y", 4)):
        np.testing.assert_array_equal(np.delete(unit[f"root.{name}"], j), 0.0)
        assert unit[f"root.{name}"][j] == pytest.approx(1.0, rel=1e-14)
    np.testing.assert_array_equal(unit["tip.displacement.x"][1:6] != 0, [False] * 5)
    np.testing.assert_array_equal(
        unit["tip.displacement.z"][:6] != 0, [False, False, True, False, True, False]
    )


def named(values: Floats, mover: str) -> dict[str, float]:
    names = (f"{mover}.x", f"{mover}.z", "tip.force.z", "gravity.z")
    return dict(zip(names, values.tolist(), strict=True))


class TestUniformBar:
    """One end driven along a bar with ν = 0, whose sections stay plane: linear elements in one dimension."""

    def dynamic_mass(self, omega: float, beta: float = 0.0) -> complex:
        """r/a of the consistent elements: u_j = cos κ(L − x_j)/cos κL, ω²ρh²(2 + cos κh) = 6E(1 − cos κh)."""
        h, E = LENGTH / CELLS, YOUNG * (1 + 1j * omega * beta)
        c = omega**2 * DENSITY * h**2 / (6 * E)
        kappa = np.arccos((1 - 2 * c) / (1 + c)) / h
        u = np.cos(kappa * (LENGTH - np.array([0, h]))) / np.cos(kappa * LENGTH)
        force = E * AREA / h * (u[0] - u[1]) - omega**2 * DENSITY * AREA * h / 6 * (2 * u[0] + u[1])
        return complex(force / (-(omega**2) * u[0]))

    def model(self, folder: Path, count: int, damping: str = "[damping]\nbeta = 1e-5\n") -> ReducedModel:
        port = root('["motion.x"]', '["reaction.x"]')
        changes = ((SUPPORT, ""), (RATIO, damping), (MODES, port + f"[modes]\ncount = {count}\n"))
        return reduced(folder, *changes).model

    def test_reaction_at_every_frequency(self, tmp_path: Path) -> None:
        model = self.model(tmp_path, 83)  # 84 DOFs
        for f in (1.0, 500.0, 1290.0, 5000.0, 12000.0):
            omega = 2 * np.pi * f
            row = model.outputs.index("root.reaction.x")
            found = responses(model, omega)[row, model.inputs.index("root.motion.x")]
            assert found == pytest.approx(self.dynamic_mass(omega, 1e-5), rel=1e-8)
        # it is the bar's, m tan(kL)/kL, where elements are short against the wave
        k = 2 * np.pi * 500 * np.sqrt(DENSITY / YOUNG)
        assert self.dynamic_mass(2 * np.pi * 500) == pytest.approx(
            MASS * np.tan(k * LENGTH) / (k * LENGTH), rel=5e-3
        )

    def test_few_modes_carry_the_whole_mass(self, tmp_path: Path) -> None:
        """What no mode moves, Ψ does: m at rest, with the rigid modes and one elastic one of 78."""
        model = self.model(tmp_path, 6, "[damping]\nratio = 0.01\n")
        assert model.M_s[0, 0] == pytest.approx(MASS, rel=1e-12)
        assert not model.K_s.any()
        assert np.count_nonzero(model.frequency == 0) == 5
        found = responses(model, 2.0)[-1, -1]
        assert found == pytest.approx(MASS, rel=1e-6)


def test_action_is_against_reaction(tmp_path: Path) -> None:
    """Actio = reactio, in both twins' kinds: forces and moments, under loads and motions, after steps."""
    kinds = ("reaction", "action", "reaction_moment", "action_moment")
    port = root(SIX, str([f"{kind}.{axis}" for kind in kinds for axis in "xyz"]), 'kind = "rigid"')
    loads = "[loads]\ngravity = true\n"
    model = reduced(tmp_path, (SUPPORT, ""), (MODES, port + loads + MODES)).model
    rng = np.random.default_rng(5)
    found = run(model, [dict(zip(model.inputs, rng.normal(size=len(model.inputs)), strict=True))] * 3, 1e-4)
    for kind in ("", "_moment"):
        for axis in "xyz":
            force = found[f"root.reaction{kind}.{axis}"]
            assert np.abs(force).min() > 0
            np.testing.assert_array_equal(found[f"root.action{kind}.{axis}"], -force)


EDGE = """[[support]]
name = "edge"
at = { box = [[0.0, 0.0, 0.0], [0.0, 0.1, 0.0]] }
fix = ["y", "z"]
outputs = ["reaction.z"]
"""
FAR = EDGE.replace("[[0.0, 0.0, 0.0], [0.0, 0.1, 0.0]]", "[[1.0, 0.0, 0.0], [1.0, 0.1, 0.0]]")
FAR = FAR.replace('fix = ["y"', 'fix = ["x", "y"')
MIDDLE = """[[port]]
name = "middle"
at = { plane = { normal = "x", at = 0.5 } }
inputs = [FORCES]
outputs = ["rotation.y", "velocity.x", "stress.xx", "displacement.z"REACTIONS]

[[pair]]
name = "gap"
ports = ["root", "tip"]
outputs = ["velocity.z"]
"""
ELEMENTS = """
[[spring]]
port = "tip"
direction = "z"
stiffness = 1e6

[[spring]]
port = "root"
direction = "x"
stiffness = 2e7

[[dashpot]]
port = "tip"
to = "middle"
direction = "z"
damping = 3e3

[[dashpot]]
port = "root"
direction = "x"
damping = 5e3

[[mass]]
port = "root"
mass = 3.0

[loads]
gravity = true
base = ["x", "z"]

"""
MATERIAL = (f"density = {DENSITY}", f"density = {DENSITY}\nalpha = 20.0\nbeta = 3e-6")


class TestPushedAndMoved:
    """A part pushed by the reactions that it has when it is moved moves so, and all else is the same.

    With all modes, at any frequency: H_moved = H_pushed [1/Y, …] with Y the accelerations per force.
    """

    MOVED = ("root.motion.x", "root.motion.z", "root.angular_motion.y", "middle.motion.x")
    PUSHED = ("root.force.x", "root.force.z", "root.moment.y", "middle.force.x")
    FOLLOWED = (
        *("root.acceleration.x", "root.acceleration.z", "root.angular_acceleration.y"),
        "middle.acceleration.x",
    )

    def pair(self, folder: Path, support: str, kind: str, elements: str, free: int) -> list[ReducedModel]:
        found = []
        for moved in (False, True):
            inputs = [name.split(".", 1)[1] for name in (self.MOVED if moved else self.PUSHED)]
            outputs = [name.split(".", 1)[1] for name in self.FOLLOWED]
            reactions = ["reaction.x", "reaction.z", "reaction_moment.y"] if moved else []
            port = root(str(inputs[:3]), str([*outputs[:3], "displacement.z", *reactions]), kind)
            middle = MIDDLE.replace("FORCES", f'"{inputs[3]}", "moment.y"')
            middle = middle.replace("REACTIONS", ', "acceleration.x"' + ', "reaction.x"' * moved)
            text = f"{port}{middle}{elements}[modes]\ncount = {free - 4 * moved}\n"
            changes = [MATERIAL, (SUPPORT, support), (MODES, text)]
            changes += [(RATIO, "[damping]\nalpha = 30.0\nbeta = 1e-6\n")]
            if "base" in elements:
                changes += [(OUTPUTS, OUTPUTS.replace("]", ', "absolute_acceleration.z"]'))]
            found.append(reduced(folder / str(moved), *changes).model)
        return found

    @pytest.mark.parametrize(
        ("support", "kind", "elements", "free"),
        [
            ("", "", "", 84),
            ("", 'kind = "rigid"', ELEMENTS, 78),
            (EDGE, "", ELEMENTS, 80),
            (FAR, "", ELEMENTS, 78),
        ],
        ids=["free", "rigid port", "partly held port", "held at the other end"],
    )
    def test_at_every_frequency(
        self, tmp_path: Path, support: str, kind: str, elements: str, free: int
    ) -> None:
        pushed, moved = self.pair(tmp_path, support, kind, elements, free)
        driven = [moved.inputs.index(name) for name in self.MOVED]
        pushing = [pushed.inputs.index(name) for name in self.PUSHED]
        others = [name for name in moved.inputs if name not in self.MOVED]
        first, second = ([of.inputs.index(name) for name in others] for of in (pushed, moved))
        both = [name for name in pushed.outputs if not name.startswith("energy")]
        rows, same = ([of.outputs.index(name) for name in both] for of in (pushed, moved))
        followed = [both.index(name) for name in self.FOLLOWED]
        reaction = ("root.reaction.x", "root.reaction.z", "root.reaction_moment.y", "middle.reaction.x")
        felt = [moved.outputs.index(name) for name in reaction]
        for f in (3.0, 150.0, 900.0, 7000.0):
            Y, H = responses(pushed, 2 * np.pi * f)[rows], responses(moved, 2 * np.pi * f)
            Z = np.linalg.inv(Y[np.ix_(followed, pushing)])
            by_motion, by_others = Y[:, pushing] @ Z, Y[np.ix_(followed, first)]
            compare(H[np.ix_(felt, driven)], Z, np.abs(Z))
            compare(H[np.ix_(felt, second)], -Z @ by_others, np.abs(Z) @ np.abs(by_others))
            compare(H[np.ix_(same, driven)], by_motion, np.abs(Y[:, pushing]) @ np.abs(Z))
            held = np.abs(Y[:, first]) + np.abs(by_motion) @ np.abs(by_others)
            compare(H[np.ix_(same, second)], Y[:, first] - by_motion @ by_others, held)


def compare(found: Complexes, wanted: Complexes, terms: Floats) -> None:
    """Row by row, as outputs have units of their own, beside what is summed; κ(K) times rounding."""
    scale = terms.max(axis=1, keepdims=True, initial=0.0)
    worst = np.max(np.abs(found - wanted) / (scale + (scale == 0)), axis=1)
    np.testing.assert_array_less(worst, 1e-8)


SIX_FORCES = '["force.x", "force.y", "force.z", "moment.x", "moment.y", "moment.z"]'
SIX_REACTIONS = str([f"{kind}.{axis}" for kind in ("reaction", "reaction_moment") for axis in "xyz"])
ACCELERATIONS = [f"{kind}.{axis}" for kind in ("acceleration", "angular_acceleration") for axis in "xyz"]


def test_two_parts_that_are_joined_are_one(tmp_path: Path) -> None:
    """A clamped bar takes the reactions of another one, which its tip moves: a bar twice as long.

    f = −Z a, a = Y (f + F) at the rigid flange where they meet, with all modes.
    """
    damping = (RATIO, "[damping]\nalpha = 3.0\nbeta = 2e-6\n")
    flange = ('"force.x", "force.z"]', SIX_FORCES[1:] + '\nkind = "rigid"')
    told = (OUTPUTS, f"outputs = {ACCELERATIONS}")
    first = reduced(tmp_path / "first", flange, told, damping, (MODES, "[modes]\ncount = 66\n")).model
    second = reduced(
        tmp_path / "second",
        (SUPPORT, ""),
        (MODES, root(SIX, SIX_REACTIONS, 'kind = "rigid"') + "[modes]\ncount = 72\n"),
        (OUTPUTS, 'outputs = ["displacement.z", "rotation.y"]'),
        damping,
    ).model
    whole = write_part(
        tmp_path,
        damping,
        (OUTPUTS, 'outputs = ["displacement.z", "rotation.y"]'),
        ('normal = "x", at = 1.0', 'normal = "x", at = 2.0'),
        (MODES, root(SIX_FORCES, str(ACCELERATIONS), 'kind = "rigid"').replace("at = 0.0", "at = 1.0")),
    )
    whole.write_text(whole.read_text() + "[modes]\ncount = 138\n")
    write_mesh(tmp_path, *beside(*bar(), (LENGTH, 0.0, 0.0)))
    one = reduce_part(read_part(whole)).model
    for f in (2.0, 60.0, 800.0):
        Y, H, wanted = (responses(of, 2 * np.pi * f) for of in (first, second, one))
        Z = H[np.ix_(places(second.outputs, "root.reaction"), places(second.inputs, "root."))]
        a = np.linalg.solve(np.eye(6) + Y @ Z, Y)  # per force on the flange
        joined = places(one.outputs, "root."), places(one.inputs, "root.")
        compare(a, wanted[np.ix_(*joined)], np.abs(wanted[np.ix_(*joined)]))
        follows = H[np.ix_(places(second.outputs, "tip."), places(second.inputs, "root."))]
        far = wanted[np.ix_(places(one.outputs, "tip."), joined[1])]
        compare(follows @ a, far, np.abs(follows) @ np.abs(a))


def places(names: tuple[str, ...], beginning: str) -> list[int]:
    return [i for i, name in enumerate(names) if name.startswith(beginning)]


def test_a_start_velocity_sets_the_part_in_motion(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`modalfmu simulate` does not ask for an input then; with damping set only it does."""
    reduction = reduced(tmp_path, (SUPPORT, ""), (MODES, root(SIX, "[]", 'kind = "rigid"') + MODES))
    path = package(reduction, tmp_path / "bar.fmu")
    for setting in ("root.start_velocity.x=1", "root.start_rotation.y=0.1", "modes.velocity[2]=1"):
        assert main(["simulate", str(path), "--set", setting, "--stop-time", "1e-3"]) == 0
        assert "no input was given" not in capsys.readouterr().err
    assert main(["simulate", str(path), "--set", "damping.alpha=1", "--stop-time", "1e-3"]) == 0
    assert "no input was given" in capsys.readouterr().err


def test_the_deformed_shape_moves_with_the_port(tmp_path: Path) -> None:
    """p' = p + Ψ s + Φ q as the FMU carries it: the tip's nodes on average as the tip says."""
    port = root(SIX, "[]", 'kind = "rigid"')
    reduction = reduced(tmp_path, (SUPPORT, ""), (MODES, port + MODES))
    path = package(reduction, tmp_path / "bar.fmu")
    face, shape = read_face(path), read_shape(path)
    assert face.amplitudes[:6] == [
        *(f"root.prescribed_displacement.{axis}" for axis in "xyz"),
        *(f"root.prescribed_rotation.{axis}" for axis in "xyz"),
    ]
    assert len(face.amplitudes) == shape.Phi.shape[2] == 6 + 8
    start = {"root.start_displacement.x": 0.1, "root.start_angular_velocity.y": -2.0, "root.motion.z": 30.0}
    found = simulate(face, None, start, stop=0.02, step=1e-3, record_modes=True)
    moved = deformed_points(shape, found.q[-1]) - shape.points
    tip = np.abs(shape.points[:, 0] - LENGTH) < 1e-6
    for axis in (0, 2):
        told = found.result[f"tip.displacement.{'xyz'[axis]}"][-1]
        assert moved[tip, axis].mean() == pytest.approx(told, rel=1e-6)  # single precision
        assert abs(told) > 0.01
