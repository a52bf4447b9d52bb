# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Simulate an external tracker with its own frame and clock.

The tracker's clock differs from the vehicle's (`clock_offset`, `clock_skew`), and a pose is
already old when stamped (`tracker_delay`). The vehicle's clock is the graph's, because message
stamps are the keys of the lockstep. Only the difference of the two clocks is observable, so all of
it is applied to the tracker, whose stamps stay on the grid: the pose stamped t is the true pose at
the vehicle's time clock(t) minus the delay.

Between control steps position, velocity and rates are interpolated linearly, and the quaternion
linearly with normalisation: within a h^2 / 8 of the truth, 13 um at 1 m/s2 and 10 ms. Where the
tracker's clock is ahead, the motion is predicted under the present command.
"""

from collections import deque
from collections.abc import Callable, Mapping
import math
from typing import final

from lta_model.measurement_chain import apply_chain, Chain
from lta_model.state import RIGID
import numpy as np
from numpy.typing import NDArray

Numbers = tuple[float, ...]  # position, quaternion, velocity, rates: the first 13 of a state
TRACKER_CHANNELS = ('clock', 'pose_time', 'pose')
NS_A_SECOND = 1e9


def interpolate_motion(before: Numbers, after: Numbers, part: float) -> Numbers:
    """Interpolate between two motions; `part` is 0 to 1."""
    # q and -q are the same attitude: interpolate along the shorter arc
    sign = math.copysign(1.0, sum(before[i] * after[i] for i in range(3, 7)))
    mixed = [
        x + part * ((sign * y if 3 <= i < 7 else y) - x)
        for i, (x, y) in enumerate(zip(before, after, strict=True))
    ]
    length = math.hypot(*mixed[3:7])
    return (*mixed[:3], *(x / length for x in mixed[3:7]), *mixed[7:])


@final
class SimulatedTracker:
    """A tracker that observes one flight."""

    def __init__(self, chains: Mapping[str, Chain]) -> None:
        self._clock, self._time, self._pose = (chains[name] for name in TRACKER_CHANNELS)
        self._late = bool(self._clock or self._time)
        self._now_ns = 0
        self._motion: Numbers = ()
        self._past: deque[tuple[int, Numbers]] = deque()

    def record_motion(self, now_ns: int, motion: Numbers) -> None:
        """Record the truth at a control step."""
        self._now_ns, self._motion = now_ns, motion
        if self._late:
            self._past.append((now_ns, motion))

    def report_motion(self, ahead: Callable[[int], NDArray[np.float64]]) -> Numbers:
        """
        Return the motion stamped with the latest control step.

        Without effects this is the truth, bit for bit.
        """
        now, motion = self._now_ns * 1e-9, self._motion
        if self._late:
            clock = apply_chain(self._clock, (now,), now)
            when_ns = round(apply_chain(self._time, clock, now)[0] * NS_A_SECOND)
            # Positive where the tracker's clock is ahead: predict, instead of looking back
            span_ns = when_ns - self._now_ns
            self._drop_old_records(when_ns)
            motion = (
                tuple(ahead(span_ns)[:RIGID].tolist()) if span_ns > 0 else self._motion_at(when_ns)
            )
        if self._pose:
            # Frame errors change position and quaternion only; body velocities stay
            motion = (*apply_chain(self._pose, motion[:7], now), *motion[7:])
        return motion

    def _drop_old_records(self, when_ns: int) -> None:
        """Drop records before a time, except the one needed for interpolation."""
        past = self._past
        while len(past) > 1 and past[1][0] <= when_ns:
            past.popleft()

    def _motion_at(self, when_ns: int) -> Numbers:
        """Return the motion at a past time; before the first record, the first one."""
        past = self._past
        begin_ns, before = past[0]
        if when_ns <= begin_ns or len(past) == 1:
            return before
        end_ns, after = past[1]
        return interpolate_motion(before, after, (when_ns - begin_ns) / (end_ns - begin_ns))
