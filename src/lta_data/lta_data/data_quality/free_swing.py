"""
Prove that a flight without commands is a free swing, which is all that a model can be fitted to.

A powered flight whose commands were not recorded also swings a little, in circles or about a
hover. A free swing goes nowhere, follows the law of a pendulum, and loses energy.
"""

import math
from typing import Final

from lta_config.errors import BadInput
from lta_data.data_quality.motion import collect_poses, PoseSeries
from lta_data.data_quality.recording import ChannelRecording
from lta_data.data_quality.smoothing import hann_kernel, interpolate_on_grid, smooth_columns
from lta_data.even_grid import build_uniform_time_grid
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
DRIVEN: Final = ('motors', 'wrench_command')
STEP: Final = 0.04  # of the grid [s]
CALM: Final = 0.4  # smoothing, short against a swing [s]
SHORTEST: Final = 4.0  # of a swing that is judged [s]
SWUNG: Final = 0.04  # least amplitude [rad]
LEAVES: Final = 0.15  # m/s; a vehicle that is faster on average is pushed by its rotors
TILTED: Final = 0.9  # of its largest tilt, which a vehicle leaves when it is released
LATE: Final = 0.75  # of the flight; a free swing has its largest tilt before
LAWFUL: Final = 0.75  # of the angular acceleration that the law of a pendulum explains
SLOWEST: Final = 0.5  # angular frequency of a swing, at least [rad/s]
LOST: Final = 0.8  # of the energy of its first third a swing has in its last, at most


def require_commands(flight: str, recording: ChannelRecording) -> None:
    """Raise `BadInput` for a flight without commands that is not proved to be a free swing."""
    if reason := explain_no_swing(recording):
        raise BadInput(
            f"'{flight}' has no commands, and {reason}; record the commands of the rotors, too, "
            'or release the vehicle by hand and let it swing on the spot.'
        )


def explain_no_swing(recording: ChannelRecording) -> str:
    """Return why a flight without commands is no free swing; '' if it is, or has commands."""
    if any(channel.topic in DRIVEN for channel in recording.channels.values()):
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
    grid = build_uniform_time_grid(attitude.time[0], attitude.time[-1], STEP, len(attitude.time))
    if len(grid) * STEP < SHORTEST:
        return f'less than {SHORTEST:g} s do not prove a free swing'
    turns, _ = interpolate_on_grid(attitude.time, attitude.values, grid)
    # Where the world's up is in the body
    up = Rotation.from_quat(turns).inv().apply([0.0, 0.0, 1.0])[:, :2]
    calm = smooth_columns(up, hann_kernel(CALM, STEP))
    off = calm - np.median(calm[len(calm) // 2 :], axis=0)
    size = np.linalg.norm(off, axis=1)
    # A hand may hold it for a while before
    tilted = np.flatnonzero(size > TILTED * size.max())
    if tilted[-1] > LATE * len(size) and size.max() > SWUNG:
        return 'it is no free swing: its energy does not decay'
    released = int(tilted[-1])
    free = off[released:]
    if len(free) * STEP < SHORTEST or np.abs(free).max() < SWUNG:
        return 'the vehicle does not swing for long enough after its largest tilt'
    where, _ = interpolate_on_grid(place.time, place.values, grid[released:])
    # Over more than the longest swing, as far as the flight allows
    width = min(math.tau / SLOWEST, 0.25 * len(where) * STEP)
    drift = np.diff(smooth_columns(where, hann_kernel(width, STEP)), axis=0) / STEP
    speed = float(np.linalg.norm(drift, axis=1).mean())
    if speed > LEAVES:
        return f'it is no free swing: the vehicle travels at {speed:.2g} m/s on average'
    along = free @ np.linalg.svd(free, full_matrices=False)[2][0]
    rate = np.gradient(along, STEP)
    pull = np.gradient(rate, STEP)
    terms = np.column_stack([along, rate, np.ones(len(along))])
    law = np.linalg.lstsq(terms, pull, rcond=None)[0]
    explained = 1.0 - float(np.var(pull - terms @ law) / max(np.var(pull), 1e-12))
    if explained < LAWFUL or -law[0] < SLOWEST**2:
        return (
            f'it is no free swing: the law of a pendulum explains {100 * max(0.0, explained):.0f} '
            '% of its angular acceleration'
        )
    thirds = [float(part.mean()) for part in np.array_split(rate**2 - law[0] * along**2, 3)]
    if thirds[2] > LOST * thirds[0]:
        return (
            'it is no free swing: its energy does not decay, but is '
            f'{thirds[2] / thirds[0]:.2g} times as large at the end'
        )
    return ''
