# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What can be turned about each shipped vehicle, and rotations against scipy."""

from dataclasses import replace
import math

from lta_config.files import list_shipped_names
from lta_discovery.model.candidates import DESIGN, NO_CANDIDATE
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter, list_free_parameters
from lta_discovery.model.quaternions import (
    quaternion_conjugate,
    quaternion_exponential,
    quaternion_logarithm,
    quaternion_product,
    rotate_vectors,
    rotation_matrix,
)
from lta_model.effects import EFFECTS
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest
from scipy.spatial.transform import Rotation


@pytest.mark.parametrize('name', list_shipped_names('vehicles'))
def test_every_knob_of_every_vehicle_builds_a_model_either_side_of_its_step(name: str) -> None:
    nominal = NominalVehicle.from_vehicle(load_vehicle(name))
    found = list_free_parameters(nominal)
    names = [knob.name for knob in found]
    assert len(set(names)) == len(names)
    for knob in found:
        assert knob.low <= 0.0 <= knob.high
        assert knob.tolerance >= 0.0
        knob.apply_to(nominal, knob.step_at(0.0)).build_model()
    assert {'vehicle.mass', 'net_lift.force', 'command_delay.delay'} <= set(names)


def test_a_candidate_is_as_large_as_its_effect_declares(
    gtmab: tuple[NominalVehicle, list[FreeParameter]],
) -> None:
    declared = {
        f'{effect}.{parameter.name}': parameter.spread
        for effect, kind in EFFECTS.items()
        for parameter in kind.parameters
    }
    for knob in gtmab[1]:
        if knob.typical and knob.name in declared:
            assert knob.typical == declared[knob.name]
            assert knob.name.split('.')[0] not in DESIGN
            assert knob.name not in NO_CANDIDATE


def test_what_is_excluded_is_registered() -> None:
    declared = {
        f'{effect}.{parameter.name}' for effect, k in EFFECTS.items() for parameter in k.parameters
    }
    assert set(EFFECTS) >= DESIGN
    assert declared >= NO_CANDIDATE


def test_the_mass_moves_with_the_trim_kept(
    gtmab: tuple[NominalVehicle, list[FreeParameter]],
) -> None:
    nominal, turned = gtmab
    mass = next(knob for knob in turned if knob.name == 'vehicle.mass')
    heavier = mass.apply_to(nominal, 0.01)
    assert heavier.mass == pytest.approx(math.exp(0.01) * nominal.mass)
    assert heavier.mass - heavier.displaced == pytest.approx(nominal.mass - nominal.displaced)


def test_a_second_turn_adds_to_the_first(
    gtmab: tuple[NominalVehicle, list[FreeParameter]],
) -> None:
    # The columns of a fit take that for granted: thrust, mass and drag cancel only to rounding.
    nominal, turned = gtmab
    for knob in turned:
        size = 0.5 * min(knob.tolerance or knob.typical, knob.high) or -0.5 * knob.typical
        twice, once = (
            knob.apply_to(knob.apply_to(nominal, size), size).build_replay_rows(),
            knob.apply_to(nominal, 2.0 * size).build_replay_rows(),
        )
        np.testing.assert_allclose(twice.body, once.body, rtol=1e-9, atol=1e-15)
        np.testing.assert_allclose(twice.actuators, once.actuators, rtol=1e-9, atol=1e-15)


def test_a_step_stays_within_the_bounds_on_either_side() -> None:
    down = FreeParameter('k', 's', {('e', 'k'): 1.0}, -0.1, -0.1, low=-1.0, high=1.0)
    assert down.step_at(0.0) == -0.1
    assert down.step_at(-1.0) == 0.1
    up = replace(down, step=0.1, fine=0.1)
    assert up.step_at(0.5) == 0.1
    assert up.step_at(1.0) == -0.1


RNG = np.random.default_rng(1)
AXIS = np.array([0.6, 0.0, 0.8])
A, B = RNG.normal(size=(2, 50, 3))


def test_operations_are_those_of_scipy() -> None:
    a, b = Rotation.from_rotvec(A), Rotation.from_rotvec(B)
    qa, qb = quaternion_exponential(A), quaternion_exponential(B)
    np.testing.assert_allclose(rotation_matrix(qa), a.as_matrix(), atol=1e-12)
    np.testing.assert_allclose(
        rotation_matrix(quaternion_product(qa, qb)), (a * b).as_matrix(), atol=1e-12
    )
    np.testing.assert_allclose(
        rotate_vectors(quaternion_conjugate(qa), B), a.inv().apply(B), atol=1e-12
    )
    turn = quaternion_logarithm(quaternion_product(quaternion_conjugate(qa), qb))
    np.testing.assert_allclose(turn, (a.inv() * b).as_rotvec(), atol=1e-10)


def test_small_rotations_keep_their_size() -> None:
    tiny = np.array([[1e-9, -2e-9, 3e-9], [0.0, 0.0, 0.0], [1e-5, 0.0, 0.0]])
    np.testing.assert_allclose(
        quaternion_logarithm(quaternion_exponential(tiny)), tiny, rtol=1e-7, atol=1e-16
    )


def test_a_turn_by_pi_keeps_its_axis_and_a_larger_one_gets_the_opposite_axis() -> None:
    np.testing.assert_allclose(quaternion_logarithm(np.array([0.6, 0.0, 0.8, 0.0])), np.pi * AXIS)
    turned = quaternion_logarithm(quaternion_exponential((np.pi + 0.1) * AXIS))
    np.testing.assert_allclose(turned, -(np.pi - 0.1) * AXIS)
