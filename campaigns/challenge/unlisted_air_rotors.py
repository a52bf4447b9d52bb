"""Disturbances outside the library that act on the air or the rotors."""

from collections.abc import Sequence
import math
from typing import final

from campaigns.challenge.air import MovingAir
from campaigns.challenge.flight import TICK
from campaigns.challenge.null_disturbance import NullDisturbance, Numbers
from campaigns.challenge.truth import Six


@final
class CrossWind(NullDisturbance):
    """Oscillating wind across the room; `size` is its amplitude. [m/s]"""

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
    The jet of a fan in the room; `size` is the speed at its outlet. [m/s]

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
