# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The array: the data sheet comes back, pvlib says the same, strings add up."""

import math

from hypothesis import given
from hypothesis import strategies as st
from lta_config.files import list_shipped_names
from lta_config.schema.cell_file import load_cell_file
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_model.electrical.panel import (
    AIR_TEMPERATURE,
    compute_curve_parameters,
    current_at_voltage,
    find_max_power_point,
    fit_diode,
    junction_current,
    power_slope,
    SingleDiodeModel,
    SolarArrayModel,
    THERMAL_VOLTAGE,
    voltage_bound,
)
import pytest

CELLS = list_shipped_names('cells')
LIGHT = st.floats(0.1, 1200.0)
pvsystem = pytest.importorskip('pvlib').pvsystem


def pvlib_curve(panel, irradiance):
    light, saturation, thermal, series, shunt = compute_curve_parameters(panel, irradiance)
    return pvsystem.singlediode(light, saturation, series, 1.0 / shunt, thermal)


@pytest.mark.parametrize('name', CELLS)
def test_the_diode_has_the_points_of_the_data_sheet(name):
    data, diode = load_cell_file(name).electrical, fit_diode(load_cell_file(name))
    light, saturation, thermal, series, shunt = diode
    found = pvsystem.singlediode(light, saturation, series, 1.0 / shunt, thermal)
    assert found['i_sc'] == pytest.approx(data.short_circuit.si, rel=1e-9)
    assert found['v_oc'] == pytest.approx(data.open_circuit.si, rel=1e-9)
    assert found['v_mp'] == pytest.approx(data.voltage.si, rel=1e-5)
    assert found['p_mp'] == pytest.approx(data.voltage.si * data.current.si, rel=1e-9)


@pytest.mark.parametrize('name', CELLS)
@pytest.mark.parametrize('irradiance', [1.0, 60.0, 267.0, 1000.0])
def test_pvlib_finds_the_same_point_of_largest_power(name, irradiance):
    panel = SolarArrayModel.from_cells(name, 2, 3)
    voltage, current = find_max_power_point(panel, irradiance)
    theirs = pvlib_curve(panel, irradiance)
    assert voltage * current == pytest.approx(theirs['p_mp'], rel=1e-9)
    assert voltage == pytest.approx(theirs['v_mp'], rel=1e-5)
    assert current_at_voltage(panel, irradiance, 0.0) == pytest.approx(theirs['i_sc'], rel=1e-9)
    middle = 0.9 * theirs['v_mp']
    there = pvsystem.i_from_v(middle, *_arguments(panel, irradiance))
    assert current_at_voltage(panel, irradiance, middle) == pytest.approx(there, rel=1e-9)


def _arguments(panel, irradiance):
    light, saturation, thermal, series, shunt = compute_curve_parameters(panel, irradiance)
    return light, saturation, series, 1.0 / shunt, thermal


@pytest.mark.parametrize(('name', 'irradiance'), [('anysolar', 800.0), ('powerfilm_small', 300.0)])
def test_warmth_is_pvlibs(name, irradiance):
    file, diode = load_cell_file(name), fit_diode(load_cell_file(name))
    data = file.electrical
    light, saturation, _, _, thermal = pvsystem.calcparams_pvsyst(
        irradiance, AIR_TEMPERATURE - 273.15 + data.warming.si * irradiance,
        data.current_drift.si * diode.light, data.ideality.si, 0.0, diode.light,
        diode.saturation, 100.0, 100.0, diode.series, data.junctions, EgRef=data.gap.si,
    )  # fmt: skip
    ours = compute_curve_parameters(SolarArrayModel.from_cells(name, 1, 1), irradiance)
    assert ours[0] == pytest.approx(light, rel=1e-6)
    assert ours[1] == pytest.approx(saturation, rel=1e-5)
    assert ours[2] == pytest.approx(thermal, rel=1e-6)


@given(LIGHT, st.integers(1, 5), st.integers(1, 5))
def test_strings_add_up(irradiance, series, parallel):
    voltage, current = find_max_power_point(
        SolarArrayModel.from_cells('anysolar', 1, 1), irradiance
    )
    volts, amperes = find_max_power_point(
        SolarArrayModel.from_cells('anysolar', series, parallel), irradiance
    )
    assert volts == pytest.approx(series * voltage, rel=1e-6)
    assert amperes == pytest.approx(parallel * current, rel=1e-6)


def test_darkness_gives_nothing():
    panel = SolarArrayModel.from_cells('anysolar', 2, 1)
    assert find_max_power_point(panel, 0.0) == (0.0, 0.0)
    assert find_max_power_point(panel, -1.0) == (0.0, 0.0)
    assert current_at_voltage(panel, 0.0, 0.0) == 0.0
    assert find_max_power_point(
        SolarArrayModel.from_energy(load_vehicle_file('sblimp').energy), 500.0
    ) == (0.0, 0.0)


def test_a_vehicle_without_an_array_has_a_panel_of_nothing():
    assert SolarArrayModel.from_energy(load_vehicle_file('sblimp').energy).model_dump() == {
        'light': 0.0, 'saturation': 0.0, 'thermal': 1.0, 'series': 0.0, 'shunt': 0.0, 'gap': 1.0,
        'drift': 0.0, 'warming': 0.0,
    }  # fmt: skip


def test_a_curve_by_hand():
    """At 1 V with a thermal voltage of 0.5 V the diode takes e^2 - 1 saturation currents."""
    numbers = (2.0, 0.01, 0.5, 0.1, 0.02)
    diode = 0.01 * (math.exp(2.0) - 1.0)
    assert junction_current(numbers, 1.0) == pytest.approx(2.0 - diode - 0.02)
    assert voltage_bound(numbers) == pytest.approx(0.5 * math.log(201.0))
    assert voltage_bound((2.0, 0.0, 0.5, 0.1, 0.02)) == 0.0
    # P = (u - R I) I, differentiated by differences.
    step = 1e-6
    powers = [
        (u - 0.1 * junction_current(numbers, u)) * junction_current(numbers, u)
        for u in (1.0 - step, 1.0 + step)
    ]
    slope = (powers[1] - powers[0]) / (2.0 * step)
    assert power_slope(numbers, 1.0) == pytest.approx(slope, rel=1e-6)


def test_no_current_flows_back_and_the_warmth_is_that_of_the_light():
    panel = SolarArrayModel.from_cells('anysolar', 1, 1)
    assert current_at_voltage(panel, 1000.0, 100.0) == 0.0
    assert current_at_voltage(panel, -1.0, 0.0) == 0.0
    unlit = panel.model_copy(update={'light': 0.0})
    assert current_at_voltage(unlit, 1000.0, 0.0) == 0.0
    assert find_max_power_point(unlit, 1000.0) == (0.0, 0.0)
    # 20 degC of the air and 10 K by 1000 W/m2: 303.15 K of 298.15 K.
    warm = panel.model_copy(update={'warming': 0.01, 'drift': 1e-3})
    light, saturation, thermal, series, shunt = compute_curve_parameters(warm, 1000.0)
    ratio = 303.15 / 298.15
    assert light == pytest.approx(panel.light * 1.005)
    assert thermal == pytest.approx(panel.thermal * ratio)
    freed = panel.gap * (1.0 - 1.0 / ratio) / (8.617333262e-5 * 298.15)
    assert saturation == pytest.approx(panel.saturation * ratio**3 * math.exp(freed))
    assert (series, shunt) == (panel.series, panel.shunt)
    assert compute_curve_parameters(warm, 500.0)[4] == pytest.approx(0.5 * panel.shunt)


@pytest.mark.parametrize('name', CELLS)
def test_the_diode_of_a_sheet_solves_its_three_equations(name):
    """
    The three equations are short circuit, open circuit and zero slope of the power at its maximum.
    """
    sheet, diode = load_cell_file(name).electrical, fit_diode(load_cell_file(name))
    assert isinstance(diode, SingleDiodeModel)
    # k T / q at 298.15 K.
    assert pytest.approx(1.380649e-23 * 298.15 / 1.602176634e-19, rel=1e-7) == THERMAL_VOLTAGE
    assert diode.thermal == pytest.approx(sheet.ideality.si * sheet.junctions * THERMAL_VOLTAGE)
    assert diode.series >= 0.0
    assert diode.shunt >= 0.0
    for volts, amperes in (
        (0.0, sheet.short_circuit.si),
        (sheet.open_circuit.si, 0.0),
        (sheet.voltage.si, sheet.current.si),
    ):
        junction = volts + diode.series * amperes
        found = junction_current(diode, junction)
        assert found == pytest.approx(amperes, abs=1e-9 * sheet.short_circuit.si)
    at = sheet.voltage.si + diode.series * sheet.current.si
    numbers = (diode.light, diode.saturation, diode.thermal, diode.series, diode.shunt)
    assert power_slope(numbers, at) == pytest.approx(0.0, abs=1e-6 * sheet.current.si)
