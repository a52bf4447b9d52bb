"""
When the motors may turn: the one state machine of the Crazyflie bridge.

`step_state` is called at a steady rhythm with what is known and what was asked, and says what to
send.
Motors turn in FLYING and for `RAMP` into LANDING, nowhere else. Whatever goes wrong in the air
comes down in order: a ramp, then the hand-over to the firmware, then disarmed. Silence is never
an answer, because the firmware locks itself after 2 s of it.
"""

from enum import StrEnum
import math
from typing import Final, NamedTuple

from lta_bridge.crazyflie.supervisor_word import explain_fault, SupervisorBit

STALE: Final = 0.3  # s: age from which a command is not flown; the firmware levels out at 0.5
SILENT: Final = 0.5  # s: age of the newest log packet from which the link counts as lost
LOST: Final = 0.5  # s: age of the newest place from which height and way count as unknown
LOW: Final = 0.3  # s for which a cell must be told low: one sample of ten a second may be wrong
RAMP: Final = 0.5  # s from full command to none
ASKING: Final = 1.0  # s for the supervisor to confirm that it is armed
AGAIN: Final = 0.1  # s between two requests without answer
HANDING: Final = 0.3  # s in which the hand-over is told again: no answer says that it came
SETTLING: Final = 10.0  # s for the firmware to land what was handed over
LEAVE: Final = 15.0  # s at most to land and to hear that it is disarmed, before the link is let go
STOPS: Final = 10  # emergency stops that are sent: nobody confirms one


class SafetyStage(StrEnum):
    """Where the bridge stands."""

    DISARMED = 'disarmed'
    ARMING = 'arming'
    READY = 'ready'  # armed, and no fresh command yet
    FLYING = 'flying'
    LANDING = 'landing'
    STOPPED = 'stopped'  # by an emergency stop; for good


class SafetyLimits(NamedTuple):
    """What ends a flight: cell voltage [V], time [s], height [m] and way through the air [m]."""

    voltage: float
    time: float
    height: float
    distance: float


class SafetyInputs(NamedTuple):
    """
    What is known at a tick.

    Attributes
    ----------
    linked : bool
        Whether a Crazyflie is connected, its parameters as expected.
    active : bool
        Whether the node is active.
    word : int
        The supervisor's newest word.
    silence : float
        Age of the newest packet with that word. [s]
    command_age : float
        Of the newest usable command; infinite without one. [s]
    voltage : float
        Of the cell; NaN where unknown. [V]
    height, distance : float
        Above and from the start; NaN where unknown. [m]
    place_age : float
        Of these two; 0 where nobody has told any, as to one who flies without an estimator. [s]

    """

    linked: bool = False
    active: bool = False
    word: int = 0
    silence: float = math.inf
    command_age: float = math.inf
    voltage: float = math.nan
    height: float = math.nan
    distance: float = math.nan
    place_age: float = 0.0


class SafetyRequest(NamedTuple):
    """What people asked since the last tick: to arm or disarm, to stop at once."""

    arm: bool | None = None
    stop: bool = False


class SafetyState(NamedTuple):
    """
    The memory.

    Attributes
    ----------
    stage : Stage
        Where the bridge stands.
    since, began : float
        Since when, and when the flight began. [s]
    why : str
        Why it stands there.
    stops : int
        Emergency stops that are still to be sent.
    asked_at : float
        When the newest request without answer was sent. [s]
    curable : bool
        Whether a fresh command ends this landing.
    low_since : float
        Since when the cell has been told low, or nothing; infinite where it is well. [s]

    """

    stage: SafetyStage = SafetyStage.DISARMED
    since: float = 0.0
    began: float = 0.0
    why: str = 'not armed yet'
    stops: int = 0
    asked_at: float = -math.inf
    curable: bool = False
    low_since: float = math.inf


class SafetyOutputs(NamedTuple):
    """
    What to send at this tick.

    Attributes
    ----------
    arm : bool or None
        A request to arm or to disarm.
    drive : float
        Share of the newest usable command that is flown, 0 to 1.
    stream : bool
        Whether a command goes out at all.
    hand_over : bool
        Whether to tell the firmware that no more setpoints come, and to land.
    stop : bool
        An emergency stop.

    """

    arm: bool | None = None
    drive: float = 0.0
    stream: bool = False
    hand_over: bool = False
    stop: bool = False


QUIET: Final = SafetyOutputs()


def find_arming_refusal(state: SafetyState, inputs: SafetyInputs, limits: SafetyLimits) -> str:
    """Return why a request to arm is refused; empty where it is not."""
    if state.stage is SafetyStage.STOPPED:
        return 'stopped by an emergency stop: switch the Crazyflie off and on, restart the bridge'
    if not inputs.linked:
        return 'no Crazyflie is connected'
    if not inputs.active:
        return 'the bridge is not active: activate it first'
    if math.isinf(inputs.silence):
        return 'the Crazyflie has not told how it is yet: ask again'
    if inputs.silence > SILENT:
        return f'the Crazyflie has said nothing for {inputs.silence:.1f} s'
    if math.isnan(inputs.voltage):
        return 'the Crazyflie has not told the voltage of its cell yet: ask again'
    if inputs.voltage < limits.voltage:
        return f'the cell has {inputs.voltage:.2f} V, less than {limits.voltage:.2f} V: charge it'
    return explain_fault(inputs.word)


def find_landing_reason(
    state: SafetyState, now: float, inputs: SafetyInputs, limits: SafetyLimits
) -> str:
    """Return why a flight must end at a time [s] although commands are fresh; empty: go on."""
    if not inputs.active:
        return 'deactivated'
    if inputs.silence > SILENT:
        return f'the Crazyflie has said nothing for {inputs.silence:.1f} s'
    if now - state.low_since >= LOW:
        known = not math.isnan(inputs.voltage)
        return (
            f'the cell has {inputs.voltage:.2f} V'
            if known
            else 'nobody tells its voltage any more'
        )
    if now - state.began > limits.time:
        return f'the flight has lasted {limits.time:.0f} s'
    if inputs.height > limits.height:
        return f'higher than {limits.height:.1f} m'
    if inputs.distance > limits.distance:
        return f'farther than {limits.distance:.1f} m'
    return ''


def find_stale_input(inputs: SafetyInputs) -> str:
    """Return why commands cannot be flown for their age, or that of the place; empty: they can."""
    if inputs.command_age > STALE:
        return f'the newest command is {inputs.command_age:.2f} s old'
    if inputs.place_age > LOST:
        return f'the newest place by the estimator is {inputs.place_age:.2f} s old'
    return ''


def step_state(
    state: SafetyState,
    now: float,
    inputs: SafetyInputs,
    request: SafetyRequest,
    limits: SafetyLimits,
) -> tuple[SafetyState, SafetyOutputs]:
    """
    Return the next state and what to send.

    Parameters
    ----------
    state : State
        Of the last tick.
    now : float
        On a clock that only goes on. [s]
    seen : Seen
        What is known.
    asked : Asked
        What was asked since the last tick.
    limits : Limits
        What ends a flight.

    """
    low = not inputs.voltage >= limits.voltage  # nor may it fly on where nobody knows
    state = state._replace(low_since=min(state.low_since, now) if low else math.inf)
    if request.stop:
        state = SafetyState(SafetyStage.STOPPED, now, state.began, 'emergency stop', STOPS)
    if state.stage is SafetyStage.STOPPED:
        # Nobody answers a stop; who still says that it is armed has not heard one.
        unheard = inputs.linked and bool(inputs.word & SupervisorBit.ARMED)
        stop = state.stops > 0 or unheard
        return state._replace(stops=max(0, state.stops - 1)), SafetyOutputs(stop=stop)
    if not inputs.linked:
        return _enter_disarmed(state, now, 'no link'), QUIET
    if explain_fault(inputs.word):
        return _enter_disarmed(state, now, explain_fault(inputs.word)), QUIET
    return STEPS[state.stage](state, now, inputs, request, limits)


def _enter_disarmed(state: SafetyState, now: float, why: str) -> SafetyState:
    """Return the state of rest, for this reason; its time is that of the change."""
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
            return state._replace(why=why), QUIET
        return _enter_stage(state, SafetyStage.ARMING, now)._replace(asked_at=now), SafetyOutputs(
            arm=True
        )
    # Found armed, by whoever flew before or by a request that was never confirmed.
    armed = inputs.word & SupervisorBit.ARMED and not inputs.word & (
        SupervisorBit.FLYING | SupervisorBit.AUTO_ARM
    )
    if armed and now - state.asked_at >= AGAIN:
        return state._replace(asked_at=now), SafetyOutputs(arm=False)
    return state, QUIET


def _step_arming(
    state: SafetyState,
    now: float,
    inputs: SafetyInputs,
    request: SafetyRequest,
    limits: SafetyLimits,
) -> tuple[SafetyState, SafetyOutputs]:
    why = 'asked to' if request.arm is False else find_arming_refusal(state, inputs, limits)
    if why or now - state.since > ASKING:
        why = why or f'the supervisor did not confirm within {ASKING:.0f} s'
        return _enter_disarmed(state, now, why), SafetyOutputs(arm=False)
    if inputs.word & SupervisorBit.ARMED and now - state.since > inputs.silence:
        return _enter_stage(state, SafetyStage.READY, now), QUIET
    if now - state.asked_at >= AGAIN:
        return state._replace(asked_at=now), SafetyOutputs(arm=True)
    return state, QUIET


def _step_ready(
    state: SafetyState,
    now: float,
    inputs: SafetyInputs,
    request: SafetyRequest,
    limits: SafetyLimits,
) -> tuple[SafetyState, SafetyOutputs]:
    if not inputs.word & SupervisorBit.ARMED:
        return _enter_disarmed(
            state, now, 'the Crazyflie disarmed itself, as one does that stands'
        ), QUIET
    why = (
        'asked to'
        if request.arm is False
        else find_landing_reason(state._replace(began=now), now, inputs, limits)
    )
    if why:
        return _enter_disarmed(state, now, why), SafetyOutputs(arm=False)
    if not find_stale_input(inputs):
        return _enter_stage(state, SafetyStage.FLYING, now)._replace(began=now), SafetyOutputs(
            drive=1.0, stream=True
        )
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
            state, now, 'the Crazyflie disarmed itself, as one does that coasts'
        ), QUIET
    why = 'asked to' if request.arm is False else find_landing_reason(state, now, inputs, limits)
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
        return state._replace(curable=curable), SafetyOutputs(drive=1.0 - gone / RAMP, stream=True)
    landed = not inputs.word & SupervisorBit.FLYING
    if (landed and gone > RAMP + AGAIN) or gone > RAMP + SETTLING:
        return _enter_disarmed(state, now, state.why), SafetyOutputs(arm=False)
    if gone < RAMP + HANDING and now - state.asked_at >= AGAIN:
        return state._replace(asked_at=now), SafetyOutputs(hand_over=True)
    return state, QUIET


STEPS: Final = {
    SafetyStage.DISARMED: _step_disarmed,
    SafetyStage.ARMING: _step_arming,
    SafetyStage.READY: _step_ready,
    SafetyStage.FLYING: _step_flying,
    SafetyStage.LANDING: _step_landing,
}
