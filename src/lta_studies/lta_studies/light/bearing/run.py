"""Judge bearings at random poses: places, numbers of diodes and ranges."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, final

from lta_studies.light.bearing.bench import BearingBench, BearingReading
from lta_studies.light.bearing.places import build_flight_spec, PLACES
from lta_studies.light.bearing.poses import draw_pose
from lta_studies.light.bearing.score import BearingScore, score_readings
import numpy as np


@final
@dataclass(frozen=True, slots=True)
class BearingTrialRequest:
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
    def pose_count(self) -> int:
        """How many poses there are."""
        return len(self.places) * len(self.counts) * len(self.ranges) * self.poses


@final
@dataclass(frozen=True, slots=True)
class BearingTrialResult:
    """Readings of one kind: where, by how many diodes, how far away [m], and what they come to."""

    place: str
    count: int
    range: float | None
    readings: tuple[BearingReading, ...]
    score: BearingScore

    def to_json(self) -> dict[str, Any]:
        """Return it for JSON, without the single readings."""
        return {
            'place': self.place,
            'diodes': self.count,
            'range': self.range,
            **self.score.to_json(),
        }


def run_bearing_trials(
    request: BearingTrialRequest, tick: Callable[[], None]
) -> list[BearingTrialResult]:
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
    for place in request.places:
        for count in request.counts:
            bench = BearingBench(build_flight_spec(PLACES[place], request.vehicle, count))
            for distance in request.ranges:
                readings = tuple(read_random_poses(bench, distance, request, tick))
                found.append(
                    BearingTrialResult(place, count, distance, readings, score_readings(readings))
                )
    return found


def read_random_poses(
    bench: BearingBench,
    distance: float | None,
    request: BearingTrialRequest,
    tick: Callable[[], None],
) -> list[BearingReading]:
    """Return the readings at random poses, each by diodes of its own."""
    where, what = (np.random.default_rng([request.seed, k]) for k in range(2))
    readings = []
    for _ in range(request.poses):
        pose = draw_pose(bench.scenario, distance, where)
        readings.append(bench.read_block(pose, bench.draw_diodes(what), what))
        tick()
    return readings


def to_json(results: Sequence[BearingTrialResult], request: BearingTrialRequest) -> dict[str, Any]:
    """Return everything for JSON; angles in radians, ranges in metres."""
    return {
        'vehicle': request.vehicle,
        'poses': request.poses,
        'seed': request.seed,
        'rows': [each.to_json() for each in results],
    }
