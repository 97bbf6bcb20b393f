"""The seam: what is written is what is read, and nothing damaged is used."""

from pathlib import Path

import numpy as np
import pytest
from examples import everything, two_ports

from fmu_src.runtime.errors import ModelError
from fmu_src.runtime.model import Port, ReducedModel
from fmu_src.runtime.resources import read_model, write_model


def written(model: ReducedModel, folder: Path) -> Path:
    for name, content in write_model(model).items():
        (folder / name).write_bytes(content)
    return folder


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return written(two_ports(), tmp_path)


@pytest.mark.parametrize("model", [two_ports(), everything()], ids=["plain", "everything"])
def test_round_trip_is_exact(tmp_path: Path, model: ReducedModel) -> None:
    back = read_model(written(model, tmp_path))
    for key in ("lam", "D_rest", "B", "C", "R", "R_in"):
        np.testing.assert_array_equal(getattr(back, key), getattr(model, key))
    for key in ("name", "description", "alpha", "beta", "ports", "initial", "residual"):
        assert getattr(back, key) == getattr(model, key)


def test_anyone_can_open_the_arrays(folder: Path) -> None:
    lam = np.load(folder / "lam.npy", allow_pickle=False)
    assert lam.dtype.str == "<f8"
    np.testing.assert_array_equal(lam, two_ports().lam)


@pytest.mark.parametrize(
    "name", ["model.json", "model.sha256", "lam.npy", "B.npy", "C.npy", "D_rest.npy", "R.npy", "R_in.npy"]
)
def test_missing_and_cut_files(folder: Path, name: str) -> None:
    content = (folder / name).read_bytes()
    (folder / name).write_bytes(content[: len(content) // 2])
    with pytest.raises(ModelError, match=name.split(".")[0]):
        read_model(folder)
    (folder / name).unlink()
    with pytest.raises(ModelError, match="cannot be read"):
        read_model(folder)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("B.npy", r"B\.npy: its checksum is not that of model\.json"),
        ("model.json", r"model\.json: its checksum is not that of model\.sha256"),
        ("model.sha256", r"model\.json: its checksum is not that of model\.sha256"),
    ],
)
def test_flipped_bit(folder: Path, name: str, message: str) -> None:
    content = bytearray((folder / name).read_bytes())
    content[-3] ^= 1
    (folder / name).write_bytes(bytes(content))
    with pytest.raises(ModelError, match=message):
        read_model(folder)


DRIVEN = {
    "ports": (Port("tip", ("motion.x",), ("displacement.x",)),),
    "M_s": np.ones((1, 1)),
    "K_s": np.ones((1, 1)),
}


def build(**changes: object) -> ReducedModel:
    r = 2
    given = {
        "name": "part",
        "description": "",
        "lam": np.array([0.0, 4.0]),
        "alpha": 0.0,
        "beta": 0.0,
        "D_rest": np.zeros((r, r)),
        "B": np.ones((r, 1)),
        "C": np.ones((1, r)),
        "R": np.zeros((1, 1)),
        "R_in": np.zeros((1, 1)),
        "ports": (Port("tip", ("force.x",), ("displacement.x",)),),
    }
    return ReducedModel(**{**given, **changes})  # type: ignore[arg-type]  # wrong types are the point


NOTHING = {
    "ports": (),
    "B": np.zeros((2, 0)),
    "C": np.zeros((0, 2)),
    "R": np.zeros((0, 0)),
    "R_in": np.zeros((0, 0)),
}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"B": np.ones((2, 2))}, "B: got"),
        ({"C": np.ones((2, 2))}, "C: got"),
        ({"lam": np.array([4.0, 0.0])}, "ascending"),
        ({"lam": np.array([-1e-3, 4.0])}, "≥ 0"),
        ({"lam": np.array([0.0, np.nan])}, "finite"),
        ({"D_rest": np.array([[1.0, 0.5], [0.4, 1.0]])}, "symmetric"),
        ({"R": np.zeros((2, 1))}, "R: got"),
        ({"R": np.full((1, 1), np.inf)}, "finite"),
        ({"R_in": np.zeros((1, 2))}, "R_in: got"),
        ({"initial": "static"}, "rigid"),
        ({"name": "1st"}, "identifier"),
        (
            {"ports": (Port("tip", ("force.x", "force.x"), ("displacement.x",)),), "B": np.ones((2, 2))},
            "twice",
        ),
        ({"lam": np.array([0, 4])}, "lam: got int"),
        ({"D_rest": np.diag([0.0, -1.0])}, "diagonal"),
        ({"alpha": np.inf}, "alpha"),
        ({"ports": (Port("tip", (), ("displacement.x",)), Port("tip", ("force.x",), ()))}, "unique"),
        ({"ports": (Port("a b", ("force.x",), ("displacement.x",)),)}, "identifier"),
        (NOTHING, "no inputs and outputs"),
        ({"description": "\ud800"}, "XML"),
        ({"ports": (Port("tip", ("motion.x",), ("displacement.x",)),)}, "M_s: got"),
        ({"M_s": np.ones((1, 1))}, "M_s: got"),
        (DRIVEN | {"B": np.ones((2, 1))} | {"lam": np.array([1.0, 4.0])}, "lam: expected 0 for the first 1"),
        (DRIVEN | {"B": np.zeros((2, 1))}, "B: expected in the first 1 rows"),
        (
            DRIVEN
            | {"lam": np.zeros(1), "B": np.ones((1, 1)), "C": np.ones((1, 1)), "D_rest": np.zeros((1, 1))},
            "got 0 modes",
        ),
        (DRIVEN | {"M_s": -np.ones((1, 1))}, "M_s: expected"),
        (DRIVEN | {"initial": "static", "lam": np.zeros(2)}, "rigid"),
        ({"ports": (Port("tip", ("heat",), ("displacement.x",)),)}, "heat"),
        ({"ports": (Port("gravity", ("force.x",), ("displacement.x",)),)}, "expected one of x, y, z"),
        ({"ports": (Port("tip", ("force.x",), ("kinetic",)),)}, "kinetic"),
        ({"ports": (Port("energy", ("force.x",), ("kinetic",)),)}, "expected one of none"),
    ],
)
def test_inconsistent_models_are_refused(changes: dict[str, object], message: str) -> None:
    with pytest.raises(ModelError, match=message):
        build(**changes)
    build()
    assert build(**DRIVEN, initial="static").r == 1


def test_damping_ratio_has_no_nan() -> None:
    model = build()
    np.testing.assert_allclose(model.damping_ratio(0.4, 0.1), [0.0, (0.4 + 0.4) / 4], rtol=1e-15)
