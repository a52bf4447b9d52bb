# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The sweep file: a set of flights and how their parameters vary.

`vary` names parameters of any file by path. Lists form a grid of all combinations. A distribution
is drawn once per sample, with the same draws and seeds at every point of the grid, so that the
points differ in nothing else.

`cases` are named groups of values that belong together; the grid combines each case with all
values. A path of one word is a whole file or the strategy: `scenario: [lamp_room, windy_field]`.
"""

from collections.abc import Mapping
from typing import Annotated, Any, Self

from lta_config.files import (
    check_exactly_one,
    find_file,
    load_file,
    Name,
    SchemaVersion,
    StrictModel,
)
from pydantic import AliasChoices, Discriminator, Field, model_validator, Tag

Value = Any  # '4 g', '[0, 0, 1] m/s', {value: 4, unit: g}, 0.5, true, a name
Values = Annotated[list[Value], Field(min_length=1, max_length=10_000)]
CASE_COLUMN = 'case'  # column of the cases' names in results


class NormalDistribution(StrictModel):
    """Normal distribution, redrawn until it lies between `low` and `high` if they are given."""

    mean: Value
    deviation: Value
    low: Value = None
    high: Value = None


class UniformDistribution(StrictModel):
    """Uniform distribution from `low` to `high`."""

    low: Value
    high: Value


class Distribution(StrictModel):
    """One distribution: exactly one of its keys."""

    normal: NormalDistribution | None = None
    uniform: UniformDistribution | None = None
    loguniform: UniformDistribution | None = None
    choice: Values | None = None

    @model_validator(mode='after')
    def _check_one_kind(self) -> Self:
        check_exactly_one(self, *type(self).model_fields)
        return self


def _classify_variation(how: object) -> str:
    """Return the kind of variation, so that pydantic reports the errors of that kind only."""
    return 'values' if isinstance(how, list) else 'distribution'


Case = Mapping[str, Value]


class SweepSeeds(StrictModel):
    """Seeds of the flights: `count` consecutive numbers."""

    first: Annotated[int, Field(ge=0, le=2**30)] = 1
    count: Annotated[int, Field(ge=1, le=10_000_000)] | None = None


class SweepFile(StrictModel):
    """A sweep file."""

    schema_version: SchemaVersion
    name: Name
    about: str
    vehicle: str
    scenario: str
    strategy: str
    gains: str
    seeds: SweepSeeds = SweepSeeds()
    samples: Annotated[int, Field(ge=1, le=10_000_000)] | None = None
    settings: Annotated[Mapping[str, Value], Field(validation_alias=AliasChoices('set'))] = {}
    cases: Mapping[Name, Case] = {}
    vary: Mapping[
        str,
        Annotated[
            Annotated[Values, Tag('values')] | Annotated[Distribution, Tag('distribution')],
            Discriminator(_classify_variation),
        ],
    ] = {}

    @model_validator(mode='after')
    def _check_samples(self) -> Self:
        random = [path for path, how in self.vary.items() if isinstance(how, Distribution)]
        if random and self.samples is None:
            raise ValueError(
                f'has a distribution for {", ".join(random)}, but no number of samples; add '
                '"samples"'
            )
        if self.samples is not None and self.seeds.count is not None:
            raise ValueError(
                'has both samples and seeds.count; remove seeds.count, because each sample has '
                'its own seed'
            )
        # A parameter with two values would be ambiguous
        both = sorted(self.vary.keys() & self.settings.keys())
        if both:
            raise ValueError(f'has {", ".join(both)} in both "set" and "vary"; keep one')
        cases = {path for case in self.cases.values() for path in case}
        if both := sorted(self.vary.keys() & cases):
            raise ValueError(f'has {", ".join(both)} in both "vary" and "cases"; keep one')
        return self

    @property
    def draws_per_point(self) -> int:
        """Flights at each point of the grid."""
        return self.samples or self.seeds.count or 1

    def shorten(self) -> Self:
        """Return the sweep with one flight at each point of the grid."""
        if self.samples is not None:
            return self.model_copy(update={'samples': 1})
        return self.model_copy(update={'seeds': SweepSeeds(first=self.seeds.first, count=1)})


def load_sweep(name: str) -> SweepFile:
    """Return a sweep file by shipped name or path; raise `BadInput` if it is invalid."""
    return load_file(SweepFile, find_file('sweep', name))
