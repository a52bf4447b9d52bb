"""What a change of the nodes would have changed in flight: setpoints, duties, lamp, reserve."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, final, NamedTuple

from lta_flight.replay.against import Compared
from lta_flight.replay.heard import Heard
import numpy as np
from numpy.typing import NDArray

SAME = 1e-9  # rad, m, m/s, 1: a decision that moves by less is the same

Column = NDArray[np.float64]


@final
@dataclass(frozen=True, slots=True)
class Decision:
    """
    One kind of decision in both runs.

    Attributes
    ----------
    name, unit : str
        What is decided.
    keys : ndarray of int64, shape (n,)
        When. [ns]
    recorded, again : ndarray, shape (n,)
        What was decided then and now; truths are 0 and 1.
    gaps : ndarray, shape (n,)
        How far apart they are; headings on the shorter side.

    """

    name: str
    unit: str
    keys: NDArray[np.int64]
    recorded: Column
    again: Column
    gaps: Column

    @property
    def changed(self) -> int:
        """How often it was decided otherwise."""
        return int((self.gaps > SAME).sum())

    @property
    def first(self) -> int | None:
        """Row of the first change."""
        return int(np.argmax(self.gaps > SAME)) if self.changed else None

    @property
    def largest(self) -> float:
        """The largest change."""
        return float(self.gaps.max(initial=0.0))


class Kind(NamedTuple):
    """Where a decision stands: topic, name, unit, how to read it, and whether it is a heading."""

    topic: str
    name: str
    unit: str
    read: Callable[[Heard], Column]
    turning: bool = False


def field(path: str) -> Callable[[Heard], Column]:
    """Return what reads one field."""

    def read(heard: Heard) -> Column:
        found = heard.numbers.get(path)
        return np.full(len(heard.keys), np.nan) if found is None else found.astype(np.float64)

    return read


def heading(heard: Heard) -> Column:
    """Return the heading of a pose whose axis is up. [rad]"""
    parts: Mapping[str, NDArray[Any]] = heard.numbers
    z, w = (parts[f'pose.orientation.{axis}'].astype(np.float64) for axis in 'zw')
    return np.unwrap(2.0 * np.arctan2(z, w)) if len(z) else z


def seen(heard: Heard) -> Column:
    """Return 1 where a lamp is seen; a variance of -1 says that none is."""
    found: Column = (heard.numbers['pose.covariance[0]'] >= 0.0).astype(np.float64)
    return found


KINDS = (
    Kind('light/estimate', 'lamp seen', '', seen),
    Kind('setpoint/pose', 'heading', 'rad', heading, turning=True),
    Kind('setpoint/pose', 'altitude', 'm', field('pose.position.z')),
    Kind('setpoint/velocity', 'speed', 'm/s', field('twist.linear.x')),
    Kind('energy/reserve', 'reserve reached', '', field('data')),
    *(Kind('motors', f'duty {k + 1}', '1', field(f'effort[{k}]')) for k in range(8)),
)


def decisions(found: Sequence[Compared]) -> list[Decision]:
    """Return the decisions in the topics that were compared."""
    topics = {each.topic: each for each in found if each.count}
    made = []
    for kind in KINDS:
        each = topics.get(kind.topic)
        if each is None:
            continue
        recorded, again = kind.read(each.recorded), kind.read(each.again)
        known = ~(np.isnan(recorded) & np.isnan(again))
        if known.any():
            gaps = between(recorded, again, kind.turning)
            made.append(Decision(kind.name, kind.unit, each.recorded.keys, recorded, again, gaps))
    return made


def between(x: Column, y: Column, turning: bool) -> Column:
    """Return how far apart two columns are; what only one knows is infinitely far."""
    with np.errstate(invalid='ignore'):
        gaps = np.abs(x - y)
    if turning:
        gaps = np.abs(np.angle(np.exp(1j * (x - y))))
    both = np.isnan(x) & np.isnan(y)
    return np.where(both, 0.0, np.where(np.isnan(gaps), np.inf, gaps))
