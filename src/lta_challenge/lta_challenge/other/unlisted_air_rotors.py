"""Disturbances outside the library that act on the air or the rotors."""

from collections.abc import Sequence
import math
from typing import final

from lta_challenge.other.air import MovingAir
from lta_challenge.other.flight import TICK
from lta_challenge.other.null_disturbance import NullDisturbance, Numbers
from lta_challenge.other.truth import Six


@final
class CrossWind(NullDisturbance):
    """Wind across the room that turns to and fro, `size` at its strongest. [m/s]."""

    def moving_air(self) -> MovingAir | None:
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
    Air from a fan at a place in the room, `size` at its mouth. [m/s]

    A round turbulent jet: its radius grows by a fifth of the way, its speed falls as much.
    """

    def moving_air(self) -> MovingAir | None:
        """Return itself."""
        return self

    def sample_flow(self, time: float, x: float, y: float, z: float) -> Six:
        """Return the velocity of the air; its acceleration along the jet is left out."""
        n = self.numbers
        c, s = math.cos(n['way']), math.sin(n['way'])
        east, north = x - n['x'], y - n['y']
        along, aside = c * east + s * north, c * north - s * east
        wide = n['radius'] + 0.2 * max(along, 0.0)
        far = (aside * aside + (z - n['z']) ** 2) / wide**2
        behind = 1.0 / (1.0 + math.exp(-min(max(along / 0.3, -60.0), 60.0)))
        speed = behind * self.size * n['radius'] / wide * math.exp(-min(far, 60.0))
        return speed * c, speed * s, 0.0, 0.0, 0.0, 0.0


@final
class StickingRotor(NullDisturbance):
    """A rotor that follows its command only where that moves by more than `size`."""

    def __init__(self, numbers: Numbers) -> None:
        super().__init__(numbers)
        self._which = int(numbers['rotor'])
        self._stuck = 0.0

    def adjust_duties(self, duties: Sequence[float]) -> Sequence[float]:
        """Return the duties, of which one lags behind by a play."""
        out = list(duties)
        wanted = out[self._which]
        self._stuck = min(max(self._stuck, wanted - self.size), wanted + self.size)
        out[self._which] = min(max(self._stuck, 0.0), 1.0)
        return out


@final
class TiringRotors(NullDisturbance):
    """Rotors that grow warm with use and weaker by it; `size` is the share lost at full duty."""

    def __init__(self, numbers: Numbers) -> None:
        super().__init__(numbers)
        self._heat: list[float] = []

    def adjust_duties(self, duties: Sequence[float]) -> Sequence[float]:
        """Return them; they warm the rotors."""
        share = TICK / self.numbers['memory']
        self._heat = self._heat or [0.0] * len(duties)
        # Copper losses grow with the square of the current, which is about that of the duty.
        self._heat = [h + share * (u * u - h) for h, u in zip(self._heat, duties, strict=True)]
        return duties

    def adjust_thrusts(self, thrusts: Sequence[float], duties: Sequence[float]) -> Sequence[float]:
        """Return weaker ones."""
        if not self._heat:
            return thrusts
        return [
            t * max(1.0 - self.size * h, 0.0) for t, h in zip(thrusts, self._heat, strict=True)
        ]
