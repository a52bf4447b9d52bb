r"""
DES, dither extremum seeking: one diode, and a heading that swings about an estimate.

The heading is :math:`\hat\theta + a \cos \omega t` (the paper; omega = 0.3 and a = 90 degrees
stand in its source, without the unit of the first: rad/s here, 21 s a swing). What the diode that
looks forward reads, J, is demodulated with the swing that the drone really makes,
:math:`\delta = \psi - \hat\theta`, because the hull follows its command late (Zhang, Arnold,
Ghods, Siranosian and Krstic, Systems and Control Letters 56, 2007, seek a source by such a loop):

.. math::

    \dot{\hat\theta} = k_s\,\xi \sin\delta + k_g\,\dot{\ell} \sin\delta,
    \qquad \ell = \ln(J + J_0), \qquad \xi = \ell - \bar\ell

with :math:`\bar\ell` the running mean of l. The two terms tell apart what lets the paper's drone
find its way. A diode has a direction: when the nose swings across the lamp, l itself rises and
falls with delta, and that is the first term, a *scan* for the bearing with one diode. And light
changes from place to place: on the way to the side where it is brighter, l *rises*, so that its
rate goes with delta. That is the second term, the *gradient*. By each other's quarter of a swing
they hardly mix. Set one of both gains to 0 to see what the other is worth.
"""

import math
from typing import NamedTuple, TYPE_CHECKING

from lta_config.settings import setting, Settings
from lta_control.cascade import wrap_angle
from lta_control.strategies.protocol import LightSight, NavigationStrategy, SteeringCommand

if TYPE_CHECKING:
    from lta_control.strategies.settings import StrategySettings


class DitherSettings(Settings):
    """The swing, and how its echo in the light steers."""

    amplitude: float = setting(
        0.5 * math.pi, 'Half width of the swing.', unit='rad', low=0.0, high=math.pi
    )
    rate: float = setting(
        0.3, 'Angular frequency of the swing.', unit='rad/s', low=0.01, high=10.0
    )
    scan: float = setting(
        0.3, 'Turn rate for light that goes with the swing.', unit='rad/s', low=0.0, high=20.0
    )
    gradient: float = setting(
        0.0, 'Turn for light whose rate goes with the swing.', unit='rad', low=0.0, high=50.0
    )
    washout: float = setting(
        15.0, 'Time over which the mean light is taken.', unit='s', low=0.1, high=600.0
    )
    floor: float = setting(
        5.0, 'Light added, so that darkness has a logarithm.', unit='counts', low=0.01, high=1e6
    )


class DitherMemory(NamedTuple):
    """What DES remembers."""

    heading: float  # asked for last [rad]
    estimate: float  # of the heading towards more light [rad]
    time: float  # of the swing [s]
    begun: bool
    level: float  # of the light, ln counts
    mean: float  # of it, over the washout


def start(heading: float) -> DitherMemory:
    """Return the memory before the first light: swing about the heading."""
    return DitherMemory(heading, heading, 0.0, False, 0.0, 0.0)


def steer(
    settings: 'StrategySettings', memory: DitherMemory, sight: LightSight
) -> tuple[SteeringCommand, DitherMemory]:
    """Return the swinging heading at cruise speed."""
    own, dt = settings.des, sight.interval
    level = math.log(sight.amplitudes[0] + own.floor)
    before, mean = (memory.level, memory.mean) if memory.begun else (level, level)
    mean += min(dt / own.washout, 1.0) * (level - mean)
    swing = math.sin(wrap_angle(sight.heading - memory.estimate))
    turn = (own.scan * (level - mean) * dt + own.gradient * (level - before)) * swing
    estimate, time = memory.estimate + turn, memory.time + dt
    heading = estimate + own.amplitude * math.cos(own.rate * time)
    course = SteeringCommand(heading, settings.speed, False)
    return course, DitherMemory(heading, estimate, time, True, level, mean)


STRATEGY = NavigationStrategy('des', start, steer)
