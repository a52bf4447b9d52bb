"""Define the request and the result of a row's study."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
import math
from pathlib import Path
from typing import Any, final, NamedTuple

from lta_config.files import find_file, load_yaml
from lta_config.schema.paper_file import SceneRange
from lta_config.schema.parameter_ranges import draw_between, draw_values
from lta_report.report import TextTable
import numpy as np
from plotly.graph_objects import Figure
from scipy.special import stdtrit


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


@final
@dataclass(frozen=True, slots=True)
class StudyPicture:
    """A picture, the command that repeats it, and the bag of its flight, if any."""

    name: str
    heading: str
    caption: str
    figure: Figure
    command: str
    bag: str = ''


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
    folder: Path  # folder for the bags of this row
    draws: int = 0  # number of draws
    ranges: Mapping[str, SceneRange] = field(default_factory=dict)  # ranges of the scene, by path

    @property
    def draw_seeds(self) -> range:
        """The numbers of the draws; a flight in a draw has the same seed."""
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
    count, middle = len(values), float(np.mean(values))
    if count < 2:
        return MeasuredValue(middle, seeds=count)
    # Two-sided 95 %: the 97.5 % quantile of Student's t
    half = float(stdtrit(count - 1, 0.975) * np.std(values, ddof=1) / math.sqrt(count))
    return MeasuredValue(middle, middle - half, middle + half, count)


def average_measures(seeds: Sequence[Mapping[str, float]]) -> dict[str, MeasuredValue]:
    """Return the means over seeds of all measures, with their 95 % intervals."""
    return {name: average_over_seeds([each[name] for each in seeds]) for name in seeds[0]}


def to_values(measures: Mapping[str, float]) -> dict[str, MeasuredValue]:
    """Return measures as values without an interval."""
    return {name: MeasuredValue(value) for name, value in measures.items()}


def yes_no_value(yes: bool) -> MeasuredValue:
    """Return the value 'yes' or 'no'."""
    return MeasuredValue('yes' if yes else 'no')
