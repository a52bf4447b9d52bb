"""
Repeat the paper's study of the number of photodiodes with both estimators.

The lamp is 3 m away and the drone is 45 degrees off the lamp's axis, or straight ahead of it: the
paper does not say which. The ring turns through 16 directions with 50 readings each; the paper
gives medians. The gains of the one vehicle are drawn once, from the seed.

Some of the paper's statements need an explanation. With ideal cosine diodes the weighted mean is
exact for any even ring of four or more, whatever the pedestal (`lta_vlc.bearing`). With equal
diodes of any response a ring of eight is exact at all 16 directions, which are its own axes and
the bisectors between them. Errors in some directions only can therefore only come from a response
other than a cosine, from unequal gains, and from reflections. Steady sunlight adds only noise at
the lamp's frequency: "all worse from sunlight" is noise or saturation, and "4 better than indoors"
is due to missing reflections.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
import math
from typing import Any, Final, final

from lta_report.line_log import LogKind
from lta_report.report import Report
from lta_report.request import option, StudyRequest, StudyRun, VEHICLE
from lta_report.study import hash_inputs, Study
from lta_report.study_store import StoreFormat
from lta_studies.light.bearing.bench import BearingBench
from lta_studies.light.bearing.places import build_flight_spec, PLACES
from lta_studies.light.bearing.poses import Pose
from lta_studies.light.bearing.score import error_quantile, extract_column
import numpy as np
from pydantic import TypeAdapter

DIRECTIONS: Final = 16
DISTANCE: Final = 3.0  # m
# Off the lamp's axis, where reflections turn the mean most. On the axis of a symmetric room they
# are symmetric, too.
ASIDE: Final = math.radians(45.0)
HEIGHT: Final = 0.5  # of the hull centre, that of the paper's flights [m]
READINGS: Final = 50
COUNTS: Final = (4, 8, 16)


@final
class RingStudyRequest(StudyRequest, command='light study', quick={'readings': 5}):
    """
    Repeat the paper's study of the number of photodiodes, with its estimator and with ours.

    Simulates 4, 8 and 16 diodes with the lamp 3 m away in 16 directions, 50 readings each, indoors
    and outdoors. Reports median errors, checks the paper's statements, and explains those that
    cannot hold.

    Exit status 0: done. 2: bad input. 130: Ctrl-C.

    Example: lta light study --seed 7
    """

    vehicle: str = VEHICLE
    readings: int = option(
        'Number of photodiode readings in each direction.', default=READINGS, low=1, high=10_000
    )
    seed: int = option('Random seed.', default=1, low=0)
    aside: float = option(
        "Angle between the lamp's axis and the drone, degrees.", default=math.degrees(ASIDE),
        low=0, high=60,
    )  # fmt: skip

    def run(self, run: StudyRun) -> Report:
        """Return the report of all rings."""
        from lta_studies.light.bearing.study_report import build_report

        # Also checks that the vehicle fits the scenes before any work
        specs = [build_flight_spec(place, self.vehicle, 1) for place in PLACES.values()]
        turned = math.radians(self.aside)
        compute = partial(study_case, self.vehicle, self.readings, self.seed, turned)
        inputs = (self.readings, self.seed, turned, *(spec.contents for spec in specs))
        cases = list(product(PLACES, COUNTS))
        study = Study(compute, str, STORE, 'rings')
        rings = run.run_study(study, hash_inputs(*inputs), cases)
        return build_report(rings, self.vehicle, self.readings, self.seed, turned)


@final
@dataclass(frozen=True, slots=True)
class RingClaim:
    """A claim of the paper: at least so many directions with an error below a limit."""

    place: str
    count: int
    sentence: str
    limit: float  # [rad]
    at_least: int


CLAIMS: Final = (
    RingClaim('indoor', 16, '16 diodes, error below 2 degrees', math.radians(2.0), 16),
    RingClaim('indoor', 8, '8 diodes, error below 4 degrees', math.radians(4.0), 12),
    RingClaim('indoor', 8, '8 diodes, error below 8 degrees', math.radians(8.0), 16),
)


@final
@dataclass(frozen=True, slots=True)
class RingStudy:
    """Results of one ring in one place."""

    place: str  # name in `PLACES`
    count: int  # number of diodes
    # Median error in each direction [rad]
    paper: tuple[float, ...]
    ours: tuple[float, ...]
    snr: float  # median SNR of the best diode

    def to_json(self) -> dict[str, Any]:
        """Convert the study to JSON; angles in rad."""
        return {
            'place': self.place, 'diodes': self.count, 'snr': self.snr,
            'paper': list(self.paper), 'fit': list(self.ours),
        }  # fmt: skip


def list_directions() -> list[float]:
    """Return the true directions of the lamp, seen from the ring. [rad]"""
    return [math.tau * k / DIRECTIONS for k in range(DIRECTIONS)]


STORE: Final = StoreFormat(
    LogKind('rings.jsonl', 'study', 'study of photodiodes', '--out'), TypeAdapter(RingStudy)
)


def study_case(
    vehicle: str, readings: int, seed: int, aside: float, ring: tuple[str, int]
) -> RingStudy:
    """Study a ring (place, number of diodes) of a vehicle, `aside` of the lamp's axis. [rad]"""
    place, count = ring
    bench = BearingBench(build_flight_spec(PLACES[place], vehicle, count))
    return study_ring(bench, place, count, readings, seed, aside)


def study_ring(
    bench: BearingBench, place: str, count: int, readings: int, seed: int, aside: float = ASIDE
) -> RingStudy:
    """Study one ring in all directions, `aside` of the lamp's axis. [rad]"""
    # The same draws indoors and outdoors: only the place differs.
    chance = np.random.default_rng([seed, count])
    diodes = bench.sample_diode_gains(chance)
    paper, ours, snrs = [], [], []
    for direction in list_directions():
        pose = pose_for_lamp_direction(bench, direction, aside)
        blocks = [bench.estimate_block_bearing(pose, diodes, chance) for _ in range(readings)]
        paper.append(error_quantile(extract_column(blocks, 'paper'), 50.0))
        ours.append(error_quantile(extract_column(blocks, 'ours'), 50.0))
        snrs.append(float(np.median(extract_column(blocks, 'snr'))))
    return RingStudy(place, count, tuple(paper), tuple(ours), float(np.median(snrs)))


def pose_for_lamp_direction(bench: BearingBench, direction: float, aside: float = ASIDE) -> Pose:
    """Return the level pose, `aside` of the axis, that has the lamp in a direction. [rad]"""
    x, y, _ = bench.scenario.goal_lamp.position.vector
    ahead_x, ahead_y, _ = bench.scenario.goal_lamp.facing.vector
    facing = math.atan2(ahead_y, ahead_x) + aside
    # Half the heading: from the drone, the lamp is at facing + pi in the map.
    half = 0.5 * (facing + math.pi - direction)
    # The ring is below the hull centre, so a level ring has the same horizontal position.
    return (
        x + DISTANCE * math.cos(facing), y + DISTANCE * math.sin(facing), HEIGHT,
        0.0, 0.0, math.sin(half), math.cos(half),
    )  # fmt: skip


def count_accurate_directions(errors: Sequence[float], limit: float) -> int:
    """Return the number of directions with a median error below a limit."""
    return sum(error < limit for error in errors)


def judge_claims(studies: Sequence[RingStudy]) -> list[tuple[str, str, str]]:
    """Return each claim of the paper with the results of its estimator and of ours."""
    rings = {(each.place, each.count): each for each in studies}
    return [judge_claim(claim, rings[claim.place, claim.count]) for claim in CLAIMS]


def judge_claim(claim: RingClaim, ring: RingStudy) -> tuple[str, str, str]:
    """Return a claim, and the number of directions in which each estimator meets it."""
    paper, ours = (
        f'{count_accurate_directions(errors, claim.limit)} of {DIRECTIONS}'
        for errors in (ring.paper, ring.ours)
    )
    return f'{claim.sentence}: at least {claim.at_least} of {DIRECTIONS} directions', paper, ours
