# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Control laws by name: they hold a vehicle by its trim, and refuse what they cannot fly."""

import math

from lta_config.constants import STANDARD_GRAVITY
from lta_config.errors import BadInput
from lta_config.files import list_shipped_names
from lta_control.allocation import create_working_array
from lta_control.laws import (
    check_onboard_law,
    find_control_law,
    LAWS,
    load_gains,
    load_law_gains,
    load_onboard_law,
    vehicle_law_name,
)
from lta_control.laws.lateral import mix_thrusts
from lta_control.laws.protocol import Feedback, LawInputs
from lta_control.motion import (
    ControlMotion,
    quaternion_from_angles,
    rotate_level_to_world,
    rotation_between,
    Setpoint,
    to_body,
    to_world,
)
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

VEHICLES = list_shipped_names('vehicles')
DT = 0.01


def ready(name, law_name=None, gains=None):
    """Return a vehicle, its law, and what the law knows."""
    vehicle = load_vehicle(name)
    made = find_control_law(law_name or vehicle.file.control.law)
    found = load_law_gains(made.gains, gains or vehicle.file.control.gains)
    return vehicle, made, made.build_constants(found, vehicle)


def once(made, constants, motion, setpoint):
    return made.step(
        constants, made.start, LawInputs(motion, setpoint, DT), create_working_array()
    )


def thrusts(vehicle, duties):
    """Return thrusts along the forward columns, by hand [N]."""
    found = []
    for rotor, duty in zip(vehicle.rotors, duties, strict=False):
        size = rotor.a * duty * duty + rotor.b * abs(duty)
        scale = (
            1.0
            if duty >= 0.0
            else np.dot(rotor.reverse, rotor.column) / np.dot(rotor.column, rotor.column)
        )
        found.append(math.copysign(size, duty) * scale)
    return np.array(found)


def wrench(vehicle, duties):
    """Return force and moment about the hull centre, jets that collide included."""
    newtons = thrusts(vehicle, duties)
    total = np.array(vehicle.allocation).T @ newtons
    coupling = vehicle.file.aero.coupling
    if coupling:
        total[:3] += np.array(coupling.force.vector) * max(0.0, newtons.min())
    return total


def test_every_vehicle_names_a_law_and_gains_that_fit():
    laws = {load_vehicle(name).file.control.law for name in VEHICLES}
    assert laws == set(LAWS)
    for name in VEHICLES:
        ready(name)


@pytest.mark.parametrize('name', ['beavis', 'sblimp', 'skye', 'multirotor', 'blimp2b'])
def test_without_error_the_rotors_carry_the_weight_and_nothing_else(name):
    vehicle, made, constants = ready(name)
    height = vehicle.hull_height_on_floor if name == 'blimp2b' else 2.0
    motion = ControlMotion(position=(0.0, 0.0, height))
    after = once(made, constants, motion, Setpoint(height, 0.0, 0.0))
    total = wrench(vehicle, after.command.duties)
    weight = vehicle.heaviness * STANDARD_GRAVITY
    assert total[2] == pytest.approx(weight, rel=1e-6, abs=1e-6)
    assert total[[0, 1, 5]] == pytest.approx(0.0, abs=1e-6)


def test_height_comes_before_speed_where_four_jets_cannot_do_both():
    vehicle, _, constants = ready('beavis')
    newtons, share, _ = mix_thrusts(constants, 0.1, 0.3, 0.0, 0.0)
    assert 0.0 < share < 1.0
    assert max(newtons) == pytest.approx(vehicle.rotors[0].full_thrust)
    total = np.array(vehicle.allocation).T @ np.array(newtons[:4])
    total[2] += vehicle.file.aero.coupling.force.vector[2] * min(newtons[:4])
    assert total[2] == pytest.approx(0.1)


@pytest.mark.parametrize(
    ('name', 'law_name', 'sentence'),
    [
        ('gtmab', 'lateral', 'needs four rotors whose jets collide, which gtmab does not have'),
        ('gtmab', 'glide', 'needs two propellers and a moving mass'),
    ],
)
def test_a_vehicle_of_another_kind_is_refused(name, law_name, sentence):
    vehicle, made = load_vehicle(name), find_control_law(law_name)
    with pytest.raises(BadInput, match=sentence):
        made.build_constants(
            load_law_gains(made.gains, {'lateral': 'beavis', 'glide': 'rgblimp'}[law_name]),
            vehicle,
        )


def test_rotors_that_push_straight_outwards_cannot_turn_beavis(tmp_path):
    """The 15 degrees by which they are turned are a guess; without them there is no yaw at all."""
    vehicle = load_vehicle('beavis')
    aero = vehicle.file.aero
    straight = {
        name: column.model_copy(update={'moment': column.moment.model_copy(
            update={'value': (*column.moment.vector[:2], 0.0)})})
        for name, column in aero.thrust_allocation.items()
    }  # fmt: skip
    file = vehicle.file.model_copy(
        update={'aero': aero.model_copy(update={'thrust_allocation': straight})}
    )
    made = find_control_law('lateral')
    with pytest.raises(BadInput, match='cannot produce forward force, sideways force and yaw'):
        made.build_constants(load_law_gains(made.gains, 'beavis'), type(vehicle)(file))


def test_a_law_that_needs_a_tracker_is_refused_aboard():
    vehicle = load_vehicle('skye')
    assert vehicle_law_name(vehicle) == 'omnidirectional'
    with pytest.raises(BadInput, match='needs a position tracker'):
        load_onboard_law('omnidirectional', vehicle)


@pytest.mark.parametrize('name', list_shipped_names('vehicles'))
def test_a_vehicle_flies_by_its_own_sensors_unless_its_law_needs_a_tracker(name):
    vehicle = load_vehicle(name)
    if find_control_law(vehicle_law_name(vehicle)).feedback is Feedback.TRACKER:
        with pytest.raises(BadInput, match='needs a position tracker'):
            check_onboard_law(vehicle)
    else:
        check_onboard_law(vehicle)


def test_aboard_a_law_flies_by_the_gains_of_the_vehicle_and_the_cascade_by_those_of_the_node():
    vehicle = load_vehicle('beavis')
    law, constants = load_onboard_law('lateral', vehicle, load_gains('gtmab'))
    assert law.name == 'lateral'
    assert constants.gains == load_law_gains(law.gains, 'beavis')
    law, constants = load_onboard_law('cascade', vehicle, load_gains('gtmab'))
    assert (law.name, constants.gains) == ('cascade', load_gains('gtmab'))


def test_frames_agree_with_scipy():
    roll, pitch, yaw = 0.3, -0.5, 2.1
    q = quaternion_from_angles(roll, pitch, yaw)
    known_turn = Rotation.from_euler('ZYX', [yaw, pitch, roll])
    assert q == pytest.approx(known_turn.as_quat(canonical=True), abs=1e-12)
    v = (0.2, -1.1, 0.7)
    assert to_world(q, v) == pytest.approx(known_turn.apply(v))
    assert to_body(q, v) == pytest.approx(known_turn.inv().apply(v))
    small = Rotation.from_rotvec([0.002, -0.001, 0.003])
    there = tuple((known_turn * small).as_quat().tolist())
    assert rotation_between(q, there) == pytest.approx((0.002, -0.001, 0.003), rel=1e-5)
    other_sign = tuple(-part for part in there)  # the same attitude
    assert rotation_between(q, other_sign) == pytest.approx((0.002, -0.001, 0.003), rel=1e-5)
    assert rotate_level_to_world(math.pi / 2, 2.0, 1.0) == pytest.approx((-1.0, 2.0))


def test_each_law_weights_the_axes_of_its_allocation():
    """The multirotor's moments count by levers: 1 / 0.01^2 about x and y, 1 / 0.1^2 about z."""
    weights = {name: ready(name)[2].rotors.weights for name in ('multirotor', 'skye', 'sblimp')}
    assert weights['multirotor'] == pytest.approx((0.0, 0.0, 1.0, 1e4, 1e4, 1e2))
    assert weights['skye'] == (1.0,) * 6
    height = ready('sblimp')[2].gains.height_weight
    assert weights['sblimp'] == (1.0, 1.0, height, 0.0, 0.0, 1000.0)


def test_a_tilted_multirotor_at_most_doubles_its_thrust():
    """The thrust is weight / cos(tilt), but for cos(80 deg) = 0.17 twice, not six times, it."""
    vehicle, made, constants = ready('multirotor')
    demands = []
    for tilt in (0.0, math.radians(59.0), math.radians(80.0)):
        motion = ControlMotion((0.0, 0.0, 2.0), quaternion_from_angles(0.0, tilt, 0.0))
        after = once(made, constants, motion, Setpoint(2.0, 0.0, 0.0))
        newtons = sum(after.thrusts) * vehicle.allocation[0][2]
        demands.append((newtons - after.missing) / constants.weight)
    assert demands == pytest.approx([1.0, 1.0 / math.cos(math.radians(59.0)), 2.0], rel=1e-6)
