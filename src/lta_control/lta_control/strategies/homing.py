r"""
Homing, LTA's own strategy: fly along the line to the lamp whatever the wind.

`lamp_filter` fuses bearings and strengths with dead reckoning into where the lamp is and how the
drone drifts. Its way through the air is that of the wind triangle (`wind_triangle`):
a drone in a cross wind holds its bearing instead of being bent into a dog's curve, and in a head
wind it flies faster. Near the lamp the speed over the ground falls with the range, `approach` a
second; inside `arrival` the drone has arrived, and it holds its place against the wind at half of
that, since what it takes for the range may be somewhat less than it is.

What does not fit is not followed: a bearing that is itself uncertain, one that is far off the
filter's, and one that is much weaker than the lamp would be from there, as an echo is whose lamp
is hidden. While there is no light that fits, the filter goes on by dead reckoning for `hold`; then
the drone searches, by a turn on the spot and then in circles that widen. A light that is no weaker
than the lamp but elsewhere, or far stronger, for `doubt` is taken for the lamp: the filter was
wrong. So is any light that is found after a search of a whole turn.

Near a lamp that stands higher than the diodes the drone's own hull hides it. It flies on by dead
reckoning as before, against the wind as before: the last metre is flown blind.
"""

import math
from typing import NamedTuple, TYPE_CHECKING

from lta_config.settings import setting, Settings
from lta_control.strategies.lamp_ekf import (
    bearing_deviation,
    expected_strength,
    initialize_fix,
    LampFilterPrior,
    LampFix,
    normalized_innovation,
    predict_fix,
    update_fix,
)
from lta_control.strategies.protocol import LightSight, NavigationStrategy, SteeringCommand
from lta_control.strategies.wind_triangle import solve_wind_triangle

if TYPE_CHECKING:
    from lta_control.strategies.settings import StrategySettings

LEAST_PUSH = 0.1  # m/s forward on the way, where the wind carries the drone there by itself
STAY = 2.0  # of the arrival range: who has arrived may be blown so far off and has still arrived


class HomingSettings(Settings):
    """What homing knows of lamp, wind and drone beforehand, and how patient it is."""

    top_speed: float = setting(
        1.05, 'Fastest airspeed to ask for.', unit='m/s', low=0.05, high=20.0
    )
    brightness: float = setting(
        2100.0,
        'Strength of the lamp at one metre, by the largest resistor.',
        unit='counts',
        low=1.0,
        high=1e9,
    )
    unsure: float = setting(
        0.5, 'Standard deviation of its logarithm.', unit='1', low=0.01, high=5.0
    )
    bearing_noise: float = setting(
        0.03, 'Standard deviation of one bearing beyond its own.', unit='rad', low=1e-4, high=1.0
    )
    strength_noise: float = setting(
        0.15, "Standard deviation of one strength's logarithm.", unit='1', low=0.01, high=5.0
    )
    wind: float = setting(
        0.4, 'Standard deviation of the drift to expect.', unit='m/s', low=0.0, high=10.0
    )
    gusts: float = setting(
        0.03, 'How much the drift changes in a second.', unit='m/s', low=0.0, high=5.0
    )
    settling: float = setting(
        6.0,
        'Time in which the drone learns its airspeed once it flies: gusts seem larger till then.',
        unit='s',
        low=0.1,
        high=60.0,
    )
    unsettled: float = setting(
        0.6, 'How much the drift changes in a second at first.', unit='m/s', low=0.0, high=5.0
    )
    gate: float = setting(
        4.0, 'Standard deviations beyond which a sight does not fit.', unit='1', low=1.0, high=20.0
    )
    echo: float = setting(
        0.25,
        'Share of the strength that fits, below which a light is an echo; one over it: too much.',
        unit='1',
        low=0.0,
        high=1.0,
    )
    trusted: float = setting(
        0.5, 'Deviation beyond which a bearing is not looked at.', unit='rad', low=0.01, high=3.2
    )
    doubt: float = setting(
        1.5, 'Time after which a light elsewhere is the lamp.', unit='s', low=0.1, high=60.0
    )
    hold: float = setting(
        8.0, 'Time to fly by dead reckoning without light.', unit='s', low=0.0, high=600.0
    )
    certain: float = setting(
        0.8, 'Deviation of its bearing up to which so.', unit='rad', low=0.05, high=3.2
    )
    arrival: float = setting(
        0.8, 'Horizontal range at which it has arrived.', unit='m', low=0.1, high=100.0
    )
    approach: float = setting(
        0.5,
        'Speed over the ground per metre to go, near the lamp.',
        unit='1/s',
        low=0.05,
        high=5.0,
    )


class HomingMemory(NamedTuple):
    """What homing remembers."""

    heading: float  # asked for last [rad]
    known: bool  # whether there is a fix
    fix: LampFix
    begun: bool  # whether `place` is known
    place: tuple[float, float]  # dead reckoned, at the last sight [m]
    flown: float  # time since the first sight [s]
    lost: float  # time without light that fits [s]
    doubted: float  # time with a strong light elsewhere [s]
    searched: float  # time of search [s]
    arrived: bool


def start(heading: float) -> HomingMemory:
    """Return the memory before the first sight: nothing is known."""
    none = (0.0, 0.0, 0.0, 0.0, 0.0)
    fix = LampFix(0.0, 0.0, 0.0, 0.0, 0.0, (none, none, none, none, none))
    return HomingMemory(heading, False, fix, False, (0.0, 0.0), 0.0, 0.0, 0.0, 0.0, False)


def reset_for_next_lamp(memory: HomingMemory) -> HomingMemory:
    """Return the memory on the way to another lamp: the wind is the same."""
    return HomingMemory(
        memory.heading, False, memory.fix, memory.begun, memory.place, memory.flown, 0.0, 0.0, 0.0,
        False,
    )  # fmt: skip


def watch(settings: 'StrategySettings', memory: HomingMemory, sight: LightSight) -> HomingMemory:
    """Return the memory after a sight from a drone that climbs: wind is felt at once."""
    return follow_sight(settings, memory, sight)


def steer(
    settings: 'StrategySettings', memory: HomingMemory, sight: LightSight
) -> tuple[SteeringCommand, HomingMemory]:
    """Return the course through the air that leads along the line to the lamp."""
    own = settings.homing
    memory = follow_sight(settings, memory, sight)
    unsure = memory.searched > 0.0 or bearing_deviation(memory.fix) > own.certain
    lost = memory.lost > own.hold or (memory.lost > 0.0 and unsure)
    if not memory.known or lost:
        heading, speed = steer_search(settings, memory, sight.interval)
        after = _update_search(memory, heading, memory.searched + sight.interval)
        return SteeringCommand(heading, speed, False), after
    heading, speed = steer_to_lamp(settings, memory)
    after = _update_search(memory, heading, 0.0)
    return SteeringCommand(heading, speed, after.arrived), after


def _update_search(m: HomingMemory, heading: float, searched: float) -> HomingMemory:
    """Return a memory with what was asked for."""
    arrived = m.arrived and searched <= 0.0
    return HomingMemory(
        heading, m.known, m.fix, m.begun, m.place, m.flown, m.lost, m.doubted, searched, arrived
    )  # fmt: skip


def build_optics(own: HomingSettings, flight_time: float) -> LampFilterPrior:
    """Return what the filter knows beforehand, some time after the first sight. [s]"""
    gusts = math.hypot(own.gusts, own.unsettled * math.exp(-flight_time / own.settling))
    return LampFilterPrior(
        math.log(own.brightness),
        own.unsure,
        own.bearing_noise,
        own.strength_noise,
        own.wind,
        gusts,
    )


def follow_sight(settings: 'StrategySettings', m: HomingMemory, sight: LightSight) -> HomingMemory:
    """Return the memory with what one more sight tells, if it fits."""
    own, dt = settings.homing, sight.interval
    optics = build_optics(own, m.flown)
    fix, known, lost, doubted = m.fix, m.known, m.lost + dt, m.doubted
    if m.known:
        moved_x, moved_y = sight.position[0] - m.place[0], sight.position[1] - m.place[1]
        fix = predict_fix(optics, fix, moved_x, moved_y, dt)
    if sight.seen and sight.deviation <= own.trusted:
        bearing, strength = sight.heading + sight.bearing, max(sight.strength, 1.0)
        there = known and normalized_innovation(fix, optics, bearing, sight.deviation) <= own.gate
        share = strength / expected_strength(fix) if known else 1.0
        fits = there and own.echo <= share <= 1.0 / own.echo
        doubted = 0.0 if fits or share < own.echo else doubted + dt
        sought = m.searched > full_turn_time(settings)
        if not known or doubted > own.doubt or (sought and not fits):
            drift = fix.wind_x, fix.wind_y
            fix, known = initialize_fix(optics, bearing, sight.deviation, strength, drift), True
            lost = doubted = 0.0
        elif fits:
            fix, lost = update_fix(fix, optics, bearing, sight.deviation, strength), 0.0
    away = math.hypot(fix.x, fix.y)
    limit = own.arrival * (STAY if m.arrived else 1.0)
    arrived = known and away <= limit
    return HomingMemory(
        m.heading, known, fix, True, sight.position, m.flown + dt, lost, doubted, m.searched,
        arrived,
    )  # fmt: skip


def steer_to_lamp(settings: 'StrategySettings', m: HomingMemory) -> tuple[float, float]:
    """Return heading [rad] and airspeed [m/s] along the line to the lamp, or to hold there."""
    own, fix = settings.homing, m.fix
    away = max(math.hypot(fix.x, fix.y), 1e-6)
    over_ground = min(settings.speed, max(own.approach * (away - 0.5 * own.arrival), 0.0))
    top = max(own.top_speed, settings.speed)
    near = own.approach * away < settings.speed
    return solve_wind_triangle(
        (fix.x + 1e-9, fix.y),
        (fix.wind_x, fix.wind_y),
        over_ground,
        top,
        -top if near else LEAST_PUSH,
    )


def full_turn_time(settings: 'StrategySettings') -> float:
    """Return how long a turn on the spot takes. [s]"""
    return 2.0 * math.pi / max(settings.search_rate, 1e-3)


def steer_search(
    settings: 'StrategySettings', m: HomingMemory, interval: float
) -> tuple[float, float]:
    """Return heading [rad] and airspeed [m/s] of a search: a turn, then circles that widen."""
    turn = full_turn_time(settings)
    if m.searched < turn:
        return m.heading + settings.search_rate * interval, 0.0
    return m.heading + settings.search_rate * interval * turn / m.searched, settings.speed


STRATEGY = NavigationStrategy('homing', start, steer, watch, reset_for_next_lamp, ranges=True)
