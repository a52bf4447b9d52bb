# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What becomes of a duty on its way to newtons, by hand and against published benches."""

from lta_model.effects.commands import COMMAND_DELAY
from lta_model.effects.motors import (
    BATTERY_SAG,
    THRUST_CURVE,
    THRUST_POLYNOMIAL,
)
from lta_model.effects.protocol import CHANNEL_SIZES
from lta_model.state import SURROUNDINGS, VOLTAGE
import numpy as np
import pytest

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
