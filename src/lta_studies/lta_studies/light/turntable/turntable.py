"""
A real light board on a turntable before a lamp: the paper's polar study from a recording.

The board stands level on a turntable, its nose to a lamp 3 m away, and is recorded while it turns.
Where the lamp truly was in each light block follows from how the table turned: by steps, as the
paper's, at a steady rate, or as a tracker saw it. Turning the board by some angle turns the lamp
by as much the other way.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
import math
from typing import Final, final, NamedTuple

from lta_config.compilation.compiler import compile_functions
from lta_config.errors import BadInput
from lta_config.topics import load_topic_table
from lta_control.cascade import wrap_angle
from lta_data.bag.recorded_flight import RecordedFlight
from lta_model.attitude import to_euler_angles
from lta_studies.light.bearing.score import error_quantile
from lta_studies.light.bearing.study import DIRECTIONS, RingStudy
from lta_vlc.bearing import estimate_bearing
from lta_vlc.demodulation import demodulate_block, plan_bins
from lta_vlc.diodes import DiodeArray
from lta_vlc.direction import DirectionFinder
from lta_vlc.direction_fit import fit_direction
from lta_vlc.lamp import LampPrior
from lta_vlc.settings import DemodulationSettings
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
PHOTODIODES: Final = 'photodiodes'
TRUTH: Final = 'ground_truth/odom'
SETTLED: Final = 0.15  # part of each hold, at both of its ends, in which the table may still turn
TOGETHER: Final = 100  # blocks that are read at a time
FEWEST: Final = DIRECTIONS  # blocks without which there is no study


class TurntableMotion(NamedTuple):
    """
    How the turntable went, counter-clockwise from above.

    Attributes
    ----------
    rate : float
        Steady; 0 where it went by steps or a tracker saw it. [rad/s]
    step : float
        Each; 0 where there are none. [rad]
    hold : float
        From one step to the next. [s]
    start : float
        Direction of the lamp from the nose in the first block. [rad]

    """

    rate: float = 0.0
    step: float = 0.0
    hold: float = 0.0
    start: float = 0.0


@final
@dataclass(frozen=True, slots=True)
class TurntableReadings:
    """
    What each light block of a turn says.

    Parameters
    ----------
    direction : ndarray, shape (n,)
        Where the lamp truly was, counter-clockwise from the nose. [rad]
    paper, ours : ndarray, shape (n,)
        Bearing by both estimators; NaN where one says nothing. [rad]
    snr : ndarray, shape (n,)
        Of the diode that hears best.
    amplitude : ndarray, shape (n, diodes)
        Of the beacon. [counts]

    """

    direction: Array
    paper: Array
    ours: Array
    snr: Array
    amplitude: Array


def read_turn(
    flight: RecordedFlight,
    diodes: DiodeArray,
    demodulation: DemodulationSettings,
    table: TurntableMotion,
    full_scale: float,
    tick: Callable[[int], None],
) -> TurntableReadings:
    """
    Return what the light blocks of a recording say.

    Parameters
    ----------
    flight : Flight
        The recording, with `photodiodes`.
    diodes : Diodes
        As the vehicle file has them.
    demodulation : Demodulation
        Which lamp.
    table : Table
        How the turntable went.
    full_scale : float
        The converter's largest reading. [counts]
    tick : callable
        Told how many blocks have been read.

    Raises
    ------
    BadInput
        If the topics are not there, the diodes are others, or too little is left of the turn.

    """
    light = load_topic_table().light
    bins = plan_bins(demodulation, light.sample_rate.si, light.samples)
    finder = DirectionFinder(diodes, compile_functions(fit_direction)[0], np.array)
    half = 0.5 * light.samples / light.sample_rate.si
    lamp = _build_true_direction(flight, table)
    found: list[tuple[float, float, float, float]] = []
    amplitudes = []
    for part in flight.iterate_blocks(PHOTODIODES, TOGETHER):
        for time, block in zip(part.time, part.samples, strict=True):
            diodes.check_count(block.shape[1])
            direction = lamp(float(time) + half)
            if math.isnan(direction):
                continue
            peaks = demodulate_block(block, (bins,), full_scale).peaks[0]
            paper = estimate_bearing(peaks, diodes.ring, demodulation.threshold)
            ours = finder.find(peaks, demodulation.threshold, LampPrior())
            found.append((
                direction, math.nan if paper is None else paper.angle,
                math.nan if ours is None else ours.azimuth, float(peaks.snr.max()),
            ))  # fmt: skip
            amplitudes.append(peaks.amplitude)
        tick(len(part.time))
    if len(found) < FEWEST:
        raise BadInput(
            f'{len(found)} light blocks are left of the turn, too few for {DIRECTIONS} '
            'directions; record for longer, or give --rate, --step and --hold as they were.'
        )
    direction, by_paper, by_fit, snr = np.array(found).T
    return TurntableReadings(direction, by_paper, by_fit, snr, np.array(amplitudes))


def _build_true_direction(
    flight: RecordedFlight, table: TurntableMotion
) -> Callable[[float], float]:
    """Return the lamp's direction at a time [rad, s]; NaN where the table was on its way."""
    first = next(iter(flight.iterate_blocks(PHOTODIODES, 1))).time[0]
    if table.step:

        def by_steps(time: float) -> float:
            steps, part = divmod((time - first) / table.hold, 1.0)
            still = SETTLED <= part <= 1.0 - SETTLED
            return wrap_angle(table.start - steps * table.step) if still else math.nan

        return by_steps
    if table.rate:
        return lambda time: wrap_angle(table.start - table.rate * (time - first))
    if TRUTH not in flight.topics:
        raise BadInput(
            f'The recording has no {TRUTH}, so how the table turned is unknown; give its --rate '
            'in degrees a second, or --step in degrees and --hold in seconds.'
        )
    series = flight.read_series(TRUTH)
    names = [f'pose.pose.orientation.{axis}' for axis in 'xyzw']
    quaternions = np.stack([series.numbers[name] for name in names], axis=1)
    yaw = np.unwrap(to_euler_angles(quaternions).yaw)
    return lambda time: wrap_angle(
        table.start - float(np.interp(time, series.time, yaw) - np.interp(first, series.time, yaw))
    )


def zero_offset(readings: TurntableReadings) -> float:
    """Return by how much the fit is turned as a whole: the error of the zero. [rad]"""
    errors = _bearing_errors(readings.ours, readings.direction)
    return float(np.nanmedian(errors))


def summarize_directions(
    readings: TurntableReadings, place: str, turned: float = 0.0
) -> tuple[RingStudy, list[int]]:
    """
    Return the median errors in each direction, and how many blocks each has.

    Parameters
    ----------
    readings : Readings
        Of a whole turn.
    place : str
        What to call it.
    turned : float
        Taken off as the error of the table's zero. [rad]

    Raises
    ------
    BadInput
        If a direction has no block.

    """
    groups = list(group_by_direction(readings.direction))
    missing = [k for k, group in enumerate(groups) if not len(group)]
    if missing:
        told = ', '.join(f'{k * 360.0 / DIRECTIONS:g}' for k in missing)
        raise BadInput(
            f'No light block has the lamp at {told} degrees; record a whole turn, or give --rate, '
            '--step and --hold as they were.'
        )
    paper, ours = (
        tuple(
            error_quantile(
                _bearing_errors(bearings[group], readings.direction[group] + turned), 50.0
            )
            for group in groups
        )
        for bearings in (readings.paper, readings.ours)
    )
    count = readings.amplitude.shape[1]
    snr = float(np.median(readings.snr))
    return RingStudy(place, count, paper, ours, snr), [len(group) for group in groups]


def group_by_direction(direction: Array) -> Iterator[NDArray[np.intp]]:
    """Yield for each of the 16 directions the blocks nearest to it."""
    nearest = np.round(direction / math.tau * DIRECTIONS).astype(int) % DIRECTIONS
    for k in range(DIRECTIONS):
        yield np.flatnonzero(nearest == k)


def _bearing_errors(bearings: Array, truth: Array) -> Array:
    return (bearings - truth + math.pi) % math.tau - math.pi
