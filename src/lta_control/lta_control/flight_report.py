# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Say in words what a flight does and why, as the nodes report it on /diagnostics."""

from collections.abc import Sequence
import math

from lta_control.bias_calibration import is_tilted, is_turning, largest_deviation, MOST_RATE
from lta_control.commanded_flight import CommandedFlight
from lta_control.estimator import EstimatorModel, MotionEstimate
from lta_control.flight_step import ControlInputs, FlightRules, FlightState, is_stopped
from lta_control.guidance import Guidance
from lta_control.mission import FlightPermission, Mission, Phase
from lta_graph.health import HealthFact, HealthLevel

REST_REASONS = {
    FlightState.OFF: 'off',
    FlightState.WAITING: 'armed; waits for a setpoint above the floor',
    FlightState.ON_GROUND: 'on the ground',
    FlightState.LANDED: 'on the ground, as it no longer sinks',
}
STOP_REASONS = {
    FlightState.OVERTURNED: 'the drone turned over',
    FlightState.BLIND: 'the height is unknown, as its sensors repeat their readings or send none',
    FlightState.NOT_FINITE: 'the estimate or the setpoint contains NaN or infinity',
    FlightState.EMERGENCY_STOP: 'emergency stop',
}


def describe_calibration(estimate: MotionEstimate, body: EstimatorModel) -> HealthFact:
    """Return the state of the bias calibration."""
    if not estimate.ready and is_turning(estimate.biases, body.rate_bias):
        off = math.degrees(largest_deviation(estimate.biases.rates, body.rate_bias))
        return HealthFact(
            'estimate',
            HealthLevel.ERROR,
            f'cannot calibrate the gyroscope bias: the drone turns at {off:.1f} deg/s, '
            f'more than the largest possible bias of {math.degrees(MOST_RATE):.0f} deg/s; '
            'keep the drone still, or if it is still, enter its bias in the vehicle file '
            '(effects.gyro_bias)',
        )
    level, text = HealthLevel.OK, 'biases are known'
    if not estimate.ready:
        level = HealthLevel.WARN
        text = 'calibrating the IMU biases: keep the drone still and level'
    elif is_tilted(estimate.biases, body.force_bias):
        level = HealthLevel.WARN
        text = (
            'the IMU biases are uncertain, because the drone was tilted during the '
            'calibration; restart the estimator with the drone still and level'
        )
    return HealthFact('estimate', level, text)


def describe_stop(state: int) -> str:
    """Return why the motors have stopped for good, and what to do; '' if they have not."""
    if not is_stopped(state):
        return ''
    why = STOP_REASONS[FlightState(state)]
    return f'{why}: the motors are off; restart the controller to fly again'


def describe_motors(
    state: int, inputs: ControlInputs, rules: FlightRules, steers: str
) -> HealthFact:
    """Return what the motors do and why; `steers` says whose setpoints the drone follows."""
    now, level = FlightState(state), HealthLevel.OK
    if is_stopped(state):
        level, text = HealthLevel.ERROR, describe_stop(state)
    elif now in REST_REASONS:
        text = REST_REASONS[now]
    elif now is FlightState.FLYING:
        text = f'flying by {steers}'
    else:
        level, text = HealthLevel.WARN, _describe_descent(now, inputs.age, rules)
    return HealthFact('motors', level, text)


def _describe_descent(state: FlightState, age: float, rules: FlightRules) -> str:
    holds = state is FlightState.HOLDING
    doing, limit = ('holding', rules.hold_after) if holds else ('landing', rules.land_after)
    if age <= limit:
        return doing
    if math.isinf(age):
        return f'the time stamp of the setpoint is in the future: {doing}'
    return f'no setpoint for {limit} s: {doing}'


def describe_airspeed(is_lost: bool) -> HealthFact:
    """Return whether the airspeed that the drone had is missing."""
    if is_lost:
        return HealthFact('airspeed', HealthLevel.ERROR, 'missing: landing')
    return HealthFact('airspeed', HealthLevel.OK, 'received again')


def describe_tracking(is_tracked: bool) -> HealthFact:
    """Return whether the tracker is lost that the drone had."""
    if is_tracked:
        return HealthFact('tracker', HealthLevel.OK, 'the drone holds places')
    return HealthFact('tracker', HealthLevel.ERROR, 'lost: holding height and heading only')


def describe_commanders(is_contested: bool) -> HealthFact:
    """Return whether several nodes have sent setpoints since arming."""
    if is_contested:
        text = 'several nodes sent setpoints: landing; stop all but one, and arm again'
        return HealthFact('commanders', HealthLevel.ERROR, text)
    return HealthFact('commanders', HealthLevel.OK, 'one node sends setpoints')


def describe_guidance(guidance: Guidance | CommandedFlight, why: str) -> HealthFact:
    """Return what the drone does, and `why` the energy restricts it."""
    mission, permission = guidance.mission, guidance.permission
    if isinstance(guidance, Guidance):
        if guidance.route and permission is FlightPermission.FLY:
            return describe_leg(mission, guidance.route)
        if guidance.course is not None:
            return describe_mission(None, permission, why)
    return describe_mission(mission, permission, why)


def describe_mission(
    mission: Mission | None, permission: FlightPermission, why: str
) -> HealthFact:
    """
    Return what the drone does, and why the energy restricts it.

    `mission` is None on a course; `why` explains the `permission`.
    """
    doing = 'course' if mission is None else str(mission.phase)
    if permission is FlightPermission.FLY:
        return HealthFact('mission', HealthLevel.OK, doing)
    resting = mission is not None and mission.phase is Phase.REST
    text = f'no take-off: {why}' if resting else f'{doing}: {why}'
    down = permission is FlightPermission.DOWN
    return HealthFact('mission', HealthLevel.ERROR if down else HealthLevel.WARN, text)


def describe_leg(mission: Mission, route: Sequence[tuple[str, float]]) -> HealthFact:
    """Return what the drone does, and at which lamp; the route has names and beacons [Hz]."""
    (here, _), (next_lamp, frequency) = route[mission.leg], route[mission.target]
    level, text = HealthLevel.OK, f'{mission.phase}: {here}'
    if mission.refused:
        following, beat = route[mission.leg + 1]
        level = HealthLevel.WARN
        text = f'cannot receive {following} at {beat:g} Hz; staying at {here}'
    values = {'lamp': here, 'listening_for': f'{next_lamp} at {frequency:g} Hz'}
    return HealthFact('mission', level, text, values)
