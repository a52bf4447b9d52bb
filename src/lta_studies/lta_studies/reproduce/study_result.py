# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Define request and result of a row's study, how both are stored, and how draws agree."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
import math
from typing import Annotated, Any, Final, final, NamedTuple

from lta_config.files import find_file, load_yaml
from lta_config.parameter_override import draw_between, draw_values
from lta_config.quantity import Quantity
from lta_config.schema.paper_file import AgreementRule, PaperRow, SceneRange
from lta_flight.sweep.statistics import student_interval
from lta_report.json_value import replace_nonfinite
from lta_report.report import TextTable
from lta_report.study import hash_inputs
import numpy as np
from plotly.graph_objects import Figure
from plotly.io import from_json
from pydantic import PlainSerializer, PlainValidator

RULE_TOLERANCE: Final = 1e-9  # relative tolerance for rounding differences between machines
SURE_SHARE: Final = 0.95  # share of the draws that makes a verdict


class DrawSummary(NamedTuple):
    """The values of a measure over the draws from the ranges of what is assumed."""

    drawn: int  # number of draws
    share: float  # share of them that satisfies the rule of the claim
    middle: float | str  # median, or the most frequent word [SI]
    # 5 % and 95 % quantiles of the draws; NaN for words [SI]
    low: float = math.nan
    high: float = math.nan
    missing: int = 0  # draws without a value, such as the path of a flight that did not arrive


def summarize_draws(
    rule: AgreementRule, printed: Quantity | None, values: Sequence[float | str]
) -> DrawSummary:
    """Return the summary of draws; values that do not exist (NaN) satisfy no rule."""
    share = sum(is_satisfied(rule, printed, value) for value in values) / len(values)
    if isinstance(values[0], str):
        return DrawSummary(len(values), share, Counter(values).most_common(1)[0][0])
    numbers = [value for value in values if not isinstance(value, str) and math.isfinite(value)]
    missing = len(values) - len(numbers)
    if not numbers:
        return DrawSummary(len(values), share, math.nan, missing=missing)
    low, middle, high = map(float, np.quantile(numbers, [0.05, 0.5, 0.95]))
    return DrawSummary(len(values), share, middle, low, high, missing)


def is_satisfied(rule: AgreementRule, printed: Quantity | None, value: float | str) -> bool:
    """Return whether a value satisfies a rule; NaN never does."""
    if isinstance(value, str):
        return value == rule.word
    low, high = agreement_bounds(rule, printed)
    # An open bound is infinite and gives no scale.
    slack = RULE_TOLERANCE * max(abs(bound) for bound in (low, high, 0.0) if math.isfinite(bound))
    return low - slack <= value <= high + slack


def agreement_bounds(rule: AgreementRule, printed: Quantity | None) -> tuple[float, float]:
    """Return the bounds within which a value agrees [SI]."""
    if rule.within is not None and printed is not None:
        # `within` is relative to the printed number.
        half = rule.within.si * abs(printed.si)
        return printed.si - half, printed.si + half
    low = -math.inf if rule.least is None else rule.least.si
    return low, math.inf if rule.most is None else rule.most.si


class MeasuredValue(NamedTuple):
    """
    A number in SI units or a word, with its 95 % interval and number of seeds.

    NaN means no interval, or a value that does not exist, such as the time of a flight that never
    arrives.
    """

    # A word for claims such as an order of strategies
    value: float | str
    low: float = math.nan
    high: float = math.nan
    seeds: int = 1


StoredFigure = Annotated[
    Figure,
    PlainValidator(lambda value: from_json(value) if isinstance(value, str) else value),
    PlainSerializer(Figure.to_json),
]


class StudyPicture(NamedTuple):
    """A picture, and the command that repeats it."""

    name: str
    heading: str
    caption: str
    figure: StoredFigure
    command: str


@final
@dataclass(frozen=True, slots=True)
class RowStudyResult:
    """Result of a study."""

    values: Mapping[str, MeasuredValue]  # the measures of the files as they are
    pictures: Sequence[StudyPicture]
    tables: Sequence[TextTable] = ()
    # Measures in each draw from the ranges of what is assumed
    draws: Mapping[str, Sequence[float | str]] = field(default_factory=dict)


@final
@dataclass(frozen=True, slots=True)
class RowStudyRequest:
    """Options of a study."""

    seeds: int  # number of flights or draws of each kind
    quick: bool  # whether to leave out the long parts
    draws: int = 0  # number of draws
    ranges: Mapping[str, SceneRange] = field(default_factory=dict)  # ranges of the scene, by path

    @property
    def draw_seeds(self) -> range:
        """Return the numbers of the draws; a flight in a draw has the same seed."""
        return range(1, self.draws + 1)

    def draw_changes(self, seed: int, vehicle: str = 'gtmab') -> dict[str, Any]:
        """Return a draw: values by path, as `FlightSpec.with_values` takes them."""
        values: dict[str, Any] = {
            **draw_values(load_yaml(find_file('vehicle', vehicle)), seed, 'vehicle')
        }
        for path, each in self.ranges.items():
            number = draw_between(each.range, each.range_source, seed)
            values[path] = number if each.unit is None else {'value': number, 'unit': each.unit}
        return values


Measures = Mapping[str, float | str]


def collect_draws(
    request: RowStudyRequest, measure: Callable[[int], Measures]
) -> dict[str, list[float | str]]:
    """Return the measures of all draws; `measure` returns those of one draw by its number."""
    draws = [measure(seed) for seed in request.draw_seeds]
    return {name: [each[name] for each in draws] for name in (draws[0] if draws else ())}


RowStudy = Callable[[RowStudyRequest], RowStudyResult]


def average_over_seeds(values: Sequence[float]) -> MeasuredValue:
    """Return the mean over seeds with its 95 % interval (Student's t)."""
    return MeasuredValue(*student_interval(values), seeds=len(values))


def average_measures(seeds: Sequence[Mapping[str, float]]) -> dict[str, MeasuredValue]:
    """Return the means over seeds of all measures, with their 95 % intervals."""
    return {name: average_over_seeds([each[name] for each in seeds]) for name in seeds[0]}


def to_values(measures: Mapping[str, float]) -> dict[str, MeasuredValue]:
    """Return measures as values without an interval."""
    return {name: MeasuredValue(value) for name, value in measures.items()}


def yes_no_value(yes: bool) -> MeasuredValue:
    """Return the value 'yes' or 'no'."""
    return MeasuredValue('yes' if yes else 'no')


@final
@dataclass(frozen=True, slots=True)
class StoredRow:
    """
    Results of a row's study, its number of seeds and its duration [s].

    `draws` has a summary for each claim and each of its measures that was drawn.
    """

    values: Mapping[str, MeasuredValue]
    pictures: Sequence[StudyPicture]
    tables: Sequence[TextTable]
    seeds: int
    seconds: float
    draws: Mapping[str, Mapping[str, DrawSummary]] = field(default_factory=dict)


def hash_row(row: PaperRow, seeds: int, quick: bool, code: str) -> str:
    """Return a hash of the inputs of a row: its file, the effort, and the hash of the code."""
    return hash_inputs(row.model_dump_json(), seeds, quick, code)


def build_stored_row(
    row: PaperRow, result: RowStudyResult, seeds: int, seconds: float
) -> StoredRow:
    """Convert the result of a study to its stored form."""
    draws = summarize_row_draws(row, result.draws)
    return StoredRow(result.values, result.pictures, result.tables, seeds, seconds, draws)


def summarize_row_draws(
    row: PaperRow, draws: Mapping[str, Sequence[float | str]]
) -> dict[str, dict[str, DrawSummary]]:
    """Summarize the draws of each claim, by measure."""
    summary = {
        name: {
            measure: summarize_draws(claim.rule, claim.value, draws[measure])
            for measure in claim.measures.values()
            if claim.rule is not None and draws.get(measure)
        }
        for name, claim in row.claims.items()
    }
    return {name: each for name, each in summary.items() if each}


def encode_values(values: Mapping[str, MeasuredValue]) -> dict[str, list[Any]]:
    """Convert values to JSON, with NaN as null."""
    encoded: dict[str, list[Any]] = replace_nonfinite(values)
    return encoded
