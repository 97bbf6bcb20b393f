"""The names that a library exports, by the tables of its format."""

import struct
from collections.abc import Iterator

LINKER = ("__dso_handle", "_mh_dylib_header")  # zig's linker marks the beginning of a Mach-O file by them


def exports(library: bytes) -> list[set[str]]:
    """One set per processor of the library: ELF, PE, Mach-O, or several Mach-O in one."""
    if library[:4] == b"\x7fELF":
        return [set(_elf(library))]
    if library[:2] == b"MZ":
        return [set(_pe(library))]
    if library[:4] == b"\xca\xfe\xba\xbe":
        count = struct.unpack_from(">I", library, 4)[0]
        parts = [struct.unpack_from(">IIIII", library, 8 + 20 * k) for k in range(count)]
        assert all(offset % 2**align == 0 for _, _, offset, _, align in parts)
        return [set(_macho(library[offset : offset + size])) for _, _, offset, size, _ in parts]
    return [set(_macho(library))]


def _name(table: bytes, offset: int) -> str:
    return table[offset : table.index(b"\0", offset)].decode()


def _elf(library: bytes) -> Iterator[str]:
    """Entries of .dynsym that have a section (System V ABI, 64 bit)."""
    table, width, count = (*struct.unpack_from("<Q", library, 40), *struct.unpack_from("<HH", library, 58))
    sections = [struct.unpack_from("<IIQQQQIIQQ", library, table + k * width) for k in range(count)]
    for _, kind, _, _, offset, size, link, _, _, entry in sections:
        if kind == 11:  # SHT_DYNSYM
            names = library[sections[link][4] :]
            for place in range(offset, offset + size, entry):
                name, _, _, section = struct.unpack_from("<IBBH", library, place)
                if section != 0:
                    yield _name(names, name)


def _pe(library: bytes) -> Iterator[str]:
    """The export directory (Microsoft, PE format, PE32+)."""
    header = struct.unpack_from("<I", library, 60)[0]
    count, optional = struct.unpack_from("<H", library, header + 6)[0], header + 24
    first = optional + struct.unpack_from("<H", library, header + 20)[0]
    sections = [struct.unpack_from("<IIII", library, first + 40 * k + 8) for k in range(count)]

    def offset(address: int) -> int:
        return next(
            raw + address - start for _, start, size, raw in sections if start <= address < start + size
        )

    directory = offset(struct.unpack_from("<I", library, optional + 112)[0])
    number, _, names = struct.unpack_from("<III", library, directory + 24)
    for k in range(number):
        yield _name(library, offset(struct.unpack_from("<I", library, offset(names) + 4 * k)[0]))


def _macho(library: bytes) -> Iterator[str]:
    """What the export trie of LC_DYLD_INFO_ONLY spells (Apple, mach-o/loader.h)."""
    assert library[:4] == b"\xcf\xfa\xed\xfe"
    place = 32
    for _ in range(struct.unpack_from("<I", library, 16)[0]):
        command, size = struct.unpack_from("<II", library, place)
        if command == 0x80000022:
            offset, length = struct.unpack_from("<II", library, place + 40)
            names = _spelled(library[offset : offset + length], 0, "")
            yield from (name for name in names if name not in LINKER)
        place += size


def _spelled(trie: bytes, place: int, prefix: str) -> Iterator[str]:
    """A node: the length of what it exports, if anything, then branches: letters and the place of a node."""
    terminal, place = _uleb128(trie, place)
    if terminal:
        yield prefix.removeprefix("_")
    place += terminal + 1
    for _ in range(trie[place - 1]):
        letters = _name(trie, place)
        node, place = _uleb128(trie, place + len(letters) + 1)
        yield from _spelled(trie, node, prefix + letters)


def _uleb128(content: bytes, place: int) -> tuple[int, int]:
    """Seven bits a byte, the lowest first; the number and the place behind it."""
    value = shift = 0
    while True:
        byte = content[place]
        value |= (byte & 0x7F) << shift
        place, shift = place + 1, shift + 7
        if byte < 0x80:
            return value, place
