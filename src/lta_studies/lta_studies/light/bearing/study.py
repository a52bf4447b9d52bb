"""
Repeat the paper's study of the number of photodiodes with both estimators, a ring at a time.

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
import math
from typing import Final, final

from lta_report.palette import GOOD, LAMP, TRUTH
from lta_studies.light.bearing.bench import BearingBench, Pose
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
DIRECTION_COUNT: Final = 16
STUDY_DISTANCE: Final = 3.0  # m
# Off the lamp's axis, where reflections turn the mean most. On the axis of a symmetric room they
# are symmetric, too.
STUDY_OFF_AXIS: Final = math.radians(45.0)
STUDY_HEIGHT: Final = 0.5  # of the hull centre, that of the paper's flights [m]
READINGS_PER_DIRECTION: Final = 50
RING_COUNTS: Final = (4, 8, 16)


@final
@dataclass(frozen=True, slots=True)
class RingStudy:
    """Results of one ring in one place."""

    place: str  # name in `BEARING_PLACES`
    count: int  # number of diodes
    # Median error in each direction [rad]
    paper: tuple[float, ...]
    ours: tuple[float, ...]
    snr: float  # median SNR of the best diode


def error_quantile(errors: Array, percent: float) -> float:
    """Return a percentile of the absolute errors; NaN if there are none."""
    finite = np.abs(errors[np.isfinite(errors)])
    return float(np.percentile(finite, percent)) if finite.size else math.nan


def list_directions() -> list[float]:
    """Return the true directions of the lamp, seen from the ring. [rad]"""
    return [math.tau * k / DIRECTION_COUNT for k in range(DIRECTION_COUNT)]


def study_ring(
    bench: BearingBench,
    place: str,
    count: int,
    readings: int,
    seed: int,
    aside: float = STUDY_OFF_AXIS,
) -> RingStudy:
    """Study one ring in all directions, `aside` of the lamp's axis. [rad]"""
    # The same draws indoors and outdoors: only the place differs.
    chance = np.random.default_rng([seed, count])
    diodes = bench.sample_diode_gains(chance)
    paper, ours, snrs = [], [], []
    for direction in list_directions():
        pose = pose_for_lamp_direction(bench, direction, aside)
        blocks = [bench.estimate_block_bearing(pose, diodes, chance) for _ in range(readings)]
        paper.append(error_quantile(np.array([each.paper for each in blocks]), 50.0))
        ours.append(error_quantile(np.array([each.ours for each in blocks]), 50.0))
        snrs.append(float(np.median([each.snr for each in blocks])))
    return RingStudy(place, count, tuple(paper), tuple(ours), float(np.median(snrs)))


def pose_for_lamp_direction(
    bench: BearingBench, direction: float, aside: float = STUDY_OFF_AXIS
) -> Pose:
    """Return the level pose, `aside` of the axis, that has the lamp in a direction. [rad]"""
    x, y, _ = bench.scenario.goal_lamp.position.vector
    ahead_x, ahead_y, _ = bench.scenario.goal_lamp.facing.vector
    facing = math.atan2(ahead_y, ahead_x) + aside
    # Half the heading: from the drone, the lamp is at facing + pi in the map.
    half = 0.5 * (facing + math.pi - direction)
    # The ring is below the hull centre, so a level ring has the same horizontal position.
    return (
        x + STUDY_DISTANCE * math.cos(facing), y + STUDY_DISTANCE * math.sin(facing), STUDY_HEIGHT,
        0.0, 0.0, math.sin(half), math.cos(half),
    )  # fmt: skip


def count_accurate_directions(errors: Sequence[float], limit: float) -> int:
    """Return the number of directions with a median error below a limit."""
    return sum(error < limit for error in errors)


RING_COLOURS: Final = dict(zip(RING_COUNTS, (LAMP, TRUTH, GOOD), strict=True))
RING_METHOD: Final = (
    'The hull is level at 0.5 m and turns through 16 directions. The diode gains of the vehicle '
    'are drawn once. Errors are medians over the readings; each reading is one block of ADC '
    'samples with its own noise.'
)


def describe_method(aside: float) -> str:
    """Describe the set-up, with the drone `aside` of the lamp's axis. [rad]"""
    where = f'{math.degrees(aside):g} degrees off its axis' if aside else 'on its axis'
    return f'The lamp is {STUDY_DISTANCE:g} m away and the drone is {where}. {RING_METHOD}'


def median_error(errors: Sequence[float]) -> float:
    """Return the median over the directions; NaN if one has no bearing."""
    return float(np.median(errors))
