"""
The comparison file: who flies which manoeuvres, and what is changed to see why.

Every entry names a vehicle or another entry, and what is different; nothing else differs.
"""

from typing import Annotated, Any, Literal, Self

from lta_config.files import find_file, load_file, StrictModel
from lta_config.quantity import Quantity, si_quantity
from pydantic import AliasChoices, Field, model_validator

Name = Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]*$')]
SPEEDS = 40  # at most


class BlockSubstitution(StrictModel):
    """Blocks of another vehicle's file, taken instead of the vehicle's own."""

    vehicle: str
    blocks: Annotated[list[Literal['rotors', 'aero', 'thrust_curve']], Field(min_length=1)]


class EntryChange(StrictModel):
    """What an entry does otherwise: parameters by path, law and gains, blocks; and why."""

    changes: Annotated[
        dict[str, Any], Field(default_factory=dict, validation_alias=AliasChoices('set'))
    ]
    law: str | None = None
    gains: str | None = None
    borrow: BlockSubstitution | None = None
    why: str = ''


class Contestant(EntryChange):
    """One that flies: a vehicle, where it is released if not from the floor, and what it flies."""

    vehicle: str
    title: str
    release: Annotated[Quantity, si_quantity('m', above=0.0, high=100.0)] | None = None
    manoeuvres: list[str] | None = None


class Ablation(EntryChange):
    """A contestant with one thing changed."""

    of: str
    manoeuvres: Annotated[list[str], Field(min_length=1)]


class SpeedLadder(EntryChange):
    """A contestant asked for one speed after the other."""

    of: str
    manoeuvre: str
    speeds: Quantity


class ComparisonFile(StrictModel):
    """A whole comparison file."""

    schema_version: Annotated[Literal[1], Field(validation_alias=AliasChoices('schema'))]
    name: Name
    about: str
    scenario: str
    seeds: Annotated[int, Field(ge=1, le=1000)]
    manoeuvres: Annotated[list[str], Field(min_length=1)]
    contestants: Annotated[dict[Name, Contestant], Field(min_length=1)]
    ablations: dict[Name, Ablation] = Field(default_factory=dict)
    limits: dict[Name, SpeedLadder] = Field(default_factory=dict)

    @model_validator(mode='after')
    def _check_references(self) -> Self:
        for kind, entries in (('ablation', self.ablations), ('limit', self.limits)):
            for name, entry in entries.items():
                if entry.of not in self.contestants:
                    known = ', '.join(self.contestants)
                    raise ValueError(
                        f'has the {kind} {name} of {entry.of}, which is no contestant; known: '
                        f'{known}'
                    )
        for name, limit in self.limits.items():
            speeds = limit.speeds
            rising = list(speeds.vector) == sorted(set(speeds.vector))
            if speeds.dimension != 'm/s' or not rising or len(speeds.vector) > SPEEDS:
                raise ValueError(
                    f'has speeds of the limit {name} that are not at most {SPEEDS} rising numbers '
                    'in m/s'
                )
        return self


def load_comparison(name: str) -> ComparisonFile:
    """Return a comparison by shipped name or path; anything wrong is a `BadInput` sentence."""
    return load_file(ComparisonFile, find_file('comparison', name))
