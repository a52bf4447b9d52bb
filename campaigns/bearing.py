# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Score the bearing to a lamp: the paper's weighted mean, and the fit by which the drone steers.

Draws random poses within 60 degrees of the lamp's axis, anywhere in the scene, and simulates
light, hull, amplifiers, ADC and demodulator. A kind is a place and a ring of diodes; in some, the
diodes are others than the vehicle file says, which the drone assumes. The table has the median
error of both, that of an unbiased estimator whose deviation is the Cramer-Rao bound at every pose,
and how often the fit's 95 % interval holds.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Sequence
import math
from typing import Final, NamedTuple

from lta_model.scenario import Scenario
from lta_model.sensors.photodiode import PhotodiodeArray
from lta_studies.light.bearing.bench import (
    BEARING_PLACES,
    BearingBench,
    BearingReading,
    build_flight_spec,
    error_quantile,
    Pose,
    TrueDiodes,
)
from lta_vlc.demodulation import Peaks
from lta_vlc.lamp import RAYLEIGH_SHARE
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation
from scipy.special import erf
from scipy.stats import binom

from campaigns.harness import Campaign, Case, Row, Rows

Array = NDArray[np.float64]
INTERVAL: Final = 1.959964  # half width of the 95 % interval in standard deviations
PERCENT: Final = 95.0
LEAST_HOLDS: Final = 0.9  # of the readings, whatever the diodes are
OTHER_SPREAD: Final = 0.05  # of the gains
HULL_HEIGHTS: Final = 0.5, 1.5  # range of the hull centre's height, uniform [m]
TILT_DEVIATION: Final = math.radians(2.0)  # standard deviation of pitch and roll [rad]
LARGEST_OFF_AXIS: Final = math.radians(60.0)  # to the lamp's axis, seen from above [rad]
WALL_DISTANCE: Final = 0.6  # minimum distance of the hull centre to a wall [m]
NEAREST: Final = 1.5  # minimum distance to the lamp; nearer, the diodes saturate [m]
FIELD_HALF_WIDTH: Final = 12.0  # maximum |x| and |y| of places in an open field [m]
POSE_TRIES: Final = 10_000


class BearingKind(NamedTuple):
    """A place, a number of diodes, and the simulated diodes where the file's are wrong."""

    place: str
    ring: int
    diodes: TrueDiodes = TrueDiodes()


AS_FILED: Final = {
    f'{place} | {ring}': BearingKind(place, ring)
    for place in BEARING_PLACES
    for ring in (4, 8, 16)
}
OTHERS: Final = {
    f'cos^{response:g} for cos^1.2, gains that spread by 5 %': BearingKind(
        'indoor', 8, TrueDiodes(response, OTHER_SPREAD)
    )
    for response in (1.0, 1.2, 1.6, 2.0)
}
KINDS: Final = AS_FILED | OTHERS


def draw_pose(scenario: Scenario, chance: Generator) -> Pose:
    """Draw a pose anywhere in the room and within the lamp's beam."""
    height = chance.uniform(*HULL_HEIGHTS)
    # A field is far larger than the range of the lamp, so places are limited to its middle.
    reach = [
        min(0.5 * side - WALL_DISTANCE, FIELD_HALF_WIDTH) for side in scenario.room.size.vector[:2]
    ]
    while True:
        x, y = (chance.uniform(-each, each) for each in reach)
        if is_within_lamp_beam(scenario, x, y):
            break
    pitch, roll = TILT_DEVIATION * chance.standard_normal(2)
    # Upper-case axes are intrinsic: yaw, then pitch, then roll.
    turn = Rotation.from_euler('ZYX', [chance.uniform(-math.pi, math.pi), pitch, roll])
    return (x, y, height, *turn.as_quat().tolist())


def is_within_lamp_beam(scenario: Scenario, x: float, y: float) -> bool:
    """Return whether a place [m] is within the lamp's beam and far enough away from it."""
    lamp_x, lamp_y, _ = scenario.goal_lamp.position.vector
    ahead = np.array(scenario.goal_lamp.facing.vector[:2])
    way = np.array([x - lamp_x, y - lamp_y])
    away = math.hypot(*way)
    within = way @ ahead >= math.cos(LARGEST_OFF_AXIS) * away * math.hypot(*ahead)
    return bool(within) and away >= NEAREST


def bearing_bound(
    diodes: PhotodiodeArray, peaks: Peaks, azimuth: float, elevation: float
) -> float:
    """
    Return the Cramer-Rao bound of the bearing's standard deviation [rad].

    For an unbiased estimator that knows everything but the azimuth, the lamp's strength and an
    even pedestal: noise and unequal gains are all that disturbs it. Reflections and an unknown
    response come on top. Infinite if the readings do not depend on the azimuth.
    """
    axes = diodes.planes[:, 3:]
    level = math.cos(elevation)
    ray = np.array([level * math.cos(azimuth), level * math.sin(azimuth), math.sin(elevation)])
    left = np.array([-level * math.sin(azimuth), level * math.cos(azimuth), 0.0])
    cosine = np.maximum(axes @ ray, 0.0)
    facing = cosine**diodes.response
    slope = np.where(
        cosine > 0.0, diodes.response * facing / np.maximum(cosine, 1e-12) * (axes @ left), 0.0
    )
    # Strength and pedestal are linear; the readings give them
    linear = np.stack([facing, np.ones(len(axes))], axis=1)
    strength, pedestal = np.linalg.lstsq(linear, peaks.amplitude, rcond=None)[0]
    expected = strength * facing + pedestal
    variance = (RAYLEIGH_SHARE * peaks.noise) ** 2 + (diodes.gain_spread * expected) ** 2
    jacobian = np.column_stack([strength * slope, linear])
    information = jacobian.T @ (jacobian / variance[:, None])
    # Schur complement of the azimuth
    rest = (
        information[0, 0]
        - information[0, 1:]
        @ np.linalg.lstsq(information[1:, 1:], information[1:, 0], rcond=None)[0]
    )
    return float(1.0 / math.sqrt(rest)) if rest > 0.0 else math.inf


def median_interval(errors: Array) -> tuple[float, float]:
    """
    Return the 95 % interval of the median of the absolute errors, by their order alone.

    The number of errors below the true median is binomial, whatever their distribution (David and
    Nagaraja 2003, Order Statistics, 7.1). NaN of fewer than six errors, which have no such
    interval.
    """
    finite = np.sort(np.abs(errors[np.isfinite(errors)]))
    # The interval begins at the last error that so few lie below with a chance of at most 2.5 %
    first = int(binom.ppf(0.5 - 0.005 * PERCENT, len(finite), 0.5)) - 1 if finite.size else -1
    if first < 0:
        return math.nan, math.nan
    return float(finite[first]), float(finite[-1 - first])


def median_normal_error(deviations: Array) -> float:
    """Return the median of absolute normal errors, one of each deviation; NaN of none."""
    finite = deviations[np.isfinite(deviations)]
    if not finite.size:
        return math.nan
    ends = 0.0, float(finite.max())
    # Half of all errors are smaller; at the largest deviation more than two thirds are
    return float(brentq(lambda error: np.mean(erf(error / finite / math.sqrt(2.0))) - 0.5, *ends))


def interval_coverage(errors: Array, deviations: Array, width: float) -> float:
    """Return the share of errors within `width` times their deviations [1]."""
    finite = np.isfinite(errors)
    if not finite.any():
        return math.nan
    return float(np.mean(np.abs(errors[finite]) < width * deviations[finite]))


def simulate_readings(
    kind: BearingKind, poses: int, seed: int
) -> tuple[BearingBench, list[BearingReading]]:
    """Return a bench and its readings at random poses, each with its own diode gains."""
    place = BEARING_PLACES[kind.place]
    bench = BearingBench(
        build_flight_spec(place, 'gtmab', kind.ring),
        build_flight_spec(place, 'gtmab', kind.ring, kind.diodes),
    )
    # Separate streams, so that rings of different size see the same poses
    where, what = (np.random.default_rng([seed, k]) for k in range(2))
    readings = []
    for _ in range(poses):
        pose, diodes = draw_pose(bench.scenario, where), bench.sample_diode_gains(what)
        readings.append(bench.estimate_block_bearing(pose, diodes, what))
    return bench, readings


def score_readings(readings: Sequence[BearingReading], bounds: Sequence[float]) -> Row:
    """Return medians with their intervals, 95 % quantiles [rad] and coverage of readings."""
    paper, ours, deviation = (
        np.array([getattr(each, name) for each in readings])
        for name in ('paper', 'ours', 'deviation')
    )
    return {
        'snr': float(np.median([each.snr for each in readings])),
        'bound': median_normal_error(np.array(bounds)),
        'paper': (error_quantile(paper, 50.0), *median_interval(paper)),
        'paper_most': error_quantile(paper, PERCENT),
        'ours': (error_quantile(ours, 50.0), *median_interval(ours)),
        'ours_most': error_quantile(ours, PERCENT),
        'holds': interval_coverage(ours, deviation, INTERVAL),
    }


def score_bearings(case: Case, options: Namespace) -> Row:
    """Score a kind; a fit worse than the mean, or an interval that is too narrow, is wrong."""
    kind = KINDS[case.kind]
    bench, readings = simulate_readings(kind, options.poses, options.seed + case.number)
    bounds = [
        bearing_bound(bench.diodes, each.peaks, each.azimuth, each.elevation) for each in readings
    ]
    row = score_readings(readings, bounds)
    # By the intervals of both medians
    worse = row['ours'][1] > row['paper'][2]
    faults = ['the fit is worse than the mean'] * worse
    faults += ['the interval of the fit claims too much'] * (row['holds'] < LEAST_HOLDS)
    return row | {'wrong': ', '.join(faults)}


def format_median(median: Sequence[float]) -> str:
    """Return a median with its interval in degrees."""
    best, low, high = map(math.degrees, median)
    return f'{best:.2f}° ({low:.2f} to {high:.2f})'


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield the lines of the table, and a sentence on the other diodes."""
    yield (
        '| place | diodes | SNR | bound | paper: median error | paper: 95 % quantile |'
        ' fit: median error | fit: 95 % quantile | fit: coverage |'
    )
    yield '|---|---|---|---|---|---|---|---|---|'
    found = {case.kind: row for case, row in rows.items() if 'ours' in row}
    for name in filter(found.__contains__, AS_FILED):
        row = found[name]
        yield (
            f'| {name} | {row["snr"]:.0f} | {math.degrees(row["bound"]):.2f}° |'
            f' {format_median(row["paper"])} | {math.degrees(row["paper_most"]):.1f}° |'
            f' {format_median(row["ours"])} | {math.degrees(row["ours_most"]):.1f}° |'
            f' {100 * row["holds"]:.1f} % |'
        )
    others = [found[name] for name in OTHERS if name in found]
    if others:
        errors = [math.degrees(row['ours'][0]) for row in others]
        lowest = min(row['holds'] for row in others)
        yield ''
        yield (
            'With diodes that differ from the file, the fit loses: with gains that spread by 5 % '
            f'and responses from cos to cos², its median error indoors with 8 diodes is '
            f'{min(errors):.1f} to {max(errors):.1f}° and its coverage down to '
            f'{100 * lowest:.1f} %.'
        )


def add_arguments(parser: ArgumentParser) -> None:
    """Add the number of poses."""
    parser.add_argument('--poses', type=int, default=300, help='random poses of each kind')


CAMPAIGN: Final = Campaign(
    lambda options: list(KINDS),
    score_bearings,
    list_table,
    add_arguments=add_arguments,
    page='bearing.md',
    smoke="--poses 30 --kinds 'indoor | 8'",
)
