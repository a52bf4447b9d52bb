# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Whole sweeps with programs that stand in for OpenFOAM: what fails is named, the rest is kept."""

from lta_windtunnel.flow_plan import plan_flows
from lta_windtunnel.solve import build_sweep, solve_sweep, ThreadedFlowSolver
from lta_windtunnel.tunnel_model import load_tunnel_model
import numpy as np
import pytest

AIR = (1.2, 1.5e-5)
GTMAB = load_tunnel_model('gtmab')


def swept(folder, *only, retry=False):
    said = []
    crew = ThreadedFlowSolver(folder, 2, lambda *_: None, retry)
    found = solve_sweep(crew, GTMAB, plan_flows(GTMAB, 'preview', AIR, only), AIR, said.append)
    return build_sweep(GTMAB, 'gtmab', 'preview', AIR, *found), said


def calls(folder, name):
    """Return how many programs have run for a case."""
    (place,) = (each.parent for each in folder.glob('*/name') if each.read_text() == f'{name}\n')
    return len((place / 'calls').read_text().splitlines())


def test_a_sweep_becomes_forces_in_body_axes(fake):
    sweep, said = swept(fake, 'heave', 'roll', 'up_left')
    assert said == []
    # 0.05 N on each of three bodies in a quarter of the air, by rho U^2.
    drags = {point.speed: -point.force[2] for point in sweep.axes['heave']}
    assert drags == pytest.approx({u: 1.2 * u**2 * 4 * 0.15 for u in (0.2, 0.5, 1.0, 1.5, 2.0)})
    assert [p.moment[0] for p in sweep.axes['roll']] == pytest.approx(
        [-1.2 * w**2 * 0.15 for w in (0.3, 1.0, 3.0)]
    )
    assert sweep.coarse['heave'].force == sweep.axes['heave'][2].force
    assert sweep.blows['up_left'].force == pytest.approx([0, 0, GTMAB.rotors['up_left'].thrust])
    assert sweep.blows['up_left'].evidence.balance < 1e-3
    pressed = sweep.blows['up_left'].pressed['envelope']
    assert (pressed.least, pressed.most) == pytest.approx((-1.2, 2.4))
    assert pressed.most_at[2] == -pressed.least_at[2] == 1.0


def test_with_the_nose_up_the_air_comes_from_ahead_and_below(fake):
    sweep, said = swept(fake, 'incidence_30')
    assert (said, dict(sweep.axes)) == ([], {})
    # 0.05 N on each of three bodies in half of the air, away from where it comes
    drag = 1.2 * 2 * 0.15
    expected = [-drag * np.cos(np.pi / 6), 0.0, drag * 0.5]
    assert sweep.inclined['incidence_30'].force == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize(
    ('fault', 'reason'),
    [('killed', 'start again to resume'), ('disk', 'disk is full; free disk space')],
)
def test_what_befell_a_flow_is_said(fake, monkeypatch, fault, reason):
    monkeypatch.setenv('FAKE_FAULT', f'up_left:{fault}')
    sweep, _ = swept(fake, 'up_left')
    assert reason in sweep.refused['up_left']


def test_a_case_that_diverged_is_named_and_only_it_is_repeated_if_the_user_asks(fake, monkeypatch):
    monkeypatch.setenv('FAKE_FAULT', 'surge:diverges')
    sweep, said = swept(fake, 'heave', 'surge')
    assert 'simpleFoam diverged' in sweep.refused['surge']
    assert said == [f'surge: {sweep.refused["surge"]}']
    assert list(sweep.axes) == ['heave']
    monkeypatch.delenv('FAKE_FAULT')
    assert '--retry-failed repeats it' in swept(fake, 'surge')[0].refused['surge']
    sweep, said = swept(fake, 'heave', 'surge', retry=True)
    assert (sorted(sweep.axes), sweep.refused, said) == (['heave', 'surge'], {}, [])
    assert calls(fake, 'heave') == 5  # a program a speed, none of them twice
    assert calls(fake, 'surge') == 6


def test_a_mesh_that_dies_takes_its_flows_along_and_no_others(fake, monkeypatch):
    monkeypatch.setenv('FAKE_FAULT', 'still mesh:killed')
    sweep, _ = swept(fake, 'heave', 'yaw', 'up_left')
    assert sorted(sweep.refused) == ['up_left', 'yaw']
    assert list(sweep.axes) == ['heave']


def test_speeds_that_swing_are_refused_and_the_slow_ones_kept(fake, monkeypatch):
    monkeypatch.setenv('FAKE_FAULT', 'heave:swings')
    sweep, _ = swept(fake, 'heave')
    assert [point.speed for point in sweep.axes['heave']] == [0.2, 0.5]
    assert sorted(sweep.refused) == ['heave at 1', 'heave at 1.5', 'heave at 2']
    assert 'varies by 50 %' in sweep.refused['heave at 1']


@pytest.mark.parametrize(('flow', 'refused'), [('heave', 'heave at 1'), ('up_left', 'up_left')])
def test_a_flow_whose_momentum_is_lost_is_refused(fake, monkeypatch, flow, refused):
    monkeypatch.setenv('FAKE_FAULT', f'{flow}:unbalanced')
    sweep, _ = swept(fake, flow)
    assert '50 % of the force is missing in the momentum' in sweep.refused[refused]
    assert sweep.axes == sweep.blows == {}


def test_a_body_that_the_mesh_has_lost_is_told_before_anything_is_solved(fake, monkeypatch):
    monkeypatch.setenv('FAKE_FAULT', 'heave mesh:lost')
    sweep, _ = swept(fake, 'heave')
    assert (
        'The heave mesh has only 8 faces on the body envelope, fewer than 20'
        in sweep.refused['heave']
    )
    assert (sweep.axes, list(sweep.coarse)) == ({}, ['heave'])
    assert 'heave\n' not in {each.read_text() for each in fake.glob('*/name')}


def test_a_disk_of_few_cells_does_not_blow(fake, monkeypatch):
    monkeypatch.setenv('FAKE_FAULT', 'still mesh:coarse')
    sweep, _ = swept(fake, 'up_left')
    assert 'up_left has only 12 mesh cells, fewer than 30' in sweep.refused['up_left']
