"""The whole of a part file: its tables, keys as in TOML."""

from collections.abc import Iterator, Sequence
from typing import Self

from pydantic import Field, model_validator

from .damping_table import DampingForm
from .load_tables import Dashpot, Link, Loads, Mass, PortElement, Spring
from .mode_tables import Accuracy, Basis, ModeChoice, check_choice
from .part_rules import (
    Reference,
    check_materials,
    check_motions,
    check_names,
    check_ports,
    check_source,
    check_variables,
)
from .part_tables import Heading, Material, Support, SystemTable
from .part_values import LengthUnit
from .port_tables import Energy, Pair, Port
from .toml_table import Table


class PartFile(Table):
    """Tables that are right one by one, then together."""

    part: Heading = Field(
        description="one table [part] with name, mesh and length_unit",
        examples=['[part], name = "cantilever"'],
    )
    material: tuple[Material, ...] = Field(
        default=(),
        description="tables [[material]] (two brackets)",
        examples=['[[material]], name = "steel"'],
    )
    system: SystemTable | None = Field(
        default=None,
        description="one table [system] with stiffness and mass",
        examples=['[system], stiffness = "K.mtx", mass = "M.mtx"'],
    )
    support: tuple[Support, ...] = Field(
        default=(),
        description="tables [[support]] (two brackets)",
        examples=['[[support]], at = "clamp", fix = ["x", "y", "z"]'],
    )
    port: tuple[Port, ...] = Field(
        default=(), description="tables [[port]] (two brackets)", examples=['[[port]], name = "tip"']
    )
    pair: tuple[Pair, ...] = Field(
        default=(),
        description="tables [[pair]] (two brackets)",
        examples=['[[pair]], ports = ["root", "tip"]'],
    )
    loads: Loads = Field(
        default=Loads(),
        description="one table [loads] with gravity and base",
        examples=["[loads], gravity = true"],
    )
    spring: tuple[Spring, ...] = Field(
        default=(), description="tables [[spring]] (two brackets)", examples=['[[spring]], port = "tip"']
    )
    dashpot: tuple[Dashpot, ...] = Field(
        default=(), description="tables [[dashpot]] (two brackets)", examples=['[[dashpot]], port = "tip"']
    )
    mass: tuple[Mass, ...] = Field(
        default=(), description="tables [[mass]] (two brackets)", examples=['[[mass]], port = "tip"']
    )
    energy: Energy = Field(
        default=Energy(),
        description="one table [energy] with outputs",
        examples=['[energy], outputs = ["kinetic", "strain"]'],
    )
    basis: Basis = Field(
        default=Basis(), description="one table [basis] with kind", examples=['[basis], kind = "modal"']
    )
    modes: ModeChoice = Field(
        default=ModeChoice(),
        description="one table [modes] with count, max_frequency, step, or error and band",
        examples=["[modes], count = 20"],
    )
    damping: DampingForm = Field(
        default=DampingForm(alpha=0.0, beta=0.0),
        description="one table [damping] with alpha and beta, ratio, ratios, table or structural",
        examples=["[damping], ratio = 0.02"],
    )
    accuracy: Accuracy | None = Field(
        default=None,
        description="one table [accuracy] with band and tolerance",
        examples=["[accuracy], band = [0.0, 500.0], tolerance = 0.01"],
    )

    @model_validator(mode="after")
    def _together(self) -> Self:
        check_source(self.part, self.material, self.system, self.support)
        check_materials(self.material, self.damping)
        check_names(self.port, self.pair, self.support)
        check_variables(self.port, self.support, self.loads, self.energy, self.system)
        check_ports(self.port, self._references())
        check_choice(self.modes, self.basis)
        check_motions(self.port, self.basis)
        return self

    def _references(self) -> Iterator[Reference]:
        for k, pair in enumerate(self.pair):
            yield from ((name, ("pair", k, "ports", i)) for i, name in enumerate(pair.ports))
        elements: dict[str, Sequence[PortElement]]
        elements = {"spring": self.spring, "dashpot": self.dashpot, "mass": self.mass}
        for table, items in elements.items():
            for k, item in enumerate(items):
                yield item.port, (table, k, "port")
                if isinstance(item, Link) and item.to is not None:
                    yield item.to, (table, k, "to")

    @property
    def length_unit(self) -> LengthUnit:
        """Of coordinates: the mesh's or, where no unit is given, the matrices'."""
        if self.part.length_unit is not None:
            return self.part.length_unit
        assert self.system is not None  # a mesh has its unit
        return self.system.units.length
