"""
One row of the reproduction: what the seed paper claims, and how that is measured here.

A row declares its claims with the rule by which each agrees or not, fixed before anything is run;
what is measured, in which unit and with how many digits; and what does not add up in the paper
itself, with the arithmetic. Numbers of ours are never written in it: texts name a measure in
braces, and a defect names its sums.
"""

from collections.abc import Mapping, Sequence
from string import Formatter
from typing import Annotated, Literal, Self

from lta_config.arithmetic import evaluate_sum
from lta_config.files import find_file, list_shipped, load_file, StrictModel
from lta_config.quantity import Quantity, UNITS
from pydantic import AliasChoices, Field, model_validator

Name = Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]*$')]
# A number; our reading of words; a LaTeX comment; what the paper leaves for later.
Source = Literal['printed', 'read', 'comment', 'future']


class PaperMeasure(StrictModel):
    """What is measured; text where there is no unit, else rounded to some digits of the unit."""

    what: str
    unit: str | None = None
    digits: Annotated[int, Field(ge=-3, le=6)] = 0

    @model_validator(mode='after')
    def _check_unit(self) -> Self:
        if self.unit is not None and self.unit not in UNITS:
            raise ValueError(f'has the unknown unit "{self.unit}"; known: {", ".join(UNITS)}')
        return self

    @property
    def factor(self) -> float:
        """SI of one unit."""
        return 1.0 if self.unit is None else UNITS[self.unit][1]

    @property
    def rounding(self) -> float:
        """Half of the last digit that is told. [SI]."""
        return float(0.5 * 10.0**-self.digits * self.factor)


class AgreementRule(StrictModel):
    """When a measure agrees with a claim: a share of its value, bounds, or a word."""

    within: Quantity | None = None
    least: Quantity | None = None
    most: Quantity | None = None
    word: Annotated[str | None, Field(validation_alias=AliasChoices('is'))] = None

    @model_validator(mode='after')
    def _check_one_kind(self) -> Self:
        bounds = self.least is not None or self.most is not None
        if sum([self.within is not None, bounds, self.word is not None]) != 1:
            raise ValueError('must be one of: within; least, most or both; is')
        return self


class PaperClaim(StrictModel):
    """
    One statement of the paper.

    Attributes
    ----------
    says, where, source : str
        What it states, in which section or figure, and whether as a number or in words.
    value : Quantity or None
        As printed.
    measure, rule : str, Rule
        What is held against it; None where it cannot be tested here.
    untested : str
        Why it cannot.
    finding : str
        What came out.
    gap : str
        What would close a difference.

    """

    says: str
    where: str
    source: Source
    value: Quantity | None = None
    measure: str | None = None
    rule: AgreementRule | None = None
    untested: str = ''
    finding: str = ''
    gap: str = ''

    @model_validator(mode='after')
    def _check_tested(self) -> Self:
        if self.source == 'future':
            if self.measure is None or self.rule is not None:
                raise ValueError('is of the future: it needs a measure, and no rule')
            return self
        if (self.measure is None) != (self.rule is None):
            raise ValueError('has a measure without a rule, or a rule without a measure')
        if (self.measure is None) != bool(self.untested):
            raise ValueError('needs either measure and rule, or why it is untested')
        if self.rule is not None and self.rule.within is not None and self.value is None:
            raise ValueError('has a rule within a share of a value, but no value')
        return self


class PaperDefect(StrictModel):
    """Where the paper contradicts itself or physics; `{0:.2f}` in `follows` is the first sum."""

    says: str
    sums: Sequence[str] = ()
    follows: str
    here: str

    @property
    def arithmetic(self) -> str:
        """What follows, its sums worked out."""
        return self.follows.format(*map(evaluate_sum, self.sums))


class PaperSeries(StrictModel):
    """
    A figure of the paper as discovery could use it.

    Attributes
    ----------
    figure, printed : str
        Which, and what of it stands in numbers.
    said : str
        What follows from those numbers, or why nothing does.

    """

    figure: str
    printed: str
    said: str


class SeedCounts(StrictModel):
    """How many seeds."""

    quick: Annotated[int, Field(ge=1)] = 1
    full: Annotated[int, Field(ge=1)] = 1


class PaperRow(StrictModel):
    """A whole row."""

    schema_version: Annotated[Literal[1], Field(validation_alias=AliasChoices('schema'))]
    name: Name
    number: Annotated[int, Field(ge=1)]
    title: str
    scenario: str
    seeds: SeedCounts = SeedCounts()
    deviations: Sequence[str] = ()
    measures: Annotated[Mapping[Name, PaperMeasure], Field(min_length=1)]
    claims: Annotated[Mapping[Name, PaperClaim], Field(min_length=1)]
    defects: Mapping[Name, PaperDefect] = Field(default_factory=dict)
    series: Mapping[Name, PaperSeries] = Field(default_factory=dict)

    @model_validator(mode='after')
    def _check_claims(self) -> Self:
        for name, claim in self.claims.items():
            for text in (claim.finding, claim.gap, claim.untested):
                self._check_names(name, text)
            if claim.measure is not None:
                self._check_names(name, f'{{{claim.measure}}}')
            if claim.measure is None or claim.rule is None:
                continue
            self._check_units(name, self.measures[claim.measure], claim)
        for name, each in self.series.items():
            self._check_names(name, each.said)
        for name, defect in self.defects.items():
            try:
                _ = defect.arithmetic
            except (LookupError, ValueError) as error:
                raise ValueError(f'has the defect {name}: {error}') from None
        return self

    def _check_names(self, claim: str, text: str) -> None:
        for name in sorted(find_measure_names(text)):
            if name not in self.measures:
                raise ValueError(
                    f'names "{name}" in {claim}, which it does not measure; known: '
                    f'{", ".join(self.measures)}'
                )

    def _check_units(self, claim: str, measure: PaperMeasure, statement: PaperClaim) -> None:
        rule = statement.rule
        assert rule is not None
        if (rule.word is not None) != (measure.unit is None):
            raise ValueError(
                f'holds a word against a number, or the reverse, in the claim {claim}'
            )
        dimension = None if measure.unit is None else UNITS[measure.unit][0]
        for bound in (rule.least, rule.most, statement.value):
            if bound is not None and dimension is not None and bound.dimension != dimension:
                raise ValueError(
                    f'has {bound.unit} in the claim {claim}, which is measured in {measure.unit}'
                )


def find_measure_names(text: str) -> set[str]:
    """Return the measures that a text names in braces."""
    return {name for _, name, _, _ in Formatter().parse(text) if name is not None}


def load_paper_row(name: str) -> PaperRow:
    """Return a row by name; anything wrong is a `BadInput` sentence."""
    return load_file(PaperRow, find_file('row of the paper', name))


def load_paper_rows() -> list[PaperRow]:
    """Return all rows, in the order of the paper."""
    return sorted(map(load_paper_row, list_shipped('paper')), key=lambda row: row.number)
