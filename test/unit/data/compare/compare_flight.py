# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Two recordings of one hand-made motion, whose clocks, frames and faults are known.

The hull wanders in the plane on sums of slow sines, climbs and turns likewise, and noise of known
size lies on everything. What the second recorder does differently is told to `write_motion`.
"""

from dataclasses import replace
import math

from lta_bag import BagWriter
from lta_bag.schemas import load_jazzy_types
from lta_data.flight import Flight
import numpy as np

from ...report_flight import make, pose, ROTORS  # noqa: TID252 - `test` is Python's own

UNIX = 1_760_000_000_000_000_000  # ns, some day in 2025
TOPIC = 'nav_msgs/msg/Odometry'
JOINTS = 'sensor_msgs/msg/JointState'
RATES = np.array([0.05, 0.11, 0.23, 0.31])  # Hz


def side_of(channels, path, start=0, frame=''):
    """Return one side of a comparison."""
    named = {each.name: replace(each, frame=frame) for each in channels}
    return Flight(named, path=path, start=start)


def wave(t, seed):
    """Return a smooth motion of about one unit."""
    chance = np.random.default_rng(seed)
    sizes, phases = chance.uniform(0.3, 0.7, 4), chance.uniform(0.0, 2 * math.pi, 4)
    return np.sin(2 * math.pi * np.multiply.outer(np.asarray(t), RATES) + phases) @ sizes


def motion(t):
    """Return x, y, z in m and yaw in rad at some instants, shape (n, 4)."""
    t = np.asarray(t, dtype=np.float64)
    z = 1.0 + 0.2 * wave(t, 3)
    return np.stack([2.0 * wave(t, 1), wave(t, 2), z, 2.9 + wave(t, 4)], axis=-1)


def stamped(nanoseconds, frame=''):
    stamp = make(
        'builtin_interfaces/msg/Time', sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9
    )
    return make('std_msgs/msg/Header', stamp=stamp, frame_id=frame)


def odometry(nanoseconds, x, y, z, yaw, frame):
    covered = make('geometry_msgs/msg/PoseWithCovariance', pose=pose(x, y, z, yaw))
    return make(TOPIC, header=stamped(nanoseconds, frame), pose=covered)


def write_motion(
    folder, *, until=40.0, rate=50.0, start=UNIX, offset=0.0, drift=0.0, phase=0.0, turn=0.0,
    shift=(0.0, 0.0, 0.0), noise=0.0, seed=0, frame='map', topic='odom', step=None, drop=None,
    robot='/lta1', extra=(),
):  # fmt: skip
    """
    Write a bag of the motion and return it.

    The event at time t of the motion is stamped start + (offset + (1 + drift) t). Instants are
    `phase` after those of the rate. `step` is (time, size) of a jump in z; `drop` an interval
    without messages; `extra` more topics to be empty of meaning.
    """
    t = phase + np.arange(round(until * rate)) / rate
    values = motion(t) + noise * np.random.default_rng(seed).normal(size=(len(t), 4))
    x, y = values[:, 0].copy(), values[:, 1].copy()
    values[:, 0] = math.cos(turn) * x - math.sin(turn) * y + shift[0]
    values[:, 1] = math.sin(turn) * x + math.cos(turn) * y + shift[1]
    values[:, 2] += shift[2]
    values[:, 3] += turn
    if step is not None:
        values[t >= step[0], 2] += step[1]
    with BagWriter(folder, {'vehicle': 'gtmab'}) as bag:
        bag.add_topic(f'{robot}/{topic}', TOPIC, [])
        for name in extra:
            bag.add_topic(f'{robot}/{name}', JOINTS, [])
        for time, row in zip(t, values, strict=True):
            if drop is not None and drop[0] < time < drop[1]:
                continue
            when = start + round(1e9 * (offset + (1.0 + drift) * time))
            message = odometry(when, *row, frame)
            bag.write(
                f'{robot}/{topic}', bytes(load_jazzy_types().serialize_cdr(message, TOPIC)), when
            )
            for name in extra:
                joints = make(
                    JOINTS, header=stamped(when), name=list(ROTORS), effort=np.full(4, 0.1)
                )
                bag.write(
                    f'{robot}/{name}',
                    bytes(load_jazzy_types().serialize_cdr(joints, JOINTS)),
                    when,
                )
    return folder
