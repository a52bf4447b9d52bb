# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Safety state machine of the Crazyflie bridge: it decides when the motors may turn.

`step_state` is called at a constant rate and returns the outputs to send. Motors turn only in
FLYING and during the first `RAMP` seconds of LANDING. Every fault in flight leads to the same
sequence: ramp down, hand over to the firmware, disarm. The bridge never just stops sending: the
firmware locks itself after 2 s without setpoints.
"""

from enum import StrEnum
import math
from typing import Final, NamedTuple

from lta_bridge.crazyflie.supervisor_word import explain_fault, SupervisorBit

STALE: Final = 0.3  # s; an older command is not flown; the firmware levels out at 0.5
SILENT_LINK: Final = 0.5  # s; if the newest log packet is older, the link counts as lost
LOST_POSITION: Final = 0.5  # s; an older position estimate counts as unknown
# s that a low voltage must last: a single sample (10 Hz) may be wrong
LOW_VOLTAGE_TIME: Final = 0.3
GROUNDED: Final = 10.0  # s to land without sinking while motors turn; the controller needs 6
RAMP: Final = 0.5  # s from full command to none
ASKING: Final = 1.0  # s for the supervisor to confirm that it is armed
REQUEST_PERIOD: Final = 0.1  # s between two unconfirmed requests
HANDING: Final = 0.3  # s during which the hand-over is repeated: it is not confirmed
LANDING_TIME: Final = 10.0  # s for the firmware to land after the hand-over
LEAVE: Final = 15.0  # s at most to land and to confirm disarming before the link is closed
STOPS: Final = 10  # emergency stops sent in a row: they are not confirmed
# Why a person ends a flight, which is no fault
ON_REQUEST, DEACTIVATED = DELIBERATE = ('on request', 'deactivated')


class SafetyStage(StrEnum):
    """States of the state machine."""

    DISARMED = 'disarmed'
    ARMING = 'arming'
    READY = 'ready'  # armed, and no fresh command yet
    FLYING = 'flying'
    LANDING = 'landing'
    STOPPED = 'stopped'  # by an emergency stop; for good


class SafetyLimits(NamedTuple):
    """Limits of a flight: cell voltage [V], time [s], height [m], distance from the start [m]."""

    voltage: float
    time: float
    height: float
    distance: float


class SafetyInputs(NamedTuple):
    """Inputs at a tick."""

    linked: bool = False  # whether a Crazyflie is connected and its parameters are as expected
    active: bool = False  # whether the node is active
    word: int = 0  # the supervisor's newest status word
    silence: float = math.inf  # age of the newest packet with that word [s]
    command_age: float = math.inf  # age of the newest usable command; infinite without one [s]
    voltage: float = math.nan  # cell voltage; NaN if unknown [V]
    # Above and from the start; NaN if unknown [m]
    height: float = math.nan
    distance: float = math.nan
    place_age: float = math.inf  # age of these two; infinite if there never was an estimate [s]
    # Whether the operator allows a flight without any position estimate. An estimate that has
    # begun must still continue.
    blind: bool = False
    grounded: float = 0.0  # for how long motors have turned to land without the drone sinking [s]
    # Who else publishes commands to fly than the nodes of the flight, in words; empty if nobody
    rivals: str = ''


class SafetyRequest(NamedTuple):
    """Requests of the operator since the last tick: arm or disarm, emergency stop."""

    arm: bool | None = None
    stop: bool = False


class SafetyState(NamedTuple):
    """Memory of the state machine."""

    stage: SafetyStage = SafetyStage.DISARMED
    # Start of the stage and of the flight [s]
    since: float = 0.0
    began: float = 0.0
    why: str = 'not armed yet'  # reason for the stage
    stops: int = 0  # emergency stops that are still to be sent
    asked_at: float = -math.inf  # when the newest unconfirmed request was sent [s]
    curable: bool = False  # whether a fresh command ends this landing
    # Since when the cell voltage has been low or unknown; infinite if it is fine [s]
    low_since: float = math.inf


class SafetyOutputs(NamedTuple):
    """Outputs to send at a tick."""

    arm: bool | None = None  # request to arm or disarm
    drive: float = 0.0  # fraction of the newest usable command to fly, 0 to 1
    stream: bool = False  # whether to send a command at all
    hand_over: bool = False  # whether to announce that no more setpoints follow, and to land
    stop: bool = False  # whether to send an emergency stop


NO_OUTPUTS: Final = SafetyOutputs()


def find_arming_refusal(state: SafetyState, inputs: SafetyInputs, limits: SafetyLimits) -> str:
    """Return why a request to arm is refused; empty if it is accepted."""
    if state.stage is SafetyStage.STOPPED:
        return (
            'an emergency stop has locked the motors: switch the Crazyflie off and on, and '
            'restart the bridge'
        )
    if not inputs.linked:
        return 'no Crazyflie is connected'
    if not inputs.active:
        return 'the bridge node is not active: activate it first'
    if math.isinf(inputs.silence):
        return 'the Crazyflie has not reported its state yet: try again'
    if inputs.silence > SILENT_LINK:
        return f'the Crazyflie has sent nothing for {inputs.silence:.1f} s: bring it closer'
    if math.isnan(inputs.voltage):
        return 'the Crazyflie has not reported its battery voltage yet: try again'
    if inputs.voltage < limits.voltage:
        return (
            f'the battery has {inputs.voltage:.2f} V, less than the limit of '
            f'{limits.voltage:.2f} V: charge it'
        )
    if inputs.rivals:
        return f'{inputs.rivals}: stop them, or allow them with allow_other_commanders:=true'
    if find_missing_position(inputs):
        return (
            'the position of the drone is not known, so no limit of height and distance could be '
            'kept: start the estimator or a tracker, or allow it with blind:=true'
        )
    return explain_fault(inputs.word)


def find_landing_reason(
    state: SafetyState, now: float, inputs: SafetyInputs, limits: SafetyLimits
) -> str:
    """Return why a flight must end at a time [s] despite fresh commands; empty to continue."""
    if not inputs.active:
        return DEACTIVATED
    if inputs.silence > SILENT_LINK:
        return f'the Crazyflie has sent nothing for {inputs.silence:.1f} s'
    # low_since is infinite while the voltage is fine, so this is then false
    if now - state.low_since >= LOW_VOLTAGE_TIME:
        is_measured = not math.isnan(inputs.voltage)
        return (
            f'the battery has only {inputs.voltage:.2f} V'
            if is_measured
            else 'the battery voltage is no longer reported'
        )
    if now - state.began > limits.time:
        return f'the flight has reached its time limit of {limits.time:.0f} s'
    if inputs.rivals:
        return inputs.rivals
    if inputs.grounded > GROUNDED:
        return f'to land, it has not sunk for {GROUNDED:.0f} s: it stands on the ground'
    if inputs.height > limits.height:
        return f'the drone is higher than its limit of {limits.height:.1f} m'
    if inputs.distance > limits.distance:
        return f'the drone is farther away than its limit of {limits.distance:.1f} m'
    return ''


def find_missing_position(inputs: SafetyInputs) -> bool:
    """Return whether height or distance from the start are unknown, and must be known."""
    if inputs.blind and math.isinf(inputs.place_age):
        return False
    # NaN compares false, so an unknown height or distance would never exceed its limit
    return math.isinf(inputs.place_age) or math.isnan(inputs.height) or math.isnan(inputs.distance)


def find_stale_input(inputs: SafetyInputs) -> str:
    """Return which input is too old to fly by; empty if none is."""
    if inputs.command_age > STALE:
        return f'the newest command is {inputs.command_age:.2f} s old'
    if find_missing_position(inputs):
        return 'the position of the drone is not known'
    if LOST_POSITION < inputs.place_age < math.inf:
        return f'the newest position estimate is {inputs.place_age:.2f} s old'
    return ''


def step_state(
    state: SafetyState,
    now: float,
    inputs: SafetyInputs,
    request: SafetyRequest,
    limits: SafetyLimits,
) -> tuple[SafetyState, SafetyOutputs]:
    """Return the next state and the outputs to send; `now` is a monotonic time [s]."""
    low = not inputs.voltage >= limits.voltage  # true for NaN too: an unknown voltage is low
    state = state._replace(low_since=min(state.low_since, now) if low else math.inf)
    # The emergency stop comes first: it must work in every stage, and even without a link
    if request.stop:
        state = SafetyState(SafetyStage.STOPPED, now, state.began, 'emergency stop', STOPS)
    if state.stage is SafetyStage.STOPPED:
        # A stop is not confirmed: a drone that still reports to be armed has not received one.
        missed = inputs.linked and bool(inputs.word & SupervisorBit.ARMED)
        stop = state.stops > 0 or missed
        return state._replace(stops=max(0, state.stops - 1)), SafetyOutputs(stop=stop)
    if not inputs.linked:
        return _enter_disarmed(state, now, 'no link'), NO_OUTPUTS
    # A fault that the firmware reports ends the flight on the drone itself: nothing to send
    if explain_fault(inputs.word):
        return _enter_disarmed(state, now, explain_fault(inputs.word)), NO_OUTPUTS
    return STAGE_STEPS[state.stage](state, now, inputs, request, limits)


def _enter_disarmed(state: SafetyState, now: float, why: str) -> SafetyState:
    """Return the disarmed state; `since` stays if it was disarmed already."""
    if state.stage is SafetyStage.DISARMED:
        return state._replace(why=why)
    return SafetyState(SafetyStage.DISARMED, now, why=why)


def _enter_stage(
    state: SafetyState, stage: SafetyStage, now: float, why: str = '', curable: bool = False
) -> SafetyState:
    return state._replace(stage=stage, since=now, why=why, curable=curable)


def _step_disarmed(
    state: SafetyState,
    now: float,
    inputs: SafetyInputs,
    request: SafetyRequest,
    limits: SafetyLimits,
) -> tuple[SafetyState, SafetyOutputs]:
    if request.arm:
        why = find_arming_refusal(state, inputs, limits)
        if why:
            return state._replace(why=why), NO_OUTPUTS
        return _enter_stage(state, SafetyStage.ARMING, now)._replace(asked_at=now), SafetyOutputs(
            arm=True
        )
    # Armed by an earlier program, or by a request that was never confirmed: disarm it.
    # A flying drone would fall, and firmware that arms itself would arm again at once
    armed = inputs.word & SupervisorBit.ARMED and not inputs.word & (
        SupervisorBit.FLYING | SupervisorBit.AUTO_ARM
    )
    if armed and now - state.asked_at >= REQUEST_PERIOD:
        return state._replace(asked_at=now), SafetyOutputs(arm=False)
    return state, NO_OUTPUTS


def _step_arming(
    state: SafetyState,
    now: float,
    inputs: SafetyInputs,
    request: SafetyRequest,
    limits: SafetyLimits,
) -> tuple[SafetyState, SafetyOutputs]:
    why = ON_REQUEST if request.arm is False else find_arming_refusal(state, inputs, limits)
    if why or now - state.since > ASKING:
        why = why or f'the Crazyflie did not confirm the arming within {ASKING:.0f} s'
        return _enter_disarmed(state, now, why), SafetyOutputs(arm=False)
    # Only a word that was sent after the request counts.
    if inputs.word & SupervisorBit.ARMED and now - state.since > inputs.silence:
        return _enter_stage(state, SafetyStage.READY, now), NO_OUTPUTS
    # The radio may have lost the request: repeat it until it is confirmed
    if now - state.asked_at >= REQUEST_PERIOD:
        return state._replace(asked_at=now), SafetyOutputs(arm=True)
    return state, NO_OUTPUTS


def _step_ready(
    state: SafetyState,
    now: float,
    inputs: SafetyInputs,
    request: SafetyRequest,
    limits: SafetyLimits,
) -> tuple[SafetyState, SafetyOutputs]:
    if not inputs.word & SupervisorBit.ARMED:
        return _enter_disarmed(
            state, now, 'the Crazyflie disarmed itself, because it stood still for too long'
        ), NO_OUTPUTS
    why = (
        ON_REQUEST
        if request.arm is False
        # The flight time does not count yet.
        else find_landing_reason(state._replace(began=now), now, inputs, limits)
    )
    if why:
        return _enter_disarmed(state, now, why), SafetyOutputs(arm=False)
    if not find_stale_input(inputs):
        return _enter_stage(state, SafetyStage.FLYING, now)._replace(began=now), SafetyOutputs(
            drive=1.0, stream=True
        )
    # No command to fly yet: in motors mode, stream zero duties
    return state, SafetyOutputs(stream=True)


def _step_flying(
    state: SafetyState,
    now: float,
    inputs: SafetyInputs,
    request: SafetyRequest,
    limits: SafetyLimits,
) -> tuple[SafetyState, SafetyOutputs]:
    if not inputs.word & SupervisorBit.ARMED:
        return _enter_disarmed(
            state, now, 'the Crazyflie disarmed itself, because its motors were idle'
        ), NO_OUTPUTS
    why = ON_REQUEST if request.arm is False else find_landing_reason(state, now, inputs, limits)
    stale = find_stale_input(inputs)
    if why or stale:
        landing = _enter_stage(state, SafetyStage.LANDING, now, why or stale, curable=bool(stale))
        return landing, SafetyOutputs(drive=1.0, stream=True)
    return state, SafetyOutputs(drive=1.0, stream=True)


def _step_landing(
    state: SafetyState,
    now: float,
    inputs: SafetyInputs,
    request: SafetyRequest,
    limits: SafetyLimits,
) -> tuple[SafetyState, SafetyOutputs]:
    gone = now - state.since
    if gone < RAMP:
        # A landing for stale inputs may return to FLYING; any other reason makes it final.
        fit = request.arm is not False and not find_landing_reason(state, now, inputs, limits)
        if (
            state.curable
            and fit
            and not find_stale_input(inputs)
            and inputs.word & SupervisorBit.ARMED
        ):
            return _enter_stage(state, SafetyStage.FLYING, now), SafetyOutputs(
                drive=1.0, stream=True
            )
        curable = state.curable and fit
        # Once the landing is final it stays final, even if the reason disappears
        return state._replace(curable=curable), SafetyOutputs(drive=1.0 - gone / RAMP, stream=True)
    # A landing counts only after the hand-over was sent.
    landed = not inputs.word & SupervisorBit.FLYING
    if (landed and gone > RAMP + REQUEST_PERIOD) or gone > RAMP + LANDING_TIME:
        return _enter_disarmed(state, now, state.why), SafetyOutputs(arm=False)
    if gone < RAMP + HANDING and now - state.asked_at >= REQUEST_PERIOD:
        return state._replace(asked_at=now), SafetyOutputs(hand_over=True)
    return state, NO_OUTPUTS


STAGE_STEPS: Final = {
    SafetyStage.DISARMED: _step_disarmed,
    SafetyStage.ARMING: _step_arming,
    SafetyStage.READY: _step_ready,
    SafetyStage.FLYING: _step_flying,
    SafetyStage.LANDING: _step_landing,
}
