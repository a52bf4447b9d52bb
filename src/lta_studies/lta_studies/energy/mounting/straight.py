"""
The seed paper's test of a mount: straight on at 0.1 m/s, in the closed loop.

A hand holds the drone level until its estimator has learned its biases; it then hangs as its
balance lets it, rises, waits, and flies straight on. Let go level, a drone whose balance leans it
swings about its lean as far as it leans: that swing is told apart from that of the flight.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
import math
from typing import final

from lta_control.cascade import Setpoint
from lta_flight.ingredients import gather
from lta_flight.loop import Loop
from lta_studies.energy.flown import Flown, fly, for_seconds, loop_on
from lta_studies.energy.mounting.fitted import Fitted
import numpy as np

SPEED = 0.1  # m/s, seed paper
HELD, LIFT_OFF, AWAY, END = 5.0, 8.0, 40.0, 100.0  # s
RISE = 1.5  # m
SCENE = 'hall'


@final
@dataclass(frozen=True, slots=True)
class Straight:
    """
    What a flight came to.

    Attributes
    ----------
    swing : float
        Greatest deviation from the mean pitch between lift-off and the start of the way. [rad]
    lean : float
        Mean pitch on the way, nose down positive. [rad]
    amplitude, rms : float
        Half of the range of pitch on the way, and its deviation from the mean. [rad]
    power : float
        Mean on the way, electronics and radio included. [W]
    hover : float
        The same over the last 10 s before it. [W]
    flown : Flown
        The flight.

    """

    swing: float
    lean: float
    amplitude: float
    rms: float
    power: float
    hover: float
    flown: Flown


def begun(fitted: Fitted, gains: str, seed: int) -> Loop:
    """Return a flight, by gains of some name ('' for the vehicle's own), that is to begin."""
    made_of = gather('gtmab', SCENE, 'bag', gains)
    scene = made_of.contents['scenario']
    start = {**scene['start'], 'held': f'{HELD} s'}
    contents = {
        **made_of.contents,
        'vehicle': fitted.content,
        'scenario': {**scene, 'start': start},
    }
    base = fitted.vehicle.standing_height

    def course(time: float) -> Setpoint:
        rise = RISE if time >= LIFT_OFF else 0.0
        return Setpoint(base + rise, 0.0, SPEED if time >= AWAY else 0.0)

    return loop_on(replace(made_of, contents=contents), course, seed)


def straight(fitted: Fitted, gains: str, seed: int) -> Straight:
    """Fly once with a seed, by gains of some name ('' for the vehicle's own), and judge."""
    return judged(fitted, fly(begun(fitted, gains, seed), for_seconds(END)))


def judged(fitted: Fitted, flown: Flown) -> Straight:
    """Return what a flight came to."""
    loads = fitted.vehicle.loads
    steady = loads.idle + loads.transmitting
    rising, way = flown.between(LIFT_OFF, AWAY), flown.between(AWAY, END)
    before = flown.between(AWAY - 10.0, AWAY)
    return Straight(
        swing=float(np.abs(rising.pitch - rising.pitch.mean()).max()),
        lean=-float(way.pitch.mean()),
        amplitude=0.5 * float(np.ptp(way.pitch)),
        rms=float(way.pitch.std()),
        power=steady + float(way.rotors.mean()),
        hover=steady + float(before.rotors.mean()),
        flown=flown,
    )


@final
@dataclass(frozen=True, slots=True)
class Spread:
    """Mean over the seeds and the greatest deviation of one from it."""

    mean: float
    off: float


def over(flights: Sequence[Straight], name: str) -> Spread:
    """Return a figure over several flights, by the name of an attribute."""
    values = [float(getattr(each, name)) for each in flights]
    mean = math.fsum(values) / len(values)
    return Spread(mean, max(abs(value - mean) for value in values))
