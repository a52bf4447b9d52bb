# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""lta vehicle, as it is typed."""

from dataclasses import replace
from functools import partial
import io
import json
import re

from lta_config.files import find_file, list_shipped_names
from lta_model.vehicle import load_vehicle
from lta_vehicle.figures.sheet import build_sheet
from lta_vehicle.views.report import build_report
from lta_vehicle.views.sheet_summary import show_sheet
import pytest
from rich.console import Console

SHIPPED = find_file('vehicle', 'gtmab').read_text('utf-8')


@pytest.fixture
def call(call, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    return partial(call, 'vehicle')


def test_a_new_vehicle_is_a_copy_with_comments_that_loads(call, tmp_path):
    status, said = call('new', 'my_blimp')
    assert status == 0
    assert 'my_blimp.yaml' in said.out
    text = (tmp_path / 'my_blimp.yaml').read_text('utf-8')
    assert text.startswith('# my_blimp: copied from gtmab.\n')
    assert text.endswith(SHIPPED.replace('\nname: gtmab\n', '\nname: my_blimp\n'))
    assert call('check', 'my_blimp.yaml')[0] == 0
    assert 'have the same content' in call('diff', 'gtmab', 'my_blimp.yaml')[1].out


@pytest.mark.parametrize('model', list_shipped_names('vehicles'))
def test_every_shipped_vehicle_is_a_start(call, tmp_path, model):
    assert call('new', 'mine', '--from', model)[0] == 0
    assert '\nname: mine\n' in (tmp_path / 'mine.yaml').read_text('utf-8')


def test_all_that_is_wrong_is_said_at_once(call, tmp_path):
    text = SHIPPED.replace('height: {value: 59.9', 'heigth: {value: 59.9', 1)
    text = text.replace(', source: "seed paper, 1S 250 mAh"', '')
    text = text.replace('capacity: {value: 250, unit: mA h', 'capacity: {value: 250, unit: g')
    (tmp_path / 'bad.yaml').write_text(text)
    status, said = call('check', 'bad.yaml')
    assert status == 2
    lines = said.err.splitlines()
    assert len(lines) == 3
    assert all(line.startswith('bad.yaml: ') for line in lines)
    assert "'hull.heigth' is not known" in said.err
    assert 'battery.mass has no source' in said.err
    assert 'energy.battery.capacity is in g, but must be in C' in said.err


def test_what_a_good_file_cannot_be_flown_for_is_said_at_once(call, tmp_path):
    text = SHIPPED.replace('gains: gtmab', 'gains: gtmap').replace('value: 116.8', 'value: 186.8')
    text = text.replace('up: {value: 72, unit: ms', 'up: {value: 72, unit: g')
    text = text.replace('  floor_contact:', '  flor_contact:')
    (tmp_path / 'bad.yaml').write_text(text)
    status, said = call('check', 'bad.yaml')
    assert status == 2
    assert 'The parts of gtmab are 56.6 g too heavy for its lift of 331.2 g' in said.err
    assert 'effects.motor_lag.up is in g' in said.err
    assert "Unknown effect 'flor_contact'" in said.err
    assert "control.gains: Unknown gains 'gtmap'; known: beavis" in said.err


def test_warnings_leave_the_status_at_zero(call):
    status, said = call('check', 'gtmab', '--json')
    assert status == 0
    found = json.loads(said.out)
    assert found['faults'] == []
    assert any(
        '39 of the 117 numbers in the vehicle file are assumed' in line
        for line in found['warnings']
    )


@pytest.mark.parametrize(
    ('old', 'new', 'warning'),
    [
        ('{value: 2, unit: g', '{value: 20, unit: g', 'which may happen within 5 days'),
        (
            'size: {value: [100, 100, 59.9]',
            'size: {value: [90, 90, 53.9]',
            r'The part envelope \(shape: shell\) measures 90.0 x',
        ),
        ('purity: {value: 93', 'purity: {value: 89.5', 'carries only .* g of ballast'),
        ('[0, 0, -33], unit: cm', '[9, 0, -33], unit: cm', 'At rest it tilts by'),
        (
            'value: [0, 0, 1], unit: "1"',
            'value: [0, 1, 0], unit: "1"',
            'up_left points along .* 89 degrees away',
        ),
    ],
)
def test_what_should_be_looked_at_is_said(call, tmp_path, old, new, warning):
    assert old in SHIPPED
    (tmp_path / 'odd.yaml').write_text(SHIPPED.replace(old, new))
    status, said = call('check', 'odd.yaml', '--json')
    assert any(re.search(warning, line) for line in json.loads(said.out)['warnings']), said.out
    assert status == 0


def test_numbers_copied_from_another_vehicle_are_reported(call, tmp_path):
    assert call('new', 'mine', '--from', 'blimp2b')[0] == 0
    found = json.loads(call('check', 'mine.yaml', '--json')[1].out)
    told = [line for line in found['warnings'] if 'are those of blimp2b' in line]
    assert told[0].startswith('65 of its 65 numbers')
    own = (tmp_path / 'mine.yaml').read_text()
    (tmp_path / 'mine.yaml').write_text(re.sub('source: .*?}', "source: 'kitchen scale'}", own))
    found = json.loads(call('check', 'mine.yaml', '--json')[1].out)
    assert not any('are those of' in line for line in found['warnings'])


def test_show_prints_words_and_sources(call):
    status, said = call('show', 'gtmab', '--sources')
    assert status == 0
    assert 'gtmab weighs 415.3 g' in said.out
    assert 'layers.propulsion_and_control.battery.mass' in said.out
    assert 'seed paper, 1S 250 mAh' in said.out


def test_show_gives_numbers_to_scripts(call):
    status, said = call('show', 'gtmab', '--json')
    found = json.loads(said.out)
    assert status == 0
    # `lta wind gtmab` says the same: above, the hull rises
    assert found['figures']['level_speed']['value'] == pytest.approx(0.757, abs=5e-3)
    assert found['figures']['level_speed']['unit'] == 'm/s'
    assert found['assumed'] == sum(entry['assumed'] for entry in found['numbers']) == 39


@pytest.mark.parametrize('name', list_shipped_names('vehicles'))
def test_every_vehicle_is_shown_in_a_narrow_window(name):
    sheet, window = build_sheet(load_vehicle(name)), io.StringIO()
    console = Console(file=window, force_terminal=True, no_color=True, width=60, height=40)
    report = build_report(sheet, [], name)
    show_sheet(sheet, replace(report, headline='', closing=[]), console)
    lines = re.sub('\x1b\\[[0-9;]*m', '', window.getvalue()).splitlines()
    assert max(map(len, lines)) <= 60


@pytest.mark.parametrize('ballast', [[], ['--set', 'trim.heaviness=4 g']])
def test_diff_says_what_no_figure_knows(call, ballast):
    scale = "effects.thrust_scale={factor: {value: 0.5, unit: '1', source: test}}"
    status, said = call('diff', 'gtmab', '--set', scale, *ballast)
    assert status == 0
    words = ' '.join(said.out.split())
    assert 'To see the influence of thrust_scale, simulate both vehicles' in words
    assert 'No derived figure changes' not in words
    assert ('ballast to add' in words) == bool(ballast)
