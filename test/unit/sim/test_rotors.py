# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""From a duty to newtons, against published benches, and what jets do to the hull."""

from lta_model.effects.commands import COMMAND_DELAY
from lta_model.effects.motors import (
    BATTERY_SAG,
    THRUST_CURVE,
    THRUST_POLYNOMIAL,
)
from lta_model.effects.protocol import AXES, CHANNEL_SIZES, VehicleMotion
from lta_model.effects.rotors import ROTOR_ENVELOPE_INTERACTION, ROTOR_MISALIGNMENT, ROTOR_THRUST
from lta_model.state import ACTUATORS, BODY, COMMAND, ROTOR, ROTOR_PLACE, SURROUNDINGS, VOLTAGE
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

# crazyflie-firmware docs/functional-areas/pwm-to-thrust.md, 2015: duty [%], voltage under load
# [V], thrust of all four motors [g].
BENCH = np.array([
    (0.0, 4.01, 0.0), (6.25, 3.98, 1.6), (12.5, 3.95, 4.8), (18.75, 3.92, 7.9),
    (25.0, 3.88, 10.9), (31.25, 3.84, 13.9), (37.5, 3.80, 17.3), (43.25, 3.76, 21.0),
    (50.0, 3.71, 24.4), (56.25, 3.67, 28.6), (62.5, 3.65, 32.8), (68.75, 3.62, 37.3),
    (75.0, 3.56, 41.7), (81.25, 3.48, 46.0), (87.5, 3.40, 51.9), (93.75, 3.30, 57.9),
])  # fmt: skip
DUTY, VOLTS = BENCH[:, 0] / 100.0, BENCH[:, 1]
NEWTONS = BENCH[:, 2] * 9.80665e-3 / 4.0

# crazyflie-firmware 2a18fc29, platform_defaults_cf2.h: c_0 to c_3, least and greatest thrust [N].
CUBIC = {
    '2.1+': (-0.024765, 0.065238, -0.026793, 0.0067768),
    'legacy': (-0.014831, 0.047245, -0.018474, 0.0059609),
    'upgrade kit': (0.0067281, 0.0101156, 0.0102632, 0.0028359),
}
LEAST = {'2.1+': 0.012817578, 'legacy': 0.012817578, 'upgrade kit': 0.019226368}
MOST = {'2.1+': 0.12, 'legacy': 0.12, 'upgrade kit': 0.18}
LINEAR_TO = {'2.1+': 0.774, 'legacy': 0.753, 'upgrade kit': 0.679}

# The older firmware's parabola, a and b [N].
PARABOLA = (0.091492681, 0.067673604)


def around(voltage=0.0):
    surroundings = [0.0] * SURROUNDINGS
    surroundings[VOLTAGE] = voltage
    return tuple(surroundings)


def through(effect, p, value, voltage=0.0):
    return effect.output(p, (), value, around(voltage))


def cubic(which, duty, nominal=4.2):
    return through(THRUST_POLYNOMIAL, (nominal, LINEAR_TO[which], *CUBIC[which]), duty)


def rms(error):
    return float(np.sqrt(np.mean(np.square(error))))


def test_thrust_follows_the_voltage():
    # A duty of 0.6 at 3.15 V is the mean voltage of 0.45 at 4.2 V.
    assert through(BATTERY_SAG, (4.2, 1.0), 0.6, 3.15) == pytest.approx(0.45, rel=1e-15)
    assert through(BATTERY_SAG, (4.2, 1.0), -0.6, 3.15) == pytest.approx(-0.45, rel=1e-15)
    full = through(THRUST_CURVE, PARABOLA, 0.6, 4.2)
    sagged = through(THRUST_CURVE, PARABOLA, through(BATTERY_SAG, (4.2, 1.0), 0.6, 3.15), 3.15)
    assert full == pytest.approx(0.0735415, rel=1e-5)
    assert sagged == pytest.approx(0.0489804, rel=1e-5)


def test_an_unknown_voltage_changes_nothing():
    assert through(BATTERY_SAG, (4.2, 1.0), 0.6, 0.0) == 0.6
    assert through(BATTERY_SAG, (0.0, 1.0), 0.6, 3.15) == 0.6


def test_sensitivity_gives_the_exponent_seen_in_flights():
    """A force per duty of V^0.7 is a sensitivity of 0.7 over the curve's d ln T / d ln u."""
    a, b = PARABOLA
    u, nominal = 0.6, 3.8
    steep = (2.0 * a * u + b) / (a * u + b)
    assert steep == pytest.approx(1.448, abs=1e-3)
    for ratio, most in ((0.99, 1e-4), (0.85, 0.006)):
        duty = through(BATTERY_SAG, (nominal, 0.7 / steep), u, ratio * nominal)
        force = through(THRUST_CURVE, PARABOLA, duty) / through(THRUST_CURVE, PARABOLA, u)
        assert force == pytest.approx(ratio**0.7, rel=most)


def test_no_sensitivity_reverses_a_rotor():
    assert through(BATTERY_SAG, (4.2, 2.0), 0.6, 0.5) == 0.0


@pytest.mark.parametrize('which', CUBIC)
def test_cubics_are_the_firmware_s_from_least_to_greatest_thrust(which):
    """`linear_to` is where the firmware starts; its greatest thrust needs no full cell."""
    at_start = cubic(which, LINEAR_TO[which] / 4.2)
    assert at_start == pytest.approx(LEAST[which], rel=2e-3)
    assert cubic(which, 2.7 / 4.2) < MOST[which] < cubic(which, 3.2 / 4.2)
    assert cubic(which, 0.0) == 0.0
    assert cubic(which, 0.5 * LINEAR_TO[which] / 4.2) == pytest.approx(0.5 * at_start, rel=1e-12)
    rising = [cubic(which, float(duty)) for duty in np.linspace(-1.0, 1.0, 401)]
    assert np.all(np.diff(rising) > 0.0)


@pytest.mark.parametrize(
    ('changes', 'words'),
    [
        ({}, ''),
        ({'voltage': 4.2, 'c_0': -0.02, 'c_1': 0.06}, ''),
        ({'voltage': 4.2, 'c_0': 0.0067, 'linear_to': 0.68}, ''),
        ({'c_1': 0.06}, 'set voltage to the nominal'),
        ({'voltage': 4.2, 'c_0': 0.0067}, 'set linear_to to a positive voltage'),
    ],
)
def test_a_cubic_must_be_that_of_a_motor(changes, words):
    values = {parameter.name: parameter.null for parameter in THRUST_POLYNOMIAL.shared}
    objection = THRUST_POLYNOMIAL.check({**values, **changes})
    assert objection.startswith(words) if not words else words in objection


def test_curves_against_the_bench():
    """Only the parabola is near this bench; the cubics belong to other motors and propellers."""
    parabola = [through(THRUST_CURVE, PARABOLA, float(duty)) for duty in DUTY]
    assert 1e3 * rms(parabola - NEWTONS) == pytest.approx(2.90, abs=0.005)
    assert 1e3 * np.max(abs(parabola - NEWTONS)) == pytest.approx(5.10, abs=0.005)
    off = {}
    for which in CUBIC:
        thrusts = [
            through(THRUST_POLYNOMIAL, (float(volts), LINEAR_TO[which], *CUBIC[which]), float(u))
            for u, volts in zip(DUTY, VOLTS, strict=True)
        ]
        off[which] = 1e3 * rms(thrusts - NEWTONS)
    assert off == pytest.approx({'2.1+': 12.15, 'legacy': 9.38, 'upgrade kit': 39.38}, abs=0.01)


def test_commands_are_late():
    assert CHANNEL_SIZES[COMMAND_DELAY.channel] == 1
    assert COMMAND_DELAY.reading((0.03,), (12.5,), 12.5) == (12.47,)
    assert COMMAND_DELAY.reading((0.0,), (12.5,), 12.5) == (12.5,)


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
