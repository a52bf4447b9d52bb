"""What a discovery says about numbers that a calibration settles."""

from types import SimpleNamespace
from typing import Any

from lta_discovery.calibration.offsets import (
    format_calibration_warning,
    list_calibration_offsets,
)
from lta_discovery.model.calibration_parameters import (
    list_calibration_parameters,
    list_wrench_laws,
    set_references,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import list_free_parameters
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest


@pytest.fixture(scope='module')
def nominal() -> NominalVehicle:
    return NominalVehicle.from_vehicle(load_vehicle('gtmab'))


def list_offsets(nominal: NominalVehicle, changes: dict[str, float], named: str = '') -> Any:
    """Return the offsets of a fit of one flight with some changes."""
    knobs = list_free_parameters(nominal, wrench=True)
    mean = np.array([changes.get(knob.name, 0.0) for knob in knobs])
    fitted = SimpleNamespace(mean=mean)
    fit: Any = SimpleNamespace(fitted=fitted, members=[SimpleNamespace(fitted=fitted)])
    return list_calibration_offsets(nominal, knobs, fit, ['A'], [named])


def test_a_third_of_a_force_and_a_heavy_day_are_said(nominal: NominalVehicle) -> None:
    said = list_offsets(nominal, {'wrench_gain.surge': -0.75, 'net_lift.force': -0.012})
    assert said == (
        'surge: 25 % of the commanded force arrives',
        'net lift of A: -12.0 mN',
    )
    assert 'lta calibrate' in format_calibration_warning(said)[0]


def test_tolerances_effects_and_names_are_not(nominal: NominalVehicle) -> None:
    """A delay of 15 ms is three tolerances; drag is no calibration; a name is said elsewhere."""
    assert list_offsets(nominal, {'command_delay.delay': 0.015}) == ()
    assert list_offsets(nominal, {'linear_drag.surge': 1.0}) == ()
    assert list_offsets(nominal, {'command_delay.delay': 0.1}, 'command_delay.delay') == ()
    assert len(list_offsets(nominal, {'command_delay.delay': 0.1})) == 1
    assert format_calibration_warning(()) == []


def test_each_kind_of_flight_frees_what_it_can_show(nominal: NominalVehicle) -> None:
    """Gains of commanded axes, or rotors; sensors only where there are any; wide throughout."""
    pushed = {
        knob.name: knob
        for knob in list_calibration_parameters(nominal, [True, *[False] * 4, True], True)
    }
    assert {'wrench_gain.surge', 'wrench_gain.yaw', 'marker_offset.pitch'} <= set(pushed)
    assert not {'wrench_gain.heave', 'rotor_1.thrust', 'gyro_bias.x', 'clock_offset.offset'} & set(
        pushed
    )
    assert pushed['wrench_gain.surge'].low < -3.0
    assert pushed['net_lift.force'].per_flight
    driven = {knob.name: knob for knob in list_calibration_parameters(nominal, [False] * 6, False)}
    assert {'rotor_4.thrust', 'gyro_bias.x', 'clock_offset.offset'} <= set(driven)
    assert not any(name.startswith('wrench_gain') for name in driven)
    usual = {knob.name: knob for knob in list_free_parameters(nominal)}
    for name, knob in driven.items():
        assert knob.typical == 0.0
        if name in usual:
            assert knob.tolerance >= usual[name].tolerance, name


def test_exponents_and_reverses_are_fitted_where_commands_show_them() -> None:
    """Surge: both signs, many sizes; heave: one sign; sway: one size; yaw: hardly any reverse."""
    time = np.linspace(0.0, 20.0, 400)
    zero = np.zeros_like(time)
    sway = np.where(time > 10.0, 0.02, -0.02)
    yaw = np.where(time < 0.2, -1e-4, 5e-3 * np.sin(time) ** 2)
    table = np.column_stack(
        [0.04 * np.sin(time), sway, 0.03 + 0.01 * np.sin(time), zero, zero, yaw]
    )
    laws = list_wrench_laws(table)
    own = ['exponent_surge', 'reverse_surge', 'reverse_sway', 'exponent_heave', 'exponent_yaw']
    assert [one for one in laws if '_from_' not in one] == own
    # Half of what the command of heave does, as a share of the other command: 0.0314 N RMS of 0.02
    assert laws['heave_from_sway'] == pytest.approx(0.785, rel=0.02)
    assert laws['heave_from_sway_size'] == laws['heave_from_sway']
    # A lever arm of 0.3 m
    assert (laws['pitch_from_surge'], laws['roll_from_sway']) == (0.3, 0.3)
    # Commands that never change show nothing of other axes
    assert not any('_from_' in one for one in list_wrench_laws(np.full((9, 6), 0.02)))
    assert list_wrench_laws(np.zeros((0, 6))) == {}
    nominal = set_references(NominalVehicle.from_vehicle(load_vehicle('gtmab')), table)
    assert nominal.parameter_value('wrench_gain', 'reference_sway') == 0.02
    assert nominal.parameter_value('wrench_gain', 'reference_roll') == 1.0
    bent = nominal.with_value('wrench_gain', 'exponent_surge', 1.5)
    # A file that states an exponent states its reference, too
    twice = set_references(bent, 2.0 * table)
    assert twice.parameter_value('wrench_gain', 'reference_sway') == 0.04
    assert twice.parameter_value('wrench_gain', 'reference_surge') == bent.parameter_value(
        'wrench_gain', 'reference_surge'
    )
    knobs = {
        one.name: one
        for one in list_calibration_parameters(
            bent, [True, True, True, False, False, True], True, (), laws
        )
    }
    assert {f'wrench_gain.{one}' for one in laws} <= set(knobs)
    assert knobs['wrench_gain.roll_from_sway'].unit == 'm'
    assert 'linear_drag.surge' in knobs
    assert knobs['wrench_gain.exponent_surge'].low == pytest.approx(0.5 - 1.5)
