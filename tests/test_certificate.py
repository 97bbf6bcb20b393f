"""What the certificate says of a reduction, against closed forms and complex solves of the full matrices."""

import json
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from port_responses import (
    NOTHING,
    Beam,
    brute_force,
    held_chain,
    interface,
    modal_damping,
    model_of,
    relative,
)
from rich.console import Console
from scipy.sparse import block_diag, csr_array
from systems import chain, chain_held

from fmu_src.runtime.model import Port, ReducedModel
from precompute.accuracy import captured_mass, certify, default_band
from precompute.advice import advice
from precompute.arrays import Bools, Floats
from precompute.certificate import Certificate, percent
from precompute.certificate_report import (
    certificate_files,
    certificate_html,
    certificate_lines,
    certificate_object,
    certificate_table,
)
from precompute.coupled_damping import projected_damping
from precompute.damping import Damping, modal_ratio, rayleigh
from precompute.eigen import Modes, solve_modes
from precompute.full_response import Reference, full_response
from precompute.interface import Interface
from precompute.known_modes import KnownModes, rigid_only
from precompute.needed_modes import Residual, reduced
from precompute.oscillators import oscillators_of
from precompute.reduction import reduce
from precompute.residual import residual_flexibility, with_residual_modes
from precompute.statics import static_solver
from precompute.system import System
from precompute.transfer import blocks_of, lines_of, transfer

BEAM = Beam()
ALPHA, BETA = 20.0, 2e-6
ROUNDING = 1e-8  # of the peak: what the brute force loses (see test_full_response)


def held_against(
    system: System, fixed: Any, modes: Modes, damping: Damping, between: Interface, band: tuple[float, float]
) -> Reference:
    with static_solver(system, fixed) as solve:
        known = KnownModes(modes.lam, modes.Phi, damping.D_rest)
        return full_response(solve, known, damping, between, band, 1e-5)


def part_of(modes: Modes, keep: Bools) -> Modes:
    return Modes(modes.lam[keep], modes.Phi[:, keep], modes.rigid, modes.solver)


def beam_model(modes: Modes, residual: Residual) -> ReducedModel:
    """The reduced model of these modes as a build makes it."""
    with static_solver(BEAM.system, BEAM.clamp) as solve:
        if residual == "modes":
            modes = with_residual_modes(modes, BEAM.interface.b.toarray(), solve)
        flexibility = residual_flexibility(BEAM.interface, modes, solve) if residual is True else None
    return reduce(
        "beam", "", modes.lam, modes.Phi, rayleigh(modes.lam, ALPHA, BETA), BEAM.interface, flexibility
    )


def beam_certificate(
    keep: Bools, residual: Residual, change: float = 1.0
) -> tuple[Certificate, ReducedModel, Reference]:
    """Of the modes `keep` out of the first ten; change: of the model's B, to make it wrong."""
    modes = solve_modes(BEAM.system, BEAM.clamp, count=len(keep))
    reference = held_against(
        BEAM.system, BEAM.clamp, modes, rayleigh(modes.lam, ALPHA, BETA), BEAM.interface, (0.0, 1200.0)
    )
    kept = part_of(modes, keep)
    model = beam_model(kept, residual)
    model = replace(model, B=change * model.B)
    return certify(reference, model, captured_mass(BEAM.system, kept.Phi), 0.01), model, reference


FIRST = np.arange(10) < 5
GAP = np.arange(10) != 2  # the third is missing, in the middle of the band


@pytest.mark.parametrize("residual", [False, True, "modes"])
@pytest.mark.parametrize("keep", [FIRST, GAP], ids=["first", "gap"])
def test_the_error_is_that_of_complex_solves(keep: Bools, residual: Residual) -> None:
    """Never below the true error at a sample, and within 1 % of it where it is not small."""
    certificate, model, _ = beam_certificate(keep, residual)
    D = np.asarray((ALPHA * BEAM.system.M + BETA * BEAM.system.K).toarray())
    H = brute_force(BEAM.system, BEAM.clamp, D, BEAM.interface, certificate.frequency, ALPHA)
    system = oscillators_of(model)
    E = H - transfer(system, lines_of(model.ports), 2 * np.pi * certificate.frequency)
    for block, comparison in zip(blocks_of(model.ports), certificate.comparisons, strict=True):
        true = relative(E, H, block)
        peak = np.max(np.linalg.norm(H[:, block.lines[:, None], block.columns], 2, axis=(1, 2)))
        assert comparison.peak == pytest.approx(peak, rel=1e-5)  # accuracy of the reference
        assert np.all(comparison.error >= true - ROUNDING)
        assert np.all(comparison.error <= 1.01 * true + 2e-5)  # twice that accuracy
        worst = int(np.argmax(true))
        entries = np.abs(E)[worst][block.lines[:, None], block.columns]
        assert comparison.deviation == pytest.approx(np.max(entries), rel=0.02)


def test_two_masses_by_hand() -> None:
    """λ = (3 ∓ √5)/2; the second mode alone is missing, so E = φ₂²/(λ₂ − ω²), largest at the band's end."""
    system, between = held_chain(2)
    modes = solve_modes(system, NOTHING, count=1)
    damping = modal_ratio(modes.lam, 0.05)
    end = np.sqrt(modes.lam[0]) / (2 * np.pi) * 1.2
    reference = held_against(system, NOTHING, modes, damping, between, (0.0, end))
    model = reduce("chain", "", modes.lam, modes.Phi, damping, between)
    comparison = certify(reference, model, captured_mass(system, modes.Phi), 0.01).comparisons[0]
    lam1, lam2 = (3 - np.sqrt(5)) / 2, (3 + np.sqrt(5)) / 2
    share1, share2 = ((2 - lam) ** 2 / (1 + (2 - lam) ** 2) for lam in (lam1, lam2))  # φ² at the last mass
    w = 2 * np.pi * comparison.worst_frequency
    H2 = share2 / (lam2 - w**2 + 2j * 0.05 * w * np.sqrt(lam2))
    assert comparison.worst_frequency == pytest.approx(end)
    assert comparison.deviation == pytest.approx(abs(H2), rel=1e-4)  # accuracy 1e-5 of the peak, 17 times H2
    assert comparison.static == pytest.approx(share2 / lam2 / 2.0, rel=1e-9)  # K⁻¹ is 2 m/N at the end
    peak = abs(share1 / (2j * 0.05 * lam1) + share2 / (lam2 - lam1 + 2j * 0.05 * np.sqrt(lam1 * lam2)))
    assert comparison.peak == pytest.approx(peak, rel=5e-3)  # the damped peak lies ζ² beside ω₁
    assert comparison.pair == ("end.displacement.x", "end.force.x")
    assert comparison.unit == "m/N"


def test_a_wrong_model_is_found_out() -> None:
    """Loads 2 % too large show as 2 %, and by name; the same model with the right loads passes."""
    right, _, _ = beam_certificate(np.ones(10, dtype=bool), "modes")
    wrong, _, _ = beam_certificate(np.ones(10, dtype=bool), "modes", change=1.02)
    assert right.kept
    assert not wrong.kept
    assert wrong.largest == pytest.approx(0.02, rel=1e-2)


def test_a_missing_mode_ends_the_frequency_up_to_which_one_percent_holds() -> None:
    modes = solve_modes(BEAM.system, BEAM.clamp, count=3)
    certificate, _, _ = beam_certificate(GAP, "modes")
    worst = max(certificate.comparisons, key=lambda comparison: comparison.largest)
    assert 0 < certificate.holds_to(0.01) < modes.frequencies[2]
    assert worst.worst_frequency == pytest.approx(modes.frequencies[2], rel=0.02)  # ζ is 1 % there
    assert "force" in worst.pair[1]


def test_a_mode_that_nobody_excites_may_be_missing() -> None:
    """Without the port that acts in y, modes that bend in y change nothing."""
    z, inner = BEAM.motion(BEAM.tip, 2), BEAM.motion(BEAM.middle, 2)
    between = interface((Port("tip", ("force.z",), ("displacement.z",)),), [z], [z])
    modes = solve_modes(BEAM.system, BEAM.clamp, count=8)
    damping = rayleigh(modes.lam, ALPHA, BETA)
    reference = held_against(BEAM.system, BEAM.clamp, modes, damping, between, (0.0, 1000.0))
    seen = np.abs(inner @ modes.Phi) > 1e-6 * np.max(np.abs(modes.Phi))
    assert 0 < np.sum(~seen) < 8
    both = []
    for keep in (np.ones(8, dtype=bool), seen):
        few = part_of(modes, keep)
        model = reduce("beam", "", few.lam, few.Phi, rayleigh(few.lam, ALPHA, BETA), between)
        both.append(certify(reference, model, captured_mass(BEAM.system, few.Phi), 0.01).largest)
    assert both[1] == pytest.approx(both[0], rel=1e-6)


def test_quantities_that_do_not_meet_raise_no_alarm() -> None:
    """Two chains side by side: the second is measured, nothing acts on it; rounding is not an error."""
    one = chain(8, ground=1.0)
    system = System(*(csr_array(block_diag([A, A])) for A in (one.M, one.K)), np.tile(one.rigid, (2, 1)))
    load, near, far = np.eye(16)[7], np.eye(16)[7], np.eye(16)[15]
    ports = (Port("a", ("force.x",), ("displacement.x",)), Port("b", (), ("rotation.x",)))
    modes = solve_modes(system, NOTHING, count=6)
    damping = modal_ratio(modes.lam, 0.02)
    between = interface(ports, [load], [near, far])
    reference = held_against(system, NOTHING, modes, damping, between, (0.0, 0.06))
    model = reduce("chains", "", modes.lam, modes.Phi, damping, between)
    apart = certify(reference, model, captured_mass(system, modes.Phi), 0.01).comparisons[1]
    assert apart.largest <= 1e-6
    assert apart.static is None


@pytest.mark.parametrize("residual", [False, "modes"])
def test_a_force_at_right_angles_to_a_motion_raises_no_alarm(residual: Residual) -> None:
    """Lightly damped modes and residual vectors enlarge rounding; no vector is spent on it."""
    y, z = BEAM.motion(BEAM.tip, 1), BEAM.motion(BEAM.tip, 2)
    between = interface((Port("tip", ("force.z",), ("displacement.y", "acceleration.y")),), [z], [y, y])
    modes = solve_modes(BEAM.system, BEAM.clamp, count=3)
    with static_solver(BEAM.system, BEAM.clamp) as solve:
        few = modes if residual is False else with_residual_modes(modes, between.b.toarray(), solve)
    damping = rayleigh(modes.lam, 0.5, 1e-7)
    reference = held_against(BEAM.system, BEAM.clamp, modes, damping, between, (0.0, 900.0))
    model = reduce("beam", "", few.lam, few.Phi, rayleigh(few.lam, 0.5, 1e-7), between)
    certificate = certify(reference, model, captured_mass(BEAM.system, few.Phi), 0.01)
    assert certificate.kept
    assert certificate.vectors == 0


def test_gravity_along_z_moves_a_free_body_not_along_x() -> None:
    """Nor does it strain it: neither is an error, and what is 0 throughout has none either."""
    x, fall = BEAM.motion(BEAM.tip, 0), np.asarray(BEAM.system.M @ BEAM.system.rigid[:, 2])
    strain = BEAM.motion(BEAM.tip, 0) - BEAM.motion(BEAM.middle, 0)
    ports = (
        Port("tip", (), ("displacement.x", "stress.xx", "rotation.x")),
        Port("gravity", ("z",), ()),
    )
    between = interface(ports, [fall], [x, strain, np.zeros_like(x)])
    modes = solve_modes(BEAM.system, NOTHING, count=12)
    damping = rayleigh(modes.lam, 0.0, 1e-6)
    reference = held_against(BEAM.system, NOTHING, modes, damping, between, (0.0, 900.0))
    model = reduce("beam", "", modes.lam, modes.Phi, damping, between)
    certificate = certify(reference, model, captured_mass(BEAM.system, modes.Phi), 0.01)
    assert len(certificate.comparisons) == 3
    assert all(c.largest <= 1e-6 for c in certificate.comparisons)  # no number is no error either


def test_a_model_that_misses_what_a_strong_dashpot_holds_is_found_out() -> None:
    """The dashpot holds the tip, and the middle swings as between two supports, sharply: nowhere near a
    resonance of the modes. At 600 frequencies beside the certificate's and at that of the held beam.
    """
    inner, tip = BEAM.motion(BEAM.middle, 2), BEAM.motion(BEAM.tip, 2)
    between = interface((Port("middle", ("force.z",), ("displacement.z",)),), [inner], [inner])
    dashpots = ((csr_array(tip[None]), 1e8),)
    modes = solve_modes(BEAM.system, BEAM.clamp, count=10)
    rule = rayleigh(modes.lam, 0.5, 1e-7)
    damping = replace(rule, D_rest=projected_damping(modes.lam, modes.Phi, None, dashpots))
    with static_solver(BEAM.system, BEAM.clamp) as solve:
        known = KnownModes(modes.lam, modes.Phi, damping.D_rest)
        reference = full_response(solve, known, damping, between, (0.0, 900.0), 1e-5, dashpots)
    model = reduce("beam", "", modes.lam, modes.Phi, damping, between)
    comparison = certify(reference, model, captured_mass(BEAM.system, modes.Phi), 0.01).comparisons[0]
    D = np.asarray((0.5 * BEAM.system.M + 1e-7 * BEAM.system.K).toarray()) + 1e8 * np.outer(tip, tip)
    held, _ = reference.full.resonances
    held = held[held < 900.0][:, None] * (1 + np.linspace(-1e-3, 1e-3, 21))
    frequency = np.unique(np.concatenate([np.linspace(5.0, 900.0, 180), held.ravel()]))
    H = brute_force(BEAM.system, BEAM.clamp, D, between, frequency, 0.5)
    E = H - transfer(oscillators_of(model), lines_of(model.ports), 2 * np.pi * frequency)
    true = float(np.max(relative(E, H, blocks_of(between.ports)[0])))
    assert true > 0.9
    assert comparison.largest == pytest.approx(true, rel=0.01)


def test_undamped_resonances_are_told() -> None:
    """Of the chain's resonances three lie in the band; with damping nothing is said of them."""
    system, between = held_chain(12)
    end = np.sqrt(np.mean(chain_held(12, 4)[2:])) / (2 * np.pi)
    modes = solve_modes(system, NOTHING, count=6)
    for beta, number in ((0.0, 3), (1e-3, 0)):
        damping = rayleigh(modes.lam, 0.0, beta)
        reference = held_against(system, NOTHING, modes, damping, between, (0.0, float(end)))
        model = reduce("chain", "", modes.lam, modes.Phi, damping, between)
        certificate = certify(reference, model, captured_mass(system, modes.Phi), 0.01)
        assert certificate.undamped == number
        assert ("have no damping" in "\n".join(certificate_lines(certificate))) == (number > 0)


@pytest.mark.parametrize(
    ("share", "words"),
    [(0.0, "0 %"), (0.00123, "0.123 %"), (0.9996, "100 %"), (1.0, "100 %"), (12.0, "1200 %")],
)
def test_shares_are_printed_without_powers_of_ten(share: float, words: str) -> None:
    assert percent(share) == words


def test_static_errors() -> None:
    """Plain truncation leaves one; residual flexibility and residual vectors leave rounding of K⁻¹."""
    for residual, least, most in ((False, 1e-5, 0.1), (True, 0.0, 1e-10), ("modes", 0.0, 1e-10)):
        certificate, _, _ = beam_certificate(FIRST, residual)
        error = certificate.comparisons[0].static
        assert error is not None
        assert least <= error <= most


def test_mass_captured() -> None:
    """All modes of a free body move all of its mass, whatever moves only in x has no share in y."""
    system = chain(6)
    modes = solve_modes(system, NOTHING, count=6)
    np.testing.assert_allclose(captured_mass(system, modes.Phi), [1.0, np.nan, np.nan], rtol=1e-12)
    rigid, elastic = modes.Phi[:, :1], modes.Phi[:, 1:]
    np.testing.assert_allclose(captured_mass(system, rigid), [1.0, np.nan, np.nan], rtol=1e-12)
    np.testing.assert_allclose(captured_mass(system, elastic), [0.0, np.nan, np.nan], atol=1e-12)


def test_the_default_band() -> None:
    assert default_band(np.array([0.0, 30.0, 90.0])) == (0.0, 60.0)
    assert default_band(np.zeros(6)) is None


def test_a_part_without_inputs_has_nothing_to_compare() -> None:
    system, _ = held_chain(4)
    between = Interface(
        (Port("end", (), ("displacement.x",)),),
        held_chain(4)[1].b[:, :0],
        held_chain(4)[1].c,
        np.zeros((1, 0)),
    )
    modes = solve_modes(system, NOTHING, count=2)
    damping = rayleigh(modes.lam, 0.0, 0.01)
    reference = held_against(system, NOTHING, modes, damping, between, (0.0, 0.1))
    model = reduce("chain", "", modes.lam, modes.Phi, damping, between)
    certificate = certify(reference, model, captured_mass(system, modes.Phi), 0.01)
    assert certificate.comparisons == ()
    assert certificate.kept
    assert "nothing to compare" in certificate_lines(certificate)[0]


def test_what_it_prints() -> None:
    certificate, _, _ = beam_certificate(FIRST, False)
    console = Console(width=200)
    with console.capture() as text:
        console.print(certificate_table(certificate))
    worst = certificate.worst
    assert worst is not None
    for word in ("displacement per force", "m/N", f"{worst.pair[0]} per {worst.pair[1]}", "static error"):
        assert word in text.get()
    lines = "\n".join(certificate_lines(certificate))
    assert "largest error found" in lines
    assert "a bound" in lines
    assert "mass captured: x " in lines
    assert "prescribed motions" not in lines


def test_what_goes_into_the_fmu() -> None:
    """JSON that carries error(f), a page that names the worst pair, a picture; the same bytes every time."""
    certificate, _, _ = beam_certificate(FIRST, False)
    files = certificate_files(certificate)
    assert files == certificate_files(certificate)
    found = json.loads(files["extra/modalfmu/accuracy/certificate.json"])
    assert found == certificate_object(certificate)
    for response, comparison in zip(found["responses"], certificate.comparisons, strict=True):
        assert max(response["error"]) == response["largest_error_found"] == comparison.largest
        assert len(response["error"]) == len(found["frequency"])
    assert files["documentation/accuracy.png"].startswith(b"\x89PNG")
    page = files["documentation/accuracy.html"].decode()
    assert 'src="accuracy.png"' in page
    assert certificate.comparisons[0].pair[0] in page


def test_names_cannot_break_the_page() -> None:
    certificate, _, _ = beam_certificate(FIRST, False)
    odd = replace(certificate, comparisons=(replace(certificate.comparisons[0], pair=("<b>", "&")),))
    page = certificate_html(odd, "accuracy.png")
    assert "&lt;b&gt; per &amp;" in page
    assert "<b>" not in page


def test_nothing_is_advised_where_the_tolerance_is_kept() -> None:
    certificate, _, reference = beam_certificate(np.ones(10, dtype=bool), "modes")
    assert advice(reference, certificate, "modes") is None


def followed(words: str, count: int, residual: Residual, tolerance: float, end: float) -> list[bool]:
    """Whether the tolerance is kept after each change that the advice names."""
    kept = []
    for change in words.split("; write ")[1].split(" or "):
        found = re.search(r"max_frequency = ([\d.e+]+)", change)
        modes = (
            solve_modes(BEAM.system, BEAM.clamp, count=count)
            if found is None
            else solve_modes(BEAM.system, BEAM.clamp, max_frequency=float(found[1]))
        )
        ends = re.search(r"band that ends at ([\d.e+]+)", change)
        band = (0.0, end if ends is None else float(ends[1]))
        reference = held_against(
            BEAM.system, BEAM.clamp, modes, rayleigh(modes.lam, ALPHA, BETA), BEAM.interface, band
        )
        model = beam_model(modes, "modes" if 'residual = "modes"' in change else residual)
        kept.append(certify(reference, model, captured_mass(BEAM.system, modes.Phi), tolerance).kept)
    return kept


def advised(
    count: int, residual: Residual, tolerance: float, beyond: float
) -> tuple[str | None, Certificate, float]:
    """The advice over a band that ends at `beyond` times the highest of `count` modes."""
    modes = solve_modes(BEAM.system, BEAM.clamp, count=count)
    end = beyond * float(modes.frequencies[-1])
    reference = held_against(
        BEAM.system, BEAM.clamp, modes, rayleigh(modes.lam, ALPHA, BETA), BEAM.interface, (0.0, end)
    )
    certificate = certify(
        reference, beam_model(modes, residual), captured_mass(BEAM.system, modes.Phi), tolerance
    )
    return advice(reference, certificate, residual), certificate, end


@pytest.mark.parametrize("residual", [False, True, "modes"])
@pytest.mark.parametrize("count", [1, 2, 6])
@pytest.mark.parametrize("beyond", [1.0, 2.0])
def test_what_is_advised_mends_it(count: int, residual: Residual, beyond: float) -> None:
    """Every change named keeps the tolerance when it is made, alone."""
    for tolerance in (0.03, 1e-4):
        words, certificate, end = advised(count, residual, tolerance, beyond)
        assert (words is None) == certificate.kept
        if words is not None:
            assert "\n" not in words
            assert f"expected at most {100 * tolerance:.3g} %" in words
            assert all(followed(words, count, residual, tolerance, end))


@pytest.mark.parametrize(
    ("count", "residual", "tolerance", "beyond", "named"),
    [
        (1, False, 0.01, 2.0, "[modes] max_frequency = "),
        (2, False, 1e-3, 1.5, '[modes] residual = "modes" (leaves'),
        (6, False, 1e-4, 1.0, '[modes] residual = "modes" and max_frequency = '),
        (4, "modes", 1e-3, 1.5, "[modes] max_frequency = "),
    ],
)
def test_each_change_is_advised_where_it_does(
    count: int, residual: Residual, tolerance: float, beyond: float, named: str
) -> None:
    assert named in str(advised(count, residual, tolerance, beyond)[0])


def test_a_shorter_band_is_advised_only_as_far_as_its_own_peak_allows() -> None:
    """Errors are relative to the peak of the band: without the highest one they count for more."""
    words, certificate, end = advised(10, False, 1e-4, 3.0)
    assert words is not None
    assert "band that ends at" in words
    assert all(followed(words, 10, False, 1e-4, end))
    assert certificate.holds_to(1e-4) > 1.5 * float(words.split("ends at ")[1].split()[0])


def test_advice_on_a_basis_that_is_not_modal_names_the_modal_one() -> None:
    modes = solve_modes(BEAM.system, BEAM.clamp, count=2)
    damping = rayleigh(modes.lam, ALPHA, BETA)
    with static_solver(BEAM.system, BEAM.clamp) as solve:
        reference = full_response(solve, rigid_only(solve), damping, BEAM.interface, (0.0, 200.0), 1e-5)
    certificate = certify(reference, beam_model(modes, False), np.ones(3), 1e-3)
    words = str(advice(reference, certificate, False, modal=False))
    assert 'write [basis] kind = "modal", [modes] ' in words
    assert all(followed(words, 2, False, 1e-3, 200.0))


DASHPOTS = ((BEAM.inner, 900.0),)


@pytest.mark.parametrize("residual", [False, True, "modes"])
@pytest.mark.parametrize("form", ["Rayleigh", "ratio", "dashpot", "half of the part"])
def test_a_reduced_model_of_the_full_one_is_what_a_build_makes(form: str, residual: Residual) -> None:
    """The candidates that choices and advice are made by have the responses of the real reduction."""
    D = BEAM.half_damped(40.0, 5e-6) if form == "half of the part" else None
    dashpots = DASHPOTS if form == "dashpot" else ()
    system = replace(BEAM.system, D=D)

    def damp(modes: Modes) -> Damping:
        rule = modal_ratio(modes.lam, 0.02) if form == "ratio" else rayleigh(modes.lam, ALPHA, BETA)
        extra = projected_damping(modes.lam, modes.Phi, D, dashpots)
        return replace(rule, D_rest=rule.D_rest + extra)

    modes = solve_modes(system, BEAM.clamp, count=6)
    keep = np.arange(6) != 1
    few, flexibility = part_of(modes, keep), None
    with static_solver(system, BEAM.clamp) as solve:
        known = KnownModes(modes.lam, modes.Phi, damp(modes).D_rest)
        reference = full_response(solve, known, damp(modes), BEAM.interface, (0.0, 800.0), 1e-5, dashpots)
        if residual == "modes":
            few = with_residual_modes(few, BEAM.interface.b.toarray(), solve)
        elif residual:
            flexibility = residual_flexibility(BEAM.interface, few, solve)
    built = reduce("beam", "", few.lam, few.Phi, damp(few), BEAM.interface, flexibility)
    own = reduced(reference.full, keep, residual)
    omega = 2 * np.pi * np.append([1.0, 50.0, 333.0, 800.0], modes.frequencies)
    H, H_built = (transfer(o, lines_of(built.ports), omega) for o in (own, oscillators_of(built)))
    assert len(own.k) == len(built.lam)
    for line in range(H.shape[1]):
        size = np.max(np.abs(H_built[:, line]))
        np.testing.assert_allclose(
            H[:, line], H_built[:, line], rtol=0, atol=1e-8 * size
        )  # rounding of λ, K⁻¹
    assert model_of(reference.full, own).frequency == pytest.approx(built.frequency)


def test_gravity_on_a_free_body_brings_no_residual_vector() -> None:
    z = BEAM.motion(BEAM.tip, 2)
    fall = np.asarray(BEAM.system.M @ BEAM.system.rigid[:, 2])
    ports = (Port("tip", ("force.z",), ("displacement.z",)), Port("gravity", ("z",), ()))
    modes = solve_modes(BEAM.system, NOTHING, count=10)
    damping = rayleigh(modes.lam, 0.0, BETA)
    between = interface(ports, [z, fall], [z])
    reference = held_against(BEAM.system, NOTHING, modes, damping, between, (0.0, 600.0))
    assert len(reduced(reference.full, np.ones(10, dtype=bool), "modes").k) == 11


def test_modes_of_a_ratio_are_compared_with_the_same_ratio_on_all_modes() -> None:
    modes = solve_modes(BEAM.system, BEAM.clamp, count=6)
    damping = modal_ratio(modes.lam, 0.02)
    reference = held_against(BEAM.system, BEAM.clamp, modes, damping, BEAM.interface, (0.0, 600.0))
    model = reduce("beam", "", modes.lam, modes.Phi, damping, BEAM.interface)
    certificate = certify(reference, model, captured_mass(BEAM.system, modes.Phi), 0.01)
    D = modal_damping(BEAM.system, BEAM.clamp, 0.02)
    H = brute_force(BEAM.system, BEAM.clamp, D, BEAM.interface, certificate.frequency, 0.0)
    E = H - transfer(oscillators_of(model), lines_of(model.ports), 2 * np.pi * certificate.frequency)
    for block, comparison in zip(blocks_of(model.ports), certificate.comparisons, strict=True):
        true = relative(E, H, block)
        assert np.max(true) == pytest.approx(comparison.largest, rel=0.01)


def test_it_samples_at_every_resonance_of_the_band() -> None:
    """Those of the known modes and those that the Krylov space finds, by the closed form of the chain."""
    n, known = 20, 3
    system, between = held_chain(n)
    modes = solve_modes(system, NOTHING, count=known)
    damping = rayleigh(modes.lam, 0.0, 0.01)
    resonances: Floats = np.sqrt(chain_held(n, 6)) / (2 * np.pi)
    reference = held_against(system, NOTHING, modes, damping, between, (0.0, 1.05 * resonances[-1]))
    for resonance in resonances:
        assert np.min(np.abs(reference.frequencies - resonance)) <= 1e-6 * resonance
