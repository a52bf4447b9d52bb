# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the firmware of a Crazyflie makes of a duty at the present voltage of its battery."""

from itertools import pairwise

from lta_config.errors import BadInput
from lta_model.effects import initial_memory
from lta_model.effects.motors import BATTERY_COMPENSATION
from lta_model.state import pack_state, SURROUNDINGS, VOLTAGE
from lta_model.vehicle import load_vehicle
from lta_sim.kernels.kernel import advance, evaluate_model
import numpy as np
import pytest

from .changed_vehicle import build

NOMINAL = 3.7
# crazyflie-firmware 2026.08, platform_defaults_cf2.h: full and least thrust of a motor [N], and
# its cubic.
FIRMWARE = {
    '2.1+': (0.12, 0.0128176, -0.0247654, 0.0652379, -0.0267925, 0.00677679),
    'legacy': (0.12, 0.0128176, -0.0148307, 0.0472447, -0.0184736, 0.00596092),
    'upgrade kit': (0.18, 0.0192264, 0.00672813, 0.0101156, 0.0102632, 0.00283586),
}
NAMES = ('full', 'least', 'c_0', 'c_1', 'c_2', 'c_3')


def around(volts):
    surroundings = [0.0] * SURROUNDINGS
    surroundings[VOLTAGE] = volts
    return tuple(surroundings)


def pwm(duty, volts=NOMINAL, which='2.1+', nominal=NOMINAL):
    return BATTERY_COMPENSATION.output((nominal, *FIRMWARE[which]), (), duty, around(volts))


def cubic(mean, which='2.1+'):
    """Return the thrust at a mean voltage of a motor [N]."""
    _, _, c_0, c_1, c_2, c_3 = FIRMWARE[which]
    return c_0 + c_1 * mean + c_2 * mean**2 + c_3 * mean**3


@pytest.mark.parametrize(
    ('duty', 'ratio'), [(0.05, 0.0), (0.10, 0.0), (0.11, 0.21), (0.5, 0.59), (1.0, 0.83)]
)
def test_what_the_stock_firmware_gives_at_3_7_volts(duty, ratio):
    assert pwm(duty) == pytest.approx(ratio, abs=0.01)


@pytest.mark.parametrize('which', FIRMWARE)
@pytest.mark.parametrize('volts', [2.0, 3.0, 3.7, 4.2, 8.4])
def test_it_inverts_the_cubic(which, volts):
    full, least = FIRMWARE[which][:2]
    for duty in np.linspace(0.0, 1.0, 101).tolist():
        ratio, wanted = pwm(duty, volts, which), full * duty
        if wanted < least:
            assert ratio == 0.0
        elif cubic(volts, which) <= wanted:
            assert ratio == 1.0
        else:
            assert cubic(ratio * volts, which) == pytest.approx(wanted, rel=1e-12)


def test_it_rises_without_a_jump_from_the_least_thrust_to_the_whole_voltage():
    duties = np.linspace(0.1069, 1.0, 500).tolist()
    for volts in (2.5, 3.0, 3.7, 4.2):
        ratios = [pwm(duty, volts) for duty in duties]
        steps = [late - early for early, late in pairwise(ratios)]
        assert min(steps) >= 0.0
        assert max(steps) < 0.01
    assert pwm(1.0, 2.5) == 1.0


def test_the_edges():
    least = 0.0128176 / 0.12
    assert pwm(0.999 * least) == 0.0
    assert pwm(1.001 * least) > 0.2
    assert pwm(0.0) == pwm(-0.5) == pwm(-1.0) == 0.0
    assert pwm(0.5, 1.999) == 0.0
    assert pwm(0.5, 2.001) > 0.9
    assert pwm(0.5, 0.0) == pwm(0.5, NOMINAL)  # nobody knows the voltage
    assert pwm(0.5, 3.3, nominal=0.0) == 0.5  # off


@pytest.mark.parametrize(
    ('changes', 'words'),
    [
        ({}, ''),
        ({'full': 0.12}, 'set voltage to the nominal'),
        ({'voltage': 3.7}, 'must be larger than least'),
        ({'voltage': 3.7, 'full': 0.12, 'least': 0.12, 'c_1': 0.03}, 'must be larger than least'),
        ({'voltage': 3.7, 'full': 0.12}, 'must increase'),
        ({'voltage': 3.7, 'full': 0.12, 'c_1': 0.03}, ''),
        ({'voltage': 3.7, 'full': 0.12, 'c_1': 0.03, 'c_2': -0.02, 'c_3': 0.004}, 'must increase'),
        ({'voltage': 3.7} | dict(zip(NAMES, FIRMWARE['2.1+'], strict=True)), ''),
        ({'voltage': 3.7} | dict(zip(NAMES, FIRMWARE['upgrade kit'], strict=True)), ''),
    ],
)
def test_a_cubic_must_have_an_inverse(changes, words):
    values = {parameter.name: parameter.null for parameter in BATTERY_COMPENSATION.shared}
    objection = BATTERY_COMPENSATION.check({**values, **changes})
    assert words in objection
    assert bool(objection) == bool(words)


UNITS = ('V', 'N', 'N', 'N', 'N/V', 'N/V2', 'N/V3')


def declared(nominal=NOMINAL):
    """Return the effect as a vehicle file has it."""
    values = zip(('voltage', *NAMES), (nominal, *FIRMWARE['2.1+']), UNITS, strict=True)
    return {
        name: {'value': value, 'unit': unit, 'source': 'crazyflie-firmware 2026.08'}
        for name, value, unit in values
    }


def thrust_of(vehicle, duty, volts):
    """Return the thrust of the first rotor after half a second of a duty [N]."""
    model, command = vehicle.build_model(), vehicle.pack_command((duty,) * 4)
    start = pack_state((0.0, 0.0, 2.0), memory=initial_memory())
    late = advance(start, model, command, around(volts), 2.5e-3, 200)
    return evaluate_model(late, model, command, around(volts)).thrusts[0]


class TestOfAVehicle:
    def test_it_says_whether_its_firmware_compensates(self):
        assert not load_vehicle('gtmab').battery_compensated
        assert build(('effects.battery_compensation', declared())).battery_compensated

    def test_null_values_do_not_count(self):
        off = {name: {**each, 'value': 0} for name, each in declared().items()}
        assert not build(('effects.battery_compensation', off)).battery_compensated

    def test_a_duty_flies_as_the_firmware_gives_it(self):
        plain, stock = build(), build(('effects.battery_compensation', declared()))
        ratio = pwm(0.5, 3.4)
        commanded = thrust_of(stock, 0.5, 3.4)
        assert commanded == pytest.approx(thrust_of(plain, ratio, 3.4), rel=1e-12)
        assert thrust_of(plain, 0.5, 3.4) == thrust_of(plain, 0.5, 4.1)

    def test_a_cubic_without_an_inverse_is_refused(self):
        wrong = declared() | {'c_1': {**declared()['c_1'], 'value': 0}}
        with pytest.raises(BadInput, match='must increase with the voltage'):
            build(('effects.battery_compensation', wrong))
