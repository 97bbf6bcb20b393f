"""[basis], [modes], [accuracy]: which reduced model, and how near to the full one."""

from typing import Annotated, Any, Literal, Self, TypeAlias

from pydantic import Field, PlainValidator, model_validator

from .part_values import BAND, Band, FilePath, Hertz, Number, Seconds
from .toml_table import Table, exactly_one, mistake, shown

Kind: TypeAlias = Literal["modal", "polynomial", "craig-bampton", "krylov", "file"]
Share: TypeAlias = Annotated[Number, Field(ge=1e-9, lt=1)]

OWN_KEYS: dict[str, Kind] = {"order": "polynomial", "frequency": "krylov", "file": "file"}
FORMS = ("count", "max_frequency", "step", "error")
FORMS_OF: dict[Kind, tuple[str, ...]] = {
    "modal": FORMS,
    "polynomial": FORMS[:3],
    "craig-bampton": FORMS[:3],
    "krylov": FORMS[:1],
    "file": FORMS[:3],
}


def _residual(value: Any) -> Any:
    if value is not True and value is not False and value != "modes":
        raise ValueError(value)
    return value


class Basis(Table):
    """[basis]: the subspace in which the part deforms; each of its other keys belongs to one kind."""

    kind: Kind = Field(
        default="modal",
        description='"modal", "polynomial", "craig-bampton", "krylov" or "file"',
        examples=['kind = "craig-bampton"'],
    )
    order: Annotated[int, Field(strict=True, ge=0, le=2)] | None = Field(
        default=None,
        description="the order of the polynomials: 0 (rigid), 1 (linear strain) or 2 (quadratic strain)",
        examples=["order = 2"],
    )
    frequency: Annotated[Number, Field(ge=0, le=1e12)] = Field(
        default=0.0,
        description="the frequency in Hz around which the basis is exact, ≥ 0 (up to 1e12)",
        examples=["frequency = 100.0"],
    )
    file: FilePath | None = Field(
        default=None,
        description="the path of a .npy file with one column per vector, relative to the part file",
        examples=['file = "U.npy"'],
    )

    @model_validator(mode="after")
    def _keys_of_the_kind(self) -> Self:
        for key, kind in OWN_KEYS.items():
            if key in self.model_fields_set and kind != self.kind:
                words = f'got {shown(getattr(self, key))} with kind = "{self.kind}", expected it with'
                raise mistake(f'{words} kind = "{kind}" alone; remove it, or write kind = "{kind}"', key)
            if kind == self.kind and getattr(self, key) is None:
                field = type(self).model_fields[key]
                assert field.examples
                words = f'missing, kind = "{kind}" needs it: expected {field.description}'
                raise mistake(f"{words}; write e.g. {field.examples[0]}", key)
        return self


class ModeChoice(Table):
    """[modes]: the lowest `count` modes, or all with f ≤ `max_frequency` (Hz), or as many as `error` needs.

    A communication step h = `step` (s) samples what is slower than its Nyquist frequency:
    max_frequency = 1/(2h). `error` is the largest error of the port-to-port frequency responses over
    `band` (Hz), relative to their peak; residual vectors go with it where `residual` does not say otherwise.
    With the basis "craig-bampton" the choice is one of fixed-interface modes, with "krylov" of vectors.
    """

    count: Annotated[int, Field(strict=True, ge=0)] | None = Field(
        default=None,
        description="a whole number of modes ≥ 1 (of Craig–Bampton ≥ 0)",
        examples=["count = 20"],
    )
    max_frequency: Hertz | None = Field(
        default=None,
        description="a frequency > 0 in Hz (1e-9 to 1e12)",
        examples=["max_frequency = 2000.0"],
    )
    step: Seconds | None = Field(
        default=None, description="a step size > 0 in s (1e-12 to 1e9)", examples=["step = 1e-3"]
    )
    error: Share | None = Field(
        default=None,
        description="the error allowed over the band, a number between 0 and 1 (1 % is 0.01)",
        examples=["error = 0.01"],
    )
    band: Band | None = Field(default=None, description=BAND, examples=["band = [0.0, 500.0]"])
    residual: Annotated[bool | Literal["modes"], PlainValidator(_residual)] = Field(
        default=False, description='true, false or "modes"', examples=["residual = true"]
    )
    initial: Literal["rest", "static"] = Field(
        default="rest", description='"rest" or "static"', examples=['initial = "rest"']
    )

    @model_validator(mode="after")
    def _one_choice(self) -> Self:
        given = [form for form in FORMS if form in self.model_fields_set]
        if given:
            exactly_one(given, ", ".join(FORMS))
        if self.band is not None and self.error is None:
            raise mistake(
                f"got {shown(self.band)} without error, expected both or none; write e.g. error = 0.01",
                "band",
            )
        if self.error is not None and self.band is None:
            raise mistake(f"missing beside error, expected {BAND}; write e.g. band = [0.0, 500.0]", "band")
        update: dict[str, object] = {}
        if self.step is not None:
            update["max_frequency"] = 1 / (2 * self.step)
        if self.error is not None and "residual" not in self.model_fields_set:
            update["residual"] = "modes"
        return self.model_copy(update=update) if update else self

    @property
    def form(self) -> str | None:
        """The key by which the modes are chosen."""
        given = [form for form in FORMS if getattr(self, form) is not None]
        return given[-1] if given else None  # the last: `step` gives max_frequency too


class Accuracy(Table):
    """[accuracy]: the error over `band` (Hz; left out: that of the modes) beyond which the build warns."""

    band: Band | None = Field(default=None, description=BAND, examples=["band = [0.0, 500.0]"])
    tolerance: Share = Field(
        default=0.01,
        description="the error tolerated over the band, a number between 0 and 1 (1 % is 0.01)",
        examples=["tolerance = 0.01"],
    )


def check_choice(modes: ModeChoice, basis: Basis) -> None:
    """Raise unless [modes] chooses in a way that the basis allows.

    Modal and Craig–Bampton bases need a choice, "krylov" needs count; "polynomial" and "file" are kept as
    a whole where there is none. `error` is met by adding modes of the full model, so by a modal basis.
    """
    forms = FORMS_OF[basis.kind]
    expected = f"exactly one of {', '.join(forms)}" if len(forms) > 1 else forms[0]
    if basis.kind != "modal":
        expected += f' with [basis] kind = "{basis.kind}"'
    if modes.form is None and basis.kind not in ("polynomial", "file"):
        raise mistake(f"got none, expected {expected}; add one, e.g. [modes], count = 20", "modes")
    if modes.form is not None and modes.form not in forms:
        raise mistake(f"got {modes.form}, expected {expected}; replace it, e.g. by count = 20", "modes")
    if modes.count == 0 and basis.kind != "craig-bampton":
        raise mistake("got 0, expected a whole number of modes ≥ 1; write e.g. count = 20", "modes", "count")
