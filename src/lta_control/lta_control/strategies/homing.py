# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
r"""
Homing, LTA's own strategy: fly along the line to the lamp in any wind.

`lamp_ekf` fuses bearings and strengths with dead reckoning into the lamp's position and the
drone's drift. The course through the air follows from the wind triangle (`solve_wind_triangle`): a
drone in a cross wind stays on the line instead of a curve of pursuit, and in a head wind it flies
faster. Inside `arrival` the drone has arrived. Without `brake` the ground speed falls near the
lamp with the range by `approach` per second, and the drone holds its position against the wind at
half that range, because the range may be underestimated.

Outliers are ignored: an uncertain bearing, one far from the filter's, and one much weaker than
the lamp would be, such as a reflection of a hidden lamp. Without accepted light the filter
continues by dead reckoning for `hold`; then the drone searches, with a turn on the spot and then
widening circles. A light elsewhere that is as strong as the lamp, or much stronger, is accepted
as the lamp after `doubt`: the filter was wrong. So is any light after a search of a full turn.

The drone's own hull hides a lamp that is near and higher than the diodes. The drone then
continues by dead reckoning and wind correction: it flies the last metre without light.

With `brake`, the drone stops at the lamp, instead of passing it. Drag is too weak for that, except
against a wind, and the rotors of a blimp push forward only: it turns against its motion over
ground, coasts meanwhile, and then pushes. It begins where the distance left is that of the turn
and of the planned deceleration (`stopping_speed`), and pushes only where it is faster than it may
be there. Stopped, it flies on to the lamp if it is not there yet, slowly enough to stop again. At
the lamp it rests as long as the wind is not known to differ from none: every turn pushes, too.
Near the lamp, light that grows fainter is that of a lamp that the hull hides, and is ignored; the
drone stays by dead reckoning.
"""

import math
from typing import NamedTuple

from lta_control.motion import wrap_angle
from lta_control.strategies.lamp_ekf import (
    bearing_deviation,
    expected_strength,
    initialize_fix,
    LAMP_HEIGHT,
    LampFilterPrior,
    LampFix,
    normalized_innovation,
    predict_fix,
    update_fix,
)
from lta_control.strategies.protocol import LightMeasurement, NavigationStrategy, SteeringCommand
from lta_control.strategies.settings import HomingSettings, StrategySettings

# m/s; least forward airspeed on the way, even where the wind alone would suffice
LEAST_AIRSPEED = 0.1
# rad; a farther heading is commanded step by step, so that the sense of a turn stays
LARGEST_TURN = 2.0
SPEED_BAND = 0.12  # m/s; a speed over ground that is not worth a turn about
CALM_WIND = 0.15  # m/s; a wind that the estimate hardly tells from none
STILL_SPEED = 0.1  # m/s; a speed over ground that the estimate hardly tells from 0
CLOSE_RANGE = 3.0  # m from the lamp, where the hull may hide a part of it
HIDDEN_TIME = 40.0  # s without light after which a close lamp is searched
GLANCE = 0.1  # rad; error of a bearing where the hull may hide a part of the lamp
ARRIVAL_HYSTERESIS = 2.0  # of the arrival range: hysteresis, so that wind does not undo an arrival
MOST_ACROSS = 0.95  # largest share of the airspeed used against a cross wind
STEERAGE = 0.1  # m/s; below this airspeed a heading is meaningless


class HomingState(NamedTuple):
    """State of homing."""

    heading: float  # last commanded [rad]
    has_fix: bool  # whether there is a fix
    fix: LampFix
    begun: bool  # whether `place` is known
    place: tuple[float, float]  # dead reckoned, at the last sight [m]
    flight_time: float  # since the first sight [s]
    lost: float  # time without accepted light [s]
    brightest: float  # strongest light of this lamp [counts]
    doubted: float  # time with a strong light elsewhere [s]
    searched: float  # time of search [s]
    arrived: bool
    braking: bool  # whether it turns about, or has, to stop


def start(heading: float) -> HomingState:
    """Return the memory before the first sight."""
    none = (0.0, 0.0, 0.0, 0.0, 0.0)
    fix = LampFix(0.0, 0.0, 0.0, 0.0, 0.0, (none, none, none, none, none))
    return HomingState(
        heading, False, fix, False, (0.0, 0.0), 0.0, 0.0, 0.0, 0.0, 0.0, False, False
    )


def reset_for_next_lamp(memory: HomingState) -> HomingState:
    """Return the memory for the way to another lamp; the wind estimate is kept."""
    return memory._replace(
        has_fix=False,
        lost=0.0,
        brightest=0.0,
        doubted=0.0,
        searched=0.0,
        arrived=False,
        braking=False,
    )


def watch(settings: StrategySettings, memory: HomingState, sight: LightMeasurement) -> HomingState:
    """Return the memory after a sight during the climb, so that the wind estimate starts early."""
    return update_with_sight(settings, memory, sight)


def steer(
    settings: StrategySettings, memory: HomingState, sight: LightMeasurement
) -> tuple[SteeringCommand, HomingState]:
    """Return the course through the air along the line to the lamp."""
    own = settings.homing
    memory = update_with_sight(settings, memory, sight)
    # Close to the lamp its bearing means little, its place is known all the same
    close = is_close(own, memory)
    unsure = memory.searched > 0.0 or (not close and bearing_deviation(memory.fix) > own.certain)
    hold = max(own.hold, HIDDEN_TIME) if close else own.hold
    lost = memory.lost > hold or (memory.lost > 0.0 and unsure)
    if not memory.has_fix or lost:
        heading, speed = steer_search(settings, memory, sight.interval)
        searched = memory.searched + sight.interval
        after = memory._replace(heading=heading, searched=searched, arrived=False, braking=False)
        return SteeringCommand(heading, speed, False), after
    braking = own.brake and must_brake(settings, memory, sight)
    if braking:
        heading, speed = brake_ahead(settings, memory, sight)
    else:
        heading, speed = steer_to_lamp(settings, memory, sight)
    after = memory._replace(heading=heading, searched=0.0, braking=braking)
    return SteeringCommand(heading, speed, after.arrived), after


def build_filter_prior(own: HomingSettings, flight_time: float) -> LampFilterPrior:
    """Return the filter's prior some time after the first sight [s]."""
    gusts = math.hypot(own.gusts, own.unsettled * math.exp(-flight_time / own.settling))
    return LampFilterPrior(
        math.log(own.brightness),
        own.unsure,
        own.bearing_noise,
        own.strength_noise,
        own.wind,
        gusts,
        # Where it matters: a drone that stops is near the lamp for long
        LAMP_HEIGHT if own.brake else 0.0,
    )


def update_with_sight(
    settings: StrategySettings, m: HomingState, sight: LightMeasurement
) -> HomingState:
    """Return the memory after one more sight; an outlier is ignored."""
    own, dt = settings.homing, sight.interval
    optics = build_filter_prior(own, m.flight_time)
    fix, has_fix, lost, doubted = m.fix, m.has_fix, m.lost + dt, m.doubted
    if m.has_fix:
        # Movement through the air since the last sight, by dead reckoning
        moved_x, moved_y = sight.position[0] - m.place[0], sight.position[1] - m.place[1]
        fix = predict_fix(optics, fix, moved_x, moved_y, dt)
    brightest, close = m.brightest, is_close(own, m)
    if sight.seen and sight.deviation <= own.trusted:
        bearing, strength = sight.heading + sight.bearing, max(sight.strength, 1.0)
        brightest = max(brightest, strength)
        deviation = math.hypot(sight.deviation, GLANCE if close else 0.0)
        there = has_fix and normalized_innovation(fix, optics, bearing, deviation) <= own.gate
        share = strength / expected_strength(fix) if has_fix else 1.0
        shaded = close and max(share, strength / brightest) < own.shade
        fits = there and own.echo <= share <= 1.0 / own.echo and not shaded
        # A weak light elsewhere is a reflection and raises no doubt
        doubted = 0.0 if fits or share < own.echo or shaded else doubted + dt
        # After a full turn without success any light is better than the old fix.
        sought = m.searched > full_turn_time(settings)
        if not has_fix or doubted > own.doubt or (sought and not fits):
            drift = fix.wind_x, fix.wind_y
            fix, has_fix = initialize_fix(optics, bearing, deviation, strength, drift), True
            lost = doubted = 0.0
        elif fits:
            fix, lost = update_fix(fix, optics, bearing, deviation, strength), 0.0
    away = math.hypot(fix.x, fix.y)
    limit = own.arrival * (ARRIVAL_HYSTERESIS if m.arrived else 1.0)
    arrived = has_fix and away <= limit
    return m._replace(
        has_fix=has_fix,
        fix=fix,
        begun=True,
        place=sight.position,
        flight_time=m.flight_time + dt,
        lost=lost,
        brightest=brightest,
        doubted=doubted,
        arrived=arrived,
    )


def steer_to_lamp(
    settings: StrategySettings, m: HomingState, sight: LightMeasurement
) -> tuple[float, float]:
    """Return heading [rad] and airspeed [m/s] along the line to the lamp, or to hold there."""
    own, fix = settings.homing, m.fix
    away, top = math.hypot(fix.x, fix.y), max(own.top_speed, settings.speed)
    # It stays able to turn about, or stops at half the arrival range
    planned = (
        stopping_speed(own, away, math.pi)
        if own.brake
        else max(own.approach * (away - 0.5 * own.arrival), 0.0)
    )
    near = (planned if own.brake else own.approach * away) < settings.speed
    heading, speed = solve_wind_triangle(
        # Avoid (0, 0), which has no direction
        (fix.x + 1e-9, fix.y),
        (fix.wind_x, fix.wind_y),
        min(settings.speed, planned),
        top,
        -top if near else LEAST_AIRSPEED,
    )
    if own.brake and m.arrived and math.hypot(fix.wind_x, fix.wind_y) < CALM_WIND:
        return sight.heading, 0.0
    return heading, speed


def is_close(own: HomingSettings, m: HomingState) -> bool:
    """Return whether the drone's hull may hide the lamp, which it does not fly past."""
    return own.brake and m.has_fix and math.hypot(m.fix.x, m.fix.y) < CLOSE_RANGE


def stopping_speed(own: HomingSettings, left: float, turn: float) -> float:
    """
    Return the speed over ground from which a drone can stop within a distance [m/s].

    It flies on at that speed v while it turns by `turn` [rad] in the time T, and then decelerates
    by a: the distance `left` [m] is v T + v^2 / 2 a.
    """
    time, rate = turn / own.turn_rate, own.deceleration
    return rate * (math.sqrt(time * time + 2.0 * left / rate) - time)


def coasting_distance(own: HomingSettings, closing: float, wind: float) -> float:
    """
    Return the distance over ground in which drag alone stops a drone [m].

    `closing` is its speed over ground, `wind` that of the air against it [m/s]. With the airspeed
    u and the distance L of `coasting`, u' = -u^2 / L.
    """
    if wind <= 0.0:
        return math.inf
    speed = closing + wind
    return own.coasting * (math.log(speed / wind) - closing / speed)


def ground_velocity(m: HomingState, sight: LightMeasurement) -> tuple[float, float]:
    """Return the drone's velocity over ground [m/s, odom]."""
    cos, sin = math.cos(sight.heading), math.sin(sight.heading)
    surge, sway = sight.drift
    return cos * surge - sin * sway + m.fix.wind_x, sin * surge + cos * sway + m.fix.wind_y


def must_brake(settings: StrategySettings, m: HomingState, sight: LightMeasurement) -> bool:
    """Return whether the drone turns against its motion, which then lasts until it has stopped."""
    own, fix = settings.homing, m.fix
    x, y = ground_velocity(m, sight)
    speed = math.hypot(x, y)
    if m.braking:
        return speed > STILL_SPEED
    away = max(math.hypot(fix.x, fix.y), 1e-6)
    closing = (fix.x * x + fix.y * y) / away
    wind = -(fix.x * fix.wind_x + fix.y * fix.wind_y) / away
    turn = abs(wrap_angle(math.atan2(-y, -x) - sight.heading))
    too_fast = closing > max(stopping_speed(own, away, turn), SPEED_BAND)
    return too_fast and coasting_distance(own, closing, wind) > away


def brake_ahead(
    settings: StrategySettings, m: HomingState, sight: LightMeasurement
) -> tuple[float, float]:
    """Return heading [rad] against the motion over ground, and airspeed along it [m/s]."""
    own, fix = settings.homing, m.fix
    x, y = ground_velocity(m, sight)
    away = max(math.hypot(fix.x, fix.y), 1e-6)
    closing = (fix.x * x + fix.y * y) / away
    heading = math.atan2(-y, -x)
    # Once turned, it decelerates as planned
    plan = stopping_speed(own, away, 0.0) if closing > 0.0 else 0.0
    want_x, want_y = plan * fix.x / away - fix.wind_x, plan * fix.y / away - fix.wind_y
    top = max(own.top_speed, settings.speed)
    speed = want_x * math.cos(heading) + want_y * math.sin(heading)
    speed = min(max(speed, -top), top)
    return limit_turn(heading, sight.heading, m.heading, LARGEST_TURN), speed


def limit_turn(goal: float, heading: float, last: float, most: float) -> float:
    """
    Return a heading at most so far from the present one that the sense of a turn stays [rad].

    `last`: heading that was commanded before.
    """
    turn, before = wrap_angle(goal - heading), wrap_angle(last - heading)
    if abs(turn) <= most:
        return goal
    return heading + math.copysign(most, before if abs(before) > 0.25 * most else turn)


def full_turn_time(settings: StrategySettings) -> float:
    """Return the duration of a turn on the spot [s]."""
    return 2.0 * math.pi / max(settings.search_rate, 1e-3)


def steer_search(
    settings: StrategySettings, m: HomingState, interval: float
) -> tuple[float, float]:
    """Return heading [rad] and airspeed [m/s] of a search: a turn, then widening circles."""
    turn = full_turn_time(settings)
    if m.searched < turn:
        return m.heading + settings.search_rate * interval, 0.0
    # The turn rate falls with time, so the circles widen
    return m.heading + settings.search_rate * interval * turn / m.searched, settings.speed


def distance_to_lamp(memory: HomingState) -> float:
    """Return the horizontal distance to the lamp; NaN before the first light [m]."""
    return math.hypot(memory.fix.x, memory.fix.y) if memory.has_fix else math.nan


def solve_wind_triangle(
    line: tuple[float, float],
    wind: tuple[float, float],
    over_ground: float,
    top_speed: float,
    least: float,
) -> tuple[float, float]:
    """
    Return heading [rad] and airspeed [m/s] of the course that follows a line over the ground.

    With the wind w along and across the line, wanted ground speed g and highest airspeed V,

        a_across = -w_across,   a_along = min(g - w_along, sqrt(V^2 - a_across^2))

    Where the cross wind exceeds V, the drone turns into it as far as some speed along the line
    remains.

    Parameters
    ----------
    line : tuple of float
        Direction to fly, of any length above 0.
    wind : tuple of float
        Velocity of the air, in the same axes. [m/s]
    over_ground : float
        Wanted speed along the line. [m/s]
    top_speed : float
        Highest airspeed. [m/s]
    least : float
        Least airspeed along the line; negative where the drone may turn around to brake. [m/s]

    """
    away = math.hypot(line[0], line[1])
    cos, sin = line[0] / away, line[1] / away
    along, across = cos * wind[0] + sin * wind[1], cos * wind[1] - sin * wind[0]
    # Cancel the cross wind first; the rest of the airspeed goes along the line.
    left = min(max(-across, -MOST_ACROSS * top_speed), MOST_ACROSS * top_speed)
    # `MOST_ACROSS` below 1 keeps this above zero
    most = math.sqrt(top_speed * top_speed - left * left)
    forward = min(max(over_ground - along, least), most)
    speed = math.hypot(forward, left)
    towards = math.atan2(line[1], line[0])
    if speed < STEERAGE:
        return towards, 0.0
    return towards + math.atan2(left, forward), speed


HOMING_STRATEGY = NavigationStrategy(
    'homing', start, steer, watch, reset_for_next_lamp, ranges=True, distance=distance_to_lamp
)
