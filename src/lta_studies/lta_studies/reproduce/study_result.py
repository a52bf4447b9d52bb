"""Define the request and the result of a row's study."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
import math
from pathlib import Path
from typing import final, NamedTuple

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

    values: Mapping[str, MeasuredValue]
    pictures: Sequence[StudyPicture]
    tables: Sequence[TextTable] = ()


@final
@dataclass(frozen=True, slots=True)
class RowStudyRequest:
    """
    Options of a study.

    Attributes
    ----------
    seeds : int
        Number of flights or draws of each kind.
    quick : bool
        Whether to leave out the long parts.
    folder : Path
        Folder for the bags of this row.

    """

    seeds: int
    quick: bool
    folder: Path


RowStudy = Callable[[RowStudyRequest], RowStudyResult]


def average_over_seeds(values: Sequence[float]) -> MeasuredValue:
    """Return the mean over seeds with its 95 % interval (Student's t)."""
    count, middle = len(values), float(np.mean(values))
    if count < 2:
        return MeasuredValue(middle, seeds=count)
    # Two-sided 95 %: the 97.5 % quantile of Student's t
    half = float(stdtrit(count - 1, 0.975) * np.std(values, ddof=1) / math.sqrt(count))
    return MeasuredValue(middle, middle - half, middle + half, count)


def yes_no_value(yes: bool) -> MeasuredValue:
    """Return the value 'yes' or 'no'."""
    return MeasuredValue('yes' if yes else 'no')
