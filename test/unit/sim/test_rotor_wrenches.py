# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What rotors do to the hull beyond B: tilted axes, reversed jets and jets that collide."""

from lta_model.effects.protocol import AXES, VehicleMotion
from lta_model.effects.rotors import ROTOR_ENVELOPE_INTERACTION, ROTOR_MISALIGNMENT, ROTOR_THRUST
from lta_model.state import ACTUATORS, BODY, COMMAND, ROTOR, ROTOR_PLACE, SURROUNDINGS
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

LEVEL = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
NO = (0.0, 0.0, 0.0)

# Thrust of a Crazyflie motor at full duty [N].
FULL = 0.1592

# Wrench per newton of thrust about the hull centre, from simulated actuator disks (OpenFOAM 1912):
# GT-MAB's left upward rotor, and BEAVIS's first rotor, tangential or radial, four of each by turns
# of 90 degrees about the vertical.
UP_LEFT = (0.0, 0.013, 0.961, 0.188, 0.0, 0.0)
RADIAL = (0.980, 0.001, -0.039, -0.001, -0.401, 0.0)


def seen(rotors=()):
    body = np.zeros(BODY)
    for i, (place, axis) in enumerate(rotors):
        first = ROTOR_PLACE + ROTOR * i
        body[first : first + ROTOR] = (*place, *axis)
    given = (NO, LEVEL, NO, NO, NO, tuple(body.tolist()), (0.0,) * COMMAND)
    return VehicleMotion(*given, (0.0,) * SURROUNDINGS)


def numbers(effect, given):
    names = [parameter.name for parameter in effect.parameters]
    assert set(given) <= set(names)
    return tuple(given.get(p.name, p.null) for p in effect.parameters)


def eight(*thrusts):
    return (*thrusts, *[0.0] * (ACTUATORS - len(thrusts)))


def four(column):
    """Return the columns of a rotor and of its three turns by 90 degrees, by parameter name."""
    named = {}
    for i in range(4):
        turn = Rotation.from_euler('z', 90.0 * i, degrees=True)
        turned = (*turn.apply(column[:3]), *turn.apply(column[3:]))
        named |= {f'{axis}_{i + 1}': float(v) for axis, v in zip(AXES, turned, strict=True)}
    return named


def total(columns, interaction, *thrusts):
    linear = ROTOR_THRUST.wrench(numbers(ROTOR_THRUST, columns), (), seen(), eight(*thrusts))
    p = numbers(ROTOR_ENVELOPE_INTERACTION, interaction)
    return np.add(linear, ROTOR_ENVELOPE_INTERACTION.wrench(p, (), seen(), eight(*thrusts)))


def test_a_reversed_rotor_below_a_balloon_loses_three_quarters():
    # 1 N down gives 0.23 N sideways, -0.252 N and -0.072 N m: per newton of signed thrust the
    # opposite, and of that the difference to the forward column.
    reverse = {'sway_1': -0.23 - 0.013, 'heave_1': 0.252 - 0.961, 'roll_1': 0.072 - 0.188}
    columns = {f'{axis}_1': v for axis, v in zip(AXES, UP_LEFT, strict=True)}
    np.testing.assert_allclose(total(columns, reverse, 1.0), UP_LEFT, atol=1e-15)
    backward = total(columns, reverse, -1.0)
    np.testing.assert_allclose(backward, (0.0, 0.23, -0.252, -0.072, 0.0, 0.0), atol=1e-15)
    np.testing.assert_allclose(total(columns, reverse, -0.5), 0.5 * backward, atol=1e-15)


# Radial rotors with the jets inward: four together +0.911 where the singles sum to -0.156, and
# with the jets outward -0.112, of which each rotor is given a quarter.
BEAVIS = {
    **{f'heave_{i}': 0.112 / 4.0 + 0.039 for i in (1, 2, 3, 4)},
    **{f'share_{i}': 1.0 for i in (1, 2, 3, 4)},
    'together_heave': 0.911 + 4.0 * 0.039,
}


def test_four_radial_rotors_lift():
    together = total(four(RADIAL), BEAVIS, 1.0, 1.0, 1.0, 1.0)
    np.testing.assert_allclose(together, (0.0, 0.0, 0.911, 0.0, 0.0, 0.0), atol=1e-12)
    assert total(four(RADIAL), BEAVIS, *[FULL] * 4)[2] == pytest.approx(0.145, abs=5e-4)
    linear = total(four(RADIAL), {}, 1.0, 1.0, 1.0, 1.0)
    assert linear[2] == pytest.approx(-0.156, abs=1e-12)
    assert total(four(RADIAL), BEAVIS, 1.0, 1.0, 1.0, 0.0)[2] == pytest.approx(-0.117, abs=1e-12)


def test_the_weakest_of_those_that_take_part_decides():
    p = numbers(ROTOR_ENVELOPE_INTERACTION, {'together_yaw': 2.0, 'share_2': 1.0, 'share_8': -1.0})
    for second, eighth, weakest in ((0.3, -0.1, 0.1), (0.05, -0.1, 0.05), (0.3, 0.1, 0.0)):
        thrust = (9.0, second, -9.0, 0.0, 0.0, 0.0, 0.0, eighth)
        wrench = ROTOR_ENVELOPE_INTERACTION.wrench(p, (), seen(), thrust)
        assert wrench == (0.0, 0.0, 0.0, 0.0, 0.0, 2.0 * weakest)


@pytest.mark.parametrize(
    ('given', 'words'),
    [
        (BEAVIS, ''),
        ({'heave_3': 0.2}, ''),
        ({**BEAVIS, 'share_1': 0.5}, ''),
        ({'together_heave': 1.0, 'share_1': 1.0}, 'fewer than two rotors'),
        ({'share_1': 1.0, 'share_2': 1.0}, 'set a parameter together_'),
    ],
)
def test_shares_must_mean_something(given, words):
    effect = ROTOR_ENVELOPE_INTERACTION
    names = [parameter.name for parameter in effect.parameters]
    objection = effect.check(dict(zip(names, numbers(effect, given), strict=True)))
    assert (words in objection) if words else objection == ''


AXIS = np.array([0.48, -0.6, 0.64])
ROTORS = (
    ((0.1, 0.2, -0.3), (0.0, 0.0, 1.0)),
    ((0.3, -0.1, -0.4), (1.0, 0.0, 0.0)),
    ((-0.2, 0.1, 0.3), tuple(AXIS)),
    ((0.0, 0.5, 0.1), (0.6, -0.8, 0.0)),
)


def perpendicular(axis):
    """Return the two axes about which a rotor tilts."""
    axis = np.asarray(axis)
    first = np.cross((0.0, 1.0, 0.0) if axis[2] ** 2 > 0.5 else (0.0, 0.0, 1.0), axis)
    first /= np.linalg.norm(first)
    return first, np.cross(axis, first)


@pytest.mark.parametrize('thrust', [0.4, -0.4])
@pytest.mark.parametrize('angle', [0.009, 0.1, 0.2])
def test_tilt_against_the_exact_rotation(angle, thrust):
    """Off by theta^2 / 2 along the axis and theta^3 / 6 across it, of the thrust."""
    for i, (place, axis) in enumerate(ROTORS):
        first, second = perpendicular(axis)
        tilt = angle * np.array([0.6, -0.8])
        turn = Rotation.from_rotvec(tilt[0] * first + tilt[1] * second)
        exact = thrust * (turn.apply(axis) - np.array(axis))
        given = {f'first_{i + 1}': tilt[0], f'second_{i + 1}': tilt[1]}
        thrusts = [0.0] * ACTUATORS
        thrusts[i] = thrust
        p = numbers(ROTOR_MISALIGNMENT, given)
        wrench = ROTOR_MISALIGNMENT.wrench(p, (), seen(ROTORS), tuple(thrusts))
        off = exact - wrench[:3]
        along = np.dot(off, axis)
        assert along == pytest.approx(-thrust * angle**2 / 2.0, rel=angle**2)
        across = np.linalg.norm(off - along * np.array(axis))
        assert across == pytest.approx(abs(thrust) * angle**3 / 6.0, rel=angle**2, abs=1e-15)
        np.testing.assert_allclose(wrench[3:], np.cross(place, wrench[:3]), atol=1e-16)


def test_rotors_that_do_not_exist_have_no_tilt():
    p = (0.1,) * (2 * ACTUATORS)
    assert ROTOR_MISALIGNMENT.wrench(p, (), seen(), (0.5,) * ACTUATORS) == (0.0,) * 6
