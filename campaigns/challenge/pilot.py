# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Simulate a pilot who excites swings, climbs and turns and stays clear of the floor."""

from dataclasses import dataclass
import math
from typing import Final, final

import numpy as np

from campaigns.challenge.body import GRAVITY, rotation_matrix, State
from campaigns.challenge.truth import VehicleTruth

Draw = np.random.Generator

MANOEUVRES: Final = ('dash', 'rock', 'pump', 'roll', 'rest')
WEIGHTS: Final = (0.25, 0.25, 0.3, 0.1, 0.1)
HEIGHTS: Final = (1.1, 2.0)  # m; range of height setpoints
CEILING: Final = 2.25  # m; forward thrust stops above
FLOOR: Final = 0.9  # m; extra lift below
WILD: Final = math.radians(18.0)  # rad; swing amplitude from which on the pilot damps the swing
SWING: Final = 3.1  # rad/s; pendulum frequency, which converts rates to amplitudes
FAR: Final = 3.0  # m; distance from the origin at which the pilot heads back
EASE: Final = 0.0067  # N; least thrust of each forward rotor, so that they can steer


@final
@dataclass(frozen=True, slots=True)
class PilotManeuver:
    """A manoeuvre."""

    name: str  # one of `MANOEUVRES`
    end: float  # end time [s]
    duty: float  # duty of the forward rotors while they push
    period: float  # period of alternating commands [s]
    height: float  # height setpoint [m]
    turn: float  # change of heading at the start [rad]


def draw_maneuvers(seconds: float, draw: Draw) -> list[PilotManeuver]:
    """Draw a sequence of manoeuvres."""
    plan, time = list[PilotManeuver](), 0.0
    # Each flight begins with dash, rock and pump in random order (taken from the end)
    order = list(draw.permutation(MANOEUVRES[:3]))
    while time < seconds:
        name = str(order.pop() if order else draw.choice(MANOEUVRES, p=WEIGHTS))
        length = draw.uniform(2.5, 5.0) if name == 'rest' else draw.uniform(5.0, 11.0)
        time += float(length)
        duty = float(draw.uniform(0.3, 0.6) if name == 'rock' else draw.uniform(0.25, 0.5))
        period, height = float(draw.uniform(1.7, 2.5)), float(draw.uniform(*HEIGHTS))
        turn = float(draw.choice([-1.0, 1.0]) * draw.uniform(0.4, 2.2))
        plan.append(PilotManeuver(name, time, duty, period, height, turn))
    return plan


@final
class SwingingPilot:
    """
    Pilot that flies a random sequence of manoeuvres.

    `seconds`: length of the flight [s]. `nominal`: parameters of the vehicle file, used for trim.
    `draw`: random generator.
    """

    def __init__(self, seconds: float, nominal: VehicleTruth, draw: Draw) -> None:
        self.plan = draw_maneuvers(seconds, draw)
        self._draw = draw
        self._curve = nominal.curve
        # Vertical force per newton of a lifting rotor
        self._lifting = nominal.columns[0][2]
        self._weight = (nominal.mass - nominal.displaced) * GRAVITY
        self._heading, self._at, self._began = float(draw.uniform(-math.pi, math.pi)), -1, 0.0
        self._sum = 0.0
        self._size = float(draw.uniform(0.02, 0.05))
        rotors = len(nominal.gains)
        self._shake, self._until = [0.0] * rotors, [0.0] * rotors

    @property
    def heading(self) -> float:
        """Initial heading [rad]."""
        return self._heading

    def initial_duties(self) -> list[float]:
        """Return the hover duties of the vehicle file."""
        up = self._thrust_to_duty(0.5 * self._weight / self._lifting)
        ease = self._thrust_to_duty(EASE)
        return [up, up, ease, ease]

    def _thrust_to_duty(self, thrust: float) -> float:
        """Return the duty for a thrust [N] of one rotor."""
        a, b = self._curve
        return (math.sqrt(b * b + 4.0 * a * max(thrust, 0.0)) - b) / (2.0 * a)

    def _draw_dither(self, time: float) -> list[float]:
        """Return the dither of each duty; each value holds for a random time."""
        for k, until in enumerate(self._until):
            if time >= until:
                self._shake[k] = float(self._draw.choice([-1.0, 1.0])) * self._size
                self._until[k] = time + float(self._draw.uniform(0.12, 0.5))
        return self._shake

    def _current_maneuver(self, time: float, state: State) -> PilotManeuver:
        """Return the current manoeuvre; start the next one when the last has ended."""
        begin = self._at < 0 or (time >= self.plan[self._at].end and self._at + 1 < len(self.plan))
        if begin:
            self._began = time
            self._at += 1
            self._heading += self.plan[self._at].turn if self._at else 0.0
            # Head back to the origin before the vehicle leaves the room
            if math.hypot(state[0], state[1]) > FAR:
                home = math.atan2(-state[1], -state[0])
                self._heading = home + float(self._draw.uniform(-0.7, 0.7))
        return self.plan[self._at]

    def compute_duties(self, time: float, state: State) -> list[float]:
        """
        Return the duties of up left, up right, forward left and forward right.

        `time`: time since the start [s]. `state`: true state of the vehicle, list of 13 floats.
        """
        now = self._current_maneuver(time, state)
        r = rotation_matrix(*state[6:10])
        # Amplitude of the swing from tilt and rates; r[8] is the cosine of the tilt
        swing = math.hypot(math.acos(min(r[8], 1.0)), state[10] / SWING, state[11] / SWING)
        ahead, aside = (
            self._forward_duty(now, time, state, swing),
            self._steering_difference(state, r[0], r[3]),
        )
        lift, roll = self._lift_duty(now, state), self._roll_difference(now, time)
        # Lifting rotors: left, right
        forces = [lift - roll, lift + roll]
        base = self._thrust_to_duty(EASE)
        # Without thrust ahead the rotors cannot steer, and they cannot pull back.
        forces += [max(ahead, base) - aside, max(ahead, base) + aside]
        return [
            min(max(one + more, 0.0), 1.0)
            for one, more in zip(forces, self._draw_dither(time), strict=True)
        ]

    def _forward_duty(self, now: PilotManeuver, time: float, state: State, swing: float) -> float:
        """Return the common duty of the forward rotors."""
        nose_up = state[11] < 0.0  # rates about y, which points left: the nose goes up
        if state[2] > CEILING:
            return 0.0  # with the nose up, forward thrust would lift it further
        if swing > WILD:
            return 0.0 if nose_up else 0.5 * now.duty
        if now.name == 'dash':
            return now.duty
        if now.name == 'rock':
            return now.duty if (time - self._began) % now.period < 0.5 * now.period else 0.0
        if now.name == 'pump':
            return now.duty if nose_up else 0.0
        return 0.0

    def _steering_difference(self, state: State, forward_x: float, forward_y: float) -> float:
        """Return half the difference of the forward duties that holds the heading."""
        off = self._heading - math.atan2(forward_y, forward_x)
        # Wrap to -pi to pi
        off = math.remainder(off, 2.0 * math.pi)
        return min(max(0.12 * off - 0.35 * state[12], -0.25), 0.25)

    def _lift_duty(self, now: PilotManeuver, state: State) -> float:
        """Return the duty of the lifting rotors that controls the height."""
        off = now.height - state[2]
        self._sum = min(max(self._sum + 2e-5 * off, -0.03), 0.08)  # N
        force = self._weight + self._sum + 0.06 * off - 0.15 * state[5]
        if state[2] < FLOOR:
            force += 0.3 * (FLOOR - state[2])
        return self._thrust_to_duty(0.5 * force / self._lifting)

    def _roll_difference(self, now: PilotManeuver, time: float) -> float:
        """Return half the difference of the lifting duties."""
        if now.name != 'roll':
            return 0.0
        left = (time - self._began) % now.period < 0.5 * now.period
        return 0.16 if left else -0.16
