# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
State machine of teleoperation: it decides whether the operator or the navigator steers.

A deflected stick takes control at once. Only the button returns it, with all sticks at rest. If
the device fails or the estimate is lost, the operator keeps control but no setpoints are sent:
they become stale, and the drone holds, then lands. After a restart, the state is taken from the
nodes that follow the setpoints. An emergency stop is final, and repeated because it is not
confirmed.
"""

from collections.abc import Collection
from enum import StrEnum
import math
from typing import Final, NamedTuple

from lta_bridge.teleop.sticks import Sticks
from lta_config.errors import BadInput
from lta_config.settings import setting, Settings
from lta_control.motion import Setpoint, wrap_angle
from lta_graph.health import HealthFact, HealthLevel

STOP_REQUESTS: Final = 10  # emergency stops sent in direct succession
NEXT_STEP_PAUSE: Final = 0.5  # s between further ones
LEAD_TURN: Final = 1.0  # rad, largest lead of the desired heading
LEAD_CLIMB: Final = 0.5  # m, largest lead of the desired altitude


def check_time_mode(*, lockstep: bool) -> None:
    """Raise `BadInput` in lockstep, where no person can keep up."""
    if lockstep:
        raise BadInput('Teleoperation works only in real time; remove time:=lockstep.')


class TeleopRates(Settings):
    """Rates at full deflection of the sticks."""

    speed: float = setting(0.3, 'm/s', 0.01, 2.0)
    """Commanded airspeed at full forward stick."""
    turn: float = setting(0.6, 'rad/s', 0.01, 3.0)
    """Turn rate of the commanded heading at full stick."""
    climb: float = setting(0.2, 'm/s', 0.01, 1.0)
    """Climb rate of the commanded altitude at full stick."""


class TeleopStage(StrEnum):
    """Who steers."""

    UNKNOWN = 'nobody known'  # no node has reported whose setpoints it follows
    NAVIGATOR = 'navigator'
    PERSON = 'person'
    STOPPED = 'stopped'  # by an emergency stop; for good


class HeadingAltitude(NamedTuple):
    """Estimated heading [rad] and altitude [m]."""

    heading: float
    altitude: float


class TeleopState(NamedTuple):
    """Memory of the state machine."""

    stage: TeleopStage = TeleopStage.UNKNOWN
    own: bool = False
    target: HeadingAltitude | None = None
    stops: int = 0
    stopped_at: float = -math.inf


class TeleopOutputs(NamedTuple):
    """Outputs to publish at a tick."""

    held: bool | None = None  # whether the operator has control; None to publish nothing
    setpoint: Setpoint | None = None  # the operator's setpoint
    stop: bool = False  # whether to send an emergency stop


NO_TELEOP: Final = TeleopOutputs()


def step_state(
    state: TeleopState,
    now: float,
    dt: float,
    sticks: Sticks | None,
    estimate: HeadingAltitude | None,
    rates: TeleopRates,
    person_steers: bool | None = None,
) -> tuple[TeleopState, TeleopOutputs]:
    """
    Return the next state and the outputs to publish.

    Parameters
    ----------
    now, dt : float
        Monotonic time, and time since the last tick. [s]
    sticks : Sticks or None
        Present deflections; None if the device has failed.
    felt : HeadingAltitude or None
        Newest estimate; None if there is no fresh one.
    rates : TeleopRates
        Rates at full deflection.
    told : bool or None
        Whether the following nodes report the operator's setpoints; None if none has reported.

    """
    if state.stage is TeleopStage.STOPPED or (sticks is not None and sticks.stop):
        return _step_stopped(state, now)
    # What the controllers report counts until this node changes it itself
    if person_steers is not None and not state.own:
        state = state._replace(
            stage=TeleopStage.PERSON if person_steers else TeleopStage.NAVIGATOR
        )
    if sticks is None or estimate is None:
        # After the loss, steering resumes at the drone's then present heading and altitude.
        return state._replace(target=None), NO_TELEOP
    # Moving a stick takes control at once: an operator in a hurry looks for no button
    takes = sticks.is_deflected or sticks.take
    if sticks.give_back and not takes:
        return TeleopState(TeleopStage.NAVIGATOR, own=True), TeleopOutputs(held=False)
    if state.stage is not TeleopStage.PERSON and not takes:
        return state, NO_TELEOP
    target = _lead_target(state.target or estimate, estimate, sticks, rates, dt)
    setpoint = Setpoint(target.altitude, target.heading, rates.speed * sticks.forward)
    return TeleopState(TeleopStage.PERSON, True, target), TeleopOutputs(True, setpoint)


def _step_stopped(state: TeleopState, now: float) -> tuple[TeleopState, TeleopOutputs]:
    # Repeat for good, since a stop may be lost
    if state.stops >= STOP_REQUESTS and now - state.stopped_at < NEXT_STEP_PAUSE:
        return state, NO_TELEOP
    return TeleopState(TeleopStage.STOPPED, stops=state.stops + 1, stopped_at=now), TeleopOutputs(
        stop=True
    )


def _lead_target(
    target: HeadingAltitude,
    estimate: HeadingAltitude,
    sticks: Sticks,
    rates: TeleopRates,
    dt: float,
) -> HeadingAltitude:
    """Integrate the sticks to a desired heading and altitude, with a limited lead."""
    # Without the limit, a blocked vehicle would turn on long after the stick is released
    ahead = wrap_angle(target.heading + rates.turn * sticks.turn * dt - estimate.heading)
    above = target.altitude + rates.climb * sticks.climb * dt - estimate.altitude
    heading = wrap_angle(estimate.heading + max(-LEAD_TURN, min(LEAD_TURN, ahead)))
    return HeadingAltitude(heading, estimate.altitude + max(-LEAD_CLIMB, min(LEAD_CLIMB, above)))


def describe_steering(
    stage: TeleopStage, alive: bool, placed: bool, answered: Collection[str]
) -> HealthFact:
    """
    Return who steers, and what is missing.

    Parameters
    ----------
    stage : TeleopStage
        Who steers.
    alive, placed : bool
        Whether the sticks can be read, and whether the estimate is known.
    answered : collection of str
        Services that have confirmed an emergency stop.

    """
    steers = stage is TeleopStage.PERSON
    if stage is TeleopStage.STOPPED:
        receivers = ', '.join(sorted(answered)) or 'no node yet'
        level, text = HealthLevel.ERROR, f'emergency stop requested; confirmed by {receivers}'
    elif not alive or not placed:
        level = HealthLevel.ERROR if steers else HealthLevel.WARN
        text = 'no state estimate received'
        if not alive:
            text = 'no input from the gamepad or keyboard'
        if steers:
            text += ': the drone hovers, then lands'
    elif stage is TeleopStage.UNKNOWN:
        level = HealthLevel.WARN
        text = 'no controller has reported whether it follows the operator or the navigator'
    else:
        level, text = HealthLevel.OK, f'the {"operator" if steers else "navigator"} steers'
    return HealthFact('helm', level, text)
