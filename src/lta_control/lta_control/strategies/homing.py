r"""
Homing, LTA's own strategy: fly along the line to the lamp in any wind.

`lamp_ekf` fuses bearings and strengths with dead reckoning into the lamp's position and the
drone's drift. The course through the air follows from the wind triangle (`wind_triangle`): a
drone in a cross wind stays on the line instead of a curve of pursuit, and in a head wind it flies
faster. Near the lamp the ground speed falls with the range by `approach` per second. Inside
`arrival` the drone has arrived; it holds its position against the wind at half that range,
because the range may be underestimated.

Outliers are ignored: an uncertain bearing, one far from the filter's, and one much weaker than
the lamp would be, such as a reflection of a hidden lamp. Without accepted light the filter
continues by dead reckoning for `hold`; then the drone searches, with a turn on the spot and then
widening circles. A light elsewhere that is as strong as the lamp, or much stronger, is accepted
as the lamp after `doubt`: the filter was wrong. So is any light after a search of a full turn.

The drone's own hull hides a lamp that is near and higher than the diodes. The drone then
continues by dead reckoning and wind correction: it flies the last metre without light.

With `brake`, the ground speed falls with the range over `braking` seconds. The drag of a blimp is
too weak for that: the drone turns against its motion and pushes, and stays.
"""

import math
from typing import NamedTuple, TYPE_CHECKING

from lta_config.settings import setting, Settings
from lta_control.cascade import wrap_angle
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
from lta_control.strategies.protocol import LightMeasurement, NavigationStrategy, SteeringCommand
from lta_control.strategies.wind_triangle import solve_wind_triangle, STEERAGE

if TYPE_CHECKING:
    from lta_control.strategies.settings import StrategySettings

LEAST_PUSH = 0.1  # m/s; least forward airspeed on the way, even where the wind alone would suffice
AHEAD = 2.0  # rad; a farther heading is commanded step by step, so that the sense of a turn stays
BAND = 0.12  # m/s; error of the ground velocity that is not worth a turn
STAY = 2.0  # of the arrival range: hysteresis, so that wind does not undo an arrival


class HomingSettings(Settings):
    """Prior knowledge of lamp, wind and drone, and the time limits of homing."""

    top_speed: float = setting(0.7, 'Highest commanded airspeed.', unit='m/s', low=0.05, high=20.0)
    brightness: float = setting(
        2100.0,
        'Expected brightness of the lamp at 1 m, with a resistor of 100 kohm in the '
        'photodiode amplifiers.',
        unit='counts',
        low=1.0,
        high=1e9,
    )
    unsure: float = setting(
        0.5,
        'Uncertainty of the expected lamp brightness: standard deviation of its logarithm.',
        unit='1',
        low=0.01,
        high=5.0,
    )
    bearing_noise: float = setting(
        0.03,
        'Standard deviation added to the one reported with each bearing.',
        unit='rad',
        low=1e-4,
        high=1.0,
    )
    strength_noise: float = setting(
        0.15,
        'Noise of a measured lamp brightness: standard deviation of its logarithm.',
        unit='1',
        low=0.01,
        high=5.0,
    )
    wind: float = setting(
        0.4,
        'Standard deviation of the wind drift assumed at the start.',
        unit='m/s',
        low=0.0,
        high=10.0,
    )
    gusts: float = setting(
        0.03,
        'Expected random change of the wind drift in one second.',
        unit='m/s',
        low=0.0,
        high=5.0,
    )
    settling: float = setting(
        6.0,
        'Time for the airspeed estimate to settle after take-off; until then, larger '
        'changes of the drift are expected (see unsettled).',
        unit='s',
        low=0.1,
        high=60.0,
    )
    unsettled: float = setting(
        0.6,
        'Expected random change of the wind drift in one second, just after take-off.',
        unit='m/s',
        low=0.0,
        high=5.0,
    )
    gate: float = setting(
        4.0,
        'Number of standard deviations beyond which a light measurement is rejected as an '
        'outlier.',
        unit='1',
        low=1.0,
        high=20.0,
    )
    echo: float = setting(
        0.25,
        'Smallest plausible ratio of measured to expected brightness: weaker light counts '
        'as a reflection, and light above the inverse ratio as too bright for the lamp.',
        unit='1',
        low=0.0,
        high=1.0,
    )
    trusted: float = setting(
        0.5, 'Standard deviation above which a bearing is ignored.', unit='rad', low=0.01, high=3.2
    )
    doubt: float = setting(
        1.5,
        'Time for which a light in another place must be seen before it is accepted as the lamp.',
        unit='s',
        low=0.1,
        high=60.0,
    )
    hold: float = setting(
        8.0, 'Longest time to fly by dead reckoning without light.', unit='s', low=0.0, high=600.0
    )
    certain: float = setting(
        0.8,
        'Largest standard deviation of the bearing with which dead reckoning is allowed.',
        unit='rad',
        low=0.05,
        high=3.2,
    )
    arrival: float = setting(
        0.8,
        'Horizontal distance to the lamp that counts as arrival.',
        unit='m',
        low=0.1,
        high=100.0,
    )
    approach: float = setting(
        0.5,
        'Ground speed per metre of remaining distance, near the lamp.',
        unit='1/s',
        low=0.05,
        high=5.0,
    )
    brake: bool = setting(
        False, 'Whether to brake ahead of the lamp and stay there, instead of flying past it.'
    )
    braking: float = setting(
        12.0,
        'With brake: time to the lamp at the present speed below which the drone slows down. A '
        'turn about takes half of it.',
        unit='s',
        low=1.0,
        high=60.0,
    )
    shade: float = setting(
        0.8,
        'With brake: smallest ratio of measured to expected brightness near the lamp; below it '
        'the hull hides a part of it.',
        unit='1',
        low=0.0,
        high=1.0,
    )


class HomingState(NamedTuple):
    """State of homing."""

    heading: float  # last commanded [rad]
    has_fix: bool  # whether there is a fix
    fix: LampFix
    begun: bool  # whether `place` is known
    place: tuple[float, float]  # dead reckoned, at the last sight [m]
    flight_time: float  # since the first sight [s]
    lost: float  # time without accepted light [s]
    doubted: float  # time with a strong light elsewhere [s]
    searched: float  # time of search [s]
    arrived: bool


def start(heading: float) -> HomingState:
    """Return the memory before the first sight."""
    none = (0.0, 0.0, 0.0, 0.0, 0.0)
    fix = LampFix(0.0, 0.0, 0.0, 0.0, 0.0, (none, none, none, none, none))
    return HomingState(heading, False, fix, False, (0.0, 0.0), 0.0, 0.0, 0.0, 0.0, False)


def reset_for_next_lamp(memory: HomingState) -> HomingState:
    """Return the memory for the way to another lamp; the wind estimate is kept."""
    return HomingState(
        memory.heading, False, memory.fix, memory.begun, memory.place, memory.flight_time,
        0.0, 0.0, 0.0, False,
    )  # fmt: skip


def watch(
    settings: 'StrategySettings', memory: HomingState, sight: LightMeasurement
) -> HomingState:
    """Return the memory after a sight during the climb, so that the wind estimate starts early."""
    return update_with_sight(settings, memory, sight)


def steer(
    settings: 'StrategySettings', memory: HomingState, sight: LightMeasurement
) -> tuple[SteeringCommand, HomingState]:
    """Return the course through the air along the line to the lamp."""
    own = settings.homing
    memory = update_with_sight(settings, memory, sight)
    # Close to the lamp its bearing means little, its place is known all the same
    close = brakes(settings, 2.0 * distance_to_lamp(memory))
    unsure = memory.searched > 0.0 or (not close and bearing_deviation(memory.fix) > own.certain)
    lost = memory.lost > own.hold or (memory.lost > 0.0 and unsure)
    if not memory.has_fix or lost:
        heading, speed = steer_search(settings, memory, sight.interval)
        after = _update_search(memory, heading, memory.searched + sight.interval)
        return SteeringCommand(heading, speed, False), after
    if brakes(settings, distance_to_lamp(memory)):
        heading, speed = brake_at_lamp(settings, memory, sight)
    else:
        heading, speed = steer_to_lamp(settings, memory)
    after = _update_search(memory, heading, 0.0)
    return SteeringCommand(heading, speed, after.arrived), after


def _update_search(m: HomingState, heading: float, searched: float) -> HomingState:
    """Return the memory with the commanded heading and the search time."""
    arrived = m.arrived and searched <= 0.0
    return HomingState(
        heading, m.has_fix, m.fix, m.begun, m.place, m.flight_time, m.lost, m.doubted, searched,
        arrived,
    )  # fmt: skip


def build_filter_prior(own: HomingSettings, flight_time: float) -> LampFilterPrior:
    """Return the filter's prior some time after the first sight. [s]"""
    gusts = math.hypot(own.gusts, own.unsettled * math.exp(-flight_time / own.settling))
    return LampFilterPrior(
        math.log(own.brightness),
        own.unsure,
        own.bearing_noise,
        own.strength_noise,
        own.wind,
        gusts,
    )


def update_with_sight(
    settings: 'StrategySettings', m: HomingState, sight: LightMeasurement
) -> HomingState:
    """Return the memory after one more sight; an outlier is ignored."""
    own, dt = settings.homing, sight.interval
    optics = build_filter_prior(own, m.flight_time)
    fix, has_fix, lost, doubted = m.fix, m.has_fix, m.lost + dt, m.doubted
    if m.has_fix:
        # Movement through the air since the last sight, by dead reckoning
        moved_x, moved_y = sight.position[0] - m.place[0], sight.position[1] - m.place[1]
        fix = predict_fix(optics, fix, moved_x, moved_y, dt)
    if sight.seen and sight.deviation <= own.trusted:
        bearing, strength = sight.heading + sight.bearing, max(sight.strength, 1.0)
        there = (
            has_fix and normalized_innovation(fix, optics, bearing, sight.deviation) <= own.gate
        )
        share = strength / expected_strength(fix) if has_fix else 1.0
        shaded = brakes(settings, math.hypot(fix.x, fix.y)) and share < own.shade
        fits = there and own.echo <= share <= 1.0 / own.echo and not (has_fix and shaded)
        # A weak light elsewhere is a reflection and raises no doubt
        doubted = 0.0 if fits or share < own.echo or shaded else doubted + dt
        # After a full turn without success any light is better than the old fix.
        sought = m.searched > full_turn_time(settings)
        if not has_fix or doubted > own.doubt or (sought and not fits):
            drift = fix.wind_x, fix.wind_y
            fix, has_fix = initialize_fix(optics, bearing, sight.deviation, strength, drift), True
            lost = doubted = 0.0
        elif fits:
            fix, lost = update_fix(fix, optics, bearing, sight.deviation, strength), 0.0
    away = math.hypot(fix.x, fix.y)
    limit = own.arrival * (STAY if m.arrived else 1.0)
    arrived = has_fix and away <= limit
    return HomingState(
        m.heading, has_fix, fix, True, sight.position, m.flight_time + dt, lost, doubted,
        m.searched, arrived,
    )  # fmt: skip


def steer_to_lamp(settings: 'StrategySettings', m: HomingState) -> tuple[float, float]:
    """Return heading [rad] and airspeed [m/s] along the line to the lamp, or to hold there."""
    own, fix = settings.homing, m.fix
    away = max(math.hypot(fix.x, fix.y), 1e-6)
    # Stop at half the arrival range
    over_ground = min(settings.speed, max(own.approach * (away - 0.5 * own.arrival), 0.0))
    top = max(own.top_speed, settings.speed)
    near = own.approach * away < settings.speed
    return solve_wind_triangle(
        # Avoid (0, 0), which has no direction
        (fix.x + 1e-9, fix.y),
        (fix.wind_x, fix.wind_y),
        over_ground,
        top,
        -top if near else LEAST_PUSH,
    )


def brakes(settings: 'StrategySettings', away: float) -> bool:
    """Return whether the drone brakes at a distance from the lamp. [m]"""
    own = settings.homing
    return own.brake and away < own.braking * settings.speed


def brake_at_lamp(
    settings: 'StrategySettings', m: HomingState, sight: LightMeasurement
) -> tuple[float, float]:
    """Return heading [rad] and airspeed [m/s] that slow the drone down and hold it at the lamp."""
    own, fix = settings.homing, m.fix
    cos, sin = math.cos(sight.heading), math.sin(sight.heading)
    surge, sway = sight.drift
    air_x, air_y = cos * surge - sin * sway, sin * surge + cos * sway
    # Velocity through the air that is wanted, and its error
    want_x, want_y = fix.x / own.braking - fix.wind_x, fix.y / own.braking - fix.wind_y
    off_x, off_y = want_x - air_x, want_y - air_y
    if math.hypot(off_x, off_y) > BAND:
        along_x, along_y = want_x + off_x, want_y + off_y
    else:
        along_x, along_y = want_x, want_y
    size = math.hypot(along_x, along_y)
    if size < 0.5 * STEERAGE:
        return sight.heading, 0.0
    heading = math.atan2(along_y, along_x)
    turn = wrap_angle(heading - sight.heading)
    if abs(turn) > AHEAD:
        last = wrap_angle(m.heading - sight.heading)
        sense = last if abs(last) > 0.25 * AHEAD else turn
        heading = sight.heading + math.copysign(AHEAD, sense)
    return heading, max(0.0, (want_x * along_x + want_y * along_y) / size)


def full_turn_time(settings: 'StrategySettings') -> float:
    """Return the duration of a turn on the spot. [s]"""
    return 2.0 * math.pi / max(settings.search_rate, 1e-3)


def steer_search(
    settings: 'StrategySettings', m: HomingState, interval: float
) -> tuple[float, float]:
    """Return heading [rad] and airspeed [m/s] of a search: a turn, then widening circles."""
    turn = full_turn_time(settings)
    if m.searched < turn:
        return m.heading + settings.search_rate * interval, 0.0
    # The turn rate falls with time, so the circles widen
    return m.heading + settings.search_rate * interval * turn / m.searched, settings.speed


def distance_to_lamp(memory: HomingState) -> float:
    """Return the horizontal distance to the lamp; NaN before the first light. [m]"""
    return math.hypot(memory.fix.x, memory.fix.y) if memory.has_fix else math.nan


STRATEGY = NavigationStrategy(
    'homing', start, steer, watch, reset_for_next_lamp, ranges=True, distance=distance_to_lamp
)
