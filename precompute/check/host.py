"""The callbacks of a master that watches: what is logged, and what becomes of the memory it hands out.

Every block of memory has a guard on both sides; nothing of the host is trusted to the FMU.
"""

import ctypes
from ctypes import c_char_p, c_int, c_size_t, c_void_p
from dataclasses import dataclass, field

GUARD = bytes(range(0xA0, 0xB0)) * 2  # 32 bytes: keeps the alignment of 16 that malloc gives
LIMIT = 1 << 31  # bytes that are handed out at once

Logger = ctypes.CFUNCTYPE(
    None, c_void_p, c_char_p, c_int, c_char_p, c_char_p
)  # arguments of the message unread
Allocate = ctypes.CFUNCTYPE(c_void_p, c_size_t, c_size_t)
Release = ctypes.CFUNCTYPE(None, c_void_p)


class Callbacks(ctypes.Structure):
    """fmi2CallbackFunctions"""

    _fields_ = (
        ("logger", Logger),
        ("allocate", Allocate),
        ("release", Release),
        ("step_finished", c_void_p),
        ("environment", c_void_p),
    )


@dataclass(frozen=True)
class Message:
    """One call of the logger."""

    environment: int | None
    instance: str
    status: int
    category: str | None
    text: str


@dataclass
class Host:
    """log: what the FMU said; misuse: what it did wrong with the host's memory; allocations: their number."""

    log: list[Message] = field(default_factory=list)
    misuse: list[str] = field(default_factory=list)
    allocations: int = 0
    _blocks: dict[int, "ctypes.Array[ctypes.c_char]"] = field(default_factory=dict)

    def callbacks(self, *, memory: bool = True, environment: int | None = None) -> Callbacks:
        """To be kept as long as the instance lives; memory: with allocateMemory and freeMemory."""
        return Callbacks(
            Logger(self._note),
            Allocate(self._allocate) if memory else Allocate(),
            Release(self._release) if memory else Release(),
            None,
            environment,
        )

    @property
    def held(self) -> int:
        """Bytes handed out and not given back."""
        return sum(len(block) - 2 * len(GUARD) for block in self._blocks.values())

    def inspect(self) -> None:
        """Look at the guards of all blocks that are out."""
        for address in self._blocks:
            self._look(address)

    def _note(
        self,
        environment: int | None,
        name: bytes | None,
        status: int,
        category: bytes | None,
        text: bytes | None,
    ) -> None:
        said = _text(text).replace("%%", "%").replace("##", "#")
        self.log.append(
            Message(environment, _text(name), status, None if category is None else _text(category), said)
        )

    def _allocate(self, count: int, size: int) -> int | None:
        self.allocations += 1
        if count * size > LIMIT:
            self.misuse.append(f"asked for {count} × {size} bytes")
            return None
        block = ctypes.create_string_buffer(count * size + 2 * len(GUARD))
        _guard(block)
        address = ctypes.addressof(block) + len(GUARD)
        self._blocks[address] = block
        return address

    def _release(self, address: int | None) -> None:
        if address is None:
            return
        if address not in self._blocks:
            self.misuse.append("freeMemory got a pointer that allocateMemory did not give, or got it twice")
            return
        self._look(address)
        del self._blocks[address]

    def _look(self, address: int) -> None:
        block = self._blocks[address]
        raw = block.raw
        if not (raw.startswith(GUARD) and raw.endswith(GUARD)):
            size = len(block) - 2 * len(GUARD)
            side = "before" if not raw.startswith(GUARD) else "behind"
            self.misuse.append(f"wrote {side} a block of {size} bytes")
            _guard(block)


def overwrite(buffer: "ctypes.Array[ctypes.c_char]", place: int, content: bytes) -> None:
    """Bytes into a buffer."""
    ctypes.memmove(ctypes.addressof(buffer) + place, content, len(content))


def _guard(block: "ctypes.Array[ctypes.c_char]") -> None:
    overwrite(block, 0, GUARD)
    overwrite(block, len(block) - len(GUARD), GUARD)


def _text(raw: bytes | None) -> str:
    return "" if raw is None else raw.decode(errors="replace")
