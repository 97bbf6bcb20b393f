"""A table of a system: its components and where their inputs come from."""

from rich.table import Table

from .ssp_package import Package


def system_table(package: Package) -> Table:
    """A row per connection: where a value comes from, where it goes, in which unit, by which formula."""
    table = Table("from", "to", "unit", "as it is, or converted", title=package.file.system.name)
    for wire in package.wires:
        unit = "" if wire.unit is None else wire.unit.name
        formula = "" if wire.is_plain else f"{wire.factor:g} · value + {wire.offset:g}"
        table.add_row(str(wire.source), str(wire.target), unit, formula)
    return table
