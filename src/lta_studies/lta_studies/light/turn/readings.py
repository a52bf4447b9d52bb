# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Evaluate a recording of a real light board that turns in front of a lamp.

The board is level and turns once or more: in flight, by hand, or on a turntable. The true
direction of the lamp in each light block follows from the odometry, or from the motion of the
table: in steps as in the paper, or at a constant rate. A rotation of the board turns the direction
of the lamp the other way. Where the nose was in the first block is not known: the median error of
the fit is subtracted.

A diode whose axis is at an angle a from the lamp reads

    M_i = g_i (S max(0, cos a)^p / d^2 + P + s1 cos a + s2 sin a + b1 cos 2a + b2 sin 2a)

with gains of mean 1. d is its distance from the lamp over that of the middle of the diodes: the
one that faces the lamp is nearer, which looks like a larger exponent. The diffuse light has a
pedestal P and two harmonics, as in the model by which the drone steers (`lta_vlc.reading_model`);
the diodes that look away from the lamp show them. Standard deviations are a jackknife over the
directions: model errors vary with direction, so that noise alone would underestimate them.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
import math
from pathlib import Path
from typing import Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_config.topics import load_topic_table
from lta_control.motion import wrap_angle
from lta_data.bag.recorded_flight import open_flight, RecordedFlight
from lta_data.bag.table import get_column
from lta_report.progress_bar import ProgressBar
from lta_studies.light.bearing.bench import DIRECTION_COUNT, error_quantile
from lta_vlc.demodulation import demodulate_block, plan_bins
from lta_vlc.diodes import build_diode_array, DiodeArray
from lta_vlc.lamp import LampFinder, LampPrior
from lta_vlc.settings import DemodulationSettings
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import TextColumn
from scipy.optimize import least_squares

Array = NDArray[np.float64]
PHOTODIODES: Final = 'photodiodes'
MOVING_SHARE: Final = 0.15  # share at both ends of a hold in which the table may still move
BLOCKS_PER_READ: Final = 100  # blocks read at a time
FEWEST_LIGHT_BLOCKS: Final = DIRECTION_COUNT  # minimum number of blocks


class TurnMotion(NamedTuple):
    """Motion of the board, counter-clockwise from above."""

    heading: str  # odometry topic with the heading, if there is neither rate nor step
    rate: float = 0.0  # constant rate of a turntable; 0 for steps or odometry [rad/s]
    step: float = 0.0  # size of a step; 0 if there are none [rad]
    hold: float = 0.0  # time from one step to the next [s]


@final
@dataclass(frozen=True, slots=True)
class TurnReadings:
    """Results of the light blocks of a turn."""

    # True direction of the lamp, counter-clockwise from the nose, but for an unknown angle that is
    # the same in all blocks, shape (n,) [rad]
    direction: Array
    # Bearings by both estimators; NaN without an estimate, shape (n,) [rad]
    paper: Array
    ours: Array
    snr: Array  # SNR of the best diode, shape (n,)
    amplitude: Array  # amplitude of the beacon, shape (n, diodes) [counts]


def read_turn(
    bag: Path,
    robot: str | None,
    vehicle: str,
    frequency: float,
    motion: TurnMotion,
    console: Console,
) -> tuple[TurnReadings, DiodeArray]:
    """Evaluate the light blocks of a bag with the diodes of a vehicle, with progress."""
    flight = open_flight(bag, robot)
    entry = load_vehicle_file(vehicle).sensors.diodes
    diodes = build_diode_array(entry)
    demodulation = DemodulationSettings(frequency=frequency)
    with ProgressBar(console, TextColumn('reading light blocks {task.completed:.0f}')) as bar:
        readings = evaluate_turn(
            flight, diodes, demodulation, motion, entry.largest_reading,
            lambda blocks: bar.update_bar(advance=blocks),
        )  # fmt: skip
    return readings, diodes


def evaluate_turn(
    flight: RecordedFlight,
    diodes: DiodeArray,
    demodulation: DemodulationSettings,
    motion: TurnMotion,
    full_scale: float,
    tick: Callable[[int], None],
) -> TurnReadings:
    """
    Evaluate the light blocks of a recording.

    Parameters
    ----------
    flight : RecordedFlight
        Recording with the topic `photodiodes`.
    demodulation : DemodulationSettings
        Demodulator for the lamp.
    full_scale : float
        Full scale of the ADC. [counts]
    tick : callable
        Progress callback: number of blocks read since its last call.

    Raises
    ------
    BadInput
        If topics are missing, the number of diodes differs, or too few blocks are usable.

    """
    light = load_topic_table().light
    bins = plan_bins(demodulation, light.sample_rate.si, light.samples)
    finder = LampFinder(diodes)
    # Half the duration of a block [s]; the truth is taken at its middle.
    half = 0.5 * light.samples / light.sample_rate.si
    lamp = _build_true_direction(flight, motion)
    samples: list[tuple[float, float, float, float]] = []
    amplitudes = []
    for part in flight.iterate_blocks(PHOTODIODES, BLOCKS_PER_READ):
        for time, block in zip(part.time, part.samples, strict=True):
            diodes.check_diode_count(block.shape[1])
            direction = lamp(float(time) + half)
            if math.isnan(direction):
                continue
            peaks = demodulate_block(block, (bins,), full_scale).peaks[0]
            paper, ours, _ = finder.find_lamp(peaks, demodulation.threshold, LampPrior())
            samples.append((
                direction, math.nan if paper is None else paper.angle,
                math.nan if ours is None else ours.azimuth, float(peaks.snr.max()),
            ))  # fmt: skip
            amplitudes.append(peaks.amplitude)
        tick(len(part.time))
    if len(samples) < FEWEST_LIGHT_BLOCKS:
        raise BadInput(
            f'The recording has only {len(samples)} usable blocks of photodiode samples, too few '
            f'for {DIRECTION_COUNT} directions; record a longer turn.'
        )
    direction, by_paper, by_fit, snr = np.array(samples).T
    return TurnReadings(direction, by_paper, by_fit, snr, np.array(amplitudes))


def _build_true_direction(flight: RecordedFlight, motion: TurnMotion) -> Callable[[float], float]:
    """Return the lamp's direction [rad] by time [s]; NaN while the table moves a step."""
    first = next(iter(flight.iterate_blocks(PHOTODIODES, 1))).time[0]
    if motion.step:

        def by_steps(time: float) -> float:
            # Number of completed steps, and the share of the current hold that has passed
            steps, part = divmod((time - first) / motion.hold, 1.0)
            still = MOVING_SHARE <= part <= 1.0 - MOVING_SHARE
            return wrap_angle(-steps * motion.step) if still else math.nan

        return by_steps
    if motion.rate:
        # The lamp turns the other way than the board.
        return lambda time: wrap_angle(-motion.rate * (time - first))
    if motion.heading not in flight.topics:
        raise BadInput(
            f'The recording has no topic {motion.heading}, so its turn is unknown; record it, or '
            'give the motion of a turntable: --rate in degrees per second, or --step in degrees '
            'and --hold in seconds.'
        )
    turn = flight[motion.heading]
    # Unwrapped, because interpolation across a jump of 2 pi would be wrong
    yaw = np.unwrap(get_column(turn, 'pose.pose.orientation.yaw'))
    return lambda time: wrap_angle(
        float(np.interp(first, turn.index, yaw) - np.interp(time, turn.index, yaw))
    )


def align_directions(readings: TurnReadings) -> TurnReadings:
    """Return readings whose directions begin where the nose was: by the median of the fit."""
    # NaN marks blocks without an estimate; about the mean angle, so that none is half a turn off
    errors = _bearing_errors(readings.ours, readings.direction)
    middle = np.angle(np.nanmean(np.exp(1j * errors)))
    zero = middle + np.nanmedian(_bearing_errors(errors, middle))
    return replace(readings, direction=_bearing_errors(readings.direction + zero, 0.0))


class DirectionErrors(NamedTuple):
    """Errors of a whole turn, by direction of the lamp."""

    # Median error of both estimators in each direction [rad]
    paper: tuple[float, ...]
    ours: tuple[float, ...]
    blocks: list[int]  # blocks in each direction
    snr: float  # median SNR of the best diode


def summarize_directions(readings: TurnReadings) -> DirectionErrors:
    """Return the errors of a whole turn; raise `BadInput` if a direction has no block."""
    groups = list(group_by_direction(readings.direction))
    missing = [k for k, group in enumerate(groups) if not len(group)]
    if missing:
        angles = ', '.join(f'{k * 360.0 / DIRECTION_COUNT:g}' for k in missing)
        raise BadInput(
            'The recording has no photodiode samples with the lamp at a bearing of '
            f'{angles} degrees; record a whole turn.'
        )
    paper, ours = (
        tuple(
            error_quantile(_bearing_errors(bearings[group], readings.direction[group]), 50.0)
            for group in groups
        )
        for bearings in (readings.paper, readings.ours)
    )
    return DirectionErrors(
        paper, ours, [len(group) for group in groups], float(np.median(readings.snr))
    )


def group_by_direction(direction: Array) -> Iterator[NDArray[np.intp]]:
    """Yield the indices of the blocks nearest to each of the 16 directions."""
    nearest = np.round(direction / math.tau * DIRECTION_COUNT).astype(int) % DIRECTION_COUNT
    for k in range(DIRECTION_COUNT):
        yield np.flatnonzero(nearest == k)


def _bearing_errors(bearings: Array, truth: Array | float) -> Array:
    # Wrapped to [-pi, pi)
    return np.asarray((bearings - truth + math.pi) % math.tau - math.pi)


BEGIN_AT = 1.2  # initial exponent of the fit
DIFFUSE = 5  # pedestal, and cosine and sine of its two harmonics
SHARED_PARAMETERS = 2 + DIFFUSE  # parameters besides the gains: exponent and strength as well
EXPONENT_BOUNDS = (0.1, 20.0)  # as the vehicle file allows


@final
class FittedResponse(NamedTuple):
    """Fitted response with standard deviations."""

    # Exponent p
    exponent: float
    exponent_deviation: float
    # Gain of each diode; their mean is 1
    gains: tuple[float, ...]
    gain_deviations: tuple[float, ...]
    strength: float  # S, reading of a nominal diode that faces the lamp [counts]
    pedestal: float  # p relative to S
    misfit: float  # rms residual relative to S

    @property
    def gain_uncertainty(self) -> float:
        """Rms standard deviation of the fitted gains."""
        return math.sqrt(sum(each * each for each in self.gain_deviations) / len(self.gains))

    @property
    def gain_spread(self) -> float:
        """Return the standard deviation of the gains among the diodes."""
        return float(np.std(self.gains, ddof=1)) if len(self.gains) > 1 else 0.0


class TurnBasis(NamedTuple):
    """What the model is made of, as means over groups of blocks, for a level lamp."""

    # Cosine between the axis of each diode and the lamp, 0 if it looks away; and d, shape (n,
    # diodes)
    cosine: Array
    distance: Array
    diffuse: Array  # harmonics of the diffuse light at each diode, shape (DIFFUSE, n, diodes)

    def select(self, some: NDArray[np.bool_]) -> 'TurnBasis':
        """Return some of the groups."""
        return TurnBasis(self.cosine[some], self.distance[some], self.diffuse[:, some])


def build_basis(
    direction: Array, groups: Sequence[NDArray[np.intp]], diodes: DiodeArray, lamp: float
) -> TurnBasis:
    """Return the basis for directions of the lamp [rad], which is `lamp` m away."""
    axes, places = np.array(diodes.axes), np.array(diodes.places)
    # From each diode to the lamp, in units of its distance; shape (blocks, diodes, 3)
    ray = np.stack([np.cos(direction), np.sin(direction), np.zeros_like(direction)], axis=1)
    way = ray[:, None] - places / lamp
    distance = np.linalg.norm(way, axis=2)
    cosine = np.maximum(np.einsum('ij,nij->ni', axes, way) / distance, 0.0)
    apart = np.arctan2(axes[:, 1], axes[:, 0]) - direction[:, None]
    level = np.hypot(axes[:, 0], axes[:, 1])
    rows = (
        np.ones_like(apart), level * np.cos(apart), level * np.sin(apart),
        np.cos(2 * apart), np.sin(2 * apart),
    )  # fmt: skip
    cosine, distance, *diffuse = (
        np.stack([row[group].mean(axis=0) for group in groups])
        for row in (cosine, distance, *rows)
    )
    return TurnBasis(cosine, distance, np.stack(diffuse))


def fit_response(
    readings: TurnReadings, diodes: DiodeArray, lamp: float = math.inf
) -> FittedResponse:
    """
    Fit the response to the readings of a whole turn.

    `readings`: readings of a whole turn. `lamp`: distance of the lamp from the middle of the
    diodes [m].
    """
    groups = [group for group in group_by_direction(readings.direction) if len(group)]
    basis = build_basis(readings.direction, groups, diodes, lamp)
    # The median ignores single disturbed blocks.
    amplitude = np.stack([np.median(readings.amplitude[group], axis=0) for group in groups])
    best = _fit_parameters(basis, amplitude)
    # Row k leaves out direction k.
    keep = ~np.eye(len(groups), dtype=bool)
    others = np.array([_fit_parameters(basis.select(some), amplitude[some]) for some in keep])
    count = len(groups)
    about = others - others.mean(axis=0)
    # Jackknife variance: (n - 1) / n times the sum of squares
    deviation = np.sqrt((count - 1) / count * np.sum(about * about, axis=0))
    exponent, strength, pedestal = best[:3]
    left = _predict_amplitude(best, basis) - amplitude
    return FittedResponse(
        float(exponent), float(deviation[0]), tuple(best[SHARED_PARAMETERS:].tolist()),
        tuple(deviation[SHARED_PARAMETERS:].tolist()), float(strength), float(pedestal / strength),
        float(math.sqrt(np.mean(left * left)) / strength),
    )  # fmt: skip


def _predict_amplitude(values: Array, basis: TurnBasis) -> Array:
    exponent, strength, gains = values[0], values[1], values[SHARED_PARAMETERS:]
    around = np.tensordot(values[2:SHARED_PARAMETERS], basis.diffuse, axes=1)
    direct = strength * np.power(basis.cosine, exponent) / basis.distance**2
    amplitude: Array = gains * (direct + around)
    return amplitude


def _fit_parameters(basis: TurnBasis, amplitude: Array) -> Array:
    """Return exponent, strength, diffuse light and gains, with the mean gain fixed to 1."""
    top = float(amplitude.max())
    scale = np.array([1.0, *(top,) * (SHARED_PARAMETERS - 1)])

    def expand_parameters(values: Array) -> Array:
        # The last gain follows from the mean of 1, as a common factor is part of the strength.
        last = amplitude.shape[1] - values[SHARED_PARAMETERS:].sum()
        return np.concatenate(
            [scale * values[:SHARED_PARAMETERS], values[SHARED_PARAMETERS:], [last]]
        )

    def residuals(values: Array) -> Array:
        # Scaled to order 1, so that the tolerances of the solver fit
        predicted = _predict_amplitude(expand_parameters(values), basis)
        return ((predicted - amplitude) / top).ravel()

    begin = np.zeros(SHARED_PARAMETERS + amplitude.shape[1] - 1)
    begin[:3], begin[SHARED_PARAMETERS:] = (BEGIN_AT, 1.0, 0.01), 1.0
    low, high = np.full(len(begin), -1.0), np.full(len(begin), 10.0)
    (low[0], high[0]), low[1:3], low[SHARED_PARAMETERS:] = EXPONENT_BOUNDS, 0.0, 0.0
    solution = least_squares(residuals, begin, bounds=(low, high))
    return expand_parameters(solution.x)
