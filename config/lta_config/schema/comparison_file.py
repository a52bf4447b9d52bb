"""
The comparison file: the platforms, their manoeuvres, and ablations that explain differences.

Each entry names a vehicle or another entry, and the only differences from it.
"""

from typing import Annotated, Any, Literal, Self

from lta_config.files import find_file, load_file, StrictModel
from lta_config.quantity import Quantity, si_quantity
from pydantic import AliasChoices, Field, model_validator

Name = Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]*$')]
SPEEDS = 40  # limit for one ladder, each speed being a flight


class BlockSubstitution(StrictModel):
    """Blocks that replace the vehicle's own, from another vehicle's file."""

    vehicle: str
    blocks: Annotated[list[Literal['rotors', 'aero', 'thrust_curve']], Field(min_length=1)]


class EntryChange(StrictModel):
    """The differences of an entry: parameters by path, law, gains and blocks, with the reason."""

    changes: Annotated[
        dict[str, Any], Field(default_factory=dict, validation_alias=AliasChoices('set'))
    ]
    law: str | None = None
    gains: str | None = None
    borrow: BlockSubstitution | None = None
    why: str = ''


class Contestant(EntryChange):
    """A platform: its vehicle, its manoeuvres, and its release height if it does not take off."""

    vehicle: str
    title: str
    release: Annotated[Quantity, si_quantity('m', above=0.0, high=100.0)] | None = None
    manoeuvres: list[str] | None = None


class Ablation(EntryChange):
    """A contestant with one change."""

    of: str
    manoeuvres: Annotated[list[str], Field(min_length=1)]


class SpeedSweep(EntryChange):
    """A contestant at increasing speeds."""

    of: str
    manoeuvre: str
    speeds: Quantity


class ComparisonFile(StrictModel):
    """A comparison file."""

    schema_version: Annotated[Literal[1], Field(validation_alias=AliasChoices('schema'))]
    name: Name
    about: str
    scenario: str
    seeds: Annotated[int, Field(ge=1, le=1000)]
    manoeuvres: Annotated[list[str], Field(min_length=1)]
    contestants: Annotated[dict[Name, Contestant], Field(min_length=1)]
    ablations: dict[Name, Ablation] = Field(default_factory=dict)
    limits: dict[Name, SpeedSweep] = Field(default_factory=dict)

    @model_validator(mode='after')
    def _check_references(self) -> Self:
        for kind, entries in (('ablation', self.ablations), ('limit', self.limits)):
            for name, entry in entries.items():
                if entry.of not in self.contestants:
                    names = ', '.join(self.contestants)
                    raise ValueError(
                        f'has the {kind} {name} with "of: {entry.of}", which is not the name of a '
                        f'contestant; known: {names}'
                    )
        for name, limit in self.limits.items():
            speeds = limit.speeds
            # The set also rejects repeated speeds
            rising = list(speeds.vector) == sorted(set(speeds.vector))
            if speeds.dimension != 'm/s' or not rising or len(speeds.vector) > SPEEDS:
                raise ValueError(
                    f'has invalid "speeds" in limits.{name}; give at most {SPEEDS} speeds in m/s, '
                    'in increasing order and without duplicates'
                )
        return self


def load_comparison(name: str) -> ComparisonFile:
    """Return a comparison by shipped name or path; raise `BadInput` if it is invalid."""
    return load_file(ComparisonFile, find_file('comparison', name))
