"""What the study of a row finds: values by name, pictures and tables."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
import math
from pathlib import Path
from typing import final, NamedTuple

from lta_studies.energy.tables import TextTable
import numpy as np
from plotly.graph_objects import Figure
from scipy.special import stdtrit


class MeasuredValue(NamedTuple):
    """
    A number in SI or a word, with the ends of its 95 % interval and of how many seeds it is.

    No interval is NaN; a number that does not exist, as the time of who never arrives, is NaN.
    """

    value: float | str
    low: float = math.nan
    high: float = math.nan
    seeds: int = 1


@final
@dataclass(frozen=True, slots=True)
class StudyPicture:
    """A picture, what to type to find it again, and the bag of the flight it shows, if any."""

    name: str
    heading: str
    caption: str
    figure: Figure
    command: str
    bag: str = ''


@final
@dataclass(frozen=True, slots=True)
class RowStudyResult:
    """All that a study found."""

    values: Mapping[str, MeasuredValue]
    pictures: Sequence[StudyPicture]
    tables: Sequence[TextTable] = ()


@final
@dataclass(frozen=True, slots=True)
class RowStudyRequest:
    """
    What a study is asked for.

    Attributes
    ----------
    seeds : int
        Flights or draws of each.
    quick : bool
        Whether what takes long may be left out.
    folder : Path
        Where bags of flights go, below a folder of the row's own.

    """

    seeds: int
    quick: bool
    folder: Path


Study = Callable[[RowStudyRequest], RowStudyResult]


def average_over_seeds(values: Sequence[float]) -> MeasuredValue:
    """Return the mean over seeds with its 95 % interval (Student's t)."""
    count, middle = len(values), float(np.mean(values))
    if count < 2:
        return MeasuredValue(middle, seeds=count)
    half = float(stdtrit(count - 1, 0.975) * np.std(values, ddof=1) / math.sqrt(count))
    return MeasuredValue(middle, middle - half, middle + half, count)


def yes_no_value(yes: bool) -> MeasuredValue:
    """Return yes or no."""
    return MeasuredValue('yes' if yes else 'no')
