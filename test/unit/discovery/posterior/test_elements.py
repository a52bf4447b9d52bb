# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Elements of a model and their priors, and those that flights lack."""

import math

from lta_discovery.flights.measured_flight import FlightStreams, MeasuredFlight, resample_flight
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter, list_free_parameters
from lta_discovery.posterior import missing_elements
from lta_discovery.posterior.elements import (
    compute_variance,
    ElementChoice,
    ForceGroup,
    list_elements,
)
from lta_discovery.posterior.missing_elements import (
    list_flight_unknowns,
    MissingElements,
    MissingElementSearch,
)
from lta_discovery.settings import NEGLIGIBLE
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest

from ..hidden_cases import CASES, off_by_tolerance  # noqa: TID252 - `test` is Python's own
from ..hidden_flight import flown  # noqa: TID252

FORCES = (ForceGroup('heave by place', 3), ForceGroup('yaw by heading', 2))


@pytest.fixture(scope='module')
def parameters() -> list[FreeParameter]:
    nominal = NominalVehicle.from_vehicle(load_vehicle('gtmab'))
    return list_flight_unknowns(list_free_parameters(nominal), only_pose=False)


def test_one_effect_and_half_a_number_and_half_a_force_are_expected(
    parameters: list[FreeParameter],
) -> None:
    elements = list_elements(parameters, FORCES)
    for kind, wanted in (('effect', 1.0), ('number', 0.5), ('force', 0.5)):
        some = [one for one in elements if one.kind == kind]
        total = sum(len(one.sizes) * math.exp(one.log_prior) for one in some)
        assert total == pytest.approx(wanted, rel=1e-12)


def test_each_effect_is_as_probable_as_another(parameters: list[FreeParameter]) -> None:
    """However many parameters it has: three axes of drag share what one deadband has."""
    shares = dict[str, float]()
    for one in list_elements(parameters, ()):
        if one.kind == 'effect':
            effect = one.name.partition('.')[0]
            shares[effect] = shares.get(effect, 0.0) + math.exp(one.log_prior)
    assert np.ptp(list(shares.values())) < 1e-12
    assert {'linear_drag', 'motor_deadband'} <= shares.keys()


def test_components_of_a_vector_are_one_element(parameters: list[FreeParameter]) -> None:
    names = [one.name for one in parameters]
    elements = {one.name: one for one in list_elements(parameters, ())}
    pair = ('cg_offset.x', 'cg_offset.y')
    assert elements[pair[0]].columns == tuple(names.index(name) for name in pair)
    assert pair[1] not in elements


def test_what_flights_have_of_their_own_may_have_a_mean(parameters: list[FreeParameter]) -> None:
    """It is a candidate once for all flights, and a tolerance of each flight."""
    lifts = [one for one in parameters if one.name == 'net_lift.force']
    assert [(one.per_flight, one.tolerance, one.typical) for one in lifts] == [
        (False, 0.0, 0.02), (True, 0.0006, 0.0),
    ]  # fmt: skip


def test_flights_without_sensors_have_no_errors_of_sensors() -> None:
    nominal = NominalVehicle.from_vehicle(load_vehicle('gtmab'))
    parameters = list_flight_unknowns(list_free_parameters(nominal), only_pose=True)
    effects = {one.name.partition('.')[0] for one in parameters}
    assert not effects & {'gyro_bias', 'gyro_scale', 'imu_bias', 'range_offset', 'pressure_drift'}
    assert {'tracker_delay', 'clock_offset', 'net_lift'} <= effects


def test_an_element_adds_its_variance_to_the_tolerance() -> None:
    elements = list_elements([], (ForceGroup('surge by heading', 4),))
    variance = compute_variance(elements, frozenset({ElementChoice(0, 10.0)}), np.full(4, 3.0))
    # 10 floors, shared by four terms: 5 floors each
    np.testing.assert_allclose(variance, 3.0**2 + 5.0**2)


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
    return float(result.found.values[k]), float(np.sqrt(result.found.covariance[k, k]))


def without_sensors(streams: FlightStreams) -> MeasuredFlight:
    """Return a flight that only a tracker has seen."""
    return resample_flight(FlightStreams(streams.pose, streams.commands, floor=streams.floor))


def test_an_effect_of_negligible_size_is_not_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """A drag of 0.03 N s/m is within an order of magnitude of a typical one."""
    flight = without_sensors(flown(CASES['linear_drag.surge'], 1, 24.0))
    for least, count in ((NEGLIGIBLE, 1), (10.0, 0)):
        monkeypatch.setattr(missing_elements, 'NEGLIGIBLE', least)
        assert len(search([flight]).found.present) == count


def test_a_drag_that_only_a_tracker_has_seen_is_named_with_its_value() -> None:
    result = search([without_sensors(flown(CASES['linear_drag.surge'], 1, 24.0))])
    assert [one.names[0] for one in result.found.present] == ['linear_drag.surge']
    assert result.found.present[0].kind == 'effect'
    value, deviation = find_value(result, 'linear_drag.surge')
    assert value == pytest.approx(0.03, abs=3.0 * deviation)
    assert deviation < 0.005
    assert result.trust == 1.0


@pytest.mark.long
@pytest.mark.parametrize('name', VALUES)
def test_each_of_several_effects_is_named_with_its_value(name: str) -> None:
    flights = [resample_flight(flown(CASES[name], seed)) for seed in (1, 2)]
    result = search(flights)
    assert [one.names[0] for one in result.found.present] == [name]
    value, deviation = find_value(result, name)
    assert value == pytest.approx(VALUES[name], abs=3.0 * deviation)


@pytest.mark.long
def test_a_lag_of_two_stages_is_named_alone() -> None:
    """Two stages act as one after a delay, here of 20 ms, which is no effect of its own."""
    changes = {
        'vehicle.effects.motor_lag.up': {'value': 0.22, 'unit': 's'},
        'vehicle.effects.motor_lag.down': {'value': 0.22, 'unit': 's'},
        'vehicle.effects.command_delay.delay': {'value': 0.02, 'unit': 's'},
    }
    result = search([resample_flight(flown(changes, seed)) for seed in (1, 2)])
    assert [one.names[0] for one in result.found.present] == ['motor_lag']
    value, deviation = find_value(result, 'command_delay.delay')
    assert value == pytest.approx(0.02, abs=3.0 * deviation)


@pytest.mark.long
@pytest.mark.parametrize('seed', [1, 2])
def test_nothing_is_named_in_a_vehicle_that_is_off_by_its_tolerances(seed: int) -> None:
    flights = [resample_flight(flown(off_by_tolerance(seed), k)) for k in (seed, seed + 10)]
    assert search(flights).found.present == ()
