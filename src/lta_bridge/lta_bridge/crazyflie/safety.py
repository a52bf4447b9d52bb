"""
When the motors may turn: the one state machine of the Crazyflie bridge.

`tick` is called at a steady rhythm with what is known and what was asked, and says what to send.
Motors turn in FLYING and for `RAMP` into LANDING, nowhere else. Whatever goes wrong in the air
comes down in order: a ramp, then the hand-over to the firmware, then disarmed. Silence is never
an answer, because the firmware locks itself after 2 s of it.
"""

from enum import StrEnum
import math
from typing import Final, NamedTuple

from lta_bridge.crazyflie.supervisor import Bit, trouble

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


class Stage(StrEnum):
    """Where the bridge stands."""

    DISARMED = 'disarmed'
    ARMING = 'arming'
    READY = 'ready'  # armed, and no fresh command yet
    FLYING = 'flying'
    LANDING = 'landing'
    STOPPED = 'stopped'  # by an emergency stop; for good


class Limits(NamedTuple):
    """What ends a flight: cell voltage [V], time [s], height [m] and way through the air [m]."""

    voltage: float
    time: float
    height: float
    distance: float


class Seen(NamedTuple):
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


class Asked(NamedTuple):
    """What people asked since the last tick: to arm or disarm, to stop at once."""

    arm: bool | None = None
    stop: bool = False


class State(NamedTuple):
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

    stage: Stage = Stage.DISARMED
    since: float = 0.0
    began: float = 0.0
    why: str = 'not armed yet'
    stops: int = 0
    asked_at: float = -math.inf
    curable: bool = False
    low_since: float = math.inf


class Order(NamedTuple):
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


QUIET: Final = Order()


def refusal(state: State, seen: Seen, limits: Limits) -> str:
    """Return why a request to arm is refused; empty where it is not."""
    if state.stage is Stage.STOPPED:
        return 'stopped by an emergency stop: switch the Crazyflie off and on, restart the bridge'
    if not seen.linked:
        return 'no Crazyflie is connected'
    if not seen.active:
        return 'the bridge is not active: activate it first'
    if math.isinf(seen.silence):
        return 'the Crazyflie has not told how it is yet: ask again'
    if seen.silence > SILENT:
        return f'the Crazyflie has said nothing for {seen.silence:.1f} s'
    if math.isnan(seen.voltage):
        return 'the Crazyflie has not told the voltage of its cell yet: ask again'
    if seen.voltage < limits.voltage:
        return f'the cell has {seen.voltage:.2f} V, less than {limits.voltage:.2f} V: charge it'
    return trouble(seen.word)


def peril(state: State, now: float, seen: Seen, limits: Limits) -> str:
    """Return why a flight must end at a time [s] although commands are fresh; empty: go on."""
    if not seen.active:
        return 'deactivated'
    if seen.silence > SILENT:
        return f'the Crazyflie has said nothing for {seen.silence:.1f} s'
    if now - state.low_since >= LOW:
        known = not math.isnan(seen.voltage)
        return (
            f'the cell has {seen.voltage:.2f} V' if known else 'nobody tells its voltage any more'
        )
    if now - state.began > limits.time:
        return f'the flight has lasted {limits.time:.0f} s'
    if seen.height > limits.height:
        return f'higher than {limits.height:.1f} m'
    if seen.distance > limits.distance:
        return f'farther than {limits.distance:.1f} m'
    return ''


def old(seen: Seen) -> str:
    """Return why commands cannot be flown for their age, or that of the place; empty: they can."""
    if seen.command_age > STALE:
        return f'the newest command is {seen.command_age:.2f} s old'
    if seen.place_age > LOST:
        return f'the newest place by the estimator is {seen.place_age:.2f} s old'
    return ''


def tick(
    state: State, now: float, seen: Seen, asked: Asked, limits: Limits
) -> tuple[State, Order]:
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
    low = not seen.voltage >= limits.voltage  # nor may it fly on where nobody knows
    state = state._replace(low_since=min(state.low_since, now) if low else math.inf)
    if asked.stop:
        state = State(Stage.STOPPED, now, state.began, 'emergency stop', STOPS)
    if state.stage is Stage.STOPPED:
        # Nobody answers a stop; who still says that it is armed has not heard one.
        unheard = seen.linked and bool(seen.word & Bit.ARMED)
        stop = state.stops > 0 or unheard
        return state._replace(stops=max(0, state.stops - 1)), Order(stop=stop)
    if not seen.linked:
        return _down(state, now, 'no link'), QUIET
    if trouble(seen.word):
        return _down(state, now, trouble(seen.word)), QUIET
    return STEPS[state.stage](state, now, seen, asked, limits)


def _down(state: State, now: float, why: str) -> State:
    """Return the state of rest, for this reason; its time is that of the change."""
    if state.stage is Stage.DISARMED:
        return state._replace(why=why)
    return State(Stage.DISARMED, now, why=why)


def _to(state: State, stage: Stage, now: float, why: str = '', curable: bool = False) -> State:
    return state._replace(stage=stage, since=now, why=why, curable=curable)


def _disarmed(
    state: State, now: float, seen: Seen, asked: Asked, limits: Limits
) -> tuple[State, Order]:
    if asked.arm:
        why = refusal(state, seen, limits)
        if why:
            return state._replace(why=why), QUIET
        return _to(state, Stage.ARMING, now)._replace(asked_at=now), Order(arm=True)
    # Found armed, by whoever flew before or by a request that was never confirmed.
    armed = seen.word & Bit.ARMED and not seen.word & (Bit.FLYING | Bit.AUTO_ARM)
    if armed and now - state.asked_at >= AGAIN:
        return state._replace(asked_at=now), Order(arm=False)
    return state, QUIET


def _arming(
    state: State, now: float, seen: Seen, asked: Asked, limits: Limits
) -> tuple[State, Order]:
    why = 'asked to' if asked.arm is False else refusal(state, seen, limits)
    if why or now - state.since > ASKING:
        why = why or f'the supervisor did not confirm within {ASKING:.0f} s'
        return _down(state, now, why), Order(arm=False)
    if seen.word & Bit.ARMED and now - state.since > seen.silence:
        return _to(state, Stage.READY, now), QUIET
    if now - state.asked_at >= AGAIN:
        return state._replace(asked_at=now), Order(arm=True)
    return state, QUIET


def _ready(
    state: State, now: float, seen: Seen, asked: Asked, limits: Limits
) -> tuple[State, Order]:
    if not seen.word & Bit.ARMED:
        return _down(state, now, 'the Crazyflie disarmed itself, as one does that stands'), QUIET
    why = 'asked to' if asked.arm is False else peril(state._replace(began=now), now, seen, limits)
    if why:
        return _down(state, now, why), Order(arm=False)
    if not old(seen):
        return _to(state, Stage.FLYING, now)._replace(began=now), Order(drive=1.0, stream=True)
    return state, Order(stream=True)


def _flying(
    state: State, now: float, seen: Seen, asked: Asked, limits: Limits
) -> tuple[State, Order]:
    if not seen.word & Bit.ARMED:
        return _down(state, now, 'the Crazyflie disarmed itself, as one does that coasts'), QUIET
    why = 'asked to' if asked.arm is False else peril(state, now, seen, limits)
    stale = old(seen)
    if why or stale:
        landing = _to(state, Stage.LANDING, now, why or stale, curable=bool(stale))
        return landing, Order(drive=1.0, stream=True)
    return state, Order(drive=1.0, stream=True)


def _landing(
    state: State, now: float, seen: Seen, asked: Asked, limits: Limits
) -> tuple[State, Order]:
    gone = now - state.since
    if gone < RAMP:
        fit = asked.arm is not False and not peril(state, now, seen, limits)
        if state.curable and fit and not old(seen) and seen.word & Bit.ARMED:
            return _to(state, Stage.FLYING, now), Order(drive=1.0, stream=True)
        curable = state.curable and fit
        return state._replace(curable=curable), Order(drive=1.0 - gone / RAMP, stream=True)
    landed = not seen.word & Bit.FLYING
    if (landed and gone > RAMP + AGAIN) or gone > RAMP + SETTLING:
        return _down(state, now, state.why), Order(arm=False)
    if gone < RAMP + HANDING and now - state.asked_at >= AGAIN:
        return state._replace(asked_at=now), Order(hand_over=True)
    return state, QUIET


STEPS: Final = {
    Stage.DISARMED: _disarmed,
    Stage.ARMING: _arming,
    Stage.READY: _ready,
    Stage.FLYING: _flying,
    Stage.LANDING: _landing,
}
