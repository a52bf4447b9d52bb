"""
Evaluate a recording of a real light board on a turntable: the paper's polar study.

The board is level on a turntable, its nose towards a lamp 3 m away, and is recorded while it
turns. The true direction of the lamp in each light block follows from the motion of the table: in
steps as in the paper, at a constant rate, or from a tracker. A rotation of the board turns the
direction of the lamp the other way.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
import math
from pathlib import Path
from typing import Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_config.topics import load_topic_table
from lta_control.cascade import wrap_angle
from lta_data.bag.recorded_flight import open_flight, RecordedFlight
from lta_model.attitude import to_euler_angles
from lta_report.progress_bar import ProgressBar
from lta_studies.light.bearing.score import error_quantile
from lta_studies.light.bearing.study import DIRECTIONS, RingStudy
from lta_vlc.bearing import estimate_bearing
from lta_vlc.demodulation import demodulate_block, plan_bins
from lta_vlc.diodes import build_diode_array, DiodeArray
from lta_vlc.direction import DirectionFinder
from lta_vlc.lamp import LampPrior
from lta_vlc.settings import DemodulationSettings
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import TextColumn

Array = NDArray[np.float64]
PHOTODIODES: Final = 'photodiodes'
TRUTH: Final = 'ground_truth/odom'
SETTLED: Final = 0.15  # share at both ends of a hold in which the table may still move
TOGETHER: Final = 100  # blocks read at a time
FEWEST: Final = DIRECTIONS  # minimum number of blocks


class TurntableMotion(NamedTuple):
    """Motion of the turntable, counter-clockwise from above."""

    rate: float = 0.0  # constant rate; 0 for steps or a tracker [rad/s]
    step: float = 0.0  # size of a step; 0 if there are none [rad]
    hold: float = 0.0  # time from one step to the next [s]
    start: float = 0.0  # direction of the lamp from the nose in the first block [rad]
    heading: str = TRUTH  # topic with the heading, if there is neither rate nor step


@final
@dataclass(frozen=True, slots=True)
class TurntableReadings:
    """Results of the light blocks of a turn."""

    # True direction of the lamp, counter-clockwise from the nose, shape (n,) [rad]
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
    motion: TurntableMotion,
    console: Console,
) -> tuple[TurntableReadings, DiodeArray]:
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
    table: TurntableMotion,
    full_scale: float,
    tick: Callable[[int], None],
) -> TurntableReadings:
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
    finder = DirectionFinder(diodes)
    # Half the duration of a block [s]; the truth is taken at its middle.
    half = 0.5 * light.samples / light.sample_rate.si
    lamp = _build_true_direction(flight, table)
    samples: list[tuple[float, float, float, float]] = []
    amplitudes = []
    for part in flight.iterate_blocks(PHOTODIODES, TOGETHER):
        for time, block in zip(part.time, part.samples, strict=True):
            diodes.check_diode_count(block.shape[1])
            direction = lamp(float(time) + half)
            if math.isnan(direction):
                continue
            peaks = demodulate_block(block, (bins,), full_scale).peaks[0]
            paper = estimate_bearing(peaks, diodes.ring, demodulation.threshold)
            ours = finder.find(peaks, demodulation.threshold, LampPrior())
            samples.append((
                direction, math.nan if paper is None else paper.angle,
                math.nan if ours is None else ours.azimuth, float(peaks.snr.max()),
            ))  # fmt: skip
            amplitudes.append(peaks.amplitude)
        tick(len(part.time))
    if len(samples) < FEWEST:
        raise BadInput(
            f'The recording has only {len(samples)} usable blocks of photodiode samples, too few '
            f'for {DIRECTIONS} directions; record a longer turn.'
        )
    direction, by_paper, by_fit, snr = np.array(samples).T
    return TurntableReadings(direction, by_paper, by_fit, snr, np.array(amplitudes))


def _build_true_direction(
    flight: RecordedFlight, table: TurntableMotion
) -> Callable[[float], float]:
    """Return the lamp's direction [rad] by time [s]; NaN while the table moves a step."""
    first = next(iter(flight.iterate_blocks(PHOTODIODES, 1))).time[0]
    if table.step:

        def by_steps(time: float) -> float:
            # Number of completed steps, and the share of the current hold that has passed
            steps, part = divmod((time - first) / table.hold, 1.0)
            still = SETTLED <= part <= 1.0 - SETTLED
            return wrap_angle(table.start - steps * table.step) if still else math.nan

        return by_steps
    if table.rate:
        # The lamp turns the other way than the board.
        return lambda time: wrap_angle(table.start - table.rate * (time - first))
    if table.heading not in flight.topics:
        remedy = 'record it'
        if table.heading == TRUTH:
            remedy = (
                'give --rate in degrees per second, or --step in degrees and --hold in seconds'
            )
        raise BadInput(
            f'The recording has no topic {table.heading}, so its turn is unknown; {remedy}.'
        )
    series = flight.read_series(table.heading)
    names = [f'pose.pose.orientation.{axis}' for axis in 'xyzw']
    quaternions = np.stack([series.numbers[name] for name in names], axis=1)
    # Unwrapped, because interpolation across a jump of 2 pi would be wrong
    yaw = np.unwrap(to_euler_angles(quaternions).yaw)
    return lambda time: wrap_angle(
        table.start - float(np.interp(time, series.time, yaw) - np.interp(first, series.time, yaw))
    )


def zero_offset(readings: TurntableReadings) -> float:
    """Return the median error of the fit, which is the error of the table's zero. [rad]"""
    errors = _bearing_errors(readings.ours, readings.direction)
    # NaN marks blocks without an estimate.
    return float(np.nanmedian(errors))


def summarize_directions(
    readings: TurntableReadings, place: str, turned: float = 0.0
) -> tuple[RingStudy, list[int]]:
    """
    Return the median errors in each direction, and the number of blocks in each.

    `readings`: readings of a whole turn. `place`: label of the study. `turned`: error of the
    table's zero, which is subtracted [rad]. Raise `BadInput` if a direction has no block.
    """
    groups = list(group_by_direction(readings.direction))
    missing = [k for k, group in enumerate(groups) if not len(group)]
    if missing:
        angles = ', '.join(f'{k * 360.0 / DIRECTIONS:g}' for k in missing)
        raise BadInput(
            'The recording has no photodiode samples with the lamp at a bearing of '
            f'{angles} degrees; record a whole turn.'
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
    """Yield the indices of the blocks nearest to each of the 16 directions."""
    nearest = np.round(direction / math.tau * DIRECTIONS).astype(int) % DIRECTIONS
    for k in range(DIRECTIONS):
        yield np.flatnonzero(nearest == k)


def _bearing_errors(bearings: Array, truth: Array) -> Array:
    # Wrapped to [-pi, pi)
    return (bearings - truth + math.pi) % math.tau - math.pi
