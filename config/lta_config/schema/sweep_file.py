"""
The sweep file: which flights to fly, with what varied how.

`vary` names any parameter of any file by its path. A list is a grid: every value with every value
of the other lists. A distribution is drawn once a sample: the same draws, and the same seeds, at
every point of the grid, so that its points differ by nothing else.

`cases` are values that belong together, under a name: the grid has every case with every value.
A path of one word is a whole file, or the strategy: `scenario: [lamp_room, windy_field]`.
"""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from lta_config.files import find_file, load_file, StrictModel
from pydantic import AliasChoices, Discriminator, Field, model_validator, Tag

Value = Any  # '4 g', '[0, 0, 1] m/s', {value: 4, unit: g}, 0.5, true, a name
Values = Annotated[list[Value], Field(min_length=1, max_length=10_000)]
CASE = 'case'  # what the names of cases are called where flights are told


class NormalDistribution(StrictModel):
    """Gauss's; drawn again until it lies between `low` and `high` where they are given."""

    mean: Value
    deviation: Value
    low: Value = None
    high: Value = None


class UniformDistribution(StrictModel):
    """From `low` to `high`."""

    low: Value
    high: Value


class Distribution(StrictModel):
    """Exactly one of its keys."""

    normal: NormalDistribution | None = None
    uniform: UniformDistribution | None = None
    loguniform: UniformDistribution | None = None
    choice: Values | None = None

    @model_validator(mode='after')
    def _check_one_kind(self) -> Self:
        given = [name for name in type(self).model_fields if getattr(self, name) is not None]
        if len(given) != 1:
            known = ', '.join(type(self).model_fields)
            raise ValueError(f'names {len(given)} distributions, but needs one of {known}')
        return self


def _classify_variation(how: object) -> str:
    """Return which of the two ways to vary is meant, so that a mistake is told of that one."""
    return 'values' if isinstance(how, list) else 'distribution'


Case = Mapping[str, Value]


class SweepSeeds(StrictModel):
    """Seeds of the flights: so many, counted from the first."""

    first: Annotated[int, Field(ge=0, le=2**30)] = 1
    count: Annotated[int, Field(ge=1, le=10_000_000)] | None = None


class SweepFile(StrictModel):
    """A whole sweep file."""

    schema_version: Annotated[Literal[1], Field(validation_alias=AliasChoices('schema'))]
    name: Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]*$')]
    about: str
    vehicle: str
    scenario: str
    strategy: str
    gains: str
    seeds: SweepSeeds = SweepSeeds()
    samples: Annotated[int, Field(ge=1, le=10_000_000)] | None = None
    settings: Annotated[Mapping[str, Value], Field(validation_alias=AliasChoices('set'))] = {}
    cases: Mapping[Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]*$')], Case] = {}
    vary: Mapping[
        str,
        Annotated[
            Annotated[Values, Tag('values')] | Annotated[Distribution, Tag('distribution')],
            Discriminator(_classify_variation),
        ],
    ] = {}

    @model_validator(mode='after')
    def _check_samples(self) -> Self:
        drawn = [path for path, how in self.vary.items() if isinstance(how, Distribution)]
        if drawn and self.samples is None:
            raise ValueError(f'draws {", ".join(drawn)} but does not say how often; add "samples"')
        if self.samples is not None and self.seeds.count is not None:
            raise ValueError(
                'has both samples and seeds.count; each sample has its own seed, so leave count '
                'out'
            )
        both = sorted(self.vary.keys() & self.settings.keys())
        if both:
            raise ValueError(f'both sets and varies {", ".join(both)}; do one of it')
        cases = {path for case in self.cases.values() for path in case}
        if both := sorted(self.vary.keys() & cases):
            raise ValueError(f'varies {", ".join(both)}, which its cases set; do one of it')
        return self

    @property
    def draws_per_point(self) -> int:
        """Flights at each point of the grid."""
        return self.samples or self.seeds.count or 1


def load_sweep(name: str) -> SweepFile:
    """Return a sweep file by shipped name or path; anything wrong is a `BadInput` sentence."""
    return load_file(SweepFile, find_file('sweep', name))
