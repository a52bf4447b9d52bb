# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The hashes by which boards and vehicle files recognize each other."""

from lta_config.schema.crazyflie_file import hash_airframe, hash_diodes, load_crazyflie
from lta_config.schema.vehicle_file import load_vehicle_file
import pytest

GTMAB, WIRING = load_vehicle_file('gtmab'), load_crazyflie('gtmab')
ROTORS = GTMAB.rotors


def changed_rotor(**change):
    rotor = ROTORS['up_left'].model_copy(update=change)
    return GTMAB.model_copy(update={'rotors': {**ROTORS, 'up_left': rotor}})


def swapped():
    motors = dict(WIRING.motors)
    motors['m1'], motors['m2'] = motors['m2'], motors['m1']
    return WIRING.model_copy(update={'motors': motors})


@pytest.mark.parametrize(
    ('vehicle', 'wiring'),
    [
        (GTMAB, swapped()),
        (GTMAB.model_copy(update={'name': 'other'}), WIRING),
        (changed_rotor(position=ROTORS['up_right'].position), WIRING),
        (changed_rotor(axis=ROTORS['forward_left'].axis), WIRING),
        (changed_rotor(reversible=True), WIRING),
    ],
)
def test_what_would_turn_a_wrong_motor_changes_the_hash(vehicle, wiring):
    assert hash_airframe(vehicle, wiring) != hash_airframe(GTMAB, WIRING)


def test_masses_and_limits_may_be_measured_anew():
    lighter = GTMAB.model_copy(update={'layers': {}, 'about': 'trimmed'})
    assert hash_airframe(lighter, WIRING) == hash_airframe(GTMAB, WIRING)
    assert hash_diodes(lighter) == hash_diodes(GTMAB)


def test_another_number_of_diodes_changes_the_hash():
    diodes = GTMAB.sensors.diodes.model_copy(update={'count': 16})
    sensors = GTMAB.sensors.model_copy(update={'diodes': diodes})
    assert hash_diodes(GTMAB.model_copy(update={'sensors': sensors})) != hash_diodes(GTMAB)
