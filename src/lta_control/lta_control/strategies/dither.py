# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
r"""
DES, dither extremum seeking: one diode, and a heading that swings about an estimate.

The heading is :math:`\hat\theta + a \cos \omega t` (the paper; omega = 0.3 and a = 90 degrees are
in its source, without the unit of the first: rad/s here, 21 s per swing). The amplitude J of the
forward diode is demodulated with the swing that the drone really makes, :math:`\delta = \psi -
\hat\theta`, because the hull lags its command (Zhang, Arnold, Ghods, Siranosian and Krstic,
Systems and Control Letters 56, 2007, seek a source with such a loop):

.. math::

    \dot{\hat\theta} = k_s\,\xi \sin\delta + k_g\,\dot{\ell} \sin\delta,
    \qquad \ell = \ln(J + J_0), \qquad \xi = \ell - \bar\ell

with :math:`\bar\ell` the running mean of l. The two terms separate two effects that lead the
paper's drone to the lamp. The first is a *scan* for the bearing: a diode is directional, so l
itself rises and falls with delta when the nose swings across the lamp. The second is the
*gradient*: light differs between places, so l *rises* on the way to the brighter side and its
rate follows delta. The two are a quarter of a swing apart and hardly mix. Set one gain to 0 to
see the effect of the other.
"""

import math
from typing import NamedTuple

from lta_control.motion import wrap_angle
from lta_control.strategies.protocol import LightMeasurement, NavigationStrategy, SteeringCommand
from lta_control.strategies.settings import StrategySettings


class DitherState(NamedTuple):
    """State of DES."""

    heading: float  # last commanded [rad]
    estimate: float  # of the heading towards more light [rad]
    time: float  # of the swing [s]
    begun: bool
    level: float  # of the light, ln counts
    mean: float  # of it, over the washout


def start(heading: float) -> DitherState:
    """Return the memory before the first light: swing about the heading."""
    return DitherState(heading, heading, 0.0, False, 0.0, 0.0)


def steer(
    settings: StrategySettings, memory: DitherState, sight: LightMeasurement
) -> tuple[SteeringCommand, DitherState]:
    """Return the swinging heading at cruise speed."""
    own, dt = settings.des, sight.interval
    # Diode 0 looks forward
    level = math.log(sight.amplitudes[0] + own.floor)
    before, mean = (memory.level, memory.mean) if memory.begun else (level, level)
    # First-order washout; the limit keeps it stable for long intervals.
    mean += min(dt / own.washout, 1.0) * (level - mean)
    swing = math.sin(wrap_angle(sight.heading - memory.estimate))
    # Both terms are demodulated with the swing actually flown.
    turn = (own.scan * (level - mean) * dt + own.gradient * (level - before)) * swing
    estimate, time = memory.estimate + turn, memory.time + dt
    heading = estimate + own.amplitude * math.cos(own.rate * time)
    course = SteeringCommand(heading, settings.speed, False)
    return course, DitherState(heading, estimate, time, True, level, mean)


DITHER_STRATEGY = NavigationStrategy('des', start, steer)
