# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""lta cfd, as it is typed, with programs that stand in for OpenFOAM."""

import math
import shutil

from campaigns.sphere import (
    build_sphere_model,
    compare_with_measurements,
    plan_validation_flows,
)
from lta_config.files import share_folder
from lta_report.report_terminal import print_table
from lta_studies.cfd.report import build_drag_table, build_rotor_table
from lta_windtunnel.flow_plan import TUNNEL_AIR
from lta_windtunnel.solve import ThreadedFlowSolver
from lta_windtunnel.sweep_table import drop_pressure_maps, read_sweep
import pytest
from rich.console import Console


@pytest.fixture
def run(fake, call, monkeypatch, tmp_path):
    """Return a function that calls `lta cfd run gtmab` in the fake's folder."""
    monkeypatch.chdir(tmp_path)
    common = ('cfd', 'run', 'gtmab', '--cache', fake, '--out', 'done')
    return lambda *words: call(*common, *words)


def test_a_run_leaves_a_page_a_sweep_and_an_aero_file(run, tmp_path):
    status, said = run('--only', 'heave', '--only', 'up_left', '--workers', 1)
    assert status == 0
    assert 'has a drag of' in said.out
    assert sorted(path.name for path in (tmp_path / 'done').iterdir()) == [
        'gtmab.aero.yaml', 'gtmab.blown.json', 'gtmab.sweep.json', 'report.html',
    ]  # fmt: skip
    sweep = read_sweep(tmp_path / 'done/gtmab.sweep.json')
    mapped = read_sweep(tmp_path / 'done/gtmab.blown.json')
    assert sweep == drop_pressure_maps(mapped) != mapped
    assert (list(sweep.axes), list(sweep.blows)) == (['heave'], ['up_left'])


def test_a_run_with_the_nose_up_has_a_table_of_its_own(run, tmp_path):
    status, said = run('--only', 'incidence_20', '--workers', 1)
    assert status == 0
    assert 'Nose up' in said.out
    assert list(read_sweep(tmp_path / 'done/gtmab.sweep.json').inclined) == ['incidence_20']


def test_what_dies_is_said_and_the_rest_is_kept(run, monkeypatch, tmp_path):
    monkeypatch.setenv('FAKE_FAULT', 'surge:diverges')
    status, said = run('--only', 'heave', '--only', 'surge')
    assert status == 0
    assert 'surge: simpleFoam diverged' in said.out
    assert 'results failed).' in said.out
    assert list(read_sweep(tmp_path / 'done/gtmab.sweep.json').axes) == ['heave']


@pytest.mark.parametrize('name', ['beavis', 'blimp2b', 'gtmab', 'sblimp', 'skye'])
def test_no_number_is_cut_on_a_terminal_of_80_columns(name):
    sweep = read_sweep(share_folder() / 'aero' / f'{name}.sweep.json')
    console = Console(width=80, record=True, force_terminal=True)
    for table in (build_drag_table(sweep), build_rotor_table(sweep)):
        print_table(table, console)
    said = [line.split() for line in console.export_text().splitlines()]
    for table in (build_drag_table(sweep), build_rotor_table(sweep)):
        assert all(' '.join(row).split() in said for row in table.rows)


def test_nothing_solved_is_status_1_with_the_analytic_part(run, monkeypatch, tmp_path):
    monkeypatch.setenv('FAKE_FAULT', 'heave mesh:killed')
    assert run('--only', 'heave')[0] == 1
    assert (tmp_path / 'done/gtmab.aero.yaml').is_file()


@pytest.mark.parametrize(
    ('words', 'said'),
    [
        (('--only', 'heavy'), "'heavy'"),
        (('--memory', '0.1', '--only', 'heave'), 'need about'),
    ],
)
def test_bad_input_is_one_sentence_and_leaves_no_folder(run, tmp_path, words, said):
    status, told = run(*words)
    assert status == 2
    assert said in told.err
    assert not (tmp_path / 'done').exists()


def test_without_openfoam_nothing_is_begun(run, monkeypatch, tmp_path):
    monkeypatch.setattr(shutil, 'which', lambda _: None)
    status, told = run()
    assert status == 2
    assert 'apt-get install' in told.err
    assert not (tmp_path / 'done').exists()


@pytest.mark.long
def test_a_sphere_is_judged(fake):
    """The transients begin with a small step, whatever the steady flow before them took."""
    model = build_sphere_model()
    flows = [
        flow
        for level in ('preview', 'reference')
        for flow in plan_validation_flows(model, level, TUNNEL_AIR)
    ]
    solver = ThreadedFlowSolver(fake, 1, lambda *_: None)
    found = compare_with_measurements(solver, model, flows, TUNNEL_AIR, print)
    alone = {'steady': 4.0, 'transient': 1.0}  # a quarter of the air is solved, or all of it
    assert {each.setting.split(',')[0] for each in found} == alone.keys()
    for each in found:  # 0.05 N at 1 kg/m3 and 1 m/s, on the shadow of a sphere of 1 m
        share = alone[each.setting.split(',')[0]]
        assert each.coefficient == pytest.approx(0.4 / math.pi * share, rel=1e-3)
