# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Forces of forms that the library does not have, as columns of a flight."""

from lta_discovery.flights.measured_flight import resample_flight
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.posterior.elements import ForceGroup
from lta_discovery.posterior.force_columns import build_scene, compute_wrenches
from lta_discovery.state_filter.linear_flight import FlightSystem, LinearFlight
from lta_discovery.state_filter.noise_model import wrench_floor
from lta_model.vehicle import load_vehicle
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.spatial.transform import Rotation

from ..hidden_flight import flown  # noqa: TID252 - `test` is Python's own

Array = NDArray[np.float64]


class Columns:
    """The forces of one clean flight."""

    def __init__(self) -> None:
        vehicle = load_vehicle('gtmab')
        nominal = NominalVehicle.from_vehicle(vehicle)
        self.floor = wrench_floor(nominal)
        system = FlightSystem(vehicle, resample_flight(flown({}, 1, 20.0)), [])
        self.flight: LinearFlight = system.linearize(nominal, np.zeros(0))
        scene = build_scene([self.flight])
        self.groups, wrenches = compute_wrenches(system, self.flight, scene, self.floor)
        # Only where the motion is known
        self.rows = np.concatenate([np.arange(a, b) for a, b in self.flight.runs])
        self.wrenches = wrenches[self.rows]

    def select(self, name: str) -> Array:
        """Return the wrenches of a force, shape (n, 6, J)."""
        first = 0
        for group in self.groups:
            if group.name == name:
                return self.wrenches[..., first : first + group.terms]
            first += group.terms
        raise AssertionError(name)


@pytest.fixture(scope='module')
def columns() -> Columns:
    return Columns()


def test_every_axis_has_the_same_forces(columns: Columns) -> None:
    names = [one.name for one in columns.groups]
    assert len(names) == len(set(names)) == 2 + 6 * 6
    for axis in ('surge', 'sway', 'heave', 'roll', 'pitch', 'yaw'):
        own = {name.partition(' by ')[2] for name in names if name.startswith(f'{axis} by ')}
        assert own - {'place'} == {
            'height', 'heading', 'one-sided speed', 'speed x speed', 'thrust x speed',
            'something that swings',
        }  # fmt: skip


def test_a_force_by_the_heading_has_its_harmonics_and_a_constant(columns: Columns) -> None:
    turn = Rotation.from_quat(columns.flight.motion[columns.rows, 3:7])
    nose = turn.apply([1.0, 0.0, 0.0])
    heading = np.arctan2(nose[:, 1], nose[:, 0])
    wanted = np.stack(
        [np.cos(heading), np.sin(heading), np.cos(2 * heading), np.sin(2 * heading),
         np.ones(len(heading))], axis=1,
    )  # fmt: skip
    force = columns.select('yaw by heading')
    np.testing.assert_allclose(force[:, 5], columns.floor[5] * wanted, atol=1e-12)
    np.testing.assert_array_equal(force[:, :5], 0.0)


def test_a_level_force_by_place_does_not_turn_with_the_vehicle(columns: Columns) -> None:
    """In the map, half of its terms point along x and half along y, with the same strength."""
    turn = Rotation.from_quat(columns.flight.motion[columns.rows, 3:7])
    force = columns.select('level force by place')
    half = force.shape[2] // 2
    for k in (0, half // 2):
        first, second = (turn.apply(force[:, :3, j]) for j in (k, half + k))
        np.testing.assert_allclose(first[:, 1:], 0.0, atol=1e-12)
        np.testing.assert_allclose(second[:, [0, 2]], 0.0, atol=1e-12)
        np.testing.assert_allclose(first[:, 0], second[:, 1], atol=1e-12)
        assert 0.0 <= first[:, 0].min() < first[:, 0].max() <= columns.floor[0]


def test_columns_of_wrenches_are_what_the_wrenches_do(columns: Columns) -> None:
    """Each moves states and readings as the unexplained wrench does, and about any strength."""
    flight, strengths = columns.flight, np.array([2.0, -1.0])
    wrenches = np.zeros((len(flight.motion), 6, 2))
    wrenches[:, 2, 0], wrenches[:, 4, 1] = 0.3, 0.02
    more = flight.add_wrenches(wrenches, strengths)
    np.testing.assert_allclose(more.moved[:, :, 0], 0.3 * flight.push[:, :, 2], rtol=1e-12)
    np.testing.assert_allclose(more.read_moved[:, :, 1], 0.02 * flight.felt[:, :, 4], rtol=1e-12)
    acting = wrenches @ strengths
    np.testing.assert_allclose(
        more.defect, flight.defect + np.einsum('nka,na->nk', flight.push, acting), rtol=1e-12
    )
    left = flight.left - np.einsum('nma,na->nm', flight.felt, acting)
    np.testing.assert_allclose(more.left, left, rtol=1e-12)


def test_the_columns_are_those_of_the_groups(columns: Columns) -> None:
    assert sum(one.terms for one in columns.groups) == columns.wrenches.shape[2]
    assert all(isinstance(one, ForceGroup) and one.terms > 1 for one in columns.groups)
