# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Prove that a flight without commands is a free swing, which is all that a model can be fitted to.

A powered flight whose commands were not recorded also swings a little, in circles or about a
hover. A free swing goes nowhere, follows the law of a pendulum, and loses energy.
"""

import math
from typing import Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_data.data_quality.motion import collect_poses, PoseSeries
from lta_data.even_grid import (
    build_uniform_time_grid,
    hann_kernel,
    interpolate_on_grid,
    smooth_columns,
)
from lta_data.flight import Flight
from lta_data.interpretation.commands import DRIVES
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
SWING_STEP: Final = 0.04  # of the grid [s]
SMOOTHING_LIMITS: Final = (0.4, 1.2)  # smoothing, a third of a period within these limits [s]
SHORTEST_SWING: Final = 4.0  # of a swing that is judged [s]
MIN_SWING: Final = 0.04  # least amplitude [rad]
LEAVES: Final = 0.15  # m/s; a vehicle that is faster on average is pushed by its rotors
RESTS: Final = 0.03  # m/s; slower motion beside the mean velocity is that of the air
TILTED: Final = 0.9  # of its largest tilt, at which a vehicle is held before it is released
HALFWAY: Final = 0.5  # of its largest tilt, below which it is released
LATEST_RELEASE: Final = 0.6  # of the flight; a free swing is released before
LAWFUL: Final = 0.88  # of the angular acceleration that the law of a pendulum explains
SLOWEST_SWING: Final = 0.5  # angular frequency of a swing, at least [rad/s]
DECAYED_ENERGY: Final = 0.95  # of the energy of its first third a swing has in its last, at most
GROWS: Final = 1.4  # times the energy that it had before; nothing but rotors or a hand give more
NEGLIGIBLE_ENERGY: Final = 0.1  # of the largest energy; less of it may be noise


def require_commands(flight: str, recording: Flight) -> None:
    """Raise `BadInput` for a flight without commands that is not proved to be a free swing."""
    if reason := explain_no_swing(recording):
        raise BadInput(
            f"'{flight}' has no commands, and {reason}; record the commands of the rotors, too, "
            'or release the vehicle by hand and let it swing on the spot.'
        )


def explain_no_swing(recording: Flight) -> str:
    """Return why a flight without commands is no free swing; '' if it is, or has commands."""
    if any(
        channel.topic in DRIVES and np.isfinite(channel.values).any()
        for channel in recording.channels.values()
    ):
        return ''
    poses = [
        pose
        for pose in collect_poses(recording.channels)
        if pose.position is not None and pose.attitude is not None
    ]
    if not poses:
        return 'no pose shows a free swing'
    return _judge_swing(poses[0])


def _judge_swing(pose: PoseSeries) -> str:
    """Return why a pose is not that of a free swing; '' if it is."""
    assert pose.position is not None
    assert pose.attitude is not None
    place, attitude = pose.position, pose.attitude
    grid = build_uniform_time_grid(
        attitude.time[0], attitude.time[-1], SWING_STEP, len(attitude.time)
    )
    if len(grid) * SWING_STEP < SHORTEST_SWING:
        return f'less than {SHORTEST_SWING:g} s do not prove a free swing'
    turns, _ = interpolate_on_grid(attitude.time, attitude.values, grid)
    # Where the world's up is in the body
    up = Rotation.from_quat(turns).inv().apply([0.0, 0.0, 1.0])[:, :2]
    where, _ = interpolate_on_grid(place.time, place.values, grid)
    # A third of its period, which is estimated with the least smoothing before
    _, released, law = _fit_pendulum(up, SMOOTHING_LIMITS[0])
    width = math.tau / max(SLOWEST_SWING, math.sqrt(max(0.0, law.stiffness))) / 3.0
    off, released, law = _fit_pendulum(
        up, min(max(SMOOTHING_LIMITS[0], width), SMOOTHING_LIMITS[1])
    )
    if released > LATEST_RELEASE * len(up) and np.abs(off).max() > MIN_SWING:
        return 'it is no free swing: its largest tilt comes late'
    free = off[released:]
    if len(free) * SWING_STEP < SHORTEST_SWING or np.abs(free).max() < MIN_SWING:
        return 'the vehicle does not swing for long enough after its largest tilt'
    way = smooth_columns(where[released:], hann_kernel(SMOOTHING_LIMITS[0], SWING_STEP))
    speed = float(np.linalg.norm(way[-1] - way[0])) / (len(way) * SWING_STEP)
    if speed > LEAVES:
        return f'it is no free swing: the vehicle travels at {speed:.2g} m/s on average'
    if law.explained < LAWFUL or law.stiffness < SLOWEST_SWING**2:
        return (
            'it is no free swing: the law of a pendulum explains '
            f'{100 * max(0.0, law.explained):.0f} % of its angular acceleration'
        )
    moved = np.gradient(way, SWING_STEP, axis=0)
    moved -= moved.mean(axis=0)
    motion = np.square(moved).sum(axis=1)
    for energy, least in ((law.energy, 0.0), (motion, RESTS**2)):
        first, _, last = (float(part.mean()) for part in np.array_split(energy, 3))
        if last > max(DECAYED_ENERGY * first, least):
            return (
                'it is no free swing: its energy does not decay, but is '
                f'{last / first:.2g} times as large at the end'
            )
    after = np.maximum.accumulate(law.energy[::-1])[::-1]
    if (after > np.maximum(GROWS * law.energy, NEGLIGIBLE_ENERGY * after[0])).any():
        return 'it is no free swing: its energy grows on the way'
    return ''


@final
class PendulumLaw(NamedTuple):
    """How a tilt, or a place, swings."""

    stiffness: float  # of the main direction: the square of its angular frequency [rad2/s2]
    explained: float  # share of the acceleration
    energy: Array  # by the inertia, shape (n,) [rad2/s2 or m2/s2]


def _fit_pendulum(up: Array, width: float) -> tuple[Array, int, PendulumLaw]:
    """
    Return the tilts, the row from which they are free, and their law from there.

    Its energy is that over a period.

    `up`, shape (n, 2): horizontal parts of the body's up [rad]. `width`: of the smoothing [s].
    """
    calm = smooth_columns(up, hann_kernel(width, SWING_STEP))
    off = calm - np.median(calm[len(calm) // 2 :], axis=0)
    size = np.linalg.norm(off, axis=1)
    # A hand may hold it at its largest tilt for a while before
    tilted = int(np.argmax(size >= TILTED * size.max()))
    released = tilted + int(np.argmax(size[tilted:] < HALFWAY * size.max()))
    free = off[released:]
    if len(free) < 3:
        return off, released, PendulumLaw(0.0, 0.0, np.zeros(len(free)))
    rate = np.gradient(free, SWING_STEP, axis=0)
    pull = np.gradient(rate, SWING_STEP, axis=0)
    law = fit_pendulum_law(free, rate, pull)
    period = math.tau / max(SLOWEST_SWING, math.sqrt(max(0.0, law.stiffness)))
    weights = hann_kernel(min(2.0 * period, 0.5 * len(free) * SWING_STEP), SWING_STEP)
    return off, released, law._replace(energy=smooth_columns(law.energy[:, None], weights)[:, 0])


def fit_pendulum_law(off: Array, rate: Array, pull: Array) -> PendulumLaw:
    """
    Fit the law of a damped pendulum to a motion, of each axis and between them.

    `off`, `rate`, `pull`, shape (n, axes): displacement and its derivatives. All axes at once, as
    they swing at frequencies of their own.
    """
    terms = np.column_stack([off, rate, np.ones(len(off))])
    law = np.linalg.lstsq(terms, pull, rcond=None)[0]
    unlike = float(np.var(pull - terms @ law, axis=0).sum())
    axes = off.shape[1]
    back = -0.5 * (law[:axes] + law[:axes].T)
    main = np.linalg.svd(off, full_matrices=False)[2][0]
    energy = np.square(rate).sum(axis=1) + (off @ back * off).sum(axis=1)
    explained = 1.0 - unlike / max(float(np.var(pull, axis=0).sum()), 1e-12)
    return PendulumLaw(float(main @ back @ main), explained, energy)
