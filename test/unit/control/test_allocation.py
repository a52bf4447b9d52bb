# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Allocation on GT-MAB: exact where it can be, and what gives way first where it cannot."""

from lta_control.allocation import (
    allocate,
    create_working_array,
    NO_ROTORS,
    pad_to_slots,
    Rotors,
    thrusts_to_duties,
)
from lta_control.vehicle_parameters import build_rotors
from lta_model.vehicle import load_vehicle, Vehicle
import pytest

ROTORS = build_rotors(load_vehicle('gtmab'))
FULL = 0.0915 + 0.0677
REST = NO_ROTORS


def give(surge=0.0, heave=0.0, yaw=0.0, rotors=ROTORS, start=REST):
    return allocate(rotors, (surge, 0.0, heave, 0.0, 0.0, yaw), start, create_working_array())


def test_the_rotors_of_the_file():
    assert ROTORS.number == 4
    assert ROTORS.low == NO_ROTORS
    assert ROTORS.high == pytest.approx(pad_to_slots((FULL,) * 4), rel=1e-12)
    assert (ROTORS.a, ROTORS.b) == (pad_to_slots((0.0915,) * 4), pad_to_slots((0.0677,) * 4))
    assert ROTORS.allocation[0] == (0.0, 0.013, 0.961, 0.188, 0.0, 0.0)
    assert ROTORS.allocation[4:] == ((0.0,) * 6,) * 4
    assert ROTORS.allocation[3] == (0.981, -0.011, -0.061, 0.002, -0.403, 0.1)


def test_what_can_be_given_is_given():
    # By hand: t_f = surge / (2 * 0.981) -+ yaw / (2 * 0.1), t_v = (heave + 0.122 t_f) / 1.922.
    thrusts, given = give(surge=0.04, heave=0.05, yaw=0.001)
    forward = 0.04 / 1.962
    up = (0.05 + 0.122 * forward) / 1.922
    assert thrusts[2:4] == pytest.approx((forward - 0.005, forward + 0.005), rel=1e-7)
    assert sum(thrusts[:2]) == pytest.approx(2 * up, rel=1e-7)
    assert given[0] == pytest.approx(0.04, rel=1e-7)
    assert given[2] == pytest.approx(0.05, rel=1e-7)
    assert given[5] == pytest.approx(0.001, rel=1e-6)


def test_what_gives_way_by_hand():
    """With one rotor at full, the other forward rotor weighs surge (1) against yaw (1000)."""
    thrusts, _ = give(surge=0.35, yaw=0.012)
    t4 = FULL
    # Minimise (0.981 (t3 + t4) - 0.35)^2 + 1000 (0.1 (t4 - t3) - 0.012)^2 over t3; heave
    # can follow, and the 0.002 m of roll are the vertical rotors' as well.
    t3 = 0.981 * (0.35 - 0.981 * t4) + 1000.0 * 0.1 * (0.1 * t4 - 0.012)
    t3 /= 0.981**2 + 1000.0 * 0.1**2
    assert thrusts[2] == pytest.approx(t3, rel=1e-6)


def test_the_strongest_push_downwards():
    vehicle = load_vehicle('gtmab')
    assert build_rotors(vehicle).lowest_heave == 0.0
    reversing = {
        name: rotor.model_copy(update={'reversible': True})
        for name, rotor in vehicle.file.rotors.items()
    }
    both = Vehicle(vehicle.file.model_copy(update={'rotors': reversing}))
    assert build_rotors(both).lowest_heave == pytest.approx(-2 * 0.961 * FULL, rel=1e-12)


def duties(rotors, thrusts):
    return thrusts_to_duties(rotors, thrusts, create_working_array())


def one_duty(thrust, a, b):
    """Return the duty of a single rotor with a thrust curve."""
    rotors = ROTORS._replace(number=1, a=pad_to_slots((a,)), b=pad_to_slots((b,)))
    return duties(rotors, pad_to_slots((thrust,)))[0]


@pytest.mark.parametrize('u', [-1.0, -0.4, -1e-9, 0.0, 1e-12, 0.02, 0.5, 1.0])
def test_duty_is_the_inverse_of_the_thrust_curve(u):
    thrust = (0.0915 * abs(u) + 0.0677) * u
    assert one_duty(thrust, 0.0915, 0.0677) == pytest.approx(u, rel=1e-12)


def test_eight_rotors_share_what_they_are_asked():
    """Four that point up at the corners and four forward: heave, surge and yaw by symmetry."""
    corners = ((0.2, 0.2), (0.2, -0.2), (-0.2, -0.2), (-0.2, 0.2))
    up = tuple((0.0, 0.0, 1.0, y, -x, 0.0) for x, y in corners)
    ahead = tuple((1.0, 0.0, 0.0, 0.0, 0.0, -y) for _, y in corners)
    eight = Rotors(8, up + ahead, NO_ROTORS, (0.2,) * 8, 0.0, (0.1,) * 8, (0.1,) * 8)
    thrusts, given = give(surge=0.2, heave=0.4, yaw=0.008, rotors=eight)
    assert thrusts[:4] == pytest.approx((0.1,) * 4, rel=1e-7)
    # A yaw of 0.008 N m is 0.01 N more on each of the two on the right, and less on the left.
    assert thrusts[4:] == pytest.approx((0.04, 0.06, 0.06, 0.04), rel=1e-6)
    assert given == pytest.approx((0.2, 0.0, 0.4, 0.0, 0.0, 0.008), rel=1e-6, abs=1e-9)


def test_reversed_thrust_is_a_ratio_of_each_rotor_and_one_in_unused_slots():
    """For Blimp2b its authors give 45 mN reversed for 40 forward, 25 for 30, and 25 for 45."""
    rotors = build_rotors(load_vehicle('blimp2b'))
    assert rotors.reverse == pytest.approx((1.125, 25 / 30, 25 / 45, *(1.0,) * 5))
    # Half of the reversed limit needs the negative of the duty for half of the forward limit.
    half = tuple(0.5 * low for low in rotors.low)
    forward = thrusts_to_duties(
        rotors, tuple(0.5 * high for high in rotors.high), create_working_array()
    )
    assert duties(rotors, half) == pytest.approx([-u for u in forward])
    assert pad_to_slots((0.1,) * 8) == (0.1,) * 8
