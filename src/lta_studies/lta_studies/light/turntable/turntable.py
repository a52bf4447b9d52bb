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

from lta_config.compilation.compiled import compiled
from lta_config.errors import BadInput
from lta_config.topics import topic_table
from lta_control.cascade import wrap
from lta_data.bag.flight import Flight
from lta_model.attitude import angles
from lta_studies.light.bearing.score import quantile
from lta_studies.light.bearing.study import DIRECTIONS, Studied
from lta_vlc.array import bearing
from lta_vlc.demodulation import hear, plan_bins
from lta_vlc.diodes import Diodes
from lta_vlc.direction import DirectionFinder
from lta_vlc.fit import fit
from lta_vlc.lamp import LampPrior
from lta_vlc.settings import Demodulation
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
PHOTODIODES: Final = 'photodiodes'
TRUTH: Final = 'ground_truth/odom'
SETTLED: Final = 0.15  # part of each hold, at both of its ends, in which the table may still turn
TOGETHER: Final = 100  # blocks that are read at a time
FEWEST: Final = DIRECTIONS  # blocks without which there is no study


class Table(NamedTuple):
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
class Readings:
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


def read(
    flight: Flight,
    diodes: Diodes,
    demodulation: Demodulation,
    table: Table,
    full_scale: float,
    tick: Callable[[int], None],
) -> Readings:
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
    light = topic_table().light
    bins = plan_bins(demodulation, light.sample_rate.si, light.samples)
    finder = DirectionFinder(diodes, compiled(fit)[0], np.array)
    half = 0.5 * light.samples / light.sample_rate.si
    lamp = _truth(flight, table)
    found: list[tuple[float, float, float, float]] = []
    amplitudes = []
    for part in flight.block_parts(PHOTODIODES, TOGETHER):
        for time, block in zip(part.time, part.samples, strict=True):
            diodes.check(block.shape[1])
            direction = lamp(float(time) + half)
            if math.isnan(direction):
                continue
            peaks = hear(block, (bins,), full_scale).peaks[0]
            paper = bearing(peaks, diodes.ring, demodulation.threshold)
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
    return Readings(direction, by_paper, by_fit, snr, np.array(amplitudes))


def _truth(flight: Flight, table: Table) -> Callable[[float], float]:
    """Return the lamp's direction at a time [rad, s]; NaN where the table was on its way."""
    first = next(iter(flight.block_parts(PHOTODIODES, 1))).time[0]
    if table.step:

        def by_steps(time: float) -> float:
            steps, part = divmod((time - first) / table.hold, 1.0)
            still = SETTLED <= part <= 1.0 - SETTLED
            return wrap(table.start - steps * table.step) if still else math.nan

        return by_steps
    if table.rate:
        return lambda time: wrap(table.start - table.rate * (time - first))
    if TRUTH not in flight.topics:
        raise BadInput(
            f'The recording has no {TRUTH}, so how the table turned is unknown; give its --rate '
            'in degrees a second, or --step in degrees and --hold in seconds.'
        )
    series = flight.series(TRUTH)
    names = [f'pose.pose.orientation.{axis}' for axis in 'xyzw']
    quaternions = np.stack([series.numbers[name] for name in names], axis=1)
    yaw = np.unwrap(angles(quaternions).yaw)
    return lambda time: wrap(
        table.start - float(np.interp(time, series.time, yaw) - np.interp(first, series.time, yaw))
    )


def offset(readings: Readings) -> float:
    """Return by how much the fit is turned as a whole: the error of the zero. [rad]"""
    errors = _errors(readings.ours, readings.direction)
    return float(np.nanmedian(errors))


def studied(readings: Readings, place: str, turned: float = 0.0) -> tuple[Studied, list[int]]:
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
    groups = list(grouped(readings.direction))
    missing = [k for k, group in enumerate(groups) if not len(group)]
    if missing:
        told = ', '.join(f'{k * 360.0 / DIRECTIONS:g}' for k in missing)
        raise BadInput(
            f'No light block has the lamp at {told} degrees; record a whole turn, or give --rate, '
            '--step and --hold as they were.'
        )
    paper, ours = (
        tuple(
            quantile(_errors(bearings[group], readings.direction[group] + turned), 50.0)
            for group in groups
        )
        for bearings in (readings.paper, readings.ours)
    )
    count = readings.amplitude.shape[1]
    snr = float(np.median(readings.snr))
    return Studied(place, count, paper, ours, snr), [len(group) for group in groups]


def grouped(direction: Array) -> Iterator[NDArray[np.intp]]:
    """Yield for each of the 16 directions the blocks nearest to it."""
    nearest = np.round(direction / math.tau * DIRECTIONS).astype(int) % DIRECTIONS
    for k in range(DIRECTIONS):
        yield np.flatnonzero(nearest == k)


def _errors(bearings: Array, truth: Array) -> Array:
    return (bearings - truth + math.pi) % math.tau - math.pi
