"""Disturbances outside the library that exert forces on the body."""

import math
from typing import final

from campaigns.challenge.body import (
    cross_product,
    GRAVITY,
    Nine,
    rotation_matrix,
    State,
    to_body,
    to_map,
)
from campaigns.challenge.flight import TICK
from campaigns.challenge.null_disturbance import NullDisturbance, Numbers
from campaigns.challenge.truth import Six, Triple


def attitude_matrix(state: State) -> Nine:
    """Return the matrix from body to map."""
    return rotation_matrix(state[6], state[7], state[8], state[9])


def wrench_of_force(force: Triple, place: Triple) -> Six:
    """Return the wrench of a force at a position, both in body axes."""
    return (*force, *cross_product(place, force))


@final
class HangingWeight(NullDisturbance):
    """
    A weight on a thread below the gondola; `size` is its mass. [kg]

    Small angles are assumed. Ballast of the same mass was removed, so only the lateral force of
    the thread is new.
    """

    def __init__(self, numbers: Numbers) -> None:
        super().__init__(numbers)
        self._place, self._speed = [0.0, 0.0], [0.0, 0.0]

    def step_wrench(self, time: float, state: State, air: Six, acceleration: Six) -> Six:
        """Advance the swing and return its pull."""
        length, hook = self.numbers['length'], (0.0, 0.0, -self.numbers['depth'])
        r, rates = attitude_matrix(state), (state[10], state[11], state[12])
        # Acceleration of the hook relative to the hull centre: Euler and centripetal terms
        spun = cross_product((acceleration[3], acceleration[4], acceleration[5]), hook)
        swung = cross_product(rates, cross_product(rates, hook))
        swing = to_map(r, *(one + two for one, two in zip(spun, swung, strict=True)))
        pulls = []
        for k in range(2):
            gain = -GRAVITY / length * self._place[k] - acceleration[k] - swing[k]
            gain -= self.numbers['damping'] * self._speed[k]
            # Semi-implicit Euler, which does not add energy to the swing
            self._speed[k] += TICK * gain
            self._place[k] += TICK * self._speed[k]
            pulls.append(self.size * GRAVITY * self._place[k] / length)
        return wrench_of_force(to_body(r, pulls[0], pulls[1], 0.0), hook)


@final
class SkewedDrag(NullDisturbance):
    """Drag with exponent 1.5 along an oblique body direction; `size` in N s1.5/m1.5."""

    def step_wrench(self, time: float, state: State, air: Six, acceleration: Six) -> Six:
        """Return the drag."""
        r = attitude_matrix(state)
        v = to_body(r, state[3] - air[0], state[4] - air[1], state[5] - air[2])
        angle, rise = self.numbers['angle'], self.numbers['rise']
        along = (
            math.cos(rise) * math.cos(angle),
            math.cos(rise) * math.sin(angle),
            math.sin(rise),
        )
        speed = sum(one * two for one, two in zip(v, along, strict=True))
        force = -self.size * math.copysign(abs(speed) ** 1.5, speed)
        return force * along[0], force * along[1], force * along[2], 0.0, 0.0, 0.0


@final
class Tether(NullDisturbance):
    """A rubber thread from the gondola to a point on the floor; `size` is its stiffness. [N/m]."""

    def step_wrench(self, time: float, state: State, air: Six, acceleration: Six) -> Six:
        """Return the pull; zero while the thread is slack."""
        r, depth = attitude_matrix(state), self.numbers['depth']
        # Position of the gondola: `depth` below the hull centre along the body's z axis
        end = [state[k] - depth * r[3 * k + 2] for k in range(3)]
        way = [self.numbers['x'] - end[0], self.numbers['y'] - end[1], -end[2]]
        length = math.sqrt(sum(each * each for each in way))
        # Force per metre of `way`; the thread cannot push
        pull = self.size * max(length - self.numbers['rest'], 0.0) / max(length, 1e-6)
        return wrench_of_force(to_body(r, *(pull * each for each in way)), (0.0, 0.0, -depth))


@final
class SloshingGas(NullDisturbance):
    """
    A gas bag that sloshes in the hull; `size` is its moving mass. [kg]

    It is a damped spring-mass system driven by the specific force.
    """

    def __init__(self, numbers: Numbers) -> None:
        super().__init__(numbers)
        self._place, self._speed = [0.0, 0.0], [0.0, 0.0]

    def step_wrench(self, time: float, state: State, air: Six, acceleration: Six) -> Six:
        """Advance the motion of the mass and return its wrench."""
        n, r = self.numbers, attitude_matrix(state)
        beat = 2.0 * math.pi * n['frequency']
        felt = to_body(r, acceleration[0], acceleration[1], acceleration[2] + GRAVITY)
        forces = []
        for k in range(2):
            gain = -felt[k] - beat * (beat * self._place[k] + 2.0 * n['damping'] * self._speed[k])
            self._speed[k] += TICK * gain
            self._place[k] += TICK * self._speed[k]
            # Only the relative acceleration counts: the mass at rest is part of the hull
            forces.append(-self.size * gain)
        x, y, z, a, b, c = wrench_of_force((forces[0], forces[1], 0.0), (0.0, 0.0, n['height']))
        weight = -self.size * felt[2]
        return x, y, z, a + weight * self._place[1], b - weight * self._place[0], c


@final
class HeadingForce(NullDisturbance):
    """A side force that depends on the heading; `size` is its amplitude. [N]"""

    def step_wrench(self, time: float, state: State, air: Six, acceleration: Six) -> Six:
        """Return the side force."""
        r = attitude_matrix(state)
        heading = math.atan2(r[3], r[0])
        force = self.size * math.sin(self.numbers['waves'] * heading + self.numbers['phase'])
        return 0.0, force, 0.0, 0.0, 0.0, 0.0


@final
class VortexShedding(NullDisturbance):
    """
    An alternating side force of a moving hull, as by shed vortices.

    Its frequency has a constant Strouhal number, and it grows with the square of the speed;
    `size` is its coefficient. [N s2/m2]
    """

    def __init__(self, numbers: Numbers) -> None:
        super().__init__(numbers)
        self._phase = numbers['phase']

    def step_wrench(self, time: float, state: State, air: Six, acceleration: Six) -> Six:
        """Advance the phase and return the force across the motion."""
        r = attitude_matrix(state)
        v = to_body(r, state[3] - air[0], state[4] - air[1], state[5] - air[2])
        speed = math.hypot(v[0], v[1])
        self._phase += 2.0 * math.pi * self.numbers['strouhal'] * speed * TICK
        force = self.size * speed * math.sin(self._phase)
        # Perpendicular to the horizontal velocity: size speed^2 sin(phase)
        return -force * v[1], force * v[0], 0.0, 0.0, 0.0, 0.0
