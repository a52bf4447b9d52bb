# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Compare decisions of a replay with the recording: setpoints, duties, lamp and reserve."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, final, NamedTuple

from lta_config.covariances import select_estimates
from lta_flight.replay.comparison import TopicComparison, TopicMessages
import numpy as np
from numpy.typing import NDArray

SMALLEST_CHANGE = 1e-9  # rad, m, m/s or 1; smaller changes do not count

Column = NDArray[np.float64]


@final
@dataclass(frozen=True, slots=True)
class DecisionComparison:
    """One kind of decision in both runs."""

    name: str
    unit: str
    keys: NDArray[np.int64]  # times, shape (n,) [ns]
    # Values in both runs; booleans are 0 and 1, shape (n,)
    recorded: Column
    again: Column
    gaps: Column  # absolute differences; of headings along the shorter arc, shape (n,)

    @property
    def change_count(self) -> int:
        """Return the number of changed decisions."""
        return int((self.gaps > SMALLEST_CHANGE).sum())

    @property
    def first_change(self) -> int | None:
        """Row of the first change."""
        return int(np.argmax(self.gaps > SMALLEST_CHANGE)) if self.change_count else None

    @property
    def largest_change(self) -> float:
        """Return the largest change."""
        return float(self.gaps.max(initial=0.0))


class DecisionKind(NamedTuple):
    """Where a decision is: topic, name, unit, reader function, and whether it is a heading."""

    topic: str
    name: str
    unit: str
    read: Callable[[TopicMessages], Column]
    turning: bool = False


def build_field_reader(path: str) -> Callable[[TopicMessages], Column]:
    """Return a function that reads one field."""

    def read(messages: TopicMessages) -> Column:
        column = messages.numbers.get(path)
        if column is None:
            return np.full(len(messages.keys), np.nan)
        return column.astype(np.float64)

    return read


def read_heading(messages: TopicMessages) -> Column:
    """Return the heading of a pose that is rotated about z only [rad]."""
    parts: Mapping[str, NDArray[Any]] = messages.numbers
    z, w = (parts[f'pose.orientation.{axis}'].astype(np.float64) for axis in 'zw')
    # q = (0, 0, sin(yaw/2), cos(yaw/2))
    return np.unwrap(2.0 * np.arctan2(z, w)) if len(z) else z


def read_lamp_visible(messages: TopicMessages) -> Column:
    """Return 1 where a lamp is seen, else 0; a huge or negative variance means that none is."""
    is_visible: Column = select_estimates(messages.numbers['pose.covariance[0]']).astype(
        np.float64
    )
    return is_visible


DECISION_KINDS = (
    DecisionKind('light/estimate', 'lamp seen', '', read_lamp_visible),
    DecisionKind('setpoint/pose', 'heading', 'rad', read_heading, turning=True),
    DecisionKind('setpoint/pose', 'altitude', 'm', build_field_reader('pose.position.z')),
    DecisionKind('setpoint/velocity', 'speed', 'm/s', build_field_reader('twist.linear.x')),
    DecisionKind('energy/reserve', 'reserve reached', '', build_field_reader('data')),
    *(
        DecisionKind('motors', f'duty {k + 1}', '1', build_field_reader(f'effort[{k}]'))
        # Missing rotors give NaN columns, which `compare_decisions` drops
        for k in range(8)
    ),
)


def compare_decisions(comparisons: Sequence[TopicComparison]) -> list[DecisionComparison]:
    """Return the comparisons of all decisions in the compared topics."""
    topics = {each.topic: each for each in comparisons if each.count}
    rows = []
    for kind in DECISION_KINDS:
        each = topics.get(kind.topic)
        if each is None:
            continue
        recorded, again = kind.read(each.recorded), kind.read(each.again)
        # Rows that neither run has, as of a rotor that does not exist
        valid = ~(np.isnan(recorded) & np.isnan(again))
        if valid.any():
            gaps = compute_differences(recorded, again, kind.turning)
            rows.append(
                DecisionComparison(kind.name, kind.unit, each.recorded.keys, recorded, again, gaps)
            )
    return rows


def compute_differences(x: Column, y: Column, turning: bool) -> Column:
    """Return the differences of two columns; infinite where only one has a value."""
    with np.errstate(invalid='ignore'):
        gaps = np.abs(x - y)
    if turning:
        # The angle of the unit phasor is the shorter arc
        gaps = np.abs(np.angle(np.exp(1j * (x - y))))
    both = np.isnan(x) & np.isnan(y)
    return np.where(both, 0.0, np.where(np.isnan(gaps), np.inf, gaps))
