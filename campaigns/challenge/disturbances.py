# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Disturbances outside the library that exert forces on the body."""

from collections.abc import Mapping, Sequence
import math
from typing import final

from campaigns.challenge.air import MovingAir
from campaigns.challenge.body import (
    cross_product,
    GRAVITY,
    Nine,
    rotation_matrix,
    State,
    STILL,
    to_body,
    to_map,
)
from campaigns.challenge.flight import TICK
from campaigns.challenge.truth import Six, Triple

Numbers = Mapping[str, float]


class NullDisturbance:
    """
    A disturbance without effect.

    `numbers`: parameters by name; `size` scales the disturbance.
    """

    def __init__(self, numbers: Numbers) -> None:
        self.numbers = numbers
        self.size = numbers['size']

    def adjust_duties(self, duties: Sequence[float]) -> Sequence[float]:
        """Return the duties that the rotors follow."""
        return duties

    def adjust_thrusts(self, thrusts: Sequence[float], duties: Sequence[float]) -> Sequence[float]:
        """Return the changed thrust of each rotor [N]."""
        return thrusts

    def air_motion(self) -> MovingAir | None:
        """Return its air motion, or None."""
        return None

    def step_wrench(self, time: float, state: State, air: Six, acceleration: Six) -> Six:
        """Advance by a step; return the wrench during it."""
        return STILL


def attitude_matrix(state: State) -> Nine:
    """Return the matrix from body to map."""
    return rotation_matrix(state[6], state[7], state[8], state[9])


def wrench_of_force(force: Triple, place: Triple) -> Six:
    """Return the wrench of a force at a position, both in body axes."""
    return (*force, *cross_product(place, force))


@final
class HangingWeight(NullDisturbance):
    """
    A weight on a thread below the gondola; `size` is its mass [kg].

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
    A gas bag that sloshes in the hull; `size` is its moving mass [kg].

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
    """A side force that depends on the heading; `size` is its amplitude [N]."""

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


@final
class CrossWind(NullDisturbance):
    """Oscillating wind across the room; `size` is its amplitude [m/s]."""

    def air_motion(self) -> MovingAir | None:
        """Return itself."""
        return self

    def sample_flow(self, time: float, x: float, y: float, z: float) -> Six:
        """Return velocity and acceleration of the air."""
        beat, way = 2.0 * math.pi * self.numbers['frequency'], self.numbers['way']
        phase = beat * time + self.numbers['phase']
        speed, gain = self.size * math.sin(phase), self.size * beat * math.cos(phase)
        c, s = math.cos(way), math.sin(way)
        return speed * c, speed * s, 0.0, gain * c, gain * s, 0.0


@final
class FanJet(NullDisturbance):
    """
    The jet of a fan in the room; `size` is the speed at its outlet [m/s].

    A round turbulent jet: its radius grows by 0.2 m per metre, its speed falls in proportion.
    """

    def air_motion(self) -> MovingAir | None:
        """Return itself."""
        return self

    def sample_flow(self, time: float, x: float, y: float, z: float) -> Six:
        """Return the velocity of the air; acceleration along the jet is neglected."""
        n = self.numbers
        c, s = math.cos(n['way']), math.sin(n['way'])
        east, north = x - n['x'], y - n['y']
        along, aside = c * east + s * north, c * north - s * east
        wide = n['radius'] + 0.2 * max(along, 0.0)
        far = (aside * aside + (z - n['z']) ** 2) / wide**2
        # A smooth step over about 0.3 m at the outlet; no air moves behind the fan
        behind = 1.0 / (1.0 + math.exp(-min(max(along / 0.3, -60.0), 60.0)))
        speed = behind * self.size * n['radius'] / wide * math.exp(-min(far, 60.0))
        return speed * c, speed * s, 0.0, 0.0, 0.0, 0.0


@final
class StickingRotor(NullDisturbance):
    """A rotor with play: it follows its command only beyond a distance of `size`."""

    def __init__(self, numbers: Numbers) -> None:
        super().__init__(numbers)
        self._which = int(numbers['rotor'])
        self._stuck = 0.0

    def adjust_duties(self, duties: Sequence[float]) -> Sequence[float]:
        """Return the duties, one of them with play."""
        out = list(duties)
        command = out[self._which]
        # Hysteresis: the output moves only as far as the play requires
        self._stuck = min(max(self._stuck, command - self.size), command + self.size)
        out[self._which] = min(max(self._stuck, 0.0), 1.0)
        return out


@final
class TiringRotors(NullDisturbance):
    """Rotors that weaken as they heat up; `size` is the share lost at full duty."""

    def __init__(self, numbers: Numbers) -> None:
        super().__init__(numbers)
        self._heat: list[float] = []

    def adjust_duties(self, duties: Sequence[float]) -> Sequence[float]:
        """Return the duties unchanged, and update the heat of the rotors."""
        share = TICK / self.numbers['memory']
        self._heat = self._heat or [0.0] * len(duties)
        # Copper losses grow with the square of the current, which is about that of the duty.
        self._heat = [h + share * (u * u - h) for h, u in zip(self._heat, duties, strict=True)]
        return duties

    def adjust_thrusts(self, thrusts: Sequence[float], duties: Sequence[float]) -> Sequence[float]:
        """Return the reduced thrusts."""
        if not self._heat:
            return thrusts
        return [
            t * max(1.0 - self.size * h, 0.0) for t, h in zip(thrusts, self._heat, strict=True)
        ]
