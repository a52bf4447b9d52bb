"""What the search names in flights in which something is hidden."""

from lta_discovery.flights.measured_flight import FlightStreams, MeasuredFlight, resample_flight
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import list_free_parameters
from lta_discovery.posterior import missing_elements
from lta_discovery.posterior.missing_elements import MissingElements, MissingElementSearch
from lta_discovery.posterior.settings import NEGLIGIBLE
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest

from ..hidden_cases import CASES, off_by_tolerance  # noqa: TID252 - `test` is Python's own
from ..hidden_flight import flown  # noqa: TID252

# Hidden effects and their values, relative to the file
VALUES = {
    'rotor_fault.lost_3': 0.14,
    'linear_drag.surge': 0.03,
    'motor_lag': 0.048,
    'motor_deadband.threshold': 0.08,
    'command_delay.delay': 0.045,
    'thrust_scale.factor': -0.2,
    'range_offset.offset': 0.1,
    'tracker_delay.delay': 0.03,
}


def search(flights: list[MeasuredFlight]) -> MissingElements:
    vehicle = load_vehicle('gtmab')
    parameters = list_free_parameters(NominalVehicle.from_vehicle(vehicle))
    return MissingElementSearch(vehicle, flights, parameters).run()


def find_value(result: MissingElements, name: str) -> tuple[float, float]:
    """Return value and standard deviation of a parameter that all flights share."""
    k = next(k for k, one in enumerate(result.parameters) if one.name == name)
    return float(result.values[k]), float(np.sqrt(result.covariance[k, k]))


def without_sensors(streams: FlightStreams) -> MeasuredFlight:
    """Return a flight that only a tracker has seen."""
    return resample_flight(FlightStreams(streams.pose, streams.commands, floor=streams.floor))


def test_an_effect_of_negligible_size_is_not_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """A drag of 0.03 N s/m is within an order of magnitude of a typical one."""
    flight = without_sensors(flown(CASES['linear_drag.surge'], 1, 24.0))
    for least, count in ((NEGLIGIBLE, 1), (10.0, 0)):
        monkeypatch.setattr(missing_elements, 'NEGLIGIBLE', least)
        assert len(search([flight]).present) == count


def test_a_drag_that_only_a_tracker_has_seen_is_named_with_its_value() -> None:
    result = search([without_sensors(flown(CASES['linear_drag.surge'], 1, 24.0))])
    assert [one.names[0] for one in result.present] == ['linear_drag.surge']
    assert result.present[0].kind == 'effect'
    value, deviation = find_value(result, 'linear_drag.surge')
    assert value == pytest.approx(0.03, abs=3.0 * deviation)
    assert deviation < 0.005
    assert result.trust == 1.0


@pytest.mark.long
@pytest.mark.parametrize('name', VALUES)
def test_each_of_several_effects_is_named_with_its_value(name: str) -> None:
    flights = [resample_flight(flown(CASES[name], seed)) for seed in (1, 2)]
    result = search(flights)
    assert [one.names[0] for one in result.present] == [name]
    value, deviation = find_value(result, name)
    assert value == pytest.approx(VALUES[name], abs=3.0 * deviation)


@pytest.mark.long
@pytest.mark.parametrize('seed', [1, 2])
def test_nothing_is_named_in_a_vehicle_that_is_off_by_its_tolerances(seed: int) -> None:
    flights = [resample_flight(flown(off_by_tolerance(seed), k)) for k in (seed, seed + 10)]
    assert search(flights).present == ()
