# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Corrections of a calibration that are taken back, one effect at a time."""

from lta_discovery.calibration.corrections import judge_corrections, list_corrections
from lta_discovery.calibration.result import CalibratedValue, Correction, WIDE
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.state_filter.forecasts import FlightForecasts
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest

LINEAR, QUADRATIC, CROSS = (
    'linear_drag.surge',
    'quadratic_drag.surge',
    'wrench_gain.heave_from_yaw',
)


def make_parameter(name: str) -> FreeParameter:
    effect, _, part = name.partition('.')
    return FreeParameter(name, '1', {(effect, part): 1.0}, 1e-3, 1e-3, 1.0)


def make_value(name: str, before: float, change: float, deviation: float) -> CalibratedValue:
    value = before + change
    ends = (value - WIDE * deviation, value + WIDE * deviation)
    return CalibratedValue(name, '1', '', before, value, ends, True, False, ())


def test_the_other_values_are_the_most_probable_ones_without_an_effect() -> None:
    """Of a Gaussian, E[q | l = 0] = q - cov(q, l) / var(l) l."""
    nominal = NominalVehicle.from_vehicle(load_vehicle('gtmab'))
    names = (LINEAR, QUADRATIC, CROSS)
    change = np.array([0.04, -0.05, 40.0])
    covariance = np.array([[1e-4, -4e-4, 0.0], [-4e-4, 3e-3, 0.0], [0.0, 0.0, 900.0]])
    before = [nominal.parameter_value(*name.split('.')) for name in names]
    deviations = np.sqrt(np.diag(covariance))
    values = list(map(make_value, names, before, change, deviations))
    parameters = [make_parameter(one) for one in names]
    (drag,) = list_corrections(nominal, parameters, change, covariance, values)
    # 0.05 is less than 1.96 times 0.055, and 40 less than 1.96 times 30: only the linear is clear
    assert drag.effect == 'linear_drag'
    assert [one.name for one in drag.values] == [LINEAR]
    assert drag.without.parameter_value('linear_drag', 'surge') == 0.0
    quadratic = drag.without.parameter_value('quadratic_drag', 'surge')
    assert quadratic == pytest.approx(before[1] - 0.05 + 4.0 * 0.04)
    assert drag.without.parameter_value('wrench_gain', 'heave_from_yaw') == pytest.approx(40.0)


def test_what_a_command_does_on_other_axes_is_no_gain() -> None:
    nominal = NominalVehicle.from_vehicle(load_vehicle('gtmab'))
    names = ('wrench_gain.surge', CROSS)
    change, covariance = np.array([-0.5, 40.0]), np.diag([0.01, 25.0])
    values = [make_value(names[0], 1.0, -0.5, 0.1), make_value(CROSS, 0.0, 40.0, 5.0)]
    parameters = [make_parameter(one) for one in names]
    gain, coupling = list_corrections(nominal, parameters, change, covariance, values)
    assert (gain.effect, coupling.effect) == ('wrench_gain', 'wrench_coupling')
    assert gain.without.parameter_value('wrench_gain', 'surge') == 1.0
    assert gain.without.parameter_value('wrench_gain', 'heave_from_yaw') == pytest.approx(40.0)
    assert coupling.without.parameter_value('wrench_gain', 'surge') == pytest.approx(0.5)


def forecast(error: float) -> list[FlightForecasts]:
    """Return forecasts of 100 s that are all off by an error along x."""
    starts = np.arange(0.0, 100.0, 1.5)
    errors = np.zeros((len(starts), 1, 6))
    errors[..., 0] = error
    return [FlightForecasts(starts, (3.0,), errors, errors, np.zeros(len(starts)), errors)]


def test_the_correction_without_which_forecasts_are_worst_comes_first() -> None:
    """Constant errors of 8 cm, and of 10 cm, 16 cm and 8 cm without an effect."""
    nominal = NominalVehicle.from_vehicle(load_vehicle('gtmab'))
    errors = {'wrench_gain': 0.1, 'linear_drag': 0.16, 'marker_offset': 0.08}
    corrections = [Correction(effect, (), nominal) for effect in errors]
    judged = judge_corrections(
        corrections,
        forecast(0.08),
        lambda others: {name: forecast(errors[name]) for name in others},
    )
    assert [one.correction.effect for one in judged] == [
        'linear_drag', 'wrench_gain', 'marker_offset',
    ]  # fmt: skip
    assert [one.ratio.value for one in judged] == pytest.approx([0.5, 0.8, 1.0])
    assert [one.is_confirmed for one in judged] == [True, True, False]
    assert judge_corrections((), forecast(0.08), lambda others: {}) == ()
