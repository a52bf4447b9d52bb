# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Detect a vehicle held in a hand: motion that no free airship makes.

Two rules. A hand trembles at 6 to 12 Hz (physiological tremor): that band exceeds the adjacent
ones and its usual level in the flight, while rotors and noise are broad or faster, and a hull
swings below 1 Hz. And a hand moves a vehicle with idle rotors, also up and down, while a free one
only drifts, swings ever less, or falls.
"""

from collections.abc import Iterator
import math
from typing import final, NamedTuple

from lta_config.limits import GRID_POINTS
from lta_data.data_quality import limits, roles
from lta_data.data_quality.free_swing import fit_pendulum_law
from lta_data.data_quality.motion import VectorSeries
from lta_data.data_quality.recording import CheckContext, CheckVerdict, QualityFinding, Severity
from lta_data.even_grid import (
    build_uniform_time_grid,
    find_runs,
    FINEST,
    hann_kernel,
    interpolate_on_grid,
    median_period,
    merge_runs,
    NO_SAMPLES,
    smooth_columns,
)
from lta_data.flight import Flight
from lta_data.interpretation.jumps import find_tracker_jumps
import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from scipy.signal import spectrogram

Array = NDArray[np.float64]
KIND = 'held'
HOP = 4  # steps per window
FLANKS = (3.5, 5.0, 13.0, 20.0)  # bands below and above the tremor [Hz]
SETTLING_TIME = 1.0  # time to coast, fall and settle after the rotors stop [s]
LIFTED_SPEED = 0.3  # least range of the vertical speed in a hand [m/s]
HAND_SMOOTHING = 0.5  # smoothing; motion of a hand is slower [s]
MIN_SWINGS = 3.0  # fewest periods of a free swing: a shorter motion of a hand may follow its law
# Of the acceleration of a free swing, its law explains more; of 12 s carried by hand at most 0.6
LAWFUL_SWING = 0.95
SIDEWAYS = 0.3  # most horizontal speed of a drop, relative to the vertical one
BUMPS = 0.02  # most decrease of the speed of a drop in a step, relative to the largest
FINAL = 0.9  # of the largest speed of a drop, which falls below only by an impact
RESTING_SPEED_SHARE = 0.2  # of the same; most speed after the impact
ZERO_FORCE = 1e-3  # smaller commanded forces count as zero [N]


@final
class TremorLevels(NamedTuple):
    """RMS acceleration in the tremor band and the adjacent bands, by window [m/s2]."""

    time: Array
    tremor: Array
    below: Array
    above: Array


def find_hand_motion(evidence: CheckContext) -> CheckVerdict:
    """Find stretches in which a hand held the vehicle."""
    findings: list[QualityFinding] = []
    unjudged: list[str] = []
    sources = [sensor.force for sensor in evidence.inertials if sensor.force is not None]
    places = [
        pose.position for pose in evidence.poses if pose.tracked and pose.position is not None
    ]
    count = 0
    for force in sources:
        count += bool(is_sampled_fast_enough(force))
        findings += find_tremor(force, force.values)
    for place in places:
        count += bool(is_sampled_fast_enough(place))
        findings += find_tremor(place, compute_acceleration(place))
    idle = find_idle_times(evidence.recording)
    if idle is None:
        unjudged.append(
            'Motion with idle rotors cannot be judged: no actuator commands are recorded.'
        )
    else:
        for place in places:
            findings += find_idle_motion(place, *idle)
    if not count:
        unjudged.append(
            'Whether a hand held the vehicle cannot be judged: no channel is sampled fast enough '
            'to show tremor at up to 12 Hz.'
        )
    return CheckVerdict(tuple(findings), tuple(unjudged))


def is_sampled_fast_enough(vector: VectorSeries) -> bool:
    """Return whether a vector is sampled fast enough for the bands."""
    return len(vector.time) > 200 and median_period(vector.time) <= 0.5 / FLANKS[2] * 0.75


def compute_acceleration(place: VectorSeries) -> Array:
    """Return the second derivative of a position [m/s2]."""
    return np.asarray(np.gradient(np.gradient(place.values, place.time, axis=0), place.time,
                                  axis=0))  # fmt: skip


def measure_tremor(vector: VectorSeries, values: Array) -> TremorLevels:
    """Return the RMS in the bands, by windows on an even grid."""
    step = median_period(vector.time)
    grid = build_uniform_time_grid(vector.time[0], vector.time[-1], step, len(vector.time))
    table, valid = interpolate_on_grid(vector.time, values, grid)
    count = round(min(limits.HOLD_WINDOW / max(FINEST, step), GRID_POINTS))
    if len(grid) < count:  # stamps that span years
        return TremorLevels(NO_SAMPLES, NO_SAMPLES, NO_SAMPLES, NO_SAMPLES)
    lines, middles, power = spectrogram(  # type: ignore[call-overload]
        # Without the zeros at both ends, which would waste two samples
        table.T, 1.0 / step, np.hanning(count + 2)[1:-1],
        noverlap=count - max(1, count // HOP),
    )  # fmt: skip
    at = np.rint(middles / step - count / 2).astype(np.intp)
    whole = sliding_window_view(valid, count)[at].all(axis=1)
    power = power.sum(axis=0)  # of all axes, shape (lines, windows) [m2/s4/Hz]

    def level(low: float, high: float) -> Array:
        # Near the Nyquist frequency, interpolation has removed the power
        inside = (lines >= low) & (lines <= min(high, 0.9 * lines[-1]))
        if not inside.any():  # too many messages in a moment to resolve a band
            return np.zeros(len(at))
        # Scaled to the width of the tremor band, so that levels are comparable.
        width = limits.TREMOR_HIGH - limits.TREMOR_LOW
        return np.where(whole, np.sqrt(power[inside].mean(axis=0) * width), 0.0)

    return TremorLevels(
        grid[at] + limits.HOLD_WINDOW / 2,
        level(limits.TREMOR_LOW, limits.TREMOR_HIGH),
        level(FLANKS[0], FLANKS[1]),
        level(FLANKS[2], FLANKS[3]),
    )


def find_tremor(vector: VectorSeries, values: Array) -> Iterator[QualityFinding]:
    """Yield stretches with the tremor of a hand."""
    if not is_sampled_fast_enough(vector):
        return
    felt = measure_tremor(vector, values)
    # The quiet quarter of the flight, even if it was held most of the time.
    usual = float(np.percentile(felt.tremor[felt.tremor > 0.0], 25)) if felt.tremor.any() else 0.0
    hand = (
        # Tremor is a peak between both flanks; motors and turbulence have wider spectra
        (felt.tremor > limits.TREMOR_FORCE)
        & (felt.tremor > limits.TREMOR_FLANK * felt.above)
        & (felt.tremor > 1.5 * felt.below)
        & (felt.tremor > limits.TREMOR_USUAL * usual)
    )
    half = limits.HOLD_WINDOW / 2
    for begin, end in merge_runs(find_runs(hand), HOP):
        # Fewer windows overlap one another, so a single impact could cause them
        if end - begin < HOP + 1:
            continue
        strength = float(np.median(felt.tremor[begin:end]))
        yield QualityFinding(
            KIND, vector.name, float(felt.time[begin]) - half, float(felt.time[end - 1]) + half,
            f'The vehicle trembles as if held by hand: {strength:.2f} m/s2 at '
            f'{limits.TREMOR_LOW:.0f} to {limits.TREMOR_HIGH:.0f} Hz, but only '
            f'{np.median(felt.above[begin:end]):.2f} m/s2 above that band, and usually '
            f'{usual:.2f} m/s2 in it.',
            Severity.SUSPICIOUS, {'tremor': strength, 'usual': usual},
        )  # fmt: skip


def find_idle_times(recording: Flight) -> tuple[Array, NDArray[np.bool_]] | None:
    """Return times of commands and whether all rotors were idle; None without commands."""
    commands = [
        (channel, ZERO_FORCE if channel.unit == 'N' else limits.IDLE_DUTY)
        for channel in recording.channels.values()
        if roles.DRIVEN.match(channel.name) and len(channel.time) > 1
    ]
    if not commands:
        return None
    time = commands[0][0].time
    idle = np.ones(len(time), dtype=np.bool_)
    for channel, least in commands:
        if len(channel.time) == len(time):
            # Negated, so that NaN counts as idle
            idle &= ~(np.abs(channel.values) > least)
    return time, idle


def find_idle_motion(
    place: VectorSeries, time: Array, idle: NDArray[np.bool_]
) -> Iterator[QualityFinding]:
    """Yield stretches in which a vehicle with idle rotors is moved."""
    step = max(median_period(place.time), 0.01)
    grid = build_uniform_time_grid(place.time[0], place.time[-1], step, len(place.time))
    if len(grid) < limits.LEAST_SAMPLES:
        return
    # A tracker that loses a marker moves nothing
    good = ~find_tracker_jumps(place.time, place.values)
    table, valid = interpolate_on_grid(place.time[good], place.values[good], grid)
    calm = smooth_columns(table, hann_kernel(HAND_SMOOTHING, step))
    speed = np.gradient(calm, step, axis=0)
    pulls = np.gradient(speed, step, axis=0)
    pull = np.linalg.norm(pulls, axis=1)
    fast = np.linalg.norm(speed, axis=1)
    for begin, end in find_runs(idle).tolist():
        first, last = float(time[begin]) + SETTLING_TIME, float(time[end - 1])
        inside = valid & (grid >= first) & (grid <= last)
        if inside.sum() * step < limits.HOLD_WINDOW:
            continue
        moved = inside & (fast > limits.CARRIED_SPEED) & (pull > 0.0)
        pushed = inside & (pull > limits.CARRIED_FORCE)
        lifted = float(np.ptp(speed[inside, 2]))  # wind hardly changes the vertical speed
        swings = is_free_swing(calm[inside], speed[inside], pulls[inside], step)
        if swings or is_drop(speed[inside], step):
            continue
        if lifted > LIFTED_SPEED and moved.sum() * step > 0.5 and pushed.sum() * step > 0.2:
            at = grid[moved | pushed]
            yield QualityFinding(
                KIND, place.name, float(at[0]), float(at[-1]),
                f'The vehicle moves with idle rotors, at up to {fast[inside].max():.2f} m/s and '
                f'{pull[inside].max():.2f} m/s2: someone is carrying it.',
                Severity.SUSPICIOUS,
                {'speed': float(fast[inside].max()), 'acceleration': float(pull[inside].max())},
            )  # fmt: skip


def is_free_swing(place: Array, rate: Array, pull: Array, step: float) -> bool:
    """
    Return whether a vehicle swings freely: by the law of a pendulum, and ever less.

    It may drift, rise or fall while it swings. All of shape (n, 3) [m, m/s, m/s2].
    """
    trend = np.vander(np.linspace(-1.0, 1.0, len(place)), 3)
    law = fit_pendulum_law(
        *(side - trend @ np.linalg.lstsq(trend, side, rcond=None)[0]
          for side in (place, rate, pull))
    )  # fmt: skip
    cycles = math.sqrt(max(0.0, law.stiffness)) * len(place) * step / math.tau
    first, _, last = (float(part.mean()) for part in np.array_split(law.energy, 3))
    return law.explained > LAWFUL_SWING and cycles > MIN_SWINGS and last < first


def is_drop(speed: Array, step: float) -> bool:
    """Return whether a vehicle falls, or rises: ever faster, straight, until it hits something."""
    vertical = speed[:, 2] * np.sign(speed[np.argmax(np.abs(speed[:, 2])), 2])
    top = int(np.argmax(vertical))
    straight = np.linalg.norm(speed[:, :2], axis=1).max() < SIDEWAYS * vertical[top]
    falling = (np.diff(vertical[: top + 1]) > -BUMPS * vertical[top]).all()
    slower = np.flatnonzero(vertical[top:] < FINAL * vertical[top])
    # The smoothed speed needs a moment to fall to 0 at an impact
    hit = (
        top + int(slower[0]) + round(2.0 * HAND_SMOOTHING / step) if len(slower) else len(vertical)
    )
    rests = np.abs(vertical[hit:]).max(initial=0.0) < RESTING_SPEED_SHARE * vertical[top]
    return bool(straight and falling and rests and top * step > 2.0 * HAND_SMOOTHING)
