"""Elements of a model and their priors."""

import math

from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter, list_free_parameters
from lta_discovery.posterior.elements import (
    compute_variance,
    ElementChoice,
    ForceGroup,
    list_elements,
)
from lta_discovery.posterior.missing_elements import list_flight_unknowns
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest

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
