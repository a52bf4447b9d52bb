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
from lta_control.cascade import Setpoint, wrap_angle

STOPS: Final = 10  # emergency stops that follow at once
AGAIN: Final = 0.5  # s between those after that
LEAD_TURN: Final = 1.0  # rad by which the wanted heading may be ahead of the nose
LEAD_CLIMB: Final = 0.5  # m by which the wanted altitude may be ahead of the hull


class TeleopRates(Settings):
    """What a full deflection means."""

    speed: float = setting(0.3, 'Airspeed of the forward stick.', unit='m/s', low=0.01, high=2.0)
    turn: float = setting(0.6, 'Rate of the wanted heading.', unit='rad/s', low=0.01, high=3.0)
    climb: float = setting(0.2, 'Rate of the wanted altitude.', unit='m/s', low=0.01, high=1.0)


class TeleopStage(StrEnum):
    """Who steers."""

    UNKNOWN = 'nobody known'  # nobody who flies by setpoints has said whose count
    NAVIGATOR = 'navigator'
    PERSON = 'person'
    STOPPED = 'stopped'  # by an emergency stop; for good


class HeadingAltitude(NamedTuple):
    """Heading [rad] and altitude [m] by the estimate."""

    heading: float
    altitude: float


class TeleopState(NamedTuple):
    """The memory: who steers, whether by our own word, what they want, and the stops said."""

    stage: TeleopStage = TeleopStage.UNKNOWN
    own: bool = False
    wanted: HeadingAltitude | None = None
    stops: int = 0
    stopped_at: float = -math.inf


class TeleopOutputs(NamedTuple):
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


SILENT: Final = TeleopOutputs()


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
    if state.stage is TeleopStage.STOPPED or (sticks is not None and sticks.stop):
        return _step_stopped(state, now)
    if person_steers is not None and not state.own:
        state = state._replace(
            stage=TeleopStage.PERSON if person_steers else TeleopStage.NAVIGATOR
        )
    if sticks is None or estimate is None:
        # Whoever comes back begins where the drone then is.
        return state._replace(wanted=None), SILENT
    takes = sticks.is_deflected or sticks.take
    if sticks.give_back and not takes:
        return TeleopState(TeleopStage.NAVIGATOR, own=True), TeleopOutputs(held=False)
    if state.stage is not TeleopStage.PERSON and not takes:
        return state, SILENT
    wanted = _lead_target(state.wanted or estimate, estimate, sticks, rates, dt)
    setpoint = Setpoint(wanted.altitude, wanted.heading, rates.speed * sticks.forward)
    return TeleopState(TeleopStage.PERSON, True, wanted), TeleopOutputs(True, setpoint)


def _step_stopped(state: TeleopState, now: float) -> tuple[TeleopState, TeleopOutputs]:
    if state.stops >= STOPS and now - state.stopped_at < AGAIN:
        return state, SILENT
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
    """Return where the sticks lead to, never far ahead of where the drone is."""
    ahead = wrap_angle(target.heading + rates.turn * sticks.turn * dt - estimate.heading)
    above = target.altitude + rates.climb * sticks.climb * dt - estimate.altitude
    heading = wrap_angle(estimate.heading + max(-LEAD_TURN, min(LEAD_TURN, ahead)))
    return HeadingAltitude(heading, estimate.altitude + max(-LEAD_CLIMB, min(LEAD_CLIMB, above)))
