# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Simulate vehicles that are commanded by a wrench: the actuators, a pilot, a controller."""

from collections.abc import Sequence
import math
from typing import Final, final, Literal

import numpy as np

from campaigns.challenge.body import GRAVITY, rotation_matrix, State
from campaigns.challenge.truth import Six, VehicleTruth

Draw = np.random.Generator

HEIGHTS: Final = (1.1, 2.0)  # m; range of height setpoints
REACH: Final = 1.5  # m; range of the place setpoints
HOLD: Final = (4.0, 9.0)  # s; length of a setpoint
DITHER: Final = (0.4, 1.2)  # s; length of a value of the dither
SPEED: Final = 0.35  # m/s; towards a setpoint
# Largest force ahead and up [N], and yaw moment [N m]: about those of two rotors of 25 mN.
MOST: Final = (0.05, 0.06, 0.006)
SHAKE: Final = 0.35  # of the largest command; size of the dither
Course = Literal['hover', 'circle', 'places']  # of a controller: rest, turn slowly, or step
RADIUS: Final = 1.0  # m; of a circle
PERIOD: Final = 40.0  # s; of a circle
# Of the controller: proportional, integral and derivative gains of each position [N/m, N/(m s),
# N s/m] and of the heading. [N m/rad, N m/(rad s), N m s/rad]
PLACE: Final = (0.04, 0.004, 0.14)
TURN: Final = (0.004, 0.0004, 0.012)


@final
class WrenchActuators:
    """
    Actuators that apply a share of a commanded wrench, without lag.

    `truth`: its `wrench_gains` are the shares. `duties`: commanded wrench before the start,
    sequence of six float.
    """

    def __init__(self, truth: VehicleTruth, duties: Sequence[float]) -> None:
        self._gains = truth.wrench_gains
        self._wrench = list(duties)

    def set_duties(self, duties: Sequence[float]) -> None:
        """Set the commanded wrench from now on."""
        self._wrench = list(duties)

    def advance(self, seconds: float) -> None:
        """Do nothing: the wrench is held."""

    def thrusts_after_command(self, seconds: float) -> list[float]:
        """Return the wrench that acts on each axis [N], [N m]."""
        return [gain * each for gain, each in zip(self._gains, self._wrench, strict=True)]

    def total_wrench(self, thrusts: Sequence[float]) -> Six:
        """Return the wrench."""
        a, b, c, d, e, f = thrusts
        return a, b, c, d, e, f


@final
class WrenchPilot:
    """
    Pilot that flies to random places and dithers each axis, as an operator in a lab does.

    The operator sees the vehicle move and knows what moves it, so what he commands suits the
    true gains; the record has the command.

    `nominal`: parameters of the vehicle file. `steps`: whether he flies single steps without
    dither, with rest between them.
    """

    def __init__(self, nominal: VehicleTruth, gains: Six, draw: Draw, steps: bool = False) -> None:
        self._draw, self._gains, self._steps = draw, gains, steps
        self._weight = (nominal.mass - nominal.displaced) * GRAVITY
        self._sum, self._until = 0.0, 0.0
        self._aim = [0.0, 0.0, float(draw.uniform(*HEIGHTS))]
        self._shake, self._ends = [0.0] * 3, [0.0] * 3

    def initial_duties(self) -> list[float]:
        """Return the command that carries the weight of the vehicle file."""
        return [0.0, 0.0, self._weight / self._gains[2], 0.0, 0.0, 0.0]

    def _draw_setpoint(self, time: float) -> None:
        """Draw the next place if the present one ends."""
        if time >= self._until:
            x, y = self._draw.uniform(-REACH, REACH, 2)
            self._aim = [float(x), float(y), float(self._draw.uniform(*HEIGHTS))]
            self._until = time + float(self._draw.uniform(*HOLD))

    def _draw_dither(self, time: float) -> list[float]:
        """Return the dither of surge, heave and yaw in shares of the largest command."""
        for k, end in enumerate(self._ends):
            if time >= end:
                size = 0.0 if self._steps else SHAKE
                self._shake[k] = size * float(self._draw.choice([-1.0, 0.0, 1.0]))
                self._ends[k] = time + float(self._draw.uniform(*DITHER))
        return self._shake

    def compute_duties(self, time: float, state: State) -> list[float]:
        """Return the commanded wrench at a time and true state."""
        self._draw_setpoint(time)
        r = rotation_matrix(*state[6:10])
        ahead, aside, off = (aim - now for aim, now in zip(self._aim, state[:3], strict=True))
        far = math.hypot(ahead, aside)
        turn = math.remainder(math.atan2(aside, ahead) - math.atan2(r[3], r[0]), 2.0 * math.pi)
        # Speed ahead: towards the place, slower the further the nose points elsewhere
        speed = r[0] * state[3] + r[3] * state[4]
        surge_speed = min(SPEED, 0.5 * far) * max(math.cos(turn), 0.0)
        steer = 0.004 * turn - 0.012 * state[12] if far > 0.3 else -0.012 * state[12]
        # Small steps, so that the integral does not wind up
        self._sum = min(max(self._sum + 6e-5 * off, -0.06), 0.06)
        lift = self._sum + 0.05 * off - 0.12 * state[5]
        shares = (0.25 * (surge_speed - speed) / MOST[0], lift / MOST[1], steer / MOST[2])
        dither = self._draw_dither(time)
        surge, heave, yaw = (
            most * min(max(share + more, -1.0), 1.0)
            for most, share, more in zip(MOST, shares, dither, strict=True)
        )
        wrench = (surge, 0.0, self._weight + heave, 0.0, 0.0, yaw)
        return [each / gain for each, gain in zip(wrench, self._gains, strict=True)]


@final
class ClosedLoopController:
    """
    Controller that follows a course by the state alone: all that it commands is an answer.

    Like a controller in a lab, it was tuned on the vehicle: its commands suit the true gains.

    `nominal`: parameters of the vehicle file. `gains`: the true gains. `course`: what it follows;
    the places of 'places' are 15 to 25 s apart.
    """

    def __init__(
        self, nominal: VehicleTruth, gains: Six, draw: Draw, course: Course = 'hover'
    ) -> None:
        self._draw, self._gains, self._course = draw, gains, course
        self._weight = (nominal.mass - nominal.displaced) * GRAVITY
        self._sums = [0.0] * 4
        self._begin = float(draw.uniform(-math.pi, math.pi))
        self._until, self._aim = math.inf, [0.0, 0.0, float(draw.uniform(*HEIGHTS)), 0.0]
        if course == 'places':
            self._until = 0.0

    def initial_duties(self) -> list[float]:
        """Return the command that carries the weight of the vehicle file."""
        return [0.0, 0.0, self._weight / self._gains[2], 0.0, 0.0, 0.0]

    def _follow_course(self, time: float) -> list[float]:
        """Return where to be at a time: position and heading."""
        if self._course == 'circle':
            turn = self._begin + 2.0 * math.pi * time / PERIOD
            place = [RADIUS * math.cos(turn), RADIUS * math.sin(turn)]
            self._aim = [*place, self._aim[2], turn + 0.5 * math.pi]
        elif time >= self._until:
            x, y = self._draw.uniform(-REACH, REACH, 2)
            height, turn = self._draw.uniform(*HEIGHTS), self._draw.uniform(-math.pi, math.pi)
            self._aim = [float(each) for each in (x, y, height, turn)]
            self._until = time + float(self._draw.uniform(15.0, 25.0))
        return self._aim

    def compute_duties(self, time: float, state: State) -> list[float]:
        """Return the commanded wrench at a time and true state."""
        r = rotation_matrix(*state[6:10])
        x, y, z, heading = self._follow_course(time)
        turn = math.remainder(heading - math.atan2(r[3], r[0]), 2.0 * math.pi)
        off = [x - state[0], y - state[1], z - state[2], turn]
        rates = [*state[3:6], state[12]]
        push = []
        for k, (error, rate) in enumerate(zip(off, rates, strict=True)):
            p, i, d = PLACE if k < 3 else TURN
            # A step in the place must not wind up the integral
            error = min(max(error, -0.5), 0.5)
            self._sums[k] += 0.01 * i * error
            push.append(p * error + self._sums[k] - d * rate)
        ahead = r[0] * push[0] + r[3] * push[1]
        aside = r[1] * push[0] + r[4] * push[1]
        wrench = (ahead, aside, self._weight + push[2], 0.0, 0.0, push[3])
        return [each / gain for each, gain in zip(wrench, self._gains, strict=True)]
