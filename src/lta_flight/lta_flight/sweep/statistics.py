# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Statistics of many flights: success rate with its uncertainty, and groups by parameter."""

from collections.abc import Sequence
import math
from typing import Any, Final, NamedTuple

from lta_flight.sweep.batch_workers import FAILED, SweepRow
import numpy as np
from scipy.special import stdtrit

NORMAL_95: Final = 1.959963984540054  # two-sided 95 % quantile of the normal distribution
GROUPS: Final = 8  # of a randomly drawn parameter, with equal numbers of flights
MOST_GRID_GROUPS: Final = 40  # up to so many values form a group each,
FLIGHTS_PER_GROUP: Final = 5  # if they have at least so many flights on average
REACHED: Final = 'reached'
BOOTSTRAP_DRAWS: Final = 4000
BOOTSTRAP_SEED: Final = 7
BOOTSTRAP_ENDS: Final = (2.5, 97.5)  # %


class ShareInterval(NamedTuple):
    """A share of flights with its 95 % confidence interval [1]."""

    value: float
    low: float
    high: float


class MeanInterval(NamedTuple):
    """A mean with its 95 % confidence interval, NaN of fewer than two values."""

    value: float
    low: float
    high: float


class BootstrapMean(NamedTuple):
    """A mean, or a ratio of means, with its 95 % interval and number of flights."""

    value: float
    low: float
    high: float
    flights: int


class ParameterGroup(NamedTuple):
    """Flights with similar values of a parameter: label, position on the axis, rows."""

    name: str
    place: float | str
    rows: list[SweepRow]


def student_interval(values: Sequence[float]) -> MeanInterval:
    """Return the mean of values with its 95 % interval (Student's t); NaN of none."""
    if not len(values):
        return MeanInterval(math.nan, math.nan, math.nan)
    count, middle = len(values), float(np.mean(values))
    if count == 1:
        return MeanInterval(middle, math.nan, math.nan)
    # Two-sided 95 %: the 97.5 % quantile of Student's t
    half = float(stdtrit(count - 1, 0.975) * np.std(values, ddof=1) / math.sqrt(count))
    return MeanInterval(middle, middle - half, middle + half)


def bootstrap_mean(values: Sequence[float]) -> BootstrapMean:
    """
    Return a mean with its percentile bootstrap interval.

    Efron and Tibshirani, An Introduction to the Bootstrap (1993), chapter 13. NaN without values;
    a single value has no interval.
    """
    # A mean is a ratio with the denominator 1.
    return bootstrap_ratio(values, [1.0] * len(values))


def bootstrap_ratio(above: Sequence[float], below: Sequence[float]) -> BootstrapMean:
    """Return the ratio of two means over the same flights, resampled in pairs."""
    count = len(above)
    if count == 0:
        return BootstrapMean(math.nan, math.nan, math.nan, 0)
    top, bottom = np.array(above, dtype=np.float64), np.array(below, dtype=np.float64)
    value = float(top.mean() / bottom.mean())
    # Resampling one value would give an interval of zero width.
    if count == 1:
        return BootstrapMean(value, math.nan, math.nan, 1)
    # A fixed seed makes the page reproducible.
    resamples = np.random.default_rng(BOOTSTRAP_SEED).integers(
        count, size=(BOOTSTRAP_DRAWS, count)
    )
    low, high = np.percentile(
        top[resamples].mean(axis=1) / bottom[resamples].mean(axis=1), BOOTSTRAP_ENDS
    )
    return BootstrapMean(value, float(low), float(high), count)


def wilson_interval(hits: int, count: int) -> ShareInterval:
    """
    Return a share with its 95 % interval (Wilson 1927, doi:10.1080/01621459.1927.10502953).

    `hits`, `count`: number of successes and of trials; the share of 0 trials is NaN.
    """
    # Nothing is known, so the interval covers everything
    if count == 0:
        return ShareInterval(math.nan, 0.0, 1.0)
    z2 = NORMAL_95 * NORMAL_95
    share = hits / count
    # Centre and half width of the interval, which stays within 0 and 1 even for few flights
    middle = (share + z2 / (2 * count)) / (1 + z2 / count)
    half = (
        NORMAL_95
        / (1 + z2 / count)
        * math.sqrt(share * (1 - share) / count + z2 / (4 * count * count))
    )
    return ShareInterval(share, max(0.0, middle - half), min(1.0, middle + half))


def reached_share(rows: Sequence[SweepRow]) -> ShareInterval:
    """Return the share of flights that reached their goal; failed ones are left out."""
    completed = [row for row in rows if row.outcome != FAILED]
    return wilson_interval(sum(row.outcome == REACHED for row in completed), len(completed))


def collect_result_values(rows: Sequence[SweepRow], name: str) -> list[float]:
    """Return one result of every successful flight that has it."""
    values = [row.figures.get(name) for row in rows if row.outcome == REACHED]
    return [float(value) for value in values if value is not None]


def group_by_parameter(rows: Sequence[SweepRow], path: str) -> list[ParameterGroup]:
    """Return flights grouped by a parameter: one group per value, or ranges of many values."""
    values = [row.values[path] for row in rows]
    distinct = list(dict.fromkeys(map(format_value, values)))
    # Do not split the flights of a grid value, which are sorted by the other parameters
    grid = len(distinct) <= MOST_GRID_GROUPS and FLIGHTS_PER_GROUP * len(distinct) <= len(rows)
    # Up to GROUPS values each get their own group anyway
    few = grid or len(distinct) <= GROUPS
    if few or not all(map(is_number, values)):
        groups = [ParameterGroup(name, name, []) for name in distinct]
        by_name = {group.name: group for group in groups}
        for row, value in zip(rows, values, strict=True):
            by_name[format_value(value)].rows.append(row)
        if all(map(is_number, values)):
            groups = [g._replace(place=float(g.rows[0].values[path])) for g in groups]
            groups.sort(key=lambda group: float(group.place))
        return groups
    # A stable sort keeps equal values in the order of their flights
    order = np.argsort(np.array(values, dtype=np.float64), kind='stable')
    return [
        build_range_group([rows[k] for k in part], path) for part in np.array_split(order, GROUPS)
    ]


def build_range_group(rows: list[SweepRow], path: str) -> ParameterGroup:
    """Return flights with neighbouring values as a group, placed at their median."""
    values = [float(row.values[path]) for row in rows]
    name = f'{min(values):.3g} to {max(values):.3g}'
    return ParameterGroup(name, float(np.median(values)), rows)


def is_number(value: Any) -> bool:
    """Return whether a value is a single number."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def format_value(value: Any) -> str:
    """Return a value as a short text."""
    if is_number(value):
        return f'{value:.6g}'
    if isinstance(value, list | tuple):
        return f'[{", ".join(format_value(item) for item in value)}]'
    return str(value)
