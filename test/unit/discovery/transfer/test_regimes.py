"""Regimes of flights: places of a moving mass, slow and fast."""

from types import SimpleNamespace

from lta_discovery.flights.measured_flight import Stream
from lta_discovery.transfer.regimes import group_by_regime
import numpy as np


def flight(speed: float, place: float | None):
    """Return what `group_by_regime` looks at of a flight."""
    start = np.zeros((3, 13))
    start[:, 7] = speed
    mass = None if place is None else Stream(np.zeros(1), np.array([[place, 0.0, 0.0]]))
    commands = Stream(np.zeros(0), np.zeros((0, 2)))
    flown = SimpleNamespace(mass=mass, commands=commands, wrench=None)
    replay = SimpleNamespace(cut=SimpleNamespace(start=start), flight=flown)
    return SimpleNamespace(replay=replay)


def test_flights_are_grouped_by_place_and_speed() -> None:
    """A place with one flight is no regime: it alone would say what it is worth."""
    told = [(0.2, 0.0647), (0.2, 0.0649), (0.4, 0.0747), (0.4, 0.0747), (0.5, 0.0847)]
    assert group_by_regime([flight(*one) for one in told]) == {
        'moving mass at 0.065 m': [0, 1],
        'moving mass at 0.075 m': [2, 3],
        'slower than 0.40 m/s': [0, 1],
        '0.40 m/s or faster': [2, 3, 4],
    }


def test_one_speed_and_no_moving_mass_is_one_regime() -> None:
    assert group_by_regime([flight(0.30 + 0.001 * k, None) for k in range(9)]) == {}
