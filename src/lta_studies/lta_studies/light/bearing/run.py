"""Judge bearings at random poses: places, numbers of diodes and ranges."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, final

from lta_studies.light.bearing.bench import Bench, Reading
from lta_studies.light.bearing.places import made_of, PLACES
from lta_studies.light.bearing.poses import draw_pose
from lta_studies.light.bearing.score import Score, score
import numpy as np


@final
@dataclass(frozen=True, slots=True)
class Asked:
    """
    What is judged.

    Parameters
    ----------
    vehicle : str
        Whose diodes.
    places : tuple of str
        Of `PLACES`.
    counts : tuple of int
        Diodes in the ring.
    ranges : tuple of float or None
        Horizontal distances to the lamp [m]; None is anywhere in the scene.
    poses : int
        Poses of each kind, each with diodes of its own.
    seed : int
        Of all chance.

    """

    vehicle: str
    places: tuple[str, ...]
    counts: tuple[int, ...]
    ranges: tuple[float | None, ...]
    poses: int
    seed: int

    @property
    def total(self) -> int:
        """How many poses there are."""
        return len(self.places) * len(self.counts) * len(self.ranges) * self.poses


@final
@dataclass(frozen=True, slots=True)
class Judged:
    """Readings of one kind: where, by how many diodes, how far away [m], and what they come to."""

    place: str
    count: int
    range: float | None
    readings: tuple[Reading, ...]
    score: Score

    def to_json(self) -> dict[str, Any]:
        """Return it for JSON, without the single readings."""
        return {
            'place': self.place,
            'diodes': self.count,
            'range': self.range,
            **self.score.to_json(),
        }


def judge(asked: Asked, tick: Callable[[], None]) -> list[Judged]:
    """
    Return how good the bearings are.

    Parameters
    ----------
    asked : Asked
        What is judged.
    tick : callable
        Called after each pose.

    Notes
    -----
    The poses of one range are the same whatever the place allows and however many diodes there
    are, as each kind draws from a stream of its own.

    """
    found = []
    for place in asked.places:
        for count in asked.counts:
            bench = Bench(made_of(PLACES[place], asked.vehicle, count))
            for distance in asked.ranges:
                readings = tuple(read(bench, distance, asked, tick))
                found.append(Judged(place, count, distance, readings, score(readings)))
    return found


def read(
    bench: Bench, distance: float | None, asked: Asked, tick: Callable[[], None]
) -> list[Reading]:
    """Return the readings at random poses, each by diodes of its own."""
    where, what = (np.random.default_rng([asked.seed, k]) for k in range(2))
    readings = []
    for _ in range(asked.poses):
        pose = draw_pose(bench.scenario, distance, where)
        readings.append(bench.read(pose, bench.drawn(what), what))
        tick()
    return readings


def to_json(found: Sequence[Judged], asked: Asked) -> dict[str, Any]:
    """Return everything for JSON; angles in radians, ranges in metres."""
    return {
        'vehicle': asked.vehicle,
        'poses': asked.poses,
        'seed': asked.seed,
        'rows': [each.to_json() for each in found],
    }
