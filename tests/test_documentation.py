"""What the FMU says to a reader, and the file it says it in."""

import os
import stat
import zipfile
from pathlib import Path

import numpy as np
from driven import driven
from examples import everything, two_ports

from fmu_src.archive import write_archive
from fmu_src.documentation import external_dependencies, index_html


def test_the_mode_table_has_every_mode_with_its_numbers() -> None:
    model = two_ports()
    mass = {axis: [0.5 * k for k in range(6)] for axis in "xyz"}
    page = index_html(model, mass, 12.5)
    assert "six modes &amp; two ports &lt;test&gt;" in page
    assert page.count("<td>rigid</td>") == 2
    for f in model.frequency:
        assert f"<td>{f:.6g}</td>" in page
    assert page.count("<td>20.0</td>") == 3  # 2.5 of 12.5 kg in the last mode
    assert "12.5 kg" in page
    assert "left" in page
    assert "effective mass" not in index_html(model)


def test_damping_that_no_alpha_and_beta_tell_is_said() -> None:
    assert "s and ratios of their own." in index_html(two_ports())
    assert "s and damping that couples modes." in index_html(everything())
    plain = index_html(two_ports(D_rest=np.zeros((6, 6))))
    assert "&beta; = 0.001 s. Each mode" in plain


def test_what_the_modes_leave_held_is_said() -> None:
    page = index_html(driven(k=2))
    assert "of 6 modes" in page
    assert "of the part with left.motion.y, left.angular_motion.z held. Each mode" in page
    assert "held" not in index_html(everything())


def test_accuracy_and_reference_results_have_a_link_where_they_are_there() -> None:
    assert 'href="accuracy.html"' in index_html(two_ports(), accuracy="accuracy.html")
    assert 'href="results.txt"' in index_html(two_ports(), references="results.txt")
    assert "href" not in index_html(two_ports())


def test_the_host_is_told_what_it_needs() -> None:
    text = external_dependencies()
    for word in ("Python  3.11", "numpy   1.24", "glibc   2.32", "LD_PRELOAD", "PYTHONHOME"):
        assert word in text


def test_the_archive_depends_on_its_content_only(tmp_path: Path) -> None:
    path = tmp_path / "one.fmu"
    before = os.umask(0o027)
    try:
        write_archive(path, {"b": b"2", "a": b"1"})
    finally:
        os.umask(before)
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    with zipfile.ZipFile(path) as archive:
        entries = archive.infolist()
    assert [e.filename for e in entries] == ["a", "b"]
    for entry in entries:
        assert entry.date_time == (1980, 1, 1, 0, 0, 0)
        assert entry.external_attr >> 16 == stat.S_IFREG | 0o644
        assert entry.compress_type == zipfile.ZIP_DEFLATED
