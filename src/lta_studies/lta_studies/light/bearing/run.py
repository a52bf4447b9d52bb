"""Evaluate bearings at random poses for places, numbers of diodes and ranges."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, final

from lta_studies.light.bearing.bench import BearingBench, BearingReading
from lta_studies.light.bearing.places import build_flight_spec, PLACES, TrueDiodes
from lta_studies.light.bearing.poses import BESIDE, draw_pose
from lta_studies.light.bearing.score import BearingScore, score_readings
import numpy as np


@final
@dataclass(frozen=True, slots=True)
class BearingTrialRequest:
    """Options of a bearing study."""

    vehicle: str  # vehicle with the diodes
    places: tuple[str, ...]  # names in `PLACES`
    counts: tuple[int, ...]  # numbers of diodes in the ring
    # Horizontal distances to the lamp [m]; None is anywhere in the scene
    ranges: tuple[float | None, ...]
    poses: int  # random poses per combination, each with its own diode gains
    seed: int  # random seed
    # The simulated diodes; the drone assumes those of the vehicle file
    diodes: tuple[TrueDiodes, ...] = (TrueDiodes(),)
    # Light blocks of a turn in place from which the drone learns its gains before each pose
    turn: int = 0
    off_axis: float = BESIDE  # largest angle to the lamp's axis [rad]

    @property
    def pose_count(self) -> int:
        """Total number of poses."""
        cases = len(self.places) * len(self.counts) * len(self.ranges) * len(self.diodes)
        return cases * self.poses


@final
@dataclass(frozen=True, slots=True)
class BearingTrialResult:
    """Readings and score at a place, number of diodes, range [m] and kind of diodes."""

    place: str
    count: int
    range: float | None
    diodes: TrueDiodes
    readings: tuple[BearingReading, ...]
    score: BearingScore

    def to_json(self) -> dict[str, Any]:
        """Convert the score to JSON, without the single readings."""
        return {
            'place': self.place,
            'diodes': self.count,
            'range': self.range,
            'true_response': self.diodes.response,
            'true_gain_spread': self.diodes.gain_spread,
            **self.score.to_json(),
        }


def run_bearing_trials(
    request: BearingTrialRequest, tick: Callable[[], None]
) -> list[BearingTrialResult]:
    """
    Evaluate the bearings for all combinations; call `tick` after each pose.

    Every combination starts its own random stream, so that rings of different size see the same
    poses.

    """
    found = []
    for place in request.places:
        for count in request.counts:
            assumed = build_flight_spec(PLACES[place], request.vehicle, count)
            for diodes in request.diodes:
                truth = build_flight_spec(PLACES[place], request.vehicle, count, diodes)
                bench = BearingBench(assumed, truth)
                for distance in request.ranges:
                    readings = tuple(simulate_random_poses(bench, distance, request, tick))
                    score = score_readings(readings)
                    found.append(
                        BearingTrialResult(place, count, distance, diodes, readings, score)
                    )
    return found


def simulate_random_poses(
    bench: BearingBench,
    distance: float | None,
    request: BearingTrialRequest,
    tick: Callable[[], None],
) -> list[BearingReading]:
    """Return the readings at random poses, each with its own diode gains."""
    # Separate streams for poses and noise keep the poses independent of the number of diodes.
    where, what = (np.random.default_rng([request.seed, k]) for k in range(2))
    readings = []
    for _ in range(request.poses):
        pose = draw_pose(bench.scenario, distance, where, request.off_axis)
        diodes = bench.sample_diode_gains(what)
        finder = bench.learn_gains(pose, diodes, request.turn, what)
        readings.append(bench.estimate_block_bearing(pose, diodes, what, finder))
        tick()
    return readings


def to_json(results: Sequence[BearingTrialResult], request: BearingTrialRequest) -> dict[str, Any]:
    """Convert the results to JSON; angles in rad, ranges in m."""
    return {
        'vehicle': request.vehicle,
        'poses': request.poses,
        'seed': request.seed,
        'rows': [each.to_json() for each in results],
    }
