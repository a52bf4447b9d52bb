# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A balloon whose lift has grown is held and landed by rotors that push down."""

from lta_config.files import list_shipped_names
from lta_control.allocation import create_working_array, NO_ROTORS
from lta_control.flight_step import has_landed, LandingWatch, STANDSTILL, watch_landing
from lta_control.laws import load_gains
from lta_control.laws.cascade import CascadeLawConstants, CascadeLawMemory, control_step
from lta_control.motion import CascadeMeasurement, Setpoint
from lta_control.vehicle_parameters import build_rotors
from lta_model.vehicle import load_vehicle, Vehicle
import pytest

DT, MASS, DRAG = 0.02, 0.7, 0.36  # s, kg with added mass, N s2/m2: about those of GT-MAB
STANDING, HEIGHT = 0.4, 1.5  # m
LIFT = 0.015  # N: 1.5 g, by warm helium or a dropped load


def with_downward_rotor():
    """Return the rotors of GT-MAB with one more below it, which blows upwards."""
    vehicle = load_vehicle('gtmab')
    up = vehicle.file.rotors['up_left']
    axis = up.axis.model_copy(update={'value': (0.0, 0.0, -1.0)})
    place = up.position.model_copy(update={'value': (0.0, 0.0, -34.35)})
    down = up.model_copy(update={'axis': axis, 'position': place})
    rotors = {**vehicle.file.rotors, 'down': down}
    return build_rotors(Vehicle(vehicle.file.model_copy(update={'rotors': rotors})))


def fly(rotors, gains, setpoints, lift=LIFT, error=0.0, turn=0.0):
    """
    Return heights and duties of a balloon that flies at setpoints [m], each for 30 s.

    Its height reads `error` too high [m], and its nose is `turn` off and does not follow [rad].
    """
    z, climb, memory, scratch = HEIGHT, 0.0, CascadeLawMemory(), create_working_array()
    constants = CascadeLawConstants(gains, rotors, (0.0, 0.09))
    landing = LandingWatch()
    flown = []
    for altitude in setpoints:
        for _ in range(round(30.0 / DT)):
            measured = CascadeMeasurement(z + error, climb, turn, 0.0, 0.0, 0.0, 0.0)
            setpoint = Setpoint(altitude, 0.0, 0.0)
            duties, force = NO_ROTORS, 0.0
            landing = watch_landing(landing, z + error, altitude <= STANDING, DT)
            down = has_landed(z + error, climb, setpoint, STANDING)
            if down or landing.still > STANDSTILL:
                memory = CascadeLawMemory()
            else:
                memory = control_step(constants, memory, measured, setpoint, DT, scratch)
                duties = memory.command.duties
                columns = zip(rotors.allocation, memory.thrusts, strict=True)
                force = sum(column[2] * thrust for column, thrust in columns)
            climb += DT * (lift + force - DRAG * climb * abs(climb)) / MASS
            z += DT * climb
            if z < STANDING:
                z, climb = STANDING, 0.0
            flown.append((z, duties))
    return flown


@pytest.mark.parametrize(
    ('rotors', 'gains'),
    [
        (build_rotors(load_vehicle('blimp2b')), load_gains('blimp2b_cascade')),
        (with_downward_rotor(), load_gains('gtmab')),
    ],
    ids=['reversible', 'downward'],
)
def test_it_is_held_at_its_height_and_lands(rotors, gains):
    flown = fly(rotors, gains, (HEIGHT, STANDING - 0.1))
    held, landing = flown[: len(flown) // 2], flown[len(flown) // 2 :]
    assert held[-1][0] == pytest.approx(HEIGHT, abs=0.1)
    # On the floor the motors stop; it rises and is pushed down again, and stays near the floor
    last = [z for z, _ in landing[-500:]]
    assert min(last) < STANDING + 0.03
    assert max(last) < STANDING + 0.15


@pytest.mark.parametrize(
    'rotors', [build_rotors(load_vehicle('gtmab')), with_downward_rotor()], ids=['up', 'down']
)
@pytest.mark.parametrize('error', [0.05, 0.5])
def test_a_landing_ends_though_the_height_reads_too_high(rotors, error):
    """2 g heavy, as ballasted; on the floor it would turn to its heading and push down."""
    flown = fly(rotors, load_gains('gtmab'), (STANDING - 0.1,), -0.02, error, 0.5)
    landed = next(turn for turn, (z, _) in enumerate(flown) if z == STANDING)
    assert any(flown[landed][1])
    after = flown[landed + round((STANDSTILL + 1.0) / DT) :]
    assert len(after) > 5.0 / DT
    assert not any(any(duties) for _, duties in after)


def test_without_such_a_rotor_it_rises():
    flown = fly(build_rotors(load_vehicle('gtmab')), load_gains('gtmab'), (STANDING - 0.1,))
    assert flown[-1][0] > HEIGHT + 2.0
    assert not any(any(duties) for _, duties in flown[-500:])


def test_the_shipped_vehicles_that_push_down():
    """As the hazard table says."""
    pushing = {
        name: round(-build_rotors(load_vehicle(name)).lowest_heave, 3)
        for name in list_shipped_names('vehicles')
    }
    assert {name for name, force in pushing.items() if force > 0.0} == {'blimp2b', 'skye'}
    assert pushing['blimp2b'] == 0.025
