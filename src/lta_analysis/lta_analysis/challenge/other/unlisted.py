"""
Things that are in no library: what they do to the duties, the thrust, the air or the vehicle.

Each is made of numbers by name; the one called `size` scales it.
"""

from collections.abc import Callable, Mapping, Sequence
import math
from typing import final

from lta_analysis.challenge.other.air import MovingAir
from lta_analysis.challenge.other.body import cross, Nine, rotation, State, STILL, to_body
from lta_analysis.challenge.other.flight import TICK
from lta_analysis.challenge.other.truth import Six, Triple

Numbers = Mapping[str, float]


def turn_of(state: State) -> Nine:
    """Return the matrix from body to map."""
    return rotation(state[6], state[7], state[8], state[9])


def pulled(force: Triple, place: Triple) -> Six:
    """Return the wrench of a force in body axes at a place of the body."""
    return (*force, *cross(place, force))


class Harmless:
    """Something that does nothing: what the others are made from."""

    def __init__(self, numbers: Numbers) -> None:
        self.numbers = numbers
        self.size = numbers['size']

    def duties(self, duties: Sequence[float]) -> Sequence[float]:
        """Return what the rotors do of what is commanded."""
        return duties

    def thrusts(self, thrusts: Sequence[float], duties: Sequence[float]) -> Sequence[float]:
        """Return what comes of the thrust of each rotor. [N]."""
        return thrusts

    def air(self) -> MovingAir | None:
        """Return how it moves the air."""
        return None

    def push(self, time: float, state: State, air: Six, acceleration: Six) -> Six:
        """Return its wrench over the next step, and go on."""
        return STILL


@final
class HangingWeight(Harmless):
    """
    A weight on a thread below the gondola; `size` is its mass. [kg]

    The swing is small: the thread pulls aside by its angle. As much ballast was taken off, so
    that only the pull aside is new.
    """

    def __init__(self, numbers: Numbers) -> None:
        super().__init__(numbers)
        self._place, self._speed = [0.0, 0.0], [0.0, 0.0]

    def push(self, time: float, state: State, air: Six, acceleration: Six) -> Six:
        """Swing on and pull."""
        length, depth = self.numbers['length'], self.numbers['depth']
        r = turn_of(state)
        pulls = []
        for k in range(2):
            # Where it hangs speeds up with the hull; the rest of its motion is left out.
            gain = -9.80665 / length * self._place[k] - acceleration[k]
            gain -= self.numbers['damping'] * self._speed[k]
            self._speed[k] += TICK * gain
            self._place[k] += TICK * self._speed[k]
            pulls.append(self.size * 9.80665 * self._place[k] / length)
        return pulled(to_body(r, pulls[0], pulls[1], 0.0), (0.0, 0.0, -depth))


@final
class StickingRotor(Harmless):
    """A rotor that follows its command only where that moves by more than `size`."""

    def __init__(self, numbers: Numbers) -> None:
        super().__init__(numbers)
        self._which = int(numbers['rotor'])
        self._stuck = 0.0

    def duties(self, duties: Sequence[float]) -> Sequence[float]:
        """Return the duties, of which one lags behind by a play."""
        out = list(duties)
        wanted = out[self._which]
        self._stuck = min(max(self._stuck, wanted - self.size), wanted + self.size)
        out[self._which] = min(max(self._stuck, 0.0), 1.0)
        return out


@final
class SkewedDrag(Harmless):
    """Drag with exponent 1.5 in one direction of the body, askew of its axes; N s1.5/m1.5."""

    def push(self, time: float, state: State, air: Six, acceleration: Six) -> Six:
        """Brake along that direction."""
        r = turn_of(state)
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
class CrossWind(Harmless):
    """Wind across the room that turns to and fro, `size` at its strongest. [m/s]."""

    def air(self) -> MovingAir | None:
        """Return itself."""
        return self

    def at(self, time: float, x: float, y: float, z: float) -> Six:
        """Return velocity and acceleration of the air."""
        beat, way = 2.0 * math.pi * self.numbers['frequency'], self.numbers['way']
        phase = beat * time + self.numbers['phase']
        speed, gain = self.size * math.sin(phase), self.size * beat * math.cos(phase)
        c, s = math.cos(way), math.sin(way)
        return speed * c, speed * s, 0.0, gain * c, gain * s, 0.0


@final
class Tether(Harmless):
    """A rubber thread from the gondola to a point on the floor; `size` is its stiffness. [N/m]."""

    def push(self, time: float, state: State, air: Six, acceleration: Six) -> Six:
        """Pull where it is taut."""
        r, depth = turn_of(state), self.numbers['depth']
        end = [state[k] - depth * r[3 * k + 2] for k in range(3)]
        way = [self.numbers['x'] - end[0], self.numbers['y'] - end[1], -end[2]]
        length = math.sqrt(sum(each * each for each in way))
        pull = self.size * max(length - self.numbers['rest'], 0.0) / max(length, 1e-6)
        return pulled(to_body(r, *(pull * each for each in way)), (0.0, 0.0, -depth))


@final
class FanJet(Harmless):
    """
    Air from a fan at a place in the room, `size` at its mouth. [m/s]

    A round turbulent jet: its radius grows by a fifth of the way, its speed falls as much.
    """

    def air(self) -> MovingAir | None:
        """Return itself."""
        return self

    def at(self, time: float, x: float, y: float, z: float) -> Six:
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
class SloshingGas(Harmless):
    """
    A gas bag that sloshes in the hull; `size` is the mass that moves. [kg]

    It goes to and fro on a spring against the specific force that it feels.
    """

    def __init__(self, numbers: Numbers) -> None:
        super().__init__(numbers)
        self._place, self._speed = [0.0, 0.0], [0.0, 0.0]

    def push(self, time: float, state: State, air: Six, acceleration: Six) -> Six:
        """Slosh on and push."""
        n, r = self.numbers, turn_of(state)
        beat = 2.0 * math.pi * n['frequency']
        felt = to_body(r, acceleration[0], acceleration[1], acceleration[2] + 9.80665)
        forces = []
        for k in range(2):
            gain = -felt[k] - beat * (beat * self._place[k] + 2.0 * n['damping'] * self._speed[k])
            self._speed[k] += TICK * gain
            self._place[k] += TICK * self._speed[k]
            # The wall gives what it already gives a mass that does not move, less this.
            forces.append(-self.size * gain)
        x, y, z, a, b, c = pulled((forces[0], forces[1], 0.0), (0.0, 0.0, n['height']))
        weight = -self.size * felt[2]
        return x, y, z, a + weight * self._place[1], b - weight * self._place[0], c


@final
class TiringRotors(Harmless):
    """Rotors that grow warm with use and weaker by it; `size` is the share lost at full duty."""

    def __init__(self, numbers: Numbers) -> None:
        super().__init__(numbers)
        self._heat: list[float] = []

    def push(self, time: float, state: State, air: Six, acceleration: Six) -> Six:
        """Do nothing to the body."""
        return STILL

    def duties(self, duties: Sequence[float]) -> Sequence[float]:
        """Return them; they warm the rotors."""
        share = TICK / self.numbers['memory']
        self._heat = self._heat or [0.0] * len(duties)
        # Copper losses grow with the square of the current, which is about that of the duty.
        self._heat = [h + share * (u * u - h) for h, u in zip(self._heat, duties, strict=True)]
        return duties

    def thrusts(self, thrusts: Sequence[float], duties: Sequence[float]) -> Sequence[float]:
        """Return weaker ones."""
        if not self._heat:
            return thrusts
        return [
            t * max(1.0 - self.size * h, 0.0) for t, h in zip(thrusts, self._heat, strict=True)
        ]


@final
class HeadingForce(Harmless):
    """A force across the hull that depends on where it points, `size` at its strongest. [N]."""

    def push(self, time: float, state: State, air: Six, acceleration: Six) -> Six:
        """Return it."""
        r = turn_of(state)
        heading = math.atan2(r[3], r[0])
        force = self.size * math.sin(self.numbers['waves'] * heading + self.numbers['phase'])
        return 0.0, force, 0.0, 0.0, 0.0, 0.0


@final
class VortexShedding(Harmless):
    """
    A side force that alternates while the hull moves, as by vortices behind it.

    At a Strouhal number, and as the square of speed; `size` is its coefficient. [N s2/m2]
    """

    def __init__(self, numbers: Numbers) -> None:
        super().__init__(numbers)
        self._phase = numbers['phase']

    def push(self, time: float, state: State, air: Six, acceleration: Six) -> Six:
        """Go on with the phase, and push across the motion."""
        r = turn_of(state)
        v = to_body(r, state[3] - air[0], state[4] - air[1], state[5] - air[2])
        speed = math.hypot(v[0], v[1])
        self._phase += 2.0 * math.pi * self.numbers['strouhal'] * speed * TICK
        force = self.size * speed * math.sin(self._phase)
        return -force * v[1], force * v[0], 0.0, 0.0, 0.0, 0.0


UNLISTED: Mapping[str, Callable[[Numbers], Harmless]] = {
    'other_pendulum': HangingWeight,
    'other_sticking_rotor': StickingRotor,
    'other_skewed_drag': SkewedDrag,
    'other_cross_wind': CrossWind,
    'other_tether': Tether,
    'other_fan': FanJet,
    'other_sloshing': SloshingGas,
    'other_tiring_rotors': TiringRotors,
    'other_heading_force': HeadingForce,
    'other_shedding': VortexShedding,
}
