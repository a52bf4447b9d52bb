"""Evaluate bearings at random poses for places, numbers of diodes and ranges."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any, Final, final, NamedTuple

from lta_report.line_log import LogKind
from lta_report.study_store import StoreFormat
from lta_report.workers import report_progress
from lta_studies.light.bearing.bench import BearingBench, BearingReading
from lta_studies.light.bearing.places import build_flight_spec, PLACES, TrueDiodes
from lta_studies.light.bearing.poses import BESIDE, draw_pose
from lta_studies.light.bearing.score import BearingScore, score_readings
import numpy as np
from pydantic import TypeAdapter


class BearingCase(NamedTuple):
    """A place, number of diodes, kind of diodes and range [m]; its text is its key."""

    place: str
    ring: int
    diodes: TrueDiodes
    range: float | None


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
        return len(self.list_cases()) * self.poses

    def list_cases(self) -> list[BearingCase]:
        """Return all combinations."""
        every = product(self.places, self.counts, self.diodes, self.ranges)
        return [BearingCase(*each) for each in every]

    def evaluate(self, case: BearingCase) -> 'BearingTrialResult':
        """
        Evaluate the bearings of a combination.

        Each starts its own random stream, so that rings of different size see the same poses.
        """
        place = PLACES[case.place]
        bench = BearingBench(
            build_flight_spec(place, self.vehicle, case.ring),
            build_flight_spec(place, self.vehicle, case.ring, case.diodes),
        )
        readings = tuple(simulate_random_poses(bench, case.range, self))
        return BearingTrialResult(
            case.place, case.ring, case.range, case.diodes, readings, score_readings(readings)
        )


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


STORE: Final = StoreFormat(
    LogKind('bearings.jsonl', 'bearing', 'study of bearings', '--out'),
    TypeAdapter(BearingTrialResult),
)


def simulate_random_poses(
    bench: BearingBench, distance: float | None, request: BearingTrialRequest
) -> list[BearingReading]:
    """Return the readings at random poses, each with its own diode gains."""
    # Separate streams for poses and noise keep the poses independent of the number of diodes.
    where, what = (np.random.default_rng([request.seed, k]) for k in range(2))
    readings = []
    for k in range(request.poses):
        pose = draw_pose(bench.scenario, distance, where, request.off_axis)
        diodes = bench.sample_diode_gains(what)
        finder = bench.learn_gains(pose, diodes, request.turn, what)
        readings.append(bench.estimate_block_bearing(pose, diodes, what, finder))
        report_progress((k + 1) / request.poses)
    return readings


def to_json(results: Sequence[BearingTrialResult], request: BearingTrialRequest) -> dict[str, Any]:
    """Convert the results to JSON; angles in rad, ranges in m."""
    return {
        'vehicle': request.vehicle,
        'poses': request.poses,
        'seed': request.seed,
        'rows': [each.to_json() for each in results],
    }
