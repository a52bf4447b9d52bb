"""
One gust with a one-minus-cosine rise and decay.

    U = (x, y, z) (1 - cos(pi s / length)) / 2,    DU/Dt = dU/dt

s is the time since the begin or until the end, whichever is less, and at most `length`; between
rise and decay the gust lasts for `hold`. The rise is the discrete gust of MIL-F-8785C, section
3.7.2, over the time in which the vehicle flies its length. A `hold` longer than the flight keeps
it, as there; 0 gives the full wave of certification rules. The gust is the same everywhere, so all
of its change is a pressure gradient, and an inviscid neutral hull follows it exactly.

The memory is a clock [s]; it stops while there is no gust.
"""

from collections.abc import Mapping
import math

from lta_model.effects.protocol import AirEffect, AirEffectInput, EffectParameter, Values, Wrench

_WIND = 'spread: a door opened in a room (assumed); limits: stronger than any storm'
_TIME = 'spread: 0.5 s, about a metre at the speed of a small blimp (assumed)'

PARAMETERS = (
    *(EffectParameter(axis, 'm/s', 0.0, -60.0, 60.0, 0.3, _WIND) for axis in ('x', 'y', 'z')),
    EffectParameter('begin', 's', 0.0, 0.0, 1e5, 0.5, _TIME),
    EffectParameter('length', 's', 0.0, 0.01, 1e4, 0.5, _TIME),
    EffectParameter('hold', 's', 0.0, 0.0, 1e6, 0.5, _TIME),
)


def compute_air_motion(p: Values, memory: Values, place: AirEffectInput) -> Wrench:
    """Return the gust at this time."""
    x, y, z, begin, length, hold = p
    since = memory[0] - begin
    until = 2.0 * length + hold - since
    # Distance from the nearer end; `length` during the hold
    edge = min(since, until, length)
    if edge <= 0.0:
        return (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    if edge == length:
        return (x, y, z, 0.0, 0.0, 0.0)
    phase = math.pi * edge / length
    share = 0.5 - 0.5 * math.cos(phase)
    slope = 0.5 * math.pi / length * math.sin(phase)
    # Falling in the second half
    slope = slope if since < until else -slope
    return (x * share, y * share, z * share, x * slope, y * slope, z * slope)


def compute_memory_rate(p: Values, memory: Values, place: AirEffectInput) -> Values:
    """Return the rate of the gust clock."""
    x, y, z, begin, length, hold = p  # noqa: RUF059
    # The clock counts flight time, only while the effect is on
    return (1.0 if length > 0.0 else 0.0,)


def find_conflict(values: Mapping[str, float]) -> str:
    """Return an objection to a gust without length: its pressure gradient would be unbounded."""
    if values['length'] <= 0.0 and any(values[axis] != 0.0 for axis in ('x', 'y', 'z')):
        return 'a gust needs its rise time; set length, in seconds'
    return ''


EFFECT = AirEffect(
    'gusts', PARAMETERS, compute_air_motion, (('time', 0.0),), compute_memory_rate, find_conflict
)
