"""
Roughen a challenge flight and its vehicle file as first logs of a laboratory are.

A hand holds and releases the vehicle, it starts on the floor, the tracker loses it, single
commands are far beyond what the actuators can do, and one or two numbers of the vehicle file are
wrong.
"""

import math
from typing import Any, Final

from lta_challenge.truth_sensors import Streams
import numpy as np
from numpy.typing import NDArray
import yaml

Array = NDArray[np.float64]
Draw = np.random.Generator

POSE: Final = 'ground_truth/odom'
COMMANDS: Final = ('motors', 'wrench_command')
# Numbers of the vehicle file that may be wrong, by their path in the file
NUMBERS: Final[tuple[tuple[str, ...], ...]] = (
    ('thrust_curve', 'a'),
    ('thrust_curve', 'b'),
    ('aero', 'linear_drag', 'moment'),
    ('aero', 'quadratic_drag', 'force'),
    ('aero', 'quadratic_drag', 'moment'),
    ('effects', 'motor_lag', 'up'),
    ('hull', 'height'),
    ('trim', 'ballast_position'),
    ('trim', 'heaviness'),
    ('layers', 'hull', 'envelope', 'size'),
    ('layers', 'propulsion_and_control', 'frame', 'position'),
)
FACTORS: Final = (0.3, 3.0)  # range of the errors of the file
TREMBLES: Final = 2e-4  # m; amplitude of a hand's tremor
TREMOR: Final = (6.0, 11.0)  # Hz
RISE: Final = 2.0  # s; lift from the floor to the beginning of the flight
SPIKES: Final = (10.0, 60.0)  # times the usual command


def distort_vehicle_file(text: str, draw: Draw) -> tuple[str, dict[str, float]]:
    """Return a vehicle file with one or two wrong numbers, and the factors by path."""
    content = yaml.safe_load(text)
    count = int(draw.integers(1, 3))
    factors = {}
    for index in draw.choice(len(NUMBERS), count, replace=False):
        path = NUMBERS[index]
        factor = math.exp(draw.uniform(*np.log(FACTORS)))
        _scale_number(content, path, factor)
        factors['.'.join(path)] = factor
    return yaml.safe_dump(content, sort_keys=False, allow_unicode=True), factors


def _scale_number(content: dict[str, Any], path: tuple[str, ...], factor: float) -> None:
    """Scale a number of a vehicle file, or all components of a vector, in place."""
    quantity = content
    for key in path:
        quantity = quantity[key]
    value = quantity['value']
    quantity['value'] = [factor * each for each in value] if isinstance(value, list) else (
        factor * value
    )  # fmt: skip


def prepend_hold(streams: Streams, seconds: float, draw: Draw) -> Streams:
    """Return a flight before which a hand holds the vehicle, with idle actuators."""
    time = np.arange(0.0, seconds, _sample_period(streams[POSE][0]))
    pose = np.tile(_first_pose(streams), (len(time), 1))
    # The hand wanders, and ends where the flight begins
    fade = np.sin(0.5 * math.pi * np.clip((seconds - time) / seconds, 0.0, 1.0)) ** 2
    pose[:, :3] += 0.1 * draw.standard_normal(3) * fade[:, None]
    phase = 2.0 * math.pi * draw.uniform(*TREMOR) * time[:, None] + draw.uniform(0.0, 6.0, 3)
    pose[:, :3] += TREMBLES * np.sin(phase)
    return _prepend_poses(streams, time, pose, seconds, draw)


def prepend_floor(streams: Streams, seconds: float, floor: float, draw: Draw) -> Streams:
    """Return a flight that begins on the floor, from which the vehicle is lifted."""
    time = np.arange(0.0, seconds + RISE, _sample_period(streams[POSE][0]))
    pose = np.tile(_first_pose(streams), (len(time), 1))
    part = np.clip((time - seconds) / RISE, 0.0, 1.0)
    # Minimum jerk: at rest at both ends
    smooth = part**3 * (10.0 - 15.0 * part + 6.0 * part**2)
    pose[:, 2] = floor + (pose[:, 2] - floor) * smooth
    return _prepend_poses(streams, time, pose, seconds + RISE, draw)


def _first_pose(streams: Streams) -> Array:
    """Return the first tracked pose; single outliers are ignored."""
    first: Array = np.median(streams[POSE][1][:9], axis=0)
    first[3:] /= np.linalg.norm(first[3:])
    return first


def _sample_period(time: Array) -> float:
    """Return the median time between readings. [s]"""
    return float(np.median(np.diff(time)))


def _prepend_poses(
    streams: Streams, time: Array, pose: Array, seconds: float, draw: Draw
) -> Streams:
    """Return a flight that begins later: poses, idle commands, and the first sensor readings."""
    out = {}
    for name, (stamps, values) in streams.items():
        own = np.arange(0.0, seconds, _sample_period(stamps))
        before = np.tile(np.median(values[:9], axis=0), (len(own), 1))
        if name == POSE:
            own, before = time, pose
        if name in COMMANDS:
            before[:] = 0.0
        else:
            # The noise of a sensor is the same in a hand
            steps = np.diff(values[:200], axis=0)
            before = before + 0.7 * np.nanmedian(np.abs(steps), axis=0) * draw.standard_normal(
                before.shape
            )
        later = seconds + stamps
        early = own < later[0]
        out[name] = (np.append(own[early], later), np.vstack([before[early], values]))
    return out


def add_spikes(streams: Streams, count: int, draw: Draw) -> Streams:
    """Return a flight with single commands that are far beyond what the actuators can do."""
    out = dict(streams)
    for name in set(COMMANDS) & set(streams):
        time, values = streams[name]
        values = values.copy()
        # The columns of actuators that the vehicle does not use stay 0
        used = np.flatnonzero(np.abs(values).max(axis=0) > 0.0)
        for k in draw.integers(0, len(time), count):
            column = draw.choice(used)
            size = draw.uniform(*SPIKES) * float(np.abs(values[:, column]).mean())
            values[k, column] = size * draw.choice([-1.0, 1.0])
        out[name] = (time, values)
    return out


def cut_gaps(streams: Streams, count: int, draw: Draw) -> Streams:
    """Return a flight whose tracker loses the vehicle for up to 3 s."""
    time, values = streams[POSE]
    outside_gaps = np.ones(len(time), dtype=np.bool_)
    for begin in draw.uniform(time[0], time[-1], count):
        outside_gaps &= (time < begin) | (time > begin + draw.uniform(0.2, 3.0))
    return {**streams, POSE: (time[outside_gaps], values[outside_gaps])}
