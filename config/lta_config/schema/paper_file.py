# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
One row of the reproduction: the claims of the seed paper, and how they are measured here.

Each claim has a rule for agreement and the measure that it judges; where its words allow several
readings, one measure for each. Each measure has a unit and a number of digits. Defects are
contradictions within the paper, with the arithmetic. A row never contains our results: its texts
name a measure in braces.
"""

from collections.abc import Mapping, Sequence
from string import Formatter
from typing import Annotated, Any, Literal, Self

from lta_config.files import (
    find_file,
    list_shipped_names,
    load_file,
    Name,
    SchemaVersion,
    StrictModel,
)
from lta_config.quantity import Quantity, SI_UNITS
from pydantic import AliasChoices, Field, model_validator

# A printed number, our reading of words, or a LaTeX comment
Source = Literal['printed', 'read', 'comment']


class PaperMeasure(StrictModel):
    """A measured quantity: text if there is no unit, else a number rounded to some digits."""

    what: str
    unit: str | None = None
    digits: Annotated[int, Field(ge=-3, le=6)] = 0

    @model_validator(mode='after')
    def _check_unit(self) -> Self:
        if self.unit is not None and self.unit not in SI_UNITS:
            raise ValueError(f'has the unknown unit "{self.unit}"; known: {", ".join(SI_UNITS)}')
        return self

    @property
    def factor(self) -> float:
        """Return the unit in SI."""
        return 1.0 if self.unit is None else SI_UNITS[self.unit][1]

    @property
    def rounding(self) -> float:
        """Half of the last printed digit. [SI]."""
        return float(0.5 * 10.0**-self.digits * self.factor)


class AgreementRule(StrictModel):
    """When a measure agrees with a claim: relative tolerance, bounds, or a word."""

    within: Quantity | None = None
    least: Quantity | None = None
    most: Quantity | None = None
    word: Annotated[str | None, Field(validation_alias=AliasChoices('is'))] = None

    @model_validator(mode='after')
    def _check_one_kind(self) -> Self:
        bounds = self.least is not None or self.most is not None
        if sum([self.within is not None, bounds, self.word is not None]) != 1:
            raise ValueError(
                'needs exactly one rule: "within", "is", or bounds ("least", "most" or both)'
            )
        return self


def _bounds_one_side(rule: AgreementRule) -> bool:
    return (rule.least is None) != (rule.most is None)


class PaperClaim(StrictModel):
    """One statement of the paper."""

    says: str  # the statement
    where: str  # its section or figure
    source: Source  # whether it is a number or words
    value: Quantity | None = None  # as printed
    # The measure to compare with, and the rule; None if it cannot be tested here
    measure: str | None = None
    rule: AgreementRule | None = None
    reading: str = ''  # how `measure` reads the claim, if there are other readings
    # Other readings: the measure of each. A verdict is final only if all agree.
    readings: Mapping[str, str] = Field(default_factory=dict)
    construction: str = ''  # why the claim holds by construction; '' if it could have failed
    # Measure that is 'yes' if an agreement says nothing, as anything would agree
    vacuous: str | None = None
    # Whether each draw flies once, and the paper prints a figure of a single flight, or claims a
    # rate at which flights succeed
    flights: Literal['single', 'rate'] | None = None
    headline: str = ''  # its line on the first page; '' if it is not there
    untested: str = ''  # why it cannot be tested
    finding: str = ''  # the result
    gap: str = ''  # what would close a difference

    @model_validator(mode='after')
    def _check_tested(self) -> Self:
        if (self.measure is None) != (self.rule is None):
            raise ValueError('has only one of "measure" and "rule"; give both or neither')
        if (self.measure is None) != bool(self.untested):
            raise ValueError('needs either "measure" and "rule", or a reason in "untested"')
        if self.rule is not None and self.rule.within is not None and self.value is None:
            raise ValueError('has a rule with "within", but no "value" to compare with; add it')
        if self.flights == 'rate' and (self.rule is None or not _bounds_one_side(self.rule)):
            raise ValueError('has "flights: rate", so its rule needs either "least" or "most"')
        if bool(self.reading) != bool(self.readings):
            raise ValueError('has only one of "reading" and "readings"; give both or neither')
        return self

    @property
    def measures(self) -> dict[str, str]:
        """Return the measure of each reading, by its name; '' where the words allow only one."""
        return {} if self.measure is None else {self.reading: self.measure, **self.readings}


class PaperDefect(StrictModel):
    """A contradiction in the paper."""

    says: str
    follows: str  # what follows, with the arithmetic
    here: str


class SeedCounts(StrictModel):
    """Numbers of seeds of a quick and of a full run."""

    quick: Annotated[int, Field(ge=1)] = 1
    full: Annotated[int, Field(ge=1)] = 1


class DrawCounts(StrictModel):
    """Numbers of draws from the ranges in a quick and in a full run; none by default."""

    quick: Annotated[int, Field(ge=0)] = 0
    full: Annotated[int, Field(ge=0)] = 0


class SceneRange(StrictModel):
    """The range of a number of the scene that the paper does not print."""

    range: tuple[float, float]
    unit: str | None = None
    range_source: str

    @model_validator(mode='before')
    @classmethod
    def _convert_list(cls, content: Any) -> Any:
        if isinstance(content, dict) and isinstance(content.get('range'), list):
            return {**content, 'range': tuple(map(float, content['range']))}
        return content


class PaperRow(StrictModel):
    """A row of the reproduction."""

    schema_version: SchemaVersion
    name: Name
    number: Annotated[int, Field(ge=1)]
    title: str
    scenario: str
    seeds: SeedCounts = SeedCounts()
    draws: DrawCounts = DrawCounts()
    ranges: Mapping[str, SceneRange] = Field(default_factory=dict)
    deviations: Sequence[str] = ()
    measures: Annotated[Mapping[Name, PaperMeasure], Field(min_length=1)]
    claims: Annotated[Mapping[Name, PaperClaim], Field(min_length=1)]
    defects: Mapping[Name, PaperDefect] = Field(default_factory=dict)

    @model_validator(mode='after')
    def _check_claims(self) -> Self:
        for name, claim in self.claims.items():
            for text in (claim.finding, claim.gap, claim.untested, claim.construction):
                self._check_names(name, text)
            for measure in (*claim.measures.values(), claim.vacuous):
                if measure is not None:
                    # Check the measure as if a text named it in braces
                    self._check_names(name, f'{{{measure}}}')
            for measure in claim.measures.values() if claim.rule else ():
                self._check_units(name, self.measures[measure], claim)
        return self

    def _check_names(self, claim: str, text: str) -> None:
        for name in sorted(find_measure_names(text)):
            if name not in self.measures:
                raise ValueError(
                    f'uses the measure "{name}" in {claim}, but does not define it; known: '
                    f'{", ".join(self.measures)}'
                )

    def _check_units(self, claim: str, measure: PaperMeasure, statement: PaperClaim) -> None:
        rule = statement.rule
        assert rule is not None
        if (rule.word is not None) != (measure.unit is None):
            raise ValueError(
                f'has a rule in the claim {claim} that does not suit its measure; use "is" for a '
                'measure without a unit (text), and "within", "least" or "most" for one with a '
                'unit'
            )
        dimension = None if measure.unit is None else SI_UNITS[measure.unit][0]
        for bound in (rule.least, rule.most, statement.value):
            if bound is not None and dimension is not None and bound.dimension != dimension:
                raise ValueError(
                    f'has the unit {bound.unit} in the claim {claim}, but its measure is in '
                    f'{measure.unit}; use a compatible unit'
                )


def find_measure_names(text: str) -> set[str]:
    """Return the measures named in braces in a text."""
    # Formatter.parse yields (text, field name, format, conversion)
    return {name for _, name, _, _ in Formatter().parse(text) if name is not None}


def load_paper_row(name: str) -> PaperRow:
    """Return a row by name; raise `BadInput` if it is invalid."""
    return load_file(PaperRow, find_file('row of the paper', name))


def load_paper_rows() -> list[PaperRow]:
    """Return all rows, in the order of the paper."""
    return sorted(map(load_paper_row, list_shipped_names('paper')), key=lambda row: row.number)
