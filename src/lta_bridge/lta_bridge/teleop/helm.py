"""
Who steers: the one state machine of teleoperation.

A stick that leaves its rest takes the helm at once; only the button gives it back, with all sticks
at rest. A dead device or a lost estimate leaves the helm with the person and says nothing: the
setpoints age, and whoever flies by them holds, then lands, as for any other silence. Who begins
anew takes up what those say who fly by the setpoints. An emergency stop is for good, and said
again and again because nobody confirms one.
"""

from enum import StrEnum
import math
from typing import Final, NamedTuple

from lta_bridge.teleop.sticks import Sticks
from lta_config.settings import setting, Settings
from lta_control.cascade import Setpoint, wrap

STOPS: Final = 10  # emergency stops that follow at once
AGAIN: Final = 0.5  # s between those after that
LEAD_TURN: Final = 1.0  # rad by which the wanted heading may be ahead of the nose
LEAD_CLIMB: Final = 0.5  # m by which the wanted altitude may be ahead of the hull


class Rates(Settings):
    """What a full deflection means."""

    speed: float = setting(0.3, 'Airspeed of the forward stick.', unit='m/s', low=0.01, high=2.0)
    turn: float = setting(0.6, 'Rate of the wanted heading.', unit='rad/s', low=0.01, high=3.0)
    climb: float = setting(0.2, 'Rate of the wanted altitude.', unit='m/s', low=0.01, high=1.0)


class Stage(StrEnum):
    """Who steers."""

    UNKNOWN = 'nobody known'  # nobody who flies by setpoints has said whose count
    NAVIGATOR = 'navigator'
    PERSON = 'person'
    STOPPED = 'stopped'  # by an emergency stop; for good


class Felt(NamedTuple):
    """Heading [rad] and altitude [m] by the estimate."""

    heading: float
    altitude: float


class State(NamedTuple):
    """The memory: who steers, whether by our own word, what they want, and the stops said."""

    stage: Stage = Stage.UNKNOWN
    own: bool = False
    wanted: Felt | None = None
    stops: int = 0
    stopped_at: float = -math.inf


class Order(NamedTuple):
    """
    What to say at this tick.

    Attributes
    ----------
    held : bool or None
        That a person has the helm, or that none has; None says nothing.
    setpoint : Setpoint or None
        What the person wants.
    stop : bool
        An emergency stop.

    """

    held: bool | None = None
    setpoint: Setpoint | None = None
    stop: bool = False


SILENT: Final = Order()


def tick(
    state: State,
    now: float,
    dt: float,
    sticks: Sticks | None,
    felt: Felt | None,
    rates: Rates,
    told: bool | None = None,
) -> tuple[State, Order]:
    """
    Return the next state and what to say.

    Parameters
    ----------
    state : State
        Of the last tick.
    now, dt : float
        Time on a clock that only goes on, and since the last tick. [s]
    sticks : Sticks or None
        What the hands say; None where the device is dead.
    felt : Felt or None
        The newest estimate; None where there is no fresh one.
    rates : Rates
        What a full deflection means.
    told : bool or None
        Whether those who fly by setpoints say that a person's count; None where none has said.

    """
    if state.stage is Stage.STOPPED or (sticks is not None and sticks.stop):
        return _stopped(state, now)
    if told is not None and not state.own:
        state = state._replace(stage=Stage.PERSON if told else Stage.NAVIGATOR)
    if sticks is None or felt is None:
        # Whoever comes back begins where the drone then is.
        return state._replace(wanted=None), SILENT
    takes = sticks.moved or sticks.take
    if sticks.give_back and not takes:
        return State(Stage.NAVIGATOR, own=True), Order(held=False)
    if state.stage is not Stage.PERSON and not takes:
        return state, SILENT
    wanted = _led(state.wanted or felt, felt, sticks, rates, dt)
    setpoint = Setpoint(wanted.altitude, wanted.heading, rates.speed * sticks.forward)
    return State(Stage.PERSON, True, wanted), Order(True, setpoint)


def _stopped(state: State, now: float) -> tuple[State, Order]:
    if state.stops >= STOPS and now - state.stopped_at < AGAIN:
        return state, SILENT
    return State(Stage.STOPPED, stops=state.stops + 1, stopped_at=now), Order(stop=True)


def _led(wanted: Felt, felt: Felt, sticks: Sticks, rates: Rates, dt: float) -> Felt:
    """Return where the sticks lead to, never far ahead of where the drone is."""
    ahead = wrap(wanted.heading + rates.turn * sticks.turn * dt - felt.heading)
    above = wanted.altitude + rates.climb * sticks.climb * dt - felt.altitude
    heading = wrap(felt.heading + max(-LEAD_TURN, min(LEAD_TURN, ahead)))
    return Felt(heading, felt.altitude + max(-LEAD_CLIMB, min(LEAD_CLIMB, above)))
