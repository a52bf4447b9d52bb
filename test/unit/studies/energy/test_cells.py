# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Solar cells beside each other: figures by hand, both fronts, arrays and the verb."""

import json

from lta_cli.app import run_command_line
from lta_config.schema.cell_file import load_cell_file, load_cell_table
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_studies.energy.cells.arrays import (
    build_all_arrays,
    compute_ground_loads,
    compute_net_powers,
    find_largest_array,
    find_pareto_front,
    list_readings,
    select_readings,
)
from lta_studies.energy.cells.report import datasheet_charging_time, find_fronts_by_criterion
import pytest

TABLE = load_cell_table('seed_paper')
ENERGY = load_vehicle_file('gtmab').energy
FOUND = {each.cell.name: each for each in list_readings(TABLE)}


@pytest.mark.parametrize(
    ('name', 'seconds_square_centimetres'),
    [
        ('anysolar', 430), ('adafruit', 1417), ('kitronik', 1452), ('seeed', 1554),
        ('powerfilm_small', 6250), ('powerfilm_large', 30897), ('dracula', 27276),
    ],
)  # fmt: skip
def test_time_times_area_by_hand(name, seconds_square_centimetres):
    """6.2 s * 8.9 cm * 7.8 cm = 430 s cm2, and so on."""
    found = 1e4 * FOUND[name].charging_time_times_area
    assert found == pytest.approx(seconds_square_centimetres, abs=0.6)


@pytest.mark.parametrize('name', [name for name in FOUND if name != 'powerfilm_large'])
def test_the_printed_figures_follow_from_the_printed_rows(name):
    each = FOUND[name]
    assert each.areal_mass == pytest.approx(each.row.areal_mass.si, rel=0.015)
    assert each.charging_time_per_area == pytest.approx(each.row.areal_charge.si, rel=0.02)


def test_the_powerfilm_row_mixes_two_panels():
    small, large = FOUND['powerfilm_small'], FOUND['powerfilm_large']
    assert large.areal_mass == pytest.approx(large.row.areal_mass.si, rel=0.01)
    assert 1e-4 * large.charging_time_per_area == pytest.approx(0.436, abs=5e-4)
    assert 1e-4 * small.charging_time_per_area == pytest.approx(2.15, abs=5e-3)


def test_grams_times_seconds():
    products = {name: 1e3 * each.charging_time_times_mass for name, each in FOUND.items()}
    assert products.pop('anysolar') == pytest.approx(146, abs=0.5)
    assert min(products.values()) == pytest.approx(614, abs=0.5)
    assert max(products.values()) == pytest.approx(1073, abs=0.5)


def names(kept):
    return [each.cell.name for each in kept]


def test_the_front_of_the_paper_is_powerfilm_and_anysolar_in_either_reading():
    found = list(FOUND.values())
    assert names(find_fronts_by_criterion(found, 0)[0]) == ['powerfilm_small', 'anysolar']
    assert names(find_fronts_by_criterion(found, 1)[0]) == ['powerfilm_large', 'anysolar']


def test_the_fair_front_depends_on_the_panel_that_was_charged():
    found = list(FOUND.values())
    assert names(find_fronts_by_criterion(found, 0)[1]) == ['powerfilm_small', 'anysolar']
    assert names(find_fronts_by_criterion(found, 1)[1]) == [
        'powerfilm_large',
        'dracula',
        'anysolar',
    ]


def test_nobody_off_the_front_is_unbeaten():
    rows = select_readings(list(FOUND.values()), 0)
    kept = find_pareto_front(rows, lambda each: each.charging_time_times_area)
    for each in rows:
        beaten = any(
            other.areal_mass <= each.areal_mass
            and other.charging_time_times_area < each.charging_time_times_area
            for other in rows
        )
        assert beaten == (each not in kept)


def test_charging_times_by_data_sheet():
    # 6.2 s * 297 mA / 180 mA; the paper found 19 s.
    found = list(FOUND.values())
    assert datasheet_charging_time(FOUND['adafruit'], found) == pytest.approx(10.23, abs=0.01)
    assert datasheet_charging_time(FOUND['anysolar'], found) == pytest.approx(6.2)


def test_the_loads_are_the_papers():
    assert compute_ground_loads(ENERGY) == pytest.approx((0.097, 0.120))


def test_net_power_at_18_klux_by_hand():
    small, large = build_all_arrays(TABLE)['powerfilm']
    (anysolar,) = build_all_arrays(TABLE)['anysolar']
    assert 1e4 * large.area == pytest.approx(1065.2, abs=0.1)
    assert 1e4 * anysolar.area == pytest.approx(138.84)
    rated_and_factor = (small, 0.72, 2.18), (large, 3.56, 2.18), (anysolar, 2.498, 1.115)
    for strung, rated, factor in rated_and_factor:
        led, sun = compute_net_powers(strung, ENERGY, TABLE)
        assert led.irradiance == pytest.approx(18e3 / 326.0, rel=0.005)
        assert sun.irradiance == pytest.approx(18e3 / 109.5, rel=0.005)
        # Within a fifth of the rating in proportion, for the LED with its spectral factor; then
        # 0.95, 22 mW of the charger, and 0.85.
        assert led.harvest == pytest.approx(rated * 18.0 / 326.0 * factor, rel=0.2)
        for net in (led, sun):
            assert net.charger == pytest.approx((net.harvest * 0.95 - 0.022) * 0.85)
            assert net.standby == pytest.approx(net.charger - 0.097)
            assert net.transmitting == pytest.approx(net.charger - 0.120)


def test_only_sunlight_on_the_small_reading_gives_both_signs_of_the_paper():
    told = {
        (strung.cell.name, net.light): net.has_printed_signs
        for strings in build_all_arrays(TABLE).values()
        for strung in strings
        for net in compute_net_powers(strung, ENERGY, TABLE)
    }
    assert told == {
        ('powerfilm_small', 'white_led'): True,
        ('powerfilm_small', 'sun'): True,
        ('powerfilm_large', 'white_led'): False,
        ('powerfilm_large', 'sun'): False,
        ('anysolar', 'white_led'): False,
        ('anysolar', 'sun'): True,
    }


def test_arrays_within_a_weight_by_hand():
    # 50 g: two ANYSOLAR panels of 23.6 g; two in series are needed for the charger's 4.95 V.
    found = find_largest_array(load_cell_file('anysolar'), 0.050)
    assert (found.series, found.parallel) == (2, 1)
    assert find_largest_array(load_cell_file('anysolar'), 0.047) is None
    # 9 g each, 7.2 V alone: five.
    large = find_largest_array(load_cell_file('powerfilm_large'), 0.045)
    assert (large.series, large.parallel) == (1, 5)
    assert find_largest_array(load_cell_file('kitronik'), 0.050) is None


def test_the_verb_writes_a_page_and_numbers(tmp_path, monkeypatch, capsys):
    folder = tmp_path / 'found'
    monkeypatch.setattr('sys.argv', ['lta', 'cells', '--out', str(folder), '--json'])
    assert run_command_line() == 0
    said = json.loads(capsys.readouterr().out)
    assert said['fronts'][1]['fair'] == ['powerfilm_large', 'dracula', 'anysolar']
    assert json.loads((folder / 'cells.json').read_text())['budget'] == pytest.approx(0.05)
    page = (folder / 'report.html').read_text()
    assert 'A fair criterion' in page
    assert 'mixes two panels' in page
