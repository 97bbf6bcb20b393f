"""The keys and values of a TOML file."""

import re
import tomllib
from pathlib import Path
from typing import Any

from .errors import PartError


def read_toml(path: Path) -> dict[str, Any]:
    """The tables of the file `path`; a byte order mark and Windows line ends are fine.

    Raises PartError, one line with the line number where there is one, if the file cannot be read,
    is not UTF-8 or is not TOML.
    """
    text = _text(path)
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise PartError(
            f"{path}: got brackets nested too deeply, expected plain lists; remove some"
        ) from None
    except tomllib.TOMLDecodeError as error:
        raise PartError(f"{path}: {_syntax(text, str(error))}") from None
    except ValueError:  # Python's limit for integers
        raise PartError(f"{path}: got an integer of thousands of digits, expected less; shorten it") from None


def _text(path: Path) -> str:
    try:
        raw = path.read_bytes()
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        reason = getattr(error, "strerror", None) or error
        raise PartError(
            f"{path}: cannot be read ({reason}); expected a part file or its folder; check the path"
        ) from None
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        got = f"byte 0x{raw[error.start]:02x}"
        raise PartError(f"{path}: line {line}: got {got}, expected UTF-8; save the file as UTF-8") from None


def _syntax(text: str, reason: str) -> str:
    """`reason` of tomllib as "line 3, column 7: got 'the line' (reason), expected …; how to mend it"."""
    lines = text.split("\n")
    place = re.search(r" \((?:at line (\d+), column (\d+)|at end of document)\)$", reason)
    if place is None:
        where, got = "not valid TOML", "text"
    elif place[1] is None:
        where, got = f"line {len(lines)}", "the end of the file"
    else:
        where, got = f"line {place[1]}, column {place[2]}", repr(lines[int(place[1]) - 1].strip()[:60])
    why = reason[: place.start()] if place else reason
    return (
        f"{where}: got {got} ({why[:1].lower()}{why[1:]}), expected TOML such as "
        '[part], key = 1.0, key = "text" or key = ["x", "y"]; mend that line'
    )
