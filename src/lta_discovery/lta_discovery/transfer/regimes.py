"""Group flights by regime, and test whether named effects transfer between regimes."""

from collections.abc import Sequence
from typing import Final

from lta_discovery.forecast.forecast_fit import ForecastFitter
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.study import DiscoveryStudy
from lta_discovery.transfer.cross_validation import cross_validate, format_interpolation_warning
import numpy as np

ENOUGH: Final = 8  # fewest flights for a test
EACH: Final = 2  # fewest flights inside and outside of a regime
APART: Final = 1e-3  # m; resolution of places of a moving mass
FASTER: Final = 1.3  # times; a smaller ratio counts as the same speed
STEADY: Final = 0.01  # of the largest command; within it a command is constant
TURNING: Final = 0.05  # rad/s; slower is straight flight
ROUNDS: Final = 2  # most steps of the fit for the test
LIFT: Final = 0.004  # N; deviation of a flight's lift (as between RGBlimp's repeats)


def group_by_regime(flights: Sequence[FlightLinearizer]) -> dict[str, list[int]]:
    """
    Group flights by moving mass, constant commands, speed, and direction of turn.

    Only regimes with enough flights inside and outside are returned.
    """
    out: dict[str, list[int]] = {}
    for f, flight in enumerate(flights):
        for name in (_mass_regime(flight), _command_regime(flight)):
            if name:
                out.setdefault(name, []).append(f)
    out |= _group_by_speed(flights) | _group_by_turn(flights)
    return {
        name: inside for name, inside in out.items() if EACH <= len(inside) <= len(flights) - EACH
    }


def _mass_regime(flight: FlightLinearizer) -> str:
    """Return the regime of the moving mass, '' without one."""
    mass = flight.replay.flight.mass
    if mass is None:
        return ''
    # Rounded, so that flights with nearly equal places share a regime
    return f'moving mass at {APART * round(float(np.median(mass.values[:, 0])) / APART):.3f} m'


def _command_regime(flight: FlightLinearizer) -> str:
    """Return the regime of a flight with constant commands, else ''."""
    measured = flight.replay.flight
    stream = measured.commands if measured.wrench is None else measured.wrench
    if not len(stream.values):
        return ''
    middle = np.median(stream.values, axis=0)
    size = float(np.abs(stream.values).max())
    if size == 0.0 or float(np.abs(stream.values - middle).max()) > STEADY * size:
        return ''
    return f'constant commands {", ".join(f"{value:.2g}" for value in middle)}'


def _group_by_speed(flights: Sequence[FlightLinearizer]) -> dict[str, list[int]]:
    """Return the slow and the fast flights, if their speeds differ clearly."""
    speeds = [
        float(np.median(np.linalg.norm(one.replay.cut.start[:, 7:10], axis=1))) for one in flights
    ]
    middle = float(np.median(speeds))
    slow = [f for f, speed in enumerate(speeds) if speed < middle]
    fast = [f for f, speed in enumerate(speeds) if speed >= middle]
    if not slow or np.median([speeds[f] for f in fast]) <= FASTER * np.median(
        [speeds[f] for f in slow]
    ):
        return {}
    return {f'slower than {middle:.2f} m/s': slow, f'{middle:.2f} m/s or faster': fast}


def _group_by_turn(flights: Sequence[FlightLinearizer]) -> dict[str, list[int]]:
    """Return the flights with a mean left turn, and with a mean right turn."""
    rates = [float(np.mean(one.replay.cut.start[:, 12])) for one in flights]
    return {
        'turning left': [f for f, rate in enumerate(rates) if rate > TURNING],
        'turning right': [f for f, rate in enumerate(rates) if rate < -TURNING],
    }


def format_regime_warning(study: DiscoveryStudy) -> str:
    """
    Return a warning if the named effects do not transfer to a left-out regime, else ''.

    The test uses forecasts of training and confirming flights, if there are enough of them.
    """
    if study.finding.carried is not None and study.finding.carried.names:
        return ''  # the effects were identified by this test
    flights = [one.flight for one in study.flights if one.role != 'holdout']
    # At least one piece has to reach the last horizon
    flights = [one for one in flights if one.replay.cut.inside[:, -1].any()]
    knobs = [knob for effect in study.finding.effects for knob in effect.knobs]
    groups = group_by_regime(flights) if knobs and len(flights) >= ENOUGH else {}
    if not groups:
        return ''
    foresight = ForecastFitter(study.nominal, flights, LIFT)
    which = [k for k, knob in enumerate(foresight.knobs) if knob.name in knobs]
    parameters = [foresight.knobs[k] for k in which]
    spread = np.array([max(knob.typical, 2.0 * knob.tolerance) for knob in parameters])
    fitted = foresight.fit(which, spread, range(len(flights)), rounds=ROUNDS)
    names = [effect.name for effect in study.finding.effects]
    return format_interpolation_warning(
        names, cross_validate(foresight, fitted, which, spread, groups)
    )
