"""The certificate to read, to compute with and to look at; as it is printed and as it goes into the FMU."""

import io
import json
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from rich import box
from rich.table import Table

from .certificate import ONE_PERCENT, Certificate, Comparison, percent
from .frequency_samples import UNSEEN
from .port_rows import DRIVEN

FOLDER = "extra/modalfmu/accuracy"
HEAD = ("response", "peak", "largest error found", "at / Hz", "there", "static error", "1 % up to / Hz")


def certificate_table(certificate: Certificate) -> Table:
    """One row per pair of kinds: errors relative to the peak of their response over the band."""
    low, high = certificate.band
    table = Table(
        title=f"accuracy from {low:.4g} to {high:.4g} Hz, port to port", title_justify="left", box=box.SIMPLE
    )
    for name in HEAD:
        table.add_column(name, justify="left" if name in ("response", "there") else "right")
    for comparison in certificate.comparisons:
        table.add_row(*_cells(comparison))
    return table


def certificate_lines(certificate: Certificate) -> list[str]:
    """What the table rests on, in sentences."""
    if not certificate.comparisons:
        return ["accuracy: no input acts on a linear output, so there is nothing to compare"]
    low, high = certificate.band
    captured = ", ".join(
        f"{axis} {100 * share:.1f} %"
        for axis, share in zip("xyz", certificate.captured, strict=True)
        if share >= 0
    )
    proved = min(certificate.proved_to, high)
    holds = certificate.holds_to(ONE_PERCENT)
    below = ", below which the part moves as a rigid body," if low > certificate.asked[0] else ""
    return [
        f"largest error found: {percent(certificate.largest)} of the peak (tolerance "
        f"{percent(certificate.tolerance)}), at {len(certificate.frequency)} frequencies, close at "
        "the resonances",
        f"1 % holds from {low:.4g} Hz{below} to {holds:.4g} Hz" if holds else "1 % holds nowhere",
        f"mass captured: {captured}",
        f"the full model's responses, by {certificate.vectors} Krylov vectors beside its known modes, are "
        f"exact to {percent(certificate.reference_error)} of the peak, which the errors include; "
        + (
            f"at these frequencies up to {proved:.4g} Hz that is a bound"
            if proved > low
            else "that is an estimate, not a bound"
        ),
        *_driven(certificate.comparisons),
        *_undamped(certificate.undamped),
    ]


def _driven(comparisons: Sequence[Comparison]) -> list[str]:
    """What responses to the motions of ports are, as those of the whole motion have no peak at 0 Hz."""
    if not any(comparison.input in DRIVEN.values() for comparison in comparisons):
        return []
    return [
        "responses to prescribed motions are those relative to the static shape that follows the ports, "
        "which is exact"
    ]


def _undamped(number: int) -> list[str]:
    if number == 0:
        return []
    return [
        f"{number} resonance{'s have' if number > 1 else ' has'} no damping, so no highest peak: errors are "
        f"relative to the highest response farther than {percent(UNSEEN)} of its frequency from there"
    ]


def certificate_object(certificate: Certificate) -> dict[str, Any]:
    """The same for JSON, with error(f) of each pair of kinds; None where there is no number."""
    return {
        "asked_band": list(certificate.asked),
        "band": list(certificate.band),
        "tolerance": certificate.tolerance,
        "largest_error_found": certificate.largest,
        "kept": certificate.kept,
        "holds_1_percent_to": certificate.holds_to(ONE_PERCENT),
        "mass_captured": {
            axis: float(share) if share >= 0 else None
            for axis, share in zip("xyz", certificate.captured, strict=True)
        },
        "reference": {
            "krylov_vectors": certificate.vectors,
            "error": certificate.reference_error,
            "proved_to": certificate.proved_to,
        },
        "undamped_resonances": certificate.undamped,
        "frequency": certificate.frequency.tolist(),
        "responses": [
            {
                "output": c.output,
                "input": c.input,
                "unit": c.unit,
                "peak": c.peak,
                "largest_error_found": c.largest,
                "at": c.worst_frequency,
                "pair": {
                    "output": c.pair[0],
                    "input": c.pair[1],
                    "deviation": c.deviation,
                    "response": c.size,
                },
                "static_error": c.static,
                "holds_1_percent_to": c.holds_to,
                "error": c.error.tolist(),
            }
            for c in certificate.comparisons
        ],
    }


def certificate_html(certificate: Certificate, plot: str) -> str:
    """A page for `documentation/`; plot: the name of the picture beside it."""
    rows = "\n".join(
        "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in _cells(c)) + "</tr>"
        for c in certificate.comparisons
    )
    head = "".join(f"<th>{escape(name)}</th>" for name in HEAD)
    lines = "\n".join(f"<p>{escape(line)}.</p>" for line in certificate_lines(certificate))
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>accuracy</title>\n'
        "<style>body{font:15px sans-serif;margin:2em}td,th{padding:.2em .8em;text-align:left}"
        "th{border-bottom:1px solid}</style></head>\n"
        "<body><h1>Accuracy of the reduction</h1>\n"
        "<p>error(f) = ‖H(f) − H<sub>r</sub>(f)‖₂ / max ‖H‖₂ over the band: the frequency responses of the "
        "reduced model against those of the full one, from all inputs to all outputs of one kind each.</p>\n"
        f"{lines}\n<table><tr>{head}</tr>\n{rows}</table>\n"
        f'<p><img src="{escape(plot)}" alt="error over frequency"></p></body></html>\n'
    )


def certificate_plot(certificate: Certificate) -> bytes:
    """error(f) of each pair of kinds, as a PNG picture."""
    from matplotlib.figure import Figure  # half a second that other commands need not wait

    high = max(4.5, 0.2 * len(certificate.comparisons))  # the legend has a line for each
    figure = Figure(figsize=(9.0, high), layout="constrained")
    axes = figure.subplots()
    for c in certificate.comparisons:
        axes.semilogy(certificate.frequency, c.error, label=f"{c.output} per {c.input}", linewidth=1.2)
    axes.axhline(certificate.tolerance, color="black", linestyle="--", linewidth=1.0, label="tolerance")
    axes.set_xlim(certificate.band)
    axes.set_xlabel("frequency / Hz")
    axes.set_ylabel("error / peak of the response")
    axes.grid(alpha=0.3)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.02), fontsize="small", frameon=False)
    picture = io.BytesIO()
    figure.savefig(picture, format="png", dpi=100)
    return picture.getvalue()


def certificate_files(certificate: Certificate) -> Mapping[str, bytes]:
    """What goes into the FMU, by its name in the archive."""
    text = json.dumps(certificate_object(certificate), indent=1)
    return {
        f"{FOLDER}/certificate.json": f"{text}\n".encode(),
        "documentation/accuracy.html": certificate_html(certificate, "accuracy.png").encode(),
        "documentation/accuracy.png": certificate_plot(certificate),
    }


def _cells(c: Comparison) -> tuple[str, ...]:
    output, by = c.pair
    return (
        f"{c.output} per {c.input}",
        f"{c.peak:.4g} {c.unit}",
        percent(c.largest),
        f"{c.worst_frequency:.4g}",
        f"{output} per {by}: {c.deviation:.2g} of {c.size:.2g} {c.unit}",
        "–" if c.static is None else percent(c.static),
        f"{c.holds_to:.4g}",
    )
