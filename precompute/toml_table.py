"""One table of a TOML file, which tells mistakes in the words of its own fields.

A field's description says what is expected there and its first example how to write it, so that the
declaration of a key and the message about a wrong one cannot drift apart:

    part.toml: material[1].poisson: got 0.5, expected Poisson's ratio, ...; write e.g. poisson = 0.3

Elements of arrays are counted from 1.
"""

import difflib
import json
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Self, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, ValidationError, model_validator
from pydantic.functional_validators import ModelWrapValidatorHandler
from pydantic_core import ErrorDetails, InitErrorDetails, PydanticCustomError

from .errors import PartError

_MISTAKE = "mistake"  # types of errors that are already in words
_UNKNOWN_KEY = "unknown_key"
_UNKNOWN_TEXT = "unknown_text"


class Table(BaseModel):
    """Frozen; every field has a description, required ones an example too; unknown keys are mistakes."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    @model_validator(mode="wrap")
    @classmethod
    def _tell_mistakes(cls, data: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        try:
            return handler(data)
        except ValidationError as error:
            if not isinstance(data, Mapping):
                raise  # no table at all: the table around this one says what it expects here
            raise ValidationError.from_exception_data(
                cls.__name__, [_in_words(cls, details) for details in error.errors()]
            ) from None


TableType = TypeVar("TableType", bound=Table)
Item = TypeVar("Item")


def validated(table: type[TableType], data: dict[str, Any], path: Path) -> TableType:
    """`data`, read from the file `path`, as `table`; PartError tells the first mistake in one line.

    The context of the validation is the file's folder.
    """
    try:
        return table.model_validate(data, context=path.absolute().parent)
    except ValidationError as error:
        # An unknown key goes first: misspelt, it also makes the right one missing.
        mistakes = sorted(error.errors(), key=lambda details: details["type"] != _UNKNOWN_KEY)
        first = ": ".join(filter(None, [str(path), _key_path(mistakes[0]["loc"]), mistakes[0]["msg"]]))
        more = f" (and {len(mistakes) - 1} more)" if len(mistakes) > 1 else ""
        raise PartError(" ".join(first.splitlines()) + more) from None


def mistake(words: str, *place: str | int) -> ValidationError:
    """To be raised by a validator: `words` about the key at `place`, relative to what it validates."""
    return ValidationError.from_exception_data(_MISTAKE, [_details(_MISTAKE, words, place)])


def shown(value: object) -> str:
    """`value` much as TOML writes it, at most 60 characters."""
    try:
        text = json.dumps(value, ensure_ascii=False, default=str)
    except (ValueError, RecursionError):  # an integer of thousands of digits, tables in tables in tables
        return "a value too large to show"
    return text if len(text) <= 60 else text[:57] + "..."


def nearest(word: str, known: Iterable[str]) -> str:
    """The one of `known`, of which there is one at least, that `word` was probably meant to be."""
    # The cutoff 0 always finds one; a word of more than 40 characters is no slip of the pen.
    return difflib.get_close_matches(word[:40].lower(), known, n=1, cutoff=0.0)[0]


def not_empty(items: tuple[Item, ...]) -> tuple[Item, ...]:
    """Raise for an empty list; unlike pydantic's min_length, only for what was empty in the file."""
    if not items:
        raise ValueError(items)
    return items


def one_of(known: Sequence[str]) -> AfterValidator:
    """The validator of a text that must be one of `known`; the nearest of them is named where it is not."""

    def check(text: str) -> str:
        if text not in known:
            raise PydanticCustomError(_UNKNOWN_TEXT, "unknown text", {"known": known})
        return text

    return AfterValidator(check)


def exactly_one(given: list[str], known: str) -> None:
    """Raise unless one key of `known` is given; several keys that go together count as one."""
    if len(given) != 1:
        got = " and ".join(given) or "none"
        mend = "remove the others" if given else "add one"
        raise mistake(f"got {got}, expected exactly one of {known}; {mend}")


def _in_words(table: type[Table], error: ErrorDetails) -> InitErrorDetails:
    kind, place, got = error["type"], error["loc"], error["input"]
    if kind in (_MISTAKE, _UNKNOWN_KEY):
        return _details(kind, error["msg"], place)
    key = str(place[0])
    fields = {field.alias or name: field for name, field in table.model_fields.items()}
    if kind == "extra_forbidden":
        return _details(_UNKNOWN_KEY, _unknown(key, list(fields)), place)
    field = fields[key]
    words = f"{'missing' if kind == 'missing' else f'got {shown(got)}'}, expected {field.description}"
    if isinstance(got, str) and kind in ("float_type", "int_type"):
        words += "; remove the quotes"
    elif kind == _UNKNOWN_TEXT:
        words += f"; did you mean {nearest(got, error['ctx']['known'])}?"
    elif field.examples:
        words += f"; write e.g. {field.examples[0]}"
    return _details(_MISTAKE, words, place)


def _unknown(key: str, known: list[str]) -> str:
    return f"unknown key, expected one of {', '.join(known)}; did you mean {nearest(key, known)}?"


def _details(kind: str, words: str, place: tuple[str | int, ...]) -> InitErrorDetails:
    # Words travel as context: braces in a template would be taken as its fields.
    told = PydanticCustomError(kind, "{words}", {"words": words})
    return InitErrorDetails(type=told, loc=place, input=None)


def _key_path(place: tuple[str | int, ...]) -> str:
    path = ""
    for step in place:
        if isinstance(step, int):
            path += f"[{step + 1}]"
        else:
            path += ("." if path else "") + (step if re.fullmatch(r"[\w-]{1,60}", step) else shown(step))
    return path
